//! The guardian's end: it listens, and lets go.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use super::super::pressed_keys::PressedKeys;
use super::super::worker::{Worker, WorkerStatus};
use super::releaser::KeyReleaser;
use super::{HEARTBEAT_TIMEOUT, READY, ReleaseTarget, WatchdogMessage};

/// How long it is listened at least, before nothing counts as silence.
const GLANCE: Duration = Duration::from_millis(1);

/// What a guardian does: it listens to the program that started it, on its own standard input, and lets go of
/// what that program holds down when it dies or falls silent. Returns when it is not needed any more.
///
/// `say` gets a line for whoever looks on; which keys it was about is not in it.
pub fn run(say: impl Fn(&str)) -> Result<(), String> {
    let stdin = rustix::stdio::stdin().try_clone_to_owned();
    let mut line = UnixStream::from(stdin.map_err(|error| error.to_string())?);
    if line.peer_addr().is_err() {
        return Err("the guardian is started by the program that it watches, not by hand".into());
    }
    let means = ReleaseTarget::receive(&line)
        .map_err(|error| format!("nothing to let go with: {error}"))?;
    let connect = || KeyReleaser::connect(&means);
    let hands = match connect() {
        Ok(hands) => hands,
        Err(reason) => {
            let _ = line.write_all(reason.as_bytes());
            return Err(reason);
        }
    };
    let report = WorkerStatus::default();
    let mut hands = Worker::new(hands, &report);
    line.write_all(&[READY])
        .map_err(|error| error.to_string())?;
    let mut watched = Watched::new(line);
    loop {
        let end = watched.wait_for_trouble();
        let count = watched.held.count();
        hands.pressed = std::mem::take(&mut watched.held);
        hands.finish(connect);
        if std::mem::take(&mut watched.is_deflected) {
            hands.injector.center_axes();
        }
        if std::mem::take(&mut watched.is_writing)
            && let Err(reason) = hands.injector.release_stuck_keys()
        {
            say(&format!("a key of a character may still be down: {reason}"));
        }
        match (end, count) {
            (Trouble::Ended, 0) => return Ok(()),
            (Trouble::Ended, _) => {
                say(&format!("the program ended; its keys are up ({count})"));
                return Ok(());
            }
            (Trouble::Silent, _) => {
                say(&format!(
                    "the program gives no sign of life; letting go of its keys ({count})"
                ));
            }
        }
    }
}

/// Why there is something to do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Trouble {
    /// The program ended, in whatever way.
    Ended,
    /// It has not said anything for too long while something is down.
    Silent,
}

/// What is known of the program.
struct Watched {
    line: UnixStream,
    held: PressedKeys,
    is_deflected: bool,
    is_writing: bool,
    last: Instant,
    /// The beginning of a word.
    begun: Vec<u8>,
}

impl Watched {
    fn new(line: UnixStream) -> Self {
        Self {
            line,
            held: PressedKeys::default(),
            is_deflected: false,
            is_writing: false,
            last: Instant::now(),
            begun: Vec::new(),
        }
    }

    /// Listens until there is something to do.
    fn wait_for_trouble(&mut self) -> Trouble {
        loop {
            let rest = HEARTBEAT_TIMEOUT.saturating_sub(self.last.elapsed());
            // Also when it is overdue: the machine may have held up this process, and not the program.
            let is_at_rest = self.held.is_empty() && !self.is_deflected && !self.is_writing;
            let patience = (!is_at_rest).then_some(rest.max(GLANCE));
            if self.line.set_read_timeout(patience).is_err() {
                return Trouble::Ended;
            }
            let mut bytes = [0; 64 * WatchdogMessage::BYTES];
            match self.line.read(&mut bytes) {
                Ok(0) => return Trouble::Ended,
                Ok(count) => {
                    self.last = Instant::now();
                    self.hear(&bytes[..count]);
                }
                Err(error) => match error.kind() {
                    ErrorKind::Interrupted => {}
                    ErrorKind::WouldBlock | ErrorKind::TimedOut => return Trouble::Silent,
                    _ => return Trouble::Ended,
                },
            }
        }
    }

