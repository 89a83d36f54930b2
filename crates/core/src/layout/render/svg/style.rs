//! Colors for a light and for a dark ground, and the style sheet.

/// A color of one role on a light and on a dark ground.
struct Color {
    role: &'static str,
    light: &'static str,
    dark: &'static str,
}

const fn color(role: &'static str, light: &'static str, dark: &'static str) -> Color {
    Color { role, light, dark }
}

/// All colors. A text has a contrast of at least 4.5 with what it stands on, as WCAG 2.2 asks for.
#[rustfmt::skip]
const COLORS: &[Color] = &[
    color("ground", "#ffffff", "#0f172a"),
    color("panel",  "#e8edf3", "#1b2537"),
    color("edge",   "#94a3b8", "#64748b"),
    color("ink",    "#0f172a", "#f1f5f9"),
    color("muted",  "#475569", "#a9b6c8"),
    color("skirt",  "#b8c4d3", "#0b1220"),
    color("cap",    "#ffffff", "#334155"),
    color("tinted", "#dbe7fb", "#27406b"),
    color("well",   "#d3dce7", "#111a2b"),
    color("metal",  "#334155", "#cbd5e1"),
    color("accent", "#1d4ed8", "#8ab4ff"),
    color("paper",  "#ffffff", "#0f172a"),
    color("warn",   "#b3261e", "#ff9d94"),
    color("reach",  "#15803d", "#4ade80"),
];

/// The rules. `$role` stands for the color of a role.
const RULES: &str = "\
.ground{fill:$ground}
.panel{fill:$panel;stroke:$edge;stroke-width:.25}
.skirt{fill:$skirt;stroke:$edge;stroke-width:.3}
.cap{fill:$cap;stroke:$edge;stroke-width:.2}
.tinted{fill:$tinted;stroke:$edge;stroke-width:.2}
.lit{fill:$accent;stroke:$edge;stroke-width:.2}
.faint{fill:none;stroke:$edge;stroke-width:.3}
.well{fill:$well;stroke:$edge;stroke-width:.3}
.groove{fill:$metal}
.slot{fill:$skirt;stroke:$edge;stroke-width:.3}
.metal{fill:$metal}
.spoke{fill:none;stroke:$metal;stroke-width:1.6;stroke-linecap:round}
.mark{fill:none;stroke:$accent;stroke-width:1.2;stroke-linecap:round}
.on-metal{fill:none;stroke:$paper;stroke-width:.7;stroke-linecap:round}
.tick{fill:none;stroke:$muted;stroke-width:.3}
.range{fill:none;stroke:$muted;stroke-width:.5}
.icon{fill:none;stroke:$muted;stroke-width:.5;stroke-linecap:round;stroke-linejoin:round}
.dashed{fill:none;stroke:$muted;stroke-width:.3;stroke-dasharray:1.2 1}
.out{fill:none;stroke:$warn;stroke-width:.7;stroke-dasharray:1.6 1}
.fault{fill:none;stroke:$warn;stroke-width:1.1}
.reach{fill:$reach;fill-opacity:.16}
.reach-edge{fill:none;stroke:$reach;stroke-width:.4;stroke-dasharray:2 1}
.volume{fill:$accent;fill-opacity:.14;stroke:$accent;stroke-width:.35}
.board{fill:$panel;fill-opacity:.75;stroke:$muted;stroke-width:.25}
.arm{fill:none;stroke:$metal;stroke-width:1.6;stroke-opacity:.7;stroke-linecap:round;stroke-linejoin:round}
.bone{fill:none;stroke:$metal;stroke-width:.8;stroke-opacity:.45;stroke-linecap:round;stroke-linejoin:round}
.joint{fill:$metal}
.bar{fill:none;stroke:$ink;stroke-width:.4}
.label,.title{fill:$ink}
.title{font-weight:bold}
.muted{fill:$muted}
.layer{fill:$accent}
.inked{fill:$paper}
.warning{fill:$warn}
text{font-family:sans-serif}
";

/// Returns the style sheet of a picture: light, or dark where the reader prefers it.
pub fn sheet() -> String {
    colored(RULES)
}

/// Returns rules for a light ground, and for a dark one where the reader prefers it. `$role` stands for the color of a role.
pub fn colored(rules: &str) -> String {
    let light = with_colors(rules, |color| color.light);
    let dark = with_colors(rules, |color| color.dark);
    format!("{light}@media (prefers-color-scheme:dark){{\n{dark}}}\n")
}

fn with_colors(rules: &str, value: impl Fn(&Color) -> &'static str) -> String {
    let mut rules = rules.to_owned();
    for color in COLORS {
        rules = rules.replace(&format!("${}", color.role), value(color));
    }
    rules
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the relative luminance of a color `#rrggbb`, as WCAG 2.2 defines it.
    fn luminance(color: &str) -> f64 {
        let channel = |at: usize| {
            let value = u8::from_str_radix(&color[at..at + 2], 16).expect("a color");
            let value = f64::from(value) / 255.0;
            if value <= 0.04045 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    fn contrast(a: &str, b: &str) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn every_text_stands_out_from_its_ground() {
        let of = |role: &str| {
            let color = COLORS.iter().find(|color| color.role == role);
            color.expect("a role")
        };
        let pairs = [
            (
                "ink",
                ["ground", "cap", "tinted", "well", "panel"].as_slice(),
            ),
            ("muted", &["ground", "cap", "well", "panel"]),
            ("accent", &["ground", "cap", "tinted"]),
            ("warn", &["ground"]),
            ("paper", &["accent", "metal"]),
        ];
        for (text, grounds) in pairs {
            for ground in grounds {
                let light = contrast(of(text).light, of(ground).light);
                let dark = contrast(of(text).dark, of(ground).dark);
                assert!(light.min(dark) >= 4.5, "{text} on {ground}: {light} {dark}");
            }
        }
    }

    #[test]
    fn every_role_has_a_color() {
        assert!(!sheet().contains('$'));
    }
}
