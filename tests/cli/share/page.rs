//! The page of `web` in a headless Chromium, which is driven by its DevTools protocol.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener};
use std::time::{Duration, Instant};

use serde_json::json;

use super::{share, typist};
use crate::browser::{Browser, TIMEOUT};

/// The state of the page, and how many pixels of its canvas have the color of a skin, a lit key and a key.
const LOOK: &str = r##"(() => {
  const canvas = document.getElementById("view");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const style = getComputedStyle(document.documentElement);
  const count = (name) => {
    const color = style.getPropertyValue(name).trim();
    const [r, g, b] = [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
    let pixels = 0;
    for (let at = 0; at < data.length; at += 4) {
      const isNear = Math.abs(data[at] - r) + Math.abs(data[at + 1] - g) + Math.abs(data[at + 2] - b) < 12;
      pixels += isNear && data[at + 3] > 250;
    }
    return pixels;
  };
  return {
    state: document.getElementById("state").textContent,
    text: document.getElementById("text").textContent,
    skin: count("--skin"), lit: count("--lit"), keys: count("--key"),
    overflow: document.documentElement.scrollWidth - innerWidth,
  };
})()"##;

#[test]
fn chromium_shows_the_hand_over_lit_keys_and_connects_again() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (typist, address) = typist(&"hola ".repeat(100), "web");
    browser.call(
        "Page.navigate",
        json!({"url": format!("http://{address}/")}),
    );
    browser.wait_for(LOOK, "a hand over keys", |look| {
        look["state"] == "running"
            && look["skin"].as_u64() > Some(2000)
            && look["keys"].as_u64() > Some(20_000)
    });
    browser.wait_for(LOOK, "a key is lit", |look| {
        look["lit"].as_u64() > Some(200)
    });
    browser.save_picture("page.png");
    browser.wait_for(LOOK, "a word is typed", |look| {
        look["text"]
            .as_str()
            .is_some_and(|text| text.contains("hola"))
    });
    drop(typist);
    browser.wait_for(LOOK, "the program has ended", |look| {
        look["state"] == "not connected" && look["skin"] == 0
    });
    let (_typist, _) = share(&"hola ".repeat(100), &format!("web:{address}"));
    let phone = json!({"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": true});
    browser.call("Emulation.setDeviceMetricsOverride", phone);
    let light = json!([{"name": "prefers-color-scheme", "value": "light"}]);
    browser.call("Emulation.setEmulatedMedia", json!({"features": light}));
    let look = browser.wait_for(LOOK, "connected again, on a phone", |look| {
        look["state"] == "running"
            && look["skin"].as_u64() > Some(2000)
            && look["keys"].as_u64() > Some(20_000)
    });
    assert_eq!(look["overflow"], 0, "nothing is wider than the screen");
    browser.wait_for(LOOK, "a key is lit on a phone", |seen| {
        seen["lit"].as_u64() > Some(200)
    });
    browser.save_picture("page-phone.png");
}

#[test]
fn the_text_of_the_page_has_shifted_characters_and_ends_with_its_session() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let text = "Ab? (C) 5% Z ";
    let (typist, address) = typist(&text.repeat(40), "web");
    browser.call(
        "Page.navigate",
        json!({"url": format!("http://{address}/")}),
    );
    browser.wait_for(LOOK, "shifted characters are typed", |look| {
        look["text"].as_str().is_some_and(|it| it.contains(text))
    });
    drop(typist);
    browser.wait_for(LOOK, "the program has ended", |look| {
        look["state"] == "not connected"
    });
    let (_typist, _) = share(&"hola ".repeat(100), &format!("web:{address}"));
    browser.wait_for(LOOK, "the text of the second session", |look| {
        let shown = look["text"].as_str();
        shown.is_some_and(|it| it.starts_with("hola") || it.contains("a hola"))
    });
    let shown = browser.evaluate(LOOK)["text"].to_string();
    assert!(!shown.contains(['?', 'Z']), "{shown}");
    // Two sessions on one connection.
    let texts = browser.evaluate(
        r#"(async () => {
            const { receive, session } = await import("/session.js");
            const scene = (time_us) => receive({ kind: "scene", time_us, state: "running", boards: [], pressed: [], keys: [] });
            const type = (key) => receive({ kind: "events", event: "key-down", key });
            session.text = "";
            scene(9e6), type("A");
            scene(8.9e6), type("B");
            const first = session.text;
            scene(1e6), type("C");
            return [first, session.text];
        })()"#,
    );
    assert_eq!(texts, json!(["ab", "c"]));
    // A hand whose source was lost while the other one is seen.
    let hands = browser.evaluate(
        r#"(async () => {
            const { receive, session } = await import("/session.js");
            const scene = (time_us) => receive({ kind: "scene", time_us, state: "running", boards: [], pressed: [], keys: [] });
            scene(100e6);
            receive({ kind: "pose", side: "left", time_us: 100e6, positions: {} });
            scene(100.4e6);
            const seen = Object.keys(session.hands);
            scene(100.6e6);
            return [seen, Object.keys(session.hands)];
        })()"#,
    );
    assert_eq!(hands, json!([["left"], []]));
}

/// Serves a page of another origin. A page without one, such as a `data:` URL, is refused by the browser itself.
fn serve_elsewhere() -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("it is bound");
    std::thread::spawn(move || {
        for mut stream in listener.incoming().map_while(Result::ok) {
            let _ = stream.read(&mut [0; 4096]);
            let page = "<title>elsewhere</title>";
            let head = "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nConnection: close\r\n";
            let length = page.len();
            let _ = write!(stream, "{head}Content-Length: {length}\r\n\r\n{page}");
        }
    });
    address
}

#[test]
fn a_page_of_another_origin_can_neither_connect_nor_read() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (_typist, address) = typist(&"hola ".repeat(100), "web");
    let elsewhere = serve_elsewhere();
    browser.call(
        "Page.navigate",
        json!({"url": format!("http://{elsewhere}/")}),
    );
    let start = Instant::now();
    while browser.evaluate("document.title") != "elsewhere" {
        assert!(start.elapsed() < TIMEOUT, "the page of {elsewhere}");
        std::thread::sleep(Duration::from_millis(20));
    }
    let connect = |path: &str| {
        format!(
            r#"new Promise((done) => {{
                const socket = new WebSocket("ws://{address}{path}");
                socket.onopen = () => done("open");
                socket.onerror = () => done("refused");
            }})"#
        )
    };
    assert_eq!(browser.evaluate(&connect("/ws")), "refused");
    let read = format!(r#"fetch("http://{address}/").then(() => "read", () => "refused")"#);
    assert_eq!(browser.evaluate(&read), "refused");
    browser.call(
        "Page.navigate",
        json!({"url": format!("http://{address}/")}),
    );
    browser.wait_for(LOOK, "the page itself", |look| look["state"] == "running");
    assert_eq!(browser.evaluate(&connect("/ws")), "open");
}
