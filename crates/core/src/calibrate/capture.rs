//! The capture of one pose: waits until the hand is still, which it reads from the data.

use std::collections::VecDeque;
use std::time::Duration;

use super::observation::{ChannelObservation, PoseObservation};
use super::pose::CalibrationPose;
use crate::capture::{ChannelSet, Channels};
use crate::time::Timestamp;

/// The time for which a hand must be still: several packets of the slowest line, and shorter than a tremor drifts.
const HOLD: Duration = Duration::from_millis(1_000);

/// The time between two checks.
const CHECK_PERIOD: Duration = Duration::from_millis(50);

/// The time after which a pose is captured although a few channels change, as with a loose wire, or all are as in the pose before, as with
/// dead sensors.
const STRICT_TIME: Duration = Duration::from_secs(6);

/// The fraction of the channels that must be still after that time.
const MOST: f64 = 0.8;

/// The fewest readings of a still hand.
const MIN_READINGS: usize = 8;

/// The change between the halves of a window that no tremor explains, as a fraction of the full scale: 1.5 counts of 255.
const STILL: f64 = 0.006;

/// The smallest change of a count between two poses that move its joint, as a fraction of the full scale: three counts of 255.
const MOVED: f64 = 0.012;

/// The progress of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CaptureState {
    /// The person gets ready: the countdown of this time runs. With no time left, the hand is still in the pose before.
    Preparing(Duration),
    /// The hand moves.
    Moving,
    /// The hand is still, for this fraction of the time that is needed, 0..=1.
    Holding(f32),
    /// The pose was captured.
    Captured,
}

/// The present count of a channel, and its range since the start of the procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LiveChannel {
    /// The index of the channel.
    pub channel: usize,
    /// The count of the last reading; `None` if it was not measured.
    pub count: Option<u16>,
    /// The smallest and the largest count, each without single spikes; `None` until there are three readings.
    pub range: Option<(u16, u16)>,
    /// The last three counts: their median has no single spike.
    last: [u16; 3],
    known: u8,
}

impl LiveChannel {
    /// Creates a channel that was not measured yet.
    pub(super) fn new(channel: usize) -> Self {
        Self {
            channel,
            count: None,
            range: None,
            last: [0; 3],
            known: 0,
        }
    }

    /// Adds a reading.
    pub(super) fn push(&mut self, channels: &Channels) {
        let count = channels.counts.get(self.channel).copied();
        let is_sent = !channels.unsent.contains(self.channel);
        self.count = count.filter(|count| *count != Channels::UNKNOWN && is_sent);
        let Some(present) = self.count else {
            return;
        };
        self.last.rotate_left(1);
        self.last[2] = present;
        self.known = (self.known + 1).min(3);
        if self.known == 3 {
            let mut sorted = self.last;
            sorted.sort_unstable();
            let (low, high) = self.range.unwrap_or((sorted[1], sorted[1]));
            self.range = Some((low.min(sorted[1]), high.max(sorted[1])));
        }
    }
}

/// The capture of one pose.
#[derive(Clone, Debug)]
pub struct PoseCapture {
    pose: CalibrationPose,
    channels: Vec<usize>,
    prepare: Duration,
    start: Option<Timestamp>,
    checked_at: Option<Timestamp>,
    window: VecDeque<(Timestamp, Vec<u16>)>,
    /// Channels that no packet of the pose carried.
    unsent: ChannelSet,
    /// Channels that the pose moves, with their counts in the pose before.
    before: Vec<(usize, f64)>,
    state: CaptureState,
    observation: Option<PoseObservation>,
}

impl PoseCapture {
    /// Creates the capture of a pose with these channels. Readings count once the countdown `prepare` is over.
    pub fn new(pose: CalibrationPose, channels: &[usize], prepare: Duration) -> Self {
        Self {
            pose,
            channels: channels.to_vec(),
            prepare,
            start: None,
            checked_at: None,
            window: VecDeque::new(),
            unsent: ChannelSet::ALL,
            before: Vec::new(),
            state: CaptureState::Preparing(prepare),
            observation: None,
        }
    }

    /// Waits some seconds for a hand that is still in the pose before: for a change of one of these channels from its count there.
    #[must_use]
    pub fn after(self, before: Vec<(usize, f64)>) -> Self {
        Self { before, ..self }
    }

