//! Layouts in words, for what a drawing cannot show: ranges, outputs, gestures and chords.

use crate::contact::TargetId;
use crate::contact::board_pose::BoardPose;
use crate::contact::surface::{Anchor, Surface};
use crate::device::keyboard::{Activation, Chord, TapHold};
use crate::device::toggle::ToggleOutput;
use crate::device::trigger::{CircleDirection, Measure, Trigger};
use crate::device::value_output::ValueOutput;
use crate::device::{KeyAction, Latch, Sequence, SequenceStep, TextId};
use crate::hand::Joint;
use crate::layout::board_shape::BoardShape;
use crate::layout::controls::{pointer, space};
use crate::layout::model::{Board, Control, Face, Key, Layout};
use crate::message::escape;

/// A list under a heading.
pub(super) struct List {
    /// Heading.
    pub heading: &'static str,
    /// The lines: a name and its description.
    pub rows: Vec<(String, String)>,
}

/// Returns the lists of a layout that are not empty: keys that do more than press one key,
/// controls, triggers, pointer, targets in space.
pub(super) fn lists(layout: &Layout) -> Vec<List> {
    let words = Words(layout);
    let keys = layout.keys.iter().filter_map(|key| words.key(key));
    let controls = layout.controls.iter();
    let triggers = layout.triggers.iter();
    let mode = layout
        .text_mode
        .map(|it| ("mode".to_owned(), it.to_string()));
    let lists = [
        List {
            heading: "Bends",
            rows: words.bends(),
        },
        List {
            heading: "Special keys",
            rows: grouped(keys),
        },
        List {
            heading: "Sequences",
            rows: layout.sequence_rows(),
        },
        List {
            heading: "Text decoder",
            rows: mode.into_iter().collect(),
        },
        List {
            heading: "Controls",
            rows: controls
                .flat_map(|control| words.control(control))
                .collect(),
        },
        List {
            heading: "Triggers",
            rows: triggers
                .map(|(name, trigger)| (name.clone(), words.trigger(trigger)))
                .collect(),
        },
        List {
            heading: "Pointer",
            rows: layout
                .pointer
                .as_ref()
                .map_or(Vec::new(), |pointer| pointer::describe(pointer, &words)),
        },
        List {
            heading: "Targets",
            rows: layout
                .spaces
                .iter()
                .flat_map(|targets| space::describe(targets, &words))
                .collect(),
        },
    ];
    lists
        .into_iter()
        .filter(|list| !list.rows.is_empty())
        .collect()
}

/// Joins the names of rows with the same description, or counts them if they are many.
fn grouped(rows: impl Iterator<Item = (String, String)>) -> Vec<(String, String)> {
    /// The largest number of names in a row.
    const MAX_NAMES: usize = 2;
    let mut groups: Vec<(Vec<String>, String)> = Vec::new();
    for (name, description) in rows {
        match groups.iter_mut().find(|(_, other)| *other == description) {
            Some((names, _)) => names.push(name),
            None => groups.push((vec![name], description)),
        }
    }
    let groups = groups.into_iter().map(|(names, description)| {
        let title = if names.len() > MAX_NAMES {
            format!("{} keys", names.len())
        } else {
            names.join(", ")
        };
        (title, description)
    });
    groups.collect()
}

impl Layout {
    /// Returns what each sequence does, in rows of a name and some of its steps; the further rows of a sequence have no name. No
    /// text is shortened, and none acts on a terminal.
    pub fn sequence_rows(&self) -> Vec<(String, String)> {
        let words = Words(self);
        let sequences = self.sequences.iter();
        sequences.flat_map(|it| words.sequence(it)).collect()
    }
}

/// A chord in words.
pub(super) struct ChordWords<'a> {
    /// The chord.
    pub chord: &'a Chord,
    /// The keys.
    pub keys: String,
    /// The label of its action.
    pub action: String,
}

/// Describes the action of a key in a layer, or returns `None` if the layer does not change the key.
pub(super) fn in_layer(layout: &Layout, key: &Key, layer: usize) -> Option<String> {
    let action = (*key.actions.get(layer)?)?;
    Some(Words(layout).action(action))
}

