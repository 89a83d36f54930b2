//! The choice of the click for a step of the pipeline.

use ademan_core::contact::{Phase, TargetId, Touch};
use ademan_core::device::{EventKind, KeyAction, OutputEvent};
use ademan_core::hand::{Finger, Side};
use ademan_core::layout::{Handle, Layout};
use ademan_core::names::named_enum;
use ademan_core::pipeline::PipelineState;
use ademan_core::snapshot::{Snapshot, Stats};

named_enum! {
    /// A click, named as the sound server keeps it. Of the clicks of one step, the first in this order is heard.
    pub enum Click ("click") {
        /// A key or a switch was pressed.
        Key = "key",
        /// A modifier or the key of a layer was pressed.
        Modifier = "modifier",
        /// The program suppressed a press, or its output dropped it.
        Suppressed = "suppressed",
    }
}

/// Chooses the click of each step: at most one, since several presses of one step sound as one.
#[derive(Clone, Debug, Default)]
pub struct ClickChooser {
    /// Fingers that press a target, by side.
    pressing: [[bool; Finger::COUNT]; Side::COUNT],
    /// Suppressed presses so far; `None` before the first step.
    suppressed: Option<u64>,
}

impl ClickChooser {
    /// Returns the click of a step on this layout. A paused session is silent, so that a hand may rest on the keys.
    pub fn update(&mut self, step: &Snapshot, layout: &Layout) -> Option<Click> {
        let was_pressing = self.is_pressing();
        step.touches.iter().for_each(|touch| self.track(touch));
        if step.state != PipelineState::Running {
            // Everything is released, which no touch says.
            self.pressing = Default::default();
        }
        let suppressed = suppressed_presses(&step.stats);
        let earlier = self.suppressed.replace(suppressed);
        if earlier.is_some_and(|earlier| suppressed > earlier) {
            return Some(Click::Suppressed);
        }
        if step.state != PipelineState::Running {
            return None;
        }
        let pressed = step.touches.iter();
        let pressed = pressed.filter(|touch| touch.phase == Phase::Pressed);
        let touched = pressed.filter_map(|touch| click_of(layout, touch.target));
        // A key that follows its touch later, as after a hold, has clicked with the touch.
        let has_no_touch = !was_pressing && !self.is_pressing() && step.touches.is_empty();
        let sent = step.events.iter().filter(|_| has_no_touch);
        touched.chain(sent.filter_map(click_of_event)).min()
    }

    fn track(&mut self, touch: &Touch) {
        let is_pressing = &mut self.pressing[touch.side.index()][touch.finger.index()];
        match touch.phase {
            Phase::Pressed => *is_pressing = true,
            Phase::Released | Phase::Left | Phase::Cancelled => *is_pressing = false,
            Phase::Touched | Phase::Moved => {}
        }
    }

    fn is_pressing(&self) -> bool {
        self.pressing.as_flattened().contains(&true)
    }
}

/// Returns the click of a target. Controls that are dragged have none.
fn click_of(layout: &Layout, target: TargetId) -> Option<Click> {
    if let Some(key) = layout.key_at(target) {
        return Some(match key.action(0) {
            Some(KeyAction::Modifier(..) | KeyAction::Layer(..)) => Click::Modifier,
            _ => Click::Key,
        });
    }
    let (control, _) = layout.control_at(target)?;
    (control.kind.handle() == Handle::Switch).then_some(Click::Key)
}

/// Returns the click of a press that a gesture sends.
fn click_of_event(event: &OutputEvent) -> Option<Click> {
    match event.kind {
        EventKind::KeyDown(code) if code.is_modifier() => Some(Click::Modifier),
        EventKind::KeyDown(_) | EventKind::Character(_) => Some(Click::Key),
        _ => None,
    }
}

/// Returns the presses so far that reached no output. Suppressed motions of a pointer are left out: they are not presses.
fn suppressed_presses(stats: &Stats) -> u64 {
    let suppressed = stats.suppressed;
    suppressed.rate_limited
        + suppressed.system_keys
        + suppressed.keys_by_role
        + stats.dropped_presses
}

#[cfg(test)]
pub(super) mod tests {
    use parry3d::math::Vec2;

    use super::*;
    use crate::files::Load;
    use ademan_core::time::Timestamp;

    const TIME: Timestamp = Timestamp(0);

    /// Returns a step in which nothing happens.
    pub(in crate::sound) fn step() -> Snapshot {
        Snapshot {
            state: PipelineState::Running,
            ..Snapshot::default()
        }
    }

    fn layout(name: &str) -> Layout {
        Layout::load(name).expect("a shipped layout")
    }

    fn touch(mut step: Snapshot, target: TargetId, phase: Phase) -> Snapshot {
        step.touches.push(Touch {
            time: TIME,
            side: Side::Right,
            finger: Finger::Index,
            target,
            phase,
            depth: 0.5,
            position: Vec2::ZERO,
        });
        step
    }

