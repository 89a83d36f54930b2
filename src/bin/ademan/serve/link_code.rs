//! A link as a picture in the terminal, for the camera of a headset or phone.

use qrcode::QrCode;
use qrcode::render::unicode::Dense1x2;

/// Returns the QR code of a text as lines of half blocks, light on dark terminals as on light ones. `None` if the text is too long.
pub fn qr_code(text: &str) -> Option<String> {
    let code = QrCode::new(text).ok()?;
    // Dark modules are blanks on an inverted terminal, so the colors are stated: black on white.
    let picture = code
        .render::<Dense1x2>()
        .dark_color(Dense1x2::Dark)
        .light_color(Dense1x2::Light)
        .build();
    let lines = picture
        .lines()
        .map(|line| format!("\x1b[97;40m{line}\x1b[0m\n"));
    Some(lines.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_is_a_square_of_half_blocks() {
        let link = format!("https://192.168.1.7:8443/#token={}", "a".repeat(64));
        let code = qr_code(&link).expect("it fits");
        let widths = code
            .lines()
            .map(|line| line.chars().filter(|it| " ▀▄█".contains(*it)).count());
        let widths: Vec<usize> = widths.collect();
        assert!(widths.iter().all(|width| *width == widths[0]), "{widths:?}");
        assert!(
            widths[0].div_ceil(2).abs_diff(widths.len()) <= 1,
            "{widths:?}"
        );
        assert_eq!(qr_code(&"a".repeat(8000)), None);
    }
}
