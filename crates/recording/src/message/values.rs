//! Values that several messages have: angles, positions, rotations, sides.

use glam::{DVec3, Quat, Vec3};

use super::wire::{
    Field, Fields, WireError, double, float, integer, message, put_double, put_float, put_integer,
    put_message, put_nonzero_double, put_nonzero_float,
};
use ademan_core::hand::{Dof, JointAngles, Side};

/// Returns the value of an enum whose numbers begin with 1; `None` for 0, which stands for none.
pub fn choice<T: Copy>(field: Field, all: &[T]) -> Result<Option<T>, WireError> {
    let number = integer(field)?;
    let Some(index) = number.checked_sub(1) else {
        return Ok(None);
    };
    let chosen = usize::try_from(index).ok().and_then(|index| all.get(index));
    chosen
        .copied()
        .map(Some)
        .ok_or(WireError::UnknownValue(field.0))
}

/// Returns the value of a list whose fields have the numbers of its elements, beginning with 1; `None` for a number that
/// a later version has added.
pub fn element<T: Copy>(field: Field, all: &[T]) -> Option<T> {
    all.get(field.0 as usize - 1).copied()
}

/// Appends a side.
pub fn put_side(out: &mut Vec<u8>, field: u32, side: Option<Side>) {
    put_integer(out, field, side.map_or(0, |side| side.index() as u64 + 1));
}

/// Appends the known angles.
pub fn put_angles(out: &mut Vec<u8>, field: u32, angles: &JointAngles) {
    put_message(out, field, |out| {
        for (dof, radians) in angles.known() {
            put_double(out, dof.index() as u32 + 1, radians);
        }
    });
}

/// Appends the known angles in single precision.
pub fn put_rounded_angles(out: &mut Vec<u8>, field: u32, angles: &JointAngles) {
    put_message(out, field, |out| {
        for (dof, radians) in angles.known() {
            put_float(out, dof.index() as u32 + 1, radians as f32);
        }
    });
}

/// Decodes angles.
pub fn angles(fields: Fields) -> Result<JointAngles, WireError> {
    let mut angles = JointAngles::default();
    for field in fields {
        let field = field?;
        if let Some(dof) = element(field, Dof::ALL) {
            angles.set(dof, double(field)?);
        }
    }
    Ok(angles)
}

/// Appends a position in double precision.
pub fn put_position(out: &mut Vec<u8>, field: u32, position: DVec3) {
    put_message(out, field, |out| {
        for (value, number) in position.to_array().into_iter().zip(1..) {
            put_nonzero_double(out, number, value);
        }
    });
}

/// Decodes a position in double precision.
pub fn position(field: Field) -> Result<DVec3, WireError> {
    let mut position = [0.0; 3];
    for part in message(field)? {
        let part = part?;
        if let Some(value) = position.get_mut(part.0 as usize - 1) {
            *value = double(part)?;
        }
    }
    Ok(DVec3::from_array(position))
}

/// Appends a message of numbers in single precision.
pub fn put_floats<const N: usize>(out: &mut Vec<u8>, field: u32, numbers: [f32; N]) {
    put_message(out, field, |out| {
        for (value, number) in numbers.into_iter().zip(1..) {
            put_nonzero_float(out, number, value);
        }
    });
}

/// Decodes a message of numbers in single precision.
pub fn floats<const N: usize>(field: Field) -> Result<[f32; N], WireError> {
    let mut numbers = [0.0; N];
    for part in message(field)? {
        let part = part?;
        if let Some(value) = numbers.get_mut(part.0 as usize - 1) {
            *value = float(part)?;
        }
    }
    Ok(numbers)
}

/// Decodes a translation.
pub fn translation(field: Field) -> Result<Vec3, WireError> {
    floats(field).map(Vec3::from_array)
}

/// Decodes a rotation.
pub fn rotation(field: Field) -> Result<Quat, WireError> {
    floats(field).map(Quat::from_array)
}
