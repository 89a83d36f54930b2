//! Groups of rays that may be of one marker, and the best ones of them that share no ray.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::joint_matching::{Fit, Group, Matching, RAY_WORTH, Seen};
use super::ray::{closest_points, gap_in_front};

/// Most pairs of rays from which groups are built: the nearest ones.
const MAX_PAIRS: usize = 4096;

/// Group of rays with its gain: the worth of its rays without its cost. Ordered by it.
#[derive(Clone, Debug)]
pub(super) struct Candidate<'a> {
    group: Group<'a>,
    gain: f64,
}

impl Ord for Candidate<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.gain.total_cmp(&other.gain)
    }
}

impl PartialOrd for Candidate<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate<'_> {}

/// Returns the groups that grow from every pair of rays of two cameras that belong to no marker yet.
pub(super) fn candidates<'a>(matching: &Matching<'a>) -> BinaryHeap<Candidate<'a>> {
    let grown = pairs(matching).into_iter().map(|pair| grow(matching, pair));
    grown
        .filter_map(|group| candidate(matching, group))
        .collect()
}

/// Takes candidates in the order of their gain. One that has lost rays to those before it is taken without them, in the order
/// of the gain that is left.
pub(super) fn pick<'a>(
    mut candidates: BinaryHeap<Candidate<'a>>,
    matching: &mut Matching<'a>,
) -> Vec<Group<'a>> {
    let mut picked = Vec::new();
    while let Some(best) = candidates.pop() {
        let is_used = |&(camera, index): &Seen| matching.is_used[camera][index];
        if !best.group.seen.iter().any(is_used) {
            matching.use_all(&best.group.seen);
            picked.push(best.group);
            continue;
        }
        let seen = best.group.seen.into_iter().filter(|seen| !is_used(seen));
        let rest = group(matching, seen.collect());
        if rest.seen.len() > 1
            && let Some(rest) = candidate(matching, rest)
        {
            candidates.push(rest);
        }
    }
    picked
}

fn pairs(matching: &Matching) -> Vec<[Seen; 2]> {
    let count = matching.cameras.len();
    let mut pairs = Vec::new();
    for camera in 0..count {
        for other_camera in camera + 1..count {
            for seen in matching.free(camera) {
                let one = matching.observation(seen);
                for other_seen in matching.free(other_camera) {
                    let other = matching.observation(other_seen);
                    if one.label.is_some() && other.label.is_some() {
                        continue;
                    }
                    if let Some(gap) = gap_in_front(&one.ray, &other.ray, matching.max_gap) {
                        pairs.push((gap, [seen, other_seen]));
                    }
                }
            }
        }
    }
    if pairs.len() > MAX_PAIRS {
        pairs.sort_by(|one, other| one.0.total_cmp(&other.0));
        pairs.truncate(MAX_PAIRS);
    }
    pairs.into_iter().map(|(_, pair)| pair).collect()
}

/// Adds to a pair the nearest ray of each other camera.
fn grow<'a>(matching: &Matching<'a>, pair: [Seen; 2]) -> Group<'a> {
    let mut grown = group(matching, pair.into_iter().collect());
    let [first, second] = pair.map(|seen| matching.observation(seen).ray);
    let Ok(closest) = closest_points(&first, &second) else {
        return grown;
    };
    let mut point = closest.midpoint();
    for camera in 0..matching.cameras.len() {
        if pair.iter().any(|seen| seen.0 == camera) {
            continue;
        }
        let mut nearest = (matching.max_gap / 2.0, None);
        for seen in matching.free(camera) {
            let observation = matching.observation(seen);
            if grown.label.is_some() && observation.label.is_some() {
                continue;
            }
            let ray = observation.ray;
            let k = ray.nearest(point);
            if k > 0.0 && ray.passes(point, nearest.0) {
                let distance = ray.at(k).distance(point);
                if distance < nearest.0 {
                    nearest = (distance, Some(seen));
                }
            }
        }
        let Some(seen) = nearest.1 else {
            continue;
        };
        grown.seen.push(seen);
        match matching.fit(&grown.seen, grown.label) {
            Some(fit) => {
                point = fit.point;
                grown.label = grown.label.or(matching.observation(seen).label);
            }
            None => {
                grown.seen.pop();
            }
        }
    }
    grown
}

fn group<'a>(
    matching: &Matching<'a>,
    seen: arrayvec::ArrayVec<Seen, { super::MAX_CAMERAS }>,
) -> Group<'a> {
    let label = seen
        .iter()
        .find_map(|&seen| matching.observation(seen).label);
    Group {
        label,
        seen,
        tied: 0,
    }
}

fn candidate<'a>(matching: &Matching<'a>, group: Group<'a>) -> Option<Candidate<'a>> {
    let Fit { cost, .. } = matching.fit(&group.seen, group.label)?;
    let gain = group.seen.len() as f64 * RAY_WORTH - cost;
    Some(Candidate { group, gain })
}
