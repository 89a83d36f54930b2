//! The first bytes of a watchdog: whether it can work.

use std::io::{self, ErrorKind, Read};

use super::message::READY;

/// Maximum length of the reason for which a watchdog cannot work, in bytes.
const MAX_REASON: u64 = 4096;

/// Reads whether the watchdog can work, or the reason why it cannot.
pub fn read_ready(mut output: impl Read) -> Result<(), String> {
    let mut first = [0];
    match read_first(&mut output, &mut first) {
        Ok(1) if first[0] == READY => Ok(()),
        Ok(1) => {
            let mut reason = first.to_vec();
            let _ = output.take(MAX_REASON).read_to_end(&mut reason);
            Err(String::from_utf8_lossy(&reason).into_owned())
        }
        Ok(_) => Err("it exited at once".into()),
        Err(error) => Err(match error.kind() {
            // The time limit of a socket.
            ErrorKind::WouldBlock | ErrorKind::TimedOut => "it does not respond".into(),
            _ => error.to_string(),
        }),
    }
}

/// Reads a byte, also after an interruption: any signal interrupts a read with a time limit, and so does the continuation of a process
/// that was stopped (signal(7)).
fn read_first(output: &mut impl Read, first: &mut [u8]) -> io::Result<usize> {
    loop {
        match output.read(first) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            read => return read,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::watchdog::WatchdogReply;

    #[test]
    fn anything_but_the_ready_byte_is_the_reason_why_it_cannot_work() {
        let read = |bytes: &[u8]| read_ready(bytes);
        assert_eq!(read(&[READY, WatchdogReply::Alive.to_byte()]), Ok(()));
        assert_eq!(read(b"no desktop"), Err("no desktop".into()));
        assert_eq!(read(b""), Err("it exited at once".into()));
    }

    /// A socket that fails with these errors, the last one first, and is ready then.
    struct Failing(Vec<ErrorKind>);

    impl Read for Failing {
        fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            if let Some(kind) = self.0.pop() {
                return Err(kind.into());
            }
            bytes[0] = READY;
            Ok(1)
        }
    }

    #[test]
    fn a_signal_does_not_end_the_wait_and_the_time_limit_does() {
        let read = |errors: &[ErrorKind]| read_ready(Failing(errors.to_vec()));
        assert_eq!(read(&[ErrorKind::Interrupted; 2]), Ok(()));
        let no_response: Result<(), String> = Err("it does not respond".into());
        assert_eq!(read(&[ErrorKind::WouldBlock]), no_response);
        let late = [ErrorKind::TimedOut, ErrorKind::Interrupted];
        assert_eq!(read(&late), no_response);
    }
}