    fn target(layout: &Layout, key: &str) -> TargetId {
        layout.key(key).expect("a key").face.target
    }

    fn press(layout: &Layout, key: &str) -> Snapshot {
        touch(step(), target(layout, key), Phase::Pressed)
    }

    fn down(mut step: Snapshot, code: &str) -> Snapshot {
        let kind = EventKind::KeyDown(code.parse().expect("a key"));
        step.events.push(OutputEvent { time: TIME, kind });
        step
    }

    /// Returns the clicks of steps that follow a first one without presses.
    fn clicks(layout: &Layout, steps: impl IntoIterator<Item = Snapshot>) -> Vec<Option<Click>> {
        let mut chooser = ClickChooser::default();
        assert_eq!(chooser.update(&step(), layout), None);
        let steps = steps.into_iter();
        steps.map(|step| chooser.update(&step, layout)).collect()
    }

    #[test]
    fn a_press_clicks_and_modifiers_have_another_click() {
        let layout = layout("qwerty-flat");
        let key = target(&layout, "H");
        let both = touch(press(&layout, "ShiftLeft"), key, Phase::Pressed);
        let cases = [
            (press(&layout, "H"), Some(Click::Key)),
            (press(&layout, "ShiftLeft"), Some(Click::Modifier)),
            (both, Some(Click::Key)),
            (touch(step(), key, Phase::Touched), None),
            (touch(step(), key, Phase::Moved), None),
            (step(), None),
        ];
        for (index, (step, expected)) in cases.into_iter().enumerate() {
            assert_eq!(clicks(&layout, [step]), [expected], "case {index}");
        }
    }

    #[test]
    fn switches_click_and_controls_that_are_dragged_do_not() {
        let layout = layout("switches");
        let mut heard = [0, 0];
        for control in &layout.controls {
            let pressed = touch(step(), control.faces[0].target, Phase::Pressed);
            let is_switch = control.kind.handle() == Handle::Switch;
            let expected = is_switch.then_some(Click::Key);
            assert_eq!(clicks(&layout, [pressed]), [expected], "{:?}", control.kind);
            heard[usize::from(is_switch)] += 1;
        }
        assert!(!heard.contains(&0), "{heard:?}");
    }

    #[test]
    fn a_key_that_follows_its_touch_later_clicks_once() {
        let layout = layout("qwerty-flat");
        let released = touch(step(), target(&layout, "H"), Phase::Released);
        let held = down(step(), "ShiftLeft");
        let steps = [press(&layout, "H"), held, down(released, "H")];
        assert_eq!(clicks(&layout, steps), [Some(Click::Key), None, None]);
    }

    #[test]
    fn gestures_without_a_touch_click() {
        let layout = layout("qwerty-flat");
        let steps = [down(step(), "H"), down(step(), "ShiftLeft")];
        let heard = clicks(&layout, steps);
        assert_eq!(heard, [Some(Click::Key), Some(Click::Modifier)]);
    }

    #[test]
    fn suppressed_and_dropped_presses_have_a_click_of_their_own() {
        let layout = layout("qwerty-flat");
        let count: [fn(&mut Stats); 4] = [
            |stats| stats.suppressed.rate_limited += 1,
            |stats| stats.suppressed.system_keys += 1,
            |stats| stats.suppressed.keys_by_role += 1,
            |stats| stats.dropped_presses += 1,
        ];
        for add in count {
            let mut suppressed = press(&layout, "H");
            add(&mut suppressed.stats);
            let mut next = step();
            next.stats = suppressed.stats;
            let heard = clicks(&layout, [suppressed, next]);
            assert_eq!(heard, [Some(Click::Suppressed), None]);
        }
        let mut moved = step();
        moved.stats.suppressed.pointing_by_role += 1;
        assert_eq!(clicks(&layout, [moved]), [None]);
    }

    #[test]
    fn gestures_click_after_a_pause_that_has_released_a_finger() {
        let layout = layout("qwerty-flat");
        let mut paused = step();
        paused.state = PipelineState::Paused;
        let steps = [press(&layout, "H"), paused, down(step(), "J")];
        let heard = clicks(&layout, steps);
        assert_eq!(heard, [Some(Click::Key), None, Some(Click::Key)]);
    }

    #[test]
    fn presses_before_the_first_step_do_not_click() {
        let mut first = step();
        first.stats.suppressed.rate_limited = 7;
        let heard = ClickChooser::default().update(&first, &layout("qwerty-flat"));
        assert_eq!(heard, None);
    }

    #[test]
    fn a_paused_session_is_silent() {
        let layout = layout("qwerty-flat");
        let mut paused = press(&layout, "H");
        paused.state = PipelineState::Paused;
        assert_eq!(clicks(&layout, [paused]), [None]);
    }
}
