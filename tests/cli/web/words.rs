//! Words that the page corrects and suggests.

use std::fs;
use std::path::Path;

use serde_json::json;
use tempfile::TempDir;

use super::page::{edit, open};
use super::{browser_and_server, copy_of, folder, serve};
use crate::browser::Browser;

const LOOK: &str = r##"({
  typed: document.getElementById("typed").value,
  words: [...document.querySelectorAll("#candidates button")].map((it) => it.textContent),
  row: document.getElementById("candidates").textContent,
  isHidden: document.getElementById("candidates").hidden,
  notice: document.getElementById("notice").textContent,
  layout: document.getElementById("layout").textContent,
  chosen: document.getElementById("words").value,
})"##;

/// Chooses a value of a list as a person does.
fn select(browser: &mut Browser, list: &str, value: &str) {
    browser.evaluate(&format!(
        "(() => {{ const it = document.getElementById({list:?}); it.value = {value:?}; it.dispatchEvent(new Event('change')); }})()"
    ));
}

/// Chooses what is done with words, and waits until the decoder is there.
fn choose(browser: &mut Browser, choice: &str) {
    select(browser, "words", choice);
    browser.wait_for(LOOK, "the row of words", |look| {
        (look["isHidden"] == true) == choice.is_empty()
    });
}

fn type_text(browser: &mut Browser, text: &str) {
    browser.evaluate(&format!(
        "document.getElementById('clear').click(); document.getElementById('text-to-type').value = {text:?}; document.getElementById('type').click()"
    ));
}

#[test]
fn words_are_corrected_and_a_click_takes_one() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    browser.call("Network.enable", json!({}));
    open(&mut browser, &address);
    let loaded = |page: &Browser| {
        let requests = page.requests();
        let of_words = requests.iter().filter_map(|it| it.rsplit('/').next());
        of_words
            .filter(|name| {
                name.starts_with("words.") || name.starts_with("full.") || name.ends_with(".adm")
            })
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(loaded(&browser), [""; 0]);

    // A layout with faults leaves the previous layout active.
    edit(&mut browser, "it.value + ')'");
    choose(&mut browser, "auto en");
    assert_eq!(
        loaded(&browser),
        ["words.js", "full.js", "full.wasm", "en.adm"]
    );
    edit(&mut browser, "it.value.slice(0, -1)");
    type_text(&mut browser, "thw quicl ");
    let is_corrected = |look: &serde_json::Value| look["typed"] == "the quick ";
    browser.wait_for(LOOK, "the words are corrected", is_corrected);

    choose(&mut browser, "suggest en");
    type_text(&mut browser, "quicl");
    let look = browser.wait_for(LOOK, "candidates", |look| {
        let words = look["words"].as_array();
        look["typed"] == "quicl" && words.is_some_and(|words| words.iter().any(|it| it == "quick"))
    });
    browser.save_picture("words.png");
    assert_eq!(look["chosen"], "suggest en");
    browser.evaluate(
        "{
            const quick = [...document.querySelectorAll('#candidates button')].find((it) => it.textContent === 'quick');
            globalThis.taken = quick;
            quick.focus();
            quick.click();
            true;
        }",
    );
    browser.wait_for(LOOK, "the candidate is taken", |seen| {
        seen["typed"] == "quick "
    });
    let focus = "({isGone: !taken.isConnected, isKept: document.getElementById('candidates').contains(document.activeElement)})";
    browser.wait_for(focus, "the row keeps the focus", |seen| {
        seen["isGone"] == true && seen["isKept"] == true
    });

    select(&mut browser, "gallery-list", "chords-bend");
    browser.wait_for(LOOK, "no letters", |seen| {
        seen["row"]
            .as_str()
            .is_some_and(|row| row.contains("too few letters"))
    });
    choose(&mut browser, "");
    assert_eq!(browser.evaluate(LOOK)["notice"], "");
}

#[test]
fn what_was_typed_stays_when_words_are_corrected_from_then_on() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    type_text(&mut browser, "hello ");
    browser.wait_for(LOOK, "a text", |look| look["typed"] == "hello ");
    choose(&mut browser, "auto en");
    browser.evaluate(
        "document.getElementById('text-to-type').value = 'thw '; document.getElementById('type').click()",
    );
    browser.wait_for(LOOK, "both", |look| look["typed"] == "hello the ");
    browser.evaluate("document.getElementById('clear').click()");
    browser.wait_for(LOOK, "nothing", |look| look["typed"] == "");
}

