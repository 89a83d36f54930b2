//! Stage 1: A sensor → [`Reading`].
//!
//! A [`SourceUri`] names a source, [`open`] opens it as a [`Source`], and [`spawn`] runs that on its own thread:
//!
//! ```no_run
//! use ademan_runtime::capture::{CaptureEvent, SourceUri, open, spawn};
//!
//! let uri: SourceUri = "serial:/dev/ttyUSB0?protocol=hc11&baud=9600".parse()?;
//! let capture = spawn(open(&uri)?)?;
//! for event in capture.events() {
//!     match event {
//!         CaptureEvent::Reading { reading, .. } => println!("{reading:?}"),
//!         CaptureEvent::Readings { readings, .. } => println!("{readings:?}"),
//!         CaptureEvent::Lost(error) | CaptureEvent::Failed(error) => eprintln!("{error}"),
//!         CaptureEvent::Elapsed(time) => println!("no reading until {time:?}"),
//!         CaptureEvent::Command(command) => println!("a recorded command: {command:?}"),
//!         CaptureEvent::Noise(stats) | CaptureEvent::End(stats) => println!("{stats:?}"),
//!     }
//! }
//! # Ok::<(), ademan_runtime::capture::CaptureError>(())
//! ```
//!
//! A byte stream consists of a [transport], which carries the bytes, and a [protocol], which decodes them. Any other
//! sensor implements [`Source`].

pub mod cameras;
pub mod cancel;
pub mod feedback;
pub mod pace;
pub mod thread;
mod event;
mod event_queue;
mod headset_list;
mod clock_offset;
mod merge;
mod poll;
mod sides;

// Everything below needs an operating system with devices, files and sockets.
mod active_sender;
mod connection;
mod garbage;
pub mod loopback;
mod packet_clock;
mod in_place;
pub mod recognition;
mod reconnect;
mod sender_clock;
pub mod recording;
mod stream;
pub mod transport;
pub mod uri;
mod wake_up;
mod suspend;

use std::time::{Duration, Instant};

use self::feedback::FeedbackDevice;
use ademan_core::command::Command;
use ademan_core::hand::Side;
use ademan_core::time::Timestamp;

pub use ademan_core::capture::*;
pub use cancel::CancelToken;
pub use event::CaptureEvent;
pub use headset_list::{ConnectedHeadset, Headset, HeadsetList, HeadsetStatus};
pub use merge::{MAX_SOURCES, MergedSource, PartialSource};
pub use pace::{MAX_SILENCE, PacedSource};
pub use poll::Readiness;
pub use sides::SidedSource;
pub use thread::{CaptureThread, spawn, spawn_batched};
pub(crate) use {in_place::InPlaceCapture, wake_up::WakeUp};
pub use {
    loopback::{Loopback, open_loopback},
    reconnect::BackOff,
    transport::StreamUri,
    uri::SourceUri,
};

/// Opens the source of a byte stream.
///
/// Recordings and simulated hands are opened by their own modules; their URIs are an error here.
pub fn open(uri: &SourceUri) -> Result<Box<dyn Source>, CaptureError> {
    match uri {
        SourceUri::Stream(stream) => (stream.transport.open)(stream),
        SourceUri::Recording { .. } | SourceUri::Typist { .. } | SourceUri::Script { .. } => {
            let schemes = transport::TRANSPORTS.iter();
            let schemes: Vec<String> = schemes
                .map(|transport| format!("`{}:`", transport.scheme.name))
                .collect();
            Err(CaptureError::InvalidUri {
                text: uri.to_string(),
                reason: format!("it is not a byte stream; use one of {}", schemes.join(", ")),
            })
        }
    }
}

/// Result of a call to [`Source::next`].
#[expect(
    clippy::large_enum_variant,
    reason = "a reading is passed on without an allocation"
)]
#[derive(Clone, Debug, PartialEq)]
pub enum SourceEvent {
    /// A reading.
    Reading(Reading),
    /// A command that a recorded session executed between two readings.
    Command(Command),
    /// Nothing new. Call again.
    Idle,
    /// End of the readings.
    End,
}

/// A sensor, a stream or a recording.
pub trait Source: Send {
    /// Returns the next reading.
    ///
    /// Blocks for at most [`MAX_BLOCK`], so that its thread can be stopped. A source with a
    /// [cancel token](Self::set_cancel_token) may block until cancellation.
    ///
    /// May be called again after a [recoverable](CaptureError::is_recoverable) error. A source whose device was lost
    /// then reconnects.
    fn next(&mut self) -> Result<SourceEvent, CaptureError>;

