//! The words on the screen of Studio.

/// Title of the window.
pub const TITLE: &str = "Ademán Studio";
/// Button that pauses the session.
pub const PAUSE: &str = "Pause";
/// Button that ends a pause.
pub const RESUME: &str = "Resume";
/// Button that moves the boards below the hand.
pub const RECENTER: &str = "Recenter";
/// Button that corrects a glove that has slipped.
pub const ZERO: &str = "Zero";
/// Hint of [`PAUSE`] and [`RESUME`].
pub const PAUSE_HINT: &str = "Release everything and suppress all events, or go on (P)";
/// Hint of [`RECENTER`].
pub const RECENTER_HINT: &str = "Move the boards below the index fingertip (C)";
/// Hint of [`ZERO`].
pub const ZERO_HINT: &str =
    "Rest the hand first: its present angles become those of its rest pose (Z)";
/// Name of the menu of panels and camera positions.
pub const VIEW: &str = "View";
/// Camera position behind the wearer.
pub const FROM_EYE: &str = "From the eye";
/// Camera position above the boards.
pub const FROM_ABOVE: &str = "From above";
/// Camera position at the right of the wearer.
pub const FROM_SIDE: &str = "From the side";
/// Switch of the bones.
pub const BONES: &str = "Bones and joints";
/// Switch between light and dark colours.
pub const DARK: &str = "Dark";
/// Name of the sensors panel.
pub const SENSORS: &str = "Sensors";
/// Name of the scope panel.
pub const SCOPE: &str = "Scope";
/// Headings of the table of sensors.
pub const SENSOR_COLUMNS: [&str; 4] = ["Channel", "Joint", "Count", "Angle"];
/// A channel at the end of its range.
pub const AT_END: &str = "at the end of its range";
/// A channel that has not changed for a while.
pub const UNCHANGED: &str = "unchanged";
/// Shown instead of sensors for a source without channels.
pub const NO_CHANNELS: &str = "This source has no channels: it measures angles or positions.";
/// Shown before the first reading.
pub const NO_READING: &str = "No reading has arrived yet.";
/// Label of the source.
pub const SOURCE: &str = "Source";
/// Label of the outputs.
pub const OUTPUT: &str = "Output";
/// Label of the rate of readings.
pub const RATE: &str = "Readings per second";
/// Label of the readings that gave a pose.
pub const ACCEPTED: &str = "Accepted";
/// Label of the readings that were dropped.
pub const DROPPED: &str = "Dropped";
/// Label of the losses of the device.
pub const LOSSES: &str = "Device lost";
/// Label of the gaps between readings.
pub const STALLS: &str = "Stalls";
/// The session has ended.
pub const ENDED: &str = "The session has ended. Everything is released.";
/// Hint at the lower edge of the 3D view.
pub const CAMERA_HINT: &str = "drag: orbit · right drag: pan · scroll: zoom · 1 2 3: views";
/// Label of the presses in the scope.
pub const PRESSES: &str = "Presses";
/// Label of the height of the lowest fingertip in the scope.
pub const LOWEST_FINGERTIP: &str = "Lowest fingertip over the board";
