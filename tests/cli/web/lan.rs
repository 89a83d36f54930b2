//! The page in a headset types into the program: TLS, the token and the consent of the person at the computer.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};
use tempfile::TempDir;

use super::folder;
use super::headset::{LOOK, SPEED, browser, enter, type_with_the_hand};
use crate::browser::Browser;
use crate::support::process::Process;
use crate::support::x11::wait_for;
use crate::{ademan, text};

/// A program that serves the page to a headset, and its settings.
struct Server {
    _process: Process,
    home: TempDir,
    link: String,
}

impl Server {
    fn start(folder: &Path) -> Self {
        let home = tempfile::tempdir().expect("a folder");
        // On a busy machine pictures, and with them readings, come more than 200 ms after another. They must not stall the session.
        let own = home.path().join("ademan");
        fs::create_dir(&own).expect("a new folder");
        fs::write(own.join("setup.ron"), "Setup(stall_timeout_ms: 2000)").expect("a file");
        let transcript = format!("transcript:{}", home.path().join("typed.txt").display());
        let control = home.path().join("control");
        let mut command = ademan(["serve", "--lan", "127.0.0.1", "--port", "0"]);
        command.args(["--dir", text(folder), "--output", &transcript]);
        command.args(["--control", text(&control), "--allow-root"]);
        command.args(["--layout", "qwerty-flat"]);
        command.env("XDG_CONFIG_HOME", home.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped());
        let mut process = Process::start(&mut command).expect("the program starts");
        let stdout = BufReader::new(process.0.stdout.take().expect("it is piped"));
        let mut lines = stdout.lines().map_while(Result::ok);
        let link = lines.find(|line| line.starts_with("https://"));
        std::thread::spawn(move || lines.count());
        Self {
            _process: process,
            home,
            link: link.expect("a link"),
        }
    }

    /// The address of the page, without the token.
    fn page(&self) -> &str {
        self.link.split('#').next().expect("a text")
    }

    fn ademan(&self, arguments: &[&str]) -> Command {
        let mut command = ademan(arguments);
        command.env("XDG_CONFIG_HOME", self.home.path());
        command
    }

    fn run(&self, arguments: &[&str]) -> String {
        let output = self.ademan(arguments).output().expect("it starts");
        assert!(output.status.success(), "{output:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    fn ctl(&self, request: &str) -> String {
        let control = self.home.path().join("control");
        self.run(&["ctl", "--socket", text(&control), request])
    }

    /// The transcript so far.
    fn typed(&self) -> String {
        fs::read_to_string(self.home.path().join("typed.txt")).unwrap_or_default()
    }

    fn wait_for(&self, expected: &str, is_expected: impl Fn(&str) -> bool) {
        let is_typed = wait_for(|| is_expected(&self.typed()));
        assert!(is_typed, "{expected}: {}", self.typed());
    }
}

/// Times that a text is typed: a busy machine may draw too few pictures of a press, or stall the session.
const ATTEMPTS: u32 = 12;

/// Types a text until the state and the transcript of the program are as expected.
fn type_until(
    browser: &mut Browser,
    server: &Server,
    text: &str,
    is_done: impl Fn(&str, &str) -> bool,
) {
    for attempt in 0.. {
        type_with_the_hand(browser, text);
        let (state, typed) = (server.ctl("state"), server.typed());
        if is_done(&state, &typed) {
            return;
        }
        assert!(attempt < ATTEMPTS, "{state}\n{typed}");
    }
}

/// Returns `true` if a key is down at the end of a transcript.
fn is_down(transcript: &str, key: &str) -> bool {
    let words = ["down", "up  "].map(|word| transcript.rfind(&format!("{word} {key}")));
    words[0] > words[1]
}

fn connected(browser: &mut Browser, words: &str) {
    browser.wait_for(LOOK, words, |look| {
        look["computer"]
            .as_str()
            .is_some_and(|it| it.contains(words))
    });
}

/// Opens a WebSocket in a page, sends a message, and returns what comes of it: the kind of the answer, or the end.
fn socket(browser: &mut Browser, url: &str, message: &str) -> Value {
    browser.evaluate(&format!(
        r#"new Promise((done) => {{
            const socket = new WebSocket({});
            let isOpen = false;
            socket.onopen = () => {{ isOpen = true; socket.send({}); }};
            socket.onmessage = (it) => done(JSON.parse(it.data).kind);
            socket.onclose = () => done("no answer");
            socket.onerror = () => done(isOpen ? "no answer" : "refused at once");
            setTimeout(() => done("neither an answer nor the end"), 60000);
        }})"#,
        json!(url),
        json!(message)
    ))
}

