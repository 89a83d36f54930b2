//! A link as a picture, for the camera of a headset or phone.

#[cfg(feature = "studio")]
use ademan::studio::headset::QrModules;
use qrcode::QrCode;
use qrcode::render::unicode::Dense1x2;

/// Black on bright white: a code in the colors of a dark terminal is inverted, which many cameras do not read.
const COLORS: &str = "\x1b[30;107m";

/// Returns the QR code of a text as lines of half blocks, black on white in every terminal. `None` if the text is too long.
pub fn blocks(text: &str) -> Option<String> {
    let code = QrCode::new(text).ok()?;
    let picture = code
        .render::<Dense1x2>()
        .dark_color(Dense1x2::Dark)
        .light_color(Dense1x2::Light)
        .build();
    let lines = picture
        .lines()
        .map(|line| format!("{COLORS}{line}\x1b[0m\n"));
    Some(lines.collect())
}

/// Returns the QR code of a text as its modules. `None` if the text is too long.
#[cfg(feature = "studio")]
pub fn modules(text: &str) -> Option<QrModules> {
    let code = QrCode::new(text).ok()?;
    let colors = code.to_colors().into_iter();
    let is_dark = colors.map(|color| color == qrcode::Color::Dark);
    Some(QrModules::new(code.width(), is_dark.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_is_a_square_of_half_blocks() {
        let link = format!("https://192.168.1.7:8443/#token={}", "a".repeat(64));
        let code = blocks(&link).expect("it fits");
        let widths = code
            .lines()
            .map(|line| line.chars().filter(|it| " ▀▄█".contains(*it)).count());
        let widths: Vec<usize> = widths.collect();
        assert!(widths.iter().all(|width| *width == widths[0]), "{widths:?}");
        assert!(
            widths[0].div_ceil(2).abs_diff(widths.len()) <= 1,
            "{widths:?}"
        );
        assert_eq!(blocks(&"a".repeat(8000)), None);
    }
    #[cfg(feature = "studio")]
    #[test]
    fn the_modules_of_a_link_are_those_of_its_half_blocks() {
        let link = format!("https://192.168.1.7:8443/#token={}", "a".repeat(64));
        let modules = modules(&link).expect("it fits");
        // A margin of four modules is on each side, and a line has two rows.
        const MARGIN: usize = 4;
        let blocks = blocks(&link).expect("it fits");
        let lines = blocks.lines();
        let lines: Vec<Vec<char>> = lines
            .map(|line| line.strip_prefix(COLORS).expect("black on white"))
            .map(|line| line.chars().collect())
            .collect();
        let is_dark = |x: usize, y: usize| match lines[(y + MARGIN) / 2][x + MARGIN] {
            '█' => true,
            '▀' => y.is_multiple_of(2),
            '▄' => !y.is_multiple_of(2),
            _ => false,
        };
        let runs = modules.dark_runs();
        let dark: Vec<_> = runs
            .flat_map(|run| (run.start..run.end).map(move |x| (run.row, x)))
            .collect();
        let side = 0..modules.width();
        let all = side.clone().flat_map(|y| side.clone().map(move |x| (y, x)));
        let drawn: Vec<_> = all.filter(|(y, x)| is_dark(*x, *y)).collect();
        assert_eq!(dark, drawn);
        assert_eq!(
            dark[..7],
            [0, 1, 2, 3, 4, 5, 6].map(|x| (0, x)),
            "a corner is dark"
        );
        assert!(super::modules(&"a".repeat(8000)).is_none());
    }
}
