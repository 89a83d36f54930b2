//! Faults of sensors: dead, missing, restless, inverted and swapped channels, small ranges and cross-talk.

use super::channel_fit::ChannelFit;
use super::weighted_line::{Point, fit_line};
use crate::calibrate::observation::Observations;
use crate::calibrate::problem::Problem;
use crate::estimate::AffineMap;
use crate::hand::Dof;

/// The largest angle of one count, in radians: 5°, the width of a key at the end of a finger.
const COARSEST: f64 = 0.0873;

/// The misfit that a swap must remove, in squared deviations: five standard deviations.
const SWAP_EVIDENCE: f64 = 25.0;

/// The misfit that a cross-talk must remove: three and a half standard deviations, because every pair of channels is tried.
const CROSS_TALK_EVIDENCE: f64 = 12.0;

/// The part of the movement of a source that must be independent of the joint's own movement.
const INDEPENDENT: f64 = 0.3;

/// The fewest poses that hold a joint and show a cross-talk: beside the line of the joint and the slope of the source, two that
/// could contradict.
const MIN_POSES: usize = 5;

/// The smallest cross-talk that is named, as a fraction of the channel's range. Less is within the error of a joint.
const CROSS_TALK: f64 = 0.1;

/// The [excess misfit](ChannelFit::excess_misfit) of a joint that no difference between people explains: its poses disagree by seven
/// standard deviations.
const CONTRADICTION: f64 = 12.0;

/// Returns the faults of all channels.
pub(super) fn find(fits: &[ChannelFit], observations: &Observations) -> Vec<Problem> {
    let mut problems = swapped(fits, observations);
    for fit in fits {
        let is_swapped = problems
            .iter()
            .any(|problem| is_swap_of(problem, fit.channel));
        if !is_swapped {
            problems.extend(own_faults(fit, observations));
        }
    }
    let is_faulty = |fit: &&ChannelFit| {
        let mut problems = problems.iter();
        fit.is_dead || problems.any(|problem| is_swap_of(problem, fit.channel))
    };
    let sound: Vec<&ChannelFit> = fits.iter().filter(|fit| !is_faulty(fit)).collect();
    let found = sound
        .iter()
        .filter_map(|fit| cross_talk(fit, &sound, observations));
    problems.extend(found);
    let is_named = |fit: &ChannelFit| problems.iter().any(|problem| problem.dof() == fit.dof);
    let erratic: Vec<Problem> = sound
        .iter()
        .filter(|fit| fit.excess_misfit(fit.dof, observations) > CONTRADICTION && !is_named(fit))
        .map(|fit| Problem::Erratic {
            channel: fit.channel,
            dof: fit.dof,
        })
        .collect();
    problems.extend(erratic);
    problems
}

fn is_swap_of(problem: &Problem, channel: usize) -> bool {
    matches!(problem, Problem::SwappedChannels { first, second }
        if first.0 == channel || second.0 == channel)
}

/// Returns the faults of one channel that is not swapped.
fn own_faults(fit: &ChannelFit, observations: &Observations) -> Vec<Problem> {
    let ChannelFit { channel, dof, .. } = *fit;
    let Some((low, high)) = fit.range else {
        return vec![Problem::MissingChannel { channel, dof }];
    };
    if fit.is_dead {
        let count = low.midpoint(high);
        return vec![Problem::DeadChannel {
            channel,
            dof,
            count,
        }];
    }
    let mut problems = Vec::new();
    let restless = observations.poses().iter().find(|observed| {
        let channel = observed.channel(channel);
        channel.is_some_and(|channel| !channel.is_still)
    });
    if let Some(observed) = restless {
        let pose = observed.pose;
        problems.push(Problem::Restless { channel, dof, pose });
    }
    if fit.is_inverted {
        problems.push(Problem::InvertedChannel { channel, dof });
    }
    let coarse = fit.rows.iter().find(|(_, map)| map.gain.abs() > COARSEST);
    if let Some(&(coarse_dof, _)) = coarse {
        let counts = high - low;
        problems.push(Problem::SmallRange {
            channel,
            dof: coarse_dof,
            counts,
        });
    }
    problems
}

/// Returns the pairs of channels that fit each other's joints far better than their own.
fn swapped(fits: &[ChannelFit], observations: &Observations) -> Vec<Problem> {
    let mut problems: Vec<Problem> = Vec::new();
    for (index, first) in fits.iter().enumerate() {
        let seconds = fits[index + 1..].iter();
        let best = seconds
            .filter_map(|second| Some((second, swap_gain(first, second, observations)?)))
            .max_by(|one, other| one.1.total_cmp(&other.1));
        if let Some((second, gain)) = best
            && gain > SWAP_EVIDENCE
        {
            problems.push(Problem::SwappedChannels {
                first: (first.channel, first.dof),
                second: (second.channel, second.dof),
            });
        }
    }
    problems
}

