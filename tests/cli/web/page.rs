//! The page itself.

use serde_json::{Value, json};

use super::browser_and_server;
use super::files::drop_file;
use crate::browser::Browser;
use crate::run;

/// The state of the page.
const LOOK: &str = r##"({
  ready: document.documentElement.dataset.ready ?? "",
  typed: document.getElementById("typed")?.value,
  state: document.getElementById("state")?.textContent,
  layout: document.getElementById("layout")?.textContent,
  latency: document.getElementById("latency")?.textContent,
  faults: document.getElementById("faults")?.textContent,
  wrong: [...document.querySelectorAll("#gutter .is-wrong")].map((it) => Number(it.textContent)),
  notice: document.getElementById("notice")?.textContent,
  keys: document.querySelectorAll("#plan .plan-key").length,
  text: document.getElementById("editor")?.value,
  overflow: document.documentElement.scrollWidth - innerWidth,
})"##;

/// Opens the page and waits until it runs.
pub fn open(browser: &mut Browser, url: &str) {
    browser.call("Page.navigate", json!({ "url": url }));
    browser.wait_for(LOOK, "the page runs", |look| {
        look["ready"] == "true" && look["layout"] != "" && look["keys"].as_u64() > Some(10)
    });
}

fn is_typed(browser: &mut Browser, text: &str) {
    browser.wait_for(LOOK, "the text is typed", |look| look["typed"] == text);
}

/// Sends an event of the mouse to a point of the page.
fn mouse(browser: &mut Browser, kind: &str, at: [f64; 2]) {
    let buttons = u32::from(kind != "mouseReleased");
    let event = json!({"type": kind, "x": at[0], "y": at[1], "button": "left", "buttons": buttons, "clickCount": 1});
    browser.call("Input.dispatchMouseEvent", event);
}

/// Returns the point at which an expression is.
fn point(browser: &mut Browser, expression: &str) -> [f64; 2] {
    let point = browser.evaluate(expression);
    [0, 1].map(|axis| point[axis].as_f64().expect("a point"))
}

/// Replaces the text of the editor as a person does.
pub fn edit(browser: &mut Browser, expression: &str) {
    browser.evaluate(&format!(
        "(() => {{ const it = document.getElementById('editor'); it.value = {expression}; it.dispatchEvent(new Event('input')); }})()"
    ));
}

/// The key of the plan that is dragged.
const ENTER: &str = "document.querySelector('#plan [data-name=\"Enter\"]')";

/// Returns the middle of this key on the screen.
fn middle_of_enter(browser: &mut Browser) -> [f64; 2] {
    let middle = format!(
        "({ENTER}.scrollIntoView({{block: 'center'}}), (({{x, y, width, height}}) => [x + width / 2, y + height / 2])({ENTER}.getBoundingClientRect()))"
    );
    point(browser, &middle)
}

/// Drags a key by 20 pixels: only its numbers change. Takes it back at the end.
fn drag_enter(browser: &mut Browser, before: &Value) {
    let at = middle_of_enter(browser);
    mouse(browser, "mousePressed", at);
    mouse(browser, "mouseMoved", [at[0] + 10.0, at[1] + 5.0]);
    mouse(browser, "mouseMoved", [at[0] + 20.0, at[1] + 5.0]);
    mouse(browser, "mouseReleased", [at[0] + 20.0, at[1] + 5.0]);
    let moved = browser.wait_for(LOOK, "a key is moved", |look| {
        look["text"] != before["text"]
    });
    let lines = |look: &Value| -> Vec<String> {
        let text = look["text"].as_str().expect("a text");
        text.lines().map(str::to_owned).collect()
    };
    let (old, new) = (lines(before), lines(&moved));
    let changed = old.iter().zip(&new).filter(|(old, new)| old != new);
    let changed: Vec<_> = changed.collect();
    assert_eq!((changed.len(), old.len()), (1, new.len()), "{changed:?}");
    assert!(changed[0].1.contains("Enter"), "{changed:?}");
    assert_eq!(
        (&moved["faults"], &moved["keys"]),
        (&json!(""), &before["keys"])
    );
    browser.evaluate("document.getElementById('undo').click()");
    browser.wait_for(LOOK, "undone", |look| look["text"] == before["text"]);
}

