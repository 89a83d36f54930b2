//! The pairs of observations of two cameras that show the same marker.

use super::assignment::{CostMatrix, assign};
use super::ray::{Ray, gap_in_front};

/// Returns, for each ray of the first camera, the index of the ray of the second camera that shows the same marker.
///
/// Rays may pair if they are not parallel, come closest in front of both cameras and pass each other within `max_gap`.
/// Among the allowed pairs, the most are taken, and among these the ones with the least total gap. Each ray is used at
/// most once.
pub fn match_rays(first: &[Ray], second: &[Ray], max_gap: f64) -> Vec<Option<usize>> {
    if second.is_empty() {
        return vec![None; first.len()];
    }
    assign(&CostMatrix::new(
        first.len(),
        second.len(),
        |row, column| gap_in_front(&first[row], &second[column], max_gap),
    ))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_marker_that_one_camera_does_not_see_has_no_pair() {
        let markers = [
            DVec3::new(0.0, 0.0, 0.0),
            DVec3::new(0.1, 0.05, 0.0),
            DVec3::new(-0.1, 0.2, 0.1),
        ];
        let rays = |camera: DVec3, seen: &[usize]| -> Vec<Ray> {
            let through = |&index: &usize| Ray::through(camera, markers[index]);
            seen.iter().map(through).collect()
        };
        let first = rays(DVec3::new(2.0, 0.3, 2.0), &[2, 0, 1]);
        let second = rays(DVec3::new(-2.0, 0.1, 2.0), &[1, 2]);
        assert_eq!(match_rays(&first, &second, 0.005), [Some(1), None, Some(0)]);
        assert_eq!(match_rays(&first, &[], 0.005), [None; 3]);
        assert_eq!(match_rays(&[], &second, 0.005), []);
    }
}
