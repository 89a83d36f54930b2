//! A newer version of the page.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::page::open;
use super::{copy_of, folder, serve, serve_at};
use crate::browser::Browser;

const LOOK: &str = r##"({
  title: document.title,
  ready: document.documentElement.dataset.ready ?? "",
  notice: document.getElementById("notice")?.textContent,
})"##;

const CONTROLLED: &str = "({controlled: Boolean(navigator.serviceWorker.controller)})";

/// Waits for a version beside the one of the page.
const WAITING: &str = r"(async () => {
    const registration = await navigator.serviceWorker.getRegistration();
    await registration.update().catch(() => {});
    return { isWaiting: Boolean(registration.waiting) };
})()";

/// The names that a module which is loaded on demand exports.
const EXPORTS: &str = "import('/headset-sound.js').then((it) => Object.keys(it))";

/// Replaces the first of a part in a file of the page.
fn change(page: &Path, file: &str, from: &str, to: &str) {
    let path = page.join(file);
    let text = fs::read_to_string(&path).expect("a text");
    assert!(text.contains(from), "{file} has {from}");
    fs::write(&path, text.replacen(from, to, 1)).expect("a file");
}

/// Makes another version of the page, in which a title and a module differ.
fn publish(page: &Path) {
    change(page, "offline.js", "\"ademan-", "\"ademan-newer-");
    change(page, "index.html", "<title>Ademán", "<title>Newer");
    let added = "export const added = 1;\nexport ";
    change(page, "headset-sound.js", "export ", added);
}

#[test]
fn an_open_page_keeps_its_version_and_the_next_load_has_the_newer_one() {
    let Some(built) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let page = copy_of(&built);
    let (server, address) = serve(page.path());
    open(&mut browser, &address);
    browser.wait_for(CONTROLLED, "the files are kept", |look| {
        look["controlled"] == true
    });
    drop(server);
    publish(page.path());
    let (_, port) = address
        .trim_end_matches('/')
        .rsplit_once(':')
        .expect("a port");
    let (_server, same) = serve_at(page.path(), port);
    assert_eq!(same, address);
    browser.wait_for(WAITING, "the newer version waits", |look| {
        look["isWaiting"] == true
    });

    // The old page has its own files, and none of the newer version.
    let exports = browser.evaluate(EXPORTS);
    let exports = exports.as_array().expect("a list");
    assert!(
        !exports.is_empty() && !exports.contains(&json!("added")),
        "{exports:?}"
    );
    let refused = browser.evaluate("fetch('words.js').then(() => 'loaded', () => 'refused')");
    assert_eq!(refused, "refused");
    let old = browser.wait_for(LOOK, "the page says so", |look| {
        look["notice"]
            .as_str()
            .is_some_and(|it| it.contains("another version"))
    });
    assert_eq!(old["title"], "Ademán");

    browser.call("Page.reload", json!({}));
    browser.wait_for(LOOK, "the newer version", |look| {
        look["title"] == "Newer" && look["ready"] == "true"
    });
    let added = browser.evaluate(EXPORTS);
    assert!(
        added
            .as_array()
            .is_some_and(|it| it.contains(&json!("added"))),
        "{added}"
    );
    assert_eq!(
        browser.evaluate("fetch('words.js').then((it) => it.ok)"),
        true
    );
    let names = browser.evaluate("caches.keys()");
    let is_newer = |name: &Value| {
        name.as_str()
            .is_some_and(|it| it.starts_with("ademan-newer-"))
    };
    let names = names.as_array().expect("a list");
    assert!(!names.is_empty() && names.iter().all(is_newer), "{names:?}");
}

#[test]
fn another_page_beside_this_one_is_not_replaced_by_it() {
    let Some(built) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let page = copy_of(&built);
    let other = "<!doctype html><title>Licence</title>";
    fs::write(page.path().join("licence.html"), other).expect("a file");
    let (_server, address) = serve(page.path());
    open(&mut browser, &address);
    browser.wait_for(CONTROLLED, "the files are kept", |look| {
        look["controlled"] == true
    });
    let url = format!("{address}licence.html");
    browser.call("Page.navigate", json!({ "url": url }));
    browser.wait_for(LOOK, "the other page", |look| look["title"] == "Licence");
}
