//! Layouts are searched for better ones, and layouts of other programs are imported.

mod support;

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

use ademan_core::document::Document;
use ademan_core::layout::Layout;
use ademan_lab::import::{ImportHands, import};
use ademan_lab::improve::{Found, ImproveError, MoveKind, Moves, Objective, Task, improve};
use ademan_lab::people::{Participant, People, Tier, population};
use ademan_lab::phrases::Corpus;
use ademan_lab::sim::fluent::SourceKind;
use support::steady;

/// Keys of digits in a bad order for the phrases, and a key that is too small.
const PAD: &str = r#"// The order is mine.
Layout(
    name: "pad", // a name
    boards: [
        (
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 310, height_mm: -45), // before the elbow
            pitch_mm: 22,
            rows: [
                (at_mm: (-88, 0), keys: "1 3 5 7 9 0 8 6 2"), // a row
            ],
            keys: [(code: "4", at_mm: (0, 30), size_mm: Box(4, 4))],
        ),
    ],
)
"#;

struct Search {
    text: &'static str,
    people: Vec<Participant>,
    corpus: Corpus,
    kinds: Vec<MoveKind>,
    keep: Vec<String>,
    objective: &'static str,
    steps: u32,
    jobs: usize,
    margin: f32,
}

impl Search {
    fn new(kind: MoveKind, objective: &'static str) -> Self {
        Self {
            text: PAD,
            people: population(&People::Drawn(4), Some(Tier::T0), 3),
            corpus: Corpus::from_text("pad", "1212121212\n2121211212\n1221 1212\n2112211")
                .expect("digits"),
            kinds: vec![kind],
            keep: Vec::new(),
            objective,
            steps: 25,
            jobs: 1,
            margin: 0.0,
        }
    }

    fn run(
        &self,
        cancel: &AtomicBool,
        mut progress: impl FnMut(u32),
    ) -> Result<Found, ImproveError> {
        let objective: Objective = self.objective.parse().expect("an objective");
        let task = Task {
            document: &Document::new("pad.ron", self.text),
            people: &self.people,
            corpus: &self.corpus,
            phrases: 2,
            source: SourceKind::Ideal,
            kinds: &self.kinds,
            keep: &self.keep,
            margin: self.margin,
            objective,
            steps: self.steps,
            seed: 5,
            jobs: NonZeroUsize::new(self.jobs).expect("more than 0"),
        };
        improve(&task, cancel, |it| progress(it.step))
    }

    fn found(&self) -> Found {
        self.run(&AtomicBool::new(false), |_| {}).expect("a search")
    }
}

/// Returns the distance of two keys in millimetres.
fn distance(text: &str, a: &str, b: &str) -> f32 {
    let layout = Layout::parse(text, "pad.ron").expect("a layout");
    let center = |name: &str| layout.key(name).expect("a key").face.outline.center;
    center(a).distance(center(b)) * 1e3
}

#[test]
fn keys_that_follow_each_other_come_closer_and_comments_stay() {
    let search = Search::new(MoveKind::Assignment, "speed");
    let found = search.found();
    assert!(found.gain > 0.0, "{found:?}");
    assert!(
        distance(&found.text, "1", "2") < 0.5 * distance(PAD, "1", "2"),
        "{}",
        found.text
    );
    for comment in [
        "// The order is mine.",
        "// a name",
        "// before the elbow",
        "// a row",
    ] {
        assert!(found.text.contains(comment), "{}", found.text);
    }
    // The same on any number of threads.
    let parallel = Search {
        jobs: 3,
        ..Search::new(MoveKind::Assignment, "speed")
    };
    assert_eq!(parallel.found(), found);
}

#[test]
fn kept_keys_stay_and_all_of_them_leave_nothing_to_move() {
    let keep = |names: &[&str]| names.iter().map(|it| (*it).to_owned()).collect();
    let search = Search {
        keep: keep(&["1", "2"]),
        ..Search::new(MoveKind::Assignment, "speed")
    };
    let found = search.found();
    assert_eq!(distance(&found.text, "1", "2"), distance(PAD, "1", "2"));
    let refused = |kept, kind, words: &str| {
        let refused_search = Search {
            keep: kept,
            ..Search::new(kind, "speed")
        };
        let error = refused_search
            .run(&AtomicBool::new(false), |_| {})
            .expect_err("nothing moves");
        assert!(error.to_string().contains(words), "{error}");
    };
    let all = keep(&["1", "2", "3", "4", "5", "6", "7", "8", "9"]);
    refused(all, MoveKind::Assignment, "no assignment that may change");
    refused(keep(&["Q"]), MoveKind::Positions, "nothing is named `Q`");
}

