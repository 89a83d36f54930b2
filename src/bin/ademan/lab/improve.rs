//! `ademan lab improve`: a layout is changed until people do better on it.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use ademan::document::{Document, FileKind};
use ademan::files::{self, FileError, OpenDocument};
use ademan::improve::{Found, ImproveError, MoveKind, Objective, Progress, Reference, Task};
use ademan::layout::Layout;
use ademan::measures::{Comparison, FEWEST_PEOPLE, Interval, LabResult, compare};
use ademan::message::{escape, escape_path, shell_word};
use ademan::session::counted;

use super::conditions::{ConditionArgs, Prepared};
use super::{OutputArgs, kinds, outputs, table};
use crate::failure::Failure;
use crate::setup_args::{number_in, one_of};
use crate::{complete, new_file, result_files, signals};

/// The people of the search and the held-out people by default.
const PEOPLE: u32 = 20;
/// The width of the progress bar, in characters.
const BAR: usize = 30;
/// The time between two updates of the bar.
const REDRAW: Duration = Duration::from_millis(200);

#[derive(clap::Args)]
pub struct Args {
    /// Layout: the name of one that comes with the program, or a file. It is not changed
    #[arg(add = complete::layout())]
    layout: String,
    /// Parts that may change: positions of boards, rows and controls; sizes; or which key has which letter. Separate several by commas
    #[arg(long = "move", value_name = "MOVES", required = true, value_delimiter = ',', value_parser = one_of::<MoveKind>(MoveKind::NAMES))]
    kinds: Vec<MoveKind>,
    /// Objective: speed, errors or effort, or weights such as speed=1,errors=2
    #[arg(long, value_name = "OBJECTIVE", default_value = "speed")]
    objective: Objective,
    /// Controls that stay as they are on their board; `boards` keeps the poses of all boards. Separate several by spaces
    #[arg(long, value_name = "NAMES")]
    keep: Vec<String>,
    /// Growth of the outline of a board on each side that is allowed, in mm
    #[arg(long, value_name = "MM", default_value_t = 0.0, value_parser = margin)]
    margin: f64,
    /// Changed layouts that are tried
    #[arg(long, value_name = "N", default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: u32,
    /// File to write; NAME-improved.ron in this folder by default. An existing file is not overwritten
    #[arg(long, short, value_name = "FILE", conflicts_with = "overwrite")]
    output: Option<PathBuf>,
    /// Write to the file of the layout itself
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    conditions: ConditionArgs,
    #[command(flatten)]
    outputs: OutputArgs,
}

fn margin(text: &str) -> Result<f64, String> {
    number_in(text, 0.0, 500.0, "mm")
}

/// The file of the result.
enum Destination {
    New(PathBuf),
    /// The file of the layout.
    Same(PathBuf),
}

/// A file that was written.
enum Written {
    New(PathBuf),
    /// The file of the layout has its new text.
    Same(PathBuf),
    /// A new file, because the file of the layout was changed during the search.
    Beside(PathBuf),
}

impl Destination {
    fn new(args: &Args, document: &Document) -> Result<Self, Failure> {
        if args.overwrite {
            // A file in the working folder may have the name of another layout.
            let Some(path) = &document.path else {
                return Err(Failure::wrong_use(format!(
                    "{} comes with the program and cannot be overwritten; use --output FILE",
                    escape(&args.layout)
                )));
            };
            let checked = files::check_overwrite(path);
            checked.map_err(|error| Failure::cannot_write(path, error))?;
            return Ok(Self::Same(path.clone()));
        }
        let path = args.output.clone().unwrap_or_else(|| {
            let stem = Path::new(&args.layout).file_stem().unwrap_or_default();
            PathBuf::from(format!("{}-improved.ron", stem.to_string_lossy()))
        });
        if path == Path::new("-") {
            return Err(Failure::wrong_use(
                "the figures go to the standard output, so the layout needs a file; use --output FILE",
            ));
        }
        let path = new_file::with_extension(&path, "ron");
        if path.exists() {
            return Err(Failure::wrong_use(format!(
                "{} exists; use --output FILE with another name, or remove it",
                escape_path(&path)
            )));
        }
        new_file::check(&path)?;
        Ok(Self::New(path))
    }

