//! The account of a day.

use std::collections::BTreeMap;
use std::fmt;

use ademan::capture::SourceStats;
use ademan::estimate::Rejection;

use super::schedule::FaultKind;

/// A page of memory of which the system tells is so large on all machines that these tests run on.
const PAGE: u64 = 4096;
/// More may not pile up between the first quarter of a day and its end, in bytes.
const FLAT: u64 = 1 << 20;

#[derive(Default)]
pub struct SoakStats {
    pub hours: f64,
    pub faults: BTreeMap<FaultKind, usize>,
    /// Packets that the glove sent, and how many of them nothing was done to.
    pub sent: u64,
    pub whole: u64,
    pub sent_bytes: u64,
    /// What the line made of that.
    pub line: SourceStats,
    pub waiting: u64,
    pub accepted: u64,
    pub rejected: [u64; Rejection::COUNT],
    /// Readings that were too old when the program stood still.
    pub superseded: u64,
    pub stalls: u64,
    /// Pauses that were asked for, also by keys.
    pub pauses: u64,
    pub armed: u64,
    pub withheld: u64,
    /// Of each key: how often it went down, and came up.
    pub keys: BTreeMap<&'static str, (u64, u64)>,
    /// Releases that no hand made.
    pub forced: u64,
    pub other_events: u64,
    /// Resident memory in bytes, after each quarter of the day; empty where the system does not tell.
    pub resident: Vec<u64>,
}

impl SoakStats {
    pub fn faults(&self) -> usize {
        self.faults.values().sum()
    }

    pub fn presses(&self) -> u64 {
        self.keys.values().map(|(down, _)| down).sum()
    }

    fn releases(&self) -> u64 {
        self.keys.values().map(|(_, up)| up).sum()
    }

    /// Whether everything is in exactly one place, nothing is left down, and nothing piles up.
    pub fn check(&self) {
        let line = &self.line;
        assert_eq!(line.bytes, self.sent_bytes);
        assert_eq!(
            line.bytes,
            66 * line.readings + line.skipped_bytes + self.waiting
        );
        let rejected: u64 = self.rejected.iter().sum();
        assert_eq!(line.readings, self.accepted + rejected + self.superseded);
        // A packet is certain with the marks of the next one: what is wrong with one takes the one before along.
        let of = |kind| self.faults.get(&kind).copied().unwrap_or(0) as u64;
        let breaks = of(FaultKind::Unplug) + of(FaultKind::Noise) + self.sent - self.whole;
        assert!(line.readings <= self.sent, "{} packets", line.readings);
        let lost = self.sent - line.readings - self.waiting / 66;
        assert!(lost <= 2 * breaks, "{lost} packets lost in {breaks} breaks");
        assert!(self.armed <= 1 + self.stalls + self.pauses);
        for (key, (down, up)) in &self.keys {
            assert_eq!(down, up, "{key}");
        }
        if let [first, .., last] = self.resident[..] {
            assert!(last <= first + FLAT, "{:?}", self.resident);
        }
    }
}

/// Resident memory in bytes, where the system tells.
pub fn resident() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: u64 = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages * PAGE)
}

impl fmt::Display for SoakStats {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, faults) = (&self.line, self.faults());
        writeln!(f, "{} h, {faults} faults: {:?}", self.hours, self.faults)?;
        writeln!(
            f,
            "packets sent {}, of them whole {}; bytes {} = 66 × {} frames + {} skipped + {} waiting, {} resyncs",
            self.sent,
            self.whole,
            line.bytes,
            line.readings,
            line.skipped_bytes,
            self.waiting,
            line.resyncs
        )?;
        let rejected: u64 = self.rejected.iter().sum();
        write!(
            f,
            "readings {} = accepted {} + rejected {rejected} + superseded {}; rejected:",
            line.readings, self.accepted, self.superseded
        )?;
        for (reason, count) in Rejection::ALL.iter().zip(self.rejected) {
            write!(f, " {reason} {count}")?;
        }
        writeln!(
            f,
            "\nstalls {}, pauses {}, armed {} times; presses {} = releases {} of {} keys ({} releases not by a hand), \
             presses withheld {}, other events {}",
            self.stalls,
            self.pauses,
            self.armed,
            self.presses(),
            self.releases(),
            self.keys.len(),
            self.forced,
            self.withheld,
            self.other_events
        )?;
        match self.resident.is_empty() {
            true => write!(
                f,
                "SKIPPED: no /proc/self/statm, so memory was not looked at"
            ),
            false => {
                let kibibytes = self.resident.iter().map(|bytes| bytes / 1024);
                let kibibytes: Vec<u64> = kibibytes.collect();
                write!(f, "resident after each quarter, in KiB: {kibibytes:?}")
            }
        }
    }
}
