//! A command line of Bash: its words, and a candidate quoted as its last word is.

/// The line up to the cursor.
#[derive(Debug, PartialEq)]
pub struct BashLine {
    /// The words without quotes; the last one is to be completed.
    pub words: Vec<String>,
    /// Length of the part of the last word that Bash keeps, in bytes: it replaces what follows.
    kept: usize,
    /// The quote that is open at the end.
    quote: Option<char>,
}

impl BashLine {
    /// Splits a line at blanks. `breaks` are the characters at which Bash splits words further.
    ///
    /// Returns `None` if a quote was closed within the last word: Bash then replaces a part of it that begins in the quote.
    pub fn new(line: &str, breaks: &str) -> Option<Self> {
        let mut words = vec![String::new()];
        let (mut quote, mut kept) = (None, 0);
        let mut was_closed = false;
        let mut characters = line.chars().peekable();
        while let Some(character) = characters.next() {
            let word = words.last_mut()?;
            match (quote, character) {
                (None, '\'' | '"') => {
                    quote = Some(character);
                    kept = word.len();
                }
                (Some(open), _) if open == character => {
                    quote = None;
                    was_closed = true;
                }
                (None, '\\') => word.extend(characters.next()),
                (Some('"'), '\\') => {
                    let escaped = characters.next_if(|next| "\\\"$`".contains(*next));
                    word.push(escaped.unwrap_or(character));
                }
                (None, _) if character.is_whitespace() => {
                    let is_started = !word.is_empty() || was_closed;
                    (kept, was_closed) = (0, false);
                    if is_started {
                        words.push(String::new());
                    }
                }
                (None, _) if breaks.contains(character) => {
                    word.push(character);
                    kept = word.len();
                }
                _ => word.push(character),
            }
        }
        (!was_closed).then_some(Self { words, kept, quote })
    }

    /// Returns what Bash inserts for a candidate; `None` if it cannot.
    pub fn inserted(&self, candidate: &str) -> Option<String> {
        let kept = &self.words.last()?[..self.kept];
        let inserted = candidate.strip_prefix(kept)?;
        match self.quote {
            None => Some(with_backslashes(inserted, |c| {
                !c.is_alphanumeric() && !"_./:=@%+,-".contains(c)
            })),
            Some('\'') => Some(inserted.replace('\'', r"'\''")),
            // A backslash does not quote it there.
            Some(_) if inserted.contains('!') => None,
            Some(_) => Some(with_backslashes(inserted, |c| "\\\"$`".contains(c))),
        }
    }
}

fn with_backslashes(text: &str, is_quoted: impl Fn(char) -> bool) -> String {
    let mut quoted = String::with_capacity(text.len());
    for character in text.chars() {
        if is_quoted(character) {
            quoted.push('\\');
        }
        quoted.push(character);
    }
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The characters at which Bash splits words unless its user changes them.
    const BREAKS: &str = " \t\n\"'@><=;|&(:";

    #[test]
    fn candidates_are_quoted_as_the_word_is() {
        let candidate = "zz;touch $(PWNED) it's!.ron";
        let table = [
            (
                "ademan run z",
                candidate,
                Some(r"zz\;touch\ \$\(PWNED\)\ it\'s\!.ron"),
            ),
            (
                r"ademan run zz\;to",
                candidate,
                Some(r"zz\;touch\ \$\(PWNED\)\ it\'s\!.ron"),
            ),
            (
                "ademan run 'zz;to",
                candidate,
                Some(r"zz;touch $(PWNED) it'\''s!.ron"),
            ),
            ("ademan run \"zz;to", candidate, None),
            ("ademan run \"z", "z$a`\"\\", Some("z\\$a\\`\\\"\\\\")),
            ("ademan run --source file:z", "file:z;a", Some(r"z\;a")),
            ("ademan run --layout=z", "--layout=z a", Some(r"z\ a")),
            ("ademan run --source 'file:z", "file:z a", Some("file:z a")),
            ("ademan run --source file:'z", "file:z a", Some("z a")),
            (r"ademan run a\ b c", "cé/", Some("cé/")),
            ("ademan run ", "~x", Some(r"\~x")),
        ];
        for (line, name, expected) in table {
            let split = BashLine::new(line, BREAKS).unwrap();
            assert_eq!(split.inserted(name).as_deref(), expected, "{line}");
        }
    }

    #[test]
    fn words_are_split_at_blanks_outside_of_quotes() {
        let words = |line| BashLine::new(line, BREAKS).map(|line| line.words);
        let expected = ["ademan", "a b", "c d", "e\\f", ""].map(str::to_owned);
        let line = r#"  ademan a\ b  'c d' "e\f" "#;
        assert_eq!(words(line), Some(expected.to_vec()));
        assert_eq!(words("ademan '' x").unwrap(), ["ademan", "", "x"]);
        assert_eq!(words("ademan \"a\"b"), None);
        assert_eq!(words("").unwrap(), [""]);
    }
}
