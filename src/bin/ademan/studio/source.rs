//! The sources of Studio: a simulated hand that types again and again, and none beside a recording.

use std::collections::BTreeSet;
use std::thread;

use ademan::capture::{CaptureError, Hc11Format, MAX_BLOCK, Source, SourceEvent, SourceStats};
use ademan::setup::LoadedSetup;
use ademan::sim::{RepeatedTypist, SimulatedTypist};

use crate::demo::script;
use crate::demo::text::{self, TextChoice};
use crate::failure::Failure;

/// The script of a hand that rests.
const REST: &str = "wait 60000";

/// Returns a hand that types on the layout of a setup, or plays the script that comes with it, without end. It leaves out keys
/// beyond its reach, and rests above a layout that it cannot type on.
pub fn simulated_hand(setup: &LoadedSetup) -> Result<RepeatedTypist, Failure> {
    let format = Hc11Format {
        baud: std::num::NonZeroU32::new(115_200).expect("the rate is not 0"),
        ..Hc11Format::default()
    };
    let hand = match script::for_layout(&setup.setup.layout) {
        Some(script) => setup.scripted(script, &format, 0.0, 0)?,
        None => typist(setup, &format)?,
    };
    Ok(RepeatedTypist::new(hand))
}

fn typist(setup: &LoadedSetup, format: &Hc11Format) -> Result<SimulatedTypist, Failure> {
    let rest = || setup.scripted(REST, format, 0.0, 0);
    let Ok(text) = text::choose(TextChoice::Default, &setup.layout) else {
        complain!("the simulated hand rests, as no key of the layout writes a character");
        return Ok(rest()?);
    };
    let error = match setup.typist(&text, format, 0.0, 0) {
        Ok(typist) => return Ok(typist),
        Err(error) => error,
    };
    let characters: BTreeSet<char> = text.chars().collect();
    let is_reached = |letter: &char| setup.typist(&letter.to_string(), format, 0.0, 0).is_ok();
    let reached: BTreeSet<char> = characters.into_iter().filter(is_reached).collect();
    let text: String = text.chars().filter(|it| reached.contains(it)).collect();
    if text.is_empty() {
        complain!("{error}; until then the simulated hand rests");
        return Ok(rest()?);
    }
    complain!("{error}; until then the simulated hand types only the keys within its reach");
    Ok(setup.typist(&text, format, 0.0, 0)?)
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

    fn stats(&self) -> SourceStats {
        SourceStats::default()
    }
}
