//! What a run tells the person at the terminal: changes of state, and the account at the end.

use ademan::estimate::Rejection;
use ademan::monitor::{Snapshot, State, Tally};

/// Says on standard error what the engine is doing, whenever that changes.
#[derive(Default)]
pub struct Status {
    last: Option<(State, bool)>,
}

impl Status {
    /// Takes a frame.
    pub fn show(&mut self, frame: &Snapshot) {
        let now = (frame.state, frame.is_paused);
        if self.last.replace(now) == Some(now) {
            return;
        }
        match frame.state {
            State::Starting | State::Stopped => {}
            State::Paused if frame.is_paused => {
                say!("paused: everything is released, `ademan ctl resume` goes on");
            }
            State::Paused => say!("paused: hold the hand off all keys for a moment to arm"),
            State::Running => say!("armed: touches are typed, Ctrl-C ends"),
            State::Stalled => say!("stalled: no readings, everything is released"),
        }
    }
}

/// One line: what came in, and what became of it.
pub fn account(tally: &Tally) -> String {
    let rejected = Rejection::ALL
        .iter()
        .zip(tally.rejected)
        .filter(|(_, count)| *count > 0)
        .map(|(reason, count)| format!(", {count} rejected ({reason})"));
    let source = &tally.source;
    let readings = counted(source.readings, "reading");
    let mut line = format!("{readings}: {} accepted", tally.accepted);
    line.extend(rejected);
    if source.superseded > 0 {
        line += &format!(", {} superseded", source.superseded);
    }
    if source.skipped_bytes > 0 {
        line += &format!(
            "; {} of {} bytes belonged to no frame",
            source.skipped_bytes, source.bytes
        );
    }
    if source.losses > 0 {
        line += &format!("; the device was lost {}", counted(source.losses, "time"));
    }
    line
}

/// `1 key`, `2 keys`.
pub fn counted(count: u64, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}
