//! The first message of a page, and the answer.

use ademan_core::message::escape;
use serde::{Deserialize, Serialize};

/// Longest name of a headset in messages, in characters.
const MAX_NAME: usize = 40;

/// The first message of a page.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Hello {
    /// The digits of the token.
    pub token: String,
    /// The name of the headset, as the page states it.
    #[serde(default)]
    name: String,
}

/// The answer to a page.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(super) enum Answer {
    /// It is read from now on.
    Welcome {
        /// The text of the layout that it shows; it keeps its own without one.
        #[serde(skip_serializing_if = "Option::is_none")]
        layout: Option<String>,
    },
    /// Its token is not valid.
    Refused,
    /// Another headset is read.
    Busy,
}

impl Hello {
    /// Reads a message.
    pub fn parse(message: &[u8]) -> Option<Self> {
        serde_json::from_slice(message).ok()
    }

    /// Returns the name for messages: short, and without characters that act on a terminal.
    pub fn name(&self) -> String {
        let short: String = self.name.chars().take(MAX_NAME).collect();
        match short.trim() {
            "" => "headset".to_owned(),
            name => escape(name).into_owned(),
        }
    }
}

impl Answer {
    /// Returns the text of the message.
    pub fn to_text(&self) -> String {
        serde_json::to_string(self).expect("texts only")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_short_and_starts_no_line() {
        let name = |name: &str| {
            let hello = serde_json::json!({"token": "", "name": name}).to_string();
            Hello::parse(hello.as_bytes()).expect("a message").name()
        };
        assert_eq!(name("Quest 3"), "Quest 3");
        assert_eq!(name("  "), "headset");
        assert_eq!(name(&"a".repeat(1000)), "a".repeat(MAX_NAME));
        for foreign in ["a\nb", "\u{1b}[2J", "\u{202e}abc"] {
            let shown = name(foreign);
            assert!(!shown.contains(['\n', '\u{1b}', '\u{202e}']), "{shown:?}");
        }
    }

    #[test]
    fn other_messages_are_no_hello() {
        for message in [
            "",
            "{}",
            "[]",
            r#"{"name":"a"}"#,
            r#"{"token":1}"#,
            r#"{"token":"","hands":[]}"#,
        ] {
            assert!(Hello::parse(message.as_bytes()).is_none(), "{message}");
        }
    }
}
