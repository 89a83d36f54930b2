//! The thread that receives the replies of the watchdog.

use std::io::{self, ErrorKind, Read};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::thread;

use crossbeam_channel::{Receiver, bounded};

use super::link::send_message;
use crate::output::watchdog::message::{WatchdogMessage, WatchdogReply};
use crate::output::watchdog::replies::Replies;
use crate::output::watchdog::{MAX_UNANSWERED_PROBES, PROBE_INTERVAL};
use crate::priority;

/// Receives replies on a thread, and sends probes while none arrive. Returns a channel that is closed when the watchdog has
/// closed the socket or does not reply to probes.
pub fn receive(socket: &UnixStream, replies: Arc<Replies>) -> io::Result<Receiver<()>> {
    let (end, exited) = bounded::<()>(0);
    let socket = socket.try_clone()?;
    socket.set_read_timeout(Some(PROBE_INTERVAL))?;
    thread::Builder::new()
        .name("watchdog".into())
        .spawn(move || {
            let _end = end;
            // A press may wait for the reply.
            priority::raise_thread_priority();
            receive_until_lost(&socket, &replies);
        })?;
    Ok(exited)
}

fn receive_until_lost(mut socket: &UnixStream, replies: &Replies) {
    let mut unanswered_probes = 0;
    let mut bytes = [0; 16];
    loop {
        match socket.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => {
                unanswered_probes = 0;
                let received = bytes[..count].iter();
                received
                    .filter_map(|byte| WatchdogReply::from_byte(*byte))
                    .for_each(|reply| replies.receive(reply));
            }
            // Counted and not timed, as this process may have been stopped itself.
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                let is_lost = unanswered_probes == MAX_UNANSWERED_PROBES;
                if is_lost || send_message(socket, WatchdogMessage::Probe).is_err() {
                    return;
                }
                unanswered_probes += 1;
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_watchdog_that_replies_to_no_probe_is_lost() {
        let (socket, mut watchdog) = UnixStream::pair().unwrap();
        let exited = receive(&socket, Arc::new(Replies::new(Arc::new(|| {})))).unwrap();
        let ended = exited.recv_timeout(Duration::from_secs(30));
        assert!(ended.unwrap_err().is_disconnected());
        drop(socket);
        let mut probes = Vec::new();
        watchdog.read_to_end(&mut probes).unwrap();
        let expected = [WatchdogMessage::Probe.to_bytes(); MAX_UNANSWERED_PROBES as usize];
        assert_eq!(probes, expected.concat());
    }
}
