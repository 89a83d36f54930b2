//! The movements that a simulated person does not intend: tremor, and fingers that follow a pressing one.

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
        }
    }

    /// Returns the angles of a hand that means to have `angles`, `seconds` after its start. `presser` is the finger that presses,
    /// from the way down to the end of the way up.
    pub(super) fn apply(
        &mut self,
        angles: JointAngles,
        presser: Option<Finger>,
        seconds: f64,
    ) -> JointAngles {
        let mut moved = angles;
        if self.enslaving > 0.0 {
            match presser {
                Some(master) => self.enslave(master, &angles, &mut moved),
                None => self.before = angles,
            }
        }
        if self.tremor.amplitude > 0.0 && self.lever > 0.0 {
            self.tremble(seconds, &mut moved);
        }
        moved
    }

    fn enslave(&self, master: Finger, angles: &JointAngles, moved: &mut JointAngles) {
        for &slave in Finger::ALL {
            let share = self.enslaving * SHARES[master.index()][slave.index()];
            let joints = Finger::FLEXIONS[master.index()]
                .into_iter()
                .zip(Finger::FLEXIONS[slave.index()]);
            for (of_master, of_slave) in joints {
                let flexion = angles.get(of_master) - self.before.get(of_master);
                moved.set(of_slave, moved.get(of_slave) + share * flexion);
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
