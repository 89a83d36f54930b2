//! Bones of constant length, fitted to measured points.

use glam::DVec3;

/// Most steps of a fit. Each one divides the error of the lengths by a large factor.
const MAX_STEPS: usize = 12;

/// Error of a length, as a fraction of the longest bone, at which a fit ends.
const TOLERANCE: f64 = 1e-12;

/// A bone between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bone {
    /// Index of the point at its near end.
    pub from: usize,
    /// Index of the point at its far end.
    pub to: usize,
    /// The length, 0 or more, in the unit of the points.
    pub length: f64,
}

/// Moves points so that every bone has its length and the sum of the squared distances from where they were is least.
///
/// The bones form trees: no way along them ends where it began. A bone whose ends coincide goes along X. Points that
/// are not finite are left as they are, and so are all points that bones connect with them.
pub fn fit_bones(points: &mut [DVec3], bones: &[Bone]) {
    let finite: Vec<Bone> = connected_to_finite(points, bones);
    let Some(longest) = finite.iter().map(|bone| bone.length).reduce(f64::max) else {
        return;
    };
    let measured = points.to_vec();
    for _ in 0..MAX_STEPS {
        let directions: Vec<DVec3> = finite
            .iter()
            .map(|bone| (points[bone.to] - points[bone.from]).normalize_or(DVec3::X))
            .collect();
        // Of the points with bones along these directions that have their lengths, the ones next to those measured:
        // x = m − Jᵀλ with J Jᵀ λ = J m − lengths.
        let mut tensions: Vec<f64> = finite
            .iter()
            .zip(&directions)
            .map(|(bone, direction)| {
                (measured[bone.to] - measured[bone.from]).dot(*direction) - bone.length
            })
            .collect();
        solve_positive(&mut normal_matrix(&finite, &directions), &mut tensions);
        points.copy_from_slice(&measured);
        for ((bone, direction), tension) in finite.iter().zip(&directions).zip(&tensions) {
            points[bone.to] -= *tension * *direction;
            points[bone.from] += *tension * *direction;
        }
        let error = |bone: &Bone| (points[bone.to].distance(points[bone.from]) - bone.length).abs();
        if finite.iter().all(|bone| error(bone) <= TOLERANCE * longest) {
            break;
        }
    }
    lay_out(points, &finite);
}

/// Returns the bones of trees whose points are all finite.
fn connected_to_finite(points: &[DVec3], bones: &[Bone]) -> Vec<Bone> {
    let mut is_finite: Vec<bool> = points.iter().map(|point| point.is_finite()).collect();
    for _ in 0..bones.len() {
        for bone in bones {
            let both = is_finite[bone.from] && is_finite[bone.to];
            (is_finite[bone.from], is_finite[bone.to]) = (both, both);
        }
    }
    let kept = bones.iter().filter(|bone| is_finite[bone.from]);
    kept.copied().collect()
}

/// Returns J Jᵀ, row by row: 2 for a bone with itself, and the cosine of the angle between two bones that meet, negative if
/// one begins where the other ends.
fn normal_matrix(bones: &[Bone], directions: &[DVec3]) -> Vec<f64> {
    let mut matrix = Vec::with_capacity(bones.len() * bones.len());
    for (one, along) in bones.iter().zip(directions) {
        for (other, other_along) in bones.iter().zip(directions) {
            let mut weight = 0.0;
            for (end, sign) in [(one.to, 1.0), (one.from, -1.0)] {
                weight += sign * f64::from(u8::from(end == other.to));
                weight -= sign * f64::from(u8::from(end == other.from));
            }
            matrix.push(weight * along.dot(*other_along));
        }
    }
    matrix
}

/// Solves a symmetric positive definite system by the decomposition of Cholesky. `matrix` is overwritten, and `values` become the
/// solution.
fn solve_positive(matrix: &mut [f64], values: &mut [f64]) {
    let size = values.len();
    for row in 0..size {
        for column in 0..=row {
            let products = (0..column)
                .map(|k| matrix[row * size + k] * matrix[column * size + k])
                .sum::<f64>();
            let rest = matrix[row * size + column] - products;
            matrix[row * size + column] = if row == column {
                // Bones in a tree are independent; rounding is not.
                rest.max(f64::EPSILON).sqrt()
            } else {
                rest / matrix[column * size + column]
            };
        }
        let products = (0..row)
            .map(|k| matrix[row * size + k] * values[k])
            .sum::<f64>();
        values[row] = (values[row] - products) / matrix[row * size + row];
    }
    for row in (0..size).rev() {
        let products = (row + 1..size)
            .map(|k| matrix[k * size + row] * values[k])
            .sum::<f64>();
        values[row] = (values[row] - products) / matrix[row * size + row];
    }
}

