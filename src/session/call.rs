//! What can be asked of a run, and what it answers.

use crossbeam_channel::{Receiver, Sender, bounded};

use crate::contact::board_pose::BoardPose;
use crate::pipeline::CommandError;
use crate::snapshot::{PipelineState, Stats};

/// Calls that wait for a run which is busy: one for each client of a control socket, and some for the program's own
/// calls to pause, which no client may crowd out.
const WAITING_CALLS: usize = 16 + 8;

/// Something that a run is to do between two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Say how it is.
    State,
    /// Let go of everything and let nothing out.
    Pause,
    /// Go on, once the hand was seen off all controls.
    Resume,
    /// Put another layout of the setup in force: its place among them.
    Profile(u8),
    /// The same with the one after the one in force; after the last comes the first.
    NextProfile,
    /// Bring the boards to where the hand is.
    Recentre,
    /// Move the boards by so many metres to the right, up and towards the wearer (the axes of the world).
    Nudge([f32; 3]),
    /// Turn each board by so many radians about its own rows, through its (0, 0): the far side rises.
    Tilt(f32),
    /// Say where the boards are.
    Places,
}

/// What a run answers to an order that it has obeyed.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// It is done.
    Done,
    /// How the run is.
    State(SessionStatus),
    /// Where the boards are.
    Places(BoardPoses),
}

/// Where the boards of the layout in force are.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardPoses {
    /// The place of the layout among those of the setup.
    pub profile: u8,
    /// Board by board, in the order of the layout.
    pub boards: Vec<BoardPose>,
}

/// How a run is, between two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SessionStatus {
    /// What the engine is doing.
    pub state: PipelineState,
    /// Whether it is paused because somebody asked for it.
    pub is_paused: bool,
    /// The place of the layout in force among those of the setup.
    pub profile: u8,
    /// The account of all readings so far.
    pub stats: Stats,
    /// Presses that the output did not take because it was busy.
    pub dropped_presses: u64,
}

/// An order, and where its answer goes.
#[derive(Clone, Debug)]
pub struct Call {
    /// What is to be done.
    pub order: Order,
    /// Takes the answer. Should have room for it: the run does not wait.
    pub answer: Sender<Result<Answer, CommandError>>,
}

/// Where calls to a run are put.
pub type Calls = Sender<Call>;

/// A way for calls: the end to put them in, and the one for [`Commands`](super::Commands). Those that come
/// while a run is busy wait, up to 24; they are obeyed in order, also when nobody waits for an answer any more.
pub fn calls() -> (Calls, Receiver<Call>) {
    bounded(WAITING_CALLS)
}
