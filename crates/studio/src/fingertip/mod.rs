//! The mouse as a fingertip: a session beside the window's own, whose hand follows the pointer over the 3D view.
//!
//! ```text
//!  mouse ─ Ray ──▶ Aim ─ front under it ──▶ PointerSource ─ positions of joints ──▶ session without an output ──▶ model
//! ```
//!
//! The readings pass through a pipeline as in the session of the window, but nothing reaches an output, as the keys would
//! go to the window itself, which has the focus. The session has one layout: another one has another session.

mod aim;
mod source;

use std::sync::Arc;

use crossbeam_channel::{Receiver, TryRecvError, unbounded};

pub use self::aim::{Aim, Mouse};
pub use self::source::MOUSE;
use self::source::PointerSource;
use crate::model::StudioModel;
use crate::scene;
use crate::sensors::{SensorTable, other_side};
use ademan_core::command::Command;
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;
use ademan_core::snapshot::Snapshot;
use ademan_lab::sim::PointerHand;
use ademan_runtime::session::view::Viewer;
use ademan_runtime::session::{Session, SessionError, SessionHandle, SessionOptions};
use ademan_runtime::setup::LoadedSetup;

/// A session whose hand follows the mouse. Dropping it releases everything and ends it.
pub struct Fingertip {
    /// The layout of the window that it is for.
    layout: Arc<Layout>,
    /// The state that the 3D view shows.
    pub model: StudioModel,
    /// The movements of the mouse.
    pub aim: Aim,
    snapshots: Receiver<Snapshot>,
    viewer: Viewer,
    session: SessionHandle,
    /// The hand that the setup does not have, at rest.
    other_hand: Option<HandPose>,
    /// The number of boards beside which the other hand was placed.
    boards_beside: Option<usize>,
}

impl Fingertip {
    /// Starts a session on a layout, with the hands of a setup.
    pub fn start(setup: &LoadedSetup, layout: &Arc<Layout>) -> Result<Self, SessionError> {
        let setup = setup.without_devices(layout);
        let (moves, received) = unbounded();
        let source = PointerSource::new(&setup, received);
        let first_side = setup.arm.side();
        let other_hand = other_hand(&setup);
        let sensors = SensorTable::default().with_other_hand(other_side(&setup));
        let arm = setup.arm_document().cloned();
        let options = SessionOptions {
            source: Some(Box::new(source)),
            speed: Some(1.0),
            ..SessionOptions::default()
        };
        let session = Session::start(setup, options)?;
        let viewer = session.add_viewer();
        let view = viewer.views().recv();
        // A session that ends so early says why.
        let Ok(view) = view else {
            session.join()?;
            return Err(SessionError::NoSource);
        };
        let mut model = StudioModel::new(view, sensors);
        if let Some(document) = &arm {
            model.shapes.set_arm(document);
        }
        Ok(Self {
            layout: Arc::clone(layout),
            model,
            aim: Aim::new(first_side, moves),
            snapshots: session.snapshots().clone(),
            viewer,
            session,
            other_hand,
            boards_beside: None,
        })
    }

    /// Returns `true` if it is for this layout of the window.
    pub fn is_for(&self, layout: &Arc<Layout>) -> bool {
        Arc::ptr_eq(&self.layout, layout)
    }

    /// Receives what the session has sent since the last frame. Does not wait.
    pub fn receive(&mut self) {
        // As in the window: one that arrives during the loop may need a later view.
        let waiting = self.snapshots.len();
        for snapshot in self.snapshots.try_iter().take(waiting) {
            self.model.update(&snapshot);
        }
        match self.viewer.views().try_recv() {
            Ok(view) => self.model.set_view(view),
            Err(TryRecvError::Disconnected) => self.model.has_ended = true,
            Err(TryRecvError::Empty) => {}
        }
        self.place_other_hand();
    }

    /// Places the other hand beside the boards once their places are known, and again when another one is. It does not follow
    /// boards that move with the first hand.
    fn place_other_hand(&mut self) {
        let (Some(hand), true) = (
            &self.other_hand,
            self.model.poses.iter().any(Option::is_some),
        ) else {
            return;
        };
        let boards = 0..self.model.view.layout.boards.len();
        let placed = boards.filter(|&board| self.model.world_from_board(board).is_some());
        let count = Some(placed.count());
        if self.boards_beside != count {
            self.boards_beside = count;
            self.model.resting = Some(scene::beside(&self.model, hand));
        }
    }

    /// Waits for the end of its session, and returns the reason if it failed.
    pub fn end(self) -> Result<(), SessionError> {
        drop(self.aim);
        self.session.join().map(drop)
    }

    /// Sends a command to its session, which may have ended.
    pub fn send(&self, command: Command) {
        let _ = self.session.commands().send(command);
    }
}

/// Returns the other hand of a person with one hand in the setup, as the mirror image of its arm at rest.
fn other_hand(setup: &LoadedSetup) -> Option<HandPose> {
    if setup.other_hand.is_some() {
        return None;
    }
    let arm = setup.arm.clone().for_side(setup.arm.side().opposite());
    Some(PointerHand::new(&arm).pose())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use ademan_core::document::Document;
    use ademan_runtime::setup::{ArmSetup, Setup};

    #[test]
    fn the_hand_of_the_mouse_has_the_meshes_of_the_arm() {
        let folder = tempfile::tempdir().expect("a folder");
        let shipped = Document::shipped("unam").expect("an arm").text;
        let end = shipped.rfind(')').expect("a bracket");
        let shapes = r#"shapes: [(file: "a.obj", joint: "wrist")])"#;
        let path = folder.path().join("own.ron");
        fs::write(&path, format!("{}{shapes}", &shipped[..end])).expect("a write");
        let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        fs::write(folder.path().join("a.obj"), mesh).expect("a write");
        let setup = Setup {
            arm: ArmSetup::Model(path.display().to_string()),
            output: "none".into(),
            ..Setup::default()
        };
        let loaded = setup.load_files().expect("a setup");
        let layout = Arc::new(loaded.layout.clone());
        let fingertip = Fingertip::start(&loaded, &layout).expect("a session");
        assert_eq!(fingertip.model.shapes.limbs().len(), 1);
    }
}
