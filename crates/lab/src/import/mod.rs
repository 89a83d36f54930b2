//! Layouts of other programs: `.dof` files and plain text grids of the keyboard-layout community become layouts in RON.
//!
//! Their keys are columns and rows of a physical keyboard. They are placed 19 mm apart, on a board for each hand or on one board, with
//! the stagger of the physical keyboard. Which finger presses a key is not imported: simulated people choose, and files of layouts do not
//! say it.

mod dof;
mod grid;
mod write;

use crate::document::BYTE_ORDER_MARK;
use crate::layout::Layout;
use crate::message::escape;
use crate::names::named_enum;

named_enum! {
    /// The boards that keys are placed on.
    pub enum ImportHands ("hands") {
        /// A board for each hand: the letters of a row are split after the fifth.
        Two = "two",
        /// One board for the right hand.
        One = "one",
    }
}

/// A key of another program.
#[derive(Clone, Debug, PartialEq, Eq)]
enum ImportedKey {
    /// No key in this column.
    Empty,
    /// A character.
    Character(char),
    /// A key by the name of its code.
    Code(&'static str),
    /// A text of several characters.
    Text(String),
}

/// A row of keys.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct ImportedRow {
    keys: Vec<ImportedKey>,
    /// Keys to the left of the letters.
    leading: usize,
}

/// The keys of another program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Grid {
    name: String,
    origin: String,
    /// The physical rows: digits, three rows of letters, thumbs.
    rows: [ImportedRow; 5],
    /// `true` if rows are not shifted against each other.
    is_ortho: bool,
    notes: Vec<String>,
}

/// A layout of another program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Imported {
    /// The name.
    pub name: String,
    /// The layout, as RON text.
    pub text: String,
    /// The omissions and additions, one sentence each.
    pub notes: Vec<String>,
}

/// Reason why a text is not imported.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImportError {
    /// Another format.
    #[error(
        "{0}; known are .dof files (JSON with `layers`) and text grids (three rows of keys that are separated by blanks)"
    )]
    Format(String),
    /// A part of the file.
    #[error("{0}")]
    Content(String),
    /// A key that cannot be.
    #[error("row {row}, key {column}: {message}")]
    Key {
        /// The row in the file, from 1.
        row: usize,
        /// The key in the row, from 1.
        column: usize,
        /// The fault.
        message: String,
    },
}

/// Imports a layout. `file` is the name of the file: its stem is the name of a layout without one.
pub fn import(file: &str, text: &str, hands: ImportHands) -> Result<Imported, ImportError> {
    let text = text.trim_start_matches(BYTE_ORDER_MARK);
    let first = text.trim_start().chars().next();
    let stem = std::path::Path::new(file).file_stem();
    let stem = stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let grid = match first {
        None => return Err(ImportError::Format("the file is empty".to_owned())),
        Some('{' | '[') => dof::read(text, &stem)?,
        Some('<') => {
            let message = "the file is XML, such as a .keylayout of macOS, which is not imported";
            return Err(ImportError::Format(message.to_owned()));
        }
        Some(_) => grid::read(text, &stem)?,
    };
    let imported = write::write(&grid, hands);
    // Whatever was read, the result is a layout.
    match Layout::parse(&imported.text, &imported.name) {
        Ok(_) => Ok(imported),
        Err(error) => Err(ImportError::Content(format!(
            "the keys make no valid layout: {}",
            error.message()
        ))),
    }
}

