//! Tests of pictures of several layouts in windows of several sizes.

use std::sync::Arc;

use ademan::capture::{Headset, HeadsetStatus};
use ademan::document::shipped_layouts;
use ademan::files::Load;
use ademan::hand::{Finger, Side};
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::session::view::{FingerBend, Fingertip, View, ViewState};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::Picture;
use crate::view::look::Look;

const COLORED: Look = Look {
    has_colors: true,
    is_unicode: true,
};

/// A view of a layout with both hands, all fingertips over the first key.
fn view(layout: &str) -> View {
    let layout = Layout::load(layout).unwrap();
    let mut state = ViewState::starting("main", "serial:/dev/ttyUSB0", "desktop");
    state.state = PipelineState::Running;
    let board = layout.boards.first();
    let face = board.and_then(|board| layout.faces(board).next());
    if let Some(face) = face {
        let position = face.row_position * 1e3;
        let sides = if layout.has_board_for(Side::Left) {
            Side::ALL
        } else {
            &Side::ALL[1..]
        };
        for &side in sides {
            for (number, &finger) in Finger::ALL.iter().enumerate() {
                state.fingertips.push(Fingertip {
                    side,
                    finger,
                    board: 0,
                    x_mm: position.x,
                    y_mm: position.y,
                    height_mm: number as f32 - 1.5,
                });
            }
        }
    }
    View {
        boards: Arc::default(),
        layout: Arc::new(layout),
        state: Arc::new(state),
        messages: Arc::default(),
        missed: 0,
    }
}

fn drawn(view: &View, look: Look, columns: u16, rows: u16) -> Buffer {
    let area = Rect::new(0, 0, columns, rows);
    let mut buffer = Buffer::empty(area);
    let messages = ["first".to_owned(), "second".to_owned()];
    let picture = Picture {
        view,
        task: &[],
        messages: &messages,
        look,
    };
    picture.draw(&mut buffer, area);
    buffer
}

