//! The bends of fingers that press by bending, as bars with their thresholds.

use ademan::hand::Side;
use ademan::session::view::FingerBend;
use ratatui::text::{Line, Span};

use super::Picture;
use crate::view::look::{finger_mark, hand_name};

/// Characters of a bar.
const COLUMNS: usize = 8;

/// Returns a line for each hand with a bar for each finger: filled as far as the finger is bent, with a mark where it presses.
pub fn lines(picture: &Picture, width: u16) -> Vec<Line<'static>> {
    let bends = &picture.view.state.bends;
    let sides = [Side::Left, Side::Right];
    let seen = |side: &Side| bends.iter().any(|bend| bend.side == *side);
    let sides: Vec<Side> = sides.into_iter().filter(seen).collect();
    let is_one = sides.len() == 1;
    let lines = sides.iter().map(|&side| {
        let mut spans = Vec::new();
        if !is_one {
            spans.push(Span::raw(format!("{} ", hand_name(side))));
        }
        for bend in bends.iter().filter(|bend| bend.side == side) {
            let is_bent = bend.bend >= bend.press_at;
            let mark = finger_mark(bend.finger, is_bent);
            let style = picture.look.fingertip(bend.finger);
            spans.push(Span::styled(mark.to_string(), style));
            let name = if is_one && width >= 96 {
                format!(" {} ", bend.finger.name())
            } else {
                String::new()
            };
            spans.push(Span::raw(format!("{name}▕{}▏ ", bar(bend))));
        }
        Line::from(spans)
    });
    lines.collect()
}

fn bar(bend: &FingerBend) -> String {
    let column = |fraction: f32| (fraction.clamp(0.0, 1.0) * COLUMNS as f32).round() as usize;
    let (filled, threshold) = (column(bend.bend), column(bend.press_at));
    let cell = |index: usize| match (index < filled, index + 1 == threshold) {
        (true, true) => '┃',
        (true, false) => '█',
        (false, true) => '│',
        (false, false) => '░',
    };
    (0..COLUMNS).map(cell).collect()
}
