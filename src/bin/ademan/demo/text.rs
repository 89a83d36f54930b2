//! What the demo types when it is not told.

use ademan::layout::Layout;
use ademan::sim::taps_for_text;

use crate::failure::Failure;

/// For layouts with letters, and for those with digits.
const TEXTS: [&str; 2] = ["Hola! Typed by a hand, 1 tap each.", "3.14159*2-0.5"];
/// How many different characters show what another layout can write.
const CHARACTERS: usize = 20;

/// The text that was asked for, or one that goes with the layout.
pub fn to_type(asked: Option<&str>, layout: &Layout) -> Result<String, Failure> {
    let text = match asked {
        Some(text) => text.to_owned(),
        None => of_layout(layout),
    };
    if !text.is_empty() {
        return Ok(text);
    }
    Err(Failure::wrong_use(match asked {
        Some(_) => "there is nothing to type: --text is empty".to_owned(),
        None => format!(
            "the demo types text, and no key of `{}` writes a character: choose another one with --layout, or see its keys with `ademan layout show`",
            layout.name
        ),
    }))
}

fn of_layout(layout: &Layout) -> String {
    let keys = layout.key_bindings();
    let fits = |text: &str| taps_for_text(text, &keys).is_ok();
    if let Some(text) = TEXTS.into_iter().find(|text| fits(text)) {
        return text.to_owned();
    }
    let visible = ('!'..='~').map(String::from);
    visible.filter(|text| fits(text)).take(CHARACTERS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_for(layout: &str) -> Result<String, Failure> {
        to_type(None, &Layout::load(layout).unwrap())
    }

    #[test]
    fn every_shipped_layout_that_writes_gets_a_text_that_it_can_write() {
        assert_eq!(text_for("qwerty-flat").unwrap(), TEXTS[0]);
        assert_eq!(text_for("qwerty-arc").unwrap(), TEXTS[0]);
        assert_eq!(text_for("numpad").unwrap(), TEXTS[1]);
        assert!(text_for("arrows").is_err());
    }

    #[test]
    fn a_layout_of_two_letters_gets_those() {
        let text = r#"Layout(name: "Yes and no", boards: [(
            place: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
            rows: [(at_mm: (-19, 0), keys: "Y N Enter")],
        )])"#;
        let layout = Layout::parse(text, "yes-no.ron").unwrap();
        assert_eq!(to_type(None, &layout).unwrap(), "ny");
        assert!(to_type(Some(""), &layout).is_err());
    }
}
