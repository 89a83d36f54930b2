//! Simulated hands that do what suits the layout, again and again.

use ademan::capture::Hc11Format;
use ademan::layout::Layout;
use ademan::setup::{LoadedSetup, SetupError};
use ademan::sim::{HandTask, SimulatedTypist};

use super::script;
use super::text::{self, TextChoice};

/// Returns a hand that plays the script that comes with the layout, types a text, or tours the controls, without end. It
/// leaves out what is beyond its reach, with a message, and follows the layout.
pub fn hand(setup: &LoadedSetup, format: &Hc11Format) -> Result<SimulatedTypist, SetupError> {
    setup.live_hand(HandTask::Fitting(typed), format)
}

/// Returns the script that comes with a layout, else a text that it can type, else a tour of its controls.
pub fn typed(layout: &Layout) -> HandTask {
    let text = || text::choose(TextChoice::Default, layout).ok();
    shipped_script(layout)
        .or_else(|| text().map(HandTask::text))
        .unwrap_or_else(|| HandTask::tour(layout))
}

/// Returns the script that comes with a layout, else a tour that uses each control once.
#[cfg(feature = "studio")]
pub fn toured(layout: &Layout) -> HandTask {
    shipped_script(layout).unwrap_or_else(|| HandTask::tour(layout))
}

fn shipped_script(layout: &Layout) -> Option<HandTask> {
    HandTask::script(script::for_unchanged(layout)?, layout)
}

#[cfg(test)]
#[cfg(feature = "studio")]
mod tests {
    use ademan::capture::{Source, SourceEvent};
    use ademan::device::Events;
    use ademan::document::{Document, shipped_layouts};
    use ademan::files::{Load, OpenDocument};
    use ademan::setup::Setup;

    use super::*;

    fn is_script(task: &HandTask, words: &str) -> bool {
        matches!(task, HandTask::Script(script) if script.text().contains(words))
    }

    #[test]
    fn the_hand_of_studio_plays_the_script_of_a_layout_or_tours_it() {
        for name in shipped_layouts() {
            let layout = Layout::load(name).expect("a layout that comes with the program");
            let words = script::for_layout(name).unwrap_or("A tour of");
            assert!(is_script(&toured(&layout), words), "{name}");
        }
    }

    #[test]
    fn an_edited_layout_has_a_tour_in_place_of_its_script() {
        let document = Document::open("media").expect("a layout that comes with the program");
        let text = document
            .text
            .replace(r#"name: "Volume""#, r#"name: "Loudness""#);
        let layout = Layout::parse(&text, &document.file).expect("another name");
        assert!(is_script(&toured(&layout), "Loudness"));
    }

    #[test]
    fn the_script_with_a_key_that_pauses_does_not_pause_the_session() {
        let setup = Setup {
            layout: "switches".to_owned(),
            ..Setup::default()
        };
        let setup = setup
            .load_files()
            .expect("a layout that comes with the program");
        let format = Hc11Format::default();
        let mut hand = setup.live_hand(HandTask::Fitting(toured), &format);
        let hand = hand.as_mut().expect("a hand");
        let (mut pipeline, mut events, mut count) = (setup.pipeline(), Events::new(), 0);
        for _ in 0..2000 {
            if let Ok(SourceEvent::Reading(reading)) = hand.next() {
                events.clear();
                pipeline
                    .step(&reading, &mut events)
                    .expect("an accepted reading");
                count += events.len();
            }
            assert_eq!(pipeline.paused_by(), None);
        }
        assert!(count > 0);
    }
}