    /// Writes the improved text of a layout that was read as `document`. Edits of its file since then are kept.
    fn write(&self, document: &Document, layout: &Layout, text: &str) -> Result<Written, Failure> {
        let create = |path: &Path| {
            let renamed = new_file::renamed(text, &layout.name, path);
            new_file::write(path, &renamed)
        };
        match self {
            Self::New(path) => {
                create(path)?;
                Ok(Written::New(path.clone()))
            }
            Self::Same(path) => {
                let is_unchanged = || {
                    let present = Document::from_path(&path.to_string_lossy());
                    present.is_ok_and(|present| present.text == document.text)
                };
                match files::replace_text_if(path, text, is_unchanged) {
                    Ok(()) => Ok(Written::Same(path.clone())),
                    Err(FileError::Changed) => {
                        let copy = beside(path);
                        create(&copy)?;
                        Ok(Written::Beside(copy))
                    }
                    Err(error) => Err(outputs::cannot_write(path, &error)),
                }
            }
        }
    }
}

impl Written {
    /// Reports the written file and its layout, which the user calls `name`.
    fn announce(&self, name: &str) -> Result<(), Failure> {
        let path = match self {
            Self::Same(path) => {
                say!("overwrote {}", escape_path(path));
                return Ok(());
            }
            Self::Beside(path) => {
                complain!(
                    "{} was changed during the search, and is left as it is",
                    escape(name)
                );
                path
            }
            Self::New(path) => path,
        };
        let origin = format!("an improved copy of {name}");
        let next = format!(
            "ademan layout check FILE && ademan lab compare {} FILE",
            shell_word(name)
        );
        new_file::announce(path, &origin, &next)
    }
}

/// Returns a name beside a layout that no other file has.
fn beside(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    new_file::first_free(|number| match number {
        1 => path.with_file_name(format!("{stem}-improved.ron")),
        _ => path.with_file_name(format!("{stem}-improved-{number}.ron")),
    })
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let document = Document::open_kind(FileKind::Layout, &args.layout)?;
    let layout = Layout::from_document(document.clone())?;
    let destination = Destination::new(args, &document)?;
    let mut read = args.conditions.files()?;
    read.extend(document.path.clone());
    result_files::check(&args.outputs.paths(), &read)?;
    let prepared = Prepared::new(&args.conditions.with_people(PEOPLE))?;
    if prepared.decoder.is_some() {
        return Err(Failure::wrong_use(
            "layouts are improved without a text decoder; use --decoder off",
        ));
    }
    if prepared.corpus.phrases.len() < 2 {
        return Err(Failure::wrong_use(
            "one phrase cannot be used to search and to judge; give at least two lines of text",
        ));
    }
    if prepared.people() < FEWEST_PEOPLE {
        return Err(Failure::wrong_use(format!(
            "fewer than {FEWEST_PEOPLE} people cannot show which layout is better; use --people with {FEWEST_PEOPLE} or more"
        )));
    }
    kinds::check(&prepared, std::slice::from_ref(&document))?;
    let search = prepared.half(false)?;
    let found = find(args, &document, &search)?;
    say!("{}", summary(&found));
    if found.text == document.text {
        return Err(Failure::job(format!(
            "no better layout found than {}: {}nothing is written",
            escape(&args.layout),
            advice(&found)
        )));
    }
    let judged = if found.is_cancelled {
        None
    } else {
        judge(args, (&document, &found.text), &destination, &prepared)?
    };
    let Some([before, mut after]) = judged else {
        complain!(
            "interrupted: the best layout so far was not judged by held-out people; judge it with `ademan lab compare`"
        );
        let written = destination.write(&document, &layout, &found.text)?;
        return written.announce(&args.layout);
    };
    let judgement = Judgement::new(args, &before, &after)?;
    after.comparison = Some(judgement.comparison.clone());
    // The files come first: a reader of the text that ends early must not cost them.
    let is_better = judgement.gain.low > 0.0;
    let layout_file = is_better
        .then(|| destination.write(&document, &layout, &found.text))
        .transpose();
    let results = outputs::write(&args.outputs, &[before, after]);
    let printed = judgement.print(args);
    let announced = layout_file?.map_or(Ok(()), |written| written.announce(&args.layout));
    results?;
    printed?;
    announced?;
    if is_better {
        return Ok(());
    }
    Err(Failure::job(format!(
        "no better layout found than {}: the gain of the search does not hold for other people and phrases, so nothing is written; larger --people and --steps may help",
        escape(&args.layout)
    )))
}

