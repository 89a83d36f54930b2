//! The thread that plays a recording and sends its steps.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;

use crossbeam_channel::{Receiver, Sender, bounded};

use super::MAX_STEPS;
use super::comparison::{Press, PressList};
use super::step::RecordedStep;
use crate::history::History;
use crate::model::StudioModel;
use crate::sensors::{SensorTable, other_side};
use crate::shapes::Shapes;
use ademan_core::command::Command;
use ademan_core::pipeline::{Pipeline, PipelineState};
use ademan_core::snapshot::StepView;
use ademan_core::time::Timestamp;
use ademan_runtime::capture::CaptureError;
use ademan_runtime::capture::recording::Replay;
use ademan_runtime::session::view::View;
use ademan_runtime::session::{self, CommandSender, command_channel};
use ademan_runtime::setup::{LoadedSetup, ReplaySettings, SetupError};

/// Steps between two keyframes.
pub const KEYFRAME_PERIOD: usize = 1024;

/// Steps that are sent together.
const BATCH_STEPS: usize = 256;

/// Batches that wait for the player. The thread waits while there are more.
const QUEUED_BATCHES: usize = 16;

/// Reason why a recording cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The file cannot be read.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// Its setup cannot be used.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// No thread can be started.
    #[error("cannot start a thread: {0}; close other programs and try again")]
    Thread(#[from] io::Error),
}

/// A recording, and the setup that it is played with.
pub struct Recording {
    /// Path of the file.
    pub path: PathBuf,
    /// Its setup, with the layout that replaces the recorded one, if any.
    pub setup: LoadedSetup,
    /// `true` if this person has made it of a layout file of their own, beside which its meshes are.
    pub has_own_layout: bool,
}

impl Recording {
    /// Reads the setup of a recording. `layout` replaces the recorded one: a shipped name or a path.
    pub fn open(path: &Path, layout: Option<&str>) -> Result<Self, OpenError> {
        let settings = ReplaySettings {
            layout,
            ..ReplaySettings::default()
        };
        let replay = Replay::open(path)?;
        Ok(Self {
            path: path.to_owned(),
            setup: LoadedSetup::from_recording(replay.setup(), &settings)?,
            has_own_layout: false,
        })
    }

    /// Returns the model before the first step.
    pub fn first_model(&self) -> StudioModel {
        let map = self.setup.glove.as_ref().map(|glove| &glove.map);
        let source = format!("recording:{}", self.path.to_string_lossy());
        let sensors = map.map(SensorTable::new).unwrap_or_default();
        let mut shapes = if self.has_own_layout {
            Shapes::default()
        } else {
            Shapes::for_setup(&self.setup)
        };
        if let Some(document) = self.setup.arm_document() {
            shapes.set_arm(document);
        }
        StudioModel::with_shapes(
            session::first_view(&self.setup, &source),
            sensors.with_other_hand(other_side(&self.setup)),
            shapes,
        )
    }

    /// Returns all presses of the recording, as far as it is complete. Takes as long as playing it as fast as possible.
    pub fn presses(&self) -> Result<Vec<Press>, String> {
        let source = Replay::open(&self.path).map_err(|error| error.to_string())?;
        let (_, commands) = command_channel();
        let mut presses = PressList::default();
        let mut observe = |step: &StepView, _: &Pipeline, _: Option<View>| presses.add(step.events);
        session::replay(&self.setup, source, &commands, &mut observe)
            .map_err(|error| error.to_string())?;
        Ok(presses.finish())
    }
}

/// Steps in order, sent together.
pub struct Batch {
    /// Index of the first step.
    pub first: usize,
    /// Times of the steps.
    pub times: Vec<Timestamp>,
    /// The steps; empty if they are outside the part that is kept.
    pub steps: Vec<RecordedStep>,
    /// A model before the step with this index, without history.
    pub keyframe: Option<(usize, Box<StudioModel>)>,
}

