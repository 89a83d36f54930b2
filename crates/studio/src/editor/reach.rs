//! Warnings about controls that the hands of the session do not reach, or that the simulated hand cannot press.

use std::sync::Arc;
use std::thread;

use crossbeam_channel::{Receiver, TryRecvError, bounded};

use super::{LayoutEditor, Problem, Severity};
use ademan_core::contact::TargetId;
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;
use ademan_runtime::setup::{HandReach, LoadedSetup, TargetOutOfReach, UnpressableControl};

/// The largest number of controls with a warning each: the nearest ones.
const MAX_WARNINGS: usize = 20;

/// The result of a check.
struct Found {
    /// Targets out of reach, the nearest first.
    out_of_reach: Vec<TargetOutOfReach>,
    /// Controls within reach that the simulated hand cannot press.
    without_press: Vec<UnpressableControl>,
}

/// Finds the controls out of reach after each edit, on a thread of its own: 10 000 keys take seconds.
pub struct ReachCheck {
    hands: HandReach,
    setup: LoadedSetup,
    /// The layout that is checked, and its result.
    job: Option<(Arc<Layout>, Receiver<Found>)>,
    /// The layout that was checked last.
    checked: Option<Arc<Layout>>,
    warnings: Vec<Problem>,
}

impl ReachCheck {
    /// Creates the check for the hands of a setup.
    pub fn new(setup: &LoadedSetup) -> Self {
        Self {
            hands: setup.hand_reach(),
            setup: setup.clone(),
            job: None,
            checked: None,
            warnings: Vec::new(),
        }
    }

    /// Returns the hands of the setup that use a layout, at rest.
    pub fn hands_at_rest(&self, layout: &Layout) -> Vec<HandPose> {
        self.setup.hands_at_rest(layout)
    }

    /// The warnings about the layout that was checked last, the nearest control first.
    pub fn warnings(&self) -> &[Problem] {
        &self.warnings
    }

    /// Receives a result, and starts a check if the layout of the editor has changed. Does not wait.
    pub fn advance(&mut self, editor: &LayoutEditor) {
        let Some(layout) = editor.layout() else {
            return;
        };
        if let Some((checked, result)) = &self.job {
            match result.try_recv() {
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {}
                // The targets of an older layout may be others.
                Ok(found) if Arc::ptr_eq(checked, layout) => {
                    self.warnings = warnings(&found, editor, layout);
                }
                Ok(_) => {}
            }
            self.checked = self.job.take().map(|(layout_checked, _)| layout_checked);
        }
        let is_checked = |checked: &Arc<Layout>| Arc::ptr_eq(checked, layout);
        if !self.checked.as_ref().is_some_and(is_checked) {
            self.start(Arc::clone(layout));
        }
    }

    fn start(&mut self, layout: Arc<Layout>) {
        let (sender, result) = bounded(1);
        let (hands, setup) = (self.hands.clone(), self.setup.clone());
        let checked = Arc::clone(&layout);
        let check = move || {
            let out_of_reach = hands.on_boards(&checked);
            let found = Found {
                without_press: setup.controls_without_press(&checked, &out_of_reach),
                out_of_reach,
            };
            // The editor may be closed.
            let _ = sender.send(found);
        };
        // Without a thread there are no warnings; the next edit tries again.
        let _ = thread::Builder::new().name("reach".into()).spawn(check);
        self.job = Some((layout, result));
    }
}

fn warnings(found: &Found, editor: &LayoutEditor, layout: &Layout) -> Vec<Problem> {
    let names = layout.target_names();
    let warning = |target_found: &TargetOutOfReach| {
        let (target, metres) = (target_found.target, target_found.metres());
        let name = names.get(target);
        let message = if metres.is_finite() {
            format!(
                "`{name}` is {:.0} mm out of reach of the hand; move it or its board {}",
                metres * 1e3,
                target_found.step()
            )
        } else {
            format!("`{name}` is out of reach: its board has no position without a second hand")
        };
        problem(message, editor, Some(target))
    };
    let far = &found.out_of_reach;
    let mut warnings: Vec<Problem> = far.iter().take(MAX_WARNINGS).map(warning).collect();
    if let Some(rest) = far.len().checked_sub(MAX_WARNINGS).filter(|rest| *rest > 0) {
        let step = TargetOutOfReach::common_step(&far[MAX_WARNINGS..]);
        let message = format!("{rest} more controls are out of reach; {step}");
        warnings.push(problem(message, editor, None));
    }
    for control in found.without_press.iter().take(MAX_WARNINGS) {
        warnings.push(problem(control.to_string(), editor, Some(control.target)));
    }
    warnings
}