/// Scores the original and the found text with held-out people. Returns both results, or `None` after an interruption.
fn judge(
    args: &Args,
    (document, found): (&Document, &str),
    destination: &Destination,
    prepared: &Prepared,
) -> Result<Option<[LabResult; 2]>, Failure> {
    let held_out = prepared.half(true)?;
    let name = match destination {
        Destination::New(path) => path.to_string_lossy().into_owned(),
        Destination::Same(_) => format!("{}, changed", args.layout),
    };
    let scores = held_out
        .score_document(&args.layout, document.clone())
        .and_then(|before| {
            let after = held_out.score_document(&name, Document::new(name.as_str(), found))?;
            Ok([before, after])
        });
    match scores {
        Err(_) if signals::is_stop_requested() => Ok(None),
        scores => scores.map(Some),
    }
}

fn find(args: &Args, document: &Document, search: &Prepared) -> Result<Found, Failure> {
    let keep: Vec<String> = args
        .keep
        .iter()
        .flat_map(|names| names.split_whitespace().map(str::to_owned))
        .collect();
    let task = Task {
        document,
        people: &search.participants,
        corpus: &search.corpus,
        phrases: search.count,
        source: search.source,
        kinds: &args.kinds,
        keep: &keep,
        margin: (args.margin * 1e-3) as f32,
        objective: args.objective,
        steps: args.steps,
        seed: search.seed,
        jobs: search.jobs,
    };
    let mut bar = Bar::new();
    let found = ademan::improve::improve(&task, &search.cancel, |progress| bar.show(&progress));
    bar.end();
    found.map_err(|error| match error {
        ImproveError::NoMoves(ademan::improve::NoMoves::Document(error)) => error.into(),
        ImproveError::Cancelled | ImproveError::Score(_) => {
            Failure::job(format!("cannot improve {}: {error}", escape(&args.layout)))
        }
        other => Failure::wrong_use(format!("cannot improve {}: {other}", escape(&args.layout))),
    })
}

fn summary(found: &Found) -> String {
    let (numbers, keys) = found.changes;
    let mut parts = Vec::new();
    if numbers > 0 {
        parts.push(counted(numbers as u64, "number"));
    }
    if keys > 0 {
        parts.push(counted(keys as u64, "key"));
    }
    let changed = if parts.is_empty() {
        "nothing changed".to_owned()
    } else {
        format!("{} changed", parts.join(" and "))
    };
    let refused = found.refused;
    format!(
        "tried {}: {changed}; not tried: {} that overlap or are out of range, {} outside the outline, {} out of reach",
        counted(u64::from(found.tried), "layout"),
        refused.invalid,
        refused.outline,
        refused.reach
    )
}

fn advice(found: &Found) -> &'static str {
    if u64::from(found.tried) < found.refused.outline {
        return "most changes leave the outline of a board, and --margin allows that; ";
    }
    ""
}

/// The judgement of held-out people on both layouts.
struct Judgement {
    subjects: String,
    phrases: usize,
    comparison: Comparison,
    /// The gain for the objective.
    gain: Interval,
    /// The layouts type.
    types: bool,
}

