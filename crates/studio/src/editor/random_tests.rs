//! Random edits of all shipped layouts.

use fastrand::Rng;

use super::tests::shipped;
use super::*;
use ademan_core::document::shipped_layouts;
use ademan_core::layout::{Control, POINTER};

fn random_parts(editor: &LayoutEditor, random: &mut Rng) -> Vec<Part> {
    let board = random.usize(..editor.count("boards").max(1));
    let mut parts = vec![
        Part::Board(board),
        Part::Row {
            board,
            row: random.usize(..4),
        },
    ];
    let targets = &editor.layout_targets;
    parts.extend((0..4).filter_map(|_| targets.get(random.usize(..targets.len().max(1)))));
    random.shuffle(&mut parts);
    parts.truncate(random.usize(1..=4));
    parts
}

fn random_binding(random: &mut Rng) -> Binding {
    let codes = ["A", "1", "Enter", "ShiftLeft", "MouseLeft", "no key"];
    match random.usize(..5) {
        0 => Binding::Layer("symbols".into()),
        1 => Binding::Text("say \"x\"".into()),
        2 => Binding::Command("nudge 0 0 -10".into()),
        3 => Binding::NoOp,
        _ => Binding::Key((*random.choice(codes).as_ref().unwrap_or(&"A")).into()),
    }
}

fn random_edit(editor: &LayoutEditor, random: &mut Rng) -> Edit {
    let parts = random_parts(editor, random);
    let part = parts[0];
    let board = random.usize(..editor.count("boards").max(1));
    let mut length = || (random.f64() * 400.0).round() / 10.0 - 20.0;
    let (x, y, z) = (length(), length(), length());
    let edges = [AlignEdge::Left, AlignEdge::Top, AlignEdge::CenterX];
    match random.usize(..18) {
        17 => Edit::Mirror {
            parts,
            axis: BoardAxis::X,
        },
        0 | 1 => Edit::Move {
            parts,
            by_mm: [x, y, if random.bool() { 0.0 } else { z }],
        },
        2 => Edit::Resize {
            parts,
            by_mm: [x, y],
            fixed: [-1.0, 1.0],
        },
        3 => Edit::Turn { parts, degrees: x },
        4 => Edit::Tilt { parts, degrees: x },
        5 => Edit::Align {
            parts,
            edge: edges[random.usize(..3)],
        },
        6 => Edit::Distribute {
            parts,
            axis: BoardAxis::X,
        },
        7 => Edit::Snap {
            parts,
            grid_mm: 9.5,
        },
        8 => Edit::Duplicate {
            parts,
            by_mm: [x, y],
        },
        9 => Edit::Delete { parts },
        10 => Edit::Bind {
            part,
            slot: Slot::Base,
            binding: Some(random_binding(random)),
        },
        11 => Edit::Bind {
            part,
            slot: Slot::Layer(0),
            binding: random.bool().then(|| random_binding(random)),
        },
        12 => Edit::SetField {
            parts,
            field: ["travel_mm", "size_mm", "label", "pose.scale", "name"][random.usize(..5)]
                .into(),
            value: random
                .bool()
                .then(|| ["3", "Disc(12)", "\"é\""][random.usize(..3)].into()),
        },
        13 => Edit::Rename {
            part,
            name: format!("new {x}"),
        },
        14 => Edit::Add(NewPart::Control {
            board,
            kind: ControlKind::ALL[random.usize(..ControlKind::ALL.len())],
            at_mm: [x, y],
            binding: None,
        }),
        15 => Edit::Add(match random.usize(..6) {
            0 => NewPart::Board { right_mm: 0.0 },
            1 => NewPart::Layer,
            2 => NewPart::Trigger,
            3 => NewPart::Space,
            4 => NewPart::Pointer,
            _ => NewPart::Row {
                board,
                at_mm: [x, y],
                keys: "F1 F2".into(),
            },
        }),
        _ => {
            let at = editor
                .text
                .floor_char_boundary(random.usize(..=editor.text.len()));
            let mut patch = Patch::default();
            patch.replace(at..at, ["(", "\"", " ", "// x\n"][random.usize(..4)]);
            Edit::ReplaceText(patch)
        }
    }
}

/// Panics unless the editor has either a layout of its text or problems with positions in it.
fn check(editor: &LayoutEditor) {
    for problem in editor.problems() {
        assert!(
            editor.text.get(problem.range.clone()).is_some(),
            "{problem:?}"
        );
        assert!(!problem.message.is_empty());
    }
    if editor.is_valid() {
        let layout = editor.layout().unwrap();
        assert_eq!(layout.text, editor.text);
        // Values of pads, the last ones, are no parts of their own.
        let values = layout.controls.iter().flat_map(Control::value_targets);
        let values = values.filter(|value| layout.control_at(*value).is_none());
        let count = layout.target_names().iter().count() - values.count();
        assert_eq!(count, editor.layout_targets.len());
        for (index, name) in layout.target_names().iter().take(count).enumerate() {
            let part = editor.part_of(TargetId(index as u32)).unwrap();
            let expected = match part {
                Part::Pointer => Some(POINTER.to_owned()),
                part => editor.part_name(part),
            };
            assert_eq!(expected.as_deref(), Some(name));
        }
    }
}

#[test]
fn random_edits_are_undone_and_redone_byte_for_byte() {
    let mut applied = 0;
    for (seed, name) in shipped_layouts().enumerate() {
        let mut random = Rng::with_seed(seed as u64);
        let mut editor = shipped(name);
        check(&editor);
        let mut texts = vec![editor.text.clone()];
        for _ in 0..60 {
            let edit = random_edit(&editor, &mut random);
            let before = editor.text.clone();
            match editor.apply(&edit) {
                Ok(()) => {
                    applied += 1;
                    check(&editor);
                    // An edit that changes nothing is no step.
                    if editor.text != before {
                        texts.push(editor.text.clone());
                    }
                }
                Err(error) => {
                    assert_eq!(editor.text, before, "{name}: {error}");
                    // Text that cannot be read stays so: go back.
                    if error == EditError::Unreadable {
                        editor.undo();
                        texts.pop();
                    }
                }
            }
        }
        let last = editor.text.clone();
        for text in texts.iter().rev().skip(1) {
            assert!(editor.undo());
            assert_eq!(editor.text, *text, "{name}");
        }
        assert!(!editor.undo() && !editor.is_modified());
        for text in &texts[1..] {
            assert!(editor.redo());
            assert_eq!(editor.text, *text, "{name}");
        }
        assert_eq!(editor.text, last);
    }
    assert!(applied > 500, "{applied}");
}
