//! Cancellation of a blocking source.

use std::io::{self, PipeReader, PipeWriter, pipe};
use std::sync::Arc;

use crossbeam_channel::{Receiver, Sender, TryRecvError, bounded};

/// Owner's end of a cancellation. Dropping it cancels, once and permanently.
#[derive(Debug)]
pub struct CancelHandle {
    _channel: Sender<()>,
    _pipe: PipeWriter,
}

/// Source's end of a cancellation, as a channel and as a pipe: a source can wait on it together with a channel or
/// with a file descriptor.
#[derive(Clone, Debug)]
pub struct CancelToken {
    channel: Receiver<()>,
    pipe: Arc<PipeReader>,
}

/// Creates both ends of a cancellation. Fails if the process is out of file descriptors.
pub fn cancel_token() -> io::Result<(CancelHandle, CancelToken)> {
    // Capacity 1 although nothing is sent: reading such a channel takes no lock.
    let (sender, channel) = bounded(1);
    let (reader, writer) = pipe()?;
    let handle = CancelHandle {
        _channel: sender,
        _pipe: writer,
    };
    let token = CancelToken {
        channel,
        pipe: Arc::new(reader),
    };
    Ok((handle, token))
}

impl CancelToken {
    /// Returns `true` after cancellation.
    pub fn is_cancelled(&self) -> bool {
        self.channel.try_recv() == Err(TryRecvError::Disconnected)
    }

    /// Returns a channel without messages, which is disconnected on cancellation.
    pub fn channel(&self) -> &Receiver<()> {
        &self.channel
    }

    /// Returns a pipe without bytes, which is at its end on cancellation.
    pub fn pipe(&self) -> &PipeReader {
        &self.pipe
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    #[test]
    fn dropping_the_handle_cancels_channel_and_pipe() {
        let (handle, token) = cancel_token().unwrap();
        let copy = token.clone();
        assert!(!copy.is_cancelled());
        drop(handle);
        assert!(copy.is_cancelled());
        assert!(copy.channel().recv().is_err());
        assert_eq!(copy.pipe().read(&mut [0]).unwrap(), 0);
    }
}
