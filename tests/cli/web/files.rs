//! Files that are dropped onto the page.

use std::path::Path;

use serde_json::json;

use super::page::open;
use super::{folder, serve};
use crate::browser::Browser;
use crate::support::peers::peer;

const LOOK: &str = r##"({
  notice: document.getElementById("notice").textContent,
  text: document.getElementById("editor").value,
  typed: document.getElementById("typed").value,
  layout: document.getElementById("layout").textContent,
})"##;

/// Drops a file onto the page.
pub(super) fn drop_file(browser: &mut Browser, name: &str, bytes: &[u8]) {
    let (name, bytes) = (json!(name), json!(bytes));
    browser.evaluate(&format!(
        "(() => {{ const files = new DataTransfer(); files.items.add(new File([new Uint8Array({bytes})], {name}));
        dispatchEvent(new DragEvent('drop', {{ dataTransfer: files, cancelable: true }})); }})()"
    ));
}

#[test]
fn a_dropped_file_is_played_or_says_why_not() {
    let Some(page) = folder() else { return };
    let Some(dance) = peer("bvh/rokoko_fingers_dance.bvh") else {
        return;
    };
    let dance = std::fs::read_to_string(dance).expect("a text");
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (_server, address) = serve(&page);
    open(&mut browser, &address);
    for (name, text, notice) in [
        ("dance.bvh", &*dance, "40 readings of bvh"),
        ("cut.bvh", "HIERARCHY\nROOT", "not closed"),
        (
            "notes.txt",
            "nothing",
            "the file is neither a recording (.mcap) nor motion capture (BVH)",
        ),
    ] {
        drop_file(&mut browser, name, text.as_bytes());
        browser.wait_for(LOOK, "a message", |look| {
            look["notice"]
                .as_str()
                .is_some_and(|it| it.contains(notice))
        });
    }
    drop_file(&mut browser, "mine.ron", b"Layout(name: \"Mine\")");
    browser.wait_for(LOOK, "a layout", |look| {
        look["text"] == "Layout(name: \"Mine\")"
    });
}

#[test]
fn a_file_that_cannot_be_read_is_a_message() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (_server, address) = serve(&page);
    open(&mut browser, &address);
    // As a browser answers for a folder, and for a file that is gone.
    browser.evaluate("Blob.prototype.text = async () => { throw new Error('gone'); }; true");
    drop_file(&mut browser, "hands.jsonl", b"{}");
    browser.wait_for(LOOK, "a reason", |look| {
        look["notice"] == "the file cannot be read: gone"
    });
}

#[test]
fn text_that_is_dragged_is_left_to_its_field_and_a_file_to_the_page() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (_server, address) = serve(&page);
    open(&mut browser, &address);
    let is_left = |own: &mut Browser, field: &str, data: &str| {
        let drop = format!(
            "['dragover', 'drop'].map((kind) => {{ const data = new DataTransfer(); data.items.add({data});
            return document.getElementById('{field}').dispatchEvent(new DragEvent(kind, {{ dataTransfer: data, bubbles: true, cancelable: true }})); }})"
        );
        own.evaluate(&drop)
    };
    let text = "'// mine', 'text/plain'";
    let file = "new File(['Layout(name: \"Mine\")'], 'mine.ron')";
    for (field, data, expected) in [
        ("editor", text, [true; 2]),
        ("text-to-type", text, [true; 2]),
        ("typed", text, [false; 2]),
        ("view", text, [false; 2]),
        ("editor", file, [false; 2]),
    ] {
        let left = is_left(&mut browser, field, data);
        assert_eq!(left, json!(expected), "{field}: {data}");
    }
    browser.wait_for(LOOK, "a layout", |look| {
        look["text"] == "Layout(name: \"Mine\")"
    });
}

#[test]
fn a_file_can_be_chosen_twice() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (_server, address) = serve(&page);
    open(&mut browser, &address);
    for input in ["recording", "webcam-file"] {
        let chosen = browser.evaluate(&format!(
            "(() => {{ const files = new DataTransfer(); files.items.add(new File(['a'], 'a.txt'));
            const input = document.getElementById('{input}'); input.files = files.files;
            const before = input.files.length; input.click(); return [before, input.files.length]; }})()"
        ));
        assert_eq!(chosen, json!([1, 0]), "the choice of {input} is a new one");
    }
}

#[test]
fn the_list_of_layouts_does_not_name_another_one_than_the_dropped_one() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (_server, address) = serve(&page);
    open(&mut browser, &address);
    let chosen = "document.getElementById('gallery-list').value";
    assert_eq!(browser.evaluate(chosen), "qwerty-flat");
    drop_file(&mut browser, "mine.ron", b"Layout(name: \"Mine\")");
    browser.wait_for(LOOK, "a layout", |look| {
        look["text"] == "Layout(name: \"Mine\")"
    });
    assert_eq!(browser.evaluate(chosen), "", "it is one of the person");
}

#[test]
fn a_dropped_recording_types_on_its_layout() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (_server, address) = serve(&page);
    open(&mut browser, &address);
    browser.evaluate("document.getElementById('gallery-list').value = 'numpad'; document.getElementById('gallery-list').dispatchEvent(new Event('change'))");
    browser.wait_for(LOOK, "another layout", |look| look["layout"] == "Numpad");
    let recordings = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings");
    let recording = std::fs::read(recordings.join("hc11.mcap")).expect("a recording");
    let cut = &recording[..recording.len() / 2];
    drop_file(&mut browser, "cut.mcap", cut);
    browser.wait_for(LOOK, "the first half", |look| {
        let notice = look["notice"].as_str().unwrap_or_default();
        notice.contains("the rest cannot be read: the file ends")
    });
    drop_file(&mut browser, "mine.mcap", b"nothing");
    browser.wait_for(LOOK, "a reason", |look| {
        let notice = look["notice"].as_str().unwrap_or_default();
        notice.contains("it is not an MCAP file")
    });
    drop_file(&mut browser, "hands.mcap", &recording);
    browser.wait_for(LOOK, "the text of the recording", |look| {
        let typed = look["typed"].as_str().unwrap_or_default();
        typed.ends_with("hi") && look["layout"] == "QWERTY, 19 mm"
    });
}
