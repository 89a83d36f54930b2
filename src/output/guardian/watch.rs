//! The guardian's end: it listens, and lets go.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use super::super::held::Held;
use super::super::platform;
use super::super::worker::{Report, Worker};
use super::{READY, SILENCE, Word};

/// How long it is listened at least, before nothing counts as silence.
const GLANCE: Duration = Duration::from_millis(1);

/// What a guardian does: it listens to the program that started it, on its own standard input, and lets go of
/// what that program holds down when it dies or falls silent. Returns when it is not needed any more.
///
/// `say` gets a line for whoever looks on; which keys it was about is not in it.
pub fn watch(say: impl Fn(&str)) -> Result<(), String> {
    let stdin = rustix::stdio::stdin().try_clone_to_owned();
    let mut line = UnixStream::from(stdin.map_err(|error| error.to_string())?);
    if line.peer_addr().is_err() {
        return Err("the guardian is started by the program that it watches, not by hand".into());
    }
    // It presses nothing, so it makes do without a pointer where the program does.
    let connect = || platform::open(None, false);
    let display = match connect() {
        Ok(display) => display,
        Err(reason) => {
            let _ = line.write_all(reason.as_bytes());
            return Err(reason);
        }
    };
    let report = Report::default();
    let mut hands = Worker::new(display, &report);
    line.write_all(&[READY])
        .map_err(|error| error.to_string())?;
    let mut watched = Watched::new(line);
    loop {
        let end = watched.wait_for_trouble();
        let count = watched.held.count();
        hands.held = std::mem::take(&mut watched.held);
        hands.let_go(connect);
        match (end, count) {
            (Trouble::Over | Trouble::Died, 0) => return Ok(()),
            (Trouble::Over | Trouble::Died, _) => {
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
    /// The program ended in good order.
    Over,
    /// It ended in any other way.
    Died,
    /// It has not said anything for too long while something is down.
    Silent,
}

/// What is known of the program.
struct Watched {
    line: UnixStream,
    held: Held,
    last: Instant,
    /// The beginning of a word.
    begun: Vec<u8>,
}

impl Watched {
    fn new(line: UnixStream) -> Self {
        Self {
            line,
            held: Held::default(),
            last: Instant::now(),
            begun: Vec::new(),
        }
    }

    /// Listens until there is something to do.
    fn wait_for_trouble(&mut self) -> Trouble {
        loop {
            let rest = SILENCE.saturating_sub(self.last.elapsed());
            // Also when it is overdue: the machine may have held up this process, and not the program.
            let patience = (!self.held.is_empty()).then_some(rest.max(GLANCE));
            if self.line.set_read_timeout(patience).is_err() {
                return Trouble::Died;
            }
            let mut bytes = [0; 64 * Word::BYTES];
            match self.line.read(&mut bytes) {
                Ok(0) => return Trouble::Died,
                Ok(count) => {
                    self.last = Instant::now();
                    if self.hear(&bytes[..count]) {
                        return Trouble::Over;
                    }
                }
                Err(error) => match error.kind() {
                    ErrorKind::Interrupted => {}
                    ErrorKind::WouldBlock | ErrorKind::TimedOut => return Trouble::Silent,
                    _ => return Trouble::Died,
                },
            }
        }
    }

    /// Takes what was read; whether it was the last.
    fn hear(&mut self, bytes: &[u8]) -> bool {
        self.begun.extend(bytes);
        let whole = self.begun.len() - self.begun.len() % Word::BYTES;
        let mut is_over = false;
        for bytes in self.begun[..whole].as_chunks().0 {
            match Word::from_bytes(*bytes) {
                Some(Word::Down(key)) => _ = self.held.press(key),
                Some(Word::Up(key)) => _ = self.held.release(key),
                Some(Word::Over) => is_over = true,
                Some(Word::Alive) | None => {}
            }
        }
        self.begun.drain(..whole);
        is_over
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

    fn tell(mut engine: &UnixStream, words: &[Word]) {
        for word in words {
            engine.write_all(&word.to_bytes()).unwrap();
        }
    }

    #[test]
    fn what_is_down_when_the_line_ends_is_known() {
        let (engine, mut watched) = watched();
        let (a, shift) = (key("A"), key("ShiftLeft"));
        tell(&engine, &[Word::Down(shift), Word::Down(a), Word::Up(a)]);
        drop(engine);
        assert_eq!(watched.wait_for_trouble(), Trouble::Died);
        assert_eq!(watched.held.release_order().collect::<Vec<_>>(), [shift]);
    }

    #[test]
    fn a_program_that_says_good_bye_did_not_die() {
        let (engine, mut watched) = watched();
        tell(&engine, &[Word::Alive, Word::Over]);
        drop(engine);
        assert_eq!(watched.wait_for_trouble(), Trouble::Over);
    }

    #[test]
    fn silence_is_trouble_only_while_something_is_down() {
        let (engine, mut watched) = watched();
        let a = key("A");
        std::thread::scope(|scope| {
            scope.spawn(|| {
                tell(&engine, &[Word::Down(a), Word::Up(a)]);
                std::thread::sleep(2 * SILENCE);
                tell(&engine, &[Word::Down(a)]);
                for _ in 0..6 {
                    std::thread::sleep(Duration::from_millis(50));
                    tell(&engine, &[Word::Alive]);
                }
            });
            let start = Instant::now();
            assert_eq!(watched.wait_for_trouble(), Trouble::Silent);
            assert!(watched.held.contains(a));
            assert!(start.elapsed() >= 3 * SILENCE, "{:?}", start.elapsed());
        });
    }

    #[test]
    fn words_that_come_in_pieces_are_put_together() {
        let (engine, mut watched) = watched();
        let bytes = Word::Down(key("A")).to_bytes();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                for byte in bytes {
                    (&engine).write_all(&[byte]).unwrap();
                    std::thread::sleep(Duration::from_millis(5));
                }
            });
            assert_eq!(watched.wait_for_trouble(), Trouble::Died);
        });
        assert!(watched.held.contains(key("A")));
    }
}