/// Presses keys with the mouse as a fingertip.
fn press_with_the_mouse(browser: &mut Browser) {
    browser.evaluate("document.getElementById('clear').click()");
    let on_screen = |key: &str| {
        format!(
            r#"(async () => {{
                const [{{ camera }}, {{ session }}, {{ move }}] = await Promise.all(["/camera.js", "/session.js", "/vectors.js"].map((it) => import(it)));
                const target = session.layout.boards[0].targets.find((it) => it.label === "{key}");
                const [x, y] = camera.project(move(session.boards[0], target.pose));
                const box = document.getElementById("view").getBoundingClientRect();
                return [box.left + x, box.top + y];
            }})()"#
        )
    };
    for (key, typed) in [("Q", "q"), ("M", "qm")] {
        let at = point(browser, &on_screen(key));
        mouse(browser, "mousePressed", at);
        is_typed(browser, typed);
        mouse(browser, "mouseReleased", at);
    }
    // The button comes up over another tab, and then the mouse comes back.
    browser.evaluate("document.getElementById('view').addEventListener('pointerdown', (it) => { globalThis.pointer = it.pointerId; })");
    let at = point(browser, &on_screen("P"));
    mouse(browser, "mousePressed", at);
    is_typed(browser, "qmp");
    browser.evaluate("document.getElementById('view').dispatchEvent(new PointerEvent('pointermove', { pointerId: globalThis.pointer, pointerType: 'mouse' }))");
    let keys = "({keys: document.querySelectorAll('#keys kbd').length})";
    browser.wait_for(keys, "the key comes up", |look| look["keys"] == 0);
    mouse(browser, "mouseReleased", at);
}

#[test]
fn chromium_types_edits_and_drags_on_the_page_and_asks_no_other_server() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    browser.call("Network.enable", json!({}));
    open(&mut browser, &address);
    browser.evaluate("document.getElementById('type').click()");
    is_typed(&mut browser, "hello");

    // A fault is shown at its line, and the board stays.
    let before = browser.evaluate(LOOK);
    edit(&mut browser, "it.value.replace('keys:', 'kyes:')");
    let broken = browser.wait_for(LOOK, "a fault", |look| look["wrong"] != json!([]));
    let text = broken["text"].as_str().expect("a text");
    let line = 1 + text[..text.find("kyes").expect("it is there")]
        .matches('\n')
        .count();
    assert_eq!(broken["wrong"], json!([line]));
    assert!(
        broken["faults"]
            .as_str()
            .expect("a text")
            .contains("`kyes`"),
        "{broken}"
    );
    assert_eq!(broken["keys"], before["keys"]);
    browser.evaluate("document.getElementById('type').click()");
    is_typed(&mut browser, "hellohello");
    edit(&mut browser, "it.value.replace('kyes:', 'keys:')");
    browser.wait_for(LOOK, "no fault", |look| {
        look["faults"] == "" && look["wrong"] == json!([])
    });

    drag_enter(&mut browser, &before);

    // A key of a row becomes a single one, and keeps the focus.
    browser.evaluate("document.querySelector('#plan [data-name=\"G\"]').focus()");
    let up = json!({"type": "keyDown", "key": "ArrowUp", "code": "ArrowUp"});
    browser.call("Input.dispatchKeyEvent", up);
    let moved = browser.wait_for(LOOK, "a key is moved by a key", |look| {
        look["text"] != before["text"]
    });
    assert!(
        moved["text"]
            .as_str()
            .is_some_and(|it| it.contains("code: \"G\"")),
        "{moved}"
    );
    assert_eq!(moved["faults"], "");
    assert_eq!(browser.evaluate("document.activeElement.dataset.name"), "G");

    press_with_the_mouse(&mut browser);

    let urls: Vec<String> = browser
        .events
        .iter()
        .filter(|it| it["method"] == "Network.requestWillBeSent")
        .map(|it| {
            it["params"]["request"]["url"]
                .as_str()
                .unwrap_or_default()
                .to_owned()
        })
        .collect();
    assert!(urls.len() > 10, "{urls:?}");
    let foreign: Vec<_> = urls
        .iter()
        .filter(|url| !url.starts_with(&address) && !url.starts_with("data:"))
        .collect();
    assert_eq!(foreign, [""; 0], "requests to other servers");
}