    /// Adds a reading and returns the progress. Readings after the capture change nothing.
    pub fn push(&mut self, time: Timestamp, channels: &Channels) -> CaptureState {
        if self.state == CaptureState::Captured {
            return self.state;
        }
        let start = *self.start.get_or_insert(time);
        let elapsed = time.since(start);
        if elapsed < self.prepare {
            self.state = CaptureState::Preparing(self.prepare - elapsed);
            return self.state;
        }
        let count = |&channel: &usize| channels.counts.get(channel).copied();
        let counts = self.channels.iter().map(count);
        let counts = counts.map(|sent| sent.unwrap_or(Channels::UNKNOWN));
        self.window.push_back((time, counts.collect()));
        self.unsent = self.unsent.intersection(channels.unsent);
        let is_due = |checked: Timestamp| time.since(checked) >= CHECK_PERIOD;
        if self.checked_at.is_none_or(is_due) {
            self.checked_at = Some(time);
            self.check(time, elapsed - self.prepare, channels.full_scale);
        }
        self.state
    }

    /// Returns the progress.
    pub fn state(&self) -> CaptureState {
        self.state
    }

    /// Returns the times of the first and the last reading of the still hand.
    pub fn span(&self) -> Option<(Timestamp, Timestamp)> {
        Some((self.window.front()?.0, self.window.back()?.0))
    }

    /// Returns what the channels showed, once the pose is captured.
    pub fn observation(&self) -> Option<&PoseObservation> {
        self.observation.as_ref()
    }

    fn check(&mut self, time: Timestamp, waited: Duration, full_scale: u16) {
        while self.window.len() > MIN_READINGS
            && self
                .window
                .get(1)
                .is_some_and(|(second, _)| time.since(*second) >= HOLD)
        {
            self.window.pop_front();
        }
        let rows: Vec<&[u16]> = self.window.iter().map(|(_, row)| row.as_slice()).collect();
        let observed = observe(&rows, &self.channels, self.unsent, full_scale);
        let still = observed.iter().filter(|channel| channel.is_still).count();
        let is_strict = waited < STRICT_TIME;
        let needed = if is_strict {
            observed.len()
        } else {
            (observed.len() as f64 * MOST).ceil() as usize
        };
        if self.window.len() < MIN_READINGS {
            self.state = CaptureState::Moving;
        } else if still < needed {
            // The later half may be still already.
            let half = self.window.len() / 2;
            self.window.drain(..half);
            self.state = CaptureState::Moving;
        } else if is_strict && self.is_in_pose_before(&observed, full_scale) {
            self.state = CaptureState::Preparing(Duration::ZERO);
        } else {
            let held = self
                .span()
                .map_or(Duration::ZERO, |(first, last)| last.since(first));
            // The first reading of a full window is up to one packet late.
            let fraction = held.as_secs_f32() / (HOLD.as_secs_f32() * 0.9);
            if fraction < 1.0 {
                self.state = CaptureState::Holding(fraction);
                return;
            }
            self.state = CaptureState::Captured;
            self.observation = Some(PoseObservation {
                pose: self.pose,
                channels: observed,
            });
        }
    }

    /// Returns `true` if none of the channels has moved that the pose moves.
    fn is_in_pose_before(&self, observed: &[ChannelObservation], full_scale: u16) -> bool {
        let least = MOVED * f64::from(full_scale);
        let is_unmoved = |(channel, count): &(usize, f64)| {
            let mut present = observed.iter().filter(|it| it.channel == *channel);
            present.all(|it| (it.median - count).abs() < least)
        };
        !self.before.is_empty() && self.before.iter().all(is_unmoved)
    }
}

/// Returns what each channel shows in a window of readings, each a row of counts of the measured channels. No reading carried the
/// channels of `unsent`.
pub(super) fn observe(
    rows: &[&[u16]],
    channels: &[usize],
    unsent: ChannelSet,
    full_scale: u16,
) -> Vec<ChannelObservation> {
    let observe = |(index, &channel): (usize, &usize)| {
        let counts = rows.iter().map(|row| row[index]);
        let counts: Vec<f64> = counts
            .filter(|count| *count != Channels::UNKNOWN)
            .map(f64::from)
            .collect();
        let is_measured = counts.len() * 2 > rows.len();
        is_measured.then(|| ChannelObservation {
            channel,
            median: percentile(&counts, 0.5),
            low: percentile(&counts, 0.1),
            high: percentile(&counts, 0.9),
            is_still: is_still(&counts, f64::from(full_scale)),
            is_sent: !unsent.contains(channel),
        })
    };
    channels.iter().enumerate().filter_map(observe).collect()
}

