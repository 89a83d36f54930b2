//! The pipeline in one process, without a clock or a device: bytes, readings or touches in, events out.

#[path = "../support/mod.rs"]
mod support;

mod arming;
mod bends;
mod body_angles;
mod body_landmarks;
mod calibration;
mod estimator;
mod examples;
mod faulty_readings;
mod fusion;
mod gestures;
mod hand_sizes;
mod hands_and_profiles;
mod oracle;
mod other_hand;
mod joint_positions;
mod key_words;
mod layout_changes;
mod learning;
mod limits;
mod lucidgloves;
mod network_poses;
mod panels;
mod pauses;
mod persons;
mod placement;
mod press_filters;
mod random_vectors;
mod recorded_landmarks;
mod rig;
mod scenarios;
mod scripts;
mod start;
mod stops;
mod swipes;
mod taps;
mod text;
mod text_taps;
mod tours;
mod tracked_hands;
mod typing;
mod typing_sources;
mod vectors;
mod zeroing;
