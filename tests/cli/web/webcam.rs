//! The webcam of the page: a film of a hand in the fake camera of the browser, a model of MediaPipe, and what the hand types.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{LazyLock, Mutex};

use serde_json::{Value, json};
use tempfile::TempDir;

use super::files::drop_file;
use super::hand_picture::write_film;
use super::page::{look_like, open};
use super::{folder, serve};
use crate::browser::Browser;
use crate::support::process::Process;

const LOOK: &str = r##"({
  status: document.getElementById("webcam-status").textContent,
  numbers: document.getElementById("webcam-numbers").textContent,
  hint: document.getElementById("webcam-hint").textContent,
  advice: document.getElementById("webcam-advice").textContent,
  model: !document.getElementById("webcam-model").hidden,
  typed: document.getElementById("typed").value,
  keys: document.querySelectorAll("#keys kbd").length,
  events: [...document.querySelectorAll("#events li")].map((it) => it.textContent).join("\n"),
  notice: document.getElementById("notice").textContent,
  overflow: document.documentElement.scrollWidth - innerWidth,
  track: globalThis.track?.readyState,
})"##;

/// Returns the file of a model. `None` if it cannot be assembled.
fn model() -> Option<PathBuf> {
    // Two tests need it.
    static MODEL: LazyLock<Mutex<()>> = LazyLock::new(Mutex::default);
    let _guard = MODEL.lock();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hand_landmarker.task");
    if path.is_file() {
        return Some(path);
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/web/model");
    let made = Command::new("bash").arg(script).arg(&path).output();
    let made = made.expect("bash starts");
    if made.status.success() {
        return Some(path);
    }
    let reason = String::from_utf8_lossy(&made.stderr);
    println!("SKIPPED: web/model cannot make a hand model: {reason}");
    None
}

/// Returns the folder of a page with MediaPipe.
fn folder_with_vision() -> Option<PathBuf> {
    let folder = folder()?;
    if folder.join("vision_bundle.mjs").is_file() {
        return Some(folder);
    }
    println!("SKIPPED: the page was built without MediaPipe; npm fetches it");
    None
}

/// Starts a browser whose camera plays a film of a hand. Its requests are written to a file.
fn browser(log: &Path) -> Option<Browser> {
    let film = log.with_extension("y4m");
    write_film(&film).expect("a film");
    Browser::start_with(&[
        "--disable-gpu",
        "--window-size=1280,800",
        "--use-fake-device-for-media-stream",
        "--use-fake-ui-for-media-stream",
        &format!("--use-file-for-fake-video-capture={}", film.display()),
        &format!("--log-net-log={}", log.display()),
    ])
}

fn click(browser: &mut Browser, id: &str) {
    browser.evaluate(&format!("document.getElementById('{id}').click()"));
}

fn choose(browser: &mut Browser, id: &str, file: &Path) {
    let document = browser.call("DOM.getDocument", json!({}));
    let query = json!({"nodeId": document["root"]["nodeId"], "selector": format!("#{id}")});
    let node = browser.call("DOM.querySelector", query);
    let files = json!({"nodeId": node["nodeId"], "files": [crate::text(file)]});
    browser.call("DOM.setFileInputFiles", files);
}

fn has(look: &Value, field: &str, part: &str) -> bool {
    look[field].as_str().is_some_and(|it| it.contains(part))
}

/// Starts the camera with a model that is chosen, until a hand is followed.
fn start(browser: &mut Browser, model: &Path) {
    browser.evaluate("document.getElementById('webcam').open = true");
    click(browser, "webcam-start");
    browser.wait_for(LOOK, "the page asks for a model", |look| {
        look["model"] == true
    });
    choose(browser, "webcam-file", model);
    browser.wait_for(LOOK, "a hand is seen", |look| {
        has(look, "numbers", "right hand")
    });
    browser.evaluate(
        "globalThis.track = document.getElementById('webcam-video').srcObject.getVideoTracks()[0]",
    );
}

/// Returns the addresses in the log of a browser that a page of a site or its workers have asked for, with `true` for each that is not of
/// the site. The browser itself asks its maker for the time, for updates and more.
fn requests(log: &str, site: &str) -> Vec<(String, bool)> {
    let site = site.trim_end_matches('/');
    let starts = log.split("\"initiator\":\"").skip(1);
    let of_site = starts.filter_map(|rest| rest.strip_prefix(site)?.strip_prefix('"'));
    let urls = of_site.filter_map(|rest| rest.split("\"url\":\"").nth(1)?.split('"').next());
    let is_foreign = |url: &str| url.starts_with("http") && !url.starts_with(site);
    urls.map(|url| (url.to_owned(), is_foreign(url))).collect()
}

#[test]
fn a_hand_before_a_webcam_gets_the_board_under_its_fingers_types_and_is_released() {
    let (Some(folder), Some(model)) = (folder_with_vision(), model()) else {
        return;
    };
    let scratch = tempfile::tempdir().expect("a folder");
    let log = scratch.path().join("requests.json");
    let Some(mut browser) = browser(&log) else {
        return;
    };
    let (_server, address) = serve(&folder);
    open(&mut browser, &address);
    let wrong = scratch.path().join("wrong.task");
    fs::write(&wrong, vec![0; 200_000]).expect("a file");
    browser.evaluate("document.getElementById('webcam').open = true");
    choose(&mut browser, "webcam-file", &wrong);
    browser.wait_for(LOOK, "a wrong model", |look| {
        has(look, "status", "it is not a .task file")
    });
    start(&mut browser, &model);

    click(&mut browser, "webcam-place-boards");
    browser.wait_for(LOOK, "the boards are placed", |look| {
        has(look, "advice", "the boards are under your hands")
    });
    browser.wait_for(LOOK, "the finger types", |look| look["typed"] != "");
    // In the film the hand disappears while its finger is bent.
    browser.wait_for(LOOK, "the hand is lost, and nothing is held", |look| {
        has(look, "numbers", "no hand") && look["keys"] == 0 && has(look, "events", "key-up")
    });

    browser.wait_for(LOOK, "the hand is back", |look| {
        has(look, "numbers", "right hand")
    });
    for (width, height) in [(1400, 1000), (390, 844)] {
        for theme in ["dark", "light"] {
            look_like(&mut browser, width, height, theme);
            browser.evaluate("document.getElementById('webcam').scrollIntoView()");
            browser.wait_for(LOOK, "the hand is drawn", |look| {
                has(look, "numbers", "right hand")
            });
            browser.save_picture(&format!("web-webcam-{width}-{theme}.png"));
            assert_eq!(browser.evaluate(LOOK)["overflow"], 0);
        }
    }
    assert_eq!(browser.evaluate(LOOK)["track"], "live");
    let cameras = "[...document.getElementById('webcam-camera').options].map((it) => it.text)";
    let offered = browser.evaluate(cameras);
    let offered = offered.as_array().expect("a list");
    assert!(offered.len() > 1 && offered[0] == "any", "{offered:?}");
    // A key may be held for less than a look from here, and than a frame of a slow machine. The page looks for hands in one image at a
    // time: before the next one come two frames, in which the hand of the image before moves the stages.
    let was_held = browser.evaluate(
        "new Promise((done) => {
            const video = document.getElementById('webcam-video');
            const end = (wasHeld) => {
                delete video.requestVideoFrameCallback;
                done(wasHeld);
            };
            const look = (call) => {
                if (document.querySelector('#events li').textContent.includes('key-down')) {
                    document.getElementById('webcam-stop').click();
                    end(true);
                }
                call();
            };
            const wait = video.requestVideoFrameCallback.bind(video);
            const frame = requestAnimationFrame;
            video.requestVideoFrameCallback = (call) => wait(() => frame(() => frame(() => look(call))));
            setTimeout(end, 100_000, false);
        })",
    );
    assert_eq!(was_held, true, "the camera is stopped while a key is held");
    let stopped = browser.wait_for(LOOK, "all keys are released", |look| {
        let last = look["events"].as_str().and_then(|it| it.lines().next());
        look["keys"] == 0 && last.is_some_and(|it| it.contains("key-up"))
    });
    assert_eq!(stopped["track"], "ended", "the light of the camera is off");

    // The simulated person types on the board at its own place again.
    click(&mut browser, "clear");
    click(&mut browser, "type");
    browser.wait_for(LOOK, "the simulated person types", |seen| {
        seen["typed"] == "hello"
    });
    drop(browser);
    let log = fs::read_to_string(&log).expect("a log");
    let requests = requests(&log, &address);
    let has = |part: &str| requests.iter().any(|(url, _)| url.contains(part));
    // Of the page, and of the worker.
    assert!(
        has("main.js") && has("vision_wasm_module_internal.wasm"),
        "{requests:?}"
    );
    let foreign = requests.iter().filter(|(_, is_foreign)| *is_foreign);
    assert_eq!(foreign.count(), 0, "{requests:?}");
}

