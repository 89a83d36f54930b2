//! The schedule of the faults.

use fastrand::Rng;

/// A kind of fault; its details are random.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultKind {
    Stall,
    Unplug,
    Noise,
    FlippedBits,
    TruncatedPacket,
    DuplicatePacket,
    ClockAhead,
    ClockBack,
    ValidLayout,
    InvalidLayout,
    Pause,
    Profile,
    Rail,
    SwappedSides,
    StopProcess,
    MovedBoards,
}

pub const KINDS: [FaultKind; 16] = [
    FaultKind::Stall,
    FaultKind::Unplug,
    FaultKind::Noise,
    FaultKind::FlippedBits,
    FaultKind::TruncatedPacket,
    FaultKind::DuplicatePacket,
    FaultKind::ClockAhead,
    FaultKind::ClockBack,
    FaultKind::ValidLayout,
    FaultKind::InvalidLayout,
    FaultKind::Pause,
    FaultKind::Profile,
    FaultKind::Rail,
    FaultKind::SwappedSides,
    FaultKind::StopProcess,
    FaultKind::MovedBoards,
];

/// Returns the time of each fault in microseconds from the start, the last one first. All kinds are equally frequent, in
/// random order.
pub fn schedule(random: &mut Rng, faults: usize, microseconds: u64) -> Vec<(u64, FaultKind)> {
    let mut kinds: Vec<FaultKind> = (0..faults)
        .map(|index| KINDS[index % KINDS.len()])
        .collect();
    random.shuffle(&mut kinds);
    let mut times: Vec<u64> = (0..faults).map(|_| random.u64(0..microseconds)).collect();
    times.sort_unstable_by(|one, other| other.cmp(one));
    times.into_iter().zip(kinds).collect()
}
