//! The simulated glove of the demo, on a thread of its own.

use std::thread::JoinHandle;

use ademan::capture::Hc11Format;
use ademan::sim::{PacketWriters, PlaybackStats, SimulatedTypist, play};
use crossbeam_channel::{Receiver, Sender};

use crate::failure::Failure;

/// A thread that plays the gloves. It hands their lines back, which stay plugged in until then.
pub struct Player {
    thread: JoinHandle<(PacketWriters, std::io::Result<PlaybackStats>)>,
}

impl Player {
    /// Plays all that the hand has to do, and then sends to `over`; so it does when asked to stop.
    pub fn start(
        typist: SimulatedTypist,
        mut lines: PacketWriters,
        line: Hc11Format,
        asked: Receiver<()>,
        over: Sender<()>,
    ) -> Self {
        let thread = std::thread::spawn(move || {
            let played = play(typist, &mut lines, line, &asked);
            // The last frame that counts is still on its way to the source.
            std::thread::sleep(2 * line.packet_period());
            // A full channel means that the end is already known.
            let _ = over.try_send(());
            (lines, played)
        });
        Self { thread }
    }

    /// Waits for the end.
    pub fn join(self) -> Result<PlaybackStats, Failure> {
        let played = self.thread.join();
        let (_lines, played) =
            played.map_err(|_| Failure::job("the simulated glove broke down"))?;
        played.map_err(|error| {
            Failure::job(format!(
                "the simulated glove cannot write to its line: {error}"
            ))
        })
    }
}
