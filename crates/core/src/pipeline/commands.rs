//! The commands that the pipeline executes.

use parry3d::math::Vec3;

use super::board_move::BoardMove;
use super::{CommandError, Pipeline, SourceRole};
use crate::command::{Command, CommandOrigin};
use crate::device::Events;

impl Pipeline {
    /// Returns `true` if the pipeline executes a command. The session executes the others.
    pub const fn handles(command: &Command) -> bool {
        match command {
            Command::Pause
            | Command::Resume
            | Command::TogglePause
            | Command::Profile { .. }
            | Command::NextProfile
            | Command::Recenter
            | Command::Nudge { .. }
            | Command::Tilt { .. }
            | Command::Zero
            | Command::UndoZero
            | Command::UndoLearning
            | Command::Text { .. }
            | Command::Candidate { .. }
            | Command::ForgetLearned
            | Command::AllowKeys
            | Command::ForbidKeys => true,
            Command::State
            | Command::Scale { .. }
            | Command::Save
            | Command::SaveLearned
            | Command::Reload
            | Command::Stop => false,
        }
    }

    /// Executes a command and appends the resulting events to `events`. A command that the pipeline does not
    /// [handle](Self::handles) has no effect. Does not allocate.
    pub fn execute(
        &mut self,
        command: &Command,
        origin: CommandOrigin,
        events: &mut Events,
    ) -> Result<(), CommandError> {
        match *command {
            Command::Pause => self.pause(origin, events),
            Command::Resume => self.resume(origin),
            Command::TogglePause if self.is_paused() => self.resume(origin),
            Command::TogglePause => self.pause(origin, events),
            Command::Profile { name } => {
                let index = self.profile_index(&name);
                self.switch_profile(index.ok_or(CommandError::UnknownProfile(name))?, events);
            }
            Command::NextProfile => {
                let next = (self.active_profile + 1) % self.profiles.len();
                self.switch_profile(next, events);
            }
            Command::Recenter => self.recenter(events)?,
            Command::Nudge { x_mm, y_mm, z_mm } => {
                self.nudge(Vec3::new(x_mm, y_mm, z_mm) * 1e-3, events)?;
            }
            Command::Tilt { deg } => self.tilt(deg.to_radians(), events)?,
            Command::Zero if origin == CommandOrigin::Layout => self.zero_when_at_rest(),
            Command::Zero => self.zero(events)?,
            Command::UndoZero => self.undo_zero(events)?,
            Command::UndoLearning => self.undo_learning(events)?,
            Command::Text { mode } => self.text_filter()?.set_mode(mode),
            Command::Candidate { number } => self.choose(number, origin)?,
            Command::ForgetLearned => self.forget_learned()?,
            Command::AllowKeys | Command::ForbidKeys if origin == CommandOrigin::Layout => {
                return Err(CommandError::Permission);
            }
            Command::AllowKeys => self.set_role(SourceRole::Both, events),
            Command::ForbidKeys => self.set_role(SourceRole::Pointer, events),
            Command::State
            | Command::Scale { .. }
            | Command::Save
            | Command::SaveLearned
            | Command::Reload
            | Command::Stop => {}
        }
        Ok(())
    }

    /// Repeats a command from outside that is part of a recording, unless a replay [does not](Command::is_replayed).
    pub fn replay(&mut self, command: &Command, events: &mut Events) -> Result<(), CommandError> {
        match command {
            Command::Zero => self.replay_zero(events),
            _ if command.is_replayed() => self.execute(command, CommandOrigin::Client, events),
            _ => Ok(()),
        }
    }

    /// Releases everything and sets the role of all sources. A key that is touched now is pressed by the next touch.
    fn set_role(&mut self, role: SourceRole, events: &mut Events) {
        self.release_all(self.time, events);
        self.gate.set_role(role);
    }

    /// Ends the permission of [`Command::AllowKeys`], because another sender may follow the one that the person has allowed:
    /// releases everything, and returns all sources to their configured roles. Returns `false` if they have these roles already.
    pub fn withdraw_allowed_keys(&mut self, events: &mut Events) -> bool {
        if !self.gate.exceeds_configured_roles() {
            return false;
        }
        self.release_all(self.time, events);
        self.gate.restore_roles();
        true
    }

