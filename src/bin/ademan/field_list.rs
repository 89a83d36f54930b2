//! `ademan layout fields` and `ademan person fields`: the fields of a file, with their defaults and valid values.

use std::io::{self, Write};

use ademan::document::Table;
use ademan::layout::field_tables;
use ademan::names::UnknownName;

use crate::failure::Failure;
use crate::list::print_json;
use crate::messages;

/// Least width of the meanings beside the other columns, in characters.
const MIN_MEANING: usize = 30;

/// The default of a field that must be written.
const REQUIRED: &str = "required";

/// Arguments of the list.
#[derive(clap::Args)]
pub struct Args {
    /// A structure, such as slider, or part of the name of a field
    word: Option<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Prints the tables of layout files that the word finds, or all.
pub fn print(args: &Args) -> Result<(), Failure> {
    print_tables(args, field_tables(), "ademan layout fields")
}

/// Prints the tables that the word finds, or all. `command` lists all of them.
pub fn print_tables(args: &Args, tables: Vec<Table>, command: &str) -> Result<(), Failure> {
    let tables = match &args.word {
        Some(word) => matching(tables, word, command)?,
        None => tables,
    };
    if args.json {
        return print_json(&tables);
    }
    let columns = messages::output_columns().unwrap_or_default();
    let texts: Vec<String> = tables.iter().map(|table| text(table, columns)).collect();
    Ok(io::stdout().write_all(texts.join("\n").as_bytes())?)
}

/// Returns the structure with this name, or else the fields whose name contains the word.
fn matching(tables: Vec<Table>, word: &str, command: &str) -> Result<Vec<Table>, Failure> {
    let lower = word.to_lowercase();
    let is_named = |table: &&Table| table.name.to_lowercase() == lower;
    if let Some(table) = tables.iter().find(is_named) {
        return Ok(vec![table.clone()]);
    }
    let mut found = tables.clone();
    for table in &mut found {
        table
            .rows
            .retain(|row| row.name.to_lowercase().contains(&lower));
    }
    found.retain(|table| !table.rows.is_empty());
    if found.is_empty() {
        let names = tables.iter().flat_map(|table| {
            let fields = table.rows.iter().map(|row| row.name.as_str());
            std::iter::once(table.name).chain(fields)
        });
        let unknown = UnknownName::new("field or structure", word, names);
        return Err(Failure::wrong_use(format!(
            "{unknown}; `{command}` lists all fields"
        )));
    }
    Ok(found)
}

/// Returns a table below its name: as aligned columns, of which the last one breaks between words, or with the meaning below each
/// field if they have no room within `columns`, 0 for no limit.
fn text(table: &Table, columns: usize) -> String {
    let rows: Vec<[String; 4]> = table
        .rows
        .iter()
        .map(|row| {
            [&row.name, &row.default, &row.values, &row.meaning].map(|cell| cell.replace('`', ""))
        })
        .collect();
    let width = |column: usize| {
        let widths = rows.iter().map(|row| row[column].chars().count());
        widths.max().unwrap_or_default()
    };
    let (name, default, values) = (width(0), width(1), width(2));
    let is_narrow = (1..8 + name + default + values + MIN_MEANING).contains(&columns);
    let title = format!("{}: {}", table.name, table.meaning.replace('`', ""));
    let mut text = messages::row("", &title, columns) + "\n";
    for row in &rows {
        let lines = if is_narrow {
            narrow_row(row, columns)
        } else {
            let first = format!(
                "  {:name$}  {:default$}  {:values$}  ",
                row[0], row[1], row[2]
            );
            messages::row(&first, &row[3], columns)
        };
        text += lines.trim_end();
        text.push('\n');
    }
    text
}

/// Returns the lines of a row in a narrow terminal: its name, values and default, and its meaning below.
fn narrow_row([name, default, values, meaning]: &[String; 4], columns: usize) -> String {
    let default = match default.as_str() {
        "" | REQUIRED => default.clone(),
        other => format!("default: {other}"),
    };
    let mut facts = vec![values.as_str(), default.as_str()];
    facts.retain(|fact| !fact.is_empty());
    let first = messages::row(&format!("  {name}  "), &facts.join("; "), columns);
    let below = messages::row("      ", meaning, columns);
    format!("{}\n{below}", first.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_terminal_shows_the_meaning_below_each_field() {
        let tables = field_tables();
        let key = tables.iter().find(|table| table.name == "Key");
        let key = key.expect("the fields of a key");
        let narrow = text(key, 60);
        println!("{narrow}");
        assert!(narrow.lines().all(|line| line.chars().count() <= 60));
        let size = "\n  at_mm  2 numbers, each -2000 to 2000 mm; required\n      Center\n";
        assert!(narrow.contains(size), "{narrow}");
        let wide = text(key, 0);
        assert_eq!(wide.lines().count(), key.rows.len() + 1);
        let broken = text(key, 130);
        assert!(broken.lines().all(|line| line.chars().count() <= 130));
        assert!(broken.lines().count() > key.rows.len() + 1);
        let names = |of: &str| {
            of.lines()
                .filter(|line| line.starts_with("  at_mm"))
                .count()
        };
        assert_eq!([&narrow, &broken, &wide].map(|it| names(it)), [1; 3]);
    }
}
