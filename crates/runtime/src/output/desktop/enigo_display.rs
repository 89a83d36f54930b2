//! A connection to a desktop through `enigo`: Windows, macOS, and X11 on operating systems other than Linux.

use std::thread;
use std::time::{Duration, Instant};

use enigo::{
    Axis, Button, Coordinate, Direction, Enigo, InputError, InputResult, Keyboard, Mouse,
    NewConError, Settings,
};

use super::burst::{self, Stroke};
use super::injector::Injector;
use super::key_reporter::KeyReporter;
use super::pending_motion::StatelessAction;
use super::system;
use ademan_core::device::pressed_keys::KeyDirection;
use ademan_core::device::{KeyCode, KeyKind};

/// Minimum time between a character and the end of its connection. On X11 a character that the keymap lacks is in the
/// keymap only as long as the connection, and the receiver of the key looks it up there.
const KEYMAP_LIFETIME: Duration = Duration::from_millis(200);

/// A connection to a display.
pub struct EnigoDisplay {
    name: Option<String>,
    enigo: Enigo,
    character_connection: Option<CharacterConnection>,
    size: Option<(i32, i32)>,
}

/// A separate connection for characters: on X11 `enigo` delays every key after a character that it has added to the
/// keymap.
struct CharacterConnection {
    enigo: Enigo,
    last_use: Instant,
}

impl EnigoDisplay {
    /// Connects to the X11 display of this name, or to the desktop of the session.
    pub fn connect(name: Option<&str>) -> Result<Self, String> {
        Ok(Self {
            name: name.map(str::to_owned),
            enigo: connect(name)?,
            character_connection: None,
            size: None,
        })
    }

    fn type_characters(&mut self, text: &str) -> Result<(), String> {
        let mut connection = match self.character_connection.take() {
            Some(connection) => connection,
            None => CharacterConnection {
                enigo: connect(self.name.as_deref())?,
                last_use: Instant::now(),
            },
        };
        let result = connection.enigo.text(text);
        connection.last_use = Instant::now();
        self.character_connection = Some(connection);
        result.map_err(message)
    }

    fn move_to(&mut self, x: f32, y: f32) -> Result<(), String> {
        let (width, height) = match self.size {
            Some(size) => size,
            None => *self
                .size
                .insert(self.enigo.main_display().map_err(message)?),
        };
        let pixel = |fraction: f32, pixels: i32| (fraction * (pixels - 1) as f32).round() as i32;
        self.enigo
            .move_mouse(pixel(x, width), pixel(y, height), Coordinate::Abs)
            .map_err(message)
    }

    fn scroll(&mut self, right: i32, up: i32) -> InputResult<()> {
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
    fn inject(&mut self, key: KeyCode, direction: KeyDirection) -> Result<(), String> {
        let direction = match direction {
            KeyDirection::Press => Direction::Press,
            KeyDirection::Release => Direction::Release,
        };
        let result = match key.kind() {
            KeyKind::Keyboard => system::inject_key(&mut self.enigo, key, direction),
            KeyKind::Mouse | KeyKind::Gamepad => inject_button(&mut self.enigo, key, direction),
        };
        result.map_err(message)
    }

    fn perform(&mut self, action: StatelessAction) -> Result<(), String> {
        match action {
            StatelessAction::MoveBy(x, y) => {
                let result = self.enigo.move_mouse(x, y, Coordinate::Rel);
                result.map_err(message)
            }
            StatelessAction::MoveTo(x, y) => self.move_to(x, y),
            StatelessAction::Scroll(right, up) => self.scroll(right, up).map_err(message),
        }
    }

    fn type_burst(&mut self, strokes: &[Stroke], _: &mut KeyReporter) -> Result<bool, String> {
        let are_characters =
            |first: &Stroke, second: &Stroke| first.character().and(second.character()).is_some();
        for run in strokes.chunk_by(are_characters) {
            match run[0] {
                Stroke::Key(key, direction) => self.inject(key, direction)?,
                Stroke::Character(_) => self.type_characters(&burst::text(run))?,
            }
        }
        Ok(true)
    }
}

impl Drop for EnigoDisplay {
    fn drop(&mut self) {
        if let Some(connection) = &self.character_connection {
            thread::sleep(KEYMAP_LIFETIME.saturating_sub(connection.last_use.elapsed()));
        }
    }
}

fn connect(name: Option<&str>) -> Result<Enigo, String> {
    let settings = Settings {
        // The minimum; it delays clicks and scrolling only.
        linux_delay: 1,
        x11_display: name.map(str::to_owned),
        ..Settings::default()
    };
    Enigo::new(&settings).map_err(|error| connect_message(error, name))
}

fn connect_message(error: NewConError, display: Option<&str>) -> String {
    match error {
        NewConError::EstablishCon(_) => system::no_display(display),
        NewConError::NoPermission => "the system does not let this program press keys; allow it \
             under System Settings, Privacy & Security, Accessibility"
            .into(),
        NewConError::Reply | NewConError::NoEmptyKeycodes => error.to_string(),
    }
}

/// Removes the placeholder that `enigo` leaves unfilled in some of its messages.
fn message(error: InputError) -> String {
    error.to_string().replace(": {e:?}", "")
}

fn inject_button(enigo: &mut Enigo, key: KeyCode, direction: Direction) -> InputResult<()> {
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
