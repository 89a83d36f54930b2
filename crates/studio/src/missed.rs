//! Steps whose snapshots a window has missed: a desktop does not draw a hidden window, and a full channel drops the newest snapshots.

use std::sync::Arc;

use super::model::{Contact, StudioModel};
use ademan_core::snapshot::Snapshot;

impl StudioModel {
    /// Updates contacts and values to the latest view if steps before a snapshot were missed: the end of a contact among them would
    /// not be seen, and a key would stay lit that nothing presses.
    pub(super) fn catch_up(&mut self, snapshot: &Snapshot) {
        let steps = snapshot.stats.accepted.saturating_sub(self.stats.accepted);
        if steps <= 1 {
            return;
        }
        let state = Arc::clone(&self.view.state);
        for contact in self.contacts.as_flattened_mut() {
            let pressed = contact.filter(|it| state.pressed.contains(&it.target));
            *contact = pressed.map(|it| Contact {
                is_pressed: true,
                ..it
            });
        }
        self.values.extend(state.values.iter().copied());
    }
}

#[cfg(test)]
mod tests {
    use parry3d::math::Vec2;

    use super::*;
    use crate::model::tests::{hand, snapshot};
    use crate::scene::tests::model_of;
    use ademan_core::contact::{Phase, TargetId, Touch};
    use ademan_core::hand::{Finger, Side};
    use ademan_core::layout::Layout;
    use ademan_core::pipeline::PipelineState;
    use ademan_core::snapshot::Stats;
    use ademan_runtime::files::Load;

    const KEY: TargetId = TargetId(3);

    fn model() -> StudioModel {
        model_of(Arc::new(Layout::load("qwerty-flat").unwrap()))
    }

    /// Returns the step with this number, and a touch of the key in it.
    fn step(number: u64, touched: Option<Phase>) -> Snapshot {
        let pose = hand(number);
        let touch = |phase| Touch {
            time: pose.time,
            side: Side::Right,
            finger: Finger::Index,
            target: KEY,
            phase,
            depth: 0.5,
            position: Vec2::ZERO,
        };
        Snapshot {
            target_names: model().view.layout.target_names(),
            touches: touched.map(touch).into_iter().collect(),
            pose: Some(pose),
            stats: Stats {
                accepted: number,
                ..Stats::default()
            },
            ..snapshot(PipelineState::Running)
        }
    }

    fn is_pressed(model: &StudioModel) -> bool {
        model.contact_with(KEY).is_some_and(|it| it.is_pressed)
    }

    #[test]
    fn a_key_that_was_released_while_the_window_was_hidden_is_not_lit() {
        let mut model = model();
        model.update(&step(1, Some(Phase::Pressed)));
        model.update(&step(2, None));
        assert!(is_pressed(&model), "nothing was missed");
        model.update(&step(900, None));
        assert_eq!(model.contact_with(KEY), None);
    }

    #[test]
    fn what_the_latest_view_has_is_shown_after_missed_steps() {
        let mut model = model();
        model.update(&step(1, None));
        let state = Arc::make_mut(&mut model.view.state);
        (state.pressed, state.values) = (vec![KEY], vec![(TargetId(7), 0.25)]);
        model.update(&step(900, Some(Phase::Moved)));
        assert!(is_pressed(&model), "its press was missed");
        assert_eq!(model.values.get(&TargetId(7)), Some(&0.25));
        model.update(&step(1800, None));
        assert!(is_pressed(&model), "it is still down");
    }
}
