//! `ademan lab replay`: a recorded hand over other layouts.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::capture::recording::Replay;
use ademan::capture::{Source, SourceEvent};
use ademan::command::CommandOrigin;
use ademan::device::Events;
use ademan::document::{Document, FileKind};
use ademan::files::OpenDocument;
use ademan::message::{escape, escape_json, escape_path};
use ademan::setup::{LoadedSetup, ReplaySettings};
use ademan::trials::{Retraced, Retracer};
use serde_json::json;

use super::outputs;
use crate::failure::Failure;
use crate::{complete, result_files};

/// Names that are listed of each kind.
const NAMED: usize = 8;

/// The limits of such a replay.
const LIMITS: &str = "limits of a replay: the person aimed at the keys of the recorded layout and saw what they did there. On another layout the same \
path presses what lies under it by chance, so these figures say where the hand was and how clear its presses were, not how fast or \
how well the person would type. `ademan lab score` simulates people who aim at the layout";

#[derive(clap::Args)]
pub struct Args {
    /// Recording
    #[arg(add = complete::recording())]
    recording: PathBuf,
    /// Layouts: shipped names, or files. Without any, the recorded one
    #[arg(add = complete::layout())]
    layouts: Vec<String>,
    /// Glove that replaces the recorded one
    #[arg(long, add = complete::glove())]
    glove: Option<String>,
    /// Result file to write: everything that was found. It holds what was typed
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    if let Some(path) = &args.json {
        result_files::check(&[path], &files(args)?)?;
    }
    let mut all = Vec::new();
    let chosen: Vec<Option<&str>> = if args.layouts.is_empty() {
        vec![None]
    } else {
        args.layouts.iter().map(|it| Some(it.as_str())).collect()
    };
    let mut cut = None;
    for layout in chosen {
        let (name, found, truncation) = retrace(args, layout)?;
        all.push((name, found));
        cut = cut.or(truncation);
    }
    // The file comes first: a reader of the text that ends early must not cost it.
    let path = args.json.as_ref();
    let written = path.map_or(Ok(()), |path| write(path, &args.recording, &all));
    let printed = print_all(&args.recording, &all);
    written?;
    printed?;
    match cut {
        None => Ok(()),
        Some(offset) => Err(Failure::damaged(format!(
            "{} is cut off at byte {offset}: everything before it was used",
            escape_path(&args.recording)
        ))),
    }
}

/// Returns the paths of the files that are read.
fn files(args: &Args) -> Result<Vec<PathBuf>, Failure> {
    let mut files = vec![args.recording.clone()];
    for layout in &args.layouts {
        files.extend(Document::open_kind(FileKind::Layout, layout)?.path);
    }
    if let Some(glove) = &args.glove {
        files.extend(Document::open_kind(FileKind::Glove, glove)?.path);
    }
    Ok(files)
}

/// Passes a recording through the pipeline with a layout. Returns the name of the layout, what was found, and the offset at which the
/// recording is cut off.
fn retrace(args: &Args, layout: Option<&str>) -> Result<(String, Retraced, Option<u64>), Failure> {
    let mut replay = Replay::open(&args.recording)?;
    let settings = ReplaySettings {
        glove: args.glove.as_deref(),
        layout,
        person: None,
        permissions: None,
    };
    let setup = LoadedSetup::from_recording(replay.setup(), &settings)?;
    let mut pipeline = setup.pipeline();
    let mut retracer = Retracer::new(&setup.layout);
    let mut events = Events::new();
    loop {
        events.clear();
        match replay.next()? {
            SourceEvent::Reading(reading) => match pipeline.step(&reading, &mut events) {
                Ok(output) => {
                    let side = output.pose.side;
                    retracer.see(reading.time, side, output, &events);
                }
                Err(_) => retracer.reject(),
            },
            SourceEvent::Command(command) => {
                // A command that concerns the recorded layout, such as a profile, does nothing on another one.
                let _ = pipeline.execute(&command, CommandOrigin::Client, &mut events);
            }
            SourceEvent::Idle => {}
            SourceEvent::End => break,
        }
    }
    let name = layout.map_or_else(|| setup.layout.file.clone(), str::to_owned);
    let truncation = replay.truncation().map(|cut| cut.offset);
    Ok((name, retracer.finish(), truncation))
}

/// Writes the result file.
fn write(path: &Path, recording: &Path, all: &[(String, Retraced)]) -> Result<(), Failure> {
    let layouts = all.iter();
    let layouts = layouts.map(|(layout, found)| json!({"layout": layout, "found": found}));
    let recording = recording.to_string_lossy();
    let result =
        json!({"recording": recording, "limits": LIMITS, "layouts": layouts.collect::<Vec<_>>()});
    let text = serde_json::to_string_pretty(&result).map_err(io::Error::from)?;
    outputs::write_private(path, &format!("{}\n", escape_json(&text)))
}

fn print_all(recording: &Path, all: &[(String, Retraced)]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    for (layout, found) in all {
        print(recording, layout, found, &mut out)?;
    }
    writeln!(out, "{LIMITS}.")
}

fn print(recording: &Path, layout: &str, found: &Retraced, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{} on {}: {:.1} s, {} readings, {} of them rejected",
        escape_path(recording),
        escape(layout),
        found.seconds,
        found.readings,
        found.rejected
    )?;
    let mut presses: Vec<(&String, &u64)> = found.presses.iter().collect();
    presses.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
    let all: u64 = presses.iter().map(|(_, count)| **count).sum();
    let names = presses
        .iter()
        .map(|(key, count)| format!("{} {count}", escape(key)));
    listed(out, &format!("presses {all}"), presses.len(), names)?;
    let near = found.near_presses.iter();
    let near = near.map(|it| {
        let keys = (escape(&it.pressed), escape(&it.other));
        format!(
            "{} {:.1} mm from {} at {:.2} s",
            keys.0, it.distance_mm, keys.1, it.seconds
        )
    });
    listed(
        out,
        &format!(
            "presses within 3 mm of another key {}",
            found.near_press_count
        ),
        found.near_presses.len(),
        near,
    )?;
    let misses = found.near_misses.iter().map(|it| {
        let (key, finger) = (escape(&it.key), escape(&it.finger));
        format!(
            "{key} by the {finger} finger, {:.1} mm, at {:.2} s",
            it.height_mm, it.seconds
        )
    });
    listed(
        out,
        &format!("approaches that pressed nothing {}", found.near_miss_count),
        found.near_misses.len(),
        misses,
    )?;
    for (finger, path) in &found.paths {
        let keys = path.keys.iter().map(|key| escape(key).to_string());
        let title = format!(
            "{} over the boards {:.0} mm, {} keys",
            escape(finger),
            path.length_mm,
            path.key_count
        );
        listed(out, &title, path.keys.len(), keys)?;
    }
    writeln!(out, "  text: {}", escape(&found.text))
}

/// Writes a title and the first names.
fn listed(
    out: &mut impl Write,
    title: &str,
    count: usize,
    names: impl Iterator<Item = String>,
) -> io::Result<()> {
    let names: Vec<String> = names.take(NAMED).collect();
    let rest = if count > NAMED { ", …" } else { "" };
    let colon = if names.is_empty() { "" } else { ": " };
    writeln!(out, "  {title}{colon}{}{rest}", names.join(", "))
}
