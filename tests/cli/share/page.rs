//! The page of `web` in a headless Chromium, which is driven by its DevTools protocol.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

use super::{share, typist};
use crate::support::process::Process;

/// Longest wait for a state of the page.
const TIMEOUT: Duration = Duration::from_secs(120);

const FLAGS: [&str; 12] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--window-size=1280,800",
    "--remote-debugging-port=0",
    "about:blank",
];

/// The state of the page, and how many pixels of its canvas have the colour of a skin, a lit key and a key.
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

/// A browser with one page.
struct Browser {
    _process: Process,
    _profile: TempDir,
    socket: WebSocket<TcpStream>,
    /// The page.
    session: Value,
    calls: u64,
}

impl Browser {
    /// Starts the browser; `None` if it is not installed.
    fn start() -> Option<Self> {
        let profile = tempfile::tempdir().expect("a folder");
        let mut command = Command::new("chromium");
        command
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .args(FLAGS)
            .stderr(Stdio::piped());
        let Ok(mut process) = Process::start(&mut command) else {
            println!("SKIPPED: chromium is not installed");
            return None;
        };
        let stderr = BufReader::new(process.0.stderr.take().expect("it is piped"));
        let mut lines = stderr.lines().map_while(Result::ok);
        let url =
            lines.find_map(|line| Some(line.split_once("DevTools listening on ")?.1.to_owned()));
        let url = url.expect("its address");
        std::thread::spawn(move || lines.count());
        let (address, _) = url["ws://".len()..].split_once('/').expect("a path");
        let stream = TcpStream::connect(address).expect("it listens");
        let (socket, _) = tungstenite::client(&url, stream).expect("a WebSocket");
        let mut browser = Self {
            _process: process,
            _profile: profile,
            socket,
            session: Value::Null,
            calls: 0,
        };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        browser.session = browser.call("Target.attachToTarget", attach)["sessionId"].clone();
        Some(browser)
    }

    /// Calls a method, and returns its result.
    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.calls += 1;
        let mut call = json!({"id": self.calls, "method": method, "params": parameters});
        if self.session.is_string() {
            call["sessionId"] = self.session.clone();
        }
        let message = Message::text(call.to_string());
        self.socket.send(message).expect("the browser runs");
        loop {
            let message = self.socket.read().expect("the browser runs");
            let answer: Value = serde_json::from_slice(&message.into_data()).expect("JSON");
            if answer["id"] == self.calls {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    /// Evaluates an expression in the page.
    fn evaluate(&mut self, expression: &str) -> Value {
        let parameters =
            json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        self.call("Runtime.evaluate", parameters)["result"]["value"].clone()
    }

    /// Waits until the page looks as expected.
    fn wait_for(&mut self, expected: &str, is_expected: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let look = self.evaluate(LOOK);
            if is_expected(&look) {
                println!("{expected}: {look}");
                return look;
            }
            assert!(start.elapsed() < TIMEOUT, "{expected}: {look}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Saves a picture of the page in the folder of the build.
    fn save_picture(&mut self, name: &str) {
        let picture = self.call("Page.captureScreenshot", json!({"format": "png"}));
        let picture = decode_base64(picture["data"].as_str().expect("a picture"));
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        fs::write(&path, picture).expect("a file");
        println!("saved {}", path.display());
    }
}

fn decode_base64(text: &str) -> Vec<u8> {
    let digit = |byte: u8| match byte {
        b'A'..=b'Z' => byte - b'A',
        b'a'..=b'z' => byte - b'a' + 26,
        b'0'..=b'9' => byte - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u32> = text
        .bytes()
        .filter(|&byte| byte != b'=')
        .map(|byte| digit(byte).into())
        .collect();
    let bytes = digits.chunks(4).flat_map(|digits| {
        let bits =
            digits.iter().fold(0, |bits, digit| bits << 6 | digit) << (6 * (4 - digits.len()));
        let [_, a, b, c] = bits.to_be_bytes();
        [a, b, c].into_iter().take(digits.len() - 1)
    });
    bytes.collect()
}

#[test]
fn chromium_shows_the_hand_over_lit_keys_and_connects_again() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let (typist, address) = typist(&"hola ".repeat(40), "web");
    browser.call(
        "Page.navigate",
        json!({"url": format!("http://{address}/")}),
    );
    browser.wait_for("a hand over keys", |look| {
        look["state"] == "running"
            && look["skin"].as_u64() > Some(2000)
            && look["keys"].as_u64() > Some(20_000)
    });
    browser.wait_for("a key is lit", |look| look["lit"].as_u64() > Some(200));
    browser.save_picture("page.png");
    browser.wait_for("a word is typed", |look| {
        look["text"]
            .as_str()
            .is_some_and(|text| text.contains("hola"))
    });
    drop(typist);
    browser.wait_for("the program has ended", |look| {
        look["state"] == "not connected" && look["skin"] == 0
    });
    let (_typist, _) = share(&"hola ".repeat(40), &format!("web:{address}"));
    let phone = json!({"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": true});
    browser.call("Emulation.setDeviceMetricsOverride", phone);
    let light = json!([{"name": "prefers-color-scheme", "value": "light"}]);
    browser.call("Emulation.setEmulatedMedia", json!({"features": light}));
    let look = browser.wait_for("connected again, on a phone", |look| {
        look["state"] == "running"
            && look["skin"].as_u64() > Some(2000)
            && look["keys"].as_u64() > Some(20_000)
    });
    assert_eq!(look["overflow"], 0, "nothing is wider than the screen");
    browser.wait_for("a key is lit on a phone", |look| {
        look["lit"].as_u64() > Some(200)
    });
    browser.save_picture("page-phone.png");
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
    let (_typist, address) = typist(&"hola ".repeat(40), "web");
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
    browser.wait_for("the page itself", |look| look["state"] == "running");
    assert_eq!(browser.evaluate(&connect("/ws")), "open");
}
