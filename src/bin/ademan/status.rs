//! What a run tells the person at the terminal: changes of state, and the account at the end.

use std::time::{Duration, Instant};

use ademan::estimate::Rejection;
use ademan::hand::{Finger, FingerSet, Side};
use ademan::snapshot::{PipelineState, Snapshot, Stats, Suppressed};

/// How long nothing more is said of the same loss.
const QUIET: Duration = Duration::from_secs(10);

/// Says on standard error what the engine is doing, whenever that changes, and what was lost, each reason at
/// most once in 10 s.
#[derive(Default)]
pub struct Status {
    last: Option<(PipelineState, bool)>,
    rejected: [Said<u64>; Rejection::COUNT],
    superseded: Said<u64>,
    of_system: Said<u64>,
    by_role: [Said<u64>; 2],
    too_many: u64,
    /// The fingers of each hand that were said not to be believed.
    doubts: [Said<FingerSet>; Side::COUNT],
}

/// What was said last of something that changes, and when.
#[derive(Clone, Copy, Default)]
struct Said<T> {
    last: T,
    at: Option<Instant>,
}

impl<T: Copy + PartialEq> Said<T> {
    /// What was said before, if that has changed and is to be said again: a loose contact comes and goes.
    fn change_to(&mut self, now: T) -> Option<T> {
        if now == self.last || self.at.is_some_and(|at| at.elapsed() < QUIET) {
            return None;
        }
        self.at = Some(Instant::now());
        Some(std::mem::replace(&mut self.last, now))
    }
}

impl Said<u64> {
    /// How many more there are since that was last said, if it is to be said again.
    fn news(&mut self, count: u64) -> Option<u64> {
        self.change_to(count).map(|before| count - before)
    }
}

impl Status {
    /// Takes a frame.
    pub fn show(&mut self, frame: &Snapshot) {
        // At the end those that nobody took count as superseded.
        if frame.state != PipelineState::Stopped {
            self.tell_losses(&frame.stats);
        }
        if let Some(pose) = &frame.pose
            && let said = &mut self.doubts[pose.side.index()]
            && said.change_to(pose.untrusted).is_some()
        {
            tell_doubt(pose.untrusted);
        }
        self.tell_state(frame);
    }

    fn tell_losses(&mut self, tally: &Stats) {
        for (reason, (loss, count)) in Rejection::ALL
            .iter()
            .zip(self.rejected.iter_mut().zip(tally.rejected))
        {
            if let Some(more) = loss.news(count) {
                say!("{} rejected: {reason}", counted(more, "reading"));
            }
        }
        if let Some(more) = self.superseded.news(tally.source.dropped) {
            say!(
                "{} superseded: this machine is too busy",
                counted(more, "reading")
            );
        }
        if let Some(more) = self.of_system.news(tally.suppressed.system_keys) {
            say!(
                "{} withheld that would act on the system; `system_keys: true` in the setup allows them",
                counted(more, "key")
            );
        }
        self.tell_roles(&tally.suppressed);
    }

    fn tell_roles(&mut self, withheld: &Suppressed) {
        let [keys, pointing] = &mut self.by_role;
        if let Some(more) = keys.news(withheld.keys_by_role) {
            say!(
                "{} withheld, as the source is only a pointer; `role: Both` next to it in the setup lets it type",
                counted(more, "key")
            );
        }
        if let Some(more) = pointing.news(withheld.pointing_by_role) {
            say!(
                "{} withheld, as the source is only for keys; `role: Both` next to it in the setup lets it point",
                counted(more, "pointer event")
            );
        }
    }

    fn tell_state(&mut self, frame: &Snapshot) {
        let now = (frame.state, frame.is_paused);
        if self.last.replace(now) == Some(now) {
            return;
        }
        let too_many = frame.stats.suppressed.rate_limited;
        let are_more = std::mem::replace(&mut self.too_many, too_many) < too_many;
        match frame.state {
            PipelineState::Starting | PipelineState::Stopped => {}
            PipelineState::Paused if frame.is_paused && are_more => {
                say!(
                    "paused: more presses came in than a person makes (`presses_per_second` of the setup); \
                     everything is released, `ademan ctl resume` goes on"
                );
            }
            PipelineState::Paused if frame.is_paused => {
                say!("paused: everything is released, `ademan ctl resume` goes on");
            }
            PipelineState::Paused => say!("paused: hold the hand off all keys for a moment to arm"),
            PipelineState::Running => say!("armed: touches are typed, Ctrl-C ends"),
            PipelineState::Stalled => say!("stalled: no readings, everything is released"),
        }
    }
}

fn tell_doubt(fingers: FingerSet) {
    let names = Finger::ALL
        .iter()
        .filter(|finger| fingers.contains(**finger));
    let names: Vec<_> = names.map(|finger| finger.name()).collect();
    match names.is_empty() {
        true => say!("all fingers are believed again"),
        false => say!(
            "not believed, and released: {}; a sensor has been at an end of its range for a second, check its wire",
            names.join(", ")
        ),
    }
}

/// One line: what came in, and what became of it.
pub fn account(tally: &Stats) -> String {
    let rejected = Rejection::ALL
        .iter()
        .zip(tally.rejected)
        .filter(|(_, count)| *count > 0)
        .map(|(reason, count)| format!(", {count} rejected ({reason})"));
    let source = &tally.source;
    let readings = counted(source.readings, "reading");
    let mut line = format!("{readings}: {} accepted", tally.accepted);
    line.extend(rejected);
    if source.dropped > 0 {
        line += &format!(", {} superseded", source.dropped);
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
    line + &withheld(&tally.suppressed)
}

/// What did not go out, and the fields of a setup that say so; nothing where all did.
fn withheld(withheld: &Suppressed) -> String {
    let reasons = [
        (withheld.rate_limited, "beyond `presses_per_second`"),
        (withheld.system_keys, "without `system_keys`"),
        (
            withheld.keys_by_role + withheld.pointing_by_role,
            "by `role`",
        ),
    ];
    let reasons = reasons.iter().filter(|(count, _)| *count > 0);
    let reasons: Vec<_> = reasons
        .map(|(count, reason)| format!("{count} {reason}"))
        .collect();
    match reasons.is_empty() {
        true => String::new(),
        false => format!("; withheld: {}", reasons.join(", ")),
    }
}

/// `1 key`, `2 keys`.
pub fn counted(count: u64, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}
