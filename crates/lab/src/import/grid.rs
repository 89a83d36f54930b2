//! Plain text grids: rows of characters, perhaps with a name above and with rows of finger numbers below.

use super::{Grid, ImportError, ImportedKey, key, place_rows};
use crate::message::escape;

/// The fewest keys of a row.
const FEWEST: usize = 5;
/// The most lines of a grid: more are another kind of text.
const MOST_LINES: usize = 12;

pub(super) fn read(text: &str, stem: &str) -> Result<Grid, ImportError> {
    let lines: Vec<(usize, &str)> = (1..)
        .zip(text.lines().map(str::trim))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with("//"))
        .collect();
    let mut grid = Grid {
        name: stem.to_owned(),
        origin: "imported from a text grid".to_owned(),
        ..Grid::default()
    };
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (number, (line_number, line)) in lines.iter().enumerate() {
        let row = row(line);
        let is_one_word = |candidate: &&str| !candidate.contains(char::is_whitespace);
        let second = lines.get(1).map(|(_, second)| second);
        if number == 0 && is_one_word(line) && !second.is_some_and(is_one_word) {
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
                    "line {line_number} of the text is not a row of keys: `{}`",
                    escape(&line.chars().take(40).collect::<String>())
                )));
            }
            (true, _) => rows.push(row),
        }
        if number >= MOST_LINES {
            let message = format!("the text has more than {MOST_LINES} lines, so it is not a grid");
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
    let is_half = |word: &&str| word.chars().count() >= FEWEST && !is_named(word);
    let are_halves = words.len() <= 3 && words.iter().all(is_half);
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

/// Returns `true` if a word names a key, such as `space` or `shift`.
fn is_named(word: &str) -> bool {
    matches!(key(word, 0, 0), Ok(ImportedKey::Code(_)))
}

fn is_letter(word: &str) -> bool {
    let mut characters = word.chars();
    characters.next().is_some_and(char::is_alphabetic) && characters.next().is_none()
}

fn is_digit(word: &str) -> bool {
    word.len() == 1 && word.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LETTERS: &str = "qwert yuiop\nasdfg hjkl;\nzxcvb nm,./\n";

    #[test]
    fn names_of_keys_for_thumbs_are_not_split_into_letters() {
        for (thumbs, names) in [
            ("space", &["Space"][..]),
            ("shift space enter", &["ShiftLeft", "Space", "Enter"]),
        ] {
            let grid = read(&format!("{LETTERS}{thumbs}"), "a").expect("a grid");
            let expected: Vec<ImportedKey> = names.iter().copied().map(ImportedKey::Code).collect();
            assert_eq!(grid.rows[4].keys, expected, "{thumbs}");
            assert_eq!(grid.rows[1].keys.len(), 10, "halves are split");
        }
    }

    #[test]
    fn a_line_that_is_no_row_is_named_by_its_place_in_the_file() {
        let text = "// a comment\n\nqwert yuiop\nasdfg hjkl;\nabcdefg x\n";
        let error = read(text, "a").expect_err("a line that is no row");
        assert!(error.to_string().contains("line 5 of the text"), "{error}");
    }

    #[test]
    fn a_text_with_more_lines_than_a_grid_is_none() {
        let fingers = "0 1 2 3 3 6 6 7 8 9\n";
        let lines = |more: usize| LETTERS.to_owned() + &fingers.repeat(more);
        assert!(read(&lines(MOST_LINES - 3), "a").is_ok());
        let error = read(&lines(MOST_LINES - 2), "a").expect_err("a long text");
        assert!(error.to_string().contains("more than 12 lines"), "{error}");
    }
}
