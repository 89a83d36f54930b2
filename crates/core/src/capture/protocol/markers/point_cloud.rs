//! Markers in space, from the observations of all cameras.

use glam::DVec3;

use crate::capture::markers::{CostMatrix, Ray, assign, gap_in_front, triangulate};

/// A marker in the image of one camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observation<'a> {
    /// The name, if the camera's software knows it.
    pub label: Option<&'a str>,
    /// The line of sight.
    pub ray: Ray,
}

/// Markers with the rays of the cameras that see them.
#[derive(Clone, Debug, Default)]
pub(super) struct PointCloud {
    markers: Vec<Marker>,
}

#[derive(Clone, Debug)]
struct Marker {
    label: Option<String>,
    rays: Vec<Ray>,
}

impl PointCloud {
    pub fn clear(&mut self) {
        self.markers.clear();
    }

    /// Adds the observations of one more camera. Those whose label an earlier camera used belong to that marker. The
    /// others are matched by the distance of their rays, at most `max_gap`: the most pairs, then the least total distance.
    pub fn add_camera(&mut self, observations: &[Observation], max_gap: f64) {
        let known = self.markers.len();
        let mut unmatched = Vec::new();
        let mut is_free = vec![true; known];
        for observation in observations {
            let known_index = observation.label.and_then(|label| {
                let same = |marker: &Marker| marker.label.as_deref() == Some(label);
                self.markers[..known].iter().position(same)
            });
            match known_index {
                Some(index) if is_free[index] => {
                    is_free[index] = false;
                    self.markers[index].rays.push(observation.ray);
                }
                // The same label twice in one image.
                Some(_) => {}
                None => unmatched.push(*observation),
            }
        }
        let free: Vec<usize> = (0..known).filter(|&index| is_free[index]).collect();
        let places: Vec<Place> = free
            .iter()
            .map(|&index| self.markers[index].place())
            .collect();
        let costs = CostMatrix::new(unmatched.len(), free.len(), |row, column| {
            let observation = &unmatched[row];
            if observation.label.is_some() && self.markers[free[column]].label.is_some() {
                return None;
            }
            places[column].gap(&observation.ray, max_gap)
        });
        let mut columns = assign(&costs);
        columns.resize(unmatched.len(), None);
        for (observation, column) in unmatched.iter().zip(columns) {
            let label = observation.label.map(str::to_owned);
            match column {
                Some(column) => {
                    let marker = &mut self.markers[free[column]];
                    marker.rays.push(observation.ray);
                    marker.label = marker.label.take().or(label);
                }
                None => self.markers.push(Marker {
                    label,
                    rays: vec![observation.ray],
                }),
            }
        }
    }

    /// Returns the label and the position of each marker that two cameras see in front of them, with rays that pass
    /// within `max_gap`. Of three or more rays, the one without which the others fit best is left out until they do.
    pub fn positions(&self, max_gap: f64) -> impl Iterator<Item = (Option<&str>, DVec3)> + '_ {
        self.markers.iter().filter_map(move |marker| {
            let position = marker.position(max_gap)?;
            Some((marker.label.as_deref(), position))
        })
    }
}

/// The knowledge of where a marker is, before the next camera.
enum Place {
    /// Somewhere along the only ray.
    Along(Ray),
    /// At the point of two or more rays.
    At(DVec3),
    /// Its rays determine no point.
    Nowhere,
}

impl Place {
    /// Returns the distance of a ray: that of two rays, or twice that from a point. `None` if it is more than `max_gap`, or
    /// if the ray does not lead to the marker in front of the camera.
    fn gap(&self, ray: &Ray, max_gap: f64) -> Option<f64> {
        let gap = match self {
            Self::Along(only) => return gap_in_front(only, ray, max_gap),
            Self::At(point) if !ray.passes(*point, max_gap / 2.0) => return None,
            Self::At(point) => {
                let k = ray.nearest(*point);
                (k > 0.0).then(|| 2.0 * ray.at(k).distance(*point))?
            }
            Self::Nowhere => return None,
        };
        (gap <= max_gap).then_some(gap)
    }
}

impl Marker {
    fn place(&self) -> Place {
        match (&self.rays[..], triangulate(&self.rays)) {
            ([only], _) => Place::Along(*only),
            (_, Ok(found)) => Place::At(found.point),
            (_, Err(_)) => Place::Nowhere,
        }
    }

    fn position(&self, max_gap: f64) -> Option<DVec3> {
        let mut rays = self.rays.clone();
        loop {
            if let Ok(found) = triangulate(&rays)
                && found.gap <= max_gap
            {
                return Some(found.point);
            }
            if rays.len() <= 2 {
                return None;
            }
            // The ray with the largest distance need not be the wrong one: that pulls the point towards itself.
            let gaps = (0..rays.len()).map(|index| gap_without(&rays, index));
            let best = gaps
                .enumerate()
                .min_by(|(_, one), (_, other)| one.total_cmp(other));
            let (index, _) = best?;
            rays.remove(index);
        }
    }
}

/// Returns the largest distance that remains without one ray; infinite if the others determine no point.
fn gap_without(rays: &[Ray], index: usize) -> f64 {
    let mut others = rays.to_vec();
    others.remove(index);
    triangulate(&others).map_or(f64::INFINITY, |found| found.gap)
}
