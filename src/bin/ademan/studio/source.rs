//! The sources of Studio: a simulated hand that uses the layout again and again, and none beside a recording.

use std::thread;

use ademan::capture::{CaptureError, MAX_BLOCK, Source, SourceEvent};
use ademan::layout::HandUse;
use ademan::output;
use ademan::session::SessionOptions;
use ademan::setup::{LoadedSetup, OtherHand, Setup, simulated_glove};
use ademan::sim::HandTask;
use ademan::studio::simulated::{HandControl, simulate};

use crate::demo::looping;
use crate::failure::Failure;

/// Loads a setup. If it has no source, a simulated hand becomes the source, which plays what suits the active layout without end; its
/// control is returned. Where other programs receive what the hand presses, it types a text and does not try every key.
pub fn load(
    setup: Setup,
    options: &mut SessionOptions,
) -> Result<(LoadedSetup, Option<HandControl>), Failure> {
    let mut loaded = setup.load_files()?;
    if loaded.setup.source.is_some() {
        return Ok((loaded, None));
    }
    if let Some(both) = with_both_hands(&loaded) {
        loaded = both.load_files()?;
    }
    let task = if output::has_effect(&loaded.setup.output) {
        looping::typed
    } else {
        looping::toured
    };
    let (hand, control) = simulate(&loaded, HandTask::Fitting(task))?;
    options.source = Some(Box::new(hand));
    Ok((loaded, Some(control)))
}

/// Returns the setup with the second hand that its layout needs, if its person has two and it names none.
fn with_both_hands(loaded: &LoadedSetup) -> Option<Setup> {
    let other = loaded.arm.side().opposite();
    let is_needed = loaded.other_hand.is_none() && loaded.layout.uses_hand(other);
    let has_two = loaded.person.hands == HandUse::Both;
    (is_needed && has_two).then(|| Setup {
        other_hand: Some(OtherHand {
            glove: Some(simulated_glove(&loaded.layout, other).to_owned()),
            ..OtherHand::default()
        }),
        ..loaded.setup.clone()
    })
}

/// A source without readings, for the session behind the window while that shows a recording.
pub struct NoReadings;

impl Source for NoReadings {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        thread::sleep(MAX_BLOCK);
        Ok(SourceEvent::Idle)
    }

    fn name(&self) -> &str {
        "none"
    }

    fn is_live(&self) -> bool {
        false
    }
}
