//! Types as written in a layout file that boards, keys and controls share. Lengths in millimetres, angles in degrees.
//!
//! `layouts/README.md` is the guide to the format. A type with the suffix `Schema` is the written form of the checked type of the same
//! name.

use serde::Deserialize;
use serde::de::{Deserializer, Error};

use super::quantity::{
    Bearing, BoardScale, Offset, Radius, RecenterDelay, RecenterOffset, RecenterSpeed, Size, Tilt,
};
use crate::document::Spanned;

/// The maximum length of a label, in characters.
const MAX_LABEL_LENGTH: usize = 16;

/// The text drawn on a control: 1 to 16 characters without control characters. May be written with escapes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label(pub String);

impl Label {
    /// Returns the text of the label, or `name` if there is none.
    pub fn or_name(label: &Option<Self>, name: Spanned) -> String {
        match label {
            Some(Self(text)) => text.clone(),
            None => name.text.to_owned(),
        }
    }
}

impl<'de> Deserialize<'de> for Label {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let length = text.chars().count();
        if length == 0 || length > MAX_LABEL_LENGTH {
            return Err(D::Error::custom(format!(
                "a label has 1 to {MAX_LABEL_LENGTH} characters, this one has {length}"
            )));
        }
        if text.chars().any(char::is_control) {
            return Err(D::Error::custom("the label contains a control character"));
        }
        Ok(Self(text))
    }
}

/// The pose of a board or volume relative to an anchor, with the scale of what is on it.
#[derive(Debug, Deserialize)]
#[serde(rename = "Pose", deny_unknown_fields)]
pub struct PoseSchema {
    /// The origin of the offsets.
    pub anchor: AnchorSchema,
    /// Direction of `forward_mm` and of the far side, clockwise from straight forward.
    #[serde(default)]
    pub bearing_deg: Bearing,
    /// Offset to the right of the bearing.
    #[serde(default)]
    pub right_mm: Offset,
    /// Offset along the bearing. Default: 0, or the radius of an arc.
    #[serde(default)]
    pub forward_mm: Option<Offset>,
    /// Offset upwards.
    #[serde(default)]
    pub height_mm: Offset,
    /// Elevation of the far side.
    #[serde(default)]
    pub tilt_deg: Tilt,
    /// Scale of the positions and sizes on the board, about (0, 0).
    #[serde(default)]
    pub scale: BoardScale,
    /// The parts that depend on the hand.
    #[serde(default)]
    pub fit: FitSchema,
}

/// The parts of a pose that depend on the hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename = "Fit")]
pub enum FitSchema {
    /// The place follows the reach of the hand, sizes its length. A pose with the anchor `world` does not.
    #[default]
    Hand,
    /// None: the lengths are those of the file.
    Off,
}

/// The point that a board moves with. It follows the position only: the axes stay those of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename = "Anchor", rename_all = "lowercase")]
pub enum AnchorSchema {
    /// The origin of the world.
    World,
    /// The elbow.
    Elbow,
    /// The wrist.
    Wrist,
}

/// Slow motion of a board towards a resting hand.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename = "AutoRecenter", deny_unknown_fields)]
pub struct AutoRecenterSchema {
    /// Speed of the board.
    #[serde(default)]
    pub speed_mm_per_s: RecenterSpeed,
    /// Time that the hand rests before the board moves.
    #[serde(default)]
    pub delay_ms: RecenterDelay,
    /// Maximum offset from the pose in the file.
    #[serde(default)]
    pub max_offset_mm: RecenterOffset,
}

/// The way in which fingers press the keys of a board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename = "Contact")]
pub enum ContactSchema {
    /// A fingertip touches a key.
    #[default]
    Touch,
    /// A finger bends, wherever the hand is: each key is that of a finger.
    Bend,
}

/// The shape of a board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename = "BoardShape", deny_unknown_fields)]
pub enum BoardShapeSchema {
    /// A flat board with straight rows.
    #[default]
    Flat,
    /// A flat board whose rows are arcs around a point on the wearer's side.
    Arc {
        /// Distance from that point to (0, 0).
        radius_mm: Radius,
    },
    /// A cylinder with its axis in front of the board. All keys face the axis.
    Cylinder {
        /// Distance from the axis to (0, 0).
        radius_mm: Radius,
        /// The curved direction.
        #[serde(default)]
        curved: Curved,
    },
}

/// The curved direction of a cylinder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Curved {
    /// Rows are curved: the axis is parallel to the board's Y.
    #[default]
    Rows,
    /// Columns are curved: the axis is parallel to the board's X.
    Columns,
}

/// The outline of a key or control.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename = "Outline")]
pub enum OutlineSchema {
    /// Width along the row, and depth away from the wearer.
    Box(Size, Size),
    /// Diameter.
    Disc(Size),
}

impl Default for OutlineSchema {
    fn default() -> Self {
        Self::Box(Size::default(), Size::default())
    }
}

/// The action of a press.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Action<'a> {
    /// Presses a key or button.
    #[serde(borrow)]
    Key(Spanned<'a>),
    /// Activates a layer.
    Layer(Spanned<'a>),
    /// Types a text.
    Text(Spanned<'a>),
    /// Issues a command to the session, in the words of `ademan ctl`: `nudge 0 0 -10`.
    Command(Spanned<'a>),
    /// Holds the pointer still.
    Clutch,
    /// Slows the pointer down.
    Precision,
    /// No action, for keys that only take part in chords.
    NoOp,
}

impl<'a> Action<'a> {
    /// Returns the name, text or command in the action, if it has one.
    pub fn argument(self) -> Option<Spanned<'a>> {
        match self {
            Self::Key(name) | Self::Layer(name) | Self::Text(name) | Self::Command(name) => {
                Some(name)
            }
            _ => None,
        }
    }
}

/// Duration of a modifier or layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename = "Latch")]
pub enum LatchSchema {
    /// Active while its key is pressed.
    Momentary,
    /// A tap activates it for the next key.
    OneShot,
    /// A tap activates it until the next tap.
    Lock,
}