/// Returns `true` if counts neither drift nor jump: the medians of both halves agree within the noise.
fn is_still(counts: &[f64], full_scale: f64) -> bool {
    let (first, second) = counts.split_at(counts.len() / 2);
    if first.is_empty() {
        return false;
    }
    let differences: Vec<f64> = counts
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    // The median of the differences is 0.95 standard deviations of white noise.
    let noise = percentile(&differences, 0.5);
    // The standard error of a median is 1.25 standard deviations by the root of the count; four of them.
    let error = 4.0 * 1.25 * noise / (first.len() as f64).sqrt();
    let drift = (percentile(first, 0.5) - percentile(second, 0.5)).abs();
    drift <= error.max(STILL * full_scale)
}

/// Returns a percentile of values, interpolated; `fraction` is 0..=1. 0 for no values.
pub(super) fn percentile(values: &[f64], fraction: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let position = fraction * last as f64;
    let (low, high) = (
        sorted[position.floor() as usize],
        sorted[position.ceil() as usize],
    );
    low + (high - low) * position.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: u64 = 10_000;

    fn channels(counts: &[u16]) -> Channels {
        Channels {
            full_scale: 255,
            counts: counts.iter().copied().collect(),
            unsent: Default::default(),
        }
    }

    /// Feeds counts of two channels by packet until the capture; returns the number of packets.
    fn feed(capture: &mut PoseCapture, counts: impl Fn(u64) -> [u16; 2]) -> Option<u64> {
        (0..1_500).find(|&packet| {
            let state = capture.push(Timestamp(packet * PERIOD), &channels(&counts(packet)));
            state == CaptureState::Captured
        })
    }

    fn capture() -> PoseCapture {
        PoseCapture::new(CalibrationPose::Fist, &[0, 1], Duration::from_secs(1))
    }

    #[test]
    fn a_still_hand_is_captured_after_the_countdown_and_a_second() {
        let mut capture = capture();
        let noisy = |packet: u64| [100 + (packet * 7 % 3) as u16, 50];
        let packets = feed(&mut capture, noisy).unwrap();
        assert!((190..210).contains(&packets), "{packets}");
        let observation = capture.observation().unwrap();
        assert_eq!(observation.median(0), Some(101.0));
        assert_eq!(observation.median(1), Some(50.0));
    }

    #[test]
    fn a_moving_hand_is_not_captured_until_it_stops() {
        let mut capture = capture();
        let moving = |packet: u64| [20 + packet.min(500) as u16 / 3, 50];
        let packets = feed(&mut capture, moving).unwrap();
        assert!((580..620).contains(&packets), "{packets}");
        assert_eq!(capture.observation().unwrap().median(0), Some(186.0));
    }

    #[test]
    fn spikes_do_not_change_the_median_and_do_not_stop_the_capture() {
        let mut capture = capture();
        let spiky = |packet: u64| match packet % 17 {
            0 => [255, 50],
            _ => [100, 50],
        };
        assert!(feed(&mut capture, spiky).unwrap() < 215);
        assert_eq!(capture.observation().unwrap().median(0), Some(100.0));
    }

    #[test]
    fn one_channel_that_never_rests_does_not_stop_the_others_for_ever() {
        let all: Vec<usize> = (0..10).collect();
        let mut capture = PoseCapture::new(CalibrationPose::Flat, &all, Duration::ZERO);
        let loose = |packet: u64| {
            let mut counts = [80; 10];
            counts[3] = (packet % 200) as u16 + 20;
            counts
        };
        let packets = (0..1_500).find(|&packet| {
            let state = capture.push(Timestamp(packet * PERIOD), &channels(&loose(packet)));
            state == CaptureState::Captured
        });
        assert!((600..800).contains(&packets.unwrap()), "{packets:?}");
        let observation = capture.observation().unwrap();
        assert!(!observation.channel(3).unwrap().is_still);
        assert!(observation.channel(4).unwrap().is_still);
    }

    #[test]
    fn a_channel_that_is_not_measured_is_left_out() {
        let mut capture = capture();
        feed(&mut capture, |_| [Channels::UNKNOWN, 50]).unwrap();
        assert_eq!(capture.observation().unwrap().channel(0), None);
    }

    #[test]
    fn a_live_range_has_no_single_spikes() {
        let mut live = LiveChannel::new(0);
        for count in [10, 11, 200, 12, 13, 0, 14] {
            live.push(&channels(&[count]));
        }
        assert_eq!((live.count, live.range), (Some(14), Some((11, 13))));
    }
}
