//! Rust source as tokens: comments are dropped, literals are kept as one token without their content.

use std::iter::Peekable;
use std::str::CharIndices;

/// An identifier, `::`, a literal, or a single punctuation character.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    pub text: String,
    /// 1-based.
    pub line: usize,
}

/// The tokens of a source file.
///
/// Strings become `""`, characters and lifetimes `'`, so that words in them count for nothing.
pub fn tokens(source: &str) -> Vec<Token> {
    let mut lexer = Lexer {
        source,
        rest: source.char_indices().peekable(),
        line: 1,
        tokens: Vec::new(),
    };
    while lexer.next_token() {}
    lexer.tokens
}

/// The tokens of a file as text, one space apart.
pub fn code(tokens: &[Token]) -> String {
    let texts: Vec<&str> = tokens.iter().map(|token| token.text.as_str()).collect();
    texts.join(" ")
}

struct Lexer<'a> {
    source: &'a str,
    rest: Peekable<CharIndices<'a>>,
    line: usize,
    tokens: Vec<Token>,
}

impl Lexer<'_> {
    fn next_token(&mut self) -> bool {
        let Some(&(start, first)) = self.rest.peek() else {
            return false;
        };
        let line = self.line;
        let ahead = &self.source[start..];
        let text = if first.is_whitespace() {
            self.bump();
            return true;
        } else if ahead.starts_with("//") {
            self.skip_while(|c| c != '\n');
            return true;
        } else if ahead.starts_with("/*") {
            self.skip_block_comment();
            return true;
        } else if let Some(hashes) = raw_string(ahead) {
            self.skip_raw_string(hashes);
            "\"\"".to_owned()
        } else if ahead.starts_with("b\"") || ahead.starts_with("c\"") {
            self.bump();
            self.skip_quoted('"');
            "\"\"".to_owned()
        } else if first == '"' {
            self.skip_quoted('"');
            "\"\"".to_owned()
        } else if first == '\'' || ahead.starts_with("b'") {
            self.skip_character_or_lifetime();
            "'".to_owned()
        } else if first.is_alphanumeric() || first == '_' {
            let length = ahead
                .find(|c: char| !c.is_alphanumeric() && c != '_')
                .unwrap_or(ahead.len());
            self.skip_bytes(start + length);
            ahead[..length].to_owned()
        } else if ahead.starts_with("::") {
            self.bump();
            self.bump();
            "::".to_owned()
        } else {
            self.bump();
            first.to_string()
        };
        self.tokens.push(Token { text, line });
        true
    }

    fn bump(&mut self) -> Option<char> {
        let (_, character) = self.rest.next()?;
        self.line += usize::from(character == '\n');
        Some(character)
    }

    fn skip_while(&mut self, condition: impl Fn(char) -> bool) {
        while self.rest.peek().is_some_and(|&(_, c)| condition(c)) {
            self.bump();
        }
    }

    fn skip_bytes(&mut self, end: usize) {
        while self.rest.peek().is_some_and(|&(at, _)| at < end) {
            self.bump();
        }
    }

    fn skip_block_comment(&mut self) {
        let mut depth = 0;
        let mut last = ' ';
        while let Some(character) = self.bump() {
            match (last, character) {
                ('/', '*') => depth += 1,
                ('*', '/') => depth -= 1,
                _ => {
                    last = character;
                    continue;
                }
            }
            last = ' ';
            if depth == 0 {
                return;
            }
        }
    }

    fn skip_raw_string(&mut self, hashes: usize) {
        let end = format!("\"{}", "#".repeat(hashes));
        self.skip_while(|c| c != '"');
        self.bump();
        while let Some(&(at, _)) = self.rest.peek() {
            if self.source[at..].starts_with(&end) {
                self.skip_bytes(at + end.len());
                return;
            }
            self.bump();
        }
    }

    fn skip_quoted(&mut self, quote: char) {
        self.bump();
        while let Some(character) = self.bump() {
            if character == '\\' {
                self.bump();
            } else if character == quote {
                return;
            }
        }
    }

    fn skip_character_or_lifetime(&mut self) {
        self.skip_while(|c| c == 'b');
        let &(start, _) = self.rest.peek().expect("a quote");
        let ahead = &self.source[start + 1..];
        let mut characters = ahead.chars();
        let first = characters.next();
        if first == Some('\\') || characters.next() == Some('\'') {
            self.skip_quoted('\'');
        } else {
            self.bump();
            self.skip_while(|c| c.is_alphanumeric() || c == '_');
        }
    }
}

/// The number of `#` of a raw string that starts here; `None` if none does.
fn raw_string(ahead: &str) -> Option<usize> {
    let after = ahead
        .strip_prefix("br")
        .or_else(|| ahead.strip_prefix('r'))?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    after[hashes..].starts_with('"').then_some(hashes)
}

/// The tokens outside of items that are compiled for unit tests only.
pub fn without_tests(tokens: &[Token]) -> Vec<Token> {
    let texts: Vec<&str> = tokens.iter().map(|token| token.text.as_str()).collect();
    let (mut kept, mut at) = (Vec::new(), 0);
    while at < tokens.len() {
        if texts[at..].starts_with(&["#", "[", "cfg", "(", "test", ")", "]"]) {
            at += 7 + item_length(&texts[at + 7..]);
        } else {
            kept.push(tokens[at].clone());
            at += 1;
        }
    }
    kept
}

/// The number of tokens of an item: up to its `;`, or to the end of its braces.
fn item_length(tokens: &[&str]) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate() {
        match *token {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth -= 1,
            _ => {}
        }
        if depth == 0 && matches!(*token, ";" | "}") {
            return at + 1;
        }
    }
    tokens.len()
}
