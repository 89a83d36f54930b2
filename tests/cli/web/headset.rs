//! The page in an emulated headset: iwer, which npm gets.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::page::open;
use super::{folder, serve};
use crate::browser::Browser;

/// The emulator. A later one may emulate otherwise.
const EMULATOR: &str = "iwer@2.5.0";

/// WebGL without a graphics card, in a small window.
const FLAGS: [&str; 4] = [
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--window-size=900,520",
];

/// The speed of the emulated hands: the headset draws some ten pictures in a second on a busy machine.
pub(super) const SPEED: f64 = 0.12;

/// Times that a text is typed: a busy machine may draw too few pictures of a press.
const ATTEMPTS: u32 = 5;

/// The state of the page.
pub(super) const LOOK: &str = r##"(async () => {
  const [{ placement }, { session }] = await Promise.all([import("/headset.js"), import("/session.js")]);
  const boards = placement();
  return {
    ready: document.documentElement.dataset.ready ?? "",
    session: document.getElementById("headset").dataset.session ?? "",
    isOffered: ["enter-vr", "enter-ar"].every((id) => document.getElementById(id).checkVisibility()),
    computer: document.getElementById("computer").textContent,
    notice: document.getElementById("notice").textContent,
    typed: document.getElementById("typed").value,
    layout: document.getElementById("layout").textContent,
    hands: Object.keys(session.hands).sort(),
    keys: session.keys,
    place: boards?.roomFromWorld ?? null,
    board: boards && boards.pose(0),
  };
})()"##;

/// Held while the emulator is installed: tests that install it at the same time take files from each other.
static INSTALLATION: Mutex<()> = Mutex::new(());

/// Returns the script of an emulated headset; `None` if it cannot be had.
fn emulator() -> Option<String> {
    let _one_at_a_time = INSTALLATION.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("iwer");
    let script = folder.join("node_modules/iwer/build/iwer.min.js");
    if !script.is_file() {
        let mut npm = Command::new("npm");
        npm.args([
            "install",
            "--no-audit",
            "--no-fund",
            "--ignore-scripts",
            "--no-save",
        ]);
        npm.arg("--prefix").arg(&folder).arg(EMULATOR);
        let installed = npm.output();
        if !installed.is_ok_and(|output| output.status.success()) {
            println!("SKIPPED: npm cannot get {EMULATOR}");
            return None;
        }
    }
    let script = fs::read_to_string(script).expect("the package has its script");
    Some(script + "\n" + include_str!("emulated_headset.js"))
}

/// Starts a browser with an emulated headset; `None` if there is none.
pub(super) fn browser() -> Option<Browser> {
    let script = emulator()?;
    let mut browser = Browser::start_with(&FLAGS)?;
    browser.call("Page.enable", json!({}));
    let source = json!({ "source": script });
    browser.call("Page.addScriptToEvaluateOnNewDocument", source);
    Some(browser)
}

/// Opens the page and enters a session.
pub(super) fn enter(browser: &mut Browser, url: &str, button: &str) {
    browser.call("Page.navigate", json!({ "url": url }));
    let ready = "({ready: document.documentElement?.dataset.ready ?? \"\"})";
    browser.wait_for(ready, "the page runs", |look| look["ready"] == "true");
    browser.wait_for(LOOK, "a headset is offered", |look| {
        look["isOffered"] == true
    });
    browser.evaluate(&format!("document.getElementById('{button}').click()"));
    browser.wait_for(LOOK, "a session, with boards in the room", |look| {
        look["session"] != "" && look["place"].is_array()
    });
}