impl Judgement {
    fn new(args: &Args, before: &LabResult, after: &LabResult) -> Result<Self, Failure> {
        let comparison = compare(
            (&before.layout_file, &before.scores),
            (&after.layout_file, &after.scores),
        );
        let reference = Reference::new(&before.scores);
        Ok(Self {
            subjects: before.subjects(),
            phrases: before.corpus_phrases.len(),
            comparison: comparison.map_err(|error| Failure::job(error.to_string()))?,
            gain: args
                .objective
                .gain(&before.scores, &after.scores, &reference),
            types: before.summary.characters > 0,
        })
    }

    fn print(&self, args: &Args) -> io::Result<()> {
        let mut out = io::stdout().lock();
        writeln!(
            out,
            "held out: {} and {} phrases that the search has not seen",
            self.subjects, self.phrases
        )?;
        table::print_comparison(&self.comparison, &mut out)?;
        writeln!(
            out,
            "gain for the objective: {:.2} ({:.2} to {:.2}) {}",
            self.gain.value,
            self.gain.low,
            self.gain.high,
            args.objective.unit(self.types)
        )
    }
}

/// A progress bar on a terminal, and a line for each tenth elsewhere.
struct Bar {
    is_terminal: bool,
    start: Instant,
    drawn: Option<Instant>,
    tenth: u32,
}

impl Bar {
    fn new() -> Self {
        Self {
            is_terminal: io::stderr().is_terminal(),
            start: Instant::now(),
            drawn: None,
            tenth: 0,
        }
    }

    fn show(&mut self, progress: &Progress) {
        let Progress { step, steps, gain } = *progress;
        if !self.is_terminal {
            let tenth = (u64::from(step) * 10 / u64::from(steps)) as u32;
            if tenth > self.tenth {
                self.tenth = tenth;
                say!("{step} of {steps} layouts tried, gain in the search {gain:.2}");
            }
            return;
        }
        if self.drawn.is_some_and(|last| last.elapsed() < REDRAW) && step < steps {
            return;
        }
        self.drawn = Some(Instant::now());
        let part = f64::from(step) / f64::from(steps);
        let full = (part * BAR as f64) as usize;
        let left = self.start.elapsed().as_secs_f64() * (1.0 - part) / part.max(1e-3);
        let bar = format!("{}{}", "#".repeat(full), "-".repeat(BAR - full));
        // Nothing is lost without the bar.
        let _ = write!(
            io::stderr(),
            "\r[{bar}] {step}/{steps}  gain {gain:.2}  {left:.0} s left   "
        );
    }

    fn end(&self) {
        if self.drawn.is_some() {
            let _ = writeln!(io::stderr());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const BOARD: &str = r#"Layout(name: "mine", boards: [(pose: (anchor: elbow), rows: [(at_mm: (0, 0), keys: "Q W")])])"#;

    #[test]
    fn edits_of_a_layout_during_the_search_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.ron");
        fs::write(&path, BOARD).unwrap();
        let name = path.to_string_lossy();
        let document = Document::open_kind(FileKind::Layout, &name).unwrap();
        let layout = Layout::from_document(document.clone()).unwrap();
        let destination = Destination::Same(path.clone());
        let better = BOARD.replace("Q W", "W Q");
        let edited = BOARD.replace("Q W", "Q W E");
        fs::write(&path, &edited).unwrap();
        for beside in ["mine-improved", "mine-improved-2"] {
            let written = destination.write(&document, &layout, &better).unwrap();
            assert!(matches!(written, Written::Beside(_)));
            assert_eq!(fs::read_to_string(&path).unwrap(), edited);
            let copy = fs::read_to_string(folder.path().join(format!("{beside}.ron"))).unwrap();
            assert_eq!(copy, better.replace("mine", beside));
        }
        fs::write(&path, BOARD).unwrap();
        let written = destination.write(&document, &layout, &better).unwrap();
        assert!(matches!(written, Written::Same(_)));
        assert_eq!(fs::read_to_string(&path).unwrap(), better);
    }
}