fn problem(message: String, editor: &LayoutEditor, target: Option<TargetId>) -> Problem {
    let part = target.and_then(|target| editor.part_of(target));
    let range = part.and_then(|part| editor.range_of(part));
    let range = range.unwrap_or_default();
    let before = editor.text().get(..range.start).filter(|_| part.is_some());
    let line = before.map(|text| text.matches('\n').count() + 1);
    Problem {
        message,
        severity: Severity::Warning,
        line,
        column: None,
        range,
        part,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::tests::key;
    use crate::editor::{Edit, Part};
    use ademan_core::document::{Document, shipped_layouts};
    use ademan_core::layout::Fit;
    use ademan_runtime::setup::Setup;
    use std::time::{Duration, Instant};

    fn editor(keys: &str) -> LayoutEditor {
        let text = format!(
            "Layout(name: \"a\", boards: [(\n\
             pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),\n\
             keys: [\n(code: \"A\", at_mm: (0, 0)),\n{keys}])])"
        );
        LayoutEditor::from_text("a.ron", &text, Fit::default())
    }

    fn check() -> ReachCheck {
        ReachCheck::new(&Setup::default().load_files().unwrap())
    }

    /// Advances until the layout of the editor is checked.
    fn finish(check: &mut ReachCheck, editor: &LayoutEditor) {
        let deadline = Instant::now() + Duration::from_secs(60);
        check.advance(editor);
        while check.job.is_some() {
            assert!(Instant::now() < deadline, "no result");
            thread::sleep(Duration::from_millis(1));
            check.advance(editor);
        }
    }

    #[test]
    fn a_key_out_of_reach_is_a_warning_until_it_is_moved_nearer() {
        let mut editor = editor("(code: \"B\", at_mm: (900, 0))");
        assert_eq!(editor.problems(), []);
        let mut check = check();
        finish(&mut check, &editor);
        let [warning] = check.warnings() else {
            panic!("{:?}", check.warnings());
        };
        assert!(warning.message.starts_with("`B` is "), "{warning:?}");
        assert_eq!(warning.severity, Severity::Warning);
        assert_eq!(warning.line, Some(5));
        let key = key(1);
        assert_eq!(warning.part, Some(key));
        let nearer = Edit::Move {
            parts: vec![key],
            by_mm: [-880.0, 0.0, 0.0],
        };
        editor.apply(&nearer).unwrap();
        finish(&mut check, &editor);
        assert_eq!(check.warnings(), []);
    }

    #[test]
    fn a_key_that_is_too_near_is_moved_away_and_one_that_is_too_far_nearer() {
        for (at_mm, step) in [("0, -290", "away"), ("0, 400", "nearer")] {
            let editor = editor(&format!("(code: \"B\", at_mm: ({at_mm}))"));
            let mut check = check();
            finish(&mut check, &editor);
            let [warning] = check.warnings() else {
                panic!("{at_mm}: {:?}", check.warnings());
            };
            let message = &warning.message;
            let is_named = message.ends_with(&format!("move it or its board {step}"));
            assert!(is_named, "{at_mm}: {message}");
        }
    }

    /// Returns twelve keys close to each other.
    fn pad() -> String {
        (0..12)
            .map(|index| {
                let (x, y) = (index % 3 * 27 - 27, 33 - index / 3 * 22);
                format!(
                    "(code: \"F{}\", at_mm: ({x}, {y}), size_mm: Box(24, 17)),",
                    index + 1
                )
            })
            .collect()
    }

    #[test]
    fn a_key_that_the_simulated_hand_cannot_press_is_a_warning_until_it_has_room() {
        let pad = pad();
        let text = format!(
            "Layout(name: \"a\", boards: [\n(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, \
             height_mm: -45), keys: [{pad}]),\n(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 190, \
             height_mm: -45, right_mm: -10), shape: Arc(radius_mm: 90), keys: [\n\
             (code: \"Space\", at_mm: (0, 0)), (code: \"Enter\", at_mm: (19, 0))])])"
        );
        let mut editor = LayoutEditor::from_text("pad.ron", &text, Fit::default());
        assert_eq!(editor.problems(), []);
        let mut check = check();
        finish(&mut check, &editor);
        let is_of_hand = |warning: &&Problem| warning.message.contains("by the simulated hand");
        let warnings: Vec<&Problem> = check.warnings().iter().filter(is_of_hand).collect();
        assert!(!warnings.is_empty(), "{:?}", check.warnings());
        for warning in warnings {
            assert_eq!(warning.severity, Severity::Warning);
            assert_eq!(warning.line, Some(4), "{warning:?}");
            assert!(warning.message.contains("would press `F"), "{warning:?}");
        }
        let beside = Edit::SetField {
            parts: vec![Part::Board(1)],
            field: "pose".to_owned(),
            value: Some("(anchor: elbow, bearing_deg: 35, forward_mm: 262.98, height_mm: -45, right_mm: -106.27)".to_owned()),
        };
        editor.apply(&beside).unwrap();
        finish(&mut check, &editor);
        assert_eq!(check.warnings(), []);
    }

    /// Returns a pad of keys and, beside it, an arc of three keys at the wrist for a finger.
    fn pad_with_arc(finger: &str) -> String {
        let pad = pad();
        let key = |(x, code): (i32, &str)| {
            format!("(code: \"{code}\", at_mm: ({x}, 0), finger: \"{finger}\"),")
        };
        let arc: String = [(0, "Space"), (19, "Backspace"), (38, "Enter")]
            .map(key)
            .concat();
        format!(
            "Layout(name: \"a\", boards: [\n(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, \
             height_mm: -45), keys: [{pad}]),\n(pose: (anchor: wrist, bearing_deg: 35, forward_mm: 60, \
             height_mm: -45, right_mm: -95), shape: Arc(radius_mm: 90), keys: [{arc}])])"
        )
    }

    #[test]
    fn a_key_that_the_named_finger_does_not_press_is_one_warning() {
        let mut is_tested = false;
        for finger in ["index", "thumb"] {
            let editor = LayoutEditor::from_text("pad.ron", &pad_with_arc(finger), Fit::default());
            assert!(editor.is_valid(), "{:?}", editor.problems());
            let mut check = check();
            finish(&mut check, &editor);
            let mut setup = Setup::default().load_files().unwrap();
            setup.layout = Layout::clone(editor.layout().unwrap());
            let tour = setup.tour();
            let codes = ["Space", "Backspace", "Enter"];
            let left_out = codes.iter().filter(|code| {
                let line = format!("\ntap {code};");
                !tour.contains(&line)
            });
            let left_out: Vec<_> = left_out.collect();
            is_tested |= !left_out.is_empty();
            for code in left_out {
                let start = format!("`{code}` ");
                let rows = check.warnings().iter();
                let rows = rows.filter(|warning| warning.message.starts_with(&start));
                assert_eq!(rows.count(), 1, "{finger}, {code}: {:?}", check.warnings());
            }
        }
        assert!(is_tested, "every key is pressed");
    }

    #[test]
    fn the_simulated_hand_presses_every_control_of_a_shipped_layout() {
        let setup = Setup::default().load_files().unwrap();
        for name in shipped_layouts() {
            let document = Document::shipped(name).unwrap();
            // A layout for other hands is left out.
            let Ok(layout) = Layout::for_hands(document, setup.layout.fit) else {
                continue;
            };
            let out_of_reach = setup.hand_reach().on_boards(&layout);
            let without_press = setup.controls_without_press(&layout, &out_of_reach);
            assert_eq!(without_press, [], "{name}");
        }
    }

    #[test]
    fn many_keys_out_of_reach_are_few_warnings() {
        let key = |index: usize| {
            let at = 900 + 20 * index;
            format!("(code: \"B\", name: \"k{index}\", at_mm: ({at}, 0)),")
        };
        let keys: String = (0..50).map(key).collect();
        let editor = editor(&keys);
        let mut check = check();
        finish(&mut check, &editor);
        assert_eq!(check.warnings().len(), MAX_WARNINGS + 1);
        assert!(check.warnings()[0].message.starts_with("`k0`"));
        let last = check.warnings().last().unwrap();
        assert!(last.message.starts_with("30 more"), "{}", last.message);
    }
}
