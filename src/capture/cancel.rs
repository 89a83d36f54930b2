//! How a source that waits is told that nobody listens any more.

use std::io::{self, PipeReader, PipeWriter, pipe};
use std::sync::Arc;

use crossbeam_channel::{Receiver, Sender, TryRecvError, bounded};

/// Held by whoever runs a source. Dropping it rings, once and for good.
#[derive(Debug)]
pub struct CancelHandle {
    _channel: Sender<()>,
    _pipe: PipeWriter,
}

/// What a source that may wait for long looks at: it is told both ways, to be waited for together with a channel
/// or with a file.
#[derive(Clone, Debug)]
pub struct CancelToken {
    channel: Receiver<()>,
    pipe: Arc<PipeReader>,
}

/// A bell, and those who hear it. Fails where the system has no more file numbers.
pub fn cancel_token() -> io::Result<(CancelHandle, CancelToken)> {
    // Room for one, although nothing is sent: such a channel is looked at without a lock.
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
    /// Whether it has rung.
    pub fn is_cancelled(&self) -> bool {
        self.channel.try_recv() == Err(TryRecvError::Disconnected)
    }

    /// A channel on which nothing comes, and that is closed when the bell rings.
    pub fn channel(&self) -> &Receiver<()> {
        &self.channel
    }

    /// A pipe on which nothing comes, and that is at its end when the bell rings.
    pub fn pipe(&self) -> &PipeReader {
        &self.pipe
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    #[test]
    fn a_bell_that_is_dropped_is_heard_both_ways() {
        let (bell, interrupt) = cancel_token().unwrap();
        let heard = interrupt.clone();
        assert!(!heard.is_cancelled());
        drop(bell);
        assert!(heard.is_cancelled());
        assert!(heard.channel().recv().is_err());
        assert_eq!(heard.pipe().read(&mut [0]).unwrap(), 0);
    }
}
