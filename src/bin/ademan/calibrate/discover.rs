//! `ademan calibrate --discover`: a glove file for a glove of which nothing is known.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use ademan::calibrate::{self, DISCOVERY_POSES, Discovery, Procedure};
use ademan::document::Document;
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::Glove;

use super::destination::Destination;
use super::session::{Outcome, Session};
use super::{Args, open_feed};
use crate::failure::Failure;
use crate::{messages, signals};

/// The name of a glove file without a name of its own.
const NAME: &str = "glove";

pub fn run(args: Args) -> Result<(), Failure> {
    let setup = args.load_setup()?;
    let destination = Destination::new(args.out, &Document::new(NAME, ""), args.force)?;
    messages::start()?;
    signals::install()?;
    let worn = Glove::load(match args.hand {
        Side::Left => "unam-hc11-left",
        Side::Right => "unam-hc11",
    })?;
    let feed = open_feed(&setup, &worn, args.demo)?;
    let prepare = Duration::from_secs_f64(args.countdown);
    let procedure = Procedure::for_unknown_glove(DISCOVERY_POSES, prepare);
    let mut session = Session::new("an unknown glove", args.hand, None, procedure, feed);
    if let Outcome::Quit = session.run()? {
        println!("no file was written");
        return Ok(());
    }
    let full_scale = session.full_scale();
    let discovery = calibrate::discover(session.procedure.observations(), full_scale)?;
    print!("{}", report(&discovery));
    let text = glove_text(&discovery, destination.path(), args.hand, full_scale);
    if destination.write(&text)? {
        let file = destination.as_word();
        println!("next: ademan calibrate --glove {file} --source …");
    }
    Ok(())
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

fn glove_text(discovery: &Discovery, path: &Path, side: Side, full_scale: u16) -> String {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "// Channels found by `ademan calibrate --discover`. Those of one finger are assumed to be in order from the knuckle outwards:\n\
         // exchange the numbers of two channels if a finger bends at the wrong joint.\n\
         Glove(\n    name: {name:?},\n    side: \"{side}\",\n    full_scale_counts: {full_scale},\n    rows: [\n"
    );
    let round = |value: f64, scale: f64| (value * scale).round() / scale + 0.0;
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
    text.push_str("    ],\n)\n");
    text
}
