//! Brackets, separators and words of a RON text, without its strings and comments.

use std::ops::Range;

/// A part of the text that is neither blank nor comment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token {
    /// The kind.
    pub kind: TokenKind,
    /// The bytes.
    pub range: Range<usize>,
}

/// The kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TokenKind {
    /// `(`, `[` or `{`.
    Open(u8),
    /// `)`, `]` or `}`.
    Close(u8),
    /// `,`
    Comma,
    /// `:`
    Colon,
    /// A name or a number.
    Word,
    /// A text or character with its quotes.
    Quoted,
    /// Any other character.
    Other,
}

/// An element of a list, an entry of a map, or a field or value in parentheses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    /// The bracket around it.
    pub bracket: u8,
    /// The bytes, with the comma after it.
    pub range: Range<usize>,
    /// The bytes between the brackets around it.
    pub inside: Range<usize>,
}

impl Element {
    /// Returns the name of the field, if it is one.
    pub fn field<'t>(&self, text: &'t str) -> Option<&'t str> {
        let slice = &text[self.range.clone()];
        let mut tokens = tokens(slice);
        match [tokens.next()?, tokens.next()?] {
            [
                Token {
                    kind: TokenKind::Word,
                    range,
                },
                Token {
                    kind: TokenKind::Colon,
                    ..
                },
            ] => Some(&slice[range]),
            _ => None,
        }
    }
}

/// Returns the tokens of a text.
pub(super) fn tokens(text: &str) -> impl Iterator<Item = Token> {
    let mut offset = 0;
    std::iter::from_fn(move || {
        offset += skipped(&text[offset..]);
        let rest = &text[offset..];
        let first = *rest.as_bytes().first()?;
        let (kind, length) = match first {
            b'(' | b'[' | b'{' => (TokenKind::Open(first), 1),
            b')' | b']' | b'}' => (TokenKind::Close(first), 1),
            b',' => (TokenKind::Comma, 1),
            b':' => (TokenKind::Colon, 1),
            _ => match quoted(rest) {
                Some(length) => (TokenKind::Quoted, length),
                None => word_or_other(rest),
            },
        };
        let start = offset;
        offset += length;
        Some(Token {
            kind,
            range: start..offset,
        })
    })
}

/// Returns the elements around an offset, innermost first. Elements that are not closed are left out.
pub(super) fn elements_around(text: &str, offset: usize) -> Vec<Element> {
    let tokens: Vec<Token> = tokens(text).collect();
    let (before, after) =
        tokens.split_at(tokens.partition_point(|token| token.range.end <= offset));
    // The bracket, the start of what is in it, and the start of its current element.
    let mut open: Vec<(u8, usize, usize)> = Vec::new();
    for token in before {
        match token.kind {
            TokenKind::Open(bracket) => open.push((bracket, token.range.end, token.range.end)),
            TokenKind::Close(_) => drop(open.pop()),
            TokenKind::Comma => {
                if let Some((_, _, start)) = open.last_mut() {
                    *start = token.range.end;
                }
            }
            _ => {}
        }
    }
    let mut elements = Vec::new();
    let (mut nested, mut end) = (0_usize, None);
    for token in after {
        match token.kind {
            TokenKind::Open(_) => nested += 1,
            TokenKind::Close(_) if nested > 0 => nested -= 1,
            TokenKind::Close(_) => {
                let Some((bracket, inside, start)) = open.pop() else {
                    break;
                };
                let close = token.range.start;
                elements.push(Element {
                    bracket,
                    range: start..end.take().unwrap_or(close),
                    inside: inside..close,
                });
            }
            TokenKind::Comma if nested == 0 && end.is_none() => end = Some(token.range.end),
            _ => {}
        }
    }
    elements
}

/// Returns the bytes of the value that starts at an offset: a token, with the content of its brackets or of the brackets that follow
/// a name.
pub(super) fn value_at(text: &str, offset: usize) -> Option<Range<usize>> {
    let mut tokens = tokens(&text[offset..]).peekable();
    let mut last = tokens.next()?;
    let start = offset + last.range.start;
    if last.kind == TokenKind::Word
        && let Some(open) = tokens.next_if(|next| next.kind == TokenKind::Open(b'('))
    {
        last = open;
    }
    let mut depth = usize::from(matches!(last.kind, TokenKind::Open(_)));
    while depth > 0 {
        last = tokens.next()?;
        match last.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth -= 1,
            _ => {}
        }
    }
    Some(start..offset + last.range.end)
}

/// Returns the value of the first field with this name.
pub(super) fn field_value<'t>(text: &'t str, name: &str) -> Option<&'t str> {
    let mut tokens = tokens(text).peekable();
    while let Some(token) = tokens.next() {
        if token.kind == TokenKind::Word
            && &text[token.range] == name
            && let Some(colon) = tokens.next_if(|next| next.kind == TokenKind::Colon)
        {
            return Some(&text[value_at(text, colon.range.end)?]);
        }
    }
    None
}

/// Returns a text whose lines after the first one begin with `new` in place of `old`. Lines that begin otherwise stay as they are, and
/// so do the lines of texts in quotes.
pub(crate) fn reindented(text: &str, old: &str, new: &str) -> String {
    let (old, new) = (format!("\n{old}"), format!("\n{new}"));
    let mut result = String::with_capacity(text.len());
    let mut end = 0;
    for token in tokens(text).filter(|token| token.kind == TokenKind::Quoted) {
        result.push_str(&text[end..token.range.start].replace(&old, &new));
        result.push_str(&text[token.range.clone()]);
        end = token.range.end;
    }
    result.push_str(&text[end..].replace(&old, &new));
    result
}