/// Opens the page and starts the camera, for which the browser waits. Returns a folder that must outlive the browser, the browser and
/// the server; `None` without a browser or MediaPipe.
fn page_that_waits_for_the_camera() -> Option<(TempDir, Browser, Process)> {
    let folder = folder_with_vision()?;
    let scratch = tempfile::tempdir().expect("a folder");
    let mut page = browser(&scratch.path().join("requests.json"))?;
    let (server, address) = serve(&folder);
    open(&mut page, &address);
    ask_for_camera(&mut page, scratch.path());
    Some((scratch, page, server))
}

/// Starts the camera, which the browser gives with `globalThis.allow()` only.
fn ask_for_camera(browser: &mut Browser, scratch: &Path) {
    browser.evaluate(
        "{
            const devices = navigator.mediaDevices;
            const ask = devices.getUserMedia.bind(devices);
            devices.getUserMedia = async (wanted) => {
                await new Promise((done) => { globalThis.allow = done; });
                const stream = await ask(wanted);
                globalThis.track = stream.getVideoTracks()[0];
                return stream;
            };
            true;
        }",
    );
    // The camera is asked for before anything looks into the model.
    let model = scratch.join("model.task");
    let mut bytes = vec![0; 200_000];
    bytes[..2].copy_from_slice(b"PK");
    fs::write(&model, bytes).expect("a file");
    browser.evaluate("document.getElementById('webcam').open = true");
    choose(browser, "webcam-file", &model);
    browser.wait_for(LOOK, "the browser asks for the camera", |look| {
        has(look, "status", "waiting for the camera")
    });
}

