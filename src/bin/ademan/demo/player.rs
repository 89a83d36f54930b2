//! The simulated glove of the demo, on a thread of its own.

use std::io;
use std::thread::{self, JoinHandle};

use ademan::capture::Hc11Format;
use ademan::command::Command;
use ademan::session::CommandSender;
use ademan::sim::{PacketWriters, PlaybackStats, SimulatedTypist, play};
use crossbeam_channel::{Sender, bounded};

use crate::failure::Failure;

/// A thread that plays the simulated gloves.
pub struct Player {
    cancel: Sender<()>,
    /// Returns the writers too: dropping them unplugs the gloves.
    thread: JoinHandle<(PacketWriters, io::Result<PlaybackStats>)>,
}

impl Player {
    /// Plays all movements of the hand and then stops the session.
    pub fn start(
        typist: SimulatedTypist,
        mut writers: PacketWriters,
        line: Hc11Format,
        session: CommandSender,
    ) -> Self {
        let (cancel, cancelled) = bounded(1);
        let thread = thread::spawn(move || {
            let played = play(typist, &mut writers, line, &cancelled);
            // The last complete packet is still on its way to the source.
            thread::sleep(2 * line.packet_period());
            let _ = session.send(Command::Stop);
            (writers, played)
        });
        Self { cancel, thread }
    }

    /// An action that ends the playback early.
    pub fn canceller(&self) -> impl Fn() + Send + Sync + 'static {
        let cancel = self.cancel.clone();
        // A full channel means that the playback is cancelled already.
        move || _ = cancel.try_send(())
    }

    /// Ends the playback early.
    pub fn cancel(&self) {
        self.canceller()();
    }

    /// Waits for the end of the playback.
    pub fn join(self) -> Result<PlaybackStats, Failure> {
        let (_writers, played) = self
            .thread
            .join()
            .map_err(|_| Failure::job("the thread of the simulated glove panicked"))?;
        played.map_err(|error| {
            Failure::job(format!(
                "the simulated glove cannot write to its line: {error}"
            ))
        })
    }
}
