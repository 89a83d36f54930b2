//! Postures over time.

use std::collections::VecDeque;

use crate::sim::movement::minimum_jerk;

/// A movement of the joints that is added to the posture: down, a pause, and back.
#[derive(Clone, Debug)]
pub(super) struct Bump {
    /// The change of each variable at the lowest point.
    pub(super) change: Vec<f64>,
    /// The start in seconds.
    pub(super) start: f64,
    /// The duration of the way down, more than 0.
    pub(super) down: f64,
    /// The time at which the way back begins.
    pub(super) release: f64,
    /// The duration of the way back, more than 0.
    pub(super) up: f64,
}

impl Bump {
    fn part_at(&self, seconds: f64) -> f64 {
        let down = progress(seconds, self.start, self.down);
        down * (1.0 - progress(seconds, self.release, self.up))
    }

    fn end(&self) -> f64 {
        self.release + self.up
    }
}

/// A way from one posture to the next.
#[derive(Clone, Debug)]
struct Way {
    goal: Vec<f64>,
    start: f64,
    duration: f64,
}

/// The posture of a hand over time. Its queries have ascending times.
#[derive(Clone, Debug)]
pub(super) struct Timeline {
    from: Vec<f64>,
    /// The ways, one after the other.
    ways: VecDeque<Way>,
    bumps: Vec<Bump>,
}

impl Timeline {
    /// Creates a hand that keeps a posture.
    pub(super) fn new(posture: Vec<f64>) -> Self {
        Self {
            from: posture,
            ways: VecDeque::new(),
            bumps: Vec::new(),
        }
    }

    /// Goes to a posture after the ways so far.
    pub(super) fn go_to(&mut self, goal: Vec<f64>, start: f64, duration: f64) {
        self.ways.push_back(Way {
            goal,
            start,
            duration: duration.max(1e-3),
        });
    }

    /// Returns the posture at the end of the ways.
    pub(super) fn goal(&self) -> &[f64] {
        self.ways.back().map_or(&self.from, |way| &way.goal)
    }

    /// Returns the end of the last way; 0 without one.
    pub(super) fn settled_at(&self) -> f64 {
        let last = self.ways.back();
        last.map_or(0.0, |way| way.start + way.duration)
    }

    pub(super) fn add(&mut self, bump: Bump) {
        self.bumps.push(bump);
    }

    /// Sets `values` to the posture at a time, and forgets what is over then.
    pub(super) fn posture(&mut self, seconds: f64, values: &mut [f64]) {
        while let Some(way) = self.ways.front()
            && way.start + way.duration <= seconds
        {
            self.from.copy_from_slice(&way.goal);
            self.ways.pop_front();
        }
        values.copy_from_slice(&self.from);
        if let Some(way) = self.ways.front() {
            let part = progress(seconds, way.start, way.duration);
            for (value, goal) in values.iter_mut().zip(&way.goal) {
                *value += (goal - *value) * part;
            }
        }
        self.bumps.retain(|bump| bump.end() > seconds);
        for bump in &self.bumps {
            let part = bump.part_at(seconds);
            if part == 0.0 {
                continue;
            }
            for (value, change) in values.iter_mut().zip(&bump.change) {
                *value += change * part;
            }
        }
    }
}

/// Returns the minimum-jerk progress of a movement, 0..=1.
fn progress(seconds: f64, start: f64, duration: f64) -> f64 {
    let t = ((seconds - start) / duration).clamp(0.0, 1.0);
    f64::from(minimum_jerk(t as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stroke_on_the_way_ends_where_the_way_ends() {
        let mut hand = Timeline::new(vec![0.0]);
        hand.add(Bump {
            change: vec![1.0],
            start: 0.0,
            down: 0.1,
            release: 0.1,
            up: 0.1,
        });
        hand.go_to(vec![2.0], 0.1, 0.2);
        let mut at = |seconds| {
            let mut values = [0.0];
            hand.posture(seconds, &mut values);
            values[0]
        };
        assert_eq!(at(0.0), 0.0);
        assert!((at(0.1) - 1.0).abs() < 1e-6);
        assert!((at(0.2) - 1.0).abs() < 1e-6);
        assert!((at(0.3) - 2.0).abs() < 1e-6);
    }
}
