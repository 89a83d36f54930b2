//! The fields of parts: their types and ranges for forms, and their values in the text.

use super::draft::Draft;
use super::error::EditError;
use super::part::{ControlKind, Part};
use super::rename::rename;
use super::rows::take_out;
use crate::document::{quoted_content, read_tree};
use crate::layout::quantity as q;

/// A field that a part can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSpec {
    /// Name, as [`Edit::SetField`](super::Edit::SetField) expects it. Its end is the unit: `_mm`, `_deg`, `_ms`.
    pub name: &'static str,
    /// Type of its value.
    pub field_type: FieldType,
}

/// The type of the value of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldType {
    /// A number.
    Number {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
        /// Value if the field is not written; `None` if that depends on other fields.
        default: Option<f64>,
    },
    /// `true` or `false`; the default is `false`.
    Bool,
    /// A text in quotes.
    Text,
    /// One of these words, as they are written. The first is the default, unless the field is required.
    Choice(&'static [&'static str]),
    /// Numbers in parentheses.
    Point {
        /// Number of coordinates.
        count: usize,
    },
    /// `Box(width, depth)` or `Disc(diameter)`.
    Outline,
    /// An action, which [`Edit::Bind`](super::Edit::Bind) sets in a [`Slot::Field`](super::Slot::Field).
    Action,
    /// An output of a value: `Axis("LeftX")`, `ScrollY(24)`, `Taps(…)`.
    Output,
    /// Any other RON text.
    Ron,
}

/// Returns a field with a number: its name, its type, and its default if it has one.
macro_rules! number {
    ($name:literal, $quantity:ident) => {
        number!($name, $quantity, None)
    };
    ($name:literal, $quantity:ident, default) => {
        number!($name, $quantity, Some(q::$quantity::default().get()))
    };
    ($name:literal, $quantity:ident, $default:expr) => {
        FieldSpec {
            name: $name,
            field_type: FieldType::Number {
                min: *q::$quantity::RANGE.start(),
                max: *q::$quantity::RANGE.end(),
                default: $default,
            },
        }
    };
}

const fn field(name: &'static str, field_type: FieldType) -> FieldSpec {
    FieldSpec { name, field_type }
}

const FINGERS: &[&str] = &[
    "\"thumb\"",
    "\"index\"",
    "\"middle\"",
    "\"ring\"",
    "\"little\"",
];
const SIDES: &[&str] = &["\"left\"", "\"right\""];
const LATCHES: &[&str] = &["Momentary", "OneShot", "Lock"];

/// Returns the fields that a part can have, those with its name and position first.
pub fn fields_of(part: Part) -> Vec<FieldSpec> {
    use FieldType::{Action, Choice, Outline, Output, Point, Ron, Text};
    let at = field("at_mm", Point { count: 2 });
    let of_part: Vec<FieldSpec> = match part {
        Part::Layout => {
            return vec![
                field("name", Text),
                field("description", Text),
                number!("chord_timeout_ms", ChordTimeout, default),
            ];
        }
        Part::Board(_) => return board_fields(),
        Part::Row { .. } => {
            return vec![
                at,
                field("keys", Text),
                number!("pitch_mm", Pitch),
                field("size_mm", Outline),
            ];
        }
        Part::RowKey { .. } => key_fields(),
        Part::RadioOption { .. } => vec![
            at,
            field("size_mm", Outline),
            field("hold", Action),
            field("tap", Action),
        ],
        Part::Trigger(_) => {
            return vec![
                field("name", Text),
                field("hand", Choice(SIDES)),
                field("held", Ron),
                field("when", Ron),
                field("action", Action),
                field("output", Output),
            ];
        }
        Part::Pointer => return pointer_fields(),
        Part::Space(_) => return pose_fields(),
        Part::SpaceTarget { .. } => {
            return vec![
                field("name", Text),
                field("at_mm", Point { count: 3 }),
                field("shape", Ron),
                field("action", Action),
            ];
        }
        Part::Layer(_) => {
            return vec![
                field("name", Text),
                field("keys", Ron),
                field("chords", Ron),
            ];
        }
        Part::Chord(_) => {
            return vec![
                field("keys", Text),
                field("action", Action),
                field("latch", Choice(LATCHES)),
                field("activate_on", Choice(&["Press", "Release"])),
                field("hold", Ron),
                number!("hold_after_ms", HoldAfter, default),
            ];
        }
        Part::Control { kind, .. } => return control_fields(kind),
    };
    named(of_part)
}

/// Returns fields with the name and the label of a control before them.
fn named(fields: Vec<FieldSpec>) -> Vec<FieldSpec> {
    let named = [
        field("name", FieldType::Text),
        field("label", FieldType::Text),
    ];
    named.into_iter().chain(fields).collect()
}

