//! Layouts with faults: they are edited like any other, until they have none.

use super::tests::{control, key};
use super::*;

fn editor(controls: &str) -> LayoutEditor {
    let text = format!(
        "Layout(name: \"a\", boards: [(\n\
         pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),\n{controls})])"
    );
    LayoutEditor::from_text("a.ron", &text, Fit::default())
}

fn move_by(editor: &mut LayoutEditor, part: Part, x: f64) {
    let parts = vec![part];
    let by_mm = [x, 0.0, 0.0];
    editor.apply(&Edit::Move { parts, by_mm }).unwrap();
}

#[test]
fn an_overlap_is_shown_and_moved_apart() {
    let mut editor = editor(
        "keys: [\n(code: \"A\", at_mm: (0, 0)),\n(code: \"B\", at_mm: (10, 0)),\n(code: \"C\", at_mm: (60, 0))]",
    );
    assert!(!editor.is_valid() && editor.is_read());
    let [problem] = editor.problems() else {
        panic!("{:?}", editor.problems());
    };
    assert!(problem.message.contains("by 7 mm"), "{problem:?}");
    assert_eq!((problem.line, problem.part), (Some(5), Some(key(1))));
    let faulty = [0, 1, 2].map(|index| editor.is_faulty(key(index)));
    assert_eq!(faulty, [true, true, false]);
    assert_eq!(editor.part_of(TargetId(1)), Some(key(1)));
    move_by(&mut editor, key(1), 2.0);
    assert!(
        editor.text().contains("(12, 0)"),
        "an overlap locks nothing"
    );
    let parts = vec![key(1)];
    let by_mm = [0.0; 2];
    editor.apply(&Edit::Duplicate { parts, by_mm }).unwrap();
    assert_eq!(editor.layout().unwrap().keys.len(), 4);
    let copies = editor.selection().to_vec();
    editor.apply(&Edit::Delete { parts: copies }).unwrap();
    move_by(&mut editor, key(1), 20.0);
    assert_eq!(editor.problems(), []);
    assert!(editor.is_valid());
}

#[test]
fn two_controls_of_one_name_are_both_there() {
    let mut editor = editor("keys: [(code: \"A\", at_mm: (0, 0)),\n(code: \"A\", at_mm: (40, 0))]");
    assert!(!editor.is_valid() && editor.is_faulty(key(1)));
    assert_eq!(editor.part_of(TargetId(1)), Some(key(1)));
    let part = key(1);
    let binding = Some(Binding::Key("B".into()));
    let slot = Slot::Base;
    let bind = Edit::Bind {
        part,
        slot,
        binding,
    };
    editor.apply(&bind).unwrap();
    assert!(editor.is_valid(), "{:?}", editor.problems());
}

#[test]
fn a_control_without_a_valid_value_keeps_its_written_place() {
    let mut editor = editor(
        "travel_mm: 4000, rows: [(at_mm: (0, 0), keys: \"A B\")], knobs: [(name: \"k\", at_mm: (80, 0), diameter_mm: 40)]",
    );
    assert!(!editor.is_valid() && !editor.is_read() && editor.is_editable());
    let unplaced = editor.unplaced(0);
    let centers: Vec<[f64; 2]> = unplaced.iter().map(|(_, place)| place.center_mm).collect();
    assert_eq!(centers, [[0.0, 0.0], [19.0, 0.0], [80.0, 0.0]]);
    assert!(unplaced[2].1.is_round);
    assert_eq!(unplaced[2].1.size_mm, [40.0; 2]);
    let (knob, _) = unplaced[2];
    move_by(&mut editor, knob, 5.0);
    assert!(editor.text().contains("(85, 0)"));
    let parts = vec![Part::Board(0)];
    let field = "travel_mm".to_owned();
    let value = Some("4".to_owned());
    editor
        .apply(&Edit::SetField {
            parts,
            field,
            value,
        })
        .unwrap();
    assert!(editor.is_valid() && editor.unplaced(0).is_empty());
}

#[test]
fn a_control_that_cannot_be_built_is_beside_the_others() {
    let editor = editor(
        "keys: [(code: \"A\", at_mm: (0, 0))], radios: [(name: \"r\", options: [(name: \"one\", at_mm: (40, 0))])], \
         knobs: [(name: \"k\", at_mm: (80, 0), diameter_mm: 40)]",
    );
    assert!(editor.is_read() && !editor.is_valid());
    let knob = control(ControlKind::Knob, 0);
    assert_eq!(editor.part_of(TargetId(1)), Some(knob));
    let unplaced = editor.unplaced(0);
    let option = Part::RadioOption {
        board: 0,
        radio: 0,
        option: 0,
    };
    assert_eq!(unplaced.len(), 1, "{unplaced:?}");
    assert_eq!(unplaced[0].0, option);
}

