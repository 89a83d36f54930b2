//! The movements that a simulated person does not intend: tremor, and fingers that follow a pressing one.

use std::collections::VecDeque;

use crate::estimate::JointAngles;
use crate::hand::{Dof, Finger};
use crate::kinematics::ArmModel;
use crate::layout::{Motion, Tremor};

/// Turns of the direction of a tremor per second.
const TURNS_HZ: f64 = 0.3;

/// The part of the flexion of each finger that the others follow, thumb first: inside the band of maximal presses of Zatsiorsky,
/// Li & Latash 1998 ?.
pub(super) const SHARES: [[f64; Finger::COUNT]; Finger::COUNT] = [
    [0.0, 0.05, 0.05, 0.05, 0.05],
    [0.05, 0.0, 0.20, 0.10, 0.07],
    [0.05, 0.15, 0.0, 0.30, 0.12],
    [0.05, 0.08, 0.30, 0.0, 0.40],
    [0.05, 0.07, 0.15, 0.45, 0.0],
];

/// Time after which the other fingers follow, in seconds: the middle of 10 to 25 ms ?.
const ENSLAVING_DELAY: f64 = 0.0175;

/// The flexion of the joints of each finger that a press adds, in radians.
type Flexions = [[f64; 3]; Finger::COUNT];

/// The unintended movements of a hand.
#[derive(Clone, Debug)]
pub(super) struct Unsteadiness {
    tremor: Tremor,
    /// Distance from the wrist to a fingertip, in metres.
    lever: f64,
    enslaving: f64,
    /// First phases of the oscillation and of its direction, in radians.
    phases: [f64; 2],
    /// The posture before the press.
    before: JointAngles,
    /// The flexions by presses with their times in seconds, from the last one that the others have followed.
    flexions: VecDeque<(f64, Flexions)>,
}

impl Unsteadiness {
    /// Creates the unsteadiness of a hand; `seed` gives the phases of its tremor.
    pub(super) fn new(motion: &Motion, arm: &ArmModel, seed: u64) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let lever = arm.reach().map_or(0.0, |reach| reach.from_wrist.length());
        Self {
            tremor: motion.tremor,
            lever: f64::from(lever),
            enslaving: motion.enslaving,
            phases: [random.f64(), random.f64()].map(|turns| turns * std::f64::consts::TAU),
            before: JointAngles::default(),
            flexions: VecDeque::new(),
        }
    }

    /// Changes the angles that a hand means to have, `seconds` after its start, to those that it has. `presser` is the finger that
    /// presses, from the way down to the end of the way up.
    pub(super) fn apply(
        &mut self,
        angles: &mut JointAngles,
        presser: Option<Finger>,
        seconds: f64,
    ) {
        if self.enslaving > 0.0 {
            let mut flexions = Flexions::default();
            match presser {
                Some(master) => flexions[master.index()] = self.flexions_of(master, angles),
                None => self.before = *angles,
            }
            self.flexions.push_back((seconds, flexions));
            let followed = self.flexions_at(seconds - ENSLAVING_DELAY);
            self.enslave(&followed, angles);
        }
        if self.tremor.amplitude > 0.0 && self.lever > 0.0 {
            self.tremble(seconds, angles);
        }
    }

    /// Returns the flexion of a finger since the posture before the press.
    fn flexions_of(&self, master: Finger, angles: &JointAngles) -> [f64; 3] {
        Finger::FLEXIONS[master.index()].map(|dof| angles.get(dof) - self.before.get(dof))
    }

    /// Returns the flexions at an earlier time, and discards what is older.
    fn flexions_at(&mut self, seconds: f64) -> Flexions {
        while self.flexions.get(1).is_some_and(|next| next.0 <= seconds) {
            self.flexions.pop_front();
        }
        match (self.flexions.front(), self.flexions.get(1)) {
            (Some((from, first)), Some((to, second))) if *from <= seconds => {
                let fraction = (seconds - from) / (to - from);
                let mut between = *first;
                for (values, ends) in between.iter_mut().zip(second) {
                    for (value, end) in values.iter_mut().zip(ends) {
                        *value += (end - *value) * fraction;
                    }
                }
                between
            }
            // Nothing has happened before the first sample.
            _ => Flexions::default(),
        }
    }

    fn enslave(&self, flexions: &Flexions, moved: &mut JointAngles) {
        for (master, bends) in Finger::ALL.iter().zip(flexions) {
            for &slave in Finger::ALL {
                let share = self.enslaving * SHARES[master.index()][slave.index()];
                let joints = Finger::FLEXIONS[slave.index()].into_iter().zip(bends);
                for (dof, flexion) in joints {
                    moved.set(dof, moved.get(dof) + share * flexion);
                }
            }
        }
    }

    /// Turns the wrist so that the fingertips oscillate with the amplitude of the tremor.
    fn tremble(&self, seconds: f64, moved: &mut JointAngles) {
        let turn = std::f64::consts::TAU * seconds;
        let wave = (turn * self.tremor.frequency_hz + self.phases[0]).sin();
        let direction = turn * TURNS_HZ + self.phases[1];
        let radians = wave * self.tremor.amplitude / self.lever;
        for (dof, part) in [
            (Dof::WristFlexion, direction.cos()),
            (Dof::WristDeviation, direction.sin()),
        ] {
            moved.set(dof, moved.get(dof) + radians * part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbors_follow_a_flexion_after_10_to_25_ms() {
        let mut hand = Unsteadiness {
            tremor: Tremor::default(),
            lever: 0.0,
            enslaving: 1.0,
            phases: [0.0; 2],
            before: JointAngles::default(),
            flexions: VecDeque::new(),
        };
        let mut followed = Vec::new();
        // The index finger bends by one radian within a millisecond, and stays so until 100 ms.
        for millisecond in 0..200 {
            let is_pressing = (50..100).contains(&millisecond);
            let mut angles = JointAngles::default();
            if is_pressing {
                angles.set(Dof::IndexMcpFlexion, 1.0);
            }
            let presser = is_pressing.then_some(Finger::Index);
            let mut moved = angles;
            hand.apply(&mut moved, presser, f64::from(millisecond) * 1e-3);
            assert_eq!(
                moved.get(Dof::IndexMcpFlexion),
                angles.get(Dof::IndexMcpFlexion)
            );
            followed.push(moved.get(Dof::MiddleMcpFlexion));
        }
        let quarter = |from: usize, is_bent: bool| {
            let later = followed.iter().skip(from);
            from + later.take_while(|angle| (**angle > 0.1) != is_bent).count()
        };
        let (bends, straightens) = (quarter(50, true), quarter(100, false));
        assert!((60..=75).contains(&bends), "{bends} ms");
        assert!((110..=125).contains(&straightens), "{straightens} ms");
        assert!(
            (followed[90] - SHARES[1][2]).abs() < 1e-9,
            "{}",
            followed[90]
        );
        assert!(hand.flexions.len() < 30, "{}", hand.flexions.len());
    }
}