fn control_fields(kind: ControlKind) -> Vec<FieldSpec> {
    use FieldType::{Action, Bool, Choice, Outline, Output, Point, Ron, Text};
    let at = field("at_mm", Point { count: 2 });
    let output = field("output", Output);
    let steps = number!("steps", Steps);
    let initial = number!("initial", Fraction, Some(0.0));
    named(match kind {
        ControlKind::Key => key_fields(),
        ControlKind::Toggle => vec![
            at,
            field("size_mm", Outline),
            field("hold", Action),
            field("tap", Action),
        ],
        ControlKind::Radio => {
            return vec![
                field("name", Text),
                field("options", Ron),
                field("initial", Text),
            ];
        }
        ControlKind::TouchSurface => vec![
            at,
            field("size_mm", Outline),
            field("mode", Choice(&["Touchscreen", "Touchpad"])),
            number!("px_per_mm", PixelsPerMm, default),
            number!("acceleration", Acceleration, default),
            number!("mm_per_detent", MmPerDetent, default),
            field("natural_scrolling", Bool),
        ],
        ControlKind::Slider => vec![
            at,
            number!("length_mm", Size, None),
            number!("width_mm", Size, default),
            number!("rotation_deg", Rotation, default),
            field("grab", Choice(&["Absolute", "Relative"])),
            steps,
            initial,
            output,
        ],
        ControlKind::Lever => vec![
            at,
            number!("length_mm", Size, None),
            number!("width_mm", Size, default),
            number!("rotation_deg", Rotation, default),
            number!("throw_deg", Throw, default),
            number!("detents", Steps),
            number!("rest", Fraction, Some(0.5)),
            field("springs_back", Bool),
            output,
        ],
        ControlKind::Knob => vec![
            at,
            number!("diameter_mm", Size, None),
            number!("range_deg", KnobRange, default),
            field("endless", Bool),
            steps,
            initial,
            output,
        ],
        ControlKind::Valve => vec![
            at,
            number!("diameter_mm", Size, None),
            number!("turns", Turns, default),
            steps,
            initial,
            output,
        ],
        ControlKind::Joystick => vec![
            at,
            number!("diameter_mm", Size, None),
            number!("travel_mm", Travel),
            number!("max_deflection_mm", MaxDeflection, default),
            number!("dead_zone", StickDeadZone, default),
            number!("exponent", StickExponent, default),
            field("axes", Ron),
            field("direction_keys", Ron),
            field("push_action", Action),
            number!("pointer_px_per_s", StickSpeed),
        ],
    })
}

fn key_fields() -> Vec<FieldSpec> {
    use FieldType::{Action, Bool, Choice, Outline, Output, Point, Ron, Text};
    vec![
        field("at_mm", Point { count: 2 }),
        field("code", Text),
        field("layer", Text),
        field("action", Action),
        number!("lift_mm", Offset, default),
        field("rotation_deg", Point { count: 3 }),
        field("finger", Choice(FINGERS)),
        field("size_mm", Outline),
        number!("travel_mm", Travel),
        number!("press_at", PressAt),
        number!("release_at", ReleaseAt),
        number!("debounce_ms", Debounce),
        field("reports_depth", Bool),
        field("output", Output),
        field("latch", Choice(LATCHES)),
        field("activate_on", Choice(&["Press", "Release"])),
        field("hold", Ron),
        number!("hold_after_ms", HoldAfter, default),
        number!("dwell_ms", DwellTime),
    ]
}

fn pose_fields() -> Vec<FieldSpec> {
    use FieldType::Choice;
    vec![
        field("pose.anchor", Choice(&["world", "elbow", "wrist"])),
        number!("pose.bearing_deg", Bearing, default),
        number!("pose.right_mm", Offset, default),
        number!("pose.forward_mm", Offset),
        number!("pose.height_mm", Offset, default),
        number!("pose.tilt_deg", Tilt, default),
        number!("pose.scale", BoardScale, default),
        field("pose.fit", Choice(&["Hand", "Off"])),
    ]
}

fn board_fields() -> Vec<FieldSpec> {
    use FieldType::{Bool, Choice, Outline, Ron};
    let own = [
        field("hand", Choice(SIDES)),
        field("contact", Choice(&["Touch", "Bend"])),
        field("shape", Ron),
        number!("shape.radius_mm", Radius),
        field("auto_recenter", Ron),
        number!("pitch_mm", Pitch, default),
        field("size_mm", Outline),
        number!("travel_mm", Travel, default),
        number!("press_at", PressAt, default),
        // The default depends on the contact.
        number!("release_at", ReleaseAt),
        number!("debounce_ms", Debounce, default),
        field("reports_depth", Bool),
    ];
    pose_fields().into_iter().chain(own).collect()
}

fn pointer_fields() -> Vec<FieldSpec> {
    use FieldType::{Choice, Output, Point, Ron};
    vec![
        field("hand", Choice(SIDES)),
        field("mode", Ron),
        field("output", Choice(&["Absolute", "Relative", "Off"])),
        field("screen_px", Point { count: 2 }),
        number!("max_step_px", MaxStep, default),
        field("smoothing", Ron),
        number!("dead_zone_px", PixelDistance, default),
        field("acceleration", Ron),
        field("precision", Ron),
        number!("precision_factor", PrecisionFactor, default),
        field("clutch", Ron),
        field("pinch_mm", Ron),
        field("clicks", Ron),
        field("dwell", Ron),
        number!("drag_threshold_px", PixelDistance, Some(30.0)),
        field("scroll", Ron),
        field("z_output", Output),
    ]
}

/// Writes or removes a field of parts.
pub(super) fn set_field(
    draft: &mut Draft,
    parts: &[Part],
    name: &str,
    value: Option<&str>,
) -> Result<Vec<Part>, EditError> {
    if let Some(value) = value
        && read_tree(value).is_none()
    {
        return Err(EditError::Value(value.to_owned()));
    }
    if let (&[part], "name", Some(new)) = (parts, name, value.and_then(quoted_content))
        && part != Part::Layout
    {
        return rename(draft, part, new);
    }
    let parts = take_out(draft, parts, false)?;
    for part in &parts {
        match value {
            Some(value) => draft.set(*part, name, value)?,
            None => draft.unset(*part, name)?,
        }
    }
    draft.commit()?;
    Ok(parts)
}
