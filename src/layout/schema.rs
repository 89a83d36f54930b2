//! A keyboard layout as it stands in its file: lengths in millimetres, angles in degrees.
//!
//! `layouts/README.md` is the guide to the format. Kinds of controls beside keys are further lists
//! of a board, so that files written today stay valid.

use serde::Deserialize;

use super::controls::joystick::Joystick;
use super::controls::knob::Knob;
use super::controls::lever::Lever;
use super::controls::pointer::Pointer;
use super::controls::radio::Radio;
use super::controls::slider::Slider;
use super::controls::space::Space;
use super::controls::toggle::Toggle;
use super::controls::touch_surface::TouchSurface;
use super::controls::trigger::Trigger;
use super::controls::valve::Valve;
use super::ranged::{
    Bearing, ChordTime, Distance, DriftDelay, DriftLimit, DriftSpeed, DwellTime, Growth, HoldTime,
    Pitch, PressShare, Radius, ReleaseShare, Repress, Scale, Size, Tilt, Travel, Turn,
};
use super::text::{Label, Pairs, Spanned};
use crate::hand::Side;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layout<'a> {
    /// What the layout is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// One line for lists.
    #[serde(borrow, default)]
    pub note: Option<Spanned<'a>>,
    /// Groups of controls, each of which is fixed to one place.
    #[serde(borrow, default)]
    pub boards: Vec<Board<'a>>,
    /// What is drawn on keys that do not say it themselves: key by key.
    #[serde(borrow, default)]
    pub labels: Pairs<'a, Label>,
    /// What keys do beside the base layer.
    #[serde(borrow, default)]
    pub layers: Vec<Layer<'a>>,
    /// What keys do together.
    #[serde(borrow, default)]
    pub chords: Vec<Chord<'a>>,
    /// How long after each other they are pressed at most.
    #[serde(default)]
    pub chord_ms: ChordTime,
    /// Postures of the hand that do something.
    #[serde(borrow, default)]
    pub triggers: Vec<Trigger<'a>>,
    /// The arm as a pointer.
    #[serde(borrow, default)]
    pub pointer: Option<Pointer<'a>>,
    /// Targets in space.
    #[serde(borrow, default)]
    pub spaces: Vec<Space<'a>>,
}

/// A group of controls that moves as one.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Board<'a> {
    /// Where it is.
    pub place: Place,
    /// The hand that it is there for; either unless said.
    #[serde(default)]
    pub hand: Option<Side>,
    /// How it is bent.
    #[serde(default)]
    pub form: Form,
    /// How it creeps under a resting hand; not at all unless said.
    #[serde(default)]
    pub drift: Option<Drift>,
    /// From key to key in a row.
    #[serde(default)]
    pub pitch_mm: Pitch,
    /// The outline of keys that do not say their own.
    #[serde(default)]
    pub size_mm: Outline,
    /// How far keys go down that do not say it themselves.
    #[serde(default)]
    pub travel_mm: Travel,
    /// Where in the travel keys press that do not say it themselves.
    #[serde(default)]
    pub press_share: PressShare,
    /// Where in the travel keys let go that do not say it themselves.
    #[serde(default)]
    pub release_share: ReleaseShare,
    /// How soon keys press again that do not say it themselves.
    #[serde(default)]
    pub repress_ms: Repress,
    /// Whether the depth of keys goes out that do not say it themselves.
    #[serde(default)]
    pub analogue: bool,
    /// Keys in lines.
    #[serde(borrow, default)]
    pub rows: Vec<Row<'a>>,
    /// Keys one by one.
    #[serde(borrow, default)]
    pub keys: Vec<Key<'a>>,
    /// Toggle switches.
    #[serde(borrow, default)]
    pub toggles: Vec<Toggle<'a>>,
    /// Radio groups.
    #[serde(borrow, default)]
    pub radios: Vec<Radio<'a>>,
    /// Touch surfaces.
    #[serde(borrow, default)]
    pub touch_surfaces: Vec<TouchSurface<'a>>,
    /// Sliders.
    #[serde(borrow, default)]
    pub sliders: Vec<Slider<'a>>,
    /// Knobs.
    #[serde(borrow, default)]
    pub knobs: Vec<Knob<'a>>,
    /// Levers.
    #[serde(borrow, default)]
    pub levers: Vec<Lever<'a>>,
    /// Valves.
    #[serde(borrow, default)]
    pub valves: Vec<Valve<'a>>,
    /// Joysticks.
    #[serde(borrow, default)]
    pub joysticks: Vec<Joystick<'a>>,
}

impl Board<'_> {
    /// A length on the board as large as the board is made, in metres.
    pub fn metres(&self, millimetres: f64) -> f32 {
        (millimetres * self.place.scale.get() * 1e-3) as f32
    }
}

