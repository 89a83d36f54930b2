//! Messages for people: text of others is escaped, and the number of messages is limited.

mod escape;
mod limit;

pub use escape::{
    escape, escape_json, escape_line, escape_lines, escape_path, is_escaped, shell_word,
};
pub use limit::{HeldBack, MESSAGE_INTERVAL, MessageLimits};