    fn profile_index(&self, name: &str) -> Option<usize> {
        let mut profiles = self.profiles.iter();
        profiles.position(|profile| profile.name.as_str() == name)
    }

    /// Releases everything and activates another profile; does nothing if there is no such profile.
    pub fn switch_profile(&mut self, profile: usize, events: &mut Events) {
        if profile == self.active_profile || profile >= self.profiles.len() {
            return;
        }
        self.release_all(self.time, events);
        if let Some(before) = self.profiles[self.active_profile].layout.filter() {
            self.is_inside_word = before.is_inside_word();
        }
        self.active_profile = profile;
        let filter = self.profiles[profile].layout.filter_mut();
        if let Some((filter, is_inside)) = filter.zip(self.is_inside_word) {
            filter.set_inside_word(is_inside);
        }
        // Its devices and trackers still have the state of the time when it was last active.
        self.release_all(self.time, events);
    }

    /// Releases everything and moves the boards of the active layout by a vector in metres along the axes of the world.
    /// A fingertip inside a target must leave it before it can touch.
    ///
    /// If there is no board, or a layout file could not represent a new position, no board moves and nothing is released.
    pub fn nudge(&mut self, by: Vec3, events: &mut Events) -> Result<(), CommandError> {
        self.move_boards(BoardMove::Nudge(by), events)
    }

    /// Releases everything and tilts each board of the active layout about its own X axis, by an angle in radians that
    /// raises the far side. Fails like [`nudge`](Self::nudge).
    pub fn tilt(&mut self, by: f32, events: &mut Events) -> Result<(), CommandError> {
        self.move_boards(BoardMove::Tilt(by), events)
    }

    fn move_boards(
        &mut self,
        board_move: BoardMove,
        events: &mut Events,
    ) -> Result<(), CommandError> {
        self.active_layout().check_move(board_move)?;
        self.release_all(self.time, events);
        self.active_layout().apply_move(board_move);
        Ok(())
    }

    /// Releases everything and moves the boards of the hand that was tracked last, all by the same vector, so that
    /// the center of the nearest one is below the index fingertip. That board moves in its own plane, so the height of
    /// the fingertip above its keys does not change. Needs a hand that has not stalled; fails like
    /// [`nudge`](Self::nudge).
    ///
    /// A layout that starts at the hand is placed again instead, where an open hand is held still next.
    pub fn recenter(&mut self, events: &mut Events) -> Result<(), CommandError> {
        if self.layout().starts_at_hand() {
            self.place_again(events);
            return Ok(());
        }
        if self.layout().scene().surfaces().is_empty() {
            return Err(CommandError::NothingToRecenter);
        }
        let index = self.last_tracked_hand().ok_or(CommandError::NoHand)?;
        let layout = &self.profiles[self.active_profile].layout;
        let pose = &self.hands[index].output.pose;
        let offset = layout.recenter_offset(pose)?;
        layout.check_move(BoardMove::Recenter(offset, pose))?;
        self.release_all(self.time, events);
        let recenter = BoardMove::Recenter(offset, &self.hands[index].output.pose);
        let active = &mut self.profiles[self.active_profile];
        active.layout.apply_move(recenter);
        Ok(())
    }

    /// Returns the index of the hand that was tracked last, unless it has stalled. A hand that is seen precedes one that is not: a
    /// camera sends readings of both.
    pub(super) fn last_tracked_hand(&self) -> Option<usize> {
        let tracked = (0..self.hands.len()).filter(|&index| self.is_tracked(index));
        tracked.max_by_key(|&index| {
            let hand = &self.hands[index];
            (hand.output.estimate.shows_hand(), hand.last_accepted)
        })
    }

    /// Returns `true` if readings of a hand arrive.
    pub(super) fn is_tracked(&self, index: usize) -> bool {
        let last = self.hands[index].last_accepted;
        last.is_some_and(|last| self.time.since(last) <= self.settings.stall_timeout)
    }
}