    /// Registers the token that cancels a blocking [`next`](Self::next), so that an idle source wakes no thread. The
    /// default ignores it.
    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        let _ = cancel;
    }

    /// Makes [`next`](Self::next) return at once, with [`Idle`](SourceEvent::Idle) if nothing has arrived. The caller then waits
    /// as described by [`wait`](Self::wait). Returns `false`, the default, if the source has to block and needs a thread of its own.
    fn set_polled(&mut self) -> bool {
        false
    }

    /// Returns the wait of a [polled](Self::set_polled) source, or `None` if [`next`](Self::next) has an event already.
    fn wait(&self) -> Option<SourceWait<'_>> {
        None
    }

    /// Returns the device that measures the fingers of a hand, if feedback can be sent to it; only the first call returns it. The
    /// default is `None`.
    fn take_feedback_device(&mut self, side: Side) -> Option<FeedbackDevice> {
        let _ = side;
        None
    }

    /// Sets the age above which a source on the network drops a reading that states its time, see
    /// [`InvalidPacket::TooOld`]. The default ignores it.
    fn set_max_age(&mut self, age: Duration) {
        let _ = age;
    }

    /// Returns the headsets that are connected, if the source waits for headsets. The default is `None`.
    fn headsets(&self) -> Option<HeadsetList> {
        None
    }

    /// Returns the name for messages: the URI, if the source has one.
    fn name(&self) -> &str;

    /// Returns the shortest time between two readings, if the source knows it.
    fn packet_period(&self) -> Option<Duration> {
        None
    }

    /// Returns `true` if readings arrive at their own pace and are dropped when the consumer is slow.
    fn is_live(&self) -> bool {
        true
    }

    /// Returns `true` if the next call of [`next`](Self::next) returns at once, so that readings may be passed on together. The
    /// default is `false`, as suits a source with a pace of its own.
    fn is_ready(&self) -> bool {
        false
    }

    /// Returns the present time on the clock of a source that holds a reading back until the reading is due, earlier than the time
    /// of that reading; `None` for any other source.
    ///
    /// By the clock of a replay in real time, its consumer detects a long gap before the gap ends.
    fn clock(&self) -> Option<Timestamp> {
        None
    }

    /// Ends the capture: nothing is read after it, and the [statistics](Self::stats) cover everything that was read. May block for
    /// 1 s. The default does nothing.
    fn stop(&mut self) {}

    /// Returns the statistics since the source was opened.
    fn stats(&self) -> SourceStats {
        SourceStats::default()
    }
}

impl Source for Box<dyn Source> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        (**self).next()
    }

    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        (**self).set_cancel_token(cancel);
    }

    fn set_polled(&mut self) -> bool {
        (**self).set_polled()
    }

    fn wait(&self) -> Option<SourceWait<'_>> {
        (**self).wait()
    }

    fn take_feedback_device(&mut self, side: Side) -> Option<FeedbackDevice> {
        (**self).take_feedback_device(side)
    }

    fn set_max_age(&mut self, age: Duration) {
        (**self).set_max_age(age);
    }

    fn headsets(&self) -> Option<HeadsetList> {
        (**self).headsets()
    }

    fn name(&self) -> &str {
        (**self).name()
    }

    fn packet_period(&self) -> Option<Duration> {
        (**self).packet_period()
    }

    fn is_live(&self) -> bool {
        (**self).is_live()
    }

    fn is_ready(&self) -> bool {
        (**self).is_ready()
    }

    fn clock(&self) -> Option<Timestamp> {
        (**self).clock()
    }

    fn stop(&mut self) {
        (**self).stop();
    }

    fn stats(&self) -> SourceStats {
        (**self).stats()
    }
}

/// The wait of a [polled](Source::set_polled) source: for bytes, until a time at the latest.
#[derive(Clone, Copy, Debug)]
pub struct SourceWait<'a> {
    /// Reports bytes; `None` if none can arrive.
    pub readiness: Option<&'a Readiness>,
    /// Time of the next call without bytes.
    pub deadline: Option<Instant>,
}

/// Longest time that [`Source::next`] blocks without a cancel token.
pub const MAX_BLOCK: Duration = Duration::from_millis(100);
