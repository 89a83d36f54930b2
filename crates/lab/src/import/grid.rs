//! Plain text grids: rows of characters, perhaps with a name above and with rows of finger numbers below.

use super::{Grid, ImportError, place_rows};
use crate::message::escape;

/// The fewest keys of a row.
const FEWEST: usize = 5;
/// The most lines of a grid: more are another kind of text.
const MOST_LINES: usize = 12;

pub(super) fn read(text: &str, stem: &str) -> Result<Grid, ImportError> {
    let lines: Vec<&str> = text
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with("//"))
        .collect();
    let mut grid = Grid {
        name: stem.to_owned(),
        origin: "imported from a text grid".to_owned(),
        ..Grid::default()
    };
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let row = row(line);
        let is_one_word = |candidate: &&str| !candidate.contains(char::is_whitespace);
        if number == 0 && is_one_word(line) && !lines.get(1).is_some_and(is_one_word) {
            grid.name = (*line).to_owned();
            continue;
        }
        let is_row = row.len() >= FEWEST && row.iter().all(|word| word.chars().count() <= 5);
        let has_letters = rows.iter().flatten().any(|word| is_letter(word));
        let is_fingers = has_letters && row.iter().all(|word| is_digit(word));
        match (is_row, is_fingers) {
            // Finger numbers of each key: people choose their fingers.
            (_, true) => {}
            // Thumb keys may be few.
            (false, _) if rows.len() >= 3 && row.iter().all(|word| word.chars().count() <= 5) => {
                rows.push(row);
            }
            (false, _) if number == 0 => grid.name = (*line).to_owned(),
            (false, _) => {
                return Err(ImportError::Format(format!(
                    "line {} of the text is no row of keys: `{}`",
                    number + 1,
                    escape(&line.chars().take(40).collect::<String>())
                )));
            }
            (true, _) => rows.push(row),
        }
        if number > MOST_LINES {
            let message = format!("the text has more than {MOST_LINES} lines, so it is no grid");
            return Err(ImportError::Format(message));
        }
    }
    place_rows(&mut grid, &rows, None, None)?;
    Ok(grid)
}

/// Returns the keys of a line: its words, or its characters if it has one word.
fn row(line: &str) -> Vec<String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    // Two halves, `qwert yuiop`, are rows of characters, too.
    let are_halves = words.len() <= 3 && words.iter().all(|word| word.chars().count() >= FEWEST);
    if are_halves {
        words
            .concat()
            .chars()
            .map(|character| character.to_string())
            .collect()
    } else {
        words.into_iter().map(str::to_owned).collect()
    }
}

fn is_letter(word: &str) -> bool {
    let mut characters = word.chars();
    characters.next().is_some_and(char::is_alphabetic) && characters.next().is_none()
}

fn is_digit(word: &str) -> bool {
    word.len() == 1 && word.bytes().all(|byte| byte.is_ascii_digit())
}
