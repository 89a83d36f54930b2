//! Texts of others in messages for people: they are escaped and cut.

mod escape;
mod formats;

pub use escape::{
    escape, escape_json, escape_line, escape_lines, escape_path, is_escaped, shell_word,
};
pub use formats::{escape_markup, quote_csv};
