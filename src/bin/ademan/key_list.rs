//! `ademan layout keys`: the names of all keys, with their aliases and codes.

use std::io::{self, Write};

use ademan::device::{KeyCode, KeyKind};
use ademan::message::escape;
use serde::Serialize;

use crate::failure::Failure;
use crate::list::print_json;

/// Arguments of the list.
#[derive(clap::Args)]
pub struct Args {
    /// Part of a name, an alias or an X11 name, a character, or an evdev code
    word: Option<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The names of characters that no key is named after: the names of X11 and other usual ones.
#[rustfmt::skip]
const CHARACTER_NAMES: [(char, &str); 21] = [
    ('!', "exclam exclamation bang"), ('@', "at"), ('#', "numbersign hash pound"), ('$', "dollar"), ('%', "percent"),
    ('^', "asciicircum caret circumflex"), ('&', "ampersand and"), ('*', "asterisk star"), ('(', "parenleft parenthesis"),
    (')', "parenright parenthesis"), ('_', "underscore"), ('+', "plus"), ('{', "braceleft"), ('}', "braceright"),
    ('|', "bar pipe"), (':', "colon"), ('"', "quotedbl doublequote"), ('<', "less"), ('>', "greater"), ('?', "question"),
    ('~', "asciitilde tilde"),
];

/// A key of the list.
#[derive(Serialize)]
struct Row {
    name: &'static str,
    aliases: &'static [&'static str],
    /// The characters on a US keymap, without and with Shift.
    characters: Vec<char>,
    /// The code of `input-event-codes.h`.
    evdev: u16,
    /// The key code of X11; `None` for buttons.
    x11: Option<u16>,
    /// The name of the X11 keysym on a US keymap.
    keysym: Option<String>,
}

impl Row {
    fn new(key: KeyCode) -> Self {
        let mut characters: Vec<char> = [false, true]
            .into_iter()
            .filter_map(|shifted| key.us_character(shifted))
            .filter(|character| !character.is_control())
            .collect();
        characters.dedup();
        Self {
            name: key.name(),
            aliases: key.aliases(),
            characters,
            evdev: key.event_code(),
            x11: (key.kind() == KeyKind::Keyboard).then(|| key.x11_code()),
            keysym: key.x11_keysym(),
        }
    }

    /// Returns `true` if the word is part of a name, or is a character or code of the key.
    fn matches(&self, word: &str) -> bool {
        let mut characters = word.chars();
        if let (Some(only), None) = (characters.next(), characters.next()) {
            return self.characters.contains(&only);
        }
        let word = word.to_lowercase();
        let names = [self.name].into_iter().chain(self.aliases.iter().copied());
        names
            .chain(self.keysym.as_deref())
            .any(|name| name.to_lowercase().contains(&word))
            || self.evdev.to_string() == word
            || self.writes(&word)
    }

    /// Returns `true` if the word is the start of a name of a character of the key.
    fn writes(&self, word: &str) -> bool {
        let mut names = CHARACTER_NAMES.iter();
        names.any(|(character, names)| {
            let mut names = names.split(' ');
            self.characters.contains(character) && names.any(|name| name.starts_with(word))
        })
    }
}

/// Prints the keys that the word finds, or all.
pub fn print(args: &Args) -> Result<(), Failure> {
    let word = args.word.as_deref().unwrap_or_default();
    let rows = KeyCode::all().map(Row::new);
    let rows: Vec<Row> = rows
        .filter(|row| word.is_empty() || row.matches(word))
        .collect();
    if rows.is_empty() {
        let suggestion = match word.parse::<KeyCode>() {
            Err(error) => error.nearest,
            Ok(key) => Some(key.name().to_owned()),
        };
        let suggestion =
            suggestion.map_or(String::new(), |name| format!(", did you mean `{name}`?"));
        return Err(Failure::wrong_use(format!(
            "no key has `{}` in its names{suggestion}; `ademan layout keys` lists all keys",
            escape(word)
        )));
    }
    if args.json {
        return print_json(&rows);
    }
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "{}",
        line("NAME", "TYPES", "EVDEV", "X11", "KEYSYM", "ALIASES")
    )?;
    for row in &rows {
        let characters: Vec<String> = row.characters.iter().map(char::to_string).collect();
        let (evdev, x11) = (row.evdev.to_string(), row.x11.map(|code| code.to_string()));
        let keysym = row.keysym.as_deref().unwrap_or("-");
        let x11 = x11.as_deref().unwrap_or("-");
        let text = line(
            row.name,
            &characters.join(" "),
            &evdev,
            x11,
            keysym,
            &row.aliases.join(" "),
        );
        writeln!(out, "{}", text.trim_end())?;
    }
    Ok(())
}

fn line(name: &str, types: &str, evdev: &str, x11: &str, keysym: &str, aliases: &str) -> String {
    format!("{name:18}  {types:5}  {evdev:>5}  {x11:>3}  {keysym:20}  {aliases}")
}
