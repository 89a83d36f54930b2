//! The values of a RON text with their positions, for edits that keep everything else in the text.

use std::ops::Range;

use super::scan::{Token, TokenKind, tokens};

/// The maximum depth of nesting, as in [`parse_ron`](super::parse_ron).
const MAX_DEPTH: usize = 128;

/// A value in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// The bytes, including the name before its parentheses.
    pub range: Range<usize>,
    /// The content of its brackets; `None` for a number, a name or a text.
    pub group: Option<Group>,
}

/// The content of a pair of brackets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The opening bracket: `(`, `[` or `{`.
    pub bracket: u8,
    /// The bytes between the brackets.
    pub inside: Range<usize>,
    /// The values, with the names of fields or the keys of a map.
    pub items: Vec<Item>,
}

/// A value between brackets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// The name of the field, or the key in a map.
    pub key: Option<Range<usize>>,
    /// The value.
    pub value: Node,
    /// Offset of the comma after it.
    pub comma: Option<usize>,
}

/// Reads the value of a text. `None` if brackets are not balanced, or something is written between values and commas.
pub fn read_tree(text: &str) -> Option<Node> {
    let all: Vec<Token> = tokens(text).collect();
    let mut reader = Reader {
        text,
        tokens: &all,
        next: 0,
    };
    reader.skip_attributes()?;
    let node = reader.node(0)?;
    (reader.next == all.len()).then_some(node)
}

struct Reader<'t> {
    text: &'t str,
    tokens: &'t [Token],
    next: usize,
}

impl Reader<'_> {
    fn kind(&self, ahead: usize) -> Option<TokenKind> {
        Some(self.tokens.get(self.next + ahead)?.kind)
    }

    /// Skips `#![enable(implicit_some)]`.
    fn skip_attributes(&mut self) -> Option<()> {
        while self.kind(0) == Some(TokenKind::Other) {
            self.next += 1;
            if let Some(TokenKind::Open(b'[')) = self.kind(0) {
                self.node(0)?;
            }
        }
        Some(())
    }

    fn node(&mut self, depth: usize) -> Option<Node> {
        let first = self.tokens.get(self.next)?.clone();
        self.next += 1;
        match first.kind {
            TokenKind::Open(bracket) => self.group(first.range.start, bracket, depth),
            TokenKind::Word if self.kind(0) == Some(TokenKind::Open(b'(')) => {
                self.next += 1;
                self.group(first.range.start, b'(', depth)
            }
            TokenKind::Word | TokenKind::Quoted => Some(Node {
                range: first.range,
                group: None,
            }),
            TokenKind::Close(_) | TokenKind::Comma | TokenKind::Colon | TokenKind::Other => None,
        }
    }

    /// Reads what follows an opening bracket.
    fn group(&mut self, start: usize, bracket: u8, depth: usize) -> Option<Node> {
        if depth == MAX_DEPTH {
            return None;
        }
        let inside = self.tokens[self.next - 1].range.end;
        let mut items = Vec::new();
        loop {
            if let Some(TokenKind::Close(close)) = self.kind(0) {
                let close_range = self.tokens[self.next].range.clone();
                self.next += 1;
                let is_own = matches!((bracket, close), (b'(', b')') | (b'[', b']') | (b'{', b'}'));
                return is_own.then_some(Node {
                    range: start..close_range.end,
                    group: Some(Group {
                        bracket,
                        inside: inside..close_range.start,
                        items,
                    }),
                });
            }
            items.push(self.item(depth)?);
        }
    }

    fn item(&mut self, depth: usize) -> Option<Item> {
        let first = self.node(depth + 1)?;
        let (key, value) = match self.kind(0) {
            Some(TokenKind::Colon) => {
                self.next += 1;
                (Some(first.range), self.node(depth + 1)?)
            }
            _ => (None, first),
        };
        let comma = match self.kind(0)? {
            TokenKind::Comma => {
                self.next += 1;
                Some(self.tokens[self.next - 1].range.start)
            }
            TokenKind::Close(_) => None,
            _ => return None,
        };
        debug_assert!(value.range.end <= self.text.len());
        Some(Item { key, value, comma })
    }
}

