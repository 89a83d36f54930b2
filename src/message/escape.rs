//! Text of files and peers in a form that cannot act on a terminal.
//!
//! A name in a layout, a file name or the text of a peer may contain escape sequences, line breaks that start a false
//! message, or characters that reverse the direction of the text. [`escape`] is applied where such a text becomes part
//! of a message, [`escape_lines`] where a message of several lines is printed.

use std::borrow::Cow;

/// Returns `text` as one line: control characters, line breaks and invisible format characters become `\n` or
/// `\u{1b}`.
pub fn escape(text: &str) -> Cow<'_, str> {
    escape_where(text, is_escaped)
}

/// Returns `text` escaped as by [`escape`], except for its line breaks.
pub fn escape_lines(text: &str) -> Cow<'_, str> {
    escape_where(text, |character| character != '\n' && is_escaped(character))
}

/// Returns `true` for a character that acts on a terminal or on the text around it instead of being visible: a control
/// character, a line or paragraph separator, or a format character for direction, annotation or tags.
///
/// The joiners U+200C and U+200D are part of words and stay as they are.
pub fn is_escaped(character: char) -> bool {
    character.is_control()
        || matches!(character,
            '\u{ad}'
            | '\u{61c}'
            | '\u{180e}'
            | '\u{200b}'
            | '\u{200e}' | '\u{200f}'
            | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}'
            | '\u{feff}'
            | '\u{fff9}'..='\u{fffb}'
            | '\u{e0000}'..='\u{e007f}')
}

fn escape_where(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len() + 8);
    for character in text.chars() {
        match is_escaped(character) {
            true => escaped.extend(character.escape_default()),
            false => escaped.push(character),
        }
    }
    Cow::Owned(escaped)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_becomes_one_line_that_cannot_act_on_a_terminal() {
        let table = [
            ("Tecla Ñ — 字 👩\u{200d}💻", "Tecla Ñ — 字 👩\u{200d}💻"),
            ("\u{1b}[31mred", "\\u{1b}[31mred"),
            ("a\nerror: b\r\n\t", "a\\nerror: b\\r\\n\\t"),
            ("\u{9b}2J\u{7f}\0", "\\u{9b}2J\\u{7f}\\u{0}"),
            ("user\u{202e}nor.yek", "user\\u{202e}nor.yek"),
            (
                "a\u{2066}b\u{2069}\u{200f}",
                "a\\u{2066}b\\u{2069}\\u{200f}",
            ),
            ("x\u{2028}y\u{feff}", "x\\u{2028}y\\u{feff}"),
            ("tag\u{e0041}", "tag\\u{e0041}"),
        ];
        for (text, expected) in table {
            assert_eq!(escape(text), expected);
        }
    }

    #[test]
    fn a_message_of_several_lines_keeps_its_line_breaks_only() {
        assert_eq!(escape_lines("a\nb\r\u{1b}[2J"), "a\nb\\r\\u{1b}[2J");
        assert!(matches!(escape_lines("a\n 2 | b"), Cow::Borrowed(_)));
    }
}