pub(super) fn type_with_the_hand(browser: &mut Browser, text: &str) {
    browser.evaluate(&format!("emulated.type('{text}', {SPEED})"));
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Lets the hands go, until the page has released everything.
fn take_hands_away(browser: &mut Browser) {
    browser.evaluate("emulated.hands.left = emulated.hands.right = null");
    browser.wait_for(LOOK, "everything is released", |look| {
        look["keys"] == json!([])
    });
}

/// Waits until a part of the state of the page has a value. Returns `false` if it has not after 3 s, which are many pictures.
fn becomes(browser: &mut Browser, part: &str, expected: &Value) -> bool {
    let start = Instant::now();
    while browser.evaluate(LOOK)[part] != *expected {
        if start.elapsed() > Duration::from_secs(3) {
            return false;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    true
}

fn leave(browser: &mut Browser) {
    browser.evaluate("document.getElementById('enter-vr').click()");
    browser.wait_for(LOOK, "the session has ended", |look| look["session"] == "");
}

#[test]
fn an_emulated_hand_types_in_the_room_and_a_lost_hand_and_the_end_release_its_key() {
    let Some(folder) = folder() else { return };
    let Some(mut browser) = browser() else { return };
    let (_server, address) = serve(&folder);
    browser.call("Network.enable", json!({}));
    enter(&mut browser, &address, "enter-vr");
    // A busy machine may lose the hand for some frames; then it types again.
    let is_typed = (0..ATTEMPTS).any(|_| {
        browser.evaluate("document.getElementById('clear').click()");
        type_with_the_hand(&mut browser, "hi");
        becomes(&mut browser, "typed", &json!("hi"))
    });
    assert!(is_typed, "{}", browser.evaluate(LOOK));
    browser.save_picture("headset-vr.png");

    let press = format!(
        "(async () => {{ const {{ session }} = await import('/session.js'); await emulated.type('q', {SPEED}, () => session.keys.includes('Q')); }})()"
    );
    for is_lost in [true, false] {
        let is_pressed = (0..ATTEMPTS).any(|_| {
            browser.evaluate(&press);
            becomes(&mut browser, "keys", &json!(["Q"]))
        });
        assert!(is_pressed, "{}", browser.evaluate(LOOK));
        if is_lost {
            browser.save_picture("headset-press.png");
            take_hands_away(&mut browser);
        } else {
            leave(&mut browser);
            browser.wait_for(LOOK, "everything is released", |look| {
                look["keys"] == json!([])
            });
        }
    }

    // Passthrough, with both hands.
    browser.evaluate("emulated.hands.left = emulated.hands.right = null");
    browser.evaluate("document.getElementById('enter-ar').click()");
    browser.wait_for(LOOK, "a session with passthrough", |look| {
        look["session"] == "alpha-blend" && look["place"].is_array()
    });
    browser.evaluate("emulated.hands.left = emulated.flat([-0.2, 1.25, -0.2], 'left'); emulated.hands.right = emulated.flat([0.2, 1.2, -0.2], 'right')");
    browser.wait_for(LOOK, "both hands", |look| {
        look["hands"] == json!(["left", "right"])
    });
    browser.save_picture("headset-ar.png");

    let urls = browser.requests();
    assert!(urls.len() > 10, "{urls:?}");
    let foreign = urls.iter().filter(|url| {
        let is_own = |start: &&str| url.starts_with(*start);
        ![address.as_str(), "data:"].iter().any(is_own)
    });
    assert_eq!(
        foreign.collect::<Vec<_>>(),
        [""; 0],
        "requests to other servers"
    );
}

#[test]
fn a_session_that_cannot_be_drawn_is_ended_and_another_one_begins() {
    let Some(folder) = folder() else { return };
    let Some(mut browser) = browser() else { return };
    let (_server, address) = serve(&folder);
    open(&mut browser, &address);
    browser.wait_for(LOOK, "a headset is offered", |look| {
        look["isOffered"] == true
    });
    browser.evaluate(
        "{
            const own = HTMLCanvasElement.prototype.getContext;
            globalThis.mend = () => { HTMLCanvasElement.prototype.getContext = own; };
            HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
                return kind === 'webgl2' ? null : own.call(this, kind, ...rest);
            };
            true;
        }",
    );
    let enter_vr = "document.getElementById('enter-vr').click()";
    browser.evaluate(enter_vr);
    browser.wait_for(LOOK, "a reason", |look| {
        let notice = look["notice"].as_str().unwrap_or_default();
        notice.contains("it has no WebGL 2")
    });
    browser.evaluate(&format!("globalThis.mend(); {enter_vr}"));
    browser.wait_for(LOOK, "a session, with boards in the room", |look| {
        look["session"] != "" && look["place"].is_array()
    });
}

#[test]
fn boards_are_moved_by_their_edge_and_laid_on_a_table_below_flat_hands() {
    let Some(folder) = folder() else { return };
    let Some(mut browser) = browser() else { return };
    let (_server, address) = serve(&folder);
    enter(&mut browser, &address, "enter-vr");
    // The near edge of the board, beside the keys.
    let at_edge = |page: &mut Browser, apart: f64, by: [f64; 3]| {
        page.evaluate(&format!(
            r#"(async () => {{
                const [{{ placement }}, {{ move }}, {{ session }}] = await Promise.all(["/headset.js", "/vectors.js", "/session.js"].map((it) => import(it)));
                const low = Math.min(...session.layout.boards[0].targets.map((it) => it.pose[1] - it.half_m[1]));
                window.edge ??= move(placement().pose(0), [0, low - 0.02, 0]);
                emulated.hands.right = emulated.pinching(edge.map((axis, index) => axis + [{}, {}, {}][index]), "right", {apart});
            }})()"#,
            by[0], by[1], by[2]
        ));
    };
    let before = browser.evaluate(LOOK);
    at_edge(&mut browser, 0.05, [0.0; 3]);
    browser.wait_for(LOOK, "a hand", |look| look["hands"] == json!(["right"]));
    at_edge(&mut browser, 0.01, [0.0; 3]);
    let gripped =
        "(async () => ({isGripped: Boolean((await import('/headset.js')).placement().grip)}))()";
    browser.wait_for(gripped, "the board is gripped", |look| {
        look["isGripped"] == true
    });
    at_edge(&mut browser, 0.01, [0.1, 0.05, -0.02]);
    let moved = browser.wait_for(LOOK, "the board has moved", |look| {
        let by = |axis: usize| number(&look["board"][axis]) - number(&before["board"][axis]);
        [0.1, 0.05, -0.02]
            .iter()
            .enumerate()
            .all(|(axis, expected)| (by(axis) - expected).abs() < 1e-3)
    });
    at_edge(&mut browser, 0.06, [0.1, 0.05, -0.02]);
    browser.wait_for(gripped, "the board is let go", |look| {
        look["isGripped"] == false
    });
    at_edge(&mut browser, 0.06, [0.3, 0.2, 0.1]);
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(browser.evaluate(LOOK)["board"], moved["board"]);
    assert_eq!(moved["typed"], "", "a hand at the edge types nothing");

    browser.evaluate("emulated.hands.left = emulated.flat([-0.12, 0.74, -0.25], 'left'); emulated.hands.right = emulated.flat([0.12, 0.74, -0.25], 'right')");
    let laid = browser.wait_for(LOOK, "the board lies on the table", |look| {
        (number(&look["board"][1]) - 0.737).abs() < 0.01
    });
    // Its front faces up: a quarter turn about X.
    let turn: Vec<f64> = (3..7).map(|index| number(&laid["board"][index])).collect();
    let expected = [-0.5_f64.sqrt(), 0.0, 0.0, 0.5_f64.sqrt()];
    let same: f64 = turn.iter().zip(expected).map(|(a, b)| a * b).sum();
    assert!(same.abs() > 0.999, "{turn:?}");
    assert_eq!(laid["typed"], "", "flat hands type nothing");
    // It lies lower than the boards were.
    browser.evaluate("emulated.device.quaternion.set(-Math.sin(0.5), 0, 0, Math.cos(0.5))");
    std::thread::sleep(Duration::from_millis(500));
    browser.save_picture("headset-table.png");
}

