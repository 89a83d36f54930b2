//! The quantities of a layout file: unit, valid range and default of each.

use std::time::Duration;

use parry3d::math::Vec2;

use crate::document::ranged_numbers;

ranged_numbers! {
    /// A coordinate or an offset along an axis, in millimetres.
    Offset = "an offset", -2000.0 ..= 2000.0, " mm", or 0.0;
    /// Width, depth or diameter of a control, in millimetres.
    Size = "a size", 1.0 ..= 500.0, " mm", or 17.0;
    /// Distance between the centers of adjacent keys of a row, in millimetres.
    Pitch = "a pitch", 1.0 ..= 500.0, " mm", or 19.0;
    /// Travel of a key, in millimetres.
    Travel = "a travel", 0.2 ..= 50.0, " mm", or 4.0;
    /// Radius of an arc or a cylinder, in millimetres.
    Radius = "a radius", 20.0 ..= 2000.0, " mm";
    /// Fraction of the travel at which a key is pressed.
    PressAt = "a press point", 0.05 ..= 1.0, "", or 0.5;
    /// Fraction of the travel at which a pressed key is released.
    ReleaseAt = "a release point", 0.0 ..= 0.95, "", or 0.25;
    /// Time after a release during which a key ignores presses, in milliseconds. Noise presses a key again within two readings; a
    /// person needs more than 60 ms to lift a finger and press again.
    Debounce = "a debounce time", 0.0 ..= 2000.0, " ms", or 40.0;
    /// Time after which a pressed key counts as held, in milliseconds.
    HoldAfter = "a hold time", 50.0 ..= 2000.0, " ms", or 250.0;
    /// Time that a fingertip or the cursor rests before it activates, in milliseconds.
    DwellTime = "a dwell time", 50.0 ..= 5000.0, " ms";
    /// A wait of a sequence, in milliseconds.
    SequenceWait = "a wait", 1.0 ..= 5000.0, " ms";
    /// Time between the first and the last key press of a chord, in milliseconds.
    ChordTimeout = "a chord timeout", 10.0 ..= 500.0, " ms", or 50.0;
    /// Time between two taps of a multitap key, in milliseconds.
    MultitapTimeout = "a multitap timeout", 200.0 ..= 5000.0, " ms", or 800.0;
    /// Pointer motion per finger motion on a touchpad, in pixels per millimetre.
    PixelsPerMm = "a pointer speed", 0.1 ..= 100.0, " px/mm", or 4.0;
    /// Increase of the pointer speed of a touchpad with a fast finger, as a factor.
    Acceleration = "an acceleration", 0.0 ..= 10.0, "", or 1.0;
    /// Motion of two fingers per detent of the wheel, in millimetres.
    MmPerDetent = "a scroll distance", 1.0 ..= 100.0, " mm", or 8.0;
    /// A joint angle, in degrees.
    JointAngle = "an angle", -180.0 ..= 180.0, "°";
    /// Distance between two fingertips, in millimetres.
    FingertipGap = "a gap", 0.0 ..= 200.0, " mm";
    /// Confidence that a hand has a shape.
    Confidence = "a confidence", 0.0 ..= 1.0, "";
    /// Distance that the palm moves in a swipe, in millimetres.
    SwipeDistance = "a distance", 0.0 ..= 1000.0, " mm";
    /// Number of times that a palm turns back within a second.
    Reversals = "a number of reversals", 0.0 ..= 16.0, "";
    /// Number of turns of a circle.
    CircleTurns = "a number of turns", 0.0 ..= 16.0, "";
    /// Time from a step of a sequence of triggers to the next, in milliseconds.
    StepGap = "a time", 50.0 ..= 10000.0, " ms";
    /// Time for which a trigger is held before it turns on, in milliseconds.
    TriggerHold = "a hold time", 0.0 ..= 5000.0, " ms";
    /// Time after a trigger turned off in which it does not turn on, in milliseconds.
    CoolDown = "a cool-down", 0.0 ..= 10000.0, " ms";
    /// Value of a stick, trigger or button of a glove, -1 to 1, or an angle of the body, in degrees.
    InputValue = "a value", -180.0 ..= 180.0, "";
    /// Width, height, depth or diameter of a volume or of the range of a pointer, in millimetres.
    Extent = "an extent", 1.0 ..= 2000.0, " mm", or 200.0;
    /// Exponent of the response curve of a pointer.
    PointerExponent = "an exponent", 0.2 ..= 5.0, "", or 1.0;
    /// Dead zone of a rate-controlled pointer, as a fraction of the displacement.
    RateDeadZone = "a dead zone", 0.0 ..= 0.9, "", or 0.15;
    /// Speed of the cursor, in pixels per second.
    CursorSpeed = "a cursor speed", 0.0 ..= 100000.0, " px/s";
    /// Gain from hand motion to cursor motion.
    Gain = "a gain", 0.05 ..= 20.0, "";
    /// Gain of the pointer while its precision gesture is active.
    PrecisionFactor = "a precision factor", 0.01 ..= 1.0, "", or 0.25;
    /// Width or height of the screen, in pixels.
    ScreenSize = "a screen size", 2.0 ..= 20000.0, " px";
    /// Maximum motion of the cursor per reading, in pixels.
    MaxStep = "a maximum step", 10.0 ..= 20000.0, " px", or 300.0;
    /// A distance on the screen, in pixels.
    PixelDistance = "a distance on the screen", 0.0 ..= 1000.0, " px", or 0.0;
    /// Cursor motion per detent of the wheel, in pixels.
    PixelsPerDetent = "a scroll distance", -1000.0 ..= 1000.0, " px";
    /// Forward motion of a fingertip that counts as a push, in millimetres.
    PushDistance = "a push", 5.0 ..= 200.0, " mm";
    /// Cutoff frequency of a filter, in hertz.
    Cutoff = "a cutoff", 0.05 ..= 50.0, " Hz";
    /// Increase of the cutoff frequency with speed, in hertz per px/s: the β of a 1-Euro filter.
    Beta = "beta", 0.0 ..= 10.0, "";
    /// Detents of the wheel for the full range of a control.
    FullRangeDetents = "a number of detents", -1000.0 ..= 1000.0, "";
    /// Pixels for the full range of a control.
    FullRangePixels = "a distance on the screen", -20000.0 ..= 20000.0, " px";
    /// Steps of the full range of a control.
    Steps = "a number of steps", whole 1.0 ..= 1000.0, "";
    /// Number that an OSC message has at an end of the range of a control.
    OscNumber = "an OSC number", -1e6 ..= 1e6, "";
    /// MIDI note; 60 is middle C.
    MidiNote = "a note", whole 0.0 ..= 127.0, "";
    /// MIDI controller; 7 is the volume of a channel.
    MidiController = "a controller", whole 0.0 ..= 119.0, "";
    /// MIDI channel, as musicians count; 10 has the drums.
    MidiChannel = "a channel", whole 1.0 ..= 16.0, "", or 1.0;
    /// Fraction of the range of a control.
    Fraction = "a fraction", 0.0 ..= 1.0, "";
    /// Rotation of a control on its board, in degrees, counter-clockwise.
    Rotation = "a rotation", -180.0 ..= 180.0, "°", or 0.0;
    /// Angle of a knob between its ends, in degrees.
    KnobRange = "the range of a knob", 10.0 ..= 360.0, "°", or 270.0;
    /// Full turns of a valve between its ends.
    Turns = "a number of turns", 0.25 ..= 50.0, "", or 3.0;
    /// Angle of a lever between its ends, in degrees.
    Throw = "a throw", 5.0 ..= 170.0, "°", or 60.0;
    /// Maximum deflection of a joystick to each side, in millimetres.
    MaxDeflection = "a maximum deflection", 2.0 ..= 200.0, " mm", or 20.0;
    /// Dead zone of a joystick, as a fraction of its maximum deflection.
    StickDeadZone = "a dead zone", 0.0 ..= 0.9, "", or 0.1;
    /// Exponent of the response curve of a joystick.
    StickExponent = "an exponent", 1.0 ..= 4.0, "", or 1.0;
    /// Speed of the cursor at the full deflection of a joystick, in pixels per second.
    StickSpeed = "a cursor speed", 1.0 ..= 20000.0, " px/s";
    /// Displacement of a hand for a full deflection of an axis, in millimetres.
    FullDisplacement = "a displacement", -500.0 ..= 500.0, " mm";
    /// Rotation of a hand for a full deflection of an axis, in degrees.
    FullRotation = "a rotation", -170.0 ..= 170.0, "°";
    /// Direction in the horizontal plane, in degrees clockwise from straight forward.
    Bearing = "a bearing", -180.0 ..= 180.0, "°", or 0.0;
    /// Scale of a board.
    BoardScale = "a scale", 0.25 ..= 4.0, "", or 1.0;
    /// Speed of auto-recentering, in millimetres per second.
    RecenterSpeed = "a recentering speed", 0.1 ..= 100.0, " mm/s", or 5.0;
    /// Time that a hand rests before auto-recentering starts, in milliseconds.
    RecenterDelay = "a recentering delay", 100.0 ..= 60000.0, " ms", or 2000.0;
    /// Maximum offset by auto-recentering, in millimetres.
    RecenterOffset = "a recentering offset", 1.0 ..= 500.0, " mm", or 30.0;
    /// Length of a unit of a mesh, in millimetres; glTF has metres.
    MeshUnit = "the unit of a mesh", 0.001 ..= 1000.0, " mm", or 1.0;
    /// Turn of a mesh, in degrees.
    MeshTurn = "a turn", -720.0 ..= 720.0, "°";
    /// Factor of the size of a mesh.
    Factor = "a factor", 0.0 ..= 100.0, "";
    /// Slope of a board, in degrees.
    Tilt = "a tilt", -90.0 ..= 90.0, "°", or 0.0;
}

impl ReleaseAt {
    /// The default for keys that are pressed by bending: of the bend of the finger. A relaxed finger is straighter.
    pub(super) const BEND: Self = Self(0.4);
}

/// Converts millimetres to metres.
pub(super) fn metres(millimetres: f64) -> f32 {
    (millimetres * 1e-3) as f32
}

/// Converts a position in millimetres to metres.
pub(super) fn position((x, y): (Offset, Offset)) -> Vec2 {
    Vec2::new(metres(x.get()), metres(y.get()))
}

/// Converts milliseconds to a duration, rounded to microseconds.
pub(super) fn duration(milliseconds: f64) -> Duration {
    Duration::from_micros((milliseconds * 1e3).round() as u64)
}
