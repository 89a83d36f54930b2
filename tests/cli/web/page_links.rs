//! Links of the page.

use serde_json::json;

use super::browser_and_server;
use super::page::{edit, open};

/// The layout in the page, and what the page says of it.
const LOOK: &str = r##"({
  ready: document.documentElement.dataset.ready ?? "",
  hash: location.hash,
  text: document.getElementById("editor")?.value,
  layout: document.getElementById("layout")?.textContent,
  faults: document.getElementById("faults")?.textContent,
  notice: document.getElementById("notice")?.textContent,
})"##;

#[test]
fn a_link_to_a_layout_with_faults_opens_with_its_text_and_one_that_is_too_large_is_refused() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    edit(&mut browser, "it.value.replace('keys:', 'kyes:')");
    let share = "document.getElementById('share').click()";
    browser.evaluate(share);
    browser.wait_for(LOOK, "a link", |look| {
        let hash = look["hash"].as_str();
        hash.is_some_and(|it| it.starts_with("#layout="))
    });
    let link = browser.evaluate("location.href");
    browser.call("Page.navigate", json!({"url": "about:blank"}));
    browser.call("Page.navigate", json!({ "url": link }));
    let look = browser.wait_for(LOOK, "the shared layout", |seen| {
        seen["ready"] == "true" && seen["layout"] != ""
    });
    let has = |part: &str, text: &str| look[part].as_str().is_some_and(|it| it.contains(text));
    assert!(has("text", "kyes:") && has("faults", "`kyes`"), "{look}");

    edit(&mut browser, "it.value + ' '.repeat(1 << 20)");
    browser.evaluate(share);
    browser.wait_for(LOOK, "no link", |seen| {
        let notice = seen["notice"].as_str();
        notice.is_some_and(|it| it.contains("larger than 1 MiB"))
    });
    assert_eq!(browser.evaluate("location.href"), link);
}
