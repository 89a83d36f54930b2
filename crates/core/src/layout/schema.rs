//! Types as written in a layout file that boards, keys and controls share. Lengths in millimetres, angles in degrees.
//!
//! `layouts/README.md` is the guide to the format; the doc comment of a field is its row in the tables of the guide. A type with the
//! suffix `Schema` is the written form of the checked type of the same name.

use serde::de::{Deserializer, Error};
use serde::{Deserialize, Serialize};

use super::quantity::{
    Bearing, BoardScale, Offset, Radius, RecenterDelay, RecenterOffset, RecenterSpeed, Size, Tilt,
};
use crate::command::TextMode;
use crate::document::{FieldType, Shape, Spanned, schema};

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

impl FieldType for Label {
    fn shape() -> Shape {
        Shape::Text {
            min_length: 1,
            max_length: Some(MAX_LABEL_LENGTH),
        }
    }
}

impl<'de> Deserialize<'de> for Label {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        if text.contains('\n') {
            let message = "the label has a line break: is its closing quote missing?";
            return Err(D::Error::custom(message));
        }
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

schema! {
    /// The pose of the point (0, 0) of a board, or of the center of a box or rectangle, relative to an anchor.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Pose", deny_unknown_fields)]
    pub struct PoseSchema {
        /// Origin of the offsets. The board moves with the position of the joint; its axes stay the axes of the world.
        pub anchor: AnchorSchema,
        /// Direction in which the board lies: 0 is straight forward, 90 is to the right.
        #[serde(default)]
        pub bearing_deg: Bearing,
        /// Offset to the right of the bearing.
        #[serde(default)]
        pub right_mm: Offset,
        /// Offset along the bearing. Default: 0, or the radius of an arc.
        #[serde(default)]
        pub forward_mm: Option<Offset>,
        /// Offset upwards; negative is below the anchor.
        #[serde(default)]
        pub height_mm: Offset,
        /// Elevation of the far side; at 90 the board is upright and faces you.
        #[serde(default)]
        pub tilt_deg: Tilt,
        /// Scale of positions, pitches, sizes and lifts on the board, about (0, 0). Travels and radii are not scaled.
        #[serde(default)]
        pub scale: BoardScale,
        /// The parts that depend on the hand of the setup.
        #[serde(default)]
        pub fit: FitSchema,
    }
}

schema! {
    /// The parts of a pose that depend on the hand.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    #[serde(rename = "Fit")]
    pub enum FitSchema {
        /// The pose fits the hand.
        #[default]
        Hand,
        /// All lengths stay as the file states them.
        Off,
    }
}

schema! {
    /// The way in which fingers press the keys of a board.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    #[serde(rename = "Contact")]
    pub enum ContactSchema {
        /// A fingertip touches a key.
        #[default]
        Touch,
        /// A finger bends, wherever the hand is: each key belongs to a finger.
        Bend,
    }
}

schema! {
    /// The moment and the place at which a fingertip presses the keys of a board. With `contact: Bend` it has no effect.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    #[serde(rename = "Press")]
    pub enum PressSchema {
        /// A fingertip presses the key whose plane it passes, at `press_at`.
        #[default]
        Plane,
        /// As `Plane`, but a thumb presses the key at which it turns, as with `Stroke`.
        ThumbStroke,
        /// A fingertip presses the key below the middle of its way from the plane to its lowest point. Fingers that follow a pressing
        /// one or sink slowly press nothing, and the keys at the edge reach by a whole key.
        Stroke,
    }
}

schema! {
    /// The owner of the gaps between the keys of a board.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    #[serde(rename = "Gaps")]
    pub enum GapsSchema {
        /// A gap belongs to the nearest key, and half a key beyond the edge of the board to the key at the edge. There it is 1 mm
        /// if the same hand has another board.
        #[default]
        Nearest,
        /// A fingertip in a gap presses nothing.
        Dead,
    }
}

schema! {
    /// The changes of the text decoder, in files of layouts and setups.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename = "TextMode")]
    pub enum TextModeSchema {
        /// Nothing; the mode can be changed while the session runs.
        Literal,
        /// The candidate that is chosen, nothing else.
        Suggest,
        /// The candidate that is chosen, and words at their end.
        Auto,
    }
}

impl From<TextModeSchema> for TextMode {
    fn from(mode: TextModeSchema) -> Self {
        match mode {
            TextModeSchema::Literal => Self::Literal,
            TextModeSchema::Suggest => Self::Suggest,
            TextModeSchema::Auto => Self::Auto,
        }
    }
}

impl From<TextMode> for TextModeSchema {
    fn from(mode: TextMode) -> Self {
        match mode {
            TextMode::Literal => Self::Literal,
            TextMode::Suggest => Self::Suggest,
            TextMode::Auto => Self::Auto,
        }
    }
}

schema! {
    /// The point that a board moves with. It follows the position only: its axes stay aligned with the world.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
    #[serde(rename = "Anchor", rename_all = "lowercase")]
    pub enum AnchorSchema {
        /// The board does not move.
        World,
        /// The elbow.
        Elbow,
        /// The wrist.
        Wrist,
        /// The index fingertip of your open hand, held still for a second at the start. From then on it does not move.
        Start,
        /// The wrist of your other hand, for a source that measures both hands in one room, such as a camera or a headset. Without
        /// that hand nothing is touched.
        Other,
        /// The shoulder of the hand, for a source that measures it: body landmarks, a BVH file, or markers. While it is not seen
        /// nothing is touched.
        Shoulder,
        /// The head, between the ears, for body landmarks. While it is not seen nothing is touched.
        Head,
        /// The hip on the side of the hand, for body landmarks. While it is not seen nothing is touched.
        Hip,
    }
}

schema! {
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
        /// Maximum offset from the pose in the file, or of the last command.
        #[serde(default)]
        pub max_offset_mm: RecenterOffset,
    }
}

