//! Line breaks between words.

use std::borrow::Cow;

/// The fewest columns for which lines are broken.
const MIN_COLUMNS: usize = 30;

/// Returns the text with line breaks between words, where a line is longer than `columns` characters. What stands between two
/// backquotes is one word, unless it is longer than a line. Lines that begin with a blank, such as excerpts of a file, stay.
pub fn wrapped(text: &str, columns: usize) -> Cow<'_, str> {
    let is_long = |line: &str| line.chars().count() > columns && !line.starts_with(' ');
    if columns < MIN_COLUMNS || !text.lines().any(is_long) {
        return text.into();
    }
    let mut wrapped = String::with_capacity(text.len() + 16);
    for line in text.split_inclusive('\n') {
        if is_long(line.trim_end_matches('\n')) {
            push_wrapped(line, columns, &mut wrapped)
        } else {
            wrapped.push_str(line)
        }
    }
    wrapped.into()
}

/// Returns a row of a table, the first columns and the words of the last one, whose further lines begin below its first. In a
/// narrow terminal they begin at the left.
pub fn row(first: &str, words: &str, columns: usize) -> String {
    let indent = first.chars().count();
    let room = columns.saturating_sub(indent);
    if room < MIN_COLUMNS {
        return wrapped(&format!("{first}{words}"), columns).into_owned();
    }
    let line_break = format!("\n{}", " ".repeat(indent));
    format!("{first}{}", wrapped(words, room).replace('\n', &line_break))
}

fn push_wrapped(line: &str, columns: usize, wrapped: &mut String) {
    let mut used = 0;
    for word in words(line, columns) {
        let length = word.trim_end().chars().count();
        if used > 0 && used + length > columns {
            wrapped.truncate(wrapped.trim_end_matches(' ').len());
            wrapped.push('\n');
            used = 0;
        }
        wrapped.push_str(word);
        used += word.chars().count();
    }
}

/// Splits a line into words, each with the blanks after it.
fn words(line: &str, columns: usize) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = line;
    while !rest.is_empty() {
        let end = word_end(rest, columns);
        let (word, after) = rest.split_at(end);
        words.push(word);
        rest = after;
    }
    words
}

fn word_end(text: &str, columns: usize) -> usize {
    let blank = |words: &str| words.find(' ').unwrap_or(words.len());
    let mut end = blank(text);
    if let Some(open) = text[..end].find('`')
        && let Some(length) = text[open + 1..].find('`')
        && text[..open + length].chars().count() < columns
    {
        let close = open + 1 + length + 1;
        end = end.max(close + blank(&text[close..]));
    }
    let blanks = text[end..].len() - text[end..].trim_start_matches(' ').len();
    end + blanks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_between_words_and_commands_stay_whole() {
        let text = "no permission to open the device; add yourself to the group: `sudo usermod -aG dialout me`, then log in\n";
        let expected = "no permission to open the device; add\nyourself to the group:\n\
                        `sudo usermod -aG dialout me`, then log\nin\n";
        assert_eq!(wrapped(text, 40), expected);
        assert_eq!(wrapped(text, 200), text);
        assert_eq!(wrapped(text, 0), text);
    }

    #[test]
    fn the_last_column_of_a_row_goes_on_below_its_beginning() {
        let words = "one two three four five six seven eight nine ten";
        let expected = "name  one two three four five six\n      seven eight nine ten";
        assert_eq!(row("name  ", words, 37), expected);
        let narrow = "name  one two three four five\nsix seven eight nine ten";
        assert_eq!(row("name  ", words, 32), narrow);
        assert_eq!(row("name  ", words, 0), format!("name  {words}"));
    }

    #[test]
    fn excerpts_and_words_longer_than_a_line_stay() {
        let excerpt = format!(" 3 | {}\n", "a b ".repeat(30));
        assert_eq!(wrapped(&excerpt, 40), excerpt);
        let long = format!("see {} now", "x".repeat(50));
        assert_eq!(wrapped(&long, 40), format!("see\n{}\nnow", "x".repeat(50)));
        let command = format!("`{}`", "a b ".repeat(20));
        assert!(
            wrapped(&command, 40)
                .lines()
                .all(|line| line.chars().count() <= 40)
        );
    }
}
