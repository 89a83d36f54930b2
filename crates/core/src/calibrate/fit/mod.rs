//! The fit of a glove to a hand: gains, offsets and curvatures, and the faults of its sensors.
//!
//! Each pose gives pairs of a count and an angle. The angle is what a typical adult shows, with the deviation between people as
//! its uncertainty, so that a joint which a table holds weighs more than one at the end of its range.

mod channel_fit;
mod curvature;
mod faults;
mod weighted_line;

use self::channel_fit::ChannelFit;
use super::error::CalibrationError;
use super::observation::Observations;
use super::pose::CalibrationPose;
use super::problem::{Problem, Severity};
use crate::estimate::{AffineMap, ChannelMap, ChannelRow, CountRange, JointLimits, channels_of};
use crate::hand::{Dof, Finger};

/// The calibration of a glove for a hand.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationResult {
    /// The rows of the starting glove with new maps, in the same order.
    pub map: ChannelMap,
    /// The quality, 0..=100: the mean over all joints that the glove measures. A joint counts in full if its sensor has no fault
    /// and fine counts, and its poses agree.
    pub score: u8,
    /// The problems, the worst first.
    pub problems: Vec<Problem>,
}

/// The fraction of the joints that may be unusable, not counting the arm and the index finger, where every joint must be usable.
const MAX_UNUSABLE: f64 = 0.25;

/// The quality of a joint with an inexact calibration.
const INEXACT: f64 = 0.5;

/// The angle of one count, in radians, at which a joint counts half: 10°.
const COARSE: f64 = 0.1745;

/// Fits a glove to a hand. `start` is the glove from which the calibration starts, such as a shipped one.
///
/// # Errors
/// Fails if the observations do not determine a calibration that a hand could use, with all reasons.
pub fn fit(
    observations: &Observations,
    start: &ChannelMap,
) -> Result<CalibrationResult, CalibrationError> {
    if start.rows().is_empty() {
        return Err(CalibrationError::EmptyGlove);
    }
    let observed = observations.poses().len();
    let has = |pose| observations.get(pose).is_some();
    if observed < 2 || !has(CalibrationPose::Flat) {
        return Err(CalibrationError::TooFewPoses { observed });
    }
    let is_sent = |row: &&ChannelRow| is_judged(row, observations);
    let sent: Vec<ChannelRow> = start.rows().iter().filter(is_sent).cloned().collect();
    if sent.is_empty() {
        return Err(CalibrationError::NothingSent);
    }
    let channels = channels_of(&sent);
    let fits = channels.iter();
    let fits: Vec<ChannelFit> = fits
        .map(|&channel| ChannelFit::new(channel, observations, start))
        .collect();
    let mut problems = faults::find(&fits, observations);
    let map = start.clone().with_curvatures(curvatures(&fits, start));
    let calibrations: Vec<AffineMap> = map
        .rows()
        .iter()
        .map(|row| {
            if is_judged(row, observations) {
                calibration(row, &fits, start, &mut problems)
            } else {
                // The count of rest, for which the starting glove has the angle, or no count.
                row.calibration
            }
        })
        .collect();
    let map = map.with_calibrations(&calibrations);
    add_implausible(&map, observations, &mut problems);
    let map = map.with_ranges(sound_ranges(&fits, start, &problems));
    problems.sort_by_key(|problem| std::cmp::Reverse(problem.severity()));
    let unusable = unusable(&problems, sent.len());
    if !unusable.is_empty() {
        return Err(CalibrationError::Unusable { problems: unusable });
    }
    let misfit = |row: &ChannelRow| {
        let fit = fits.iter().find(|fit| fit.channel == row.channel);
        fit.map_or(0.0, |fit| fit.excess_misfit(row.dof, observations))
    };
    Ok(CalibrationResult {
        score: score(map.rows().iter().filter(is_sent), &problems, misfit),
        map,
        problems,
    })
}

/// Returns `true` if the poses judge a row: the glove has its sensor. A finger without a count in any pose is one that the glove does not
/// measure, except for the index finger, without which nothing can be typed.
fn is_judged(row: &ChannelRow, observations: &Observations) -> bool {
    let is_measured = || observations.range(row.channel).is_some();
    observations.is_sent(row.channel) && (reaches_keys(row.dof) || is_measured())
}

/// Returns `true` for a joint of the arm or of the index finger.
fn reaches_keys(dof: Dof) -> bool {
    matches!(dof.finger(), None | Some(Finger::Index))
}

/// Returns the curvatures that the poses show. A channel without one keeps the curvature of the starting glove, with which the values
/// of its rows were found.
fn curvatures(fits: &[ChannelFit], start: &ChannelMap) -> Vec<(usize, f64)> {
    let is_kept = |channel: usize| {
        let mut own = fits.iter().filter(|fit| fit.channel == channel);
        own.all(ChannelFit::keeps_curvature)
    };
    let old = start.curvatures().iter().copied();
    let old = old.filter(|(channel, _)| is_kept(*channel));
    let new = fits.iter().filter_map(ChannelFit::curvature);
    let mut all: Vec<(usize, f64)> = new.chain(old).collect();
    all.sort_by_key(|(channel, _)| *channel);
    all
}

