//! Messages for people: text of others is escaped, and the number of messages is limited.

mod escape;
mod limit;

pub use escape::{escape, escape_lines, is_escaped};
pub use limit::{HeldBack, MESSAGE_INTERVAL, MessageLimits};