#[test]
fn a_link_of_the_page_and_one_of_the_program_carry_a_layout() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    edit(
        &mut browser,
        "it.value.replace('name: \"', 'name: \"Mine, é, ')",
    );
    browser.wait_for(LOOK, "the edited layout", |look| {
        look["layout"]
            .as_str()
            .is_some_and(|name| name.starts_with("Mine"))
    });
    browser.evaluate("document.getElementById('share').click()");
    browser.wait_for("({hash: location.hash})", "a link", |look| {
        look["hash"]
            .as_str()
            .is_some_and(|hash| hash.starts_with("#layout="))
    });
    let link = browser.evaluate("location.href");
    let link = link.as_str().expect("a text");
    let home = tempfile::tempdir().expect("a folder");
    let mut shown = crate::ademan(["layout", "show", link]);
    shown.env("XDG_STATE_HOME", home.path());
    crate::run_to_end(&mut shown).reported("`Mine, é, QWERTY");

    let shared = run(["layout", "share", "numpad", "--page", &address]).out;
    browser.call("Page.navigate", json!({"url": "about:blank"}));
    browser.call("Page.navigate", json!({"url": shared.trim()}));
    let look = browser.wait_for(LOOK, "the shared layout", |look| {
        look["ready"] == "true" && look["text"].as_str().is_some_and(|it| !it.is_empty())
    });
    let numpad = run(["layout", "new", "-", "--from", "numpad"]).out;
    let same = |text: &str| text.lines().skip(4).collect::<Vec<_>>().join("\n");
    assert_eq!(same(look["text"].as_str().expect("a text")), same(&numpad));

    let good = browser.evaluate("location.hash");
    let good = good.as_str().expect("a text");
    let cut = format!("{good}.");
    let escaped = format!("{good}%3D");
    for damaged in ["#layout=AAAA", "#layout=!!!!", &cut, &escaped] {
        for (fragment, notice) in [(damaged, "is damaged"), (good, "comes from the link")] {
            browser.evaluate(&format!("location.hash = {}", json!(fragment)));
            browser.wait_for(LOOK, fragment, |seen| {
                seen["notice"]
                    .as_str()
                    .is_some_and(|it| it.contains(notice))
            });
        }
    }
    browser.evaluate("location.hash = ''");
    browser.wait_for(LOOK, "no link", |seen| seen["notice"] == "");
    let kept = browser.evaluate(LOOK);
    assert_eq!(kept["text"], look["text"]);
}

/// Returns `true` if the browser would ask the person before it closes the page.
fn asks_before_it_closes(browser: &mut Browser) -> bool {
    let leave = "!dispatchEvent(new Event('beforeunload', { cancelable: true }))";
    browser.evaluate(leave) == true
}

#[test]
fn the_page_asks_before_it_drops_a_changed_layout() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    assert!(
        !asks_before_it_closes(&mut browser),
        "it is as it was opened"
    );
    let add_line = "it.value + '// mine\\n'";
    edit(&mut browser, add_line);
    assert!(asks_before_it_closes(&mut browser), "a change of the text");
    browser.evaluate("document.getElementById('save').click()");
    assert!(!asks_before_it_closes(&mut browser), "it is saved");
    let up = json!({"type": "keyDown", "key": "ArrowUp", "code": "ArrowUp"});
    let before = browser.evaluate(LOOK);
    browser.evaluate("document.querySelector('#plan [data-name=\"G\"]').focus()");
    browser.call("Input.dispatchKeyEvent", up);
    browser.wait_for(LOOK, "a key is moved", |look| {
        look["text"] != before["text"]
    });
    assert!(asks_before_it_closes(&mut browser), "a change of the plan");
    browser.evaluate("document.getElementById('share').click()");
    browser.wait_for("({hash: location.hash})", "a link", |look| {
        look["hash"]
            .as_str()
            .is_some_and(|hash| hash.starts_with("#layout="))
    });
    assert!(!asks_before_it_closes(&mut browser), "it is in the link");
}

