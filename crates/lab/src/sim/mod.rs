//! Simulated people for demos, tests and the scoring of layouts.
//!
//! A text ([`actions_for_text`]) or a [`Script`] becomes a list of [`HandAction`]s, which a [`SimulatedTypist`] performs on
//! the targets of a layout. The intention (which finger goes where, when, and with what error) and the unsteadiness of a
//! [`Person`](crate::layout::Person) give joint angles and positions; its [`Sensor`]s measure nothing else of the hands. A
//! [`SimulatedWearer`] is a person in a glove that is not calibrated yet.

mod action;
mod action_error;
mod assignment;
mod body;
mod disturbance;
mod effector;
mod glove_sensor;
mod motor;
mod tremor;
mod unsteadiness;
pub mod fluent;
pub mod script;
mod text_plan;
mod reach;
mod reach_target;
mod room;
mod typing_hand;
mod pointer_hand;
mod movement;
mod noise;
mod planner;
mod pointing_posture;
mod sensor;
mod task;
mod tour;
mod layout_feed;
mod follower;
mod settings;
mod simulated_hand;
mod sensed_hand;
mod live;
mod typist;
mod text_field;
mod score;
mod wearer;

pub use action::{HandAction, TargetPoint};
pub use action_error::{ActionError, ActionErrorKind};
pub use layout_feed::{LayoutChange, LayoutFeed};
pub use motor::TypingKeys;
pub(crate) use movement::minimum_jerk;
pub use pointer_hand::{Pointed, PointerHand};
pub use reach::{Miss, pressing_fingers};
pub use score::{
    EditCounts, TypingScore, error_rate, kept_characters, word_errors, words_per_minute,
};
pub use script::Script;
pub use sensor::{JointSensor, Sensor};
pub use settings::TypistSettings;
pub use simulated_hand::GloveCounts;
pub use task::HandTask;
pub use text_field::UsTextField;
pub use text_plan::{PlanError, actions_for_text, backspace_of, taps_for_text};
pub use tour::{TourStop, aimed_tour, tour, tour_text};
pub use tremor::Tremor;
pub use typing_hand::{REACH_TOLERANCE, TypingHand};
pub use typist::{SimulatedTypist, TypistError};
pub use wearer::{GloveFault, GloveSensors, HomeMadeGlove, SensorErrors, SimulatedWearer};
