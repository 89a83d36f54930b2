//! Statistics of a session in one line.

use ademan::estimate::Rejection;
use ademan::pipeline::Suppressed;
use ademan::session::{Summary, counted};
use ademan::snapshot::Stats;

use crate::failure::Failure;

/// Prints the statistics. A recording that is incomplete is a failure, as the source or as the file that is written, and so is a source
/// none of whose bytes is understood.
pub fn report(summary: Summary) -> Result<(), Failure> {
    say!("{}", line(&summary.stats));
    if let Some(error) = summary.record_error {
        return Err(Failure::job(error.to_string()));
    }
    check_cut(&summary.stats)?;
    let source = &summary.stats.source;
    if source.readings == 0 && source.skipped_bytes > 0 {
        return Err(Failure::job(
            "the source sent no valid packet; check `protocol` and its options, and `baud` of a serial line (`--source` in the help lists them)",
        ));
    }
    Ok(())
}

/// Fails if the source is a recording that is cut off.
pub fn check_cut(stats: &Stats) -> Result<(), Failure> {
    match stats.source.cut_at {
        None => Ok(()),
        Some(offset) => Err(Failure::damaged(format!(
            "the recording is cut off at byte {offset}: everything before it was used, and everything is released"
        ))),
    }
}

/// Returns the warning of a session that was late, so that keys of a hand may be missing: it or its output has stalled, or readings or
/// keystrokes were dropped. A program that was stopped by Ctrl-Z is late, too.
pub fn missing_keys(stats: &Stats) -> Option<&'static str> {
    let lost = stats.stalls + stats.output_stalls + stats.source.dropped + stats.dropped_presses;
    (lost > 0)
        .then_some("keys may be missing: this machine was too busy, or the program was stopped")
}

/// Returns a line of received, accepted, rejected and dropped readings, losses, stalls of the session and its output, keystrokes that were
/// not typed, and suppressed events.
pub fn line(stats: &Stats) -> String {
    let rejected = Rejection::ALL
        .iter()
        .zip(stats.rejected)
        .filter(|(_, count)| *count > 0)
        .map(|(reason, count)| format!(", {count} rejected ({reason})"));
    let source = &stats.source;
    let readings = counted(source.readings, "reading");
    let mut line = format!("{readings}: {} accepted", stats.accepted);
    line.extend(rejected);
    if source.left_out > 0 {
        line += &format!(", {} of the other hand left out", source.left_out);
    }
    if source.dropped > 0 {
        line += &format!(", {} dropped", source.dropped);
    }
    if source.invalid.total() > 0 {
        let reasons = source.invalid.known();
        let reasons: Vec<_> = reasons
            .map(|(reason, count)| format!("{count} {reason}"))
            .collect();
        let packets = counted(source.invalid.total(), "invalid packet");
        line += &format!("; {packets} ({})", reasons.join(", "));
    }
    if source.skipped_bytes > 0 {
        line += &format!(
            "; {} of {} bytes belonged to no packet",
            source.skipped_bytes, source.bytes
        );
    }
    if source.losses > 0 {
        line += &format!("; the device was lost {}", counted(source.losses, "time"));
    }
    if stats.stalls > 0 {
        line += &format!("; stalled {}", counted(stats.stalls, "time"));
    }
    if stats.output_stalls > 0 {
        let times = counted(stats.output_stalls, "time");
        line += &format!("; the output stalled {times}");
    }
    if stats.dropped_presses > 0 {
        let keystrokes = counted(stats.dropped_presses, "keystroke");
        line += &format!("; the output did not type {keystrokes}");
    }
    line + &suppressed(&stats.suppressed)
}

/// Returns the suppressed events with the setup field that suppressed them; empty if there are none.
fn suppressed(suppressed: &Suppressed) -> String {
    let reasons = [
        (suppressed.rate_limited, "beyond `max_presses_per_second`"),
        (suppressed.system_keys, "without `allow_system_keys`"),
        (
            suppressed.keys_by_role + suppressed.pointing_by_role,
            "by `role`",
        ),
    ];
    let reasons: Vec<_> = reasons
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, reason)| format!("{count} {reason}"))
        .collect();
    if reasons.is_empty() {
        String::new()
    } else {
        format!("; suppressed: {}", reasons.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stalls_are_named_and_may_cost_keys_as_dropped_readings_do() {
        let mut stats = Stats {
            accepted: 3,
            ..Stats::default()
        };
        stats.source.readings = 3;
        assert_eq!(missing_keys(&stats), None);
        let warning =
            Some("keys may be missing: this machine was too busy, or the program was stopped");
        stats.stalls = 2;
        assert_eq!(line(&stats), "3 readings: 3 accepted; stalled 2 times");
        assert_eq!(missing_keys(&stats), warning);
        (stats.stalls, stats.output_stalls) = (0, 1);
        assert_eq!(
            line(&stats),
            "3 readings: 3 accepted; the output stalled 1 time"
        );
        assert_eq!(missing_keys(&stats), warning);
        stats.output_stalls = 0;
        stats.source.dropped = 1;
        assert_eq!(missing_keys(&stats), warning);
    }

    #[test]
    fn keystrokes_that_the_output_dropped_are_named() {
        let mut stats = Stats {
            accepted: 3,
            ..Stats::default()
        };
        stats.source.readings = 3;
        assert_eq!(line(&stats), "3 readings: 3 accepted");
        stats.dropped_presses = 2;
        let expected = "3 readings: 3 accepted; the output did not type 2 keystrokes";
        assert_eq!(line(&stats), expected);
    }
}