#[test]
fn a_recording_that_is_dropped_switches_the_camera_off_and_a_layout_does_not() {
    let Some((_scratch, mut browser, _server)) = page_that_waits_for_the_camera() else {
        return;
    };
    drop_file(&mut browser, "mine.ron", b"Layout(name: \"Mine\")");
    let look = browser.wait_for(LOOK, "it still waits", |_| true);
    assert!(has(&look, "status", "waiting for the camera"), "{look}");
    drop_file(&mut browser, "hands.jsonl", b"{\"hands\":[]}");
    let off = browser.wait_for(LOOK, "it is off", |_| true);
    assert!(has(&off, "status", "the camera is off"), "{off}");
}

#[test]
fn a_headset_that_is_entered_switches_the_camera_off() {
    let Some((_scratch, mut browser, _server)) = page_that_waits_for_the_camera() else {
        return;
    };
    click(&mut browser, "enter-vr");
    let off = browser.wait_for(LOOK, "it is off", |_| true);
    assert!(has(&off, "status", "the camera is off"), "{off}");
}

#[test]
fn a_camera_that_the_browser_gives_after_the_person_types_otherwise_is_let_go() {
    let Some((_scratch, mut browser, _server)) = page_that_waits_for_the_camera() else {
        return;
    };
    click(&mut browser, "type");
    browser.evaluate("globalThis.allow()");
    let look = browser.wait_for(LOOK, "the camera is let go", |seen| {
        seen["track"] == "ended"
    });
    assert!(has(&look, "status", "the camera is off"), "{look}");
    browser.wait_for(LOOK, "the simulated person types", |seen| {
        seen["typed"] == "hello"
    });
}

#[test]
fn the_focus_goes_from_the_button_that_starts_the_camera_to_the_one_that_stops_it_and_back() {
    let Some((_scratch, mut browser, _server)) = page_that_waits_for_the_camera() else {
        return;
    };
    // The finder of hands, which the model would end, says nothing.
    browser.evaluate(
        "{
            globalThis.Worker = class extends EventTarget { postMessage() {} terminate() {} };
            document.getElementById('webcam-start').focus();
            globalThis.allow();
            true;
        }",
    );
    let focus = "({id: document.activeElement.id})";
    browser.wait_for(focus, "the camera runs", |seen| seen["id"] == "webcam-stop");
    click(&mut browser, "webcam-stop");
    browser.wait_for(focus, "the camera is off", |seen| {
        seen["id"] == "webcam-start"
    });
}

#[test]
fn the_memory_of_the_page_stays_as_it_is_while_the_camera_runs() {
    let (Some(folder), Some(model)) = (folder_with_vision(), model()) else {
        return;
    };
    let scratch = tempfile::tempdir().expect("a folder");
    let Some(mut browser) = browser(&scratch.path().join("requests.json")) else {
        return;
    };
    // ADEMAN_MINUTES=5 measures longer.
    let minutes = std::env::var("ADEMAN_MINUTES").ok();
    let minutes: f64 = minutes.and_then(|it| it.parse().ok()).unwrap_or(0.5);
    let (_server, address) = serve(&folder);
    open(&mut browser, &address);
    start(&mut browser, &model);
    click(&mut browser, "webcam-place-boards");
    // The page has done everything once, however long a slow machine takes.
    browser.wait_for(LOOK, "the finger types", |look| look["typed"] != "");
    let pause = std::time::Duration::from_secs_f64(minutes * 60.0 / 6.0);
    let measure = |page: &mut Browser| {
        std::thread::sleep(pause);
        page.call("HeapProfiler.collectGarbage", json!({}));
        let heap = page.call("Runtime.getHeapUsage", json!({}));
        let bytes = heap["usedSize"].as_f64().expect("a number")
            + heap["backingStorageSize"].as_f64().unwrap_or_default();
        bytes / 1e6
    };
    let used: Vec<f64> = (0..6).map(|_| measure(&mut browser)).collect();
    println!("megabytes in use: {used:.1?}");
    let (early, late) = (used[1], used[5]);
    assert!(late < 1.15 * early + 1.0, "{used:?}");
}
