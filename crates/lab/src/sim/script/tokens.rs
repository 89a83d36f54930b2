//! The tokens of a script: words, quoted names and `&`.

use std::ops::Range;

/// A word of a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    /// The word without its quotes.
    pub text: &'a str,
    /// Bytes of the word in the script, including its quotes.
    pub span: Range<usize>,
}

/// A syntax error in a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// Bytes of the wrong part.
    pub span: Range<usize>,
    /// Explanation.
    pub message: String,
}

impl SyntaxError {
    /// Creates an error at a part of the script.
    pub fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            span,
            message: message.into(),
        }
    }
}

impl Token<'_> {
    /// Returns `true` if the token joins two actions: a `&` without quotes.
    pub fn is_join(&self) -> bool {
        self.text == "&" && self.span.len() == 1
    }
}

/// Splits a script into steps of tokens. Steps end with a newline or `;`; steps without tokens are left out, and so are
/// comments from `#` to the end of the line.
pub fn tokenize(text: &str) -> Result<Vec<Vec<Token<'_>>>, SyntaxError> {
    let mut steps = Vec::new();
    let mut tokens = Vec::new();
    let mut start = 0;
    while let Some(character) = text[start..].chars().next() {
        let rest = &text[start..];
        match character {
            '\n' | ';' => {
                steps.push(std::mem::take(&mut tokens));
                start += 1;
            }
            '#' => start += rest.find('\n').unwrap_or(rest.len()),
            blank if blank.is_whitespace() => start += blank.len_utf8(),
            _ => {
                let token = token(text, start, character)?;
                start = token.span.end;
                tokens.push(token);
            }
        }
    }
    steps.push(tokens);
    steps.retain(|step| !step.is_empty());
    Ok(steps)
}

/// Returns the token that begins with `first` at the byte `start`.
fn token(text: &str, start: usize, first: char) -> Result<Token<'_>, SyntaxError> {
    let rest = &text[start..];
    if first == '&' {
        let span = start..start + 1;
        return Ok(Token { text: "&", span });
    }
    if first != '"' && first != '\'' {
        let ends = |c: char| c.is_whitespace() || matches!(c, ';' | '&');
        let length = rest.find(ends).unwrap_or(rest.len());
        return Ok(Token {
            text: &rest[..length],
            span: start..start + length,
        });
    }
    let line = rest[1..].lines().next().unwrap_or_default();
    let Some(length) = line.find(first) else {
        let span = start..start + 1 + line.len();
        return Err(SyntaxError::new(
            span,
            format!("the name has no closing {first}"),
        ));
    };
    Ok(Token {
        text: &line[..length],
        span: start..start + length + 2,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(script: &str) -> Vec<Vec<&str>> {
        let steps = tokenize(script).unwrap().into_iter();
        steps
            .map(|tokens| tokens.into_iter().map(|token| token.text).collect())
            .collect()
    }

    #[test]
    fn steps_end_with_a_newline_or_a_semicolon_and_comments_are_ignored() {
        let script = "tap Q ; lift;;\n# all of this; is nothing\r\n\twait 5 # so is this\n\n";
        assert_eq!(
            texts(script),
            [vec!["tap", "Q"], vec!["lift"], vec!["wait", "5"]]
        );
    }

    #[test]
    fn quoted_names_may_contain_any_character_of_the_syntax() {
        let script = "tap \"Volume; up # & down\" 'say \"é\"'&set x#y";
        let words = ["tap", "Volume; up # & down", "say \"é\"", "&", "set", "x#y"];
        assert_eq!(texts(script), [words]);
        let error = tokenize("tap 'Q\nlift").unwrap_err();
        assert_eq!(error, SyntaxError::new(4..6, "the name has no closing '"));
    }
}
