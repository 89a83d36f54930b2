//! The words of a script, and where they stand.

use std::ops::Range;

use super::ScriptError;

/// A word, without its quotes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token<'a> {
    pub(super) text: &'a str,
    /// Its bytes in the script, with its quotes.
    pub(super) span: Range<usize>,
}

impl Token<'_> {
    /// Whether it joins two orders: a `&` that is not in quotes.
    pub(super) fn is_join(&self) -> bool {
        self.text == "&" && self.span.len() == 1
    }
}

/// The words of each order of a script; orders without any are left out.
pub(super) fn tokenize(text: &str) -> Result<Vec<Vec<Token<'_>>>, ScriptError> {
    let mut orders = Vec::new();
    let mut words = Vec::new();
    let mut start = 0;
    while let Some(character) = text[start..].chars().next() {
        let rest = &text[start..];
        match character {
            '\n' | ';' => {
                orders.push(std::mem::take(&mut words));
                start += 1;
            }
            '#' => start += rest.find('\n').unwrap_or(rest.len()),
            blank if blank.is_whitespace() => start += blank.len_utf8(),
            _ => {
                let word = word(text, start, character)?;
                start = word.span.end;
                words.push(word);
            }
        }
    }
    orders.push(words);
    orders.retain(|words| !words.is_empty());
    Ok(orders)
}

/// The word that begins with `first` at the byte `start`.
fn word(text: &str, start: usize, first: char) -> Result<Token<'_>, ScriptError> {
    let rest = &text[start..];
    if first == '&' {
        let place = start..start + 1;
        return Ok(Token {
            text: "&",
            span: place,
        });
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
        let place = start..start + 1 + line.len();
        return Err((place, format!("the name has no closing {first}")));
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
        let orders = tokenize(script).unwrap().into_iter();
        orders
            .map(|words| words.into_iter().map(|word| word.text).collect())
            .collect()
    }

    #[test]
    fn orders_end_with_a_line_or_a_semicolon_and_comments_and_blanks_are_nothing() {
        let script = "tap Q ; lift;;\n# all of this; is nothing\r\n\twait 5 # so is this\n\n";
        assert_eq!(
            texts(script),
            [vec!["tap", "Q"], vec!["lift"], vec!["wait", "5"]]
        );
    }

    #[test]
    fn in_quotes_everything_is_part_of_a_name() {
        let script = "tap \"Volume; up # & down\" 'say \"é\"'&set x#y";
        let words = ["tap", "Volume; up # & down", "say \"é\"", "&", "set", "x#y"];
        assert_eq!(texts(script), [words]);
        let (place, message) = tokenize("tap 'Q\nlift").unwrap_err();
        assert_eq!(
            (place, message.as_str()),
            (4..6, "the name has no closing '")
        );
    }
}
