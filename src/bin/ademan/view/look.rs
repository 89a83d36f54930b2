//! Colors and characters, as the environment asks for them: `NO_COLOR`, `CLICOLOR`, `CLICOLOR_FORCE`, `TERM` and the
//! locale.

use std::borrow::Cow;
use std::env;

use ademan::hand::{Finger, Side};
use ademan::pipeline::PipelineState;
use ratatui::buffer::Buffer;
use ratatui::style::{Color, Modifier, Style};

use super::terminal::HAS_LOCALE;

/// Fraction of errors from which a key is hot.
const HOT: f64 = 1.0 / 3.0;

/// The look of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    pub has_colors: bool,
    /// `true` if the locale has box characters.
    pub is_unicode: bool,
}

impl Look {
    pub fn from_environment() -> Self {
        Self::from_variables(|name| env::var(name).ok().filter(|value| !value.is_empty()))
    }

    fn from_variables(get: impl Fn(&str) -> Option<String>) -> Self {
        let is_forced = get("CLICOLOR_FORCE").is_some_and(|value| value != "0");
        let is_dumb = get("TERM").is_some_and(|term| term == "dumb");
        let is_off = get("CLICOLOR").is_some_and(|value| value == "0");
        let locale = ["LC_ALL", "LC_CTYPE", "LANG"]
            .iter()
            .find_map(|name| get(name));
        let locale = locale.unwrap_or_default().to_lowercase();
        Self {
            has_colors: get("NO_COLOR").is_none() && (is_forced || !is_dumb && !is_off),
            is_unicode: !HAS_LOCALE || locale.contains("utf-8") || locale.contains("utf8"),
        }
    }

    fn colored(self, color: Color) -> Style {
        if self.has_colors {
            Style::new().fg(color)
        } else {
            Style::new()
        }
    }

    /// Returns the style of a pressed key.
    pub fn pressed(self) -> Style {
        if self.has_colors {
            Style::new()
                .fg(Color::Black)
                .bg(Color::Green)
                .add_modifier(Modifier::BOLD)
        } else {
            Style::new().add_modifier(Modifier::BOLD | Modifier::REVERSED)
        }
    }

    /// Returns the style of a key by its fraction of errors.
    pub fn heat(self, error_rate: f64) -> Style {
        if error_rate <= 0.0 {
            return Style::new();
        }
        let is_hot = error_rate >= HOT;
        if self.has_colors {
            let color = if is_hot { Color::Red } else { Color::Yellow };
            Style::new().fg(Color::Black).bg(color)
        } else if is_hot {
            Style::new().add_modifier(Modifier::BOLD | Modifier::REVERSED)
        } else {
            Style::new().add_modifier(Modifier::REVERSED)
        }
    }

    /// Returns the style of text that is less important.
    pub fn faint(self) -> Style {
        Style::new().add_modifier(Modifier::DIM)
    }

    /// Returns the style of the state of a session.
    pub fn state(self, state: PipelineState) -> Style {
        let color = match state {
            PipelineState::Running => Color::Green,
            PipelineState::Stalled => Color::Red,
            _ => Color::Yellow,
        };
        let style = self.colored(color);
        style.add_modifier(Modifier::BOLD | Modifier::REVERSED)
    }

    /// Returns the style of a fingertip.
    pub fn fingertip(self, finger: Finger) -> Style {
        let color = match finger {
            Finger::Thumb => Color::Magenta,
            Finger::Index => Color::Yellow,
            Finger::Middle => Color::Cyan,
            Finger::Ring => Color::LightBlue,
            Finger::Little => Color::LightRed,
        };
        let style = self.colored(color).add_modifier(Modifier::BOLD);
        if self.is_unicode {
            style
        } else {
            style.add_modifier(Modifier::UNDERLINED)
        }
    }

