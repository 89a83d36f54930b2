//! Lists of what there is to choose from, made from the tables of the library.

use std::io::{self, Write};

use serde::Serialize;

use ademan::document::{Document, DocumentError, FileKind};
use ademan::files::{OpenDocument, own_names};
use ademan::message::{escape, escape_json, escape_line};

use crate::failure::Failure;
use crate::messages;

/// A line of a list.
#[derive(Serialize)]
pub struct Row {
    /// The name, as it is written in flags and files.
    pub name: String,
    /// Description in one line.
    pub summary: String,
    /// A command that uses it, where the name does not tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub example: Option<String>,
}

/// Options of every list.
#[derive(clap::Args)]
pub struct ListArgs {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl ListArgs {
    /// Prints the rows: a table with the example below each row, or JSON.
    pub fn print(&self, rows: &[Row]) -> Result<(), Failure> {
        if self.json {
            return print_json(rows);
        }
        let columns = messages::output_columns().unwrap_or_default();
        Ok(io::stdout().write_all(table(rows, columns).as_bytes())?)
    }
}

/// Returns the name and the document of each file of a kind: the files that come with the program, then the files in the
/// configuration folder.
pub fn documents(
    kind: FileKind,
) -> impl Iterator<Item = (String, Result<Document, DocumentError>)> {
    let shipped = kind
        .shipped()
        .map(|name| (name.to_owned(), Document::shipped(name)));
    let own = own_names(kind).into_iter().map(move |name| {
        let document = Document::open_kind(kind, &name);
        (name, document)
    });
    shipped.chain(own)
}

/// Returns the summary of a file with an error.
pub fn invalid(error: &DocumentError) -> String {
    format!("invalid: {}", error.message())
}

/// Prints a value as JSON.
pub fn print_json(value: &(impl Serialize + ?Sized)) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(value).map_err(io::Error::from)?;
    Ok(writeln!(io::stdout(), "{}", escape_json(&json))?)
}

/// Returns a line for each row, and one for its example. Summaries break between words within `columns`, 0 for no limit; an
/// example stays one line, which can be copied.
fn table(rows: &[Row], columns: usize) -> String {
    let names: Vec<_> = rows.iter().map(|row| escape(&row.name)).collect();
    let longest = names.iter().map(|name| name.chars().count()).max();
    let width = longest.unwrap_or_default();
    let mut text = String::new();
    for (row, name) in rows.iter().zip(names) {
        let name = format!("{name:width$}  ");
        text += &messages::row(&name, &escape_line(&row.summary), columns);
        text.push('\n');
        if let Some(example) = &row.example {
            text += &format!("{:width$}    {}\n", "", escape_line(example));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summaries_break_between_words_and_examples_stay_whole() {
        let rows = [Row {
            name: "typist:TEXT".to_owned(),
            summary: "simulated hand that types the text, through the bytes of a protocol"
                .to_owned(),
            example: Some("ademan run --source 'typist:hello?protocol=text-line'".to_owned()),
        }];
        let example = "               ademan run --source 'typist:hello?protocol=text-line'\n";
        let narrow = "typist:TEXT  simulated hand that types the text,\n             through the bytes of a protocol\n";
        assert_eq!(table(&rows, 50), format!("{narrow}{example}"));
        let whole = format!("typist:TEXT  {}\n{example}", rows[0].summary);
        assert_eq!(table(&rows, 0), whole);
        assert_eq!(table(&rows, 100), whole);
    }
}
