//! Numbers in a file, each with the range that makes sense for it. A number out of range, NaN and
//! infinity are refused where they stand.

use serde::de::{Deserialize, Deserializer, Error};

/// Declares newtypes over `f64` that are only read within their range, some with the value that stands
/// for a field left out.
macro_rules! measures {
    ($($(#[$meta:meta])*
       $name:ident = $what:literal, $min:literal ..= $max:literal, $unit:literal $(, or $default:literal)?;)+) => {$(
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            /// The smallest and the largest value.
            pub const RANGE: std::ops::RangeInclusive<f64> = $min..=$max;

            /// The value, in the unit of the file.
            pub const fn get(self) -> f64 {
                self.0
            }
        }

        $(
            impl Default for $name {
                fn default() -> Self {
                    Self($default)
                }
            }
        )?

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let value = f64::deserialize(deserializer)?;
                if Self::RANGE.contains(&value) {
                    return Ok(Self(value));
                }
                Err(D::Error::custom(format!(
                    concat!("{} is out of range: ", $what, " is {} to {}", $unit),
                    shown(value),
                    Self::RANGE.start(),
                    Self::RANGE.end(),
                )))
            }
        }
    )+};
}

measures! {
    /// A place on a board or a distance from an anchor, in millimetres.
    Distance = "a distance", -2000.0 ..= 2000.0, " mm", or 0.0;
    /// A width, depth or diameter, in millimetres.
    Size = "a size", 1.0 ..= 500.0, " mm", or 17.0;
    /// The distance from the middle of one key to that of the next in a row, in millimetres.
    Pitch = "a pitch", 1.0 ..= 500.0, " mm", or 19.0;
    /// How far a key goes down, in millimetres.
    Travel = "a travel", 0.2 ..= 50.0, " mm", or 4.0;
    /// The radius of an arc or cylinder, in millimetres.
    Radius = "a radius", 20.0 ..= 2000.0, " mm";
    /// The part of the travel at which a key counts as pressed.
    PressShare = "a press share", 0.05 ..= 1.0, "", or 0.5;
    /// The part of the travel at which a key counts as let go again.
    ReleaseShare = "a release share", 0.0 ..= 0.95, "", or 0.25;
    /// For how long after it came up a key does not press again, in milliseconds.
    Repress = "a re-press delay", 0.0 ..= 2000.0, " ms", or 0.0;
    /// How long a key is pressed before it counts as held, in milliseconds.
    HoldTime = "a hold time", 50.0 ..= 2000.0, " ms", or 250.0;
    /// How long a fingertip or the cursor rests until it fires, in milliseconds.
    DwellTime = "a dwell time", 50.0 ..= 5000.0, " ms";
    /// How long after each other the keys of a chord are pressed at most, in milliseconds.
    ChordTime = "a chord time", 10.0 ..= 500.0, " ms", or 50.0;
    /// How fast the pointer goes on a touch pad, in pixels for a millimetre.
    Speed = "a speed", 0.1 ..= 100.0, " px/mm", or 4.0;
    /// How much faster the pointer goes when the finger is quick.
    Acceleration = "an acceleration", 0.0 ..= 10.0, "", or 1.0;
    /// How far two fingers go for a click of the wheel, in millimetres.
    ScrollWay = "a way for a click", 1.0 ..= 100.0, " mm", or 8.0;
    /// An angle of a joint, in degrees.
    Angle = "an angle", -180.0 ..= 180.0, "°";
    /// How far apart two fingertips are, in millimetres.
    Gap = "a gap", 0.0 ..= 200.0, " mm";
    /// A width, height, depth or diameter in space, in millimetres.
    Extent = "a size in space", 1.0 ..= 2000.0, " mm", or 200.0;
    /// The exponent of a curve of the pointer.
    Exponent = "an exponent", 0.2 ..= 5.0, "", or 1.0;
    /// The share of a displacement that is rest.
    DeadShare = "a dead share", 0.0 ..= 0.9, "", or 0.15;
    /// A speed of the cursor, in pixels a second.
    CursorSpeed = "a speed of the cursor", 0.0 ..= 100000.0, " px/s";
    /// How many pixels of the cursor a pixel of the hand is.
    Gain = "a gain", 0.05 ..= 20.0, "";
    /// How slow a pointer is that is made slow.
    Factor = "a precision factor", 0.01 ..= 1.0, "", or 0.25;
    /// How many pixels a screen is wide or high.
    Screen = "a size of a screen", 2.0 ..= 20000.0, " px";
    /// The most that a cursor moves in a frame, in pixels.
    Step = "a largest step", 10.0 ..= 20000.0, " px", or 300.0;
    /// How far around a place on the screen, in pixels.
    PointerRadius = "a radius on the screen", 0.0 ..= 1000.0, " px", or 0.0;
    /// How far the cursor goes for a click of the wheel, in pixels.
    ScrollPixels = "a way for a click of the wheel", -1000.0 ..= 1000.0, " px";
    /// How far a fingertip is pushed forward, in millimetres.
    PushDepth = "a push", 5.0 ..= 200.0, " mm";
    /// The cutoff of a filter, in hertz.
    Cutoff = "a cutoff", 0.05 ..= 50.0, " Hz";
    /// How much a cutoff rises with speed, in hertz per px/s.
    Steepness = "a steepness", 0.0 ..= 10.0, "";
    /// Clicks of a wheel for the whole range of a control.
    Clicks = "a number of clicks", -1000.0 ..= 1000.0, "";
    /// Pixels for the whole range of a control.
    Pixels = "a distance on the screen", -20000.0 ..= 20000.0, " px";
    /// How many times as large boards become.
    Growth = "a growth", 0.5 ..= 2.0, "";
    /// Steps of a whole range.
    Steps = "a number of steps", 1.0 ..= 1000.0, "";
    /// A share of the range of a control.
    Share = "a share", 0.0 ..= 1.0, "";
    /// How far a control lies turned in the plane of its board, in degrees.
    Turn = "a turn", -180.0 ..= 180.0, "°", or 0.0;
    /// How far a knob turns between its ends, in degrees.
    KnobRangeDegrees = "the range of a knob", 10.0 ..= 360.0, "°", or 270.0;
    /// How many full turns a valve has between its ends.
    Turns = "a number of turns", 0.25 ..= 50.0, "", or 3.0;
    /// How far a lever turns between its ends, in degrees.
    Throw = "a throw", 5.0 ..= 170.0, "°", or 60.0;
    /// How far a joystick goes to each side, in millimetres.
    Reach = "a reach", 2.0 ..= 200.0, " mm", or 20.0;
    /// The share of its reach within which a joystick stands in the middle.
    DeadZone = "a dead zone", 0.0 ..= 0.9, "", or 0.1;
    /// The exponent of a joystick's way from the dead zone to its end.
    Curve = "a curve", 1.0 ..= 4.0, "", or 1.0;
    /// How fast a joystick moves the pointer, in pixels a second.
    PointerSpeed = "a speed of the pointer", 1.0 ..= 20000.0, " px/s";
    /// A turn about the vertical, in degrees.
    Bearing = "a bearing", -180.0 ..= 180.0, "°", or 0.0;
    /// How many times as large a board is.
    Scale = "a scale", 0.25 ..= 4.0, "", or 1.0;
    /// How fast a board drifts, in millimetres per second.
    DriftSpeed = "a drift speed", 0.1 ..= 100.0, " mm/s", or 5.0;
    /// How long a hand rests before a board drifts, in milliseconds.
    DriftDelay = "a drift delay", 100.0 ..= 60000.0, " ms", or 2000.0;
    /// How far a board drifts at most, in millimetres.
    DriftLimit = "a drift limit", 1.0 ..= 500.0, " mm", or 30.0;
    /// A slope, in degrees.
    Tilt = "a tilt", -90.0 ..= 90.0, "°", or 0.0;
}

/// Short also for 1e308, which `Display` writes with three hundred zeros.
fn shown(value: f64) -> String {
    if value.is_finite() && value.abs() >= 1e9 {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}
