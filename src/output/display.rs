//! A connection to a desktop through `enigo`: X11, Windows, macOS.

use std::thread;
use std::time::{Duration, Instant};

use enigo::{
    Axis, Button, Coordinate, Direction, Enigo, InputError, InputResult, Keyboard, Mouse,
    NewConError, Settings,
};

use super::pending_motion::StatelessAction;
use super::platform;
use super::worker::Injector;
use crate::device::{KeyCode, KeyKind};

/// How long a connection that wrote a character is kept. On X11 a character that the keymap lacks is
/// put into it for as long, and whoever receives the key looks there for what it means.
const KEYMAP_IS_READ: Duration = Duration::from_millis(200);

/// A connection to a display.
pub struct EnigoDisplay {
    name: Option<String>,
    enigo: Enigo,
    writer: Option<Writer>,
    size: Option<(i32, i32)>,
}

/// A connection of its own for characters: on X11 `enigo` delays every key after a character that it
/// had to put into the keymap.
struct Writer {
    enigo: Enigo,
    last: Instant,
}

impl EnigoDisplay {
    /// Connects to an X11 display by its name; without one, to the desktop of the session.
    pub fn connect(name: Option<&str>) -> Result<Self, String> {
        Ok(Self {
            name: name.map(str::to_owned),
            enigo: connect(name)?,
            writer: None,
            size: None,
        })
    }

    fn write(&mut self, character: char) -> Result<(), String> {
        let mut writer = match self.writer.take() {
            Some(writer) => writer,
            None => Writer {
                enigo: connect(self.name.as_deref())?,
                last: Instant::now(),
            },
        };
        let mut text = [0; 4];
        let outcome = writer.enigo.text(character.encode_utf8(&mut text));
        writer.last = Instant::now();
        self.writer = Some(writer);
        outcome.map_err(reason)
    }

    fn go_to(&mut self, x: f32, y: f32) -> Result<(), String> {
        let (width, height) = match self.size {
            Some(size) => size,
            None => *self.size.insert(self.enigo.main_display().map_err(reason)?),
        };
        let pixel = |share: f32, pixels: i32| (share * (pixels - 1) as f32).round() as i32;
        self.enigo
            .move_mouse(pixel(x, width), pixel(y, height), Coordinate::Abs)
            .map_err(reason)
    }

    fn turn(&mut self, right: i32, up: i32) -> InputResult<()> {
        if right != 0 {
            self.enigo.scroll(right, Axis::Horizontal)?;
        }
        if up != 0 {
            self.enigo.scroll(-up, Axis::Vertical)?;
        }
        Ok(())
    }
}

impl Injector for EnigoDisplay {
    fn inject(&mut self, key: KeyCode, direction: Direction) -> Result<(), String> {
        let outcome = match key.kind() {
            KeyKind::Keyboard => platform::inject(&mut self.enigo, key, direction),
            KeyKind::Mouse | KeyKind::Gamepad => press_button(&mut self.enigo, key, direction),
        };
        outcome.map_err(reason)
    }

    fn perform(&mut self, impulse: StatelessAction) -> Result<(), String> {
        match impulse {
            StatelessAction::Write(character) => self.write(character),
            StatelessAction::MoveBy(x, y) => {
                let outcome = self.enigo.move_mouse(x, y, Coordinate::Rel);
                outcome.map_err(reason)
            }
            StatelessAction::MoveTo(x, y) => self.go_to(x, y),
            StatelessAction::Scroll(right, up) => self.turn(right, up).map_err(reason),
        }
    }
}

impl Drop for EnigoDisplay {
    fn drop(&mut self) {
        if let Some(writer) = &self.writer {
            thread::sleep(KEYMAP_IS_READ.saturating_sub(writer.last.elapsed()));
        }
    }
}

fn connect(name: Option<&str>) -> Result<Enigo, String> {
    let settings = Settings {
        // The least that there is; it holds up clicks and scrolling only.
        linux_delay: 1,
        x11_display: name.map(str::to_owned),
        ..Settings::default()
    };
    Enigo::new(&settings).map_err(|error| connect_reason(error, name))
}

fn connect_reason(error: NewConError, display: Option<&str>) -> String {
    match error {
        NewConError::EstablishCon(_) => platform::no_display(display),
        NewConError::NoPermission => "the system does not let this program press keys; allow it \
             under System Settings, Privacy & Security, Accessibility"
            .into(),
        NewConError::Reply | NewConError::NoEmptyKeycodes => error.to_string(),
    }
}

/// Some texts of `enigo` have a placeholder that is never filled in.
fn reason(error: InputError) -> String {
    error.to_string().replace(": {e:?}", "")
}

fn press_button(enigo: &mut Enigo, key: KeyCode, direction: Direction) -> InputResult<()> {
    let button = match key.name() {
        "MouseLeft" => Button::Left,
        "MouseRight" => Button::Right,
        "MouseMiddle" => Button::Middle,
        "MouseBack" => Button::Back,
        "MouseForward" => Button::Forward,
        _ => return Err(InputError::InvalidInput("a desktop has no such button")),
    };
    enigo.button(button, direction)
}
