//! The last seconds of a session, for time plots.

use std::collections::VecDeque;

use crate::hand::Dof;
use crate::time::Timestamp;

/// Seconds that are kept.
pub const SECONDS: f32 = 30.0;

/// The angles that are kept.
pub const SHOWN_ANGLES: [Dof; 4] = [
    Dof::ElbowFlexion,
    Dof::WristFlexion,
    Dof::IndexMcpFlexion,
    Dof::IndexPipFlexion,
];

/// The most moments that are kept: 30 s at 400 readings per second.
const MAX_MOMENTS: usize = 12_000;

/// The plotted values of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time of the reading.
    pub time: Timestamp,
    /// The [`SHOWN_ANGLES`], in degrees.
    pub angles: [f32; SHOWN_ANGLES.len()],
    /// Height of the lowest fingertip over the first board, in millimetres.
    pub height_mm: Option<f32>,
    /// A target is pressed.
    pub is_pressed: bool,
}

/// The moments of the last [`SECONDS`], oldest first.
#[derive(Clone, Debug, Default)]
pub struct History {
    moments: VecDeque<Moment>,
}

impl History {
    /// Adds a moment and drops those that are too old. A clock that went back starts anew.
    pub fn push(&mut self, moment: Moment) {
        if self
            .moments
            .back()
            .is_some_and(|last| moment.time < last.time)
        {
            self.moments.clear();
        }
        while let Some(first) = self.moments.front()
            && (self.moments.len() == MAX_MOMENTS
                || moment.time.since(first.time).as_secs_f32() > SECONDS)
        {
            self.moments.pop_front();
        }
        self.moments.push_back(moment);
    }

    /// Iterates over the age in seconds and the moment, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = (f32, &Moment)> {
        let last = self.moments.back().map(|last| last.time);
        let age =
            move |moment: &Moment| last.map_or(0.0, |last| last.since(moment.time).as_secs_f32());
        self.moments.iter().map(move |moment| (age(moment), moment))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(seconds: u64) -> Moment {
        Moment {
            time: Timestamp(seconds * 1_000_000),
            angles: Default::default(),
            height_mm: None,
            is_pressed: false,
        }
    }

    #[test]
    fn moments_of_the_last_thirty_seconds_are_kept() {
        let mut history = History::default();
        (0..100).for_each(|second| history.push(moment(second)));
        let ages: Vec<f32> = history.iter().map(|(age, _)| age).collect();
        assert_eq!((ages.len(), ages[0], ages[30]), (31, 30.0, 0.0));
    }

    #[test]
    fn a_clock_that_goes_back_starts_anew() {
        let mut history = History::default();
        history.push(moment(50));
        history.push(moment(1));
        assert_eq!(history.iter().count(), 1);
    }
}
