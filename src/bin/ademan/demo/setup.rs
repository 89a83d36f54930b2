//! The setup of the demo: its hands, their gloves, and the person who is simulated.

use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::{Glove, HandUse, Layout, Person};
use ademan::message::escape;
use ademan::output;
use ademan::setup::{LoadedSetup, OtherHand, Setup, simulated_glove};

use super::Args;
use crate::failure::Failure;
use crate::{link, person};

/// The largest count of a channel on the simulated line.
const MAX_COUNT: u16 = 1023;

/// Stall timeout. The simulated hand pauses only when the whole machine is busy, which should not release its keys.
const STALL_TIMEOUT_MS: u32 = 1000;

/// Loads the setup whose gloves and arms the demo simulates. A person of the command line is simulated; the pipeline assumes the
/// arm and the person of the setup file, if it names any.
pub fn load(args: &Args) -> Result<LoadedSetup, Failure> {
    let base = match &args.setup {
        Some(path) => Setup::load(path)?,
        None => Setup::default(),
    };
    let assumed = base.person.clone().or(args.person.clone());
    let simulated = args.person.clone().or(assumed.clone());
    let simulated = simulated.as_deref().map(person::load).transpose()?;
    let side = side(args, simulated.as_ref())?;
    let layout_name = match args.layout.clone() {
        Some(layout) if output::has_effect(&args.output) => link::trusted(layout, args.trust)?,
        Some(layout) => link::looked_at(layout)?,
        None => base.layout,
    };
    let layout = Layout::load(&layout_name)?;
    let glove_of = |worn| simulated_glove(&layout, worn).to_owned();
    let has_other = layout.uses_hand(side.opposite());
    let uses_both = simulated
        .as_ref()
        .is_none_or(|person| person.hands == HandUse::Both);
    let glove = args.glove.clone().or(base.glove);
    let other = base.other_hand.unwrap_or_default();
    let setup = Setup {
        layout: layout_name,
        profiles: base.profiles,
        output: args.output.clone(),
        stall_timeout_ms: STALL_TIMEOUT_MS,
        glove: Some(glove.unwrap_or_else(|| glove_of(side))),
        person: assumed,
        arm: base.arm,
        other_hand: (has_other && uses_both).then(|| OtherHand {
            glove: Some(other.glove.unwrap_or_else(|| glove_of(side.opposite()))),
            arm: other.arm,
            ..OtherHand::default()
        }),
        smoothing: base.smoothing,
        learn_ranges: base.learn_ranges,
        allow_system_keys: base.allow_system_keys,
        ..Setup::default()
    };
    let loaded = setup.load_files()?;
    if !loaded.layout.uses_inputs() {
        check_gloves(&loaded)?;
    }
    match simulated {
        None => Ok(loaded),
        Some(person) => simulate(loaded, person),
    }
}

/// Returns a setup with the gloves that a simulated hand of this side wears, for both hands if its layout is for two, and with the
/// stall timeout of a busy machine.
pub fn with_simulated_gloves(setup: Setup, side: Side) -> Result<Setup, Failure> {
    let layout = Layout::load(&setup.layout)?;
    let other = side.opposite();
    Ok(Setup {
        stall_timeout_ms: STALL_TIMEOUT_MS,
        glove: Some(simulated_glove(&layout, side).to_owned()),
        other_hand: layout.uses_hand(other).then(|| OtherHand {
            glove: Some(simulated_glove(&layout, other).to_owned()),
            ..OtherHand::default()
        }),
        ..setup
    })
}

/// Returns the side of the first hand.
fn side(args: &Args, person: Option<&Person>) -> Result<Side, Failure> {
    match (args.hand, person.and_then(|person| person.side)) {
        (Some(named), Some(own)) if named != own => Err(Failure::wrong_use(format!(
            "--hand {named} contradicts the person, who types with the {own} hand; leave out --hand"
        ))),
        (named, own) => Ok(named.or(own).unwrap_or(Side::Right)),
    }
}

/// Refuses a glove whose counts the simulated line does not carry.
fn check_gloves(setup: &LoadedSetup) -> Result<(), Failure> {
    let is_too_fine = |glove: &&Glove| glove.map.full_scale() > MAX_COUNT;
    match setup.gloves().find(is_too_fine) {
        None => Ok(()),
        Some(glove) => Err(Failure::wrong_use(format!(
            "the demo simulates the line of an HC11 converter, with counts up to {MAX_COUNT}, but `{}` has counts up to {}; \
             simulate it with `ademan run --source 'typist:TEXT?protocol=lucidgloves' --glove GLOVE`",
            escape(&glove.name),
            glove.map.full_scale()
        ))),
    }
}

fn simulate(mut setup: LoadedSetup, person: Person) -> Result<LoadedSetup, Failure> {
    let side = setup.arm.side();
    match person.side {
        Some(own) if own != side => Err(Failure::wrong_use(format!(
            "the person types with the {own} hand, but the glove is for the {side} hand; choose a glove for the {own} hand with --glove"
        ))),
        _ => {
            setup.simulated_person = person;
            Ok(setup)
        }
    }
}
