//! Lengths of hand and forearm that were measured with a ruler. They belong in the setup file, as each glove fits several hands.

use ademan::calibrate::positions::HandLengths;
use ademan::kinematics::BoneLengths;

use crate::failure::Failure;
use crate::setup_args::number_in;

/// The lengths on the command line.
#[derive(Clone, Copy, Default, clap::Args)]
pub struct LengthArgs {
    /// Hand length in mm, from the wrist crease to the tip of the middle finger: prints the line for the setup file
    #[arg(long, value_name = "MM", value_parser = hand_mm, conflicts_with = "discover")]
    hand_length: Option<f64>,
    /// Forearm length in mm, from the elbow to the wrist crease
    #[arg(long, value_name = "MM", value_parser = forearm_mm, conflicts_with = "discover")]
    forearm_length: Option<f64>,
}

impl LengthArgs {
    /// Returns the arm for the setup file, or `None` without lengths.
    ///
    /// # Errors
    /// Fails if one length is missing, or if no person has both.
    pub fn both(self) -> Result<Option<String>, Failure> {
        match (self.hand_length, self.forearm_length) {
            (None, None) => Ok(None),
            (Some(hand), Some(forearm)) => {
                let (hand, forearm) = (hand * 1e-3, forearm * 1e-3);
                let bones = BoneLengths::from_hand_and_forearm(hand, forearm);
                bones.map_err(|reason| {
                    Failure::wrong_use(format!("--hand-length and --forearm-length: {reason}"))
                })?;
                Ok(Some(arm_text(hand, forearm)))
            }
            _ => Err(Failure::wrong_use(
                "a glove measures no lengths: give both --hand-length and --forearm-length, or none",
            )),
        }
    }

    /// Returns these lengths, and measured ones for those that were not typed.
    pub fn or(self, measured: HandLengths) -> HandLengths {
        let metres = |millimetres: f64| millimetres * 1e-3;
        HandLengths {
            hand: self.hand_length.map(metres).or(measured.hand),
            forearm: self.forearm_length.map(metres).or(measured.forearm),
        }
    }
}

/// Returns the arm of a setup file with these lengths in metres.
pub fn arm_text(hand: f64, forearm: f64) -> String {
    let millimetres = |metres: f64| (metres * 1e3).round();
    format!(
        "Measured(hand_length_mm: {}, forearm_length_mm: {})",
        millimetres(hand),
        millimetres(forearm)
    )
}

fn hand_mm(text: &str) -> Result<f64, String> {
    number_in(text, 100.0, 300.0, "mm")
}

fn forearm_mm(text: &str) -> Result<f64, String> {
    number_in(text, 100.0, 500.0, "mm")
}
