//! The default text of the demo.

use ademan::layout::Layout;
use ademan::sim::taps_for_text;

use crate::failure::Failure;

/// Texts for layouts with letters and for layouts with digits.
const TEXTS: [&str; 2] = ["Hola! Typed by a hand, 1 tap each.", "3.14159*2-0.5"];
/// Length of the text for any other layout.
const MAX_CHARACTERS: usize = 20;

/// Returns the given text, or one that the layout can type.
pub fn choose(given: Option<&str>, layout: &Layout) -> Result<String, Failure> {
    let text = match given {
        Some(text) => text.to_owned(),
        None => default_text(layout),
    };
    if !text.is_empty() {
        return Ok(text);
    }
    Err(Failure::wrong_use(match given {
        Some(_) => "nothing to type: --text is empty".to_owned(),
        None => format!(
            "the demo types text, and no key of `{}` writes a character: name another layout with --layout; `ademan layout show` draws its keys",
            layout.name
        ),
    }))
}

fn default_text(layout: &Layout) -> String {
    let keys = layout.key_bindings();
    let can_type = |text: &str| taps_for_text(text, &keys).is_ok();
    if let Some(text) = TEXTS.into_iter().find(|text| can_type(text)) {
        return text.to_owned();
    }
    let visible = ('!'..='~').map(String::from);
    visible
        .filter(|text| can_type(text))
        .take(MAX_CHARACTERS)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_for(layout: &str) -> Result<String, Failure> {
        choose(None, &Layout::load(layout).unwrap())
    }

    #[test]
    fn every_shipped_layout_with_characters_gets_a_text_that_it_can_type() {
        assert_eq!(text_for("qwerty-flat").unwrap(), TEXTS[0]);
        assert_eq!(text_for("qwerty-arc").unwrap(), TEXTS[0]);
        assert_eq!(text_for("numpad").unwrap(), TEXTS[1]);
        assert!(text_for("arrows").is_err());
    }

    #[test]
    fn a_layout_of_two_letters_gets_these_letters() {
        let text = r#"Layout(name: "Yes and no", boards: [(
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
            rows: [(at_mm: (-19, 0), keys: "Y N Enter")],
        )])"#;
        let layout = Layout::parse(text, "yes-no.ron").unwrap();
        assert_eq!(choose(None, &layout).unwrap(), "ny");
        assert!(choose(Some(""), &layout).is_err());
    }
}