/// Reads the word of a key.
fn key(word: &str, row: usize, column: usize) -> Result<ImportedKey, ImportError> {
    let mut characters = word.chars();
    let first = characters.next();
    if let (Some(first), None) = (first, characters.next()) {
        return Ok(match first {
            '~' | '*' => ImportedKey::Empty,
            '\n' => ImportedKey::Code("Enter"),
            '\t' => ImportedKey::Code("Tab"),
            other => ImportedKey::Character(lower(other)),
        });
    }
    Ok(match word {
        "\\~" => ImportedKey::Character('~'),
        "\\*" => ImportedKey::Character('*'),
        "spc" | "spce" | "sp" | "space" => ImportedKey::Code("Space"),
        "sft" | "shft" | "shift" => ImportedKey::Code("ShiftLeft"),
        "bsp" | "bcsp" | "bksp" => ImportedKey::Code("Backspace"),
        "ret" | "ent" | "rtn" | "enter" | "\\n" => ImportedKey::Code("Enter"),
        "tb" | "tab" | "\\t" => ImportedKey::Code("Tab"),
        "esc" => ImportedKey::Code("Escape"),
        "del" => ImportedKey::Code("Delete"),
        _ => {
            let text = word
                .strip_prefix("\\#")
                .map(|rest| format!("#{rest}"))
                .or_else(|| word.strip_prefix("\\@").map(|rest| format!("@{rest}")))
                .or_else(|| word.strip_prefix('#').map(str::to_owned));
            match text {
                Some(text) if text.chars().count() > 32 => {
                    return Err(ImportError::Key {
                        row,
                        column,
                        message: format!(
                            "the text `{}` has more than 32 characters",
                            escape(&text)
                        ),
                    });
                }
                Some(text) => match (text.chars().next(), text.chars().nth(1)) {
                    (Some(one), None) => ImportedKey::Character(one),
                    _ => ImportedKey::Text(text),
                },
                None => ImportedKey::Empty,
            }
        }
    })
}

/// Returns a character in lower case.
fn lower(character: char) -> char {
    let mut lower = character.to_lowercase();
    match (lower.next(), lower.next()) {
        (Some(one), None) => one,
        _ => character,
    }
}

/// Returns `true` if a word is an empty key on purpose.
fn is_gap(word: &str) -> bool {
    matches!(word, "~" | "*")
}

/// Reads rows of words, and finds their physical rows. `first` is the physical row of the first one and `leading` the number of keys to
/// the left of the letters, if the file says so.
fn place_rows(
    grid: &mut Grid,
    rows: &[Vec<String>],
    first: Option<usize>,
    leading: Option<usize>,
) -> Result<(), ImportError> {
    let is_digits = |row: &Vec<String>| {
        let digits = row.iter().filter(|word| {
            let mut characters = word.chars();
            characters.next().is_some_and(|it| it.is_ascii_digit()) && characters.next().is_none()
        });
        digits.count() >= 3
    };
    let first = first.unwrap_or_else(|| usize::from(!rows.first().is_some_and(is_digits)));
    let last = grid.rows.len();
    if rows.len() < 3 || rows.len() > last.saturating_sub(first) {
        return Err(ImportError::Content(format!(
            "the layout has {} rows; a layout has three rows of letters, perhaps one of digits above and one for thumbs below",
            rows.len()
        )));
    }
    let mut unknown: Vec<String> = Vec::new();
    for (index, words) in rows.iter().enumerate() {
        let mut keys = Vec::new();
        for (column, word) in words.iter().enumerate() {
            let key = key(word, index + 1, column + 1)?;
            if key == ImportedKey::Empty && !is_gap(word) {
                unknown.push(format!("`{}`", escape(word)));
            }
            keys.push(key);
        }
        let own = match keys.first() {
            Some(ImportedKey::Code(_) | ImportedKey::Character('`')) => 1,
            _ => 0,
        };
        grid.rows[first + index] = ImportedRow {
            leading: leading.unwrap_or(own),
            keys,
        };
    }
    if !unknown.is_empty() {
        unknown.dedup();
        grid.notes.push(format!(
            "left out: {} (layer, magic and modifier keys have no counterpart)",
            unknown.join(", ")
        ));
    }
    let letters = grid.rows.iter().flat_map(|row| &row.keys);
    let letters =
        letters.filter(|key| matches!(key, ImportedKey::Character(it) if it.is_alphabetic()));
    if letters.count() < 10 {
        return Err(ImportError::Content(
            "the layout has fewer than ten letters; is it a layout of letters?".to_owned(),
        ));
    }
    Ok(())
}
