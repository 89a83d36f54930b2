//! `ademan layout fields` and `ademan person fields`: the fields of a file, with their defaults and valid values.

use std::io::{self, Write};

use ademan::document::Table;
use ademan::layout::field_tables;
use ademan::message::escape_json;
use ademan::names::UnknownName;

use crate::failure::Failure;

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
    let mut out = io::stdout().lock();
    if args.json {
        let json = serde_json::to_string_pretty(&tables).map_err(io::Error::from)?;
        return Ok(writeln!(out, "{}", escape_json(&json))?);
    }
    let texts: Vec<String> = tables.iter().map(text).collect();
    Ok(out.write_all(texts.join("\n").as_bytes())?)
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

/// Returns a table as aligned columns below its name.
fn text(table: &Table) -> String {
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
    let mut text = format!("{}: {}\n", table.name, table.meaning.replace('`', ""));
    for row in &rows {
        let line = format!(
            "  {:name$}  {:default$}  {:values$}  {}",
            row[0], row[1], row[2], row[3]
        );
        text += line.trim_end();
        text.push('\n');
    }
    text
}
