//! Markers over time: each keeps its name while it is followed.

use glam::DVec3;

use super::assignment::{CostMatrix, assign};
use super::joint_matching::{Expected, MatchedMarker, Observation, match_cameras};

/// Longest time in seconds for which a hidden marker is predicted.
const BRIDGE: f64 = 0.1;

/// Longest time in seconds after which a marker that reappears counts as the same marker.
const MEMORY: f64 = 0.3;

/// Most markers that are followed. The ones that were seen last stay.
const MAX_TRACKS: usize = 256;

/// Standard deviation in metres of a measured position, and of a prediction for the same instant.
const NEAR_DEVIATION: f64 = 0.002;

/// Standard deviation of the acceleration of a marker, in m/s².
const ACCELERATION: f64 = 10.0;

/// The fraction of the change of velocity that each new position contributes.
const VELOCITY_GAIN: f64 = 0.6;

/// Number of standard deviations within which a marker continues a track.
const GATE: f64 = 5.0;

/// A marker at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedMarker<'a> {
    /// The unique number of the marker.
    pub id: u64,
    /// The name, if a camera has ever stated it.
    pub label: Option<&'a str>,
    /// The position.
    pub position: DVec3,
    /// `true` if fewer than two cameras see the marker, so that its position continues its motion.
    pub is_predicted: bool,
}

/// The markers that are followed.
///
/// The observations of each instant are [matched](match_cameras) with the markers at their predicted positions, so that markers whose
/// rays cross are not confused. A marker has the label that a camera states, and keeps it in lines that state none.
#[derive(Clone, Debug)]
pub struct MarkerTracker {
    max_gap: f64,
    metre: f64,
    tracks: Vec<Track>,
    seconds: f64,
    next_id: u64,
}

#[derive(Clone, Debug)]
struct Track {
    id: u64,
    label: Option<String>,
    position: DVec3,
    /// The velocity, in units per second; unknown after the first position.
    velocity: Option<DVec3>,
    /// The time at which it was seen last, in seconds.
    seen: f64,
}

impl MarkerTracker {
    /// Creates a tracker for rays of one marker that pass each other within `max_gap`, where a metre has `metre` units.
    pub fn new(max_gap: f64, metre: f64) -> Self {
        Self {
            max_gap,
            metre,
            tracks: Vec::new(),
            seconds: f64::NEG_INFINITY,
            next_id: 0,
        }
    }

    /// Forgets all markers, after an interruption.
    pub fn reset(&mut self) {
        self.tracks.clear();
        self.seconds = f64::NEG_INFINITY;
    }

    /// Adds the observations of all cameras at a time in seconds, later than the time before. An earlier time starts again.
    pub fn update(&mut self, seconds: f64, cameras: &[Vec<Observation>]) {
        if seconds < self.seconds {
            self.reset();
        }
        self.seconds = seconds;
        self.tracks.retain(|track| seconds - track.seen <= MEMORY);
        let known: Vec<Track> = self.tracks.clone();
        let expected: Vec<Expected> = known
            .iter()
            .filter(|track| seconds - track.seen <= BRIDGE)
            .map(|track| Expected {
                label: track.label.as_deref(),
                point: track.at(seconds),
                deviation: self.deviation(track),
            })
            .collect();
        let mut markers = match_cameras(cameras, &expected, self.max_gap);
        // A marker that may be another one waits until it is unambiguous.
        markers.retain(|marker| !marker.is_ambiguous);
        let mut tracks = self.tracks_of(&markers);
        for (marker, track) in markers.iter().zip(&mut tracks) {
            let index = *track.get_or_insert_with(|| {
                self.tracks.push(Track::new(self.next_id, marker, seconds));
                self.next_id += 1;
                self.tracks.len() - 1
            });
            self.tracks[index].update(marker, seconds);
        }
        self.keep_labels_unique(&markers, &tracks);
        self.tracks.sort_by(|one, other| {
            let order = other.seen.total_cmp(&one.seen);
            order.then(one.id.cmp(&other.id))
        });
        self.tracks.truncate(MAX_TRACKS);
    }

    /// Returns the markers that are seen now, then those that are predicted.
    pub fn markers(&self) -> impl Iterator<Item = TrackedMarker<'_>> {
        let followed = self
            .tracks
            .iter()
            .filter(|track| self.seconds - track.seen <= BRIDGE);
        followed.map(|track| TrackedMarker {
            id: track.id,
            label: track.label.as_deref(),
            position: track.at(self.seconds),
            is_predicted: track.seen < self.seconds,
        })
    }

    fn deviation(&self, track: &Track) -> f64 {
        let time = self.seconds - track.seen;
        let speed = match track.velocity {
            Some(_) => 0.0,
            // Nothing is known about the motion yet.
            None => 1.0,
        };
        self.metre * (NEAR_DEVIATION + speed * time + 0.5 * ACCELERATION * time * time)
    }

    /// Returns the index of the track of each marker: the track with its name, or the track that leads to its position.
    fn tracks_of(&self, markers: &[MatchedMarker]) -> Vec<Option<usize>> {
        let named = |marker: &MatchedMarker| {
            let label = marker.label?;
            let is_same = |track: &Track| track.label.as_deref() == Some(label);
            self.tracks.iter().position(is_same)
        };
        let mut found: Vec<Option<usize>> = markers.iter().map(named).collect();
        let rest: Vec<usize> = (0..markers.len())
            .filter(|&index| found[index].is_none())
            .collect();
        let free: Vec<usize> = (0..self.tracks.len())
            .filter(|index| !found.contains(&Some(*index)))
            .collect();
        let costs = CostMatrix::new(rest.len(), free.len(), |row, column| {
            let (marker, track) = (&markers[rest[row]], &self.tracks[free[column]]);
            if marker.label.is_some() && track.label.is_some() {
                return None;
            }
            let distance = track.at(self.seconds).distance(marker.point);
            let is_near = distance <= GATE * self.deviation(track);
            is_near.then_some(distance * distance)
        });
        for (row, column) in assign(&costs).into_iter().enumerate() {
            found[rest[row]] = column.map(|column| free[column]);
        }
        found
    }

    /// Removes a label that a camera states for a marker from every other track.
    fn keep_labels_unique(&mut self, markers: &[MatchedMarker], tracks: &[Option<usize>]) {
        for (marker, track) in markers.iter().zip(tracks) {
            let Some(label) = marker.label else {
                continue;
            };
            for (index, other) in self.tracks.iter_mut().enumerate() {
                if Some(index) != *track && other.label.as_deref() == Some(label) {
                    other.label = None;
                }
            }
        }
    }
}

impl Track {
    fn new(id: u64, marker: &MatchedMarker, seconds: f64) -> Self {
        Self {
            id,
            label: marker.label.map(str::to_owned),
            position: marker.point,
            velocity: None,
            seen: seconds,
        }
    }

    /// Returns the predicted position at a time in seconds.
    fn at(&self, seconds: f64) -> DVec3 {
        let displacement = self.velocity.unwrap_or_default() * (seconds - self.seen);
        self.position + displacement
    }

    fn update(&mut self, marker: &MatchedMarker, seconds: f64) {
        let time = seconds - self.seen;
        if time > 0.0 {
            let now = (marker.point - self.position) / time;
            let velocity = self
                .velocity
                .map_or(now, |before| before.lerp(now, VELOCITY_GAIN));
            self.velocity = Some(velocity);
        }
        if self.label.is_none() {
            self.label = marker.label.map(str::to_owned);
        }
        self.position = marker.point;
        self.seen = seconds;
    }
}
