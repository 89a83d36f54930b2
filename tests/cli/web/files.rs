//! Files that are dropped onto the page. Motion capture files of other programs are in the folder `ADEMAN_PEERS` (default:
//! `../shared/peers`), which is not part of the project.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::page::open;
use super::{folder, serve};
use crate::browser::Browser;

const LOOK: &str = r##"({
  notice: document.getElementById("notice").textContent,
  text: document.getElementById("editor").value,
})"##;

fn drop_file(browser: &mut Browser, name: &str, text: &str) {
    let (name, text) = (json!(name), json!(text));
    browser.evaluate(&format!(
        "(() => {{ const files = new DataTransfer(); files.items.add(new File([{text}], {name}));
        dispatchEvent(new DragEvent('drop', {{ dataTransfer: files, cancelable: true }})); }})()"
    ));
}

#[test]
fn a_dropped_file_is_played_or_says_why_not() {
    let Some(page) = folder() else { return };
    let peers = std::env::var_os("ADEMAN_PEERS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/peers"),
        PathBuf::from,
    );
    let Ok(dance) = std::fs::read_to_string(peers.join("bvh/rokoko_fingers_dance.bvh")) else {
        println!("SKIPPED: there is no folder {}", peers.display());
        return;
    };
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
            "the file is no motion capture (BVH)",
        ),
    ] {
        drop_file(&mut browser, name, text);
        browser.wait_for(LOOK, "a message", |look| {
            look["notice"]
                .as_str()
                .is_some_and(|it| it.contains(notice))
        });
    }
    drop_file(&mut browser, "mine.ron", "Layout(name: \"Mine\")");
    browser.wait_for(LOOK, "a layout", |look| {
        look["text"] == "Layout(name: \"Mine\")"
    });
}
