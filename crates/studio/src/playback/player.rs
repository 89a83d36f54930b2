//! The position in a recording, and the model there.

use std::sync::Arc;
use std::time::Duration;

use super::MAX_STEPS;
use super::loader::{Batch, KEYFRAME_PERIOD, Loaded, Loader, OpenError, Part, Recording};
use super::step::RecordedStep;
use crate::history::SECONDS;
use crate::model::StudioModel;
use ademan_core::time::Timestamp;
use ademan_runtime::capture::pace::MAX_GAP;

/// Playing speeds, as a multiple of the recorded speed.
pub const SPEEDS: [f64; 7] = [0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0];

/// A change of the position, or of how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// Go to the step with this index, and pause.
    Step(usize),
    /// Go on by a number of steps, and pause.
    By(isize),
    /// Go to the latest step at or before a time, and pause.
    Time(Timestamp),
    /// Go on by a time in seconds, and pause.
    BySeconds(f64),
    /// Play, from the start if the position is at the end.
    Play,
    /// Pause.
    Pause,
    /// Play at a multiple of the recorded speed.
    Speed(f64),
}

/// The most batches that are received for one frame, so that it is not late: 4096 steps.
const MAX_BATCHES: usize = 16;

/// A recording that is played forwards, or shown at any of its steps.
pub struct Player {
    recording: Arc<Recording>,
    loader: Loader,
    /// Steps that the loader has played.
    played: usize,
    /// Index of the first of `steps`.
    first: usize,
    steps: Vec<RecordedStep>,
    /// Models before the steps with these indices, ascending, without history.
    keyframes: Vec<(usize, Box<StudioModel>)>,
    /// Times of all steps that were loaded once.
    times: Vec<Timestamp>,
    /// `Some` once the whole recording was loaded, with the reason if it is not complete.
    end: Option<Option<String>>,
    /// Index of the step that the model shows; `None` before the first one.
    shown: Option<usize>,
    /// Index of the step that is to be shown.
    wanted: usize,
    is_playing: bool,
    speed: f64,
    /// Time of the recording that is playing, in microseconds; `None` until playing continues from the position.
    clock: Option<f64>,
}

impl Player {
    /// Starts to load a recording, which plays as soon as its first steps are there.
    pub fn open(recording: Recording) -> Result<Self, OpenError> {
        let recording = Arc::new(recording);
        let part = Part {
            first: 0,
            to_end: true,
        };
        Ok(Self {
            loader: Loader::start(Arc::clone(&recording), part)?,
            played: 0,
            first: 0,
            steps: Vec::new(),
            keyframes: Vec::new(),
            times: Vec::new(),
            end: None,
            recording,
            shown: None,
            wanted: 0,
            is_playing: true,
            speed: 1.0,
            clock: None,
        })
    }

    /// Receives the steps that were loaded, plays for the time that has passed, and brings the model to the position. The model is
    /// the one of the last call.
    pub fn advance(&mut self, elapsed: Duration, model: &mut StudioModel) {
        self.receive();
        if self.is_playing {
            self.play(elapsed);
        }
        self.show_wanted(model);
    }

    fn receive(&mut self) {
        for _ in 0..MAX_BATCHES {
            match self.loader.loaded.try_recv() {
                Ok(Loaded::Steps(batch)) => self.add(batch),
                Ok(Loaded::End(reason)) => _ = self.end.get_or_insert(reason),
                Err(_) => break,
            }
        }
    }

    fn add(&mut self, batch: Batch) {
        self.played = batch.first + batch.times.len();
        if self.played > self.times.len() {
            self.times.truncate(batch.first);
            self.times.extend(&batch.times);
        }
        self.keyframes.extend(batch.keyframe);
        self.steps.extend(batch.steps);
    }

    /// Moves the position by the time that has passed. A longer gap between two steps takes [`MAX_GAP`], as in a replay.
    fn play(&mut self, elapsed: Duration) {
        let Some(&last) = self.times.last() else {
            // A recording without a step has ended once it is loaded.
            self.is_playing = self.end.is_none();
            return;
        };
        let start = || self.times[self.wanted].0 as f64;
        let next = self.times.get(self.wanted + 1).unwrap_or(&last);
        // A device may have been lost for hours.
        let gap_end = next.0 as f64 - MAX_GAP.as_secs_f64() * 1e6 * self.speed;
        let from = self.clock.unwrap_or_else(start).max(gap_end);
        let clock = from + elapsed.as_secs_f64() * 1e6 * self.speed;
        if clock >= last.0 as f64 {
            // The end, or the end of what is loaded so far.
            self.is_playing = self.end.is_none();
        }
        let clock = clock.min(last.0 as f64);
        self.clock = Some(clock);
        self.wanted = self.index_at(Timestamp(clock as u64));
    }

    /// Returns the index of the latest step at or before a time.
    fn index_at(&self, time: Timestamp) -> usize {
        let after = self.times.partition_point(|other| *other <= time);
        after.saturating_sub(1)
    }

