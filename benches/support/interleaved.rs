//! Times of several rows that do the same work, from one interleaved run.

use std::time::{Duration, Instant};

/// One pass over the same input, for each row.
pub type Pass<'a> = &'a mut dyn FnMut();

/// Returns the time of one pass of each row: the fastest of all rounds, because other programs on the machine only add to
/// it. Each round runs every row once and starts with another one, so that load affects all rows alike.
pub fn fastest(rounds: usize, passes: &mut [Pass]) -> Vec<Duration> {
    let rows = passes.len();
    let mut times = vec![Duration::MAX; rows];
    for round in 0..rounds {
        for turn in 0..rows {
            let row = (round + turn) % rows;
            let start = Instant::now();
            passes[row]();
            times[row] = times[row].min(start.elapsed());
        }
    }
    times
}

/// Returns `true` if the program was started to measure (`cargo bench`) and not to run once (`cargo test --benches`).
pub fn is_measuring() -> bool {
    std::env::args().any(|argument| argument == "--bench")
}