fn text(buffer: &Buffer) -> String {
    let rows = buffer.content.chunks(usize::from(buffer.area.width.max(1)));
    let lines = rows.map(|row| row.iter().map(|cell| cell.symbol()).collect::<String>());
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn eighty_by_twenty_four_characters_show_every_shipped_layout() {
    for layout in shipped_layouts() {
        let text = text(&drawn(&view(layout), COLORED, 80, 24));
        assert!(!text.contains("no room"), "{layout}:\n{text}");
        assert!(text.contains("second"), "{layout}:\n{text}");
    }
}

#[test]
fn a_long_message_goes_on_in_the_next_row() {
    let words = "the glove sends nothing: check its cable, its port and its bit rate, or name another source";
    let view = view("numpad");
    let drawn_at = |columns: u16| {
        let area = Rect::new(0, 0, columns, 24);
        let mut buffer = Buffer::empty(area);
        let messages = ["first".to_owned(), words.to_owned()];
        let picture = Picture {
            view: &view,
            task: &[],
            messages: &messages,
            look: COLORED,
        };
        picture.draw(&mut buffer, area);
        text(&buffer)
    };
    let narrow = drawn_at(60);
    let mut lines = narrow.lines().map(str::trim_end);
    let first = "the glove sends nothing: check its cable, its port and its";
    assert!(lines.any(|line| line == first), "{narrow}");
    assert_eq!(lines.next(), Some("bit rate, or name another source"));
    assert!(drawn_at(100).contains(words));
}

#[test]
fn two_hands_are_drawn_side_by_side_the_left_one_first() {
    let text = text(&drawn(&view("qwerty-two-flat"), COLORED, 100, 30));
    let row = text.lines().find(|line| line.contains("│ W │")).unwrap();
    assert!(row.find("│ W │") < row.find("│ O │"), "{text}");
    assert!(row.contains("│ O │"), "{text}");
}

#[test]
fn a_small_window_names_what_it_leaves_out() {
    let view = view("media");
    let small = text(&drawn(&view, COLORED, 40, 10));
    println!("{small}");
    assert!(small.contains("no room for values"), "{small}");
    assert!(
        small.contains("Volum") && small.contains("second"),
        "{small}"
    );
    let smaller = text(&drawn(&view, COLORED, 40, 4));
    assert!(smaller.contains("no room for a board"), "{smaller}");
}

#[test]
fn a_fingertip_does_not_cover_a_label() {
    let text = text(&drawn(&view("qwerty-flat"), COLORED, 80, 24));
    assert!(text.lines().nth(2).unwrap().contains('`'), "{text}");
}

#[test]
fn a_key_above_another_one_hides_the_label_below_it() {
    let keys = r#"(code: "A", label: "below", at_mm: (0, 0), size_mm: Box(60, 17)),
        (code: "B", at_mm: (0, 0), size_mm: Box(36, 17), lift_mm: 10)"#;
    let layout = format!(r#"Layout(name: "a", boards: [(pose: (anchor: elbow), keys: [{keys}])])"#);
    let view = View {
        boards: Arc::default(),
        layout: Arc::new(Layout::parse(&layout, "a.ron").unwrap()),
        state: Arc::new(ViewState::starting(
            "main",
            "serial:/dev/ttyUSB0",
            "desktop",
        )),
        messages: Arc::default(),
        missed: 0,
    };
    let text = text(&drawn(&view, COLORED, 80, 24));
    assert!(text.contains("   B   "), "{text}");
}

#[test]
fn an_open_radial_menu_has_the_label_of_the_highlighted_sector() {
    let mut view = view("radial");
    let target = view.layout.target_names().find("Edit").unwrap();
    let sectors = ["Copy", "Paste", "Redo", "Style", "Undo", "Cut"];
    let nested = ["Style", "Bold", "Italic", "Plain", "Underline"];
    let labels = [&["Edit"][..], &sectors, &nested].concat();
    for (index, label) in labels.iter().enumerate() {
        let value = index as f32 / (labels.len() - 1) as f32;
        let mut state = ViewState::clone(&view.state);
        state.values = vec![(target, value)];
        view.state = Arc::new(state);
        let text = text(&drawn(&view, COLORED, 80, 24));
        assert!(text.matches(label).count() >= 2, "{index} {label}:\n{text}");
    }
}

#[test]
fn the_mark_of_an_xy_pad_is_where_both_values_are() {
    let mut view = view("xy-pad");
    let names = view.layout.target_names();
    let [x, y] = ["Filter x", "Filter y"].map(|name| names.find(name).unwrap());
    let mut mark = |values: [f32; 2]| {
        let mut state = ViewState::clone(&view.state);
        state.values = vec![(x, values[0]), (y, values[1])];
        view.state = Arc::new(state);
        let text = text(&drawn(&view, COLORED, 80, 24));
        let shown = format!("{:.2}", values[1]);
        assert!(text.contains(&shown), "Filter y of {shown}:\n{text}");
        let rows = text.lines().enumerate();
        let marks =
            rows.filter_map(|(row, line)| Some((line.chars().position(|it| it == '●')?, row)));
        // The other pad is to the right.
        marks.min().unwrap()
    };
    let (left, near) = mark([0.0, 0.0]);
    let (right, far) = mark([1.0, 1.0]);
    assert!(
        left + 8 < right && far + 4 < near,
        "{left} {right}, {far} {near}"
    );
    assert_eq!(mark([1.0, 0.0]), (right, near));
    assert_eq!(mark([0.0, 1.0]), (left, far));
}

#[test]
fn drawing_works_in_windows_of_any_size() {
    for layout in shipped_layouts() {
        let view = view(layout);
        for (columns, rows) in [(0, 0), (1, 1), (5, 3), (40, 12), (300, 2), (2, 300)] {
            let text = text(&drawn(&view, COLORED, columns, rows));
            let is_blank = text.chars().all(char::is_whitespace);
            let is_large = columns >= 40 && rows >= 12;
            assert!(!(is_large && is_blank), "{layout}: a blank window");
            assert_eq!(text.lines().count(), usize::from(rows), "{layout}");
        }
    }
}

#[test]
fn without_utf_8_everything_is_ascii() {
    let look = Look {
        is_unicode: false,
        ..COLORED
    };
    for layout in shipped_layouts() {
        let text = text(&drawn(&view(layout), look, 80, 24));
        assert!(text.is_ascii(), "{layout}:\n{text}");
    }
}

#[test]
fn one_loss_is_a_loss_and_two_are_losses() {
    let shown = |losses: u64| {
        let mut view = view("numpad");
        let mut state = ViewState::clone(&view.state);
        state.counts.losses = losses;
        view.state = Arc::new(state);
        let drawn = drawn(&view, COLORED, 120, 30);
        let symbols = drawn.content().iter().map(|cell| cell.symbol());
        symbols.collect::<String>()
    };
    assert!(shown(0).contains(", no losses"), "{}", shown(0));
    assert!(shown(1).contains(", 1 loss of the device"), "{}", shown(1));
    assert!(
        shown(2).contains(", 2 losses of the device"),
        "{}",
        shown(2)
    );
}

/// The line of keys of a run that has typed a text.
fn key_line(typed: &str, look: Look, columns: u16) -> String {
    let mut view = view("qwerty-flat");
    let mut state = ViewState::clone(&view.state);
    state.recent = vec!["H".to_owned(), "Enter".to_owned()];
    state.typed = typed.to_owned();
    view.state = Arc::new(state);
    let text = text(&drawn(&view, look, columns, 30));
    let line = text.lines().find(|line| line.contains("no key is down"));
    line.expect("a line of keys").trim_end().to_owned()
}

#[test]
fn the_line_of_keys_shows_the_end_of_the_text_so_far() {
    let line = |typed| key_line(typed, COLORED, 40);
    assert_eq!(line(""), "no key is down   typed H Enter");
    assert_eq!(line("hola "), "no key is down   typed \"hola \"");
    let long = line("the quick brown fox jumps");
    assert_eq!(long, "no key is down   typed \"…own fox jumps\"");
    assert_eq!(line("a\nb\tc"), "no key is down   typed \"a↵b⇥c\"");
    // Text of a layout file does not act on the terminal.
    assert!(!line("\u{1b}[2Ja").contains('\u{1b}'));
    let ascii = Look {
        is_unicode: false,
        ..COLORED
    };
    assert!(key_line("a\n\t and a long, long text", ascii, 40).is_ascii());
}

#[test]
fn bent_fingers_are_bars_with_their_thresholds_and_are_named_while_output_waits() {
    let mut view = view("chords-bend");
    let mut state = ViewState::clone(&view.state);
    state.fingertips.clear();
    state.state = PipelineState::Paused;
    let bends = [(Finger::Thumb, 0.25), (Finger::Index, 0.75)];
    state.bends = bends
        .map(|(finger, bend)| FingerBend {
            side: Side::Right,
            finger,
            bend,
            press_at: 0.5,
            release_at: 0.4,
        })
        .to_vec();
    view.state = Arc::new(state);
    let text = text(&drawn(&view, COLORED, 100, 30));
    assert!(text.contains("paused: straighten index"), "{text}");
    assert!(text.contains("① thumb ▕██░│░░░░▏"), "{text}");
    assert!(text.contains("❷ index ▕███┃██░░▏"), "{text}");
}

#[test]
fn a_layout_that_waits_for_an_open_hand_asks_for_it() {
    let mut view = view("webcam-qwerty");
    let shown = |pictured: &View| text(&drawn(pictured, COLORED, 100, 30));
    assert!(!shown(&view).contains("hold your hand"));
    let mut state = ViewState::clone(&view.state);
    state.awaits_hand = true;
    view.state = Arc::new(state);
    let asked = shown(&view);
    assert!(
        asked.contains("running: hold your hand open for a second"),
        "{asked}"
    );
}

#[test]
fn the_first_line_names_the_headset_or_says_that_none_is_connected() {
    let mut view = view("qwerty-flat");
    let mut first_line = |connected| {
        let mut state = ViewState::clone(&view.state);
        state.source = "headset:192.168.1.7:8443?page=web".to_owned();
        state.headset = Some(HeadsetStatus { connected });
        view.state = Arc::new(state);
        let text = text(&drawn(&view, COLORED, 100, 24));
        text.lines().next().unwrap_or_default().to_owned()
    };
    let line = first_line(None);
    assert!(
        line.contains(" · no headset connected · headset:"),
        "{line}"
    );
    let headset_line = first_line(Some(Headset::new("Quest 3", [192, 168, 1, 9].into())));
    assert!(
        headset_line.contains(" · headset Quest 3 at 192.168.1.9 · "),
        "{headset_line}"
    );
}