    /// Moves the position, or changes how it moves.
    pub fn apply(&mut self, change: Move) {
        match change {
            Move::Step(index) => self.seek(index),
            Move::By(steps) => self.seek(self.wanted.saturating_add_signed(steps)),
            Move::Time(time) => self.seek(self.index_at(time)),
            Move::BySeconds(seconds) => {
                let time = Timestamp::from_seconds(self.time().seconds() + seconds);
                self.seek(self.index_at(time));
            }
            Move::Play => {
                let is_at_end = self.wanted + 1 >= self.times.len();
                if is_at_end && self.end.is_some() {
                    self.wanted = 0;
                }
                (self.is_playing, self.clock) = (true, None);
            }
            Move::Pause => self.is_playing = false,
            Move::Speed(speed) => self.speed = speed,
        }
    }

    /// Goes to a step, or to the last one, and pauses.
    fn seek(&mut self, index: usize) {
        (self.is_playing, self.clock) = (false, None);
        self.wanted = index.min(self.times.len().saturating_sub(1));
    }

    /// Updates the model to the wanted step if the step is loaded, and loads it otherwise.
    fn show_wanted(&mut self, model: &mut StudioModel) {
        if self.times.is_empty() || self.shown == Some(self.wanted) {
            return;
        }
        let loaded = self.first..self.first + self.steps.len();
        if !loaded.contains(&self.wanted) || !self.has_history(self.wanted) {
            self.load_around(self.wanted);
            return;
        }
        let most = self.steps_of_history(self.wanted) + KEYFRAME_PERIOD;
        let next = match self.shown {
            Some(shown) if shown < self.wanted && self.wanted - shown <= most => shown + 1,
            _ => self.restore(model),
        };
        self.apply_steps(next, model);
    }

    /// Applies the steps up to the wanted one to the model.
    fn apply_steps(&mut self, next: usize, model: &mut StudioModel) {
        for index in next..=self.wanted {
            self.steps[index - self.first].apply_to(model);
        }
        self.shown = Some(self.wanted);
    }

    /// Replaces the model by the latest keyframe from which the history of the wanted step is complete. Returns the index of the
    /// step after it.
    fn restore(&self, model: &mut StudioModel) -> usize {
        let oldest = self.wanted - self.steps_of_history(self.wanted);
        let after = self
            .keyframes
            .partition_point(|(index, _)| *index <= oldest);
        let (index, keyframe) = &self.keyframes[after.saturating_sub(1)];
        model.clone_from(keyframe);
        *index
    }

    /// Returns the number of steps before one from which its history follows.
    fn steps_of_history(&self, index: usize) -> usize {
        let from = Timestamp::from_seconds(self.times[index].seconds() - SECONDS);
        let first = self.times[..index].partition_point(|time| *time < from);
        // One more, as a sum of seconds is rounded. Half of the steps that are kept are more than a history has, whatever the rate.
        (index - first.saturating_sub(1)).min(MAX_STEPS / 2)
    }

    /// Returns `true` if the history before a step is loaded, too.
    fn has_history(&self, index: usize) -> bool {
        index - self.steps_of_history(index) >= self.first
    }

    /// Loads the steps around one that is not loaded, unless they are on their way.
    fn load_around(&mut self, index: usize) {
        let is_in_part = (self.first..self.first + MAX_STEPS).contains(&index);
        if is_in_part && self.has_history(index) && self.played <= index {
            return;
        }
        let first = index.saturating_sub(MAX_STEPS / 2) / KEYFRAME_PERIOD * KEYFRAME_PERIOD;
        let part = Part {
            first,
            to_end: self.end.is_none(),
        };
        match Loader::start(Arc::clone(&self.recording), part) {
            Ok(loader) => {
                self.loader = loader;
                (self.played, self.first, self.shown) = (0, first, None);
                self.steps.clear();
                self.keyframes.clear();
            }
            Err(error) => self.end = Some(Some(error.to_string())),
        }
    }
}

/// The state, for displays.
impl Player {
    /// The recording.
    pub fn recording(&self) -> &Arc<Recording> {
        &self.recording
    }

    /// Returns the index of the position.
    pub fn position(&self) -> usize {
        self.wanted
    }

    /// Returns the number of steps that were loaded so far.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Returns `true` before the first step is loaded.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Returns the time of the position.
    pub fn time(&self) -> Timestamp {
        let time = self.times.get(self.wanted);
        time.copied().unwrap_or_default()
    }

    /// Returns the times of the first and the last step that were loaded.
    pub fn range(&self) -> Option<(Timestamp, Timestamp)> {
        self.times.first().copied().zip(self.times.last().copied())
    }

    /// Returns `true` if the recording plays.
    pub fn is_playing(&self) -> bool {
        self.is_playing
    }

    /// Returns the speed, as a multiple of the recorded speed.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Returns `true` if the model belongs to the wanted position.
    pub fn is_shown(&self) -> bool {
        self.shown == Some(self.wanted)
    }

    /// Returns `true` if the whole recording was loaded once.
    pub fn is_complete(&self) -> bool {
        self.end.is_some()
    }

    /// Returns the reason why the recording ends before its end mark, once it is loaded.
    pub fn problem(&self) -> Option<&str> {
        self.end.as_ref()?.as_deref()
    }
}
