//! The statistics of a run.

use std::collections::BTreeMap;
use std::fmt;

use ademan::capture::SourceStats;
use ademan::estimate::Rejection;

use super::schedule::FaultKind;

/// The size of a memory page in bytes, on all machines that run these tests.
const PAGE: u64 = 4096;
/// The permitted growth of the memory from the first quarter of the run to its end, in bytes.
const MAX_GROWTH: u64 = 1 << 20;

/// The counts and measurements of a soak test.
#[derive(Default)]
pub struct SoakStats {
    pub hours: f64,
    pub faults: BTreeMap<FaultKind, usize>,
    /// The number of sent packets, and of those without a fault.
    pub sent: u64,
    pub whole: u64,
    pub sent_bytes: u64,
    /// The statistics of the decoder.
    pub line: SourceStats,
    pub waiting: u64,
    pub accepted: u64,
    pub rejected: [u64; Rejection::COUNT],
    /// Readings dropped while the process was stopped.
    pub dropped: u64,
    pub stalls: u64,
    /// Pauses by commands and by keys.
    pub pauses: u64,
    pub armed: u64,
    pub suppressed: u64,
    /// The number of presses and releases of each key.
    pub keys: BTreeMap<&'static str, (u64, u64)>,
    /// Releases by commands.
    pub forced: u64,
    pub other_events: u64,
    /// Memory that this thread has allocated and not freed, in bytes, after each quarter of the run.
    pub live_bytes: Vec<i64>,
    /// Resident memory in bytes, after each quarter of the run; empty if the system does not report it.
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

    /// Checks that everything is counted exactly once, no key stays pressed, and no memory accumulates.
    pub fn check(&self) {
        let line = &self.line;
        assert_eq!(line.bytes, self.sent_bytes);
        assert_eq!(
            line.bytes,
            66 * line.readings + line.skipped_bytes + self.waiting
        );
        let rejected: u64 = self.rejected.iter().sum();
        assert_eq!(line.readings, self.accepted + rejected + self.dropped);
        // A packet is complete with the marks of the next one, so that a fault costs the packet before it as well.
        let of = |kind| self.faults.get(&kind).copied().unwrap_or(0) as u64;
        let breaks = of(FaultKind::Unplug) + of(FaultKind::Noise) + self.sent - self.whole;
        assert!(line.readings <= self.sent, "{} packets", line.readings);
        let lost = self.sent - line.readings - self.waiting / 66;
        assert!(lost <= 2 * breaks, "{lost} packets lost in {breaks} breaks");
        assert!(self.armed <= 1 + self.stalls + self.pauses);
        for (key, (down, up)) in &self.keys {
            assert_eq!(down, up, "{key}");
        }
        if let [first, .., last] = self.live_bytes[..] {
            let growth = last - first;
            assert!(growth <= 1 << 16, "{:?}", self.live_bytes);
        }
        if let [first, .., last] = self.resident[..] {
            assert!(last <= first + MAX_GROWTH, "{:?}", self.resident);
        }
    }
}

/// Returns the resident memory in bytes, if the system reports it.
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
            "packets sent {}, of them whole {}; bytes {} = 66 × {} packets + {} skipped + {} waiting, {} resyncs",
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
            "readings {} = accepted {} + rejected {rejected} + dropped {}; rejected:",
            line.readings, self.accepted, self.dropped
        )?;
        for (reason, count) in Rejection::ALL.iter().zip(self.rejected) {
            write!(f, " {reason} {count}")?;
        }
        writeln!(
            f,
            "\nstalls {}, pauses {}, armed {} times; presses {} = releases {} of {} keys ({} releases not by a hand), \
             presses suppressed {}, other events {}",
            self.stalls,
            self.pauses,
            self.armed,
            self.presses(),
            self.releases(),
            self.keys.len(),
            self.forced,
            self.suppressed,
            self.other_events
        )?;
        if self.resident.is_empty() {
            write!(
                f,
                "SKIPPED: no /proc/self/statm, so memory was not measured"
            )
        } else {
            let kibibytes = self.resident.iter().map(|bytes| bytes / 1024);
            let kibibytes: Vec<u64> = kibibytes.collect();
            write!(f, "resident after each quarter, in KiB: {kibibytes:?}")
        }
    }
}
