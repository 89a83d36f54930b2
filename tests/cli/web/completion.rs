//! Names of the format in the text editor of the page.

use serde_json::{Value, json};

use super::browser_and_server;
use super::page::{edit, open};
use crate::browser::Browser;

/// The state of the list, as a screen reader knows it.
const LOOK: &str = r##"(() => {
  const editor = document.getElementById("editor");
  const active = document.getElementById(editor.getAttribute("aria-activedescendant") ?? "");
  const list = document.getElementById(editor.getAttribute("aria-controls") ?? "");
  return {
    names: [...document.querySelectorAll("#completion [role=option]")].map((it) => it.textContent),
    role: list?.getAttribute("role"),
    active: active?.textContent,
    selected: active?.getAttribute("aria-selected"),
    status: document.getElementById("completion-status").textContent,
    about: document.getElementById("completion-about").textContent,
    is_open: !document.querySelector(".completion").hidden,
    text: editor.value,
    before: editor.value.slice(0, editor.selectionStart),
    focus: document.activeElement.id,
    faults: document.getElementById("faults").textContent,
  };
})()"##;

fn press(browser: &mut Browser, key: &str) {
    for kind in ["rawKeyDown", "keyUp"] {
        let modifiers = u32::from(key == " ") * 2;
        let code = match key {
            "Tab" => 9,
            "Enter" => 13,
            "Escape" => 27,
            " " => 32,
            "ArrowUp" => 38,
            _ => 40,
        };
        let event = json!({"type": kind, "key": key, "code": if key == " " { "Space" } else { key },
            "windowsVirtualKeyCode": code, "modifiers": modifiers});
        browser.call("Input.dispatchKeyEvent", event);
    }
}

fn write(browser: &mut Browser, text: &str) {
    browser.call("Input.insertText", json!({ "text": text }));
}

/// Puts the cursor after a part of the text.
fn go_after(browser: &mut Browser, part: &str) {
    browser.evaluate(&format!(
        "(() => {{ const it = document.getElementById('editor'); it.focus(); const at = it.value.indexOf({part:?}) + {}; it.setSelectionRange(at, at); }})()",
        part.len()
    ));
}

/// Returns `true` if the list has a name.
fn offers(look: &Value, name: &str) -> bool {
    look["names"]
        .as_array()
        .is_some_and(|it| it.iter().any(|it| it == name))
}

#[test]
fn names_are_offered_while_typing_and_accepted_with_a_key() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    let text = "Layout(\n    name: \"A\",\n    boards: [(pose: (anchor: world, ), rows: [(at_mm: (0, 0), keys: \"A B\")])],\n    // an\n)\n";
    edit(&mut browser, &format!("{text:?}"));

    // A field, whose value is offered next. Tab leaves the editor only while no list is open.
    go_after(&mut browser, "anchor: world, ");
    browser.wait_for(
        "fetch('layout.schema.json').then((it) => ({ok: it.ok}))",
        "the schema",
        |it| it["ok"] == true,
    );
    write(&mut browser, "ti");
    let look = browser.wait_for(LOOK, "a list", |look| look["is_open"] == true);
    assert_eq!(look["names"][0], "tilt_deg", "{look}");
    assert_eq!(
        (&look["role"], &look["active"], &look["selected"]),
        (&json!("listbox"), &json!("tilt_deg"), &json!("true"))
    );
    assert!(
        look["status"]
            .as_str()
            .is_some_and(|it| it.contains("Tab or Enter accepts")),
        "{look}"
    );
    assert!(
        look["about"]
            .as_str()
            .is_some_and(|it| it.contains("Elevation")),
        "{look}"
    );
    press(&mut browser, "Tab");
    let completed = browser.evaluate(LOOK);
    assert!(
        completed["before"]
            .as_str()
            .is_some_and(|it| it.ends_with("anchor: world, tilt_deg: ")),
        "{completed}"
    );
    assert_eq!(
        (&completed["focus"], &completed["is_open"]),
        (&json!("editor"), &json!(false))
    );
    write(&mut browser, "20, sc");
    press(&mut browser, "Escape");
    let closed = browser.evaluate(LOOK);
    assert_eq!(
        (&closed["is_open"], &closed["active"]),
        (&json!(false), &Value::Null)
    );
    browser.save_picture("web-completion-closed.png");
    press(&mut browser, "Tab");
    assert_ne!(browser.evaluate(LOOK)["focus"], "editor");

    // A word of an enumeration, chosen with the arrow keys and Enter. Fields that are there are not offered.
    edit(&mut browser, &format!("{text:?}"));
    go_after(&mut browser, "(pose: (");
    press(&mut browser, " ");
    let demanded = browser.wait_for(LOOK, "a list on demand", |seen| seen["is_open"] == true);
    assert!(
        offers(&demanded, "bearing_deg") && !offers(&demanded, "anchor"),
        "{demanded}"
    );
    press(&mut browser, "Escape");
    edit(&mut browser, &format!("{:?}", text.replace("world, ", "")));
    go_after(&mut browser, "anchor: ");
    press(&mut browser, " ");
    let anchors = browser.wait_for(LOOK, "the anchors", |seen| seen["is_open"] == true);
    assert_eq!(
        anchors["names"],
        json!([
            "world", "elbow", "wrist", "start", "other", "shoulder", "head", "hip"
        ])
    );
    press(&mut browser, "ArrowDown");
    press(&mut browser, "ArrowDown");
    press(&mut browser, "ArrowUp");
    assert_eq!(browser.evaluate(LOOK)["active"], "elbow");
    browser.save_picture("web-completion.png");
    press(&mut browser, "Enter");
    let valid = browser.wait_for(LOOK, "a valid layout", |seen| seen["faults"] == "");
    assert!(
        valid["before"]
            .as_str()
            .is_some_and(|it| it.ends_with("anchor: elbow")),
        "{valid}"
    );
}

