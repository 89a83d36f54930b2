//! The alpha encoding.

use std::fmt::Write;

use super::{Button, Fields, unknown};
use crate::capture::protocol::{InvalidPacket, PacketError};

/// Longest key, without its parentheses.
const MAX_KEY: usize = 3;

/// Reads a line that consists of fields, none of them twice.
pub(super) fn parse(line: &[u8]) -> Result<Fields, PacketError> {
    let mut fields = Fields::default();
    let mut rest = line;
    while !rest.is_empty() {
        let field = split_key(rest).and_then(|(key, rest)| Some((key, split_number(rest)?)));
        let (key, (value, after)) = field.ok_or_else(|| unknown("it is not a list of fields"))?;
        set(&mut fields, key, value)?;
        rest = after;
    }
    Ok(fields)
}

/// Splits a key off: a capital letter, or capital letters in parentheses.
fn split_key(text: &[u8]) -> Option<(&[u8], &[u8])> {
    let (key, rest) = match text {
        [b'(', rest @ ..] => {
            let end = rest.iter().position(|&byte| byte == b')')?;
            (&rest[..end], &rest[end + 1..])
        }
        _ => text.split_at_checked(1)?,
    };
    let is_key = (1..=MAX_KEY).contains(&key.len()) && key.iter().all(u8::is_ascii_uppercase);
    is_key.then_some((key, rest))
}

/// Splits a number off; the number is `None` if there is none. One that is too large counts as the largest.
fn split_number(text: &[u8]) -> Option<(Option<i64>, &[u8])> {
    let (sign, digits) = match text {
        [b'-', rest @ ..] => (-1, rest),
        _ => (1, text),
    };
    let length = digits
        .iter()
        .take_while(|byte| byte.is_ascii_digit())
        .count();
    let (digits, rest) = digits.split_at(length);
    if digits.is_empty() {
        return (sign > 0).then_some((None, rest));
    }
    let value = digits.iter().fold(0_i64, |value, digit| {
        let next = value.saturating_mul(10);
        next.saturating_add(i64::from(digit - b'0'))
    });
    Some((Some(sign * value), rest))
}

/// Sets the field of a key.
fn set(fields: &mut Fields, key: &[u8], value: Option<i64>) -> Result<(), PacketError> {
    let slot = match *key {
        [letter] => {
            if let Some(button) = Button::KEYS
                .iter()
                .position(|&button_key| button_key == letter)
            {
                let is_repeated = std::mem::replace(&mut fields.buttons[button], true);
                return if is_repeated { Err(twice()) } else { Ok(()) };
            }
            match letter {
                b'A'..=b'E' => &mut fields.curls[usize::from(letter - b'A')],
                b'F' | b'G' => &mut fields.stick[usize::from(letter - b'F')],
                b'P' => &mut fields.trigger,
                _ => return Ok(()),
            }
        }
        [finger @ b'A'..=b'E', b'B'] => &mut fields.splays[usize::from(finger - b'A')],
        [finger @ b'A'..=b'E', b'A', joint @ b'A'..=b'D'] => {
            &mut fields.joints[usize::from(finger - b'A')][usize::from(joint - b'A')]
        }
        _ => return Ok(()),
    };
    let value = value.ok_or_else(|| unknown("a field has no number"))?;
    match slot.replace(value) {
        None => Ok(()),
        Some(_) => Err(twice()),
    }
}

/// Returns the error of a cut line with the next one after it.
fn twice() -> PacketError {
    PacketError::new(InvalidPacket::Truncated, "it has a field twice")
}

/// Writes the fields in the order of the firmware, then the joints.
pub(super) fn encode(fields: &Fields) -> String {
    let mut line = String::new();
    let mut number = |key: &str, value: Option<i64>| {
        if let Some(value) = value {
            write!(line, "{key}{value}").expect("a string accepts every text");
        }
    };
    for (key, curl) in ["A", "B", "C", "D", "E"].into_iter().zip(fields.curls) {
        number(key, curl);
    }
    number("F", fields.stick[0]);
    number("G", fields.stick[1]);
    number("P", fields.trigger);
    for (key, is_down) in Button::KEYS.into_iter().zip(fields.buttons) {
        if is_down {
            line.push(char::from(key));
        }
    }
    for (finger, splay) in ('A'..='E').zip(fields.splays) {
        if let Some(splay) = splay {
            write!(line, "({finger}B){splay}").expect("a string accepts every text");
        }
    }
    for (finger, joints) in ('A'..='E').zip(fields.joints) {
        for (joint, value) in ('A'..='D').zip(joints) {
            if let Some(value) = value {
                write!(line, "({finger}A{joint}){value}").expect("a string accepts every text");
            }
        }
    }
    line.push('\n');
    line
}