impl Node {
    /// Returns its bytes in the text that it was read from.
    pub fn text<'t>(&self, text: &'t str) -> &'t str {
        &text[self.range.clone()]
    }

    /// Returns the values between its brackets.
    pub fn items(&self) -> &[Item] {
        self.group.as_ref().map_or(&[], |group| &group.items)
    }

    /// Returns the value in `Some(…)`, or itself.
    pub fn in_some(&self, text: &str) -> &Self {
        match self.items() {
            [item] if item.key.is_none() && self.name(text) == Some("Some") => {
                item.value.in_some(text)
            }
            _ => self,
        }
    }

    /// Returns the name before its parentheses: `Box` of `Box(17, 17)`.
    pub fn name<'t>(&self, text: &'t str) -> Option<&'t str> {
        let group = self.group.as_ref()?;
        let before = &text[self.range.start..group.inside.start - 1];
        let word = tokens(before).next()?;
        Some(&before[word.range])
    }

    /// Returns the field with this name, or the entry of a map whose key is a text without escapes.
    pub fn item(&self, text: &str, name: &str) -> Option<&Item> {
        let is_own = |item: &&Item| {
            item.key.as_ref().is_some_and(|key| {
                let key = &text[key.clone()];
                key == name || quoted_content(key) == Some(name)
            })
        };
        self.items().iter().find(is_own)
    }

    /// Returns the value of the field with this name, without `Some`.
    pub fn field(&self, text: &str, name: &str) -> Option<&Self> {
        Some(self.item(text, name)?.value.in_some(text))
    }

    /// Returns the value at these fields and indices, such as `["boards", "0", "pose"]`.
    pub fn at<'p>(&self, text: &str, path: impl IntoIterator<Item = &'p str>) -> Option<&Self> {
        path.into_iter().try_fold(self, |node, step| {
            let node = node.in_some(text);
            match step.parse::<usize>() {
                Ok(index) => Some(node.items().get(index)?.value.in_some(text)),
                Err(_) => node.field(text, step),
            }
        })
    }

    /// Returns the value as a number, if it is a finite one.
    pub fn number(&self, text: &str) -> Option<f64> {
        let digits = self.in_some(text).text(text).replace('_', "");
        digits
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite())
    }

    /// Returns the content of a text without escapes.
    pub fn string<'t>(&self, text: &'t str) -> Option<&'t str> {
        quoted_content(self.in_some(text).text(text))
    }
}

/// Returns the content of a quoted text, raw or not. `None` if it has escapes.
pub fn quoted_content(quoted: &str) -> Option<&str> {
    if let Some(raw) = quoted.strip_prefix('r') {
        let content = raw.trim_start_matches('#');
        let hashes = raw.len() - content.len();
        let content = content.strip_prefix('"')?;
        return content.get(..content.len().checked_sub(hashes + 1)?);
    }
    let content = quoted.strip_prefix('"')?.strip_suffix('"')?;
    (!content.contains('\\')).then_some(content)
}

/// Returns a text in quotes that is read without escapes.
pub fn quote(content: &str) -> String {
    if !content.contains(['"', '\\']) {
        return format!("\"{content}\"");
    }
    let mut hashes = String::from("#");
    while content.contains(&format!("\"{hashes}")) {
        hashes.push('#');
    }
    format!("r{hashes}\"{content}\"{hashes}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Document, shipped_gloves, shipped_layouts};

    #[test]
    fn fields_indices_and_some_lead_to_a_value() {
        let text = "#![enable(implicit_some)]\n// (\nA(b: [1, Some((c: -2.5, d: \"x)\"))], m: {\"Q\": \"1\"})";
        let tree = read_tree(text).unwrap();
        assert_eq!(tree.name(text), Some("A"));
        let number = tree.at(text, ["b", "1", "c"]).unwrap();
        assert_eq!(number.number(text), Some(-2.5));
        assert_eq!(
            tree.at(text, ["b", "1", "d"]).unwrap().string(text),
            Some("x)")
        );
        assert_eq!(tree.at(text, ["m", "Q"]).unwrap().string(text), Some("1"));
        assert_eq!(tree.at(text, ["b", "2"]), None);
    }

    #[test]
    fn a_text_that_is_no_value_has_no_tree() {
        for text in ["", "(", "(a: )", "(a b)", "[1, 2)", "1 2", ")", "(,)"] {
            assert_eq!(read_tree(text), None, "{text}");
        }
        let deep = "[".repeat(10_000) + &"]".repeat(10_000);
        assert_eq!(read_tree(&deep), None);
    }

    #[test]
    fn every_shipped_file_has_a_tree() {
        for name in shipped_layouts().chain(shipped_gloves()) {
            let text = Document::shipped(name).unwrap().text;
            let tree = read_tree(&text).unwrap_or_else(|| panic!("{name}"));
            assert!(tree.field(&text, "name").is_some(), "{name}");
        }
    }

    #[test]
    fn quotes_are_removed_and_added() {
        for content in ["a", "a \"b\"", "\\", "\"#", "é"] {
            assert_eq!(quoted_content(&quote(content)), Some(content));
        }
        assert_eq!(quoted_content("\"\\n\""), None);
    }
}