/// Returns the names at the cursor, which `|` marks, as the page finds them.
fn names(browser: &mut Browser, text: &str) -> Vec<String> {
    let found = browser.evaluate(&format!(
        r#"(async () => {{
            const {{ offersOf }} = await import("/offers.js");
            const schema = await (await fetch("/layout.schema.json")).json();
            const text = {text:?};
            return offersOf(schema)(text.replace("|", ""), text.indexOf("|")).offers.map((it) => it.insert);
        }})()"#
    ));
    let found = found.as_array().expect("a list").iter();
    found
        .map(|it| it.as_str().unwrap_or_default().to_owned())
        .collect()
}

#[test]
fn the_names_are_those_that_may_stand_at_the_cursor() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    for (text, expected) in [
        ("Layout(bo|)", &["boards: "][..]),
        ("(bo|: [])", &["boards"]),
        (
            "Layout(boards: [(shape: |)])",
            &["Flat", "Arc()", "Cylinder()"],
        ),
        ("Layout(boards: [(shape: Arc(|))])", &["radius_mm: "]),
        (
            "Layout(boards: [(shape: Cylinder(radius_mm: 60, |))])",
            &["curved: "],
        ),
        ("Layout(boards: [(gaps: |)])", &["Nearest", "Dead"]),
        ("Layout(boards: [(gaps: De|ad)])", &["Dead"]),
        ("Layout(boards: [(keys: [(latch: One|)])])", &["OneShot"]),
        (
            "Layout(pointer: Pointer(clicks: [(gesture: Pinch(\"in|\"))]))",
            &["\"index\"", "\"ring\""],
        ),
        (
            "Layout(pointer: (clicks: [(gesture: Pinch(mid|))]))",
            &["\"middle\""],
        ),
        // Texts, numbers and comments have no names.
        ("Layout(name: \"bo|\")", &[]),
        ("Layout(boards: [(pitch_mm: 1|)])", &[]),
        ("Layout(/* bo| */)", &[]),
        ("Layout(\n// bo|\n)", &[]),
        ("Layout(boards: [] bo|)", &[]),
        ("Layout(unknown: (bo|))", &[]),
    ] {
        assert_eq!(names(&mut browser, text), expected, "{text}");
    }
}

#[test]
fn names_that_come_late_are_not_shown_to_a_person_who_is_somewhere_else() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    browser.call("Page.enable", json!({}));
    // `arrive` lets the schema arrive.
    let late = r#"{
        const own = fetch;
        globalThis.fetch = async (...of) => {
            const answer = await own(...of);
            if (of[0] !== "layout.schema.json") return answer;
            const schema = await answer.json();
            await new Promise((arrive) => (globalThis.arrive = arrive));
            return { json: async () => schema };
        };
    }"#;
    browser.call(
        "Page.addScriptToEvaluateOnNewDocument",
        json!({ "source": late }),
    );
    open(&mut browser, &address);
    let text = "Layout(\n    name: \"A\",\n    boards: [(pose: (anchor: world))],\n)\n";
    edit(&mut browser, &format!("{text:?}"));
    go_after(&mut browser, "(pose: (");
    press(&mut browser, " ");
    let asked = "({asked: typeof globalThis.arrive})";
    browser.wait_for(asked, "the schema is asked for", |look| {
        look["asked"] == "function"
    });
    browser.evaluate("document.getElementById('text-to-type').focus()");
    browser.evaluate("arrive()");
    assert_eq!(browser.evaluate(LOOK)["is_open"], false);
    go_after(&mut browser, "(pose: (");
    press(&mut browser, " ");
    browser.wait_for(LOOK, "the names on demand", |look| look["is_open"] == true);
}
