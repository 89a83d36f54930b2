//! `ademan text`: builds language models, and decodes taps.

use std::io::{self, BufRead, Read, Write};
use std::path::{Path, PathBuf};

use ademan::device::KeyAction;
use ademan::document::DocumentError;
use ademan::files::{self, Load};
use ademan::layout::Layout;
use ademan::message::{escape, escape_path};
use ademan_text::build::{Builder, held_out};
use ademan_text::{Decoder, Key, Keyboard, Model, Options, Prior, Tap, TouchModel, languages};

use crate::failure::Failure;
use crate::{complete, result_files};

/// Build language models, and read taps with them
#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  ademan text build --words words.txt --text sentences.txt -o my.adm\n  echo '0 0' | ademan text decode en --layout qwerty-flat"
)]
pub enum Args {
    /// Build a language model from lists of words and text. The same files give the same bytes
    #[command(
        after_help = "Example: ademan text build --words words.txt --text sentences.txt --text more.txt -o my.adm"
    )]
    Build {
        /// A list of words, one each line, with a weight after a space: how often the word is expected in a text as long as the given
        /// ones
        #[arg(long, required_unless_present = "text")]
        words: Vec<PathBuf>,
        /// A text, a sentence each line. A word that no list has counts if it occurs twice
        #[arg(long)]
        text: Vec<PathBuf>,
        /// A language model in the ARPA format, as SRILM and KenLM write it, which is mixed with what the texts say. It adds no words
        #[arg(long, value_name = "FILE.arpa")]
        arpa: Option<PathBuf>,
        /// Leave out every 20th line of each text, to measure the model with it
        #[arg(long)]
        hold_out: bool,
        /// The model to write
        #[arg(short, long, value_name = "FILE.adm")]
        output: PathBuf,
    },
    /// Read taps from the standard input, one `x y` in mm each line from the center of the layout's first board, x to the right, y down.
    /// An empty line prints the candidates
    #[command(after_help = "Example: ademan text decode en --layout qwerty-flat < taps.txt")]
    Decode {
        /// The model: `en` or `es`, or a file
        model: String,
        /// Layout whose keys are tapped: the name of one that comes with the program, or a file
        #[arg(long, default_value = "qwerty-flat", add = complete::layout())]
        layout: String,
    },
}

pub fn run(args: Args) -> Result<(), Failure> {
    match args {
        Args::Build {
            words,
            text,
            arpa,
            hold_out,
            output,
        } => build(&words, &text, arpa.as_slice(), hold_out, &output),
        Args::Decode { model, layout } => decode(&model, &layout),
    }
}

fn read(path: &Path) -> Result<String, Failure> {
    let text = files::open_regular(path).and_then(|file| Ok(io::read_to_string(file)?));
    text.map_err(|error| Failure::cannot_read(path, error))
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let read = files::open_regular(path)
        .and_then(|mut file| Ok(file.read_to_end(&mut bytes).map(drop)?));
    read.map_err(|error| Failure::cannot_read(path, error))?;
    Ok(bytes)
}

fn build(
    words: &[PathBuf],
    texts: &[PathBuf],
    arpa: &[PathBuf],
    hold_out: bool,
    output: &Path,
) -> Result<(), Failure> {
    result_files::check(&[output], &[words, texts, arpa].concat())?;
    let mut builder = Builder::new();
    for path in words {
        add_list(&mut builder, path)?;
    }
    for path in arpa {
        let added = builder.arpa(&read(path)?);
        added.map_err(|error| Failure::cannot_read(path, error))?;
    }
    for path in texts {
        let text = read(path)?;
        let lines = text.lines().enumerate();
        for (_, line) in lines.filter(|&(line, _)| !(hold_out && held_out(line))) {
            builder.text(line);
        }
    }
    let bytes = builder
        .build()
        .map_err(|error| Failure::wrong_use(format!("cannot build a model: {error}")))?;
    files::replace(output, &bytes).map_err(|error| Failure::cannot_write(output, error))?;
    let model = Model::from_bytes(&bytes)
        .map_err(|error| Failure::job(format!("the model cannot be read: {error}")))?;
    Ok(writeln!(
        io::stdout(),
        "wrote {}: {} words, {} pairs of words, {} bytes",
        escape_path(output),
        model.lexicon.words(),
        model.bigrams.len(),
        bytes.len(),
    )?)
}

