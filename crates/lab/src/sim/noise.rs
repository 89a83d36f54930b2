//! Noise of simulated sensors.

use glam::{DVec3, Quat, Vec3};

use crate::capture::Sample;
use crate::hand::Displacement;

/// Normally distributed noise.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    deviation: f64,
    random: fastrand::Rng,
}

impl Noise {
    /// Creates noise with this standard deviation.
    pub(super) fn new(deviation: f64, seed: u64) -> Self {
        Self {
            deviation,
            random: fastrand::Rng::with_seed(seed),
        }
    }

    /// Returns the next value of the noise.
    pub(super) fn value(&mut self) -> f64 {
        if self.deviation > 0.0 {
            self.deviation * gaussian(&mut self.random)
        } else {
            0.0
        }
    }

    /// Adds noise to each value of a sample of joints: in millimetres to positions, in degrees to angles.
    pub(super) fn add_to(&mut self, sample: &mut Sample) {
        if self.deviation <= 0.0 {
            return;
        }
        match sample {
            Sample::Channels(_) => {}
            Sample::Angles { angles } => {
                for (dof, radians) in angles.clone().known() {
                    angles.set(dof, radians + self.value().to_radians());
                }
            }
            Sample::Bones { bones } => {
                for arm in [&mut bones.left, &mut bones.right] {
                    for (bone, rotation) in arm.clone().known() {
                        let turn = self.vector().map(f64::to_radians).as_vec3();
                        arm.set(bone, rotation * Quat::from_scaled_axis(turn));
                    }
                }
            }
            Sample::Joints { .. } | Sample::Body(_) | Sample::Displacement { .. } => {
                displace(sample, || self.offset());
            }
        }
    }

    /// Returns an offset in metres, for a deviation in millimetres.
    fn offset(&mut self) -> DVec3 {
        self.vector() / 1000.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.value(), self.value(), self.value())
    }
}

/// Displaces each position of a sample by the next offset, in metres. A sample without positions stays.
pub(super) fn displace(sample: &mut Sample, mut offset: impl FnMut() -> DVec3) {
    match sample {
        Sample::Channels(_) | Sample::Angles { .. } | Sample::Bones { .. } => {}
        Sample::Joints { positions } => {
            for (joint, position) in positions.clone().known() {
                positions.set(joint, position + offset());
            }
        }
        Sample::Body(body) => {
            for landmark in &mut body.points {
                let position = Vec3::from_array(landmark.position) + offset().as_vec3();
                landmark.position = position.to_array();
            }
        }
        Sample::Displacement { displacement } => {
            let rotation = displacement.rotation().unwrap_or_default();
            let translation = displacement.translation() + offset().as_vec3();
            *displacement = Displacement::new(displacement.joint, translation, rotation);
        }
    }
}

/// Returns a sample of the standard normal distribution (Box-Muller transform).
pub(super) fn gaussian(random: &mut fastrand::Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.f64()).cos()
}
