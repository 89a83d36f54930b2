//! The simulated glove of the demo, on a thread of its own.

use std::io;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use ademan::capture::Hc11Format;
use ademan::command::Command;
use ademan::session::{CommandSender, Reply};
use ademan::sim::{PacketWriters, PlaybackStats, SimulatedTypist, play};
use crossbeam_channel::{Sender, bounded};

use crate::failure::Failure;

/// Longest wait for packets that are still on their way to the session.
const ARRIVAL_TIMEOUT: Duration = Duration::from_secs(1);

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
    ) -> Result<Self, Failure> {
        let (cancel, cancelled) = bounded(1);
        let run = move || {
            let played = play(typist, &mut writers, line, &cancelled);
            if let Ok(played) = &played {
                wait_for_packets(
                    &session,
                    writers.len() as u64 * played.packets.saturating_sub(1),
                );
            }
            let _ = session.send(Command::Stop);
            (writers, played)
        };
        let thread = thread::Builder::new().name("simulated glove".into());
        let thread = thread.spawn(run).map_err(Failure::no_thread)?;
        Ok(Self { cancel, thread })
    }

    /// Returns an action that ends the playback early.
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

/// Waits until the session has received this many readings.
fn wait_for_packets(session: &CommandSender, packets: u64) {
    let deadline = Instant::now() + ARRIVAL_TIMEOUT;
    while Instant::now() < deadline {
        match session.request(Command::State) {
            Ok(Reply::State(status)) if status.stats.source.readings < packets => {
                thread::sleep(Duration::from_millis(5));
            }
            _ => return,
        }
    }
}
