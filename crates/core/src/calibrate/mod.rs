//! Calibration: from readings of known poses to the values of a glove file.
//!
//! ```text
//!  Procedure ──Reading──▶ PoseCapture ──PoseObservation──▶ Observations ──fit──▶ CalibrationResult ──write──▶ glove file
//! ```
//!
//! A [`Procedure`] leads through the [`CalibrationPose`]s that a glove needs. Each is captured once the hand is still, which the
//! [`PoseCapture`] reads from the data. [`fit`] turns the [`Observations`] into gains and offsets, names the sensors with a
//! fault, and rates the result. [`observe_recording`] finds the same observations in a recording. [`discover`] finds the joints of
//! the channels of a glove without a file, and [`finger_sensors`] the fingers of sensors whose plugs may be exchanged.
//!
//! A [`SensorRecording`] of repeated poses gives jitter, hysteresis, repeatability and drift of each sensor.
//!
//! Sources that measure [`positions`] need lengths, a table and a place for the board instead of gains.
//!
//! Everything here is free of clocks, files and terminals: the same readings give the same result.

mod capture;
mod discovery;
mod error;
mod fingers;
mod fit;
mod observation;
mod pose;
pub mod positions;
mod problem;
mod procedure;
mod recorded;
mod sensors;

pub use capture::{CaptureState, LiveChannel, PoseCapture};
pub use discovery::{DISCOVERY_POSES, Discovery, discover};
pub use error::{CalibrationError, other_glove_advice};
pub use fingers::{FingerSensor, at_their_fingers, finger_sensors};
pub use fit::{CalibrationResult, fit};
pub use observation::{ChannelObservation, Observations, PoseObservation, rest_pose};
pub use pose::{CalibrationPose, ExpectedAngle};
pub use problem::{Problem, Severity, problem_messages};
pub use procedure::{Procedure, ProcedureState};
pub use recorded::{MARKS_KIND, PoseMark, marks_from_text, marks_to_text, observe_recording};
pub use sensors::{Drift, HoldCounts, MIN_CYCLES, SensorParameters, SensorRecording};
