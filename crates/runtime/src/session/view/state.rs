//! The state of a session, as the control socket sends it too.

use serde::{Deserialize, Serialize};

use super::hand::ViewHand;
use crate::capture::HeadsetStatus;
use ademan_core::command::{CommandOrigin, TextMode};
use ademan_core::contact::TargetId;
use ademan_core::device::{Axis, KeyCode};
use ademan_core::hand::{Finger, Side};
use ademan_core::message::escape;
use ademan_core::pipeline::PipelineState;
use ademan_core::snapshot::Stats;
use ademan_core::time::Timestamp;

/// The state of a session. Targets have the index that they have in the layout.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ViewState {
    /// Name of the session; empty in a view of a program that names none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Number of the process of the session; `None` for a recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub process: Option<u32>,
    /// Time of the last reading.
    pub time_us: Timestamp,
    /// State of the pipeline.
    pub state: PipelineState,
    /// Origin of a requested pause.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub paused_by: Option<CommandOrigin>,
    /// Name of the active profile.
    pub profile: String,
    /// Name of the source.
    pub source: String,
    /// The headset that is connected; `None` for a source that waits for none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub headset: Option<HeadsetStatus>,
    /// Names of the outputs, separated by commas.
    pub output: String,
    /// Readings per second over the last second.
    pub readings_per_second: f32,
    /// Readings and losses so far.
    pub counts: ViewCounts,
    /// `true` if the layout waits for an open hand that is held still.
    #[serde(default, skip_serializing_if = "is_false")]
    pub awaits_hand: bool,
    /// Hands that are tracked.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hands: Vec<ViewHand>,
    /// Fingertips near a board.
    pub fingertips: Vec<Fingertip>,
    /// Bends of fingers that press by bending.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bends: Vec<FingerBend>,
    /// Targets that fingers press.
    pub pressed: Vec<TargetId>,
    /// Keys and buttons that are down, the first that was pressed first.
    pub keys: Vec<KeyCode>,
    /// The latest keys and characters that were pressed, oldest first.
    pub recent: Vec<String>,
    /// The end of the text that a field with a US keymap shows, after each Backspace.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub typed: String,
    /// The mode of the text decoder; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text_mode: Option<TextMode>,
    /// The candidates of the text decoder for the word that is typed, the most probable one first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub candidates: Vec<String>,
    /// Values of controls, since each was first moved: 0..=1, or turns.
    pub values: Vec<(TargetId, f32)>,
    /// Axes that are off zero.
    pub axes: Vec<(Axis, f32)>,
    /// Position of the cursor in its range, 0..=1: to the right, up, towards the wearer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pointer: Option<[f32; 3]>,
    /// Position of the cursor in each space, in millimetres.
    pub in_spaces_mm: Vec<Option<[f32; 3]>>,
    /// Selected targets in space.
    pub selected: Vec<TargetId>,
}

/// Counts of readings and of what went wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ViewCounts {
    /// Readings received.
    pub received: u64,
    /// Readings that gave a pose.
    pub accepted: u64,
    /// Readings that gave no joint angles.
    pub rejected: u64,
    /// Readings dropped.
    pub dropped: u64,
    /// Losses of the device.
    pub losses: u64,
    /// Gaps between readings longer than the stall timeout.
    pub stalls: u64,
    /// Events suppressed.
    pub suppressed: u64,
    /// Presses that the output dropped.
    pub dropped_presses: u64,
}

/// A fingertip over a board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fingertip {
    /// The hand.
    pub side: Side,
    /// The finger.
    pub finger: Finger,
    /// Index of the board.
    pub board: usize,
    /// Position in row coordinates: to the right.
    pub x_mm: f32,
    /// Position in row coordinates: away from the wearer.
    pub y_mm: f32,
    /// Distance from the pad of the fingertip to the board; negative while it presses.
    pub height_mm: f32,
}

/// The bend of a finger that presses by bending, as fractions of its range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FingerBend {
    /// The hand.
    pub side: Side,
    /// The finger.
    pub finger: Finger,
    /// Present bend.
    pub bend: f32,
    /// Bend from which it presses.
    pub press_at: f32,
    /// Bend at which it releases.
    pub release_at: f32,
}

impl ViewState {
    /// Returns the state before the first reading.
    pub fn starting(profile: &str, source: &str, output: &str) -> Self {
        Self {
            profile: profile.to_owned(),
            source: source.to_owned(),
            output: output.to_owned(),
            ..Self::default()
        }
    }

    /// Returns the end of [`typed`](Self::typed) for one line of at most `length` characters: with signs for line breaks and tabs, and
    /// `…` in place of what is cut.
    pub fn typed_end(&self, length: usize) -> String {
        let visible = self.typed.replace('\n', "↵").replace('\t', "⇥");
        let escaped = escape(&visible);
        let count = escaped.chars().count();
        if count <= length {
            return escaped.into_owned();
        }
        let cut = escaped.chars().skip(count - length.saturating_sub(1));
        let cut: String = cut.collect();
        match length {
            0 => cut,
            _ => format!("…{cut}"),
        }
    }
}

fn is_false(value: &bool) -> bool {
    !value
}

impl From<&Stats> for ViewCounts {
    fn from(stats: &Stats) -> Self {
        Self {
            received: stats.source.readings,
            accepted: stats.accepted,
            rejected: stats.rejected.iter().sum(),
            dropped: stats.source.dropped,
            losses: stats.source.losses,
            stalls: stats.stalls,
            suppressed: stats.suppressed.total(),
            dropped_presses: stats.dropped_presses,
        }
    }
}
