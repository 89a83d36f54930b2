//! Characters: the right ones or none, whatever the keymap, the locks and the receiver do.

use std::fs;
use std::thread;
use std::time::Duration;

use ademan::device::{Capabilities, EventKind, KeyCode, OutputEvent};
use ademan::output::{Desktop, Sink};
use ademan::time::Timestamp;
use tempfile::TempDir;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt as _, KEY_PRESS_EVENT, KEY_RELEASE_EVENT};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

use super::both_killed::in_session;
use super::keymaps::{server_with, set_keymap};
use crate::support::binary::ademan;
use crate::support::key_log::KeyLog;
use crate::support::process::signal;
use crate::support::program::Program;
use crate::support::x11::{InputWindow, TerminalWindow, XServer, wait_for};

/// Characters that no key of the keymap `us` types: more than a keymap has unused keys.
const FOREIGN: &str = "αβγδεζηθικλμνξοπρστυφχψωабвгдежз";

/// Time for which the receiver is busy before it reads the keymap.
const BUSY: Duration = Duration::from_millis(150);

/// Number of attempts to type a text on a busy machine.
const ATTEMPTS: usize = 20;

/// Keysym of a key without a meaning.
const NO_SYMBOL: u32 = 0;

/// Codes of keys of a PC keyboard.
const CONTROL: u8 = 37;
const ALT: u8 = 64;
const CAPS_LOCK: u8 = 66;

/// A client that reads and changes the keymap, and presses keys.
pub struct KeymapClient {
    connection: RustConnection,
}

impl KeymapClient {
    pub fn connect(server: &XServer) -> Self {
        let (connection, _) = x11rb::connect(Some(server.display())).expect("the server answers");
        Self { connection }
    }

    /// Returns the keysyms of each key from the first code, 8.
    pub fn keymap(&self) -> Vec<Vec<u32>> {
        let setup = self.connection.setup();
        let (first, count) = (setup.min_keycode, setup.max_keycode - setup.min_keycode + 1);
        let reply = self.connection.get_keyboard_mapping(first, count);
        let reply = reply.expect("the server runs").reply();
        let reply = reply.expect("the server answers");
        let keys = reply.keysyms.chunks(reply.keysyms_per_keycode.into());
        // The width depends on the widest key.
        let without_end = |keysyms: &[u32]| {
            let end = keysyms.iter().rposition(|keysym| *keysym != NO_SYMBOL);
            keysyms[..end.map_or(0, |end| end + 1)].to_vec()
        };
        keys.map(without_end).collect()
    }

    /// Returns the first keysym of a key.
    fn keysym(&self, code: u8) -> u32 {
        let keysyms = &self.keymap()[usize::from(code - 8)];
        keysyms.first().copied().unwrap_or(NO_SYMBOL)
    }

    fn set_keysym(&self, code: u8, keysym: u32) {
        let change = self
            .connection
            .change_keyboard_mapping(1, code, 1, &[keysym]);
        let change = change.expect("the server runs");
        change.check().expect("the server changes its keymap");
    }

    /// Assigns the function key F35 to all unused keys but this number. Returns the number of unused keys before.
    pub fn use_all_but(&self, count: usize) -> usize {
        let keymap = self.keymap();
        let codes = (8..=u8::MAX)
            .zip(&keymap)
            .filter(|(_, keysyms)| keysyms.is_empty());
        // The key with the code 8 is reserved. A key that a layout may press, such as F24, gets no character without a keysym either.
        let is_usable = |code: &u8| *code != 8 && KeyCode::from_x11_code(*code).is_none();
        let unused: Vec<u8> = codes.map(|(code, _)| code).filter(is_usable).collect();
        for code in unused.iter().skip(count) {
            self.set_keysym(*code, 0xffe0);
        }
        unused.len()
    }

    fn fake(&self, kind: u8, code: u8) {
        let event = self
            .connection
            .xtest_fake_input(kind, code, 0, x11rb::NONE, 0, 0, 0);
        let event = event.expect("the server runs").check();
        event.expect("the server has XTEST");
    }

    fn press(&self, code: u8) {
        self.fake(KEY_PRESS_EVENT, code);
    }

    fn release(&self, code: u8) {
        self.fake(KEY_RELEASE_EVENT, code);
    }
}

fn open(server: &XServer) -> Desktop {
    Desktop::open(Some(server.display()), &Capabilities::default()).expect("the server runs")
}

/// Sends a text as a key of a layout does: all characters have one time.
fn send(sink: &mut Desktop, text: &str) {
    let event = |character| OutputEvent {
        time: Timestamp(0),
        kind: EventKind::Character(character),
    };
    let events: Vec<_> = text.chars().map(event).collect();
    sink.send(&events).expect("the queue has room");
}

/// Returns what a receiver reads that looks up each key when it has been busy for a time.
fn read_late(window: &InputWindow, client: &KeymapClient) -> String {
    let character = |code| {
        thread::sleep(BUSY);
        let keysym = client.keysym(code);
        let unicode = if keysym > 0x0100_0000 {
            keysym - 0x0100_0000
        } else {
            keysym
        };
        char::from_u32(unicode).filter(|_| unicode != NO_SYMBOL)
    };
    window
        .pressed_keys()
        .into_iter()
        .filter_map(character)
        .collect()
}

