//! Trails: the latest positions of a fingertip.

use std::collections::VecDeque;

use parry3d::math::Vec3;

use ademan_core::time::Timestamp;

/// Age of the end of a trail, in seconds.
pub const SECONDS: f32 = 0.8;

/// The maximum number of positions, for a source that sends very often.
const MAX_POSITIONS: usize = 160;

/// The latest positions of a fingertip, in the world.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    positions: VecDeque<(Timestamp, Vec3)>,
}

impl Trail {
    /// Adds a position. A time before the last one, as at the start of a replay, starts the trail over.
    pub fn push(&mut self, time: Timestamp, position: Vec3) {
        if self.positions.back().is_some_and(|(last, _)| *last > time) {
            self.positions.clear();
        }
        self.positions.push_back((time, position));
        let is_old = |start: Timestamp| time.since(start).as_secs_f32() > SECONDS;
        while let Some((start, _)) = self.positions.front()
            && (is_old(*start) || self.positions.len() > MAX_POSITIONS)
        {
            self.positions.pop_front();
        }
    }

    /// Removes all positions.
    pub fn clear(&mut self) {
        self.positions.clear();
    }

    /// Iterates over the ages in seconds and the positions, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = (f32, Vec3)> + '_ {
        let now = self
            .positions
            .back()
            .map_or(Timestamp(0), |(time, _)| *time);
        let positions = self.positions.iter();
        positions.map(move |(time, position)| (now.since(*time).as_secs_f32(), *position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_ends_after_its_time() {
        let mut trail = Trail::default();
        for step in 0..30 {
            trail.push(Timestamp(step * 100_000), Vec3::X * step as f32);
        }
        let ages: Vec<f32> = trail.iter().map(|(age, _)| age).collect();
        assert!(ages[0] <= SECONDS && ages[0] > SECONDS - 0.2, "{ages:?}");
        assert_eq!(ages.last(), Some(&0.0));
    }

    #[test]
    fn a_replay_that_starts_again_leaves_no_line_across_the_view() {
        let mut trail = Trail::default();
        trail.push(Timestamp(500_000), Vec3::X);
        trail.push(Timestamp(0), Vec3::Y);
        assert_eq!(trail.iter().count(), 1);
    }

    #[test]
    fn a_fast_source_does_not_grow_a_trail() {
        let mut trail = Trail::default();
        for step in 0..10_000 {
            trail.push(Timestamp(step), Vec3::ZERO);
        }
        assert_eq!(trail.iter().count(), MAX_POSITIONS);
    }
}