#[test]
fn a_choice_that_is_taken_back_while_its_language_is_loaded_corrects_nothing() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    browser.evaluate(
        "{
            const load = globalThis.fetch;
            globalThis.fetch = async (file) => {
                if (file !== 'en.adm') return load(file);
                await new Promise((done) => { globalThis.goOn = done; });
                const bytes = await (await load(file)).arrayBuffer();
                const read = async () => { globalThis.isRead = true; return bytes; };
                return { ok: true, arrayBuffer: read };
            };
            true;
        }",
    );
    select(&mut browser, "words", "auto en");
    let waits = "({waits: Boolean(globalThis.goOn), isRead: Boolean(globalThis.isRead)})";
    browser.wait_for(waits, "the language is loaded", |look| {
        look["waits"] == true
    });
    select(&mut browser, "words", "");
    browser.evaluate("globalThis.goOn()");
    browser.wait_for(waits, "it has arrived", |look| look["isRead"] == true);
    type_text(&mut browser, "thw ");
    let look = browser.wait_for(LOOK, "the text", |seen| seen["typed"] == "thw ");
    assert_eq!(
        (&look["isHidden"], &look["chosen"]),
        (&json!(true), &json!(""))
    );
}

#[test]
fn a_page_that_is_loaded_again_says_that_nothing_is_corrected() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    choose(&mut browser, "suggest en");
    select(&mut browser, "person", "left-small");
    browser.evaluate("globalThis.isOld = true");
    browser.call("Page.reload", json!({}));
    let chosen = "({
        ready: !globalThis.isOld && document.documentElement.dataset.ready === 'true',
        chosen: ['words', 'person'].map((id) => document.getElementById(id)?.value),
    })";
    let look = browser.wait_for(chosen, "the page runs again", |look| look["ready"] == true);
    assert_eq!(look["chosen"], json!(["", ""]));
}

/// Returns a copy of the page in which a file is missing.
fn without(page: &Path, missing: &str) -> TempDir {
    let folder = copy_of(page);
    fs::remove_file(folder.path().join(missing)).expect("it was there");
    folder
}

#[test]
fn words_without_their_code_are_a_message() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = without(&page, "words.js");
    let (_server, address) = serve(folder.path());
    open(&mut browser, &address);
    select(&mut browser, "words", "auto en");
    let look = browser.wait_for(LOOK, "a message", |look| look["notice"] != "");
    let notice = look["notice"].as_str().expect("a text");
    assert!(
        notice.starts_with("words are not corrected: Failed to fetch"),
        "{notice}"
    );
    assert_eq!(look["chosen"], "");
}

#[test]
fn a_decoder_that_cannot_be_loaded_is_a_message_and_keys_type_on() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = without(&page, "en.adm");
    let (_server, address) = serve(folder.path());
    open(&mut browser, &address);
    select(&mut browser, "words", "auto en");
    let look = browser.wait_for(LOOK, "a message", |look| look["notice"] != "");
    assert_eq!(look["notice"], "words are not corrected: en.adm: 404");
    assert_eq!(look["chosen"], "");
    type_text(&mut browser, "thw ");
    browser.wait_for(LOOK, "the text", |seen| seen["typed"] == "thw ");
}

#[test]
fn a_language_that_cannot_be_loaded_ends_the_corrections_in_another_one() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = without(&page, "es.adm");
    let (_server, address) = serve(folder.path());
    open(&mut browser, &address);
    choose(&mut browser, "auto en");
    select(&mut browser, "words", "auto es");
    let look = browser.wait_for(LOOK, "a message", |look| look["notice"] != "");
    assert_eq!(look["notice"], "words are not corrected: es.adm: 404");
    assert_eq!(look["chosen"], "");
    type_text(&mut browser, "thw thw ");
    let typed = browser.wait_for(LOOK, "the text", |seen| seen["typed"] == "thw thw ");
    assert_eq!(typed["isHidden"], true);
}
