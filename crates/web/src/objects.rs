//! Objects for the page, one per line.

use serde::Serialize;

/// Objects that are written one after the other.
#[derive(Debug, Default)]
pub struct Lines(Vec<u8>);

/// An object with its kind in front.
#[derive(Serialize)]
struct Kinded<'a, T: Serialize> {
    kind: &'a str,
    #[serde(flatten)]
    object: T,
}

impl Lines {
    /// Appends an object with its kind.
    pub fn add(&mut self, kind: &str, object: impl Serialize) {
        let object = Kinded { kind, object };
        serde_json::to_writer(&mut self.0, &object)
            .expect("a vector accepts all bytes, and every key is a string");
        self.0.push(b'\n');
    }

    /// Appends a message to the person.
    pub fn add_notice(&mut self, text: &str) {
        #[derive(Serialize)]
        struct Notice<'a> {
            text: &'a str,
        }
        self.add("notice", Notice { text });
    }

    /// Appends the text of an object, which has no kind yet.
    pub fn add_text(&mut self, kind: &str, object: &[u8]) {
        self.0.extend_from_slice(br#"{"kind":""#);
        self.0.extend_from_slice(kind.as_bytes());
        self.0.extend_from_slice(b"\",");
        self.0.extend_from_slice(&object[1..]);
        self.0.push(b'\n');
    }

    /// Returns the bytes, to which lines may be appended.
    pub fn bytes_mut(&mut self) -> &mut Vec<u8> {
        &mut self.0
    }

    /// Returns the text, and starts again.
    pub fn take(&mut self) -> String {
        String::from_utf8(std::mem::take(&mut self.0)).expect("JSON is UTF-8")
    }
}
