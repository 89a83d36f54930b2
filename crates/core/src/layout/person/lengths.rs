//! The lengths of the bones of a person, derived from the lengths in the person file.

use std::ops::RangeInclusive;

use super::schema::PersonSchema;
use crate::document::{Document, DocumentError};
use crate::kinematics::{BoneLengths, FOREARM_PER_HAND};

/// Forearm length as a multiple of hand length: 0.146 and 0.108 of the stature (Drillis & Contini 1966).
const FOREARM: f64 = 0.146 / 0.108;

/// The accepted ratios of lengths: up to a third more or less than the average. A ratio outside its range is a mistake in the file.
const BREADTH_PER_HAND: RangeInclusive<f64> = 0.3..=0.65;
const UPPER_ARM_PER_FOREARM: RangeInclusive<f64> = 0.85..=1.7;

/// Returns the lengths of all bones in metres; `None` if the file has no length.
pub(super) fn bones(
    document: &Document,
    schema: &PersonSchema,
) -> Result<Option<BoneLengths>, DocumentError> {
    let metres = |millimetres: f64| millimetres * 1e-3;
    let hand = schema.hand_length_mm.map(|length| metres(length.get()));
    let breadth = schema.hand_breadth_mm.map(|length| metres(length.get()));
    let forearm = schema.forearm_length_mm.map(|length| metres(length.get()));
    let upper_arm = schema
        .upper_arm_length_mm
        .map(|length| metres(length.get()));
    let average = |length: f64| BoneLengths::from_hand_and_forearm(length, FOREARM * length);
    // An average person with a hand of 180 mm. The lengths that the file lacks follow in proportion.
    let unit = average(0.18).map_err(|error| document.error_at(&document.text, error))?;
    let (by_breadth, by_upper_arm) = (unit.hand / unit.breadth, unit.forearm / unit.upper_arm);
    let derived_forearm = forearm.or(upper_arm.map(|length| length * by_upper_arm));
    let derived_hand = hand
        .or(breadth.map(|breadth| breadth * by_breadth))
        .or(derived_forearm.map(|length| length / FOREARM));
    let Some(hand_length) = derived_hand else {
        return Ok(None);
    };
    let forearm_length = derived_forearm.unwrap_or(FOREARM * hand_length);
    let named = [
        "hand_length_mm",
        "forearm_length_mm",
        "hand_breadth_mm",
        "upper_arm_length_mm",
    ];
    let place = named.iter().find_map(|name| document.field_value(name));
    // `check` names the fields of a proportion that is a mistake.
    let computed = BoneLengths::in_any_proportion(hand_length, forearm_length);
    let mut bones =
        computed.map_err(|error| document.error_at(place.unwrap_or(&document.text), error))?;
    bones.breadth = breadth.unwrap_or(bones.breadth);
    bones.upper_arm = upper_arm.unwrap_or(bones.upper_arm);
    check(document, &bones)?;
    Ok(Some(bones))
}

/// Returns an error, at a field of the file, if two lengths have a ratio that no person has.
fn check(document: &Document, bones: &BoneLengths) -> Result<(), DocumentError> {
    let hand = ("hand_length_mm", bones.hand);
    let forearm = ("forearm_length_mm", bones.forearm);
    let breadth = ("hand_breadth_mm", bones.breadth);
    let upper_arm = ("upper_arm_length_mm", bones.upper_arm);
    for ((name, length), (base, base_length), ratios) in [
        (breadth, hand, BREADTH_PER_HAND),
        (forearm, hand, FOREARM_PER_HAND),
        (upper_arm, forearm, UPPER_ARM_PER_FOREARM),
    ] {
        if ratios.contains(&(length / base_length)) {
            continue;
        }
        let (low, high) = (ratios.start() * base_length, ratios.end() * base_length);
        let message = format!(
            "`{name}` of {:.0} mm does not fit `{base}` of {:.0} mm: with this `{base}` it is {:.0} to {:.0} mm; measure both again",
            length * 1e3,
            base_length * 1e3,
            low * 1e3,
            high * 1e3
        );
        let place = document.field_value(name).or(document.field_value(base));
        return Err(document.error_at(place.unwrap_or(&document.text), message));
    }
    Ok(())
}