/// Where a board is: its point (0, 0) seen from the anchor.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// What it is fixed to.
    pub anchor: Anchor,
    /// From straight forward to the right.
    #[serde(default)]
    pub bearing_deg: Bearing,
    /// To the right of the bearing.
    #[serde(default)]
    pub right_mm: Distance,
    /// Along the bearing; what is left out is 0, or the radius of an arc.
    #[serde(default)]
    pub forward_mm: Option<Distance>,
    /// Upwards from the anchor.
    #[serde(default)]
    pub height_mm: Distance,
    /// How much the far side is lifted.
    #[serde(default)]
    pub tilt_deg: Tilt,
    /// How many times as large is what is on the board, about (0, 0).
    #[serde(default)]
    pub scale: Scale,
}

/// How a board creeps under a resting hand.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drift {
    /// How fast.
    #[serde(default)]
    pub speed_mm_s: DriftSpeed,
    /// How long the hand rests before.
    #[serde(default)]
    pub after_ms: DriftDelay,
    /// How far at most.
    #[serde(default)]
    pub limit_mm: DriftLimit,
}

/// What a board is fixed to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Anchor {
    /// The world's origin.
    World,
    /// The elbow's position.
    Elbow,
    /// The wrist's position.
    Wrist,
}

/// How a board is bent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Form {
    /// Not at all.
    #[default]
    Flat,
    /// Its plane is flat, and its rows go round a point on the wearer's side of the board.
    Arc {
        /// From that point to (0, 0).
        radius_mm: Radius,
    },
    /// It is wrapped around an axis in front of it, which all keys face.
    Cylinder {
        /// From the axis to (0, 0).
        radius_mm: Radius,
        /// What is bent.
        #[serde(default)]
        bends: Bends,
    },
}

/// What a cylinder bends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Bends {
    /// The axis runs along the board's Y.
    #[default]
    Rows,
    /// The axis runs along the board's X.
    Columns,
}

/// The outline of a key.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Outline {
    /// Width along the row, and depth away from the wearer.
    Box(Size, Size),
    /// Diameter.
    Disc(Size),
}

impl Default for Outline {
    fn default() -> Self {
        Self::Box(Size::default(), Size::default())
    }
}

/// Keys in a line, from left to right.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row<'a> {
    /// The middle of the first key.
    pub at_mm: (Distance, Distance),
    /// Key codes, with blanks between them.
    #[serde(borrow)]
    pub keys: Spanned<'a>,
    /// From key to key; else as the board says.
    #[serde(default)]
    pub pitch_mm: Option<Pitch>,
    /// The outline of the keys; else as the board says.
    #[serde(default)]
    pub size_mm: Option<Outline>,
}

/// One key.
#[derive(Debug, Deserialize)]
#[serde(try_from = "KeyFields<'a>", bound(deserialize = "'de: 'a"))]
pub struct Key<'a> {
    /// What it does.
    pub does: Does<'a>,
    /// What names it.
    pub word: Spanned<'a>,
    /// All the rest.
    pub fields: KeyFields<'a>,
}

