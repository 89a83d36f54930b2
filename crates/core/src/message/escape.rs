//! Text of files and peers in a form that cannot act on a terminal.
//!
//! A name in a layout, a file name or the text of a peer may contain escape sequences, line breaks that start a false
//! message, characters that reverse the direction of the text, or a megabyte. [`escape`], or [`escape_path`], is applied
//! to each such field where it becomes part of a message: later, its line breaks look like line breaks of the message.
//! [`escape_line`] and [`escape_lines`] are applied to finished messages, and [`escape_json`] to JSON on a terminal.

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

/// Maximum length of a field in a message, in bytes.
const MAX_FIELD_BYTES: usize = 400;

/// Maximum length of a line, in bytes.
const MAX_LINE_BYTES: usize = 2_000;

/// Ends a text that was shortened.
const ELLIPSIS: char = '…';

/// Returns a field of a message as at most 400 bytes in one line: control characters, line breaks and invisible format
/// characters become `\n` or `\u{1b}`, and `…` replaces the end of a longer text.
pub fn escape(text: &str) -> Cow<'_, str> {
    escape_within(text, MAX_FIELD_BYTES)
}

/// Returns a path as [`escape`] does.
pub fn escape_path(path: &Path) -> String {
    escape(&path.to_string_lossy()).into_owned()
}

/// Returns a finished message of one line, escaped as by [`escape`], of at most 2000 bytes.
pub fn escape_line(text: &str) -> Cow<'_, str> {
    escape_within(text, MAX_LINE_BYTES)
}

/// Returns a finished message with its line breaks, and each line as by [`escape_line`].
pub fn escape_lines(text: &str) -> Cow<'_, str> {
    let is_plain = |line: &str| matches!(escape_line(line), Cow::Borrowed(_));
    if text.split('\n').all(is_plain) {
        return Cow::Borrowed(text);
    }
    let lines: Vec<_> = text.split('\n').map(escape_line).collect();
    Cow::Owned(lines.join("\n"))
}

/// Returns JSON in which no character acts on a terminal. It is equal when it is parsed.
pub fn escape_json(json: &str) -> Cow<'_, str> {
    // Line breaks between the values are part of the layout; JSON allows no control character in a string.
    let is_escaped = |character: char| character != '\n' && is_escaped(character);
    if !json.contains(is_escaped) {
        return Cow::Borrowed(json);
    }
    let mut escaped = String::with_capacity(json.len() + 8);
    for character in json.chars() {
        if !is_escaped(character) {
            escaped.push(character);
            continue;
        }
        for unit in character.encode_utf16(&mut [0; 2]) {
            // Writing to a string does not fail.
            let _ = write!(escaped, "\\u{unit:04x}");
        }
    }
    Cow::Owned(escaped)
}

/// Returns a word as a shell reads it: in single quotes, unless it has only letters, digits and `/._-+:,=@%`.
///
/// A word with characters that are escaped does not keep its value, and stays one word.
pub fn shell_word(word: &str) -> Cow<'_, str> {
    let word = escape(word);
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+:,=@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word
    } else {
        Cow::Owned(format!("'{}'", word.replace('\'', r"'\''")))
    }
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

/// Returns the escaped text, of at most `max_bytes`.
fn escape_within(text: &str, max_bytes: usize) -> Cow<'_, str> {
    if text.len() <= max_bytes && !text.contains(is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(max_bytes.min(2 * text.len()));
    // The end of the part that stays if the rest does not fit.
    let mut end = 0;
    for character in text.chars() {
        if is_escaped(character) {
            escaped.extend(character.escape_default());
        } else {
            escaped.push(character);
        }
        if escaped.len() > max_bytes {
            escaped.truncate(end);
            escaped.push(ELLIPSIS);
            break;
        }
        if escaped.len() + ELLIPSIS.len_utf8() <= max_bytes {
            end = escaped.len();
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

    #[test]
    fn a_megabyte_becomes_the_start_of_a_line() {
        let field = "x".repeat(MAX_FIELD_BYTES);
        assert!(matches!(escape(&field), Cow::Borrowed(_)));
        for long in ["x", "字", "\u{1b}"].map(|part| part.repeat(1 << 20)) {
            let line = format!("a{long}");
            let (cut_field, line) = (escape(&line), escape_line(&line));
            assert!(cut_field.len() <= MAX_FIELD_BYTES && cut_field.len() > MAX_FIELD_BYTES - 12);
            assert!(line.len() <= MAX_LINE_BYTES && line.len() > MAX_LINE_BYTES - 12);
            assert!(cut_field.starts_with('a') && cut_field.ends_with('…'));
        }
        let lines = format!("{}\nb", "x".repeat(3_000));
        assert!(escape_lines(&lines).ends_with("x…\nb"));
    }

    #[test]
    fn json_is_equal_without_characters_that_act_on_a_terminal() {
        let value = serde_json::json!({"name": "é\u{9b}2J\u{202e}\u{2028}\u{e0041}\u{1b}\n"});
        let pretty = format!("{value:#}");
        let printed = escape_json(&pretty);
        assert!(
            !printed.contains(|c: char| c != '\n' && is_escaped(c)),
            "{printed}"
        );
        assert!(
            printed.contains(r"é\u009b2J\u202e\u2028\udb40\udc41\u001b\n"),
            "{printed}"
        );
        let parsed: serde_json::Value = serde_json::from_str(&printed).unwrap();
        assert_eq!(parsed, value);
    }

    #[test]
    fn a_word_of_a_command_stays_one_word() {
        assert_eq!(
            shell_word("/dev/serial/by-id/usb-1"),
            "/dev/serial/by-id/usb-1"
        );
        assert_eq!(shell_word("a;touch b"), "'a;touch b'");
        assert_eq!(shell_word("it's\n"), r"'it'\''s\n'");
        assert_eq!(shell_word(""), "''");
    }
}