    /// Returns a text with other characters in place of those that the locale does not have.
    pub fn text(self, text: &str) -> Cow<'_, str> {
        if self.is_unicode || text.is_ascii() {
            return text.into();
        }
        let replaced = text
            .chars()
            .map(|it| if it.is_ascii() { it } else { ascii(it) });
        replaced.collect::<String>().into()
    }

    /// Replaces all characters that the locale does not have.
    pub fn apply(self, buffer: &mut Buffer) {
        if self.is_unicode {
            return;
        }
        for cell in &mut buffer.content {
            if !cell.symbol().is_ascii() {
                let first = cell.symbol().chars().next().unwrap_or(' ');
                cell.set_char(ascii(first));
            }
        }
    }
}

/// Numbers of the fingers, from the thumb to the little finger, as pianists count them.
const ABOVE: [char; Finger::COUNT] = ['①', '②', '③', '④', '⑤'];
const INSIDE: [char; Finger::COUNT] = ['❶', '❷', '❸', '❹', '❺'];

/// Returns the mark of a fingertip: a number in a circle, which is filled if the fingertip is in the board.
pub fn finger_mark(finger: Finger, is_inside: bool) -> char {
    let marks = if is_inside { INSIDE } else { ABOVE };
    marks[finger.index()]
}

/// Returns the word for a hand.
pub fn hand_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left ",
        Side::Right => "right",
    }
}

fn ascii(character: char) -> char {
    let number = |marks: [char; Finger::COUNT]| marks.iter().position(|mark| *mark == character);
    if let Some(number) = number(ABOVE).or_else(|| number(INSIDE)) {
        return char::from(b'1' + number as u8);
    }
    match character {
        '─' | '━' => '-',
        '│' | '┃' => '|',
        '┌' | '┐' | '└' | '┘' | '╭' | '╮' | '╰' | '╯' | '├' | '┤' | '┬' | '┴' | '┼' => {
            '+'
        }
        '█' => '#',
        '░' | '·' => '.',
        '▕' => '[',
        '▏' => ']',
        '→' => '>',
        '←' => '<',
        '↑' => '^',
        '↓' => 'v',
        '×' => 'x',
        '✛' => '+',
        '−' | '–' | '—' => '-',
        '…' => '~',
        '●' => '*',
        '○' => 'o',
        '▶' => '>',
        '°' => ' ',
        '↵' | '⏎' | '⇥' => '/',
        '⇧' => '^',
        '⌫' => '<',
        '\u{2801}'..='\u{28ff}' => '#',
        _ => '?',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(variables: &[(&str, &str)]) -> Look {
        Look::from_variables(|name| {
            let found = variables.iter().find(|(known, _)| *known == name);
            found.map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn the_environment_chooses_colors() {
        let table: [(&[(&str, &str)], bool); 7] = [
            (&[], true),
            (&[("TERM", "xterm")], true),
            (&[("TERM", "dumb")], false),
            (&[("CLICOLOR", "0")], false),
            (&[("CLICOLOR", "0"), ("CLICOLOR_FORCE", "1")], true),
            (&[("TERM", "dumb"), ("CLICOLOR_FORCE", "0")], false),
            (&[("NO_COLOR", "1"), ("CLICOLOR_FORCE", "1")], false),
        ];
        for (variables, expected) in table {
            assert_eq!(look(variables).has_colors, expected, "{variables:?}");
        }
    }

    #[test]
    fn a_text_has_the_characters_of_the_locale() {
        let drawing = "┌──┐\n│⏎ │\n└──┘\n";
        let ascii = Look {
            has_colors: false,
            is_unicode: false,
        };
        assert_eq!(ascii.text(drawing), "+--+\n|/ |\n+--+\n");
        let unicode = Look {
            is_unicode: true,
            ..ascii
        };
        assert_eq!(unicode.text(drawing), drawing);
    }

    #[test]
    fn the_locale_chooses_the_characters() {
        let table: [(&[(&str, &str)], bool); 5] = [
            (&[], !HAS_LOCALE),
            (&[("LANG", "es_MX.UTF-8")], true),
            (&[("LANG", "C")], !HAS_LOCALE),
            (&[("LANG", "C.utf8")], true),
            (&[("LC_ALL", "C"), ("LANG", "es_MX.UTF-8")], !HAS_LOCALE),
        ];
        for (variables, expected) in table {
            assert_eq!(look(variables).is_unicode, expected, "{variables:?}");
        }
    }
}
