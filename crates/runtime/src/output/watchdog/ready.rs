//! The first bytes of a watchdog: whether it can work.

use std::io::Read;

use super::message::READY;

/// Maximum length of the reason for which a watchdog cannot work, in bytes.
const MAX_REASON: u64 = 4096;

/// Reads whether the watchdog can work, or the reason why it cannot.
pub fn read_ready(mut output: impl Read) -> Result<(), String> {
    let mut first = [0];
    match output.read(&mut first) {
        Ok(1) if first[0] == READY => Ok(()),
        Ok(1) => {
            let mut reason = first.to_vec();
            let _ = output.take(MAX_REASON).read_to_end(&mut reason);
            Err(String::from_utf8_lossy(&reason).into_owned())
        }
        Ok(_) => Err("it exited at once".into()),
        Err(error) => Err(error.to_string()),
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
}