/// Adds a list of words, and reports the lines that are left out.
fn add_list(builder: &mut Builder, path: &Path) -> Result<(), Failure> {
    let counts = builder.words(&read(path)?);
    let (added, left_out) = counts.map_err(|error| Failure::cannot_read(path, error))?;
    let shown = escape_path(path);
    match (added, left_out) {
        (_, 0) => {}
        (0, _) => {
            return Err(Failure::wrong_use(format!(
                "{shown} is not a list of words: each line has a word of letters and apostrophes, and its weight after a space, as in \
                 `hello 5`"
            )));
        }
        _ => say!(
            "left out {left_out} of {} lines of {shown}: they do not begin with a word of letters and apostrophes",
            added + left_out
        ),
    }
    Ok(())
}

/// Returns the keys of the first board of a layout that type a character.
fn keyboard(name: &str) -> Result<Keyboard, DocumentError> {
    let layout = Layout::load(name)?;
    let Some(board) = layout.boards.first() else {
        return Ok(Keyboard::new([]));
    };
    let keys = layout.keys[board.keys.clone()].iter().filter_map(|key| {
        let Some(KeyAction::Key(code)) = key.action(0) else {
            return None;
        };
        let half = board.row_half_extents(&key.face);
        let center = key.face.row_position;
        Some(Key {
            character: code.us_character(false)?,
            center: [center.x * 1e3, -center.y * 1e3],
            size: [half.x * 2e3, half.y * 2e3],
            hand: u8::from(center.x > 0.0),
        })
    });
    Ok(Keyboard::new(keys))
}

fn decode(name: &str, layout: &str) -> Result<(), Failure> {
    let file;
    let bytes = match name {
        "en" => languages::ENGLISH,
        "es" => languages::SPANISH,
        absent if !Path::new(absent).exists() => {
            return Err(Failure::wrong_use(format!(
                "cannot read {}: there is no such file; the languages are `en` and `es`, and `ademan text build` makes a \
                 model of another one",
                escape(absent)
            )));
        }
        path => {
            file = read_bytes(Path::new(path))?;
            &file
        }
    };
    let model = Model::from_bytes(bytes)
        .map_err(|error| Failure::wrong_use(format!("cannot use {}: {error}", escape(name))))?;
    let keyboard = keyboard(layout)?;
    if keyboard.keys().is_empty() {
        return Err(Failure::wrong_use(format!(
            "no key of the first board of {} types a character",
            escape(layout)
        )));
    }
    let touch = TouchModel::new(Prior::default());
    let mut decoder = Decoder::new(model, keyboard, touch, Options::default());
    let mut out = io::stdout().lock();
    for (number, line) in io::stdin().lock().lines().enumerate() {
        let line = line?;
        if line.trim().is_empty() {
            print(&mut decoder, &mut out)?;
            decoder.commit();
            decoder.start_sentence();
            continue;
        }
        decoder.tap(tap(&line).ok_or_else(|| {
            Failure::wrong_use(format!(
                "line {} is not a tap `x y` in mm: {}",
                number + 1,
                escape(&line)
            ))
        })?);
    }
    print(&mut decoder, &mut out)
}

fn tap(line: &str) -> Option<Tap> {
    let mut numbers = line.split_whitespace().map(str::parse::<f32>);
    let (x, y) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
    let is_sane = numbers.next().is_none() && x.is_finite() && y.is_finite();
    is_sane.then(|| Tap::at(x, y))
}

/// Prints the candidates, the best first, with their log-probabilities.
fn print(decoder: &mut Decoder, out: &mut impl Write) -> Result<(), Failure> {
    if decoder.taps() == 0 {
        return Ok(());
    }
    for candidate in decoder.candidates() {
        writeln!(out, "{:.1}\t{}", candidate.score, candidate.text)?;
    }
    Ok(writeln!(out)?)
}
