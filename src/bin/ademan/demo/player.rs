//! The simulated glove at the far end of the line, at the line's real pace.

use std::io::Write;
use std::thread::JoinHandle;
use std::time::Instant;

use ademan::capture::LineSettings;
use ademan::capture::hc11::{BODY_BYTES, encode};
use ademan::lab::Typist;
use crossbeam_channel::{Receiver, Sender, at};

use crate::failure::Failure;

/// A thread that plays the glove.
pub struct Player {
    thread: JoinHandle<(Box<dyn Write + Send>, std::io::Result<Played>)>,
}

/// What was played.
#[derive(Clone, Copy, Debug, Default)]
pub struct Played {
    /// Frames sent.
    pub frames: u64,
    /// Whether it was told to end early.
    pub interrupted: bool,
}

impl Player {
    /// Plays all that the typist has to type, and then sends to `over`; so it does when asked to stop.
    pub fn start(
        typist: Typist,
        mut writer: Box<dyn Write + Send>,
        line: LineSettings,
        asked: Receiver<()>,
        over: Sender<()>,
    ) -> Self {
        let thread = std::thread::spawn(move || {
            let played = play(typist, &mut *writer, line, &asked);
            // A full channel means that the end is already known.
            let _ = over.try_send(());
            // The line stays plugged in until the player is joined.
            (writer, played)
        });
        Self { thread }
    }

    /// Waits for the end.
    pub fn join(self) -> Result<Played, Failure> {
        let played = self.thread.join();
        let (_line, played) = played.map_err(|_| Failure::job("the simulated glove broke down"))?;
        played.map_err(|error| {
            Failure::job(format!(
                "the simulated glove cannot write to its line: {error}"
            ))
        })
    }
}

/// Each packet goes out when its last byte would have left the converter box.
fn play(
    mut typist: Typist,
    writer: &mut dyn Write,
    line: LineSettings,
    asked: &Receiver<()>,
) -> std::io::Result<Played> {
    let start = Instant::now();
    let mut played = Played::default();
    while let Some(counts) = typist.next_counts() {
        let mut body = [0; BODY_BYTES];
        for (byte, count) in body.iter_mut().zip(counts) {
            *byte = count as u8;
        }
        played.frames += 1;
        let due = start + line.frame_period().mul_f64(played.frames as f64);
        crossbeam_channel::select! {
            recv(asked) -> _ => {
                played.interrupted = true;
                return Ok(played);
            }
            recv(at(due)) -> _ => writer.write_all(&encode(line.framing, &body))?,
        }
    }
    writer.flush()?;
    // The last frame that counts is still on its way to the source.
    std::thread::sleep(2 * line.frame_period());
    Ok(played)
}
