//! Lists of what there is to choose from, made from the tables of the library.

use std::io::{self, Write};

use serde::Serialize;

use ademan::message::{escape, escape_json, escape_line};

use crate::failure::Failure;

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
        let mut out = io::stdout().lock();
        if self.json {
            let json = serde_json::to_string_pretty(rows).map_err(io::Error::from)?;
            return Ok(writeln!(out, "{}", escape_json(&json))?);
        }
        let names: Vec<_> = rows.iter().map(|row| escape(&row.name)).collect();
        let longest = names.iter().map(|name| name.chars().count()).max();
        let width = longest.unwrap_or_default();
        for (row, name) in rows.iter().zip(names) {
            writeln!(out, "{name:width$}  {}", escape_line(&row.summary))?;
            if let Some(example) = &row.example {
                writeln!(out, "{:width$}    {}", "", escape_line(example))?;
            }
        }
        Ok(())
    }
}