/// Returns the chords with an action of their own in a layer.
pub(super) fn chords(layout: &Layout, layer: usize) -> Vec<ChordWords<'_>> {
    let words = Words(layout);
    let chords = layout.chords.iter().filter_map(|chord| {
        let action = (*chord.actions.get(layer)?)?;
        let keys = chord.keys.iter().filter_map(|target| layout.face(*target));
        let names: Vec<&str> = keys.map(|face| face.name.as_str()).collect();
        let mut action = words.action(action);
        if layer == 0 {
            let activation = words.activation(chord.activation);
            action.extend(activation.map(|activation| format!(" ({activation})")));
        }
        Some(ChordWords {
            chord,
            keys: names.join(" "),
            action,
        })
    });
    chords.collect()
}

/// Describes the pose and shape of a board: `elbow: 300 mm ahead, 35° to the right, 45 mm below, level`.
pub(super) fn board(board: &Board, surface: &Surface) -> String {
    if surface.is_bent() {
        let hand = surface.side().map(|side| format!("{side} hand, "));
        let hand = hand.unwrap_or_default();
        return format!("{hand}pressed by bending a finger, wherever the hand is");
    }
    let pose = BoardPose::from_pose(&surface.anchor_from_surface());
    let mut parts = Vec::new();
    let mut add = |metres: f32, [positive, negative]: [&str; 2]| {
        let millimetres = (metres * 1e3).round();
        if millimetres != 0.0 {
            let direction = if millimetres > 0.0 {
                positive
            } else {
                negative
            };
            parts.push(format!("{:.0} mm {direction}", millimetres.abs()));
        }
    };
    add(pose.forward, ["ahead", "behind"]);
    add(pose.right, ["to the right", "to the left"]);
    add(pose.height, ["above", "below"]);
    parts.extend(bearing(pose.bearing));
    parts.push(tilt(pose.tilt));
    let radius = |radius: f32| format!("{:.0} mm", radius * 1e3);
    match board.shape {
        BoardShape::Flat => {}
        BoardShape::Arc(at_zero) => parts.push(format!("rows on arcs of {}", radius(at_zero))),
        BoardShape::CurvedRows(axis) => parts.push(format!("rows around {}", radius(axis))),
        BoardShape::CurvedColumns(axis) => parts.push(format!("columns around {}", radius(axis))),
    }
    let hand = surface.side().map(|side| format!("{side} hand, "));
    let anchor = anchor(surface.anchor());
    format!(
        "{}from the {anchor}: {}",
        hand.unwrap_or_default(),
        parts.join(", ")
    )
}

/// Returns the name of an anchor.
pub(super) fn anchor(anchor: Anchor) -> &'static str {
    match anchor {
        Anchor::World => "origin",
        Anchor::Joint(Joint::Wrist) => "wrist",
        Anchor::Joint(_) => "elbow",
        Anchor::Start => "start",
        Anchor::OtherHand => "other wrist",
        Anchor::Body(point) => point.name(),
    }
}

/// Describes a bearing, or returns `None` for straight ahead.
fn bearing(radians: f32) -> Option<String> {
    let degrees = radians.to_degrees().round();
    let direction = if degrees > 0.0 { "right" } else { "left" };
    (degrees != 0.0).then(|| format!("turned {:.0}° to the {direction}", degrees.abs()))
}

/// Describes a tilt.
pub(super) fn tilt(radians: f32) -> String {
    match radians.to_degrees().round() {
        0.0 => "level".into(),
        degrees => format!("tilt {degrees:.0}°"),
    }
}

/// Returns the functions of a key beside its press, in a few characters; empty if there are none.
pub(super) fn key_notes(layout: &Layout, key: &Key) -> Vec<String> {
    let words = Words(layout);
    let mut notes: Vec<String> = Vec::new();
    match key.activation {
        Activation::OnPress => {}
        Activation::OnRelease => notes.push("release".into()),
        Activation::Dwell(time) => notes.push(format!("{} ms", time.as_millis())),
        Activation::TapHold(TapHold { hold_action, .. }) => {
            notes.push(format!("hold {}", words.action(hold_action)));
        }
    }
    if key.reports_depth || key.output != ValueOutput::ValueOnly {
        notes.push("depth".into());
    }
    notes
}