/// Opens a browser, which trusts every certificate, and serves the page. `None` if the page is not built or no browser is installed.
fn browser_and_server(open: impl FnOnce() -> Option<Browser>) -> Option<(Browser, Server)> {
    let folder = folder()?;
    let mut browser = open()?;
    let server = Server::start(&folder);
    let ignore = json!({"ignore": true});
    browser.call("Security.setIgnoreCertificateErrors", ignore);
    Some((browser, server))
}

#[test]
fn the_page_types_into_the_program_once_keys_are_allowed_until_its_token_is_revoked() {
    let Some((mut browser, server)) = browser_and_server(browser) else {
        return;
    };
    browser.call("Network.enable", json!({}));
    // A small picture is drawn more often.
    let size = json!({"width": 480, "height": 300, "deviceScaleFactor": 1, "mobile": false});
    browser.call("Emulation.setDeviceMetricsOverride", size);
    enter(&mut browser, &server.link, "enter-vr");
    connected(&mut browser, "once it allows keys");
    let hash = browser.evaluate("location.href");
    assert_eq!(hash, server.page(), "the token leaves the address bar");

    // It only points.
    type_until(&mut browser, &server, "h", |state, _| {
        state.contains("suppressed")
    });
    assert!(!server.typed().contains("down H"), "{}", server.typed());

    server.ctl("allow-keys");
    type_until(&mut browser, &server, "hi", |_, typed| {
        typed.contains("down H") && typed.contains("down I")
    });
    browser.save_picture("headset-lan.png");

    // A revoked token ends the connection, which releases its keys. The hand rests on the key.
    for attempt in 0.. {
        let press = "(async () => { const { session } = await import('/session.js'); await emulated.type('q', SPEED, () => session.keys.includes('Q')); })()";
        browser.evaluate(&press.replace("SPEED", &SPEED.to_string()));
        std::thread::sleep(Duration::from_secs(1));
        if is_down(&server.typed(), "Q") {
            break;
        }
        assert!(attempt < ATTEMPTS, "{}", server.typed());
    }
    server.run(&["token", "revoke", "headset"]);
    server.wait_for("it is released", |typed| !is_down(typed, "Q"));
    connected(&mut browser, "refuses this page");

    let page = server.page().to_owned();
    let own = page.replace("https", "wss");
    let is_own =
        |url: &&String| url.starts_with(&page) || url.starts_with(&own) || url.starts_with("data:");
    let urls = browser.requests();
    assert!(urls.iter().all(|url| is_own(&url)), "{urls:?}");
}

#[test]
fn a_client_without_the_token_or_of_another_page_is_refused() {
    let Some((mut browser, server)) = browser_and_server(Browser::start) else {
        return;
    };
    let token = server.link.rsplit('=').next().expect("a token").to_owned();
    let socket_url = format!("{}hands", server.page().replace("https", "wss"));
    let hello = |sent: &str| json!({"token": sent, "name": "Quest 3"}).to_string();

    // A page without an address has another origin.
    assert_eq!(
        socket(&mut browser, &socket_url, &hello(&token)),
        "refused at once"
    );

    browser.call("Page.navigate", json!({"url": server.page()}));
    let ready = "({ready: document.documentElement?.dataset.ready ?? \"\"})";
    browser.wait_for(ready, "the page runs", |look| look["ready"] == "true");
    let shown = browser.evaluate("document.getElementById('computer').textContent");
    assert_eq!(shown, "", "without a token it does not connect");
    assert_eq!(
        socket(&mut browser, &socket_url, &hello(&"0".repeat(64))),
        "refused"
    );
    assert_eq!(
        socket(&mut browser, &socket_url, "{\"time_us\":1,\"hands\":[]}"),
        "no answer"
    );
    assert_eq!(socket(&mut browser, &socket_url, &hello(&token)), "welcome");

    // The files are public, and nothing else is.
    let fetched = browser.evaluate("Promise.all(['/', '/main.js', '/tokens', '/ws', '/../key.pem'].map(async (it) => (await fetch(it)).status))");
    assert_eq!(fetched, json!([200, 200, 404, 404, 404]));
}

