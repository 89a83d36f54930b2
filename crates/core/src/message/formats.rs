//! Text of others in files for browsers and spreadsheets.

use super::is_escaped;

/// Escapes a text for use between tags or in quotes. Characters that XML does not allow, and those that act on the text around
/// them, become U+FFFD.
pub fn escape_markup(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\t' | '\n' => escaped.push(' '),
            '\u{fffe}' | '\u{ffff}' => escaped.push(char::REPLACEMENT_CHARACTER),
            other if is_escaped(other) => escaped.push(char::REPLACEMENT_CHARACTER),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Returns a field of CSV: in quotes if it needs them. A spreadsheet executes no field as a formula.
pub fn quote_csv(text: &str) -> String {
    let text = if text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        format!("'{text}")
    } else {
        text.to_owned()
    };
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_xml_forbids_is_replaced() {
        assert_eq!(
            escape_markup("<a & \"b\">"),
            "&lt;a &amp; &quot;b&quot;&gt;"
        );
        assert_eq!(escape_markup("\u{1}\u{ffff}\t"), "\u{fffd}\u{fffd} ");
        assert_eq!(escape_markup("a\u{202e}b\u{2066}"), "a\u{fffd}b\u{fffd}");
    }
}
