//! Actions that move joints: angles and pinches.

use std::time::Duration;

use super::{MOVE_PACKETS, Planner, PressedTip, TipState};
use crate::hand::{BodyAngle, Dof, Finger, Input};
use crate::names::UnknownName;
use crate::sim::action_error::ActionErrorKind;
use crate::sim::movement::{InputChange, TipPath};
use crate::sim::typing_hand::PINCH_GAP;

impl Planner<'_> {
    pub(super) fn set_angles(
        &mut self,
        angles: &[(Dof, f64)],
        time: Option<Duration>,
    ) -> Result<(), ActionErrorKind> {
        let mut channel_targets = Vec::new();
        for &(dof, radians) in angles {
            let index = self.state.hand.index_of(dof).ok_or_else(|| {
                let known = self.state.hand.dofs().map(Dof::name);
                ActionErrorKind::NoSensor(UnknownName::new("degree of freedom", dof.name(), known))
            })?;
            let value = self.state.hand.value_at(index, dof, radians);
            let value = value.map_err(|(low, high)| ActionErrorKind::AngleOutOfRange {
                dof,
                wanted: radians.to_degrees(),
                low: low.to_degrees().ceil(),
                high: high.to_degrees().floor(),
            })?;
            channel_targets.retain(|(other, _)| *other != index);
            channel_targets.push((index, value));
        }
        for finger in angles.iter().filter_map(|(dof, _)| dof.finger()) {
            self.state.posed = self.state.posed.with(finger);
        }
        let moves = |finger| angles.iter().any(|(dof, _)| dof.finger() == finger);
        if moves(Some(Finger::Thumb)) {
            self.state.is_pinched = false;
        }
        let moves_tip = moves(None) || moves(Some(Finger::Index));
        self.move_channels(channel_targets, time.unwrap_or(self.turn_time()), moves_tip)
    }

    /// Moves channels. A pressed fingertip keeps its position; otherwise the fingertip follows from the channels.
    fn move_channels(
        &mut self,
        channel_targets: Vec<(usize, f64)>,
        time: Duration,
        moves_tip: bool,
    ) -> Result<(), ActionErrorKind> {
        if let TipState::Pressed(PressedTip { id, tip, .. }) = self.state.tip_state {
            let path = Some(TipPath::To(tip));
            let distance = self.push_movement(channel_targets, path, time, MOVE_PACKETS);
            return self.check_reach(distance, Some(id));
        }
        if moves_tip {
            self.state.tip_state = TipState::Free;
        }
        self.push_movement(channel_targets, None, time, MOVE_PACKETS);
        Ok(())
    }

    pub(super) fn pinch(&mut self, time: Duration) -> Result<(), ActionErrorKind> {
        if self.state.is_pinched {
            return Ok(());
        }
        let mut values = self.state.values.clone();
        match self.state.tip_state {
            TipState::Pressed(_) => self.state.hand.bring_thumb_to_index(&mut values),
            TipState::Clear | TipState::Free => self.state.hand.pinch(&mut values),
        }
        let changed = (0..values.len()).filter(|&index| values[index] != self.state.values[index]);
        let channel_targets: Vec<(usize, f64)> =
            changed.map(|index| (index, values[index])).collect();
        let indices = channel_targets.iter().map(|&(index, _)| index);
        let of_index_finger = indices.filter(|&index| self.state.hand.is_used_to_reach(index));
        self.state.before_pinch = of_index_finger
            .map(|index| (index, self.state.values[index]))
            .collect();
        let moves_tip = !self.state.before_pinch.is_empty();
        self.move_channels(channel_targets, time, moves_tip)?;
        self.state.is_pinched = true;
        Ok(())
    }

    /// Checks that thumb and index finger are together during a pinch.
    pub(super) fn check_pinch(&self) -> Result<(), ActionErrorKind> {
        let gap = self.state.hand.pinch_gap(&self.state.values);
        if self.state.is_pinched && gap > PINCH_GAP {
            Err(ActionErrorKind::PinchFailed(gap))
        } else {
            Ok(())
        }
    }

    /// Sets an input of the glove and keeps the posture for a packet.
    pub(super) fn set_input(&mut self, input: Input, value: f64) -> Result<(), ActionErrorKind> {
        if !self.state.hand.has_input(input) {
            return Err(ActionErrorKind::NoInput(input));
        }
        self.change_input(InputChange::Glove(input, value));
        Ok(())
    }

    /// Turns the head, a foot or a knee, and keeps the posture of the arm for a packet.
    pub(super) fn set_body(
        &mut self,
        angle: BodyAngle,
        radians: f64,
    ) -> Result<(), ActionErrorKind> {
        if !self.state.hand.shows_body() {
            return Err(ActionErrorKind::NoBody(angle));
        }
        self.change_input(InputChange::Body(angle, radians));
        Ok(())
    }

    fn change_input(&mut self, change: InputChange) {
        self.wait(self.period);
        if let Some(movement) = self.movements.last_mut() {
            movement.input = Some(change);
        }
    }

    pub(super) fn unpinch(&mut self, time: Duration) -> Result<(), ActionErrorKind> {
        self.state.is_pinched = false;
        let mut channel_targets = std::mem::take(&mut self.state.before_pinch);
        let moves_tip = !channel_targets.is_empty();
        let thumb = self.state.hand.thumb_indices();
        channel_targets.extend(thumb.map(|index| (index, self.state.rest[index])));
        self.move_channels(channel_targets, time, moves_tip)
    }
}
