//! Text in drawings: its width and its size inside a shape.

use parry3d::math::Vec2;

/// Half the height of a capital letter as a fraction of the font size. Centers a line of text without
/// `dominant-baseline`, which some viewers do not support.
pub const HALF_CAPITAL_HEIGHT: f32 = 0.36;

/// The height of a line as a fraction of the font size.
pub const LINE_HEIGHT: f32 = 1.25;

/// Returns an upper bound of the width of a text as a multiple of the font size.
///
/// The widths come from DejaVu Sans, the widest of the usual fonts without serifs.
pub fn width_em(text: &str) -> f32 {
    text.chars().map(character_em).sum()
}

fn character_em(character: char) -> f32 {
    match character {
        ' ' | '!' | '\'' | ',' | '.' | ':' | ';' | 'I' | 'i' | 'j' | 'l' | '|' => 0.4,
        '(' | ')' | '-' | '[' | ']' | 'f' | 'r' | 't' => 0.42,
        '"' | '/' | '\\' | '·' => 0.46,
        '%' | '@' | 'M' | 'W' | 'm' => 1.0,
        '#' | '&' | '+' | '<' | '=' | '>' | 'w' | '~' | '^' => 0.84,
        'A'..='Z' => 0.79,
        '\0'..='\u{24f}' => 0.65,
        '\u{2190}'..='\u{21ff}' => 0.84,
        '\u{1f000}'.. => 1.3,
        // Symbols such as ⌫, and letters of other scripts.
        _ => 1.2,
    }
}

/// A text in one or two lines, and its font size.
#[derive(Debug, PartialEq)]
pub struct FittedText<'a> {
    pub lines: Vec<&'a str>,
    pub size: f32,
}

/// Returns the largest text, of at most `max_size`, that fits into a rectangle, in one line or in two.
pub fn fit(text: &str, room: Vec2, max_size: f32) -> FittedText<'_> {
    let size_of = |lines: &[&str]| {
        let width = lines.iter().map(|line| width_em(line)).fold(0.1, f32::max);
        let height = LINE_HEIGHT * lines.len() as f32;
        max_size.min(room.x / width).min(room.y / height).max(0.0)
    };
    let splits = text.match_indices(' ');
    let splits = splits.map(|(at, _)| vec![&text[..at], &text[at + 1..]]);
    let best = splits.max_by(|a, b| size_of(a).total_cmp(&size_of(b)));
    let one = vec![text];
    let lines = match best {
        Some(two) if size_of(&two) > size_of(&one) => two,
        _ => one,
    };
    FittedText {
        size: size_of(&lines),
        lines,
    }
}

/// Breaks a text at spaces into lines of at most `width` at a font size. A longer word has a line of its own.
pub fn wrap(text: &str, width: f32, size: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width_em(line) + width_em(word) + 0.4 <= width / size => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_broken_where_it_becomes_largest() {
        let narrow = fit("Shift lock", Vec2::new(12.0, 12.0), 6.0);
        assert_eq!(narrow.lines, ["Shift", "lock"]);
        let wide = fit("Shift lock", Vec2::new(80.0, 6.0), 6.0);
        assert_eq!(wide.lines, ["Shift lock"]);
        for fitted in [&narrow, &wide] {
            assert!(fitted.size <= 6.0 && fitted.size > 2.0, "{fitted:?}");
        }
    }

    #[test]
    fn lines_are_not_wider_than_the_room() {
        let text = "a spring-loaded lever, a gear lever, a valve, an endless knob";
        for line in wrap(text, 60.0, 3.0) {
            assert!(width_em(&line) * 3.0 <= 60.0, "{line}");
        }
        assert!(wrap("", 10.0, 3.0).is_empty());
    }
}