#[test]
fn undo_takes_back_what_was_written_before_the_change_of_the_plan_and_leaves_the_first_text() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    let text = |page: &mut Browser| page.evaluate("document.getElementById('editor').value");
    let undo = "document.getElementById('undo').click()";
    let first = text(&mut browser);
    browser.evaluate(undo);
    assert_eq!(text(&mut browser), first, "there is nothing to undo");
    browser.evaluate("document.querySelector('#plan [data-name=\"G\"]').focus()");
    let up = json!({"type": "keyDown", "key": "ArrowUp", "code": "ArrowUp"});
    browser.call("Input.dispatchKeyEvent", up);
    let moved = browser.wait_for(LOOK, "a key is moved", |look| look["text"] != first);
    edit(&mut browser, "it.value + '// mine\\n'");
    browser.evaluate(undo);
    assert_eq!(text(&mut browser), moved["text"], "the line is taken back");
    browser.evaluate(undo);
    assert_eq!(text(&mut browser), first, "the key is moved back");
    browser.evaluate(undo);
    assert_eq!(text(&mut browser), first, "there is nothing more to undo");
    drop_file(&mut browser, "a.ron", b"Layout(name: \"Mine\")\r\n");
    browser.wait_for(LOOK, "a file with other line ends", |look| {
        look["text"] == "Layout(name: \"Mine\")\n"
    });
    browser.evaluate(undo);
    assert_eq!(text(&mut browser), first, "the layout before the file");
}

#[test]
fn the_page_opens_without_a_server_after_the_first_visit() {
    let Some((mut browser, server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    let controlled = "({controlled: Boolean(navigator.serviceWorker.controller)})";
    browser.wait_for(controlled, "the files are kept", |look| {
        look["controlled"] == true
    });
    // What a person has asked for once is kept, too.
    let asked = r#"(async () => {
        const files = ["full.js", "full.wasm", "words.js", "recordings.js", "score.wasm", "en.adm"];
        const answers = await Promise.all(files.map((it) => fetch(it).then((answer) => answer.arrayBuffer()).catch(() => null)));
        return files.filter((_, index) => !answers[index]);
    })()"#;
    assert_eq!(browser.evaluate(asked), json!([]));
    drop(server);
    browser.call("Page.navigate", json!({"url": "about:blank"}));
    open(&mut browser, &address);
    browser.evaluate("document.getElementById('type').click()");
    is_typed(&mut browser, "hello");
    assert_eq!(browser.evaluate(asked), json!([]), "without a server");
    let deferred = browser.evaluate(
        r#"(async () => {
            const loaded = performance.getEntriesByType("resource").map((it) => new URL(it.name).pathname);
            const early = loaded.filter((it) => it === "/headset.js" || it === "/layout.schema.json");
            const {offer} = await import("/headset.js");
            return {early, offer: typeof offer, schema: (await fetch("layout.schema.json")).ok};
        })()"#,
    );
    assert_eq!(
        deferred,
        json!({"early": [], "offer": "function", "schema": true}),
        "loaded when it is used, and kept for then"
    );
}

#[test]
fn the_page_runs_in_a_browser_that_keeps_nothing_of_sites() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    browser.call("Page.enable", json!({}));
    let blocked = "Object.defineProperty(window, 'sessionStorage', { get() { throw new DOMException('blocked', 'SecurityError'); } })";
    browser.call(
        "Page.addScriptToEvaluateOnNewDocument",
        json!({ "source": blocked }),
    );
    open(&mut browser, &address);
    browser.evaluate("document.getElementById('type').click()");
    is_typed(&mut browser, "hello");
}

#[test]
fn a_page_whose_module_cannot_be_loaded_says_why() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    browser.call("Page.enable", json!({}));
    let refused = "WebAssembly.instantiateStreaming = async () => { throw new Error('refused'); }";
    browser.call(
        "Page.addScriptToEvaluateOnNewDocument",
        json!({ "source": refused }),
    );
    browser.call("Page.navigate", json!({ "url": address }));
    browser.wait_for(LOOK, "the reason", |look| {
        look["state"] == "not loaded: refused"
    });
}