/// Returns the new calibration of a row. A row that no pose determines keeps the start's, in proportion to the other rows of its
/// channel. The joint of a dead sensor is straight: bent, it would keep a run from typing with the other fingers.
fn calibration(
    row: &ChannelRow,
    fits: &[ChannelFit],
    start: &ChannelMap,
    problems: &mut Vec<Problem>,
) -> AffineMap {
    let fit = fits.iter().find(|fit| fit.channel == row.channel);
    let own = fit.and_then(|fit| fit.rows.iter().find(|(dof, _)| *dof == row.dof));
    if let Some((_, calibration)) = own {
        return *calibration;
    }
    if let Some(count) = fit.and_then(ChannelFit::dead_count) {
        return AffineMap::from_counts(-count, row.calibration.gain, 0.0);
    }
    let siblings = start.rows().iter();
    let sibling = siblings.filter(|other| other.channel == row.channel);
    let fitted = |other: &ChannelRow| {
        let (_, new) = fit?.rows.iter().find(|(dof, _)| *dof == other.dof)?;
        Some((other.calibration, *new))
    };
    if let Some((old, new)) = sibling.filter_map(fitted).next() {
        // The zero of the old row is at the angle that the new map has at the same angle of the sibling.
        let zero = new.apply_inverse(old.apply(row.calibration.apply_inverse(0.0)));
        let gain = row.calibration.gain * new.gain / old.gain;
        return AffineMap::from_counts(-zero, gain, 0.0);
    }
    let is_explained = problems.iter().any(|problem| problem.dof() == row.dof);
    if !is_explained {
        problems.push(Problem::NotObserved { dof: row.dof });
    }
    row.calibration
}

/// Returns the ranges of the channels whose sensors have no fault that remains: only those may be widened while typing.
fn sound_ranges(
    fits: &[ChannelFit],
    start: &ChannelMap,
    problems: &[Problem],
) -> Vec<(usize, CountRange)> {
    let has_problem = |channel: usize| {
        let mut rows = start.rows().iter().filter(|row| row.channel == channel);
        rows.any(|row| {
            problems.iter().any(|problem| {
                problem.dof() == row.dof && problem.severity() != Severity::Corrected
            })
        })
    };
    let sound = fits.iter().filter(|fit| !has_problem(fit.channel));
    let range = |fit: &ChannelFit| fit.range.map(|range| (fit.channel, range));
    sound
        .filter_map(range)
        .filter(|(_, (low, high))| low < high)
        .collect()
}

/// Adds the joints that a running program would reject in one of the poses.
fn add_implausible(map: &ChannelMap, observations: &Observations, problems: &mut Vec<Problem>) {
    let limits = JointLimits::human();
    for row in map.rows() {
        let is_named = problems.iter().any(|problem| problem.dof() == row.dof);
        if is_named || !observations.is_sent(row.channel) {
            continue;
        }
        let outside = observations.poses().iter().find_map(|observed| {
            let radians = map.radians(row, observed.median(row.channel)?);
            let is_outside = limits.checked_clamp(row.dof, radians).is_none();
            is_outside.then_some((observed.pose, radians))
        });
        if let Some((pose, radians)) = outside {
            problems.push(Problem::Implausible {
                dof: row.dof,
                pose,
                degrees: radians.to_degrees(),
            });
        }
    }
}

/// Returns the problems for which a calibration is refused: the problems of the arm and the index finger, which reach the
/// keys, and all problems if they concern too many of the rows that the glove sends.
fn unusable(problems: &[Problem], rows: usize) -> Vec<Problem> {
    let unusable = problems.iter();
    let unusable: Vec<&Problem> = unusable
        .filter(|problem| problem.severity() == Severity::Unusable)
        .collect();
    let is_swapped = |problem: &Problem| matches!(problem, Problem::SwappedChannels { .. });
    let is_refused = |problem: &&Problem| reaches_keys(problem.dof()) || is_swapped(problem);
    let are_many = unusable.len() as f64 > MAX_UNUSABLE * rows as f64;
    if are_many {
        unusable.into_iter().cloned().collect()
    } else {
        unusable.into_iter().filter(is_refused).cloned().collect()
    }
}

/// Returns the mean quality of the joints of rows, in percent. `misfit` is the disagreement of the poses of a row, 0 for none.
fn score<'a>(
    rows: impl Iterator<Item = &'a ChannelRow>,
    problems: &[Problem],
    misfit: impl Fn(&ChannelRow) -> f64,
) -> u8 {
    let quality = |row: &ChannelRow| {
        let own = problems.iter().filter(|problem| problem.dof() == row.dof);
        let worst = own.map(|problem| match problem.severity() {
            Severity::Corrected => 1.0,
            Severity::Inexact => INEXACT,
            Severity::Unusable => 0.0,
        });
        let resolution = 1.0 / (1.0 + row.calibration.gain.abs() / COARSE);
        worst.fold(resolution / (1.0 + misfit(row)), f64::min)
    };
    let (total, count) = rows
        .map(quality)
        .fold((0.0, 0.0), |(total, count), quality| {
            (total + quality, count + 1.0)
        });
    (100.0 * total / count).round() as u8
}

#[cfg(test)]
mod tests;
