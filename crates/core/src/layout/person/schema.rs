//! Persons as written in a file. The doc comment of a field is its row in `ademan person fields`.
//!
//! A figure with `?` is remembered from the literature and unchecked: a default of the simulation, not a claim.

use serde::Deserialize;

use crate::document::{Pairs, Spanned, Table, ranged_numbers, schema, tables_of};
use crate::hand::Side;
use crate::layout::quantity::JointAngle;

ranged_numbers! {
    /// Length of a hand, in millimetres.
    HandLength = "the length of a hand", 100.0 ..= 300.0, " mm";
    /// Breadth of a hand, in millimetres.
    HandBreadth = "the breadth of a hand", 40.0 ..= 150.0, " mm";
    /// Length of a forearm, in millimetres.
    ForearmLength = "the length of a forearm", 100.0 ..= 500.0, " mm";
    /// Length of an upper arm, in millimetres.
    UpperArmLength = "the length of an upper arm", 100.0 ..= 600.0, " mm";
    /// Speed of movements, as a factor.
    Speed = "a speed", 0.1 ..= 4.0, "", or 1.0;
    /// Amplitude of a tremor, in millimetres.
    TremorAmplitude = "the amplitude of a tremor", 0.0 ..= 30.0, " mm", or 0.0;
    /// Frequency of a tremor, in hertz.
    TremorFrequency = "the frequency of a tremor", 1.0 ..= 25.0, " Hz", or 7.0;
    /// Standard deviation of the end points of strokes, in millimetres.
    ScatterDeviation = "a scatter", 0.0 ..= 30.0, " mm", or 0.0;
    /// Part of the squared size of a target in the variance of the end points.
    ScatterPart = "a part of the size", 0.0 ..= 0.25, "", or 0.0;
    /// Constant offset of a finger, in millimetres.
    FingerOffset = "the offset of a finger", -30.0 ..= 30.0, " mm";
    /// Strength of the enslaving of fingers.
    Enslaving = "enslaving", 0.0 ..= 1.0, "", or 0.0;
}

schema! {
    /// A person: the size of the arms and hands, and the movements of the simulated person. Every field is optional.
    #[derive(Deserialize)]
    #[serde(rename = "Person", deny_unknown_fields)]
    pub(super) struct PersonSchema<'a> {
        /// Name for displays. Default: none.
        #[serde(borrow, default)]
        pub name: Option<Spanned<'a>>,
        /// The hand that types, or the first of two. Default: the side of the glove, or right.
        #[serde(default)]
        pub side: Option<Side>,
        /// Wrist crease to the end of the middle finger; 183 ± 10 in men and 166 ± 8 in women (Buryanov & Kotiuk 2010).
        /// Default: from another length, see `forearm_length_mm`; without any, the arm model `unam`.
        #[serde(default)]
        pub hand_length_mm: Option<HandLength>,
        /// Across the knuckles. Default: 0.456 of the hand length (Buryanov & Kotiuk 2010).
        #[serde(default)]
        pub hand_breadth_mm: Option<HandBreadth>,
        /// Elbow to wrist crease. Default: 1.352 of the hand length (0.146 and 0.108 of the stature, Drillis & Contini 1966).
        #[serde(default)]
        pub forearm_length_mm: Option<ForearmLength>,
        /// Shoulder to elbow. Default: 1.274 of the forearm length (0.186 and 0.146 of the stature, Drillis & Contini 1966).
        #[serde(default)]
        pub upper_arm_length_mm: Option<UpperArmLength>,
        /// Ranges of joints that are smaller than usual, in degrees: `{"index-mcp-flexion": (-10, 70)}`. Default: a healthy
        /// adult (Electronic Textbook of Hand Surgery, "Normal range of motion").
        #[serde(borrow, default)]
        pub joint_limits_deg: Pairs<'a, (JointAngle, JointAngle)>,
        /// Number of hands in use.
        #[serde(default)]
        pub hands: HandsSchema,
        /// Fingers of each hand that press, such as `["index"]` for two-finger typing, `["index", "middle"]` for four fingers, and
        /// all five for touch typing; the thumb presses Space. Default: the finger that the layout names, or the nearest one of a
        /// board at the wrist, or else the index finger.
        #[serde(borrow, default)]
        pub fingers: Vec<Spanned<'a>>,
        /// Fingers that do not press and rest half bent beside the others, instead of extended away from the keys. Default: none.
        #[serde(borrow, default)]
        pub resting: Vec<Spanned<'a>>,
        /// Factor of the speed of the simulated movements, whose time is 60 ms + 85 ms × log₂(distance / 19 mm + 1) (Fitts's law ?).
        #[serde(default)]
        pub speed: Speed,
        /// Random error of the end points of strokes. Default: none.
        #[serde(default)]
        pub scatter: ScatterSchema,
        /// Constant error of fingers, to the right and away from the wearer on the board: `{"index": (1.5, -2)}`. Default: none.
        #[serde(borrow, default)]
        pub offsets_mm: Pairs<'a, (FingerOffset, FingerOffset)>,
        /// Tremor of the hand. Default: none.
        #[serde(default)]
        pub tremor: TremorSchema,
        /// Part of the flexion of a pressing finger that its neighbors follow: 0.3 light, 0.6 medium ?, 1 for the shares of Zatsiorsky, Li
        /// & Latash 1998 ?.
        #[serde(default)]
        pub enslaving: Enslaving,
    }
}

schema! {
    /// The hands that a person uses.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    #[serde(rename = "Hands")]
    pub enum HandsSchema {
        /// Both, where a layout has boards for both.
        #[default]
        Both,
        /// Only the hand of `side`.
        One,
    }
}

schema! {
    /// The scatter of end points: the variance along each axis of the board is the squared deviation plus a part of the squared size of
    /// the target (dual Gaussian, Bi & Zhai 2016 ?).
    #[derive(Clone, Copy, Debug, Default, Deserialize)]
    #[serde(rename = "Scatter", deny_unknown_fields)]
    pub(super) struct ScatterSchema {
        /// Deviation along the rows; 1.3 on glass ?, 4 to 7 in the air ?.
        #[serde(default)]
        pub x_mm: ScatterDeviation,
        /// Deviation across the rows; 1.15 on glass ?, 4 to 7 in the air ?.
        #[serde(default)]
        pub y_mm: ScatterDeviation,
        /// Deviation of the depth; 5 to 9 in the air ?.
        #[serde(default)]
        pub depth_mm: ScatterDeviation,
        /// Part of the squared width in the variance along the rows; 0.0075 on glass ?.
        #[serde(default)]
        pub x_part: ScatterPart,
        /// Part of the squared depth of the target in the variance across the rows; 0.0108 on glass ?.
        #[serde(default)]
        pub y_part: ScatterPart,
    }
}

schema! {
    /// The tremor of a hand: an oscillation of the fingertips along a slowly turning direction.
    #[derive(Clone, Copy, Debug, Default, Deserialize)]
    #[serde(rename = "Tremor", deny_unknown_fields)]
    pub(super) struct TremorSchema {
        /// Largest amplitude at the fingertips, bent fingers move less; 0.05 in healthy hands (Arch Neurol 1982;39:358, 97 people).
        #[serde(default)]
        pub amplitude_mm: Option<TremorAmplitude>,
        /// Frequency; 7 is usual in healthy hands (the same source), 4 to 6 in a resting tremor ?.
        #[serde(default)]
        pub frequency_hz: Option<TremorFrequency>,
    }
}

/// Returns the tables of the fields of a person file.
pub fn person_field_tables() -> Vec<Table> {
    tables_of::<PersonSchema>()
}