/// The part of a recording that is loaded.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Index of the first step that is sent whole, a multiple of [`KEYFRAME_PERIOD`]. At most [`MAX_STEPS`] steps follow.
    pub first: usize,
    /// Play on to the end of the recording, for the times of its steps.
    pub to_end: bool,
}

/// A message of the thread.
pub enum Loaded {
    /// Steps.
    Steps(Batch),
    /// The end of the recording, and the reason if it is not complete.
    End(Option<String>),
}

/// A thread that plays a recording once. It ends when this is dropped.
pub struct Loader {
    pub loaded: Receiver<Loaded>,
    commands: CommandSender,
}

impl Loader {
    /// Starts a thread that plays a part of a recording.
    pub fn start(recording: Arc<Recording>, part: Part) -> Result<Self, OpenError> {
        let source = Replay::open(&recording.path)?;
        let (sender, loaded) = bounded(QUEUED_BATCHES);
        let (commands, receiver) = command_channel();
        let stop = commands.clone();
        let name = thread::Builder::new().name("recording".into());
        name.spawn(move || {
            let truncation = source.shared_truncation();
            let mut pass = Pass::new(recording.first_model(), sender, part);
            let mut observe = |step: &StepView, pipeline: &Pipeline, view: Option<View>| {
                // The end of the replay releases everything; it is no step of the recording.
                if step.state == PipelineState::Stopped {
                    return;
                }
                let step = RecordedStep::new(step, view);
                if !pass.add(step, pipeline.time()) {
                    // A full queue of commands does not refuse this one.
                    let _ = stop.send(Command::Stop);
                }
            };
            let ended = session::replay(&recording.setup, source, &receiver, &mut observe);
            let cut = truncation.get().map(|cut| cut.reason.clone());
            pass.end(ended.err().map(|error| error.to_string()).or(cut));
        })?;
        Ok(Self { loaded, commands })
    }
}

impl Drop for Loader {
    fn drop(&mut self) {
        let _ = self.commands.send(Command::Stop);
    }
}

/// One pass through a recording.
struct Pass {
    model: StudioModel,
    sender: Sender<Loaded>,
    part: Part,
    index: usize,
    batch: Batch,
    is_stopped: bool,
}

impl Pass {
    fn new(model: StudioModel, sender: Sender<Loaded>, part: Part) -> Self {
        Self {
            model,
            sender,
            part,
            index: 0,
            batch: Batch::new(0),
            is_stopped: false,
        }
    }

    /// Adds a step. Returns `false` if no further one is needed.
    fn add(&mut self, step: RecordedStep, time: Timestamp) -> bool {
        if self.is_stopped {
            return false;
        }
        let end = self.part.first + MAX_STEPS;
        if self.index >= end && !self.part.to_end {
            self.send();
            self.is_stopped = true;
            return false;
        }
        let is_kept = (self.part.first..end).contains(&self.index);
        if is_kept && self.index.is_multiple_of(KEYFRAME_PERIOD) {
            // The player rebuilds the history from the steps before the one that it shows.
            self.model.history = History::default();
            self.batch.keyframe = Some((self.index, Box::new(self.model.clone())));
        }
        step.apply_to(&mut self.model);
        self.batch.times.push(time);
        if is_kept {
            self.batch.steps.push(step);
        }
        self.index += 1;
        if self.batch.times.len() == BATCH_STEPS {
            self.send();
        }
        !self.is_stopped
    }

    fn send(&mut self) {
        let batch = std::mem::replace(&mut self.batch, Batch::new(self.index));
        self.is_stopped |= self.sender.send(Loaded::Steps(batch)).is_err();
    }

    fn end(mut self, error: Option<String>) {
        if !self.is_stopped {
            self.send();
            // The player may be gone.
            let _ = self.sender.send(Loaded::End(error));
        }
    }
}

impl Batch {
    fn new(first: usize) -> Self {
        Self {
            first,
            times: Vec::new(),
            steps: Vec::new(),
            keyframe: None,
        }
    }
}