#[test]
fn boards_in_one_place_are_a_warning_with_the_distance() {
    let board = "(pose: (anchor: elbow, forward_mm: 300), keys: [(code: \"A\", at_mm: (0, 0))])";
    let other = board.replace("\"A\"", "\"B\"").replace("(0, 0)", "(5, 0)");
    let text = format!("Layout(name: \"a\", boards: [\n{board},\n{other}])");
    let editor = LayoutEditor::from_text("a.ron", &text, Fit::default());
    assert!(editor.is_valid());
    let [problem] = editor.problems() else {
        panic!("{:?}", editor.problems());
    };
    assert_eq!(problem.severity, Severity::Warning);
    assert!(
        problem.message.contains("boards 1 and 2 overlap by"),
        "{problem:?}"
    );
    assert_eq!(problem.line, Some(3));
    assert_eq!(problem.part.and_then(Part::board), Some(1));
}

#[test]
fn unbalanced_brackets_are_the_only_text_that_is_not_edited() {
    let mut editor = editor("keys: [(code: \"A\", at_mm: (0, 0)]");
    assert!(!editor.is_editable() && !editor.is_valid());
    let parts = vec![key(0)];
    let by_mm = [1.0, 0.0, 0.0];
    let refused = editor.apply(&Edit::Move { parts, by_mm });
    assert_eq!(refused, Err(EditError::Unreadable));
}

#[test]
fn controls_are_pasted_as_text_under_free_names() {
    let mut source = editor(
        "rows: [(at_mm: (0, 0), keys: \"A B\")], sliders: [(name: \"fade\", at_mm: (0, 60), length_mm: 60)]",
    );
    let row_key = Part::RowKey {
        board: 0,
        row: 0,
        column: 1,
    };
    let slider = control(ControlKind::Slider, 0);
    source.select([row_key, slider]);
    let text = source.copied().unwrap();
    let paste = |copy: &str, y: f64| Edit::Paste {
        board: 0,
        text: copy.to_owned(),
        by_mm: [0.0, y],
    };
    let mut other = editor("keys: [(code: \"C\", at_mm: (0, 0))]");
    other.apply(&paste(&text, 0.0)).unwrap();
    assert!(other.is_valid(), "{:?}", other.problems());
    let names = |editor: &LayoutEditor| -> Vec<String> {
        let layout = editor.layout().unwrap();
        layout.target_names().iter().map(str::to_owned).collect()
    };
    assert_eq!(names(&other), ["C", "B", "fade"]);
    assert_eq!(other.selection().len(), 2);
    other.apply(&paste(&text, 120.0)).unwrap();
    assert_eq!(names(&other), ["C", "B", "B 2", "fade", "fade 2"]);
    for nonsense in ["", "hello", "(", "(keys: [])", "[1, 2]"] {
        assert!(other.apply(&paste(nonsense, 0.0)).is_err(), "{nonsense}");
    }
}

#[test]
fn several_controls_get_one_number_and_keep_the_others() {
    let mut editor = editor(
        "keys: [(code: \"A\", at_mm: (0, 0)),\n(code: \"B\", at_mm: (40, 7), size_mm: Box(20, 30))]",
    );
    let parts = vec![key(0), key(1)];
    let place = PlaceTo {
        center_mm: [None, Some(12.0)],
        size_mm: [Some(25.0), None],
    };
    editor.apply(&Edit::Place { parts, place }).unwrap();
    let text = editor.text();
    assert!(
        text.contains("at_mm: (0, 12), size_mm: Box(25, 17)"),
        "{text}"
    );
    assert!(
        text.contains("at_mm: (40, 12), size_mm: Box(25, 30)"),
        "{text}"
    );
    assert!(editor.undo() && !editor.can_undo(), "one step");
}

#[test]
fn a_key_is_repeated_in_columns_and_rows() {
    let mut editor = editor("keys: [(code: \"A\", at_mm: (0, 0))]");
    let repeat = |count: [usize; 2]| Edit::Repeat {
        parts: vec![key(0)],
        count,
        pitch_mm: [20.0, -30.0],
    };
    assert!(editor.apply(&repeat([1, 1])).is_err());
    assert!(editor.apply(&repeat([40, 40])).is_err());
    editor.apply(&repeat([3, 2])).unwrap();
    assert!(editor.is_valid(), "{:?}", editor.problems());
    assert_eq!(editor.selection().len(), 6);
    let layout = editor.layout().unwrap();
    let mut centers: Vec<[i32; 2]> = layout
        .keys
        .iter()
        .map(|key| (key.face.row_position * 1e3).round().as_ivec2().to_array())
        .collect();
    centers.sort_unstable();
    assert_eq!(
        centers,
        [[0, -30], [0, 0], [20, -30], [20, 0], [40, -30], [40, 0]]
    );
    assert!(editor.undo() && !editor.can_undo(), "one step");
}
