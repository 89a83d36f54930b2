//! The library's forward kinematics, and the angles of a hand that types.

use ademan::capture::hc11::{BODY_BYTES, channels};
use ademan::capture::{Hc11Format, Reading, Sample};
use ademan::estimate::{Estimate, Estimator, EstimatorSettings};
use ademan::hand::Finger;
use ademan::kinematics::ArmModel;
use ademan::setup::Setup;
use ademan::time::Timestamp;
use parry3d::math::Vec3;

/// The centers of the fingertips, in metres.
pub type Tips = [Vec3; Finger::COUNT];

const READINGS: u64 = 1_024;

/// Returns the arm of the default setup and the angles of a simulated typist.
pub fn recorded_hand() -> (ArmModel, Vec<Estimate>) {
    let setup = Setup::default().load_files().expect("the default setup");
    let text = "the quick brown fox jumps over the lazy dog";
    let mut typist = setup
        .typist(text, &Hc11Format::default(), 0.5, 1)
        .expect("the text is on the board");
    let glove = setup.glove.as_ref().expect("a glove");
    let mut estimator = Estimator::new(EstimatorSettings::default()).with_channels(&glove.map);
    let mut estimate = |number: u64| {
        let counts = typist.next_counts().expect("the text is long enough");
        let body: [u8; BODY_BYTES] = std::array::from_fn(|channel| counts[channel] as u8);
        let sample = Sample::Channels(channels(&body));
        let reading = Reading::new(Timestamp(5_729 * (number + 1)), None, sample);
        *estimator.update(&reading).expect("a plausible reading")
    };
    let estimates = (0..READINGS).map(&mut estimate).collect();
    (setup.arm, estimates)
}

/// The library.
pub struct Ours<'a>(pub &'a ArmModel);

impl Ours<'_> {
    pub fn tips(&self, estimate: &Estimate) -> Tips {
        let pose = self.0.forward(estimate);
        std::array::from_fn(|index| {
            let tip = pose.fingertip(Finger::ALL[index]);
            tip.expect("the arm has all fingers")
        })
    }
}
