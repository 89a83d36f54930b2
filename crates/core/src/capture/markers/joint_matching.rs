//! Markers from the observations of all cameras, matched jointly.

use arrayvec::ArrayVec;
use glam::DVec3;

use super::assignment::{CostMatrix, assign};
use super::candidates::{candidates, pick};
use super::ray::{Ray, gap_in_front};
use super::triangulation::triangulate;

/// Most cameras that are matched.
pub const MAX_CAMERAS: usize = 16;

/// Noise of a ray, as a fraction of the largest gap.
const NOISE: f64 = 0.05;

/// Largest cost of a point that is not where a marker was expected: five standard deviations. An unexpected movement
/// of a marker costs no more.
const UNEXPECTED: f64 = 12.5;

/// Worth of a ray that a marker explains: the cost of one that passes it at half of the largest gap.
pub(super) const RAY_WORTH: f64 = 0.125 / (NOISE * NOISE);

/// Difference of cost, three standard deviations, below which two ways to match the same rays cannot be told apart.
const MARGIN: f64 = 4.5;

/// Standard deviations within which a marker is looked for where it is expected.
const GATE: f64 = 4.0;

/// Rounds in which the rays of each camera are matched again with the markers that the others show.
const ROUNDS: usize = 2;

/// Most comparisons of a ray with a group of rays in a step. A crowd that takes more is not matched again, and what is new in it
/// counts as ambiguous.
const MAX_COMPARISONS: usize = 1 << 17;

/// A marker in the image of one camera.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// The name, if the camera's software knows it.
    pub label: Option<&'a str>,
    /// The line of sight.
    pub ray: Ray,
}

/// A position at which a marker is expected.
#[derive(Clone, Copy, Debug)]
pub struct Expected<'a> {
    /// The name of the marker, if it has one.
    pub label: Option<&'a str>,
    /// The position.
    pub point: DVec3,
    /// The standard deviation of the position.
    pub deviation: f64,
}

/// A camera and the index of one of its observations.
pub(super) type Seen = (usize, usize);

/// A marker that two or more cameras see.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchedMarker<'a> {
    /// The name, from any of the cameras.
    pub label: Option<&'a str>,
    /// The point that is nearest to its rays.
    pub point: DVec3,
    /// `true` if its rays fit other markers as well, and it is not where one was expected.
    pub is_ambiguous: bool,
}

/// Rays that are matched to one marker.
#[derive(Clone, Debug)]
pub(super) struct Group<'a> {
    pub label: Option<&'a str>,
    pub seen: ArrayVec<Seen, MAX_CAMERAS>,
    /// Rays at the start of `seen` that their label ties to the marker.
    pub tied: usize,
}

/// The point of some rays, and what it costs to take them for one marker: half of the squared distances in standard deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub point: DVec3,
    pub cost: f64,
}

/// The observations of one instant.
pub struct Matching<'a> {
    pub(super) cameras: &'a [Vec<Observation<'a>>],
    expected: &'a [Expected<'a>],
    pub(super) max_gap: f64,
    /// Observations that belong to a marker, or whose label is wrong.
    pub(super) is_used: Vec<Vec<bool>>,
}

/// Returns the markers that two or more of the first [`MAX_CAMERAS`] cameras see.
///
/// Observations with one label are of one marker; of three or more, those that do not fit are left out. All others are matched
/// jointly: groups of rays, at most one per camera, that pass each other within `max_gap`, so that as many rays as possible
/// with the least squared distances are explained, and markers are where they were expected. A marker that is expected where each
/// camera sees one ray at most is taken first. The result depends on the order
/// of cameras and observations only where costs are equal. The work is bounded by the numbers of both.
pub fn match_cameras<'a>(
    cameras: &'a [Vec<Observation<'a>>],
    expected: &'a [Expected<'a>],
    max_gap: f64,
) -> Vec<MatchedMarker<'a>> {
    let cameras = &cameras[..cameras.len().min(MAX_CAMERAS)];
    let is_used = cameras.iter().map(|seen| vec![false; seen.len()]).collect();
    let mut matching = Matching {
        cameras,
        expected,
        max_gap,
        is_used,
    };
    let mut groups = matching.labelled();
    matching.take_expected(&mut groups);
    for camera in 0..cameras.len() {
        matching.extend(&mut groups, camera, true);
    }
    groups.extend(pick(candidates(&matching), &mut matching));
    let rounds = if matching.is_crowd(&groups) {
        0
    } else {
        ROUNDS
    };
    for _ in 0..rounds {
        for camera in 0..cameras.len() {
            matching.extend(&mut groups, camera, false);
        }
    }
    matching.finish(&groups)
}

