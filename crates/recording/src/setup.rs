//! The setup texts of a recording.

use std::time::Duration;

use ademan_core::document::MAX_DOCUMENT_BYTES;

/// Kind of the setup text with the shortest time between two readings, in microseconds.
const PACKET_PERIOD: &str = "packet-period";

/// Largest size of a setup text in bytes: the limit of every file of a setup.
const MAX_TEXT_BYTES: usize = MAX_DOCUMENT_BYTES as usize;

/// Largest size of all setup texts of a recording in bytes.
const MAX_SETUP_BYTES: usize = 32 << 20;

/// Most setup texts of a recording: enough for a thousand profiles.
const MAX_TEXTS: usize = 1024;

/// Texts that describe how a recording was made: glove, arm, layouts and settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordedSetup {
    /// The texts in the order of the file.
    pub entries: Vec<SetupText>,
}

/// One text of a setup.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetupText {
    /// Subject of the text: `glove`, `arm`, `layout`, `setup`, ….
    pub kind: String,
    /// Path or built-in name.
    pub name: String,
    /// The text itself.
    pub text: String,
}

impl SetupText {
    fn size(&self) -> usize {
        self.kind.len() + self.name.len() + self.text.len()
    }
}

impl RecordedSetup {
    /// Adds a text.
    #[must_use]
    pub fn with(mut self, kind: &str, name: &str, text: &str) -> Self {
        self.entries.push(SetupText {
            kind: kind.into(),
            name: name.into(),
            text: text.into(),
        });
        self
    }

    /// Adds the shortest time between two readings of the source, on which the stall timeout depends.
    #[must_use]
    pub fn with_packet_period(self, period: Option<Duration>) -> Self {
        match period {
            Some(period) => self.with(PACKET_PERIOD, "µs", &period.as_micros().to_string()),
            None => self,
        }
    }

    /// Returns the first text of this kind.
    pub fn get(&self, kind: &str) -> Option<&SetupText> {
        self.entries.iter().find(|entry| entry.kind == kind)
    }

    /// Checks that [`Recording`](super::Recording) accepts the texts. The error names what is too large.
    pub fn check_size(&self) -> Result<(), String> {
        for entry in &self.entries {
            let subject = format!("the {} {}", entry.kind, entry.name);
            check_text(&subject, entry)?;
        }
        self.check_total()
    }

    /// Returns the shortest time between two readings.
    pub fn packet_period(&self) -> Option<Duration> {
        let microseconds = self.get(PACKET_PERIOD)?.text.parse().ok()?;
        Some(Duration::from_micros(microseconds))
    }

    pub(super) fn remove_packet_period(&mut self) {
        self.entries.retain(|entry| entry.kind != PACKET_PERIOD);
    }

    /// Adds a text of a file, unless there is one of this kind.
    pub(super) fn add(&mut self, entry: SetupText) -> Result<(), String> {
        check_text("a setup text", &entry)?;
        if self.get(&entry.kind).is_none() {
            self.entries.push(entry);
        }
        self.check_total()
    }

    fn check_total(&self) -> Result<(), String> {
        let count = self.entries.len();
        if count > MAX_TEXTS {
            return Err(format!("there are more than {MAX_TEXTS} setup texts"));
        }
        let size: usize = self.entries.iter().map(SetupText::size).sum();
        if size <= MAX_SETUP_BYTES {
            Ok(())
        } else {
            Err(format!(
                "the setup texts have {size} bytes, more than the limit of {MAX_SETUP_BYTES}"
            ))
        }
    }
}

/// Checks the size of a text. The error calls it `subject`.
fn check_text(subject: &str, entry: &SetupText) -> Result<(), String> {
    let size = entry.size();
    if size <= MAX_TEXT_BYTES {
        Ok(())
    } else {
        Err(format!(
            "{subject} has {size} bytes, more than the limit of {MAX_TEXT_BYTES}"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(kind: &str, length: usize) -> SetupText {
        SetupText {
            kind: kind.into(),
            name: String::new(),
            text: "x".repeat(length),
        }
    }

    #[test]
    fn the_first_text_of_a_kind_is_kept_and_the_others_take_no_memory() {
        let mut setup = RecordedSetup::default();
        for length in [3, 700_000, 700_000] {
            for kind in ["layout", "glove"] {
                setup.add(text(kind, length)).unwrap();
            }
        }
        assert_eq!(setup.entries, [text("layout", 3), text("glove", 3)]);
    }

    #[test]
    fn texts_beyond_the_limits_are_errors() {
        let add_all = |count: usize, length: usize| {
            let mut setup = RecordedSetup::default();
            (0..count).try_for_each(|index| setup.add(text(&index.to_string(), length)))
        };
        assert_eq!(add_all(32, 1_000_000), Ok(()));
        let error = add_all(40, 1_000_000).unwrap_err();
        assert!(error.contains("more than the limit of 33554432"), "{error}");
        let too_long = add_all(1, 2_000_000).unwrap_err();
        assert_eq!(
            too_long,
            "a setup text has 2000001 bytes, more than the limit of 1048576"
        );
        let too_many = add_all(2000, 1).unwrap_err();
        assert_eq!(too_many, "there are more than 1024 setup texts");
    }
}
