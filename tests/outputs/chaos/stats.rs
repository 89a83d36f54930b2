//! The statistics of a run.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use super::attack::Attack;

#[derive(Default)]
pub struct ChaosStats {
    pub length: Duration,
    pub episodes: usize,
    /// Starts of the program.
    pub starts: usize,
    pub presses: usize,
    pub repeats: usize,
    pub releases: usize,
    /// The largest resident memory of the program in kB.
    pub memory: u64,
    /// The largest number of file descriptors of the program.
    pub descriptors: usize,
    /// The number of attacks of each kind, and the longest time until all keys were released after one.
    pub attacks: BTreeMap<Attack, (usize, Option<Duration>)>,
}

impl ChaosStats {
    /// Counts an attack.
    pub fn count(&mut self, attack: Attack) {
        self.attacks.entry(attack).or_default().0 += 1;
    }

    /// Records the time until all keys were released.
    pub fn record_release(&mut self, attack: Attack, time: Duration) {
        let (_, longest) = self.attacks.entry(attack).or_default();
        *longest = (*longest).max(Some(time));
    }
}

impl fmt::Display for ChaosStats {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:.1?}, {} episodes, {} starts of the program; {} presses, {} repeats, {} releases",
            self.length, self.episodes, self.starts, self.presses, self.repeats, self.releases
        )?;
        writeln!(
            f,
            "at most {} kB of memory and {} file descriptors",
            self.memory, self.descriptors
        )?;
        writeln!(f, "attack                 count  longest until release")?;
        for (attack, (count, longest)) in &self.attacks {
            let attack = format!("{attack:?}");
            let longest = longest.map_or_else(String::new, |time| format!("{time:.0?}"));
            writeln!(f, "{attack:22} {count:5}  {longest}")?;
        }
        Ok(())
    }
}
