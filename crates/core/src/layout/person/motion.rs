//! The errors and the speed of the movements of a person.

use parry3d::math::{Vec2, Vec3};

use super::schema::{PersonSchema, TremorFrequency};
use crate::document::{Document, DocumentError};
use crate::hand::{Finger, FingerSet};

/// The errors and the speed of the movements of a person. By default there are no errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Factor of the speed.
    pub speed: f64,
    /// Random error of the end points of strokes.
    pub scatter: Scatter,
    /// Constant errors of the fingers on the board in metres, thumb first: to the right and away from the wearer.
    pub offsets: [Vec2; Finger::COUNT],
    /// Tremor.
    pub tremor: Tremor,
    /// Part of the flexion of a finger that its neighbors follow, as a factor of the published one, 0..=1.
    pub enslaving: f64,
}

/// The scatter of the end points of strokes, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scatter {
    /// Standard deviation along the X, Y and Z of a target, whatever its size.
    pub deviation: Vec3,
    /// Parts of the squared size of a target along X and Y in the variance.
    pub parts: Vec2,
}

/// A tremor of the fingertips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tremor {
    /// Amplitude in metres.
    pub amplitude: f64,
    /// Frequency.
    pub frequency_hz: f64,
}

impl Default for Tremor {
    fn default() -> Self {
        Self {
            amplitude: 0.0,
            frequency_hz: TremorFrequency::default().get(),
        }
    }
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            speed: 1.0,
            scatter: Scatter::default(),
            offsets: [Vec2::ZERO; Finger::COUNT],
            tremor: Tremor::default(),
            enslaving: 0.0,
        }
    }
}

impl Scatter {
    /// Returns the standard deviations at a target of this size, in metres.
    pub fn deviation_at(&self, size: Vec2) -> Vec3 {
        let variance = self.deviation * self.deviation + (self.parts * size * size).extend(0.0);
        Vec3::new(variance.x.sqrt(), variance.y.sqrt(), variance.z.sqrt())
    }
}

/// Returns the motion of a file, whose `fingers` press.
pub(super) fn motion(
    document: &Document,
    schema: &PersonSchema,
    fingers: FingerSet,
) -> Result<Motion, DocumentError> {
    let scatter = &schema.scatter;
    let metres = |millimetres: f64| (millimetres * 1e-3) as f32;
    Ok(Motion {
        speed: schema.speed.get(),
        scatter: Scatter {
            deviation: Vec3::new(
                metres(scatter.x_mm.get()),
                metres(scatter.y_mm.get()),
                metres(scatter.depth_mm.get()),
            ),
            parts: Vec2::new(scatter.x_part.get() as f32, scatter.y_part.get() as f32),
        },
        offsets: offsets(document, schema, fingers)?,
        tremor: tremor(document, schema)?,
        enslaving: schema.enslaving.get(),
    })
}

fn tremor(document: &Document, schema: &PersonSchema) -> Result<Tremor, DocumentError> {
    let tremor = schema.tremor;
    if tremor.frequency_hz.is_some() && tremor.amplitude_mm.is_none() {
        let place = document.field_value("frequency_hz");
        let message =
            "a tremor with a `frequency_hz` needs an `amplitude_mm`; add it, or remove `tremor`";
        return Err(document.error_at(place.unwrap_or(&document.text), message));
    }
    Ok(Tremor {
        amplitude: tremor.amplitude_mm.unwrap_or_default().get() * 1e-3,
        frequency_hz: tremor.frequency_hz.unwrap_or_default().get(),
    })
}

fn offsets(
    document: &Document,
    schema: &PersonSchema,
    fingers: FingerSet,
) -> Result<[Vec2; Finger::COUNT], DocumentError> {
    let mut offsets = [Vec2::ZERO; Finger::COUNT];
    let mut seen = FingerSet::NONE;
    for (name, (x, y)) in &schema.offsets_mm.0 {
        let finger = super::finger(document, *name)?;
        if seen.contains(finger) {
            let message = format!("duplicate finger `{finger}`; write one offset for it");
            return Err(document.error_at(name.text, message));
        }
        if !fingers.is_empty() && !fingers.contains(finger) {
            let message = format!(
                "`{finger}` has an offset, but `fingers` does not list it; add it there, or remove the offset"
            );
            return Err(document.error_at(name.text, message));
        }
        seen = seen.with(finger);
        offsets[finger.index()] = Vec2::new(x.get() as f32, y.get() as f32) * 1e-3;
    }
    Ok(offsets)
}
