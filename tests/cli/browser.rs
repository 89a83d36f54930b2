//! A headless Chromium, which is driven by its DevTools protocol.

use std::fs;
use std::io::{BufRead, BufReader, ErrorKind};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Error, Message, WebSocket};

use crate::support::process::Process;

/// Longest wait for a state of the page, and for the answer to a call.
pub const TIMEOUT: Duration = Duration::from_secs(120);

/// Wait for the answer of a page that may be replaced: what is evaluated in between is sometimes not answered.
const LOOK_TIMEOUT: Duration = Duration::from_secs(20);

const FLAGS: [&str; 10] = [
    "--headless",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--remote-debugging-port=0",
    "about:blank",
];

/// A browser with one page.
pub struct Browser {
    _process: Process,
    _profile: TempDir,
    socket: WebSocket<TcpStream>,
    /// The page.
    session: Value,
    calls: u64,
    /// The events of the protocol so far.
    pub events: Vec<Value>,
}

impl Browser {
    /// Starts the browser; `None` if it is not installed.
    pub fn start() -> Option<Self> {
        Self::start_with(&["--disable-gpu", "--window-size=1280,800"])
    }

    /// Starts the browser with more flags; `None` if it is not installed.
    pub fn start_with(flags: &[&str]) -> Option<Self> {
        let profile = tempfile::tempdir().expect("a folder");
        let mut command = Command::new("chromium");
        command
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .args(flags)
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
        let is_set = stream.set_read_timeout(Some(TIMEOUT));
        is_set.expect("it is a socket");
        let (socket, _) = tungstenite::client(&url, stream).expect("a WebSocket");
        let is_shorter = socket
            .get_ref()
            .set_read_timeout(Some(Duration::from_secs(1)));
        is_shorter.expect("it is a socket");
        let mut browser = Self {
            _process: process,
            _profile: profile,
            socket,
            session: Value::Null,
            calls: 0,
            events: Vec::new(),
        };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        browser.session = browser.call("Target.attachToTarget", attach)["sessionId"].clone();
        Some(browser)
    }

    /// Calls a method, and returns its result.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        let answer = self.answer(method, parameters, TIMEOUT);
        let answer = answer.unwrap_or_else(|| panic!("no answer to {method}"));
        assert!(answer.get("error").is_none(), "{method}: {answer}");
        answer["result"].clone()
    }

    /// Calls a method, and returns the answer, which may be an error; `None` if there is none in this time.
    fn answer(&mut self, method: &str, parameters: Value, timeout: Duration) -> Option<Value> {
        self.calls += 1;
        let mut call = json!({"id": self.calls, "method": method, "params": parameters});
        if self.session.is_string() {
            call["sessionId"] = self.session.clone();
        }
        let message = Message::text(call.to_string());
        self.socket.send(message).expect("the browser runs");
        let start = Instant::now();
        while start.elapsed() < timeout {
            let received = match self.socket.read() {
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => continue,
                received => received.expect("the browser runs"),
            };
            let answer: Value = serde_json::from_slice(&received.into_data()).expect("JSON");
            if answer["id"] == self.calls {
                return Some(answer);
            }
            if answer["method"].is_string() {
                self.events.push(answer);
            }
        }
        None
    }

    /// Evaluates an expression in the page.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        self.call("Runtime.evaluate", evaluation(expression))["result"]["value"].clone()
    }

    /// Waits until what an expression says of the page is as expected.
    pub fn wait_for(
        &mut self,
        look: &str,
        expected: &str,
        is_expected: impl Fn(&Value) -> bool,
    ) -> Value {
        let start = Instant::now();
        loop {
            let answer = self.answer("Runtime.evaluate", evaluation(look), LOOK_TIMEOUT);
            let seen = answer.map_or(Value::Null, |it| it["result"]["result"]["value"].clone());
            // A page that is being replaced by another one answers with an error or not at all.
            if !seen.is_null() && is_expected(&seen) {
                println!("{expected}: {seen}");
                return seen;
            }
            assert!(start.elapsed() < TIMEOUT, "{expected}: {seen}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Returns the addresses that the page has requested, if the events of the network are on.
    pub fn requests(&self) -> Vec<String> {
        let sent = self.events.iter();
        let sent = sent.filter(|it| it["method"] == "Network.requestWillBeSent");
        let url = |it: &Value| it["params"]["request"]["url"].as_str().map(str::to_owned);
        sent.filter_map(url).collect()
    }

    /// Saves a picture of the page in the folder of the build.
    pub fn save_picture(&mut self, name: &str) {
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
            digits.iter().fold(0, |bits, sextet| bits << 6 | sextet) << (6 * (4 - digits.len()));
        let [_, a, b, c] = bits.to_be_bytes();
        [a, b, c].into_iter().take(digits.len() - 1)
    });
    bytes.collect()
}

/// Returns the parameters of the evaluation of an expression, and of the promise that it may be.
fn evaluation(expression: &str) -> Value {
    json!({"expression": expression, "returnByValue": true, "awaitPromise": true})
}
