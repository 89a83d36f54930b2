//! The default text of the demo.

use ademan::layout::Layout;
use ademan::sim::actions_for_text;

use crate::failure::Failure;

/// Texts for layouts with letters and signs, with digits, and with few signs.
const TEXTS: [&str; 3] = [
    "Hola! Typed by a hand, 1 tap each.",
    "3.14159*2-0.5",
    "hola mundo",
];
/// Texts of a tour through all layouts.
const SHORT_TEXTS: [&str; 3] = ["Hola!", "3.14", "hola"];
/// Length of the text for any other layout.
const MAX_CHARACTERS: usize = 20;

/// The text to type.
#[derive(Clone, Copy, Debug)]
pub enum TextChoice<'a> {
    /// This text.
    Given(&'a str),
    /// A text that the layout can type.
    Default,
    /// A text that the layout can type within a few seconds.
    Short,
}

/// Returns the text for a layout.
pub fn choose(choice: TextChoice, layout: &Layout) -> Result<String, Failure> {
    let text = match choice {
        TextChoice::Given(text) => text.to_owned(),
        TextChoice::Default => default_text(layout, TEXTS),
        TextChoice::Short => default_text(layout, SHORT_TEXTS),
    };
    if !text.is_empty() {
        return Ok(text);
    }
    Err(Failure::wrong_use(match choice {
        TextChoice::Given(_) => "nothing to type: --text is empty".to_owned(),
        _ => format!(
            "no key of `{}` writes a character; `ademan layout show` draws the keys",
            layout.name
        ),
    }))
}

fn default_text(layout: &Layout, texts: [&str; 3]) -> String {
    let can_type = |text: &str| actions_for_text(text, layout, false).is_ok();
    if let Some(text) = texts.into_iter().find(|text| can_type(text)) {
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
    use ademan::files::Load;

    fn text_for(layout: &str) -> Result<String, Failure> {
        choose(TextChoice::Default, &Layout::load(layout).unwrap())
    }

    #[test]
    fn every_shipped_layout_with_characters_gets_a_text_that_it_can_type() {
        assert_eq!(text_for("qwerty-flat").unwrap(), TEXTS[0]);
        assert_eq!(text_for("qwerty-arc").unwrap(), TEXTS[0]);
        assert_eq!(text_for("numpad").unwrap(), TEXTS[1]);
        assert_eq!(text_for("phone-pad").unwrap(), TEXTS[0]);
        let other = text_for("arrows").unwrap_err().to_string();
        assert!(other.contains("writes a character"), "{other}");
    }

    #[test]
    fn a_pad_of_letters_gets_a_text_without_signs() {
        let text = r#"Layout(name: "Pad", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 310, height_mm: -45), keys: [
            (action: Multitap("A B C D E F H L"), name: "1", at_mm: (-20, 0)),
            (action: Multitap("M N O U Space"), name: "2", at_mm: (20, 0)),
        ])])"#;
        let layout = Layout::parse(text, "pad.ron").unwrap();
        assert_eq!(choose(TextChoice::Default, &layout).unwrap(), TEXTS[2]);
    }

    #[test]
    fn a_layout_of_two_letters_gets_these_letters() {
        let text = r#"Layout(name: "Yes and no", boards: [(
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
            rows: [(at_mm: (-19, 0), keys: "Y N Enter")],
        )])"#;
        let layout = Layout::parse(text, "yes-no.ron").unwrap();
        assert_eq!(choose(TextChoice::Default, &layout).unwrap(), "ny");
        assert!(choose(TextChoice::Given(""), &layout).is_err());
    }
}