#[test]
fn shortcuts_of_the_browser_change_neither_the_plan_nor_the_view() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    let before = browser.evaluate(LOOK);
    // Each returns true if the browser continues with the key.
    let press = |page: &mut Browser, at: &str, keys: &str| {
        page.evaluate(&format!(
            "document.querySelector('{at}').dispatchEvent(new KeyboardEvent('keydown', {{ bubbles: true, cancelable: true, {keys} }}))"
        ))
    };
    let plan_key = "#plan [data-name=G]";
    for keys in ["key: 'd', ctrlKey: true", "key: 'ArrowLeft', altKey: true"] {
        assert_eq!(press(&mut browser, plan_key, keys), true, "{keys}");
    }
    for keys in ["key: '+', ctrlKey: true", "key: '0', metaKey: true"] {
        assert_eq!(press(&mut browser, "#view", keys), true, "{keys}");
    }
    assert_eq!(browser.evaluate(LOOK)["text"], before["text"]);
    assert_eq!(press(&mut browser, "#view", "key: '+'"), false);
    let capital = "key: 'D', shiftKey: true";
    assert_eq!(press(&mut browser, plan_key, capital), false);
    browser.wait_for(LOOK, "a copy", |look| look["text"] != before["text"]);
}

#[test]
fn a_drag_on_the_plan_whose_button_came_up_over_another_tab_is_cancelled() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    open(&mut browser, &address);
    browser.evaluate(&format!(
        "{{ globalThis.dragged = {ENTER}; globalThis.dragged.addEventListener('pointerdown', (it) => {{ globalThis.pointer = it.pointerId; }}); }}"
    ));
    let state = "[dragged.isConnected, ...['class', 'transform'].map((it) => dragged.getAttribute(it)), document.getElementById('editor').value]";
    let at = middle_of_enter(&mut browser);
    let before = browser.evaluate(state);
    assert_eq!(before[0], true);
    mouse(&mut browser, "mousePressed", at);
    mouse(&mut browser, "mouseMoved", [at[0] + 20.0, at[1]]);
    browser.wait_for(state, "it follows the mouse", |seen| seen[2] != before[2]);
    browser.evaluate("dragged.dispatchEvent(new PointerEvent('pointermove', { pointerId: globalThis.pointer, pointerType: 'mouse' })); true");
    // The element is the same one, so that the colors of a score stay.
    assert_eq!(browser.evaluate(state), before);
    mouse(&mut browser, "mouseReleased", at);
    assert_eq!(browser.evaluate(state), before);
}

/// Sets the size of the window and the theme.
pub fn look_like(browser: &mut Browser, width: u32, height: u32, theme: &str) {
    let size =
        json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600});
    browser.call("Emulation.setDeviceMetricsOverride", size);
    let features = json!([{"name": "prefers-color-scheme", "value": theme}]);
    browser.call(
        "Emulation.setEmulatedMedia",
        json!({ "features": features }),
    );
}

#[test]
fn the_page_fits_a_phone_and_a_desk_in_both_themes() {
    let Some((mut browser, _server, address)) = browser_and_server() else {
        return;
    };
    for (width, height) in [(1400, 860), (390, 844)] {
        for theme in ["dark", "light"] {
            look_like(&mut browser, width, height, theme);
            open(&mut browser, &address);
            browser.evaluate("document.getElementById('type').click()");
            let look = browser.wait_for(LOOK, "something is typed", |look| {
                look["typed"].as_str().is_some_and(|it| it.len() >= 3)
            });
            browser.save_picture(&format!("web-{width}-{theme}.png"));
            assert_eq!(look["overflow"], 0, "nothing is wider than {width} pixels");
        }
    }
    // Every control has a name for a screen reader.
    let unnamed = browser.evaluate(
        r#"[...document.querySelectorAll("button, input, select, textarea, [role=button]")]
            .filter((it) => !(it.labels?.length || it.textContent.trim() || it.getAttribute("aria-label") || it.getAttribute("aria-labelledby")))
            .map((it) => it.id || it.outerHTML)"#,
    );
    assert_eq!(unnamed, Value::Array(Vec::new()));
}