#[test]
fn sizes_grow_within_the_outline_of_the_board_only() {
    let mut search = Search::new(MoveKind::Sizes, "errors");
    search.people = population(&People::Drawn(4), Some(Tier::T1), 3);
    let extent = |text: &str| {
        let layout = Layout::parse(text, "pad.ron").expect("a layout");
        let (low, high) = layout.extent(&layout.boards[0]);
        (high - low) * 1e3
    };
    let found = search.found();
    let within = extent(PAD) + 0.1;
    assert!(extent(&found.text).cmple(within).all(), "{}", found.text);
    assert!(found.refused.outline > 0, "{found:?}");
    search.margin = 0.02;
    let wider = search.found();
    assert!(extent(&wider.text).cmple(within + 40.0).all());
    assert!(wider.refused.outline < found.refused.outline, "{wider:?}");
}

#[test]
fn a_search_that_is_cancelled_returns_the_best_so_far() {
    let search = Search::new(MoveKind::Assignment, "speed");
    let cancel = AtomicBool::new(false);
    let mut seen = 0;
    let found = search.run(&cancel, |step| {
        seen = step;
        cancel.store(step >= 12, Ordering::Relaxed);
    });
    let found = found.expect("the best so far");
    assert_eq!(seen, 12);
    assert!(found.is_cancelled && found.gain > 0.0, "{found:?}");
    Layout::parse(&found.text, "pad.ron").expect("a layout");
}

#[test]
fn a_layout_without_touched_keys_has_no_positions() {
    let document = Document::shipped("chords-bend").expect("a layout");
    let people = [steady(&["index"])];
    let corpus = Corpus::from_text("two", "a\nb").expect("phrases");
    let task = Task {
        document: &document,
        people: &people,
        corpus: &corpus,
        phrases: 1,
        source: SourceKind::Ideal,
        kinds: &[MoveKind::Positions],
        keep: &[],
        margin: 0.0,
        objective: "speed".parse().expect("an objective"),
        steps: 1,
        seed: 0,
        jobs: NonZeroUsize::MIN,
    };
    let error = improve(&task, &AtomicBool::new(false), |_| {}).expect_err("no positions");
    assert!(
        error
            .to_string()
            .contains("fingers that bend need no place"),
        "{error}"
    );
}

const MINIMAL: &str = r#"{
    "name": "Test", "authors": ["A", "B"], "board": "ansi",
    "layers": {"main": ["q w e r t  y u i o p", "a s d f g  h j k l ;", "z x c v b  n m , . /"]}
}"#;

const FULL: &str = r##"{
    "name": "Full", "anchor": [0, 0],
    "layers": {
        "main": ["` 1 2 3 4 5  6 7 8 9 0 - = bsp", "tb q w e r t  y u i o p [ ] \\", "cps a s d f g  h j k l ; ' ret",
                 "shft z x c v b  n m , . / shft", "~ ~ &mgc  spc  @altgr #the ß"],
        "shift": ["\\~ ! @ # $ %  ^ & \\* ( ) _ + bsp", "tab Q W E R T  Y U I O P { } |", "caps A S D F G H J K L : \" ent",
                  "sft Z X C V B  N M < > ! shft"],
        "altgr": ["* * *"]
    },
    "magic": {"mgc": {"a": "b"}}
}"##;