/// Gives every bone exactly its length, from the first bone on: what is left is far below the noise, but adds up in files.
fn lay_out(points: &mut [DVec3], bones: &[Bone]) {
    let before = points.to_vec();
    let mut shift = vec![DVec3::ZERO; points.len()];
    for bone in bones {
        let along = before[bone.to] - before[bone.from];
        let exact = along.normalize_or(DVec3::X) * bone.length;
        shift[bone.to] = shift[bone.from] + exact - along;
        points[bone.to] = before[bone.to] + shift[bone.to];
    }
}

/// Returns the median of some lengths; `None` if there is none.
pub fn median(lengths: &mut [f64]) -> Option<f64> {
    if lengths.is_empty() {
        return None;
    }
    let middle = lengths.len() / 2;
    let (_, median, _) = lengths.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trunk with two branches, one of them of three bones.
    fn bones() -> Vec<Bone> {
        let bone = |from, to, length| Bone { from, to, length };
        vec![
            bone(0, 1, 0.3),
            bone(1, 2, 0.26),
            bone(2, 3, 0.09),
            bone(2, 4, 0.08),
            bone(4, 5, 0.04),
        ]
    }

    fn point(random: &mut fastrand::Rng, size: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| size * (random.f64() - 0.5)))
    }

    /// Returns points that have the lengths.
    fn exact(random: &mut fastrand::Rng) -> Vec<DVec3> {
        let mut points = vec![point(random, 1.0); 6];
        for bone in bones() {
            points[bone.to] = points[bone.from] + point(random, 1.0).normalize() * bone.length;
        }
        points
    }

    fn cost(points: &[DVec3], measured: &[DVec3]) -> f64 {
        let pairs = points.iter().zip(measured);
        pairs
            .map(|(point, target)| point.distance_squared(*target))
            .sum()
    }

    #[test]
    fn fitted_bones_have_their_lengths_and_no_small_turn_is_nearer() {
        let mut random = fastrand::Rng::with_seed(9);
        for round in 0..200 {
            let mut measured = exact(&mut random);
            for position in &mut measured {
                *position += point(&mut random, 0.01);
            }
            let mut fitted = measured.clone();
            fit_bones(&mut fitted, &bones());
            for bone in bones() {
                let length = fitted[bone.to].distance(fitted[bone.from]);
                assert!((length - bone.length).abs() < 1e-12, "{round}: {length}");
            }
            let least = cost(&fitted, &measured);
            // Turning a bone with all beyond it, or moving all, keeps the lengths.
            for bone in bones() {
                for _ in 0..8 {
                    let turn = glam::DQuat::from_scaled_axis(point(&mut random, 1e-3));
                    let (center, mut moved) = (fitted[bone.from], fitted.clone());
                    for index in beyond(bone.to) {
                        moved[index] = center + turn * (fitted[index] - center);
                    }
                    assert!(cost(&moved, &measured) >= least - 1e-12, "{round}");
                    let shift = point(&mut random, 1e-4);
                    let shifted: Vec<DVec3> = fitted.iter().map(|point| *point + shift).collect();
                    assert!(cost(&shifted, &measured) >= least - 1e-12, "{round}");
                }
            }
        }
    }

    fn beyond(point: usize) -> Vec<usize> {
        let next = bones().into_iter().filter(|bone| bone.from == point);
        let further = next.flat_map(|bone| beyond(bone.to));
        [point].into_iter().chain(further).collect()
    }

    #[test]
    fn points_that_fit_stay_and_those_that_are_not_finite_disturb_no_other_tree() {
        let mut random = fastrand::Rng::with_seed(2);
        let exact = exact(&mut random);
        let mut fitted = exact.clone();
        fit_bones(&mut fitted, &bones());
        assert!(cost(&fitted, &exact) < 1e-24);
        let mut points = exact.clone();
        points[5] = DVec3::NAN;
        points.extend([DVec3::ZERO, DVec3::X]);
        let mut bones = bones();
        bones.push(Bone {
            from: 6,
            to: 7,
            length: 0.5,
        });
        fit_bones(&mut points, &bones);
        assert_eq!(points[..5], exact[..5]);
        assert!(cost(&points[6..], &[DVec3::X * 0.25, DVec3::X * 0.75]) < 1e-24);
        let mut coincident = vec![DVec3::Y; 2];
        fit_bones(
            &mut coincident,
            &[Bone {
                from: 0,
                to: 1,
                length: 1.0,
            }],
        );
        assert_eq!(coincident[0].distance(coincident[1]), 1.0);
    }
}
