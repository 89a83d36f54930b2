//! `ademan calibrate --discover`: a glove file for a glove of which nothing is known.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;

use ademan::calibrate::{
    self, CalibrationPose, DISCOVERY_POSES, Discovery, Observations, Procedure,
};
use ademan::document::{Document, quote};
use ademan::estimate::{ChannelMap, InputRow};
use ademan::files::Load;
use ademan::hand::{Dof, Side};
use ademan::layout::Glove;
use ademan::setup::LoadedSetup;

use super::destination::Destination;
use super::session::{Outcome, Session};
use super::{Args, glove_document, open_feed, source_word};
use crate::failure::Failure;
use crate::{messages, new_file, signals};

/// The name of a glove file without a name of its own.
const NAME: &str = "glove";

pub fn run(args: Args) -> Result<Outcome, Failure> {
    let setup = args.load_setup()?;
    let like = similar_glove(&setup, &args)?;
    let side = args.side();
    let destination = Destination::new(args.out, &Document::new(NAME, ""), args.force)?;
    messages::start()?;
    signals::install()?;
    let feed = open_feed(&setup, &like, (args.demo, args.demo_glove))?;
    let prepare = Duration::from_secs_f64(args.countdown);
    let procedure = Procedure::for_unknown_glove(DISCOVERY_POSES, like.map.inputs(), prepare);
    let mut session = Session::new("an unknown glove", side, None, procedure, feed);
    if let Outcome::Quit = session.run()? {
        return Ok(Outcome::Quit);
    }
    let full_scale = session.full_scale();
    let observations = session.procedure.observations();
    let discovery = calibrate::discover(observations, full_scale)?;
    let known = (like.map.full_scale() == full_scale).then(|| Known {
        map: &like.map,
        assumed: assumed_angles(&discovery, &like.map, observations),
    });
    let text = glove_text(&discovery, destination.path(), side, full_scale, known);
    if destination.write(&text, &report(&discovery))? {
        let file = destination.as_word();
        let mut out = io::stdout();
        let source = source_word(args.source.as_ref(), args.demo);
        writeln!(
            out,
            "next: ademan calibrate --glove {file} --source {source}"
        )?;
    }
    Ok(Outcome::Finished)
}

/// Returns the glove that comes with the program for such a source: every glove with this protocol has
/// its channels of sticks and buttons, and the arm that they do not measure.
fn similar_glove(setup: &LoadedSetup, args: &Args) -> Result<Glove, Failure> {
    let worn = match (args.demo, args.side()) {
        (Some(_), Side::Left) if args.demo_glove.is_none() => Some("unam-hc11-left"),
        (Some(_), Side::Right) if args.demo_glove.is_none() => Some("unam-hc11"),
        _ => None,
    };
    Ok(match worn {
        Some(name) => Glove::load(name)?,
        None => Glove::parse(&glove_document(setup)?)?,
    })
}

/// The parts of a glove other than its channels of joints.
struct Known<'a> {
    map: &'a ChannelMap,
    /// Angles that the glove does not measure, in radians.
    assumed: Vec<(Dof, f64)>,
}

/// Returns the angles of a similar glove for joints that were not found: the angles that it assumes, and the angles of its channels
/// that this glove does not send.
fn assumed_angles(
    discovery: &Discovery,
    like: &ChannelMap,
    observations: &Observations,
) -> Vec<(Dof, f64)> {
    let flat = observations.get(CalibrationPose::Flat);
    let at_rest = like.rows().iter().filter_map(|row| {
        let count = flat?.median(row.channel)?;
        let radians = like.radians(row, count);
        let is_unsent = !observations.is_sent(row.channel);
        (is_unsent && radians != 0.0).then_some((row.dof, radians))
    });
    let assumed = like.assumed_angles().iter().copied().chain(at_rest);
    let is_found = |dof: Dof| discovery.rows.iter().any(|row| row.dof == dof);
    assumed.filter(|(dof, _)| !is_found(*dof)).collect()
}

/// Returns the channel of each joint, and those that are not clear.
fn report(discovery: &Discovery) -> String {
    let mut text = format!("{:<22}channel\n", "joint");
    for row in &discovery.rows {
        let _ = writeln!(text, "{:<22}{}", row.dof.name(), row.channel);
    }
    if !discovery.unclear.is_empty() {
        let unclear = discovery.unclear.iter().map(usize::to_string);
        let unclear: Vec<String> = unclear.collect();
        let _ = writeln!(
            text,
            "not clear: {}; each spreads the fingers, follows several parts of the hand, or is one too many for its finger",
            unclear.join(", ")
        );
    }
    text.push('\n');
    text
}

fn glove_text(
    discovery: &Discovery,
    path: &Path,
    side: Side,
    full_scale: u16,
    known: Option<Known>,
) -> String {
    let name = quote(&new_file::name_of(path));
    let mut text = format!(
        "// Channels found by `ademan calibrate --discover`. The channels of a finger are assumed to be in order from the knuckle outwards:\n\
         // exchange the numbers of two channels if a finger bends at the wrong joint.\n\
         Glove(\n    name: {name},\n    side: \"{side}\",\n    full_scale_counts: {full_scale},\n"
    );
    if let Some(known) = &known {
        put_known(&mut text, known);
    }
    text.push_str("    rows: [\n");
    for row in &discovery.rows {
        let zero = row.calibration.apply_inverse(0.0);
        let _ = writeln!(
            text,
            "        (label: {:?}, dof: \"{}\", channel: {}, offset_counts: {:?}, full_scale_rad: {:?}, offset_rad: 0.0),",
            row.label,
            row.dof,
            row.channel,
            round(-zero, 10.0),
            round(row.calibration.gain * f64::from(full_scale), 1e4)
        );
    }
    text.push_str("    ],\n");
    if let Some(known) = &known {
        put_inputs(&mut text, known.map.inputs());
    }
    text.push_str(")\n");
    text
}

/// Appends what is known of the counts and of the joints that the glove does not measure.
fn put_known(text: &mut String, known: &Known) {
    if known.map.uses_full_range() {
        text.push_str("    uses_full_range: true,\n");
    }
    let entry =
        |(dof, radians): &(Dof, f64)| format!("\"{dof}\": {:?}", round(radians.to_degrees(), 10.0));
    let assumed: Vec<String> = known.assumed.iter().map(entry).collect();
    if !assumed.is_empty() {
        let _ = writeln!(text, "    assumed_deg: {{{}}},", assumed.join(", "));
    }
}

/// Appends the sticks, triggers and buttons.
fn put_inputs(text: &mut String, inputs: &[InputRow]) {
    if inputs.is_empty() {
        return;
    }
    text.push_str("    inputs: [\n");
    for row in inputs {
        let counts = |value: f64| round(row.calibration.apply_inverse(value), 10.0);
        let _ = writeln!(
            text,
            "        (input: \"{}\", channel: {}, zero_counts: {:?}, full_counts: {:?}),",
            row.input,
            row.channel,
            counts(0.0),
            counts(1.0)
        );
    }
    text.push_str("    ],\n");
}

/// Rounds to a multiple of 1/`scale`. 0 has no sign.
fn round(value: f64, scale: f64) -> f64 {
    (value * scale).round() / scale + 0.0
}