/// Waits until the sink has typed or dropped this number of characters.
fn wait_for_characters(log: &KeyLog, sink: &Desktop, count: usize) {
    let is_done = || log.presses_after(0) + sink.dropped_presses() as usize >= count;
    assert!(wait_for(is_done), "{} of {count}", log.presses_after(0));
}

/// Sends a text. Returns `true` if it was typed, or `false` if it was dropped entirely.
fn is_typed(log: &KeyLog, sink: &mut Desktop, text: &str) -> bool {
    let (length, dropped) = (text.chars().count(), sink.dropped_presses());
    let count = log.presses_after(0) + dropped as usize + length;
    send(sink, text);
    wait_for_characters(log, sink, count);
    let dropped = (sink.dropped_presses() - dropped) as usize;
    assert!(
        [0, length].contains(&dropped),
        "part of {text:?} is dropped"
    );
    if dropped > 0 {
        // As the loop does after a stall.
        sink.void_presses();
    }
    dropped == 0
}

/// Sends a text until it is typed: on a busy machine it may wait too long, and is dropped.
fn type_text(log: &KeyLog, sink: &mut Desktop, text: &str) {
    let is_typed = (0..ATTEMPTS).any(|_| is_typed(log, sink, text));
    assert!(is_typed, "{text:?} is dropped");
}

/// Sends texts to a busy receiver, of which the keymap can type those that are marked, and checks that these arrive.
fn assert_arrives_or_dropped(server: &XServer, client: &KeymapClient, texts: &[(&str, bool)]) {
    let (window, log) = (InputWindow::open(server), KeyLog::start(server));
    let mut sink = open(server);
    let mut expected = String::new();
    for (text, can_be_typed) in texts {
        if *can_be_typed {
            type_text(&log, &mut sink, text);
            expected += text;
        } else {
            assert!(!is_typed(&log, &mut sink, text), "{text:?}");
        }
    }
    assert_eq!(read_late(&window, client), expected);
    sink.close()
        .expect("a character that cannot be typed is no failure");
}

#[test]
fn a_receiver_that_reads_the_keymap_late_reads_the_right_characters() {
    let Some(server) = XServer::start() else {
        return;
    };
    let client = KeymapClient::connect(&server);
    let texts = [
        ("αβγδεζ", true),
        (FOREIGN, false),
        ("ζεδγβα", true),
        ("abc", true),
        ("гдежзи", true),
    ];
    assert_arrives_or_dropped(&server, &client, &texts);
}

#[test]
fn a_text_that_needs_more_keys_than_the_keymap_has_unused_is_dropped_entirely() {
    let Some(server) = XServer::start() else {
        return;
    };
    let client = KeymapClient::connect(&server);
    client.use_all_but(1);
    let texts = [("añbécídóeúfü", false), ("ñandu", true), ("abc 123", true)];
    assert_arrives_or_dropped(&server, &client, &texts);
}

#[test]
fn without_an_unused_key_a_foreign_character_is_dropped_and_the_run_goes_on() {
    let Some(server) = XServer::start() else {
        return;
    };
    let client = KeymapClient::connect(&server);
    client.use_all_but(0);
    assert_arrives_or_dropped(&server, &client, &[("ñ", false), ("abc", true)]);
}

/// Sends a text in front of a terminal and checks that it arrives.
fn assert_arrives(server: &XServer, terminal: &TerminalWindow, text: &str) {
    let (mut sink, log) = (open(server), KeyLog::start(server));
    type_text(&log, &mut sink, text);
    assert_eq!(terminal.typed(text), text);
    sink.close().expect("the server runs");
}

#[test]
fn characters_arrive_under_caps_lock() {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(terminal) = TerminalWindow::start(&server) else {
        return;
    };
    let client = KeymapClient::connect(&server);
    client.press(CAPS_LOCK);
    client.release(CAPS_LOCK);
    assert_arrives(&server, &terminal, "Niño ßÉ λΛ Ж1!");
}

#[test]
fn characters_arrive_with_the_second_group_of_a_keymap() {
    let arguments = ["us,ru", "-option", "grp:caps_toggle"];
    let Some(server) = server_with(&arguments) else {
        return;
    };
    let Some(terminal) = TerminalWindow::start(&server) else {
        return;
    };
    let client = KeymapClient::connect(&server);
    client.press(CAPS_LOCK);
    client.release(CAPS_LOCK);
    assert_arrives(&server, &terminal, "niño тест 1?/");
}

#[test]
fn characters_arrive_with_a_held_shift() {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(terminal) = TerminalWindow::start(&server) else {
        return;
    };
    let client = KeymapClient::connect(&server);
    client.press(50);
    assert_arrives(&server, &terminal, "niño 1!");
    assert_eq!(server.pressed_keys(), [50]);
}

