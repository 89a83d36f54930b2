//! The page with a keyboard, a screen reader and a finger.

use serde_json::{Value, json};

use super::browser_and_server;
use super::page::{edit, look_like, open};
use crate::browser::Browser;

const FOCUS: &str = "({
  id: document.activeElement.id,
  isKey: document.activeElement.matches('#plan .plan-key'),
  name: document.activeElement.dataset.name,
})";

fn press(browser: &mut Browser, key: &str) {
    let event = json!({"type": "keyDown", "key": key, "code": key});
    browser.call("Input.dispatchKeyEvent", event);
}

#[test]
fn what_disappears_leaves_the_focus_to_what_is_beside_it() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    // The second one is the key “delete” of a Mac.
    for (name, key) in [("G", "Delete"), ("K", "Backspace")] {
        browser.evaluate(&format!(
            "document.querySelector('#plan [data-name=\"{name}\"]').focus()"
        ));
        press(&mut browser, key);
        browser.wait_for(FOCUS, "another key has the focus", |focus| {
            focus["isKey"] == true && focus["name"] != name
        });
    }
    // As after a score.
    browser.evaluate(
        "{
            document.getElementById('score').open = true;
            const clear = document.getElementById('score-clear');
            clear.hidden = false;
            clear.focus();
            clear.click();
            true;
        }",
    );
    assert_eq!(browser.evaluate(FOCUS)["id"], "score-start");
}

/// Returns what is smaller than 24 pixels, the least that WCAG 2.5.8 permits; a box to tick has its label.
const SMALL: &str = r#"[...document.querySelectorAll("button, input:not([type=checkbox]), select, textarea, summary, .check")]
    .map((it) => [it.id || it.textContent, it.getBoundingClientRect()])
    .filter(([, { width, height }]) => width > 0 && (width < 24 || height < 24))
    .map(([name, { width, height }]) => `${name}: ${width} x ${height}`)"#;

/// Returns the texts that are read aloud when they change, but are taken out of the page while they are empty.
const LEFT_OUT: &str = r#"[...document.querySelectorAll("[role=status], [aria-live]")]
    .filter((it) => !it.closest("[hidden]") && getComputedStyle(it).display === "none")
    .map((it) => it.id)"#;

#[test]
fn controls_are_large_enough_and_texts_that_change_are_read_aloud() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    look_like(&mut browser, 390, 844, "dark");
    open(&mut browser, &address);
    browser.evaluate("document.querySelectorAll('details').forEach((it) => { it.open = true; })");
    edit(&mut browser, "it.value.replace('keys:', 'kyes:')");
    let faults = "({count: document.querySelectorAll('#faults button').length})";
    browser.wait_for(faults, "a fault", |look| look["count"].as_u64() > Some(0));
    assert_eq!(browser.evaluate(SMALL), Value::Array(Vec::new()));
    assert_eq!(browser.evaluate(LEFT_OUT), Value::Array(Vec::new()));
    let name = "document.getElementById(document.getElementById('editor').getAttribute('aria-labelledby')).textContent";
    assert_eq!(browser.evaluate(name), "Layout");

    // The same faults are not read again after each letter.
    browser.evaluate("globalThis.shown = document.querySelector('#faults li')");
    edit(&mut browser, "it.value + ' '");
    assert_eq!(browser.evaluate("shown.isConnected"), true);
}

/// Returns the least contrast of the state with the color behind it.
const CONTRAST: &str = r#"(() => {
    const luminance = (color) => color.match(/[\d.]+/g).slice(0, 3)
        .map((it) => it / 255)
        .map((it) => (it <= 0.04045 ? it / 12.92 : ((it + 0.055) / 1.055) ** 2.4))
        .reduce((sum, it, index) => sum + it * [0.2126, 0.7152, 0.0722][index], 0);
    const state = document.createElement("span");
    state.id = "state";
    document.body.prepend(state);
    const contrasts = ["", "running", "stalled"].map((name) => {
        state.className = name;
        const { color, backgroundColor } = getComputedStyle(state);
        const [low, high] = [color, backgroundColor].map(luminance).sort((a, b) => a - b);
        return (high + 0.05) / (low + 0.05);
    });
    state.remove();
    return Math.min(...contrasts);
})()"#;

#[test]
fn the_state_can_be_read_in_both_themes() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    for theme in ["dark", "light"] {
        look_like(&mut browser, 1400, 860, theme);
        open(&mut browser, &address);
        let contrast = browser.evaluate(CONTRAST).as_f64();
        assert!(contrast >= Some(4.5), "{theme}: {contrast:?}");
    }
}