#[test]
fn a_page_says_that_another_headset_is_read_as_long_as_it_is() {
    let Some((mut browser, server)) = browser_and_server(Browser::start) else {
        return;
    };
    browser.call("Page.navigate", json!({"url": server.link}));
    connected(&mut browser, "once it allows keys");
    let url = json!(format!("{}hands", server.page().replace("https", "wss")));
    let token = server.link.rsplit('=').next().expect("a token");
    let hello = json!(json!({"token": token, "name": "other"}).to_string());
    // Another headset, whose hand is seen.
    browser.evaluate(&format!(
        r#"(() => {{
            const line = document.getElementById("computer");
            globalThis.said = [];
            new MutationObserver(() => said.push(line.textContent)).observe(line, {{ childList: true }});
            const other = new WebSocket({url});
            const joints = Array.from({{ length: 25 }}, () => [0.1, 1, -0.3]);
            let time = 0;
            const send = () => other.send(JSON.stringify({{ time_us: time += 20000, hands: [{{ label: "right", joints }}] }}));
            other.onopen = () => other.send({hello});
            other.onmessage = () => setInterval(send, 20);
            return true;
        }})()"#
    ));
    let said = |look: &Value| -> Vec<String> {
        let all = look["said"].as_array().into_iter().flatten();
        all.filter_map(|it| it.as_str().map(str::to_owned))
            .skip_while(|it| !it.contains("reads another headset"))
            .collect()
    };
    let look = browser.wait_for("({said})", "it has tried twice", |seen| {
        said(seen).len() > 1
    });
    let texts = said(&look);
    assert_eq!(texts[0], texts[1], "{look}");
}

/// Waits until the state of the session contains these words.
fn wait_for_state(server: &Server, words: &str) {
    let control = server.home.path().join("control");
    let mut last = None;
    let is_there = wait_for(|| {
        let mut asked = server.ademan(&["ctl", "--socket", text(&control), "state"]);
        let output = asked.output().expect("it starts");
        let is_there = String::from_utf8_lossy(&output.stdout).contains(words);
        last = Some(output);
        is_there
    });
    assert!(is_there, "{words}: {last:?}");
}

#[test]
fn the_state_of_the_session_names_the_headset_with_a_valid_token_until_it_leaves() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let page = "<!doctype html><title>page</title>";
    fs::write(folder.path().join("index.html"), page).expect("a page");
    let server = Server::start(folder.path());
    wait_for_state(&server, "source     no headset connected\n");
    browser.call(
        "Security.setIgnoreCertificateErrors",
        json!({"ignore": true}),
    );
    browser.call("Page.navigate", json!({"url": server.page()}));
    let loaded = "({title: document.title, state: document.readyState})";
    browser.wait_for(loaded, "the page is loaded", |look| {
        *look == json!({"title": "page", "state": "complete"})
    });
    let url = format!("{}hands", server.page().replace("https", "wss"));
    let token = server.link.rsplit('=').next().expect("a token").to_owned();
    let hello = |sent: &str, name: &str| json!({"token": sent, "name": name}).to_string();

    assert_eq!(
        socket(&mut browser, &url, &hello(&"0".repeat(64), "Stranger")),
        "refused"
    );
    let state = server.ctl("state");
    assert!(state.contains("no headset connected"), "{state}");
    assert!(!state.contains("Stranger"), "{state}");

    // The name may not act on a terminal, and is as long as it may be.
    let name = format!("Quest\u{1b}[2J{}", "3".repeat(1000));
    let (url, hello) = (json!(url), json!(hello(&token, &name)));
    browser.evaluate(&format!(
        "window.kept = new WebSocket({url}); kept.onopen = () => kept.send({hello}); true"
    ));
    let shown_name = format!(r"Quest\u{{1b}}[2J{}", "3".repeat(31));
    wait_for_state(
        &server,
        &format!("source     headset {shown_name} at 127.0.0.1\n"),
    );
    let named_state = server.ctl("state");
    assert!(!named_state.contains(&token), "{named_state}");
    browser.evaluate("kept.close(); true");
    wait_for_state(&server, "source     no headset connected\n");
}