#[test]
fn layouts_of_the_community_become_layouts_that_type() {
    let minimal = import("test.dof", MINIMAL, ImportHands::Two).expect("a layout");
    assert_eq!(minimal.name, "Test");
    let layout = Layout::parse(&minimal.text, "test").expect("a layout");
    assert_eq!(layout.boards.len(), 2);
    assert_eq!(layout.description, "by A, B, imported from a .dof file");
    for key in [
        "Q",
        "T",
        "Y",
        "Semicolon",
        "Slash",
        "Space",
        "ShiftLeft",
        "Backspace",
        "Enter",
    ] {
        assert!(layout.key(key).is_some(), "{key} in {}", minimal.text);
    }
    // The stagger of the rows, and the halves.
    let x = |name: &str| layout.key(name).expect("a key").face.outline.center.x * 1e3;
    assert!((x("A") - x("Q") - 4.75).abs() < 0.01 && (x("Z") - x("Q") - 14.25).abs() < 0.01);
    assert_eq!(x("Y"), x("Q"));

    let full = import("full.dof", FULL, ImportHands::One).expect("a layout");
    let full_layout = Layout::parse(&full.text, "full").expect("a layout");
    assert_eq!(full_layout.boards.len(), 1);
    assert!(
        full_layout.texts.contains(&"the".to_owned())
            && full_layout.texts.contains(&"ß".to_owned())
    );
    let notes = full.notes.join("\n");
    for words in [
        "left out: `cps`",
        "`&mgc`",
        "`altgr`",
        "magic keys",
        "1 keys type something else",
    ] {
        assert!(notes.contains(words), "{words} in {notes}");
    }
    let grid = "semimak\nf l h v z q w u o y\ns r n t k c d e a i\nx ' b m j p g , . /\n0 1 2 3 3 6 6 7 8 9\n";
    let grid = import("x.txt", grid, ImportHands::Two).expect("a layout");
    assert_eq!(grid.name, "semimak");
    let halves = "qwert yuiop\nasdfg hjkl;\nzxcvb nm,./";
    let halves = import("halves.txt", halves, ImportHands::Two).expect("a layout");
    assert_eq!(halves.name, "halves");
    for text in [&grid.text, &halves.text] {
        assert!(Layout::parse(text, "grid").expect("a layout").keys.len() >= 34);
    }
}

#[test]
fn other_files_are_refused_with_the_reason() {
    for (text, words) in [
        ("", "the file is empty"),
        ("{\"a\": 1", "starts like JSON but is not valid"),
        (
            "{\"keys\": [], \"label\": \"x\"}",
            "files of other layout analyzers",
        ),
        ("{\"name\": \"x\"}", "missing field `layers`"),
        (
            "{\"layers\": {\"base\": []}}",
            "no layer `main`; it has `base`",
        ),
        ("{\"layers\": {\"main\": [\"q w e r t y\"]}}", "has 1 rows"),
        (
            r#"{"anchor": [18446744073709551615, 18446744073709551615], "layers": {"main": ["q w e", "a s d", "z x c"]}}"#,
            "the anchor is in column 18446744073709551615",
        ),
        (
            r#"{"anchor": [1, 18446744073709551615], "layers": {"main": ["q w e", "a s d", "z x c"]}}"#,
            "has 3 rows",
        ),
        (
            r#"{"anchor": [2, 1], "layers": {"main": ["q w e", "a s d", "z x c"]}}"#,
            "the first key is in column 0 or 1",
        ),
        ("<?xml version=\"1.0\"?>", "is XML"),
        (
            "KBD us \"US\"\nCOPYRIGHT something long",
            "is not a row of keys",
        ),
        ("1 2 3 4 5\n6 7 8 9 0\n! @ # $ %", "fewer than ten letters"),
        ("[1, 2]", "the JSON is not a .dof file"),
    ] {
        let error = import("a.dof", text, ImportHands::Two).expect_err(text);
        assert!(error.to_string().contains(words), "{words}: {error}");
    }
}

#[test]
fn a_move_that_is_named_twice_counts_once() {
    let document = Document::new("pad.ron", PAD);
    let phrases = ["12".to_owned()];
    let counts = |kinds: &[MoveKind]| {
        let moves = Moves::new(&document, kinds, &[], &phrases).expect("it can move");
        moves.count()
    };
    for kind in [MoveKind::Positions, MoveKind::Sizes, MoveKind::Assignment] {
        assert_eq!(counts(&[kind; 2]), counts(&[kind]), "{kind}");
    }
}
