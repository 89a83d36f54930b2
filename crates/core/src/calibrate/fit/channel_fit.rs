//! The fit of one channel: its curvature and the lines of its rows.

use super::curvature::{self, Prior};
use super::weighted_line::{Line, Point, fit_line};
use crate::calibrate::observation::{Observations, PoseObservation};
use crate::calibrate::pose::CalibrationPose;
use crate::estimate::{AffineMap, ChannelMap, Linearity};
use crate::hand::Dof;

/// The smallest range of a working channel, as a fraction of the full scale: three counts of 255.
const DEAD: f64 = 0.012;

/// The smallest angle between two poses that shows a gain, in radians.
const MIN_ANGLE: f64 = 0.1;

/// The fit of one channel.
#[derive(Clone, Debug)]
pub(super) struct ChannelFit {
    /// The index of the channel.
    pub(super) channel: usize,
    /// The joint of the first row.
    pub(super) dof: Dof,
    /// The range of the medians of all poses; `None` if the channel was not measured.
    pub(super) range: Option<(f64, f64)>,
    /// `true` if the counts never change, although the poses move the joint.
    pub(super) is_dead: bool,
    /// `true` if the counts fall where the counts of the starting glove rise.
    pub(super) is_inverted: bool,
    /// The joints with a new calibration.
    pub(super) rows: Vec<(Dof, AffineMap)>,
    /// The curvature in counts over the full scale, if it is fitted. Otherwise the curvature of the starting glove remains.
    curvature: Option<f64>,
    linearity: Linearity,
}

impl ChannelFit {
    /// Fits a channel to the observations.
    pub(super) fn new(channel: usize, observations: &Observations, start: &ChannelMap) -> Self {
        let rows = || start.rows().iter().filter(|row| row.channel == channel);
        let dof = rows().next().map_or(Dof::ElbowFlexion, |row| row.dof);
        let range = observations.range(channel);
        let full_scale = f64::from(start.full_scale());
        let is_moved = rows().any(|row| {
            observations
                .poses()
                .iter()
                .any(|observed| moves(observed.pose, row.dof))
        });
        let is_constant = range.is_none_or(|(low, high)| high - low < DEAD * full_scale);
        let mut fit = Self {
            channel,
            dof,
            range,
            is_dead: is_constant && is_moved,
            is_inverted: false,
            rows: Vec::new(),
            curvature: None,
            linearity: start.linearity(channel),
        };
        if fit.is_dead || range.is_none() {
            return fit;
        }
        let Some(primary) =
            rows().find(|row| has_gain(&points(channel, row.dof, observations, true)))
        else {
            fit.rows = rows()
                .filter_map(|row| {
                    let straight = fit.points(row.dof, observations, true);
                    Some((row.dof, shifted(row.calibration, &straight)?))
                })
                .collect();
            return fit;
        };
        let defined = points(channel, primary.dof, observations, true);
        let gain = fit_line(&defined).map_or(0.0, |line| line.map.gain);
        fit.is_inverted = gain * primary.calibration.gain < 0.0;
        // A glove that was calibrated with exchanged wires counts in their direction; its curvature still shows them.
        let mut old = start.curvatures().iter();
        let was_exchanged = old.any(|(other, counts)| *other == channel && *counts < 0.0);
        let is_exchanged = fit.is_inverted != was_exchanged;
        let prior = Prior::for_sensor(start.uses_full_range(), is_exchanged);
        let curvature = curvature::estimate(&defined, prior);
        let (low, high) = curvature::range(&defined);
        if high > low {
            let counts = curvature::over_full_scale(curvature, (low, high), full_scale);
            fit.curvature = Some(counts);
            fit.linearity = Linearity::new(counts, start.full_scale());
        }
        fit.rows = rows()
            .filter_map(|row| {
                let line = fit.line(row.dof, observations)?;
                let row_points = points(channel, row.dof, observations, true);
                (has_gain(&row_points) && line.map.gain != 0.0).then_some((row.dof, line.map))
            })
            .collect();
        fit
    }