    /// Takes what was read.
    fn hear(&mut self, bytes: &[u8]) {
        self.begun.extend(bytes);
        let whole = self.begun.len() - self.begun.len() % WatchdogMessage::BYTES;
        for bytes in self.begun[..whole].as_chunks().0 {
            match WatchdogMessage::from_bytes(*bytes) {
                Some(WatchdogMessage::KeyDown(key)) => _ = self.held.press(key),
                Some(WatchdogMessage::KeyUp(key)) => _ = self.held.release(key),
                Some(WatchdogMessage::AxesDeflected) => self.is_deflected = true,
                Some(WatchdogMessage::AxesCentered) => self.is_deflected = false,
                Some(WatchdogMessage::TextStarted) => self.is_writing = true,
                Some(WatchdogMessage::TextFinished) => self.is_writing = false,
                Some(WatchdogMessage::Heartbeat) | None => {}
            }
        }
        self.begun.drain(..whole);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;

    fn watched() -> (UnixStream, Watched) {
        let (engine, line) = UnixStream::pair().unwrap();
        (engine, Watched::new(line))
    }

    fn tell(mut engine: &UnixStream, words: &[WatchdogMessage]) {
        for word in words {
            engine.write_all(&word.to_bytes()).unwrap();
        }
    }

    #[test]
    fn what_is_down_when_the_line_ends_is_known() {
        let (engine, mut watched) = watched();
        let (a, shift) = (key("A"), key("ShiftLeft"));
        tell(
            &engine,
            &[
                WatchdogMessage::KeyDown(shift),
                WatchdogMessage::KeyDown(a),
                WatchdogMessage::KeyUp(a),
            ],
        );
        drop(engine);
        assert_eq!(watched.wait_for_trouble(), Trouble::Ended);
        assert_eq!(watched.held.release_order().collect::<Vec<_>>(), [shift]);
    }

    #[test]
    fn an_axis_that_is_away_from_its_rest_counts_as_down() {
        let (engine, mut watched) = watched();
        tell(&engine, &[WatchdogMessage::AxesDeflected]);
        assert_eq!(watched.wait_for_trouble(), Trouble::Silent);
        assert!(watched.is_deflected);
        tell(&engine, &[WatchdogMessage::AxesCentered]);
        drop(engine);
        assert_eq!(watched.wait_for_trouble(), Trouble::Ended);
        assert!(!watched.is_deflected);
    }

    #[test]
    fn silence_is_trouble_only_while_something_is_down() {
        let (engine, mut watched) = watched();
        let a = key("A");
        std::thread::scope(|scope| {
            scope.spawn(|| {
                tell(
                    &engine,
                    &[WatchdogMessage::KeyDown(a), WatchdogMessage::KeyUp(a)],
                );
                std::thread::sleep(2 * HEARTBEAT_TIMEOUT);
                tell(&engine, &[WatchdogMessage::KeyDown(a)]);
                for _ in 0..6 {
                    std::thread::sleep(Duration::from_millis(50));
                    tell(&engine, &[WatchdogMessage::Heartbeat]);
                }
            });
            let start = Instant::now();
            assert_eq!(watched.wait_for_trouble(), Trouble::Silent);
            assert!(watched.held.contains(a));
            assert!(
                start.elapsed() >= 3 * HEARTBEAT_TIMEOUT,
                "{:?}",
                start.elapsed()
            );
        });
    }

    #[test]
    fn words_that_come_in_pieces_are_put_together() {
        let (engine, mut watched) = watched();
        let bytes = WatchdogMessage::KeyDown(key("A")).to_bytes();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                for byte in bytes {
                    (&engine).write_all(&[byte]).unwrap();
                    std::thread::sleep(Duration::from_millis(5));
                }
            });
            assert_eq!(watched.wait_for_trouble(), Trouble::Ended);
        });
        assert!(watched.held.contains(key("A")));
    }
}
