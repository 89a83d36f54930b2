//! The text that each edit writes.

use super::*;
use ademan_core::document::{Document, shipped_layouts};

pub(super) fn shipped(name: &str) -> LayoutEditor {
    let text = Document::shipped(name).unwrap().text;
    LayoutEditor::from_text(name, &text, Fit::default())
}

fn editor(boards: &str) -> LayoutEditor {
    let text = format!("// mine\nLayout(name: \"a\", boards: [\n{boards}\n])\n");
    LayoutEditor::from_text("a.ron", &text, Fit::default())
}

/// Returns the text of the boards after an edit of `boards`.
fn edited(boards: &str, edit: &Edit) -> String {
    let mut editor = editor(boards);
    assert_eq!(editor.problems(), []);
    editor.apply(edit).unwrap();
    let text = editor.text();
    let start = "// mine\nLayout(name: \"a\", boards: [\n".len();
    text[start..text.len() - "\n])\n".len()].to_owned()
}

/// Returns a control of the first board.
pub(crate) const fn control(kind: ControlKind, index: usize) -> Part {
    Part::control(0, kind, index)
}

/// Returns a key of the first board that is not in a row.
pub(crate) const fn key(index: usize) -> Part {
    control(ControlKind::Key, index)
}

fn in_row(column: usize) -> Part {
    Part::RowKey {
        board: 0,
        row: 0,
        column,
    }
}

#[test]
fn a_key_of_a_row_is_moved_out_of_it_and_a_whole_row_as_one() {
    let board = "    (\n        pose: (anchor: elbow),\n        rows: [\n            (at_mm: (0.0, 1.50), keys: \"Q W  E\"), // top\n        ],\n    ),";
    let moved = |parts| {
        edited(
            board,
            &Edit::Move {
                parts,
                by_mm: [0.0, 40.0, 0.0],
            },
        )
    };
    assert_eq!(
        moved(vec![in_row(0), in_row(1), in_row(2)]),
        board.replace("1.50", "41.5")
    );
    let expected = board
        .replace(
            "(at_mm: (0.0, 1.50), keys: \"Q W  E\")",
            "(at_mm: (0.0, 1.50), keys: \"Q\"),\n            (at_mm: (38, 1.50), keys: \"E\")",
        )
        .replace(
            "        ],\n    ),",
            "        ],\n        keys: [\n            (code: \"W\", at_mm: (19, 41.5)),\n        ],\n    ),",
        );
    assert_eq!(moved(vec![in_row(1)]), expected);
}

#[test]
fn a_corner_stays_while_a_turned_key_is_resized() {
    let board =
        "(pose: (anchor: elbow), keys: [(code: \"A\", at_mm: (0, 0), rotation_deg: (0, 0, 90))])";
    let edit = Edit::Resize {
        parts: vec![key(0)],
        by_mm: [10.0, 0.0],
        fixed: [-1.0, -1.0],
    };
    assert_eq!(
        edited(board, &edit),
        board
            .replace("(0, 0), ro", "(0, 5), ro")
            .replace("90)", "90), size_mm: Box(27, 17)")
    );
}

#[test]
fn controls_are_aligned_and_distributed_by_their_outlines() {
    let board = "(pose: (anchor: elbow), keys: [(code: \"A\", at_mm: (0, 0)), (code: \"B\", at_mm: (30, 1), size_mm: Box(27, 17)), (code: \"C\", at_mm: (100, 0))])";
    let parts = || vec![key(0), key(1), key(2)];
    let align = Edit::Align {
        parts: parts(),
        edge: AlignEdge::Bottom,
    };
    assert_eq!(edited(board, &align), board.replace("(30, 1)", "(30, 0)"));
    let distribute = Edit::Distribute {
        parts: parts(),
        axis: BoardAxis::X,
    };
    assert_eq!(
        edited(board, &distribute),
        board.replace("(30, 1)", "(50, 1)")
    );
}

#[test]
fn a_key_of_a_row_is_bound_within_the_row_and_layers_follow() {
    let mut editor = shipped("qwerty-two-arc");
    let original = editor.text().to_owned();
    let bind = |code: &str| Edit::Bind {
        part: in_row(0),
        slot: Slot::Base,
        binding: Some(Binding::Key(code.into())),
    };
    editor.apply(&bind("F1")).unwrap();
    let expected = original
        .replace("\"Q W E R T\"", "\"F1 W E R T\"")
        .replace("\"Q\": \"1\"", "\"F1\": \"1\"");
    assert_eq!(editor.text(), expected);
    editor.undo();
    editor.apply(&bind("A")).unwrap();
    assert!(editor.is_valid(), "{:?}", editor.problems());
    assert!(
        editor
            .text()
            .contains("(code: \"A\", at_mm: (-38, 28.5), name: \"Q\"),")
    );
}

