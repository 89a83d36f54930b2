//! The rows of the scope, by what is painted.

use eframe::egui::{self, Pos2, Rect, Shape};

use super::canvas::Canvas;
use super::{Rows, lanes};
use crate::history::{History, Moment, SentEvent, SentKey, SentValue};
use crate::plot::TimeWindow;
use ademan_core::contact::TargetId;
use ademan_core::hand::{Dof, Finger, FingerSet, Side};
use ademan_core::time::Timestamp;

const AREA: Rect = Rect {
    min: Pos2::ZERO,
    max: Pos2::new(1000.0, 300.0),
};

fn moment(seconds: f64, height: f32) -> Moment {
    let mut heights_mm = [[f32::NAN; Finger::COUNT]; Side::COUNT];
    heights_mm[Side::Right.index()][Finger::Index.index()] = height;
    let press = if height < 0.0 {
        FingerSet::NONE.with(Finger::Index)
    } else {
        FingerSet::NONE
    };
    let mut pressing = [FingerSet::NONE; Side::COUNT];
    pressing[Side::Right.index()] = press;
    Moment {
        time: Timestamp::from_seconds(seconds),
        degrees: [f32::NAN; Dof::COUNT],
        heights_mm,
        pressing,
        latency_ms: f32::NAN,
    }
}

fn event(seconds: f64, name: &str, is_press: bool) -> SentEvent {
    SentEvent {
        time: Timestamp::from_seconds(seconds),
        key: SentKey::Code(name.parse().unwrap()),
        is_press,
    }
}

const HEIGHTS: Rows = Rows {
    heights: true,
    latency: false,
    presses: false,
    events: false,
};

/// Draws rows of the last 10 s, and returns the shapes and the part with the rows.
fn draw(history: &History, rows: Rows) -> (Vec<Shape>, Rect) {
    let context = egui::Context::default();
    let mut area = Rect::NOTHING;
    let input = egui::RawInput {
        screen_rect: Some(AREA),
        ..egui::RawInput::default()
    };
    let output = context.run_ui(input, |ui| {
        let names = lanes::row_names(history, rows);
        let canvas = Canvas::new(ui, AREA, history, TimeWindow::new(10.0), &names);
        let canvas = canvas.expect("room");
        area = canvas.area;
        lanes::draw(&canvas, &[false; Dof::COUNT], rows);
    });
    let shapes = output.shapes.iter().map(|clipped| clipped.shape.clone());
    let shapes = shapes.collect();
    output.drop_without_applying_deltas();
    (shapes, area)
}

/// Returns the lines through values.
fn lines(shapes: &[Shape]) -> Vec<Vec<Pos2>> {
    let lines = shapes.iter().filter_map(|shape| match shape {
        Shape::Path(path) => Some(path.points.clone()),
        _ => None,
    });
    lines.collect()
}

#[test]
fn a_line_has_a_gap_where_readings_are_missing() {
    let mut history = History::default();
    for (seconds, height) in [
        (1.0, 5.0),
        (2.0, 6.0),
        (2.2, f32::NAN),
        (8.0, 7.0),
        (9.0, 8.0),
    ] {
        history.push(moment(seconds, height));
    }
    let (shapes, _) = draw(&history, HEIGHTS);
    let counts: Vec<usize> = lines(&shapes).iter().map(Vec::len).collect();
    assert_eq!(counts, [2, 2]);
}

#[test]
fn the_fingers_keep_their_names_while_readings_are_missing() {
    let mut history = History::default();
    history.push(moment(1.0, -2.0));
    let rows = Rows {
        presses: true,
        ..HEIGHTS
    };
    let names = lanes::row_names(&history, rows);
    history.push(moment(2.0, f32::NAN));
    assert_eq!(lanes::row_names(&history, rows), names);
    let (shapes, _) = draw(&history, HEIGHTS);
    let has_name = |shape: &Shape| matches!(shape, Shape::Text(it) if it.galley.text() == names[0]);
    assert!(shapes.iter().any(has_name), "{names:?}");
}

#[test]
fn a_high_fingertip_is_within_its_row() {
    let mut history = History::default();
    history.push(moment(1.0, 5.0));
    history.push(moment(9.0, 140.0));
    let (shapes, area) = draw(&history, HEIGHTS);
    let drawn = lines(&shapes).concat();
    assert_eq!(drawn.len(), 2);
    assert!(drawn.iter().all(|point| area.contains(*point)), "{drawn:?}");
}

#[test]
fn the_value_at_which_a_control_was_left_is_among_the_keys() {
    let mut history = History::default();
    history.push(moment(0.0, 5.0));
    history.push_event(event(1.0, "A", true));
    for (seconds, value) in [(2.0, 0.4), (2.1, 0.75)] {
        history.push_value(SentValue {
            time: Timestamp::from_seconds(seconds),
            target: TargetId(7),
            name: "Fader 1".to_owned(),
            value,
        });
    }
    history.push_event(event(5.0, "A", false));
    history.push(moment(10.0, 5.0));
    let rows = Rows {
        heights: false,
        events: true,
        ..HEIGHTS
    };
    let (shapes, _) = draw(&history, rows);
    let words = shapes.iter().filter_map(|shape| match shape {
        Shape::Text(it) => Some(it.galley.text()),
        _ => None,
    });
    let words: Vec<&str> = words.collect();
    let order = ["A↓", "Fader 1 0.75", "A↑"].map(|name| words.iter().position(|it| *it == name));
    assert!(order.iter().all(Option::is_some), "{words:?}");
    assert!(order.is_sorted(), "{words:?}");
}

#[test]
fn no_tick_crosses_the_name_of_a_key() {
    let mut history = History::default();
    history.push(moment(0.0, 5.0));
    for (seconds, name, is_press) in [
        (1.0, "MediaPlayPause", true),
        (1.1, "MediaPlayPause", false),
        (1.3, "A", true),
        (3.0, "A", false),
        (4.0, "B", true),
        (8.0, "B", false),
        (9.9, "C", true),
        (9.95, "MediaPlayPause", true),
    ] {
        history.push_event(event(seconds, name, is_press));
    }
    history.push(moment(10.0, 5.0));
    let rows = Rows {
        heights: false,
        events: true,
        ..HEIGHTS
    };
    let (shapes, area) = draw(&history, rows);
    let names: Vec<(String, Rect)> = shapes
        .iter()
        .filter_map(|shape| match shape {
            Shape::Text(it) if it.galley.text().ends_with(['↓', '↑']) => {
                Some((it.galley.text().to_owned(), it.visual_bounding_rect()))
            }
            _ => None,
        })
        .collect();
    let words: Vec<&str> = names.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(words, ["A↓", "A↑", "B↓", "B↑"]);
    let ticks: Vec<f32> = shapes
        .iter()
        .filter_map(|shape| match shape {
            Shape::LineSegment { points, stroke } if stroke.width == 1.0 => Some(points[0].x),
            _ => None,
        })
        .collect();
    assert!(ticks.len() >= 8, "{ticks:?}");
    for (name, place) in names {
        let crosses = |x: &&f32| place.x_range().contains(**x) && area.x_range().contains(**x);
        assert_eq!(ticks.iter().find(crosses), None, "{name}");
    }
}