impl<'a> Matching<'a> {
    pub(super) fn observation(&self, (camera, index): Seen) -> &Observation<'a> {
        &self.cameras[camera][index]
    }

    fn set_used(&mut self, (camera, index): Seen, is_used: bool) {
        self.is_used[camera][index] = is_used;
    }

    pub(super) fn use_all(&mut self, seen: &[Seen]) {
        for &sighting in seen {
            self.set_used(sighting, true);
        }
    }

    /// Returns the observations of a camera that belong to no marker.
    pub(super) fn free(&self, camera: usize) -> impl Iterator<Item = Seen> + '_ {
        let used = self.is_used[camera].iter().enumerate();
        used.filter_map(move |(index, is_used)| (!is_used).then_some((camera, index)))
    }

    /// Returns `true` if there are too many rays to compare all of them.
    fn is_crowd(&self, groups: &[Group]) -> bool {
        let cameras = self.cameras.len();
        let free: usize = (0..cameras).map(|camera| self.free(camera).count()).sum();
        let all = groups.len() + free;
        all * all * cameras > MAX_COMPARISONS
    }

    /// Returns the point of rays that may be of one marker.
    pub(super) fn fit(&self, seen: &[Seen], label: Option<&str>) -> Option<Fit> {
        let rays: ArrayVec<Ray, MAX_CAMERAS> = seen
            .iter()
            .map(|&seen| self.observation(seen).ray)
            .collect();
        let found = triangulate(&rays).ok()?;
        if found.gap > self.max_gap {
            return None;
        }
        let distance = |ray: &Ray| {
            ray.at(ray.nearest(found.point))
                .distance_squared(found.point)
        };
        let squared: f64 = rays.iter().map(distance).sum();
        let noise = NOISE * self.max_gap;
        Some(Fit {
            point: found.point,
            cost: squared / (2.0 * noise * noise) + self.surprise(found.point, label),
        })
    }

    /// Returns the cost of a marker at a point, 0 where one was expected.
    fn surprise(&self, point: DVec3, label: Option<&str>) -> f64 {
        let mut least = UNEXPECTED;
        for expected in self.expected {
            if expected.label.is_some() && label.is_some() && expected.label != label {
                continue;
            }
            let squared = expected.point.distance_squared(point);
            least = least.min(squared / (2.0 * expected.deviation * expected.deviation));
        }
        least
    }

    /// Returns the groups of observations with the same label in two or more images.
    fn labelled(&mut self) -> Vec<Group<'a>> {
        let mut groups: Vec<Group<'a>> = Vec::new();
        for (camera, observations) in self.cameras.iter().enumerate() {
            for (index, observation) in observations.iter().enumerate() {
                let Some(label) = observation.label else {
                    continue;
                };
                let seen = (camera, index);
                let known = groups.iter_mut().find(|group| group.label == Some(label));
                match known {
                    Some(group) if group.seen.last().is_some_and(|last| last.0 != camera) => {
                        group.seen.push(seen);
                    }
                    // The same label twice in one image.
                    Some(_) => self.is_used[camera][index] = true,
                    None => groups.push(Group {
                        label: Some(label),
                        seen: [seen].into_iter().collect(),
                        tied: 0,
                    }),
                }
            }
        }
        groups.retain(|group| group.seen.len() > 1);
        for group in &mut groups {
            self.use_all(&group.seen);
            self.drop_outliers(group);
            group.tied = group.seen.len();
        }
        groups.retain(|group| group.seen.len() > 1);
        groups
    }

    /// Leaves out the rays without which the others fit best, until they do. The ray with the largest distance need not be the
    /// wrong one: that pulls the point towards itself.
    fn drop_outliers(&self, group: &mut Group) {
        while group.seen.len() > 1 && self.fit(&group.seen, group.label).is_none() {
            let gap_without = |index: usize| {
                let others = group.seen.iter().enumerate();
                let others = others.filter(|(other, _)| *other != index);
                let rays: ArrayVec<Ray, MAX_CAMERAS> = others
                    .map(|(_, &seen)| self.observation(seen).ray)
                    .collect();
                triangulate(&rays).map_or(f64::INFINITY, |found| found.gap)
            };
            let gaps = (0..group.seen.len()).map(|index| (index, gap_without(index)));
            let best = gaps.min_by(|(_, one), (_, other)| one.total_cmp(other));
            group.seen.remove(best.map_or(0, |(index, _)| index));
        }
    }

    /// Matches the markers that are at their expected position, apart from all others, and seen by two or more cameras.
    fn take_expected(&mut self, groups: &mut Vec<Group<'a>>) {
        let noise = NOISE * self.max_gap;
        let mut gates_of = self
            .cameras
            .iter()
            .map(|seen| vec![0_u32; seen.len()])
            .collect::<Vec<_>>();
        let mut in_gates: Vec<ArrayVec<Seen, MAX_CAMERAS>> = Vec::new();
        for expected in self.expected {
            let gate = GATE * (expected.deviation + noise);
            let mut in_gate = ArrayVec::new();
            let mut is_apart = true;
            for (camera, gates) in gates_of.iter_mut().enumerate() {
                let mut hits = 0;
                for (index, observation) in self.cameras[camera].iter().enumerate() {
                    let ray = &observation.ray;
                    if !ray.passes(expected.point, gate) || ray.nearest(expected.point) <= 0.0 {
                        continue;
                    }
                    gates[index] += 1;
                    hits += 1;
                    if hits == 1 {
                        in_gate.push((camera, index));
                    }
                }
                is_apart &= hits <= 1;
            }
            if !is_apart {
                in_gate.clear();
            }
            in_gates.push(in_gate);
        }
        for (expected, seen) in self.expected.iter().zip(in_gates) {
            let is_alone = |&(camera, index): &Seen| {
                gates_of[camera][index] == 1 && !self.is_used[camera][index]
            };
            if seen.len() < 2 || !seen.iter().all(is_alone) {
                continue;
            }
            let mut labels = seen.iter().filter_map(|&seen| self.observation(seen).label);
            let label = labels.next();
            let is_other = |other: &str| expected.label.is_some_and(|wanted| wanted != other);
            if labels.any(|other| Some(other) != label) || label.is_some_and(is_other) {
                continue;
            }
            let is_good = |fit: Fit| fit.cost <= MARGIN * seen.len() as f64;
            if self
                .fit(&seen, label.or(expected.label))
                .is_some_and(is_good)
            {
                self.use_all(&seen);
                let tied = seen.len();
                groups.push(Group { label, seen, tied });
            }
        }
    }

    /// Matches the observations of a camera that are not tied to a marker with the markers that the other cameras show, and with
    /// the observations of these that belong to none unless `only_groups`.
    fn extend(&mut self, groups: &mut Vec<Group<'a>>, camera: usize, only_groups: bool) {
        for group in groups.iter_mut() {
            let is_free = |&(index, seen): &(usize, &Seen)| index >= group.tied && seen.0 == camera;
            let found = group.seen.iter().enumerate().find(is_free);
            if let Some((index, &seen)) = found {
                group.seen.remove(index);
                self.set_used(seen, false);
            }
            if !group.seen[..group.tied].iter().any(|seen| seen.0 == camera) {
                group.label = group
                    .seen
                    .iter()
                    .find_map(|&seen| self.observation(seen).label);
            }
        }
        let is_open = |group: &Group| !group.seen.iter().any(|seen| seen.0 == camera);
        let mut rows: Vec<Group<'a>> = Vec::new();
        groups.retain(|group| {
            let is_open = is_open(group);
            if is_open {
                rows.push(group.clone());
            }
            !is_open
        });
        if !only_groups {
            let others = (0..self.cameras.len()).filter(|&other| other != camera);
            for seen in others.flat_map(|other| self.free(other)) {
                rows.push(Group {
                    label: self.observation(seen).label,
                    seen: [seen].into_iter().collect(),
                    tied: 0,
                });
            }
        }
        let columns: Vec<Seen> = self.free(camera).collect();
        let alone: Vec<Option<Fit>> = rows
            .iter()
            .map(|row| self.fit(&row.seen, row.label))
            .collect();
        let costs = CostMatrix::new(rows.len(), columns.len(), |row, column| {
            self.added_cost(&rows[row], alone[row], columns[column])
        });
        for (mut group, column) in rows.into_iter().zip(assign(&costs)) {
            if let Some(column) = column {
                group.seen.push(columns[column]);
                let label = group.label.or(self.observation(columns[column]).label);
                match self.fit(&group.seen, label) {
                    Some(_) => group.label = label,
                    None => {
                        group.seen.pop();
                    }
                }
            }
            let is_marker = group.seen.len() > 1;
            for &seen in &group.seen {
                self.set_used(seen, is_marker);
            }
            if is_marker {
                groups.push(group);
            }
        }
    }

    /// Returns what one more ray adds to the cost of a group, 0 or more; `None` if it may not be of the same marker.
    fn added_cost(&self, group: &Group, alone: Option<Fit>, seen: Seen) -> Option<f64> {
        let observation = self.observation(seen);
        if group.label.is_some() && observation.label.is_some() {
            return None;
        }
        let count = group.seen.len() as f64;
        let cost = match (&group.seen[..], alone) {
            ([only], _) => {
                let first = self.observation(*only).ray;
                gap_in_front(&first, &observation.ray, self.max_gap)?;
                self.fit(&[*only, seen], group.label.or(observation.label))?
                    .cost
            }
            (_, Some(fit)) if observation.ray.passes(fit.point, self.max_gap) => {
                let k = observation.ray.nearest(fit.point);
                let noise = NOISE * self.max_gap;
                let squared = observation.ray.at(k).distance_squared(fit.point);
                // The point gives way to the new ray.
                (k > 0.0).then_some(squared * count / (count + 1.0) / (2.0 * noise * noise))?
            }
            _ => return None,
        };
        let new_rays = if alone.is_some() { 1.0 } else { 2.0 };
        (cost <= RAY_WORTH * new_rays + UNEXPECTED).then_some(cost)
    }

    /// Returns the markers of the groups.
    fn finish(&self, groups: &[Group<'a>]) -> Vec<MatchedMarker<'a>> {
        let fits: Vec<Option<Fit>> = groups
            .iter()
            .map(|group| self.fit(&group.seen, group.label))
            .collect();
        let is_crowd = self.is_crowd(groups);
        let mut markers = Vec::new();
        for (index, group) in groups.iter().enumerate() {
            let Some(fit) = fits[index] else {
                continue;
            };
            let is_new = self.surprise(fit.point, group.label) >= UNEXPECTED;
            markers.push(MatchedMarker {
                label: group.label,
                point: fit.point,
                is_ambiguous: is_new && (is_crowd || self.is_ambiguous(groups, &fits, index)),
            });
        }
        markers
    }

    /// Returns `true` if the group could have another ray of one of its cameras, and lie elsewhere, at nearly the same cost.
    fn is_ambiguous(&self, groups: &[Group], fits: &[Option<Fit>], index: usize) -> bool {
        let group = &groups[index];
        let Some(fit) = fits[index] else {
            return false;
        };
        group
            .seen
            .iter()
            .enumerate()
            .skip(group.tied)
            .any(|(place, &own)| {
                let others = (0..self.cameras[own.0].len()).map(|other| (own.0, other));
                others.filter(|&other| other != own).any(|other| {
                    let Some(changed) = self.fit_with(group, place, other) else {
                        return false;
                    };
                    if changed.point.distance(fit.point) <= self.max_gap {
                        return false;
                    }
                    let owner = groups.iter().enumerate().find_map(|(number, rival)| {
                        let rival_place = rival.seen.iter().position(|&seen| seen == other)?;
                        Some((number, rival_place))
                    });
                    match owner {
                        None => !self.is_used[other.0][other.1] && changed.cost < fit.cost + MARGIN,
                        Some((number, rival_place)) if rival_place >= groups[number].tied => {
                            let before = fits[number].map_or(0.0, |rival_fit| rival_fit.cost);
                            self.fit_with(&groups[number], rival_place, own)
                                .is_some_and(|swapped| {
                                    changed.cost + swapped.cost < fit.cost + before + MARGIN
                                })
                        }
                        Some(_) => false,
                    }
                })
            })
    }

    /// Returns the fit of a group with one of its rays replaced.
    fn fit_with(&self, group: &Group, place: usize, seen: Seen) -> Option<Fit> {
        let mut changed = group.seen.clone();
        changed[place] = seen;
        let mut labels = changed
            .iter()
            .filter_map(|&sighting| self.observation(sighting).label);
        let label = labels.next();
        if labels.any(|other| Some(other) != label) {
            return None;
        }
        self.fit(&changed, label)
    }
}
