//! What goes wrong, and when.

use fastrand::Rng;

/// A fault of a kind; what it does in particular is up to chance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultKind {
    Stall,
    Unplug,
    Noise,
    FlippedBits,
    CutFrame,
    FrameTwice,
    ClockAhead,
    ClockBack,
    GoodLayout,
    BadLayout,
    Pause,
    Profile,
    Rail,
    SwappedSides,
    StandStill,
    MovedBoards,
}

pub const KINDS: [FaultKind; 16] = [
    FaultKind::Stall,
    FaultKind::Unplug,
    FaultKind::Noise,
    FaultKind::FlippedBits,
    FaultKind::CutFrame,
    FaultKind::FrameTwice,
    FaultKind::ClockAhead,
    FaultKind::ClockBack,
    FaultKind::GoodLayout,
    FaultKind::BadLayout,
    FaultKind::Pause,
    FaultKind::Profile,
    FaultKind::Rail,
    FaultKind::SwappedSides,
    FaultKind::StandStill,
    FaultKind::MovedBoards,
];

/// When each fault comes, in microseconds from the start, the last one first. Each kind comes as often as the
/// others, in any order.
pub fn schedule(random: &mut Rng, faults: usize, microseconds: u64) -> Vec<(u64, FaultKind)> {
    let mut kinds: Vec<FaultKind> = (0..faults)
        .map(|place| KINDS[place % KINDS.len()])
        .collect();
    random.shuffle(&mut kinds);
    let mut times: Vec<u64> = (0..faults).map(|_| random.u64(0..microseconds)).collect();
    times.sort_unstable_by(|one, other| other.cmp(one));
    times.into_iter().zip(kinds).collect()
}