#[test]
fn a_key_stays_in_its_row_if_a_held_action_is_removed_that_it_does_not_have() {
    let mut editor = shipped("qwerty-two-arc");
    let original = editor.text().to_owned();
    let unbind = Edit::Bind {
        part: in_row(0),
        slot: Slot::Hold,
        binding: None,
    };
    editor.apply(&unbind).unwrap();
    assert_eq!(editor.text(), original);
    assert_eq!(editor.selection(), [in_row(0)]);
}

#[test]
fn a_latch_in_a_line_of_its_own_goes_with_the_action_that_has_it() {
    let board = "    (\n        pose: (anchor: elbow),\n        keys: [\n            (\n                code: \"ShiftLeft\",\n                at_mm: (0, 0),\n                latch: Lock,\n            ),\n        ],\n    ),";
    let bind = Edit::Bind {
        part: key(0),
        slot: Slot::Base,
        binding: None,
    };
    let expected = board
        .replace("code: \"ShiftLeft\"", "action: NoOp")
        .replace("latch: Lock", "name: \"ShiftLeft\"");
    assert_eq!(edited(board, &bind), expected);
}

#[test]
fn deleted_keys_leave_no_mention() {
    let mut editor = shipped("chords-bend");
    editor
        .apply(&Edit::Delete {
            parts: vec![key(0)],
        })
        .unwrap();
    assert!(editor.is_valid(), "{:?}", editor.problems());
    assert!(!editor.text().contains("\"T I\""));
    assert!(editor.text().contains("// Chords of bent fingers"));
    let mut arc = shipped("qwerty-two-arc");
    arc.apply(&Edit::Delete {
        parts: vec![in_row(2)],
    })
    .unwrap();
    assert!(arc.is_valid(), "{:?}", arc.problems());
    assert!(!arc.text().contains("\"E\": "));
}

#[test]
fn every_kind_of_part_is_added_and_is_valid() {
    for &kind in ControlKind::ALL {
        let mut editor = shipped("numpad");
        let add = Edit::Add(NewPart::Control {
            board: 0,
            kind,
            at_mm: [0.0, 200.0],
            binding: None,
        });
        editor.apply(&add).unwrap();
        assert!(editor.is_valid(), "{kind:?}: {:?}", editor.problems());
        let part = editor.selection()[0];
        let parts = vec![part];
        let by_mm = [0.0, 100.0];
        editor.apply(&Edit::Duplicate { parts, by_mm }).unwrap();
        assert!(editor.is_valid(), "{kind:?}: {:?}", editor.problems());
        assert_ne!(editor.selection(), [part]);
    }
    for new in [
        NewPart::Board { right_mm: 0.0 },
        NewPart::Trigger,
        NewPart::Pointer,
        NewPart::Space,
        NewPart::Layer,
    ] {
        let mut editor = shipped("numpad");
        editor.apply(&Edit::Add(new.clone())).unwrap();
        assert!(editor.is_valid(), "{new:?}: {:?}", editor.problems());
        assert!(editor.range_of(editor.selection()[0]).is_some());
    }
}

#[test]
fn the_selected_keys_become_a_chord() {
    let mut editor = shipped("qwerty-flat");
    editor.select([in_row(0), Part::Layout, in_row(1)]);
    let keys = editor.selected_keys();
    assert_eq!(keys, ["Backquote", "1"]);
    let binding = Binding::Key("F1".into());
    editor
        .apply(&Edit::Add(NewPart::Chord { keys, binding }))
        .unwrap();
    assert!(editor.is_valid(), "{:?}", editor.problems());
    assert!(
        editor
            .text()
            .contains("(keys: \"Backquote 1\", action: Key(\"F1\"))")
    );
}

#[test]
fn a_target_in_space_is_added_beside_the_others() {
    let mut editor = shipped("numpad");
    editor.apply(&Edit::Add(NewPart::Space)).unwrap();
    for expected in [120.0, 240.0] {
        let at_mm = beside(&editor.targets_in(0));
        assert_eq!(at_mm, [expected, 0.0, 0.0]);
        let add = NewPart::SpaceTarget { space: 0, at_mm };
        editor.apply(&Edit::Add(add)).unwrap();
        assert!(editor.is_valid(), "{:?}", editor.problems());
    }
    assert_eq!(editor.targets_in(0).len(), 3);
}

#[test]
fn a_control_that_is_added_onto_another_is_a_part_like_it() {
    let mut editor = editor("(pose: (anchor: elbow), keys: [(code: \"A\", at_mm: (0, 0))])");
    let add = |at_mm| {
        Edit::Add(NewPart::Control {
            board: 0,
            kind: ControlKind::Key,
            at_mm,
            binding: None,
        })
    };
    editor.apply(&add([0.0, 1.0])).unwrap();
    assert!(!editor.is_valid());
    assert_eq!(editor.part_of(TargetId(1)), Some(key(1)));
    assert_eq!(editor.selection(), [key(1)]);
    editor.undo();
    assert!(editor.is_valid() && editor.part_of(TargetId(1)).is_none());
}

