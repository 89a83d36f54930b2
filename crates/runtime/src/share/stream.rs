//! Reading from the stream of a client.

use std::io::{self, ErrorKind, Read};
use std::sync::Arc;

/// The client has to be disconnected.
#[derive(Debug)]
pub(super) struct Disconnected;

/// A part of what a client has sent.
pub(super) enum Received {
    /// There is nothing more.
    Nothing,
    /// A request.
    Request(Vec<u8>),
    /// Bytes to send to the client.
    Reply(Arc<[u8]>),
    /// The client is disconnected, for this reason.
    Refused(String),
    /// The client has gone, or there is no way to tell it what is wrong.
    Gone,
}

/// The result of a read.
pub(super) enum Input {
    /// Bytes; none if the client has closed its half of the connection.
    Bytes(usize),
    /// Nothing has arrived.
    Nothing,
    /// The connection is lost.
    Lost,
}

/// The bytes of a client that one round reads. Further bytes wait for the next round, so that no client occupies the thread.
pub(super) struct RoundInput<'a> {
    stream: &'a mut dyn Read,
    /// Bytes that may still be read.
    left: usize,
}

impl<'a> RoundInput<'a> {
    /// Limits a round to a number of bytes.
    pub fn new(stream: &'a mut dyn Read, max_bytes: usize) -> Self {
        Self {
            stream,
            left: max_bytes,
        }
    }
}

impl Read for RoundInput<'_> {
    /// Fails with [`ErrorKind::WouldBlock`] after the last byte of the round: the connection has not ended.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let most = buffer.len().min(self.left);
        if most == 0 {
            return Err(ErrorKind::WouldBlock.into());
        }
        let count = self.stream.read(&mut buffer[..most])?;
        self.left -= count;
        Ok(count)
    }
}

/// Reads the bytes that have arrived.
pub(super) fn read(stream: &mut dyn Read, buffer: &mut [u8]) -> Input {
    match stream.read(buffer) {
        Ok(count) => Input::Bytes(count),
        Err(error) if is_temporary(error.kind()) => Input::Nothing,
        Err(_) => Input::Lost,
    }
}

/// Returns `true` if a stream without data failed with this kind of error, which differs with the system if a read has a time limit.
pub(super) fn is_temporary(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_reads_a_part_of_a_flood_and_notices_the_end() {
        let mut flood: &[u8] = &[b'x'; 25];
        let counts = [1, 2, 3].map(|_| {
            let mut round = RoundInput::new(&mut flood, 10);
            let reads = std::iter::from_fn(|| match read(&mut round, &mut [0; 4]) {
                Input::Bytes(0) | Input::Nothing | Input::Lost => None,
                Input::Bytes(count) => Some(count),
            });
            reads.collect::<Vec<_>>()
        });
        assert_eq!(counts, [vec![4, 4, 2], vec![4, 4, 2], vec![4, 1]]);
        let mut round = RoundInput::new(&mut flood, 10);
        assert!(matches!(read(&mut round, &mut [0; 4]), Input::Bytes(0)));
    }

    #[test]
    fn a_client_that_sends_nothing_for_a_time_is_not_lost() {
        struct Failing(ErrorKind);

        impl Read for Failing {
            fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
                Err(self.0.into())
            }
        }

        let is_kept = |kind| {
            let input = read(&mut Failing(kind), &mut [0; 4]);
            matches!(input, Input::Nothing)
        };
        assert!(is_kept(ErrorKind::WouldBlock));
        assert!(is_kept(ErrorKind::TimedOut));
        assert!(!is_kept(ErrorKind::ConnectionReset));
    }
}