/// Returns the misfit that a swap of two channels removes; `None` unless both fit better.
fn swap_gain(first: &ChannelFit, second: &ChannelFit, observations: &Observations) -> Option<f64> {
    if first.is_dead || second.is_dead {
        return None;
    }
    let misfit = |fit: &ChannelFit, dof: Dof| {
        let line = fit.line_of_all(dof, observations)?;
        Some(line.misfit)
    };
    let own = (misfit(first, first.dof)?, misfit(second, second.dof)?);
    let other = (misfit(first, second.dof)?, misfit(second, first.dof)?);
    let gains = (own.0 - other.1, own.1 - other.0);
    let is_better = gains.0 > 0.0 && gains.1 > 0.0 && other.0 + other.1 < (own.0 + own.1) / 3.0;
    is_better.then_some(gains.0 + gains.1)
}

/// Returns the strongest cross-talk into a channel from another one.
fn cross_talk(
    fit: &ChannelFit,
    fits: &[&ChannelFit],
    observations: &Observations,
) -> Option<Problem> {
    let line = fit.line(fit.dof, observations)?;
    let range = fit.range.map(|(low, high)| high - low)?;
    let own_angle = (line.map.gain * range).abs();
    let others = fits
        .iter()
        .filter(|other| !repeats(fit, other, observations));
    let leaks = others.filter_map(|source| {
        let (slope, evidence) = leak(fit, source, line.map, observations)?;
        let fraction = slope.abs() / own_angle;
        let is_strong = evidence > CROSS_TALK_EVIDENCE && fraction > CROSS_TALK;
        is_strong.then_some((source, fraction, evidence))
    });
    let (source, fraction, _) = leaks.max_by(|one, other| one.2.total_cmp(&other.2))?;
    Some(Problem::CrossTalk {
        channel: fit.channel,
        dof: fit.dof,
        source: (source.channel, source.dof),
        fraction,
    })
}

/// Returns `true` if a channel has the counts of another one in all poses: a glove that sends one value for a finger has it in the
/// channel of each joint. A channel repeats itself.
fn repeats(fit: &ChannelFit, other: &ChannelFit, observations: &Observations) -> bool {
    let mut poses = observations.poses().iter();
    poses.all(|observed| observed.median(fit.channel) == observed.median(other.channel))
}

/// Returns the change of a joint for the range of another channel, in radians, and the misfit that it removes.
///
/// It is the partial regression of both on the joint's own movement: a source that moves with the joint in all poses explains
/// nothing, and gives `None`.
fn leak(
    fit: &ChannelFit,
    source: &ChannelFit,
    map: AffineMap,
    observations: &Observations,
) -> Option<(f64, f64)> {
    let (low, high) = source.range?;
    let (mut own, mut other) = (Vec::new(), Vec::new());
    let poses = observations.poses().iter();
    for observed in poses.filter(|observed| !observed.pose.leaves_free(fit.dof)) {
        let (count, source) = observed
            .median(fit.channel)
            .zip(observed.median(source.channel))?;
        let expected = observed.pose.expected(fit.dof);
        let point = |y: f64| Point {
            x: expected.radians,
            y,
            deviation: expected.deviation,
        };
        own.push(point(map.apply(fit.linear(count)) - expected.radians));
        other.push(point((source - low) / (high - low)));
    }
    if own.len() < MIN_POSES {
        return None;
    }
    let constant = fit_line(&other)?.constant_misfit;
    let (own, other) = (without_line(&own)?, without_line(&other)?);
    let pairs = || own.iter().zip(&other);
    let sum = |value: fn(&Point, &Point) -> f64| -> f64 {
        pairs()
            .map(|(point, twin)| value(point, twin) / point.deviation.powi(2))
            .sum()
    };
    let variance = sum(|_, twin| twin.y * twin.y);
    let covariance = sum(|point, twin| point.y * twin.y);
    let is_independent = variance > INDEPENDENT * constant && variance > 0.0;
    is_independent.then(|| (covariance / variance, covariance * covariance / variance))
}

/// Returns the points less the line through them.
fn without_line(points: &[Point]) -> Option<Vec<Point>> {
    let line = fit_line(points)?.map;
    let rest = |point: &Point| Point {
        y: point.y - line.apply(point.x),
        ..*point
    };
    Some(points.iter().map(rest).collect())
}