#[test]
fn with_a_held_control_or_alt_characters_are_dropped() {
    let Some(server) = XServer::start() else {
        return;
    };
    let client = KeymapClient::connect(&server);
    for modifier in [CONTROL, ALT] {
        client.press(modifier);
        assert!(server.wait_for_keys(&[modifier.into()]));
        let (log, text) = (KeyLog::start(&server), "niño");
        let mut sink = open(&server);
        send(&mut sink, text);
        sink.close().expect("the server runs");
        assert_eq!(log.presses_after(0), 0, "modifier {modifier}");
        assert_eq!(sink.dropped_presses() as usize, text.chars().count());
        client.release(modifier);
    }
}

#[test]
fn a_keymap_that_the_user_changes_after_a_text_stays_unchanged() {
    for keymap in ["br", "jp", "us,ru"] {
        let Some(server) = server_with(&["us"]) else {
            return;
        };
        let (client, log) = (KeymapClient::connect(&server), KeyLog::start(&server));
        client.use_all_but(12);
        let mut sink = open(&server);
        let texts = ["αβγδεζηθικλμ", "ñü", "абв"];
        type_text(&log, &mut sink, texts[0]);
        set_keymap(&server, &[keymap]);
        let expected = client.keymap();
        for text in &texts[1..] {
            send(&mut sink, text);
        }
        sink.close().expect("a change of the keymap is no failure");
        assert_eq!(client.keymap(), expected, "{keymap}");
    }
}

/// A layout of one key that types a text.
pub const LAYOUT: &str = r#"Layout(
    name: "Text",
    description: "a key that types a text",
    boards: [(
        pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
        keys: [(action: Text("niño λ"), name: "text", at_mm: (0, 0))],
    )],
)"#;

/// A run that has added keys to the keymap of its server.
struct Typed {
    server: XServer,
    client: KeymapClient,
    program: Program,
    /// The keymap before.
    keymap: Vec<Vec<u32>>,
    folder: TempDir,
}

impl Typed {
    /// Starts a run and waits until its keymap has changed. Returns `None` without an X server.
    fn start() -> Option<Self> {
        let server = XServer::start()?;
        let client = KeymapClient::connect(&server);
        let keymap = client.keymap();
        // Real users have a runtime folder in memory.
        let folder = tempfile::tempdir_in("/dev/shm").expect("a folder in memory");
        let layout = folder.path().join("text.ron");
        fs::write(&layout, LAYOUT).expect("the folder is writable");
        let run = ["run", "--output", "desktop", "--source"];
        // A busy machine may drop a text.
        let source = format!(
            "script:{} wait 600000",
            "wait 800; tap text;".repeat(ATTEMPTS)
        );
        let mut run = ademan([&run[..], &[&source]].concat());
        run.arg("--layout").arg(layout);
        let program = Program::from_command(in_session(run, &server, folder.path()));
        assert!(
            wait_for(|| client.keymap() != keymap),
            "{:#?}",
            program.stderr_lines()
        );
        Some(Self {
            server,
            client,
            program,
            keymap,
            folder,
        })
    }

    /// Kills the run, with its watchdog or without.
    fn kill(&mut self, with_watchdog: bool) {
        if with_watchdog {
            let [watchdog] = self.program.children()[..] else {
                panic!("one child: {:?}", self.program.children());
            };
            // A program that is stopped does not replace the watchdog.
            self.program.signal(&["STOP"]);
            signal("KILL", watchdog);
        }
        self.program.signal(&["KILL"]);
        assert_eq!(self.program.wait_for_exit().code(), None);
    }

    /// Runs the command that the unit executes after each run.
    fn release_keys(&self) {
        let mut command = in_session(ademan(["release-keys"]), &self.server, self.folder.path());
        let output = command.output().expect("it starts");
        assert_eq!(output.status.code(), Some(0), "{output:?}");
    }

    fn is_keymap_restored(&self) -> bool {
        wait_for(|| self.client.keymap() == self.keymap)
    }
}

#[test]
fn the_watchdog_of_a_killed_run_removes_its_keys_from_the_keymap() {
    let Some(mut typed) = Typed::start() else {
        return;
    };
    typed.kill(false);
    assert!(typed.is_keymap_restored());
}

#[test]
fn keys_in_the_keymap_of_a_run_that_was_killed_with_its_watchdog_are_removed_by_the_command_of_the_unit()
 {
    let Some(mut typed) = Typed::start() else {
        return;
    };
    typed.kill(true);
    assert_ne!(typed.client.keymap(), typed.keymap);
    typed.release_keys();
    assert!(typed.is_keymap_restored());
}

#[test]
fn a_keymap_that_the_user_has_changed_since_a_run_was_killed_stays_unchanged() {
    let Some(mut typed) = Typed::start() else {
        return;
    };
    typed.kill(true);
    if set_keymap(&typed.server, &["br"]) {
        let expected = typed.client.keymap();
        typed.release_keys();
        assert_eq!(typed.client.keymap(), expected);
    }
}

#[test]
fn an_orderly_end_restores_the_keymap() {
    let Some(mut typed) = Typed::start() else {
        return;
    };
    typed.program.signal(&["INT"]);
    typed.program.wait_for_exit();
    assert_eq!(typed.client.keymap(), typed.keymap);
}
