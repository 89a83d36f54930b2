//! The legacy encoding: 13 numbers with `&` between them.

use super::{Button, Fields, unknown};
use crate::capture::protocol::PacketError;
use crate::hand::Finger;

/// Numbers in a line: five curls, the stick in two directions, then the buttons of [`BUTTONS`].
const VALUES: usize = Finger::COUNT + 2 + BUTTONS.len();

/// The buttons, in the order of their numbers.
const BUTTONS: [Button; 6] = [
    Button::Stick,
    Button::Trigger,
    Button::A,
    Button::B,
    Button::Grab,
    Button::Pinch,
];

/// Reads a line of exactly 13 whole numbers.
pub(super) fn parse(line: &[u8]) -> Result<Fields, PacketError> {
    let mut values = [0; VALUES];
    let mut count = 0;
    for word in line.split(|&byte| byte == b'&') {
        let number = std::str::from_utf8(word)?.parse();
        let number: i64 = number.map_err(|_| unknown("a value is not a whole number"))?;
        if let Some(value) = values.get_mut(count) {
            *value = number;
        }
        count += 1;
    }
    if count != VALUES {
        return Err(PacketError::wrong_count(count, VALUES));
    }
    let mut fields = Fields {
        curls: std::array::from_fn(|finger| Some(values[finger])),
        stick: [Some(values[Finger::COUNT]), Some(values[Finger::COUNT + 1])],
        ..Fields::default()
    };
    for (button, value) in BUTTONS.into_iter().zip(&values[Finger::COUNT + 2..]) {
        fields.buttons[button as usize] = *value > 0;
    }
    Ok(fields)
}
