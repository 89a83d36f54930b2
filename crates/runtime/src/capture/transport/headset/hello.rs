//! The first message of a page, and the answer.

use serde::{Deserialize, Serialize};

/// The first message of a page.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Hello {
    /// The digits of the token.
    pub token: String,
    /// The name of the headset, as the page states it.
    #[serde(default)]
    pub name: String,
}

/// The answer to a page.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(super) enum Answer {
    /// The page is read from now on.
    Welcome {
        /// The text of the layout that the page shows; without one it keeps its own.
        #[serde(skip_serializing_if = "Option::is_none")]
        layout: Option<String>,
    },
    /// The token of the page is not valid.
    Refused,
    /// Another headset is read.
    Busy,
}

impl Hello {
    /// Reads a message.
    pub fn parse(message: &[u8]) -> Option<Self> {
        serde_json::from_slice(message).ok()
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