schema! {
    /// The shape of a board.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
    #[serde(rename = "BoardShape", deny_unknown_fields)]
    pub enum BoardShapeSchema {
        /// A flat board with straight rows.
        #[default]
        Flat,
        /// A flat board whose rows are arcs around a point on your side.
        Arc {
            /// Distance from the center of the arcs to (0, 0).
            radius_mm: Radius,
        },
        /// A cylinder with its axis in front of the board; every key faces the axis.
        Cylinder {
            /// Distance from the axis to (0, 0).
            radius_mm: Radius,
            /// The curved direction.
            #[serde(default)]
            curved: Curved,
        },
    }
}

schema! {
    /// The curved direction of a cylinder.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    pub enum Curved {
        /// The axis is parallel to the board's y, and the ends of the rows rise.
        #[default]
        Rows,
        /// The axis is parallel to the board's x, and the near and far rows rise.
        Columns,
    }
}

schema! {
    /// The outline of a key or control.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    #[serde(rename = "Outline")]
    pub enum OutlineSchema {
        /// Width along the row, and depth away from you.
        Box(Size, Size),
        /// Diameter.
        Disc(Size),
    }
}

impl Default for OutlineSchema {
    fn default() -> Self {
        Self::Box(Size::default(), Size::default())
    }
}

schema! {
    /// The action of a press.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    pub enum Action<'a> {
        /// Presses a key, or a button of a mouse or gamepad: `Key("MouseLeft")`, `Key("PadSouth")`.
        #[serde(borrow)]
        Key(Spanned<'a>),
        /// Activates a layer.
        Layer(Spanned<'a>),
        /// Types a text of 1 to 32 characters, whatever the receiver's keymap is.
        Text(Spanned<'a>),
        /// Types the first of 2 to 12 keys or characters; another tap within `multitap_timeout_ms` replaces it by the next one:
        /// `Multitap("A B C 2")`.
        Multitap(Spanned<'a>),
        /// Starts one of the `sequences` of the layout: keys, texts and waits.
        Sequence(Spanned<'a>),
        /// Issues a command to the session, in the words of `ademan ctl`: `Command("nudge 0 0 -10")`.
        Command(Spanned<'a>),
        /// Holds the pointer still.
        Clutch,
        /// Slows the pointer down.
        Precision,
        /// No action, for keys that only take part in chords.
        NoOp,
    }
}

impl<'a> Action<'a> {
    /// Returns the name, text or command in the action, if it has one.
    pub fn argument(self) -> Option<Spanned<'a>> {
        match self {
            Self::Key(name)
            | Self::Layer(name)
            | Self::Text(name)
            | Self::Multitap(name)
            | Self::Sequence(name)
            | Self::Command(name) => Some(name),
            _ => None,
        }
    }
}

schema! {
    /// Duration of a modifier or layer.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
    #[serde(rename = "Latch")]
    pub enum LatchSchema {
        /// While the key is pressed.
        Momentary,
        /// A tap activates it for the next key.
        OneShot,
        /// A tap activates it until the next tap.
        Lock,
    }
}