/// What a press does.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Does<'a> {
    /// Holds a key or button down.
    #[serde(borrow)]
    Key(Spanned<'a>),
    /// Switches to a layer.
    Layer(Spanned<'a>),
    /// Writes a text.
    Write(Spanned<'a>),
    /// Puts another layout of the setup in force.
    Profile(Spanned<'a>),
    /// The same with the next one.
    NextProfile,
    /// Lets nothing out until it is pressed again.
    Pause,
    /// Brings the boards to where the hand is.
    Recentre,
    /// Moves the boards to the right, up and towards the wearer, in mm.
    Nudge(Distance, Distance, Distance),
    /// Lifts the far sides of the boards, in degrees.
    Tilt(Tilt),
    /// Makes the boards so many times as large.
    Scale(Growth),
    /// Holds the pointer still.
    Clutch,
    /// Makes the pointer slow.
    Precision,
    /// Nothing but to take part in chords.
    Nothing,
}

impl<'a> Does<'a> {
    /// What is named.
    pub fn word(self) -> Option<Spanned<'a>> {
        match self {
            Self::Key(word) | Self::Layer(word) | Self::Write(word) | Self::Profile(word) => {
                Some(word)
            }
            _ => None,
        }
    }
}

/// The fields of one key; those left out are as the board says.
#[derive(Debug, Deserialize)]
#[serde(rename = "Key", deny_unknown_fields)]
pub struct KeyFields<'a> {
    /// The key code that it sends.
    #[serde(borrow, default)]
    pub code: Option<Spanned<'a>>,
    /// The layer that it switches to.
    #[serde(borrow, default)]
    pub layer: Option<Spanned<'a>>,
    /// What else it does.
    #[serde(borrow, default)]
    pub does: Option<Does<'a>>,
    /// What it is called in layers and messages; else the code or layer.
    #[serde(borrow, default)]
    pub name: Option<Spanned<'a>>,
    /// What is drawn on it.
    #[serde(default)]
    pub label: Option<Label>,
    /// Its middle.
    pub at_mm: (Distance, Distance),
    /// How far it stands out of its board.
    #[serde(default)]
    pub lift_mm: Distance,
    /// How it is turned on its board about x, then y, then z.
    #[serde(default)]
    pub turn_deg: (Turn, Turn, Turn),
    /// Its outline.
    #[serde(default)]
    pub size_mm: Option<Outline>,
    /// How far it goes down.
    #[serde(default)]
    pub travel_mm: Option<Travel>,
    /// Where in the travel it presses.
    #[serde(default)]
    pub press_share: Option<PressShare>,
    /// Where in the travel it lets go.
    #[serde(default)]
    pub release_share: Option<ReleaseShare>,
    /// How soon it presses again.
    #[serde(default)]
    pub repress_ms: Option<Repress>,
    /// Whether its depth goes out.
    #[serde(default)]
    pub analogue: Option<bool>,
    /// How long a modifier or layer stays in force.
    #[serde(default)]
    pub latch: Option<Latch>,
    /// When it sends its code.
    #[serde(default)]
    pub fires: Option<Fires>,
    /// What it does when it is held instead of tapped.
    #[serde(borrow, default)]
    pub hold: Option<Hold<'a>>,
    /// How long it is pressed before it counts as held.
    #[serde(default)]
    pub hold_ms: Option<HoldTime>,
    /// How long a fingertip rests on it until it fires.
    #[serde(default)]
    pub dwell_ms: Option<DwellTime>,
}

impl<'a> TryFrom<KeyFields<'a>> for Key<'a> {
    type Error = &'static str;

    fn try_from(fields: KeyFields<'a>) -> Result<Self, Self::Error> {
        let does = match (fields.code, fields.layer, fields.does) {
            (Some(code), None, None) => Does::Key(code),
            (None, Some(layer), None) => Does::Layer(layer),
            (None, None, Some(does)) => does,
            (None, None, None) => return Err("the key has neither a `code` nor a `layer`"),
            (Some(_), Some(_), _) => return Err("the key has both a `code` and a `layer`"),
            (_, _, Some(_)) => return Err("the key has a `does` beside its `code` or `layer`"),
        };
        let Some(word) = fields.name.or(does.word()) else {
            return Err("a key that does this needs a `name`");
        };
        Ok(Self { does, word, fields })
    }
}

/// How long a modifier or layer stays in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Latch {
    /// As long as its key is pressed.
    Held,
    /// For the next key.
    OneShot,
    /// Until the next tap.
    Lock,
}

/// When a key sends its code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Fires {
    /// When it is pressed.
    Press,
    /// When it is let go of.
    Release,
}

/// What a key does when it is held.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "HoldFields<'a>", bound(deserialize = "'de: 'a"))]
pub struct Hold<'a>(pub Does<'a>);

/// A hold as it is written.
#[derive(Debug, Deserialize)]
#[serde(rename = "Hold", deny_unknown_fields)]
struct HoldFields<'a> {
    #[serde(borrow, default)]
    code: Option<Spanned<'a>>,
    #[serde(borrow, default)]
    layer: Option<Spanned<'a>>,
}

impl<'a> TryFrom<HoldFields<'a>> for Hold<'a> {
    type Error = &'static str;

    fn try_from(fields: HoldFields<'a>) -> Result<Self, Self::Error> {
        match (fields.code, fields.layer) {
            (Some(code), None) => Ok(Self(Does::Key(code))),
            (None, Some(layer)) => Ok(Self(Does::Layer(layer))),
            (None, None) => Err("the hold has neither a `code` nor a `layer`"),
            (Some(_), Some(_)) => Err("the hold has both a `code` and a `layer`"),
        }
    }
}

/// What keys do while the layer is in force.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layer<'a> {
    /// What keys that switch to it call it.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// Name of a key → the key code that it sends in this layer.
    #[serde(borrow)]
    pub keys: Pairs<'a, Spanned<'a>>,
}

/// What several keys do together.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chord<'a> {
    /// Their names, with blanks between them.
    #[serde(borrow)]
    pub keys: Spanned<'a>,
    /// What they do.
    #[serde(borrow)]
    pub does: Does<'a>,
    /// How long a modifier or layer stays in force.
    #[serde(default)]
    pub latch: Option<Latch>,
}