    /// Returns the channel and its curvature in counts, if it is fitted.
    pub(super) fn curvature(&self) -> Option<(usize, f64)> {
        // The file has two decimals.
        let counts = self.curvature.filter(|counts| counts.abs() >= 0.005)?;
        Some((self.channel, (counts * 100.0).round() / 100.0))
    }

    /// Returns `true` if the poses do not show a curvature, so that the curvature of the starting glove remains.
    pub(super) fn keeps_curvature(&self) -> bool {
        self.curvature.is_none()
    }

    /// Returns the line through the poses that define a joint.
    pub(super) fn line(&self, dof: Dof, observations: &Observations) -> Option<Line> {
        fit_line(&self.points(dof, observations, true))
    }

    /// Returns by how much the poses that define a joint disagree: the mean squared residual beyond the deviation between people,
    /// in units of four times it; 0 for two poses.
    pub(super) fn excess_misfit(&self, dof: Dof, observations: &Observations) -> f64 {
        let poses = points(self.channel, dof, observations, true).len();
        let line = self.line(dof, observations).filter(|_| poses > 2);
        line.map_or(0.0, |line| {
            (line.misfit / (poses - 2) as f64 - 1.0).max(0.0) / 4.0
        })
    }

    /// Returns the line through all poses, each with the deviation that the joint has in it.
    pub(super) fn line_of_all(&self, dof: Dof, observations: &Observations) -> Option<Line> {
        fit_line(&self.points(dof, observations, false))
    }

    /// Returns the linear count at which a dead sensor stays. `None` for other sensors, and if the channel was not measured.
    pub(super) fn dead_count(&self) -> Option<f64> {
        let (low, high) = self.range.filter(|_| self.is_dead)?;
        Some(self.linear(low.midpoint(high)))
    }

    /// Returns the linear count of a count.
    pub(super) fn linear(&self, count: f64) -> f64 {
        self.linearity.apply(count)
    }

    /// Returns the [`points`] of a joint with linear counts.
    fn points(&self, dof: Dof, observations: &Observations, is_defined: bool) -> Vec<Point> {
        let mut points = points(self.channel, dof, observations, is_defined);
        for point in &mut points {
            point.x = self.linear(point.x);
        }
        points
    }
}

/// Returns the count of a channel and the angle of a joint in each pose, or in each pose that defines the joint.
fn points(channel: usize, dof: Dof, observations: &Observations, is_defined: bool) -> Vec<Point> {
    let poses = observations.poses().iter();
    let poses = poses.filter(|observed| !is_defined || observed.pose.defines(dof));
    let point = |observed: &PoseObservation| {
        let expected = observed.pose.expected(dof);
        Some(Point {
            x: observed.median(channel)?,
            y: expected.radians,
            deviation: expected.deviation,
        })
    };
    poses.filter_map(point).collect()
}

/// Returns `true` if a pose moves a joint away from its angle in the flat hand.
fn moves(pose: CalibrationPose, dof: Dof) -> bool {
    pose.defines(dof) && pose.expected(dof).radians.abs() >= MIN_ANGLE
}

/// Returns `true` if points are far enough from each other to show a gain.
fn has_gain(points: &[Point]) -> bool {
    let angles = points.iter().map(|point| point.y);
    let (low, high) = angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), angle| {
        (low.min(angle), high.max(angle))
    });
    high - low >= MIN_ANGLE
}

/// Returns a calibration with the gain of the starting glove through points of one angle.
fn shifted(start: AffineMap, points: &[Point]) -> Option<AffineMap> {
    let shifts: Vec<Point> = points
        .iter()
        .map(|point| Point {
            x: 0.0,
            y: point.y - start.gain * point.x,
            ..*point
        })
        .collect();
    Some(AffineMap {
        offset: fit_line(&shifts)?.map.offset,
        ..start
    })
}
