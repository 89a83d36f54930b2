//! The keys that are hit worst, as colors on a drawing of the boards.

use std::fmt::Write;
use std::sync::Arc;

use ademan::contact::TargetId;
use ademan::layout::Layout;
use ademan::session::view::{View, ViewState};
use ademan::sim::{HandAction, taps_for_text};
use ratatui::buffer::Buffer;
use ratatui::style::{Color, Modifier, Style};

use super::line::CharacterScore;
use crate::view::look::Look;
use crate::view::picture;

/// The errors of a target.
#[derive(Clone, Copy, Default)]
struct Heat {
    attempts: usize,
    errors: usize,
}

/// Returns the drawing of the boards, with the keys of wrong characters in colors: yellow, and red from every third on. With
/// `finds_letters` a multitap key types all its letters.
pub fn draw(layout: &Layout, characters: &[CharacterScore], finds_letters: bool) -> String {
    let look = Look::from_environment();
    let (columns, _) = ratatui::crossterm::terminal::size().unwrap_or((80, 24));
    let heats = heats(layout, characters, finds_letters);
    let style = |target: TargetId| {
        let heat = heats.iter().find(|(known, _)| *known == target);
        let heat = heat.map_or(Heat::default(), |(_, heat)| *heat);
        look.heat(heat.errors as f64 / heat.attempts.max(1) as f64)
    };
    let view = View {
        layout: Arc::new(layout.clone()),
        state: Arc::new(ViewState::starting("", "", "")),
        boards: Arc::default(),
        messages: Arc::default(),
        missed: 0,
    };
    text(&picture::boards_with_styles(&view, look, columns, style))
}

/// Returns the errors of each target that types one of the characters: of the last one for a character of several.
fn heats(
    layout: &Layout,
    characters: &[CharacterScore],
    finds_letters: bool,
) -> Vec<(TargetId, Heat)> {
    let mut heats: Vec<(TargetId, Heat)> = Vec::new();
    for score in characters {
        let strokes = taps_for_text(&score.character.to_string(), layout, finds_letters);
        let targets = match strokes.unwrap_or_default().pop() {
            Some(HandAction::Chord(targets)) => targets,
            Some(action) => action.target().into_iter().collect(),
            None => Vec::new(),
        };
        for target in targets {
            let index = heats.iter().position(|(known, _)| *known == target);
            let index = index.unwrap_or_else(|| {
                heats.push((target, Heat::default()));
                heats.len() - 1
            });
            heats[index].1.attempts += score.attempts;
            heats[index].1.errors += score.errors;
        }
    }
    heats
}

/// Returns a drawing with the codes of a terminal for its styles.
fn text(buffer: &Buffer) -> String {
    let mut text = String::new();
    for row in 0..buffer.area.height {
        let mut present = String::new();
        for column in 0..buffer.area.width {
            let cell = &buffer[(column, row)];
            let codes = codes(cell.style());
            if codes != present {
                let _ = write!(text, "\x1b[0{codes}m");
                present = codes;
            }
            text.push_str(cell.symbol());
        }
        if !present.is_empty() {
            text.push_str("\x1b[0m");
        }
        text.push('\n');
    }
    text
}

/// Returns the codes of the styles that [`Look::heat`] uses.
fn codes(style: Style) -> String {
    let mut codes = String::new();
    match style.bg {
        Some(Color::Red) => codes += ";30;41",
        Some(Color::Yellow) => codes += ";30;43",
        _ => {}
    }
    if style.add_modifier.contains(Modifier::BOLD) {
        codes += ";1";
    }
    if style.add_modifier.contains(Modifier::REVERSED) {
        codes += ";7";
    }
    codes
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan::files::Load;

    fn score(character: char, attempts: usize, errors: usize) -> CharacterScore {
        CharacterScore {
            character,
            attempts,
            errors,
        }
    }

    #[test]
    fn the_keys_of_a_chord_and_of_both_cases_of_a_letter_add_up() {
        let layout = Layout::load("qwerty-flat").unwrap();
        let heats = heats(
            &layout,
            &[score('a', 2, 1), score('A', 3, 2), score('b', 1, 0)],
            false,
        );
        let counts: Vec<_> = heats
            .iter()
            .map(|(_, heat)| (heat.attempts, heat.errors))
            .collect();
        assert_eq!(counts, [(5, 3), (1, 0)]);
        let a = layout.face(heats[0].0).unwrap();
        assert_eq!(a.label, "A");
        // N is a chord of index and middle finger, and E the index finger.
        let chords = Layout::load("chords-bend").unwrap();
        let chord_heats = super::heats(&chords, &[score('n', 4, 4), score('e', 2, 0)], false);
        let chord_counts: Vec<_> = chord_heats
            .iter()
            .map(|(_, heat)| (heat.attempts, heat.errors))
            .collect();
        assert_eq!(chord_counts, [(6, 4), (4, 4)]);
        // The three letters of a key, from which a decoder finds the words.
        let pad = Layout::load("phone-words").unwrap();
        let scores = ['a', 'b', 'c'].map(|letter| score(letter, 2, 1));
        let [(_, heat)] = super::heats(&pad, &scores, true)[..] else {
            panic!("one key");
        };
        assert_eq!((heat.attempts, heat.errors), (6, 3));
        assert!(super::heats(&pad, &scores, false).is_empty());
    }
}
