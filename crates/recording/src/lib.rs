//! Recordings: MCAP files with readings, the results of the pipeline and the setup.
//!
//! A recording is an [MCAP](https://mcap.dev/spec) file. Its records, in order: a metadata record [`FORMAT_RECORD`], a
//! metadata record [`SETUP_RECORD`] per setup text, the channels, and chunks of [messages](message). Of several setup texts of
//! one kind the first one counts. Readings are on the channel [`READINGS_TOPIC`]. A chunk has the messages of less than a second,
//! so a truncated file loses at most the messages of its last second.
//!
//! Recordings of format 1 have messages in JSON outside chunks. They are read and no longer written.
//!
//! [`Recording`] reads the readings and the commands. Angles, touches, presses and events follow from them and the setup: a replay
//! (`session::replay` of `ademan_runtime`) computes them again, also on another layout. Other programs read the recorded ones with the
//! schema in the file.
//!
//! - [`message`] encodes and decodes messages.
//! - [`kind`] lists the kinds of setup texts.
//!
//! ```
//! use ademan_recording::{RecordedEvent, Recording, RecordingError};
//!
//! fn readings(bytes: &[u8]) -> Result<usize, RecordingError> {
//!     let mut recording = Recording::new(bytes)?;
//!     let mut count = 0;
//!     while let Some(event) = recording.next_event()? {
//!         count += usize::from(matches!(event, RecordedEvent::Reading(_)));
//!     }
//!     Ok(count)
//! }
//!
//! let error = readings(b"HIERARCHY").unwrap_err();
//! assert_eq!(error.to_string(), "at byte 0, it is not an MCAP file");
//! ```

mod chunk;
mod json;
pub mod kind;
mod lengths;
pub mod message;
mod reader;
mod records;
mod setup;

pub use chunk::COMPRESSION;
pub use reader::{RecordedEvent, Recording, RecordingError, Truncation};
pub use setup::{RecordedSetup, SetupText};

/// Topic of the channel of readings.
pub const READINGS_TOPIC: &str = "/readings";

/// Topic of the channel of commands.
pub const COMMANDS_TOPIC: &str = "/commands";

/// The `origin`, in JSON, of a command from outside the layout. A replay of the readings does not issue it again.
pub const EXTERNAL_ORIGIN: &str = "external";

/// Encoding of the messages of all channels, and of the schemas.
pub const MESSAGE_ENCODING: &str = "protobuf";

/// Encoding of the messages of format 1.
pub const JSON_ENCODING: &str = "json";

/// Metadata record with the version of the format, under the key `format`.
pub const FORMAT_RECORD: &str = "ademan";

/// Version of the format that this program writes.
pub const FORMAT_VERSION: &str = "2";

/// Version of the format with messages in JSON, which this program also reads.
pub const JSON_FORMAT_VERSION: &str = "1";

/// Metadata record with a setup text: the keys `kind`, `name` and `text`.
pub const SETUP_RECORD: &str = "ademan.setup";

/// Largest size of a record and of a chunk in bytes: enough for the largest setup text.
pub const MAX_RECORD_BYTES: usize = 4 << 20;
