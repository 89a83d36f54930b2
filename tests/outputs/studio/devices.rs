//! Sources that are chosen in the window of the real program, with the keyboard of an X server.

use std::time::Duration;

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat, KEY_PRESS_EVENT, KEY_RELEASE_EVENT};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

use super::safety::{Session, TRANSCRIPT};
use crate::support::x11::{XServer, wait_at_most, wait_for};

/// Keysyms of keys without a character.
const F9: u32 = 0xffc6;
const ENTER: u32 = 0xff0d;
const ESCAPE: u32 = 0xff1b;
const SHIFT: u32 = 0xffe1;
const CONTROL: u32 = 0xffe3;

/// A point in the margin of the window of the devices, in a corner of the 3D view where no hand is.
const MARGIN: (i16, i16) = (15, 330);

/// Time in which a tapped key shows.
const TAP_TIMEOUT: Duration = Duration::from_secs(10);

/// The keyboard of an X server, on which a person types.
struct Keyboard {
    client: RustConnection,
    /// The keysyms of each key, without Shift and with it.
    keysyms: Vec<[u32; 2]>,
    first: u8,
}

impl Keyboard {
    fn new(server: &XServer) -> Self {
        let (client, _) = x11rb::connect(Some(server.display())).expect("the server answers");
        let setup = client.setup();
        let (first, last) = (setup.min_keycode, setup.max_keycode);
        let mapping = client.get_keyboard_mapping(first, last - first + 1);
        let mapping = mapping.expect("a request").reply().expect("a keyboard");
        let columns = usize::from(mapping.keysyms_per_keycode);
        let keysyms = mapping.keysyms.chunks(columns);
        let keysyms = keysyms.map(|keysyms| [keysyms[0], keysyms[1]]).collect();
        Self {
            client,
            keysyms,
            first,
        }
    }

    /// Returns `true` if the window of the devices is seen: it is gray, and the 3D view behind it is blue there.
    fn is_open(&self) -> bool {
        let root = self.client.setup().roots[0].root;
        let (x, y) = MARGIN;
        let image = self
            .client
            .get_image(ImageFormat::Z_PIXMAP, root, x, y, 1, 1, !0);
        let image = image.expect("a request").reply().expect("an image");
        let [blue, green, red, _] = image.data[..] else {
            panic!("a pixel has four bytes: {:?}", image.data);
        };
        red == green && green == blue
    }

    /// Opens the window of the devices or closes it, and waits until that is seen: keys before go elsewhere. A key that comes before
    /// Studio reads keys is lost, so it is tapped again.
    fn toggle_devices(&self) {
        let wanted = !self.is_open();
        for _ in 0..10 {
            self.tap(F9);
            if wait_at_most(TAP_TIMEOUT, || self.is_open() == wanted) {
                // The field gets the focus with the next picture.
                std::thread::sleep(Duration::from_millis(500));
                return;
            }
        }
        panic!("F9 changes nothing");
    }

    fn fake(&self, kind: u8, code: u8) {
        let event = self
            .client
            .xtest_fake_input(kind, code, 0, x11rb::NONE, 0, 0, 0);
        let event = event.expect("the server runs").check();
        event.expect("the server has XTEST");
        // A person is slower than the window.
        std::thread::sleep(Duration::from_millis(15));
    }

    /// Presses and releases the key of a keysym, with Shift where that is needed.
    fn tap(&self, keysym: u32) {
        let find = |column: usize| self.keysyms.iter().position(|key| key[column] == keysym);
        let (index, needs_shift) = match find(0) {
            Some(index) => (index, false),
            None => (find(1).expect("a key"), true),
        };
        let code = |key_index: usize| self.first + u8::try_from(key_index).expect("a code");
        let shift = code(
            self.keysyms
                .iter()
                .position(|key| key[0] == SHIFT)
                .expect("a key"),
        );
        if needs_shift {
            self.fake(KEY_PRESS_EVENT, shift);
        }
        self.fake(KEY_PRESS_EVENT, code(index));
        self.fake(KEY_RELEASE_EVENT, code(index));
        if needs_shift {
            self.fake(KEY_RELEASE_EVENT, shift);
        }
    }

    /// Replaces the words of the field that has the focus, and confirms them.
    fn enter(&self, words: &str) {
        let control = self.keysyms.iter().position(|key| key[0] == CONTROL);
        let control = self.first + u8::try_from(control.expect("a key")).expect("a code");
        self.fake(KEY_PRESS_EVENT, control);
        self.tap(u32::from('a'));
        self.fake(KEY_RELEASE_EVENT, control);
        for character in words.chars() {
            self.tap(u32::from(character));
        }
        self.tap(ENTER);
    }
}

#[test]
fn a_missing_port_leaves_the_session_and_another_source_replaces_it() {
    let Some(session) = Session::start(TRANSCRIPT) else {
        return;
    };
    session.server.focus_visible_window();
    let keyboard = Keyboard::new(&session.server);
    // The tour of the first start would have the first Enter.
    keyboard.tap(ESCAPE);
    keyboard.toggle_devices();
    keyboard.enter("serial:/dev/no-such-port");
    session.wait_for_typing();
    let armed = |counted: &Session| {
        let lines = counted.program.stderr_lines();
        lines.iter().filter(|line| line.contains("armed")).count()
    };
    assert_eq!(armed(&session), 1, "{:#?}", session.program.stderr_lines());
    // The field has lost the focus with Enter.
    keyboard.toggle_devices();
    keyboard.toggle_devices();
    keyboard.enter("typist:hello");
    let is_typed = || session.transcript("events.2").contains("down O");
    assert!(wait_for(is_typed), "{:#?}", session.program.stderr_lines());
}