/// Moves the boards with a pinch beside the keys, while the layout changes. Returns whether they moved before and after the change.
const MOVES: &str = r#"(async () => {
  const { Boards } = await import("/headset-boards.js");
  const { compose } = await import("/headset-joints.js");
  const { session } = await import("/session.js");
  const boards = new Boards();
  const head = [0, 1.6, 0, 0, 0, 0, 1];
  const place = () => boards.roomFromWorld.join();
  boards.follow({}, head, 0);
  const { targets } = session.layout.boards[0];
  const right = Math.max(...targets.map((it) => it.pose[0] + it.half_m[0]));
  const [x, y, z] = compose(boards.pose(0), [right + 0.02, targets[0].pose[1], 0, 0, 0, 0, 1]);
  const pinch = (by) => {
    const joint = (dx, dz) => [x + by + dx, y, z + dz];
    const joints = Array.from({ length: 25 }, () => joint(0, 0));
    [joints[0], joints[6], joints[21]] = [joint(0, 0.15), joint(-0.03, 0.06), joint(0.03, 0.06)];
    boards.follow({ right: { joints } }, head, 0);
    return place();
  };
  const held = pinch(0);
  const before = pinch(0.1) !== held;
  session.layout = { ...session.layout };
  const placed = pinch(0.2);
  return { before, after: pinch(0.3) !== placed };
})()"#;

#[test]
fn a_hand_that_holds_a_board_does_not_move_the_boards_of_another_layout() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (_server, address) = serve(&page);
    open(&mut browser, &address);
    let moves = browser.evaluate(MOVES);
    assert_eq!(moves, json!({"before": true, "after": false}));
}

/// A headset whose browser asks the person, who does not answer.
const ASKS: &str = "Object.defineProperty(navigator, 'xr', { value: {
    isSessionSupported: async () => true,
    requestSession: () => {
        globalThis.asked = (globalThis.asked ?? 0) + 1;
        return new Promise(() => {});
    },
} })";

#[test]
fn a_second_click_while_the_browser_asks_the_person_asks_no_second_time() {
    let Some(page) = folder() else { return };
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (_server, address) = serve(&page);
    browser.call("Page.enable", json!({}));
    let source = json!({ "source": ASKS });
    browser.call("Page.addScriptToEvaluateOnNewDocument", source);
    open(&mut browser, &address);
    browser.wait_for(LOOK, "a headset is offered", |look| {
        look["isOffered"] == true
    });
    browser.evaluate("for (const id of ['enter-vr', 'enter-vr', 'enter-ar']) document.getElementById(id).click()");
    let look = browser.wait_for(LOOK, "no complaint", |seen| seen["notice"] == "");
    assert_eq!(look["session"], "");
    assert_eq!(browser.evaluate("globalThis.asked"), 1);
}
