//! 6 · [`OutputEvent`](crate::device::OutputEvent) → the operating system or a peer.

use crate::device::OutputEvent;

/// Where events go.
pub trait Sink: Send {
    /// Takes the events of one frame, in order. Does not wait for the receiver.
    ///
    /// A sink keeps account of what it has put down, so that a release is never lost: what it could
    /// not deliver it delivers later, or lets go of in [`close`](Self::close).
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError>;

    /// Lets go of everything that is still down and waits, at most a second, until all is delivered.
    fn close(&mut self) -> Result<(), OutputError>;
}

/// Why events did not arrive. Each text says what was tried, what happened and what to do.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The output cannot be had here.
    #[error("cannot open the output `{output}`: {reason}")]
    Open {
        /// The output as named.
        output: String,
        /// What happened and what to do.
        reason: String,
    },
    /// The output stopped taking events.
    #[error("the output `{output}` failed: {reason}")]
    Send {
        /// The output as named.
        output: String,
        /// What happened.
        reason: String,
    },
}