#[test]
fn all_errors_are_problems_with_the_part_at_their_position() {
    let board = "(pose: (anchor: elbow), rows: [(at_mm: (0, 0), keys: \"A Bx C\")], knobs: [(name: \"K\", at_mm: (0, 90), diameter_mm: 900)], keys: [(code: \"Nope\", at_mm: (0, 30))])";
    let mut editor = editor(board);
    let parts: Vec<_> = editor
        .problems()
        .iter()
        .map(|problem| problem.part)
        .collect();
    let knob = control(ControlKind::Knob, 0);
    assert_eq!(parts, [Some(knob)]);
    editor
        .apply(&Edit::SetField {
            parts: vec![knob],
            field: "diameter_mm".into(),
            value: Some("40".into()),
        })
        .unwrap();
    let problems = editor.problems();
    let faulty: Vec<_> = problems.iter().map(|problem| problem.part).collect();
    assert_eq!(faulty, [Some(in_row(1)), Some(key(0))]);
    assert_eq!(&editor.text()[problems[0].range.clone()], "Bx");
}

#[test]
fn a_drag_is_one_step() {
    let mut editor = shipped("numpad");
    let original = editor.text().to_owned();
    let part = editor.part_of(TargetId(0)).unwrap();
    let drag = |x: f64| Edit::Move {
        parts: vec![part],
        by_mm: [x, 300.0, 0.0],
    };
    editor.apply(&drag(1.0)).unwrap();
    for x in 2..10 {
        editor.amend(&drag(f64::from(x))).unwrap();
    }
    let mut once = shipped("numpad");
    once.apply(&drag(9.0)).unwrap();
    assert_eq!(editor.text(), once.text());
    assert!(editor.undo());
    assert_eq!(editor.text(), original);
}

#[test]
fn an_edit_that_changes_nothing_is_no_step_and_leaves_what_can_be_redone() {
    let board = "(pose: (anchor: elbow), keys: [(code: \"A\", at_mm: (0, 0))])";
    let mut editor = editor(board);
    let original = editor.text().to_owned();
    let drag = |x: f64| Edit::Move {
        parts: vec![key(0)],
        by_mm: [x, 0.0, 0.0],
    };
    let same = Edit::SetField {
        parts: vec![key(0)],
        field: "code".into(),
        value: Some("\"A\"".into()),
    };
    editor.apply(&same).unwrap();
    assert!(!editor.can_undo());
    editor.apply(&drag(5.0)).unwrap();
    let moved = editor.text().to_owned();
    assert!(editor.undo());
    editor.apply(&same).unwrap();
    assert!(editor.can_redo(), "the field has the value already");
    for x in [1.0, 2.0, 0.0] {
        editor.amend(&drag(x)).unwrap();
    }
    assert!(!editor.can_undo());
    assert_eq!(editor.text(), original);
    assert!(editor.can_redo(), "the drag ends where it began");
    editor.amend(&drag(3.0)).unwrap();
    assert!(!editor.can_redo());
    assert!(editor.take_back());
    assert_eq!(editor.text(), original);
    assert!(editor.redo(), "the drag was taken back");
    assert_eq!(editor.text(), moved);
}

#[test]
fn a_field_of_a_form_exists_in_the_format() {
    let mut seen = std::collections::BTreeSet::new();
    for name in shipped_layouts() {
        let mut editor = shipped(name);
        let boards = (0..editor.count("boards")).map(Part::Board);
        let parts: Vec<Part> = boards.chain(editor.layout_targets.clone()).collect();
        for part in parts {
            for spec in fields_of(part) {
                if !seen.insert((part.kind_name(), spec.name)) {
                    continue;
                }
                let field = spec.name.to_owned();
                let value = Some("Nothing".to_owned());
                let set = Edit::SetField {
                    parts: vec![part],
                    field,
                    value,
                };
                // The field that contains it is missing.
                if editor.apply(&set).is_err() {
                    continue;
                }
                let mut problems = editor.problems().iter();
                let has_unknown = problems.any(|it| it.message.contains("unknown field"));
                assert!(!has_unknown, "{name}: {spec:?} {:?}", editor.problems());
                editor.undo();
            }
        }
    }
    assert!(seen.len() > 100, "{}", seen.len());
}

#[test]
fn a_number_is_read_however_it_is_written() {
    let editor = editor(
        "(pose: (anchor: elbow, forward_mm: Some(320), tilt_deg: -2.50), keys: [(code: \"A\", at_mm: (0, 0))])",
    );
    assert_eq!(editor.problems(), []);
    let number = |field: &str| editor.number(Part::Board(0), field);
    assert_eq!(number("pose.forward_mm"), Some(320.0));
    assert_eq!(number("pose.tilt_deg"), Some(-2.5));
    assert_eq!(number("pose.right_mm"), None);
    assert_eq!(number("pose.anchor"), None);
}