/// The length of a row of steps, in characters.
const ROW_LENGTH: usize = 60;

/// Describes a text that is typed.
fn types(text: &str) -> String {
    format!("types `{}`", escape(text))
}

/// Describes the duration of a modifier or layer.
fn duration(latch: Latch) -> &'static str {
    match latch {
        Latch::Momentary => "",
        Latch::OneShot => " for the next key",
        Latch::Lock => " until the next tap",
    }
}

/// Returns the label of a control, with its name if that is another word.
fn title(face: &Face) -> String {
    if face.label == face.name {
        face.name.clone()
    } else {
        format!("{} ({})", face.label, face.name)
    }
}

/// Describes the controls of a layout.
pub struct Words<'a>(&'a Layout);

impl Words<'_> {
    /// Returns the label of an action, with its duration.
    pub fn action(&self, action: KeyAction) -> String {
        let label = self.0.action_label(action);
        match action {
            KeyAction::Layer(_, latch) => format!("layer {label}{}", duration(latch)),
            KeyAction::Modifier(_, latch) => format!("{label}{}", duration(latch)),
            KeyAction::Sequence(_) => format!("sequence {label}"),
            KeyAction::Multitap(_) => format!("one of {}", escape(label)),
            _ => label.to_owned(),
        }
    }

    /// Returns the steps of a sequence in short rows, the first of which has its name: nothing that it types may be cut.
    fn sequence(&self, sequence: &Sequence) -> Vec<(String, String)> {
        let mut rows: Vec<(String, String)> = Vec::new();
        for step in self.steps(&sequence.steps) {
            match rows.last_mut() {
                Some((_, row)) if row.chars().count() + step.chars().count() <= ROW_LENGTH => {
                    row.push_str(", ");
                    row.push_str(&step);
                }
                Some((_, row)) => {
                    row.push(',');
                    rows.push((String::new(), step));
                }
                None => rows.push((escape(&sequence.name).into_owned(), step)),
            }
        }
        rows
    }

    /// Describes steps, the keys of a tap as one.
    fn steps(&self, steps: &[SequenceStep]) -> Vec<String> {
        let mut described = Vec::new();
        let mut tapped: Vec<&str> = Vec::new();
        for step in steps {
            match *step {
                SequenceStep::Press(code) => tapped.push(code.name()),
                SequenceStep::Release => {
                    described.push(format!("taps {}", tapped.join("+")));
                    tapped.clear();
                }
                SequenceStep::Text(TextId(text)) => {
                    let text = self.0.texts.get(usize::from(text));
                    described.push(types(text.map_or("?", String::as_str)));
                }
                SequenceStep::Wait(time) => {
                    // Durations of a file are whole microseconds; the product of seconds is not exact.
                    let milliseconds = time.as_micros() as f64 / 1e3;
                    described.push(format!("waits {milliseconds} ms"));
                }
            }
        }
        described
    }

    /// Returns the names and the thresholds of keys that are pressed by bending.
    fn bends(&self) -> Vec<(String, String)> {
        let keys = self.0.keys.iter().filter_map(|key| {
            let (surface, target) = self.0.scene.target(key.face.target)?;
            let finger = surface.bent_by(key.face.target)?;
            let percent = |bend: f32| (bend * 100.0).round();
            let description = format!(
                "{finger} bent beyond {} %, until {} %",
                percent(target.press_at),
                percent(target.release_at)
            );
            Some((title(&key.face), description))
        });
        keys.collect()
    }

    /// Describes an activation other than by a press.
    fn activation(&self, activation: Activation) -> Option<String> {
        match activation {
            Activation::OnPress => None,
            Activation::OnRelease => Some("acts at the release".to_owned()),
            Activation::Dwell(time) => {
                Some(format!("acts after a touch of {} ms", time.as_millis()))
            }
            Activation::TapHold(TapHold {
                hold_action,
                hold_after,
            }) => Some(format!(
                "held for {} ms: {}",
                hold_after.as_millis(),
                self.action(hold_action)
            )),
        }
    }

    /// Returns the name and the description of a key that does more than press one key.
    fn key(&self, key: &Key) -> Option<(String, String)> {
        let mut parts = Vec::from_iter(self.activation(key.activation));
        match key.action(0) {
            Some(action @ (KeyAction::Modifier(_, latch) | KeyAction::Layer(_, latch)))
                if latch != Latch::Momentary =>
            {
                parts.push(self.action(action));
            }
            Some(action @ KeyAction::Text(_)) => parts.push(types(self.0.action_label(action))),
            Some(action @ (KeyAction::Sequence(_) | KeyAction::Multitap(_))) => {
                parts.push(self.action(action))
            }
            Some(KeyAction::Command(command)) => parts.push(format!("command `{command}`")),
            _ => {}
        }
        if key.output != ValueOutput::ValueOnly {
            parts.push(format!("depth{}", self.value_output(key.output)));
        } else if key.reports_depth {
            parts.push("reports its depth".into());
        }
        (!parts.is_empty()).then(|| (title(&key.face), parts.join(", ")))
    }

    fn control(&self, control: &Control) -> Vec<(String, String)> {
        let descriptions = control.kind.model().describe(self);
        control.faces.iter().map(title).zip(descriptions).collect()
    }

    /// Describes the output of a switch, with a comma before it.
    pub fn switched(&self, output: ToggleOutput) -> String {
        match output {
            ToggleOutput::ValueOnly => String::new(),
            ToggleOutput::Hold(action) => format!(", holds {}", self.action(action)),
            ToggleOutput::Tap(action) => format!(", taps {}", self.action(action)),
        }
    }

    /// Describes the output of a value, with a comma before it.
    pub fn value_output(&self, output: ValueOutput) -> String {
        match output {
            ValueOutput::ValueOnly => String::new(),
            ValueOutput::Axis(axis) => format!(", axis {axis}"),
            ValueOutput::ScrollX(detents) => format!(", wheel {detents} to the right"),
            ValueOutput::ScrollY(detents) => format!(", wheel {detents} up"),
            ValueOutput::MoveX(pixels) => format!(", pointer {pixels} px to the right"),
            ValueOutput::MoveY(pixels) => format!(", pointer {pixels} px up"),
            ValueOutput::Taps {
                increase,
                decrease,
                steps,
            } => format!(
                ", {steps} taps of {} or {}",
                self.action(increase),
                self.action(decrease)
            ),
        }
    }

    fn trigger(&self, trigger: &Trigger) -> String {
        let mut parts = vec![match trigger.measure {
            Measure::Angle(dof) => format!("{dof} {:.0}°", trigger.on.to_degrees()),
            Measure::Pinch(finger) => format!("{finger} pinch, {:.0} mm", trigger.on * 1e3),
            Measure::HandShape(shape) => format!("{shape}, confidence {:.2}", trigger.on),
            Measure::Swipe(direction) => format!("swipe {direction}, {:.0} mm", trigger.on * 1e3),
            Measure::Shake => format!("shake, {:.0} reversals", trigger.on),
            Measure::Circle(point, direction) => {
                let direction = direction.map_or("either direction", CircleDirection::name);
                format!(
                    "circle of the {point}, {direction}, {:.1} turns",
                    trigger.on
                )
            }
            Measure::Sequence(steps) => {
                let step = |target: &TargetId| {
                    let mut triggers = self.0.triggers.iter();
                    Some(triggers.find(|(_, it)| it.target == *target)?.0.as_str())
                };
                let names: Vec<&str> = steps.targets.iter().flatten().filter_map(step).collect();
                let within = steps.within.as_millis();
                format!("{} within {within} ms", names.join(", then "))
            }
            Measure::Input(input) => format!("glove {input}, from {:.2}", trigger.on),
            Measure::Body(angle) => format!("{angle} {:.0}°", trigger.on.to_degrees()),
        }];
        parts.extend(
            trigger
                .held
                .map(|held| format!("while glove {held} is held")),
        );
        parts.extend(trigger.side.map(|side| format!("{side} hand")));
        if !trigger.hold.is_zero() {
            parts.push(format!("for {} ms", trigger.hold.as_millis()));
        }
        if let Some(action) = trigger.action {
            parts.push(format!("holds {}", self.action(action)));
        }
        parts.join(", ") + &self.value_output(trigger.output)
    }
}