/// Returns the first bracket that is not closed, or is closed by one of another kind, and that other bracket.
pub(super) fn unbalanced(text: &str) -> Option<(Token, Option<Token>)> {
    let mut open: Vec<Token> = Vec::new();
    for token in tokens(text) {
        match token.kind {
            TokenKind::Open(_) => open.push(token),
            TokenKind::Close(close) => {
                let opened = open.pop()?;
                if opened.kind != TokenKind::Open(opening(close)) {
                    return Some((opened, Some(token)));
                }
            }
            _ => {}
        }
    }
    Some((open.pop()?, None))
}

const fn opening(close: u8) -> u8 {
    match close {
        b')' => b'(',
        b']' => b'[',
        _ => b'{',
    }
}

/// Returns the length of the blanks and comments at the start.
fn skipped(text: &str) -> usize {
    let mut rest = text;
    loop {
        rest = rest.trim_start();
        rest = if let Some(comment) = rest.strip_prefix("//") {
            comment.find('\n').map_or("", |end| &comment[end..])
        } else if let Some(comment) = rest.strip_prefix("/*") {
            after_block_comment(comment)
        } else {
            return text.len() - rest.len();
        };
    }
}

/// Returns what follows a block comment, in which others may be nested.
fn after_block_comment(mut rest: &str) -> &str {
    let mut depth = 1;
    while depth > 0 {
        let (end, start) = (rest.find("*/"), rest.find("/*"));
        rest = match (end, start) {
            (Some(end), Some(start)) if start < end => {
                depth += 1;
                &rest[start + 2..]
            }
            (Some(end), _) => {
                depth -= 1;
                &rest[end + 2..]
            }
            (None, _) => "",
        };
        if rest.is_empty() {
            break;
        }
    }
    rest
}

/// Returns the length of the text or character in quotes at the start, to the end of the file if it is not closed.
fn quoted(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    if bytes[0] == b'\'' {
        let line = text.lines().next().unwrap_or_default();
        let end = line.char_indices().skip(2).find(|(_, c)| *c == '\'');
        return end.map(|(end, _)| end + 1);
    }
    if bytes[0] == b'r' {
        let hashes = bytes[1..].iter().take_while(|byte| **byte == b'#').count();
        let start = 1 + hashes;
        if bytes.get(start) != Some(&b'"') {
            return None;
        }
        let end = format!("\"{}", "#".repeat(hashes));
        let found = text[start + 1..].find(&end);
        return Some(found.map_or(text.len(), |found| start + 1 + found + end.len()));
    }
    if bytes[0] != b'"' {
        return None;
    }
    let mut escaped = false;
    for (index, byte) in bytes.iter().enumerate().skip(1) {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return Some(index + 1),
            _ => {}
        }
    }
    Some(text.len())
}

fn word_or_other(text: &str) -> (TokenKind, usize) {
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-');
    let end = text.find(|c| !is_word(c)).unwrap_or(text.len());
    match end {
        0 => (
            TokenKind::Other,
            text.chars().next().map_or(1, char::len_utf8),
        ),
        _ => (TokenKind::Word, end),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "A(b: [1, (c: \"x, ]\", d: -2.5), /* ( */ 3], e: 'é', // }\n f: r#\"(\"#)";

    #[test]
    fn strings_and_comments_hide_brackets_and_commas() {
        let slices: Vec<&str> = tokens(TEXT).map(|token| &TEXT[token.range]).collect();
        let expected = "A ( b : [ 1 , ( c : \"x, ]\" , d : -2.5 ) , 3 ] , e : 'é' , f : r#\"(\"# )";
        assert_eq!(slices.join(" "), expected);
        assert_eq!(unbalanced(TEXT), None);
        assert_eq!(unbalanced("([)").unwrap().1.unwrap().range, 2..3);
        assert_eq!(unbalanced("([]").unwrap().0.range, 0..1);
    }

    #[test]
    fn the_elements_around_an_offset_are_found_from_the_inside() {
        let offset = TEXT.find("-2.5").unwrap();
        let elements = elements_around(TEXT, offset);
        let slices: Vec<&str> = elements
            .iter()
            .map(|it| TEXT[it.range.clone()].trim())
            .collect();
        let list = "b: [1, (c: \"x, ]\", d: -2.5), /* ( */ 3],";
        assert_eq!(slices, ["d: -2.5", "(c: \"x, ]\", d: -2.5),", list]);
        let fields: Vec<_> = elements.iter().map(|element| element.field(TEXT)).collect();
        assert_eq!(fields, [Some("d"), None, Some("b")]);
    }

    #[test]
    fn a_field_has_a_value() {
        assert_eq!(
            field_value(TEXT, "b"),
            Some("[1, (c: \"x, ]\", d: -2.5), /* ( */ 3]")
        );
        assert_eq!(field_value("(a: B(1), b: 2)", "a"), Some("B(1)"));
        assert_eq!(field_value(TEXT, "x"), None);
    }

    #[test]
    fn damaged_texts_have_tokens_within_the_text() {
        for end in (0..TEXT.len()).filter(|end| TEXT.is_char_boundary(*end)) {
            let text = &TEXT[..end];
            assert!(tokens(text).all(|token| text.get(token.range).is_some()));
            for offset in 0..=end {
                let elements = elements_around(text, offset);
                assert!(
                    elements
                        .iter()
                        .all(|it| text.get(it.range.clone()).is_some())
                );
            }
        }
    }
}