/// Tests without a browser. `.ci/repeats` does not list this module, so they have to pass at once.
mod refusals {
    use std::process::Command;

    use crate::web::folder;
    use crate::{ademan, text};

    #[test]
    fn an_address_of_every_network_is_refused_with_what_to_do() {
        let Some(folder) = folder() else { return };
        for (address, words) in [("0.0.0.0", "every network"), ("desk", "ip address")] {
            let ended = crate::run(["serve", "--dir", text(&folder), "--lan", address]).exited(2);
            ended.reported(words);
        }
    }

    /// Runs `ademan serve --lan` on a folder without a page, which ends it at the latest. Returns what it printed, and whether it made a token.
    fn refused(arguments: &[&str]) -> (crate::Ended, bool) {
        let home = tempfile::tempdir().expect("a folder");
        let mut command = ademan(["serve", "--lan", "127.0.0.1", "--port", "0", "--dir"]);
        command.arg(home.path()).args(arguments);
        command
            .env("XDG_CONFIG_HOME", home.path())
            .env("XDG_STATE_HOME", home.path());
        let ended = crate::run_to_end(&mut command);
        assert_ne!(ended.code, Some(0));
        let has_token = home.path().join("ademan/network").exists();
        (ended, has_token)
    }

    #[test]
    fn a_layout_of_a_link_is_refused_before_the_link_to_the_page_is_shown_unless_it_is_trusted() {
        let link = crate::run(["layout", "share", "numpad"]).out;
        let arguments = ["--allow-root", "--layout", link.trim()];
        let (unknown, has_token) = refused(&arguments);
        unknown.reported("then add --trust");
        assert_eq!((&*unknown.out, has_token), ("", false));
        let (trusted, _) = refused(&[&arguments[..], &["--trust"]].concat());
        trusted.reported("run web/build");
    }

    #[test]
    fn root_is_refused_before_there_is_a_token_and_a_link() {
        let user = Command::new("id").arg("-u").output().expect("it starts");
        if user.stdout != b"0\n" {
            println!("SKIPPED: this test needs root");
            return;
        }
        let (ended, has_token) = refused(&[]);
        ended.reported("--allow-root");
        assert_eq!((&*ended.out, has_token), ("", false));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_server_in_the_background_of_a_terminal_goes_on_and_is_given_consent_when_it_returns() {
    let Some(page) = folder() else { return };
    let home = tempfile::tempdir().expect("a folder");
    let control = home.path().join("control");
    let server = ademan(["serve", "--lan", "127.0.0.1", "--port", "0"]);
    let mut shell = Command::new("sh");
    shell
        .args(["-c", "set -m; \"$@\" & read line; fg", "sh"])
        .arg(server.get_program())
        .args(server.get_args())
        .args(["--dir", text(&page), "--control", text(&control)])
        .args(["--output", "none", "--allow-root"])
        .env("XDG_CONFIG_HOME", home.path())
        .env_remove("XDG_RUNTIME_DIR");
    let mut screen = crate::view::screen::Screen::start(&shell, 120, 60);
    let succeeds = |request: &str| {
        let output = ademan(["ctl", "--socket", text(&control), request]).output();
        output.expect("it starts").status.success()
    };
    let is_running = wait_for(|| succeeds("state"));
    assert!(is_running, "no session:\n{}", screen.text());
    // The shell reads the first line, and the program the second one.
    screen.type_keys("\rallow\r");
    screen.wait_for_text("the headset may press keys");
    assert!(succeeds("stop"), "{}", screen.text());
    assert!(screen.wait().success(), "{}", screen.text());
}
