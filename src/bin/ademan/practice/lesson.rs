//! The text to type: a given one, or a short one that the layout can type.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::Path;

use ademan::contact::TargetId;
use ademan::document::BYTE_ORDER_MARK;
use ademan::files;
use ademan::hand::Finger;
use ademan::layout::Layout;
use ademan::message::{escape, escape_path};
use ademan::setup::LoadedSetup;
use ademan::sim::{HandAction, taps_for_text};
use ademan_text::model::alphabet::plain;
use clap::ValueEnum;

use super::Args;
use crate::demo::text::{self, TextChoice};
use crate::failure::Failure;

/// The longest lesson, in characters.
const MAX_CHARACTERS: usize = 1000;

/// The longest file of a lesson, in bytes.
const MAX_FILE_BYTES: u64 = 1 << 20;

/// Number of repetitions of a chord.
const CHORD_REPETITIONS: usize = 3;

/// Maximum number of chords in a lesson.
const MAX_CHORDS: usize = 30;

const ENGLISH: [&str; 5] = [
    "the hand finds its own way to each key",
    "a calm finger makes few errors",
    "read the whole line first and then type it",
    "lift the finger before the next key",
    "speed comes by itself after a while",
];

/// Texts without accents, which every keymap has.
const SPANISH: [&str; 5] = [
    "la mano aprende sola el camino de cada tecla",
    "un dedo tranquilo comete pocos errores",
    "lee primero la frase entera y luego escribe",
    "levanta el dedo antes de la tecla siguiente",
    "la velocidad llega sola con el tiempo",
];

/// A kind of lesson that comes with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LessonKind {
    /// Short texts in English
    English,
    /// Short texts in Spanish, without accents
    Spanish,
    /// The characters that the layout types by chords, few fingers first
    Chords,
    /// Targets to point at and to click on with the pointer of the layout
    Pointing,
}

/// A text to type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lesson {
    /// The name in the history.
    pub name: &'static str,
    pub text: String,
    /// The fingers that type each character, if some characters are chords of bent fingers.
    pub fingers: ChordLegend,
    /// `true` in a lesson of chords, which rates each of them.
    pub rates_chords: bool,
    /// `true` if a text decoder finds the letters of multitap keys from one tap each.
    pub finds_letters: bool,
}

/// The fingers that type each character together.
pub type ChordLegend = BTreeMap<char, Vec<Finger>>;

impl Lesson {
    /// Returns the lesson that the arguments ask for, for the layout of a setup. `number` chooses among the texts of a language.
    pub fn choose(args: &Args, setup: &LoadedSetup, number: usize) -> Result<Self, Failure> {
        let (layout, finds_letters) = (&setup.layout, setup.finds_letters());
        let (name, text) = match (&args.text, &args.file, args.lesson) {
            (Some(text), ..) => ("text", typeable(first_line(text), setup)),
            (None, Some(path), _) => ("file", typeable(read(path)?, setup)),
            (None, None, Some(LessonKind::Chords)) => ("chords", chords(layout)?),
            (None, None, Some(LessonKind::Spanish)) => {
                built_in("spanish", &SPANISH, setup, number)?
            }
            // Pointing has no text.
            (None, None, Some(LessonKind::English | LessonKind::Pointing) | None) => {
                built_in("english", &ENGLISH, setup, number)?
            }
        };
        if text.is_empty() {
            return Err(Failure::wrong_use(
                "nothing to type: the text is empty; give another one with --text or --file",
            ));
        }
        let taps = taps_for_text(&text, layout, finds_letters);
        taps.map_err(|error| {
            let layout_name = escape(&layout.name);
            Failure::wrong_use(if layout.multitaps.keys.is_empty() || finds_letters {
                format!("`{layout_name}` cannot type this text: {error}; `ademan layout show` draws its keys")
            } else {
                let remedy = if ademan::text::finds_letters(layout) {
                    "add `--decoder auto`, with which one tap is a letter, or choose another layout"
                } else {
                    "choose another layout"
                };
                format!("`{layout_name}` types a character with several taps of a key, and practice counts one press for each character; {remedy}")
            })
        })?;
        Ok(Self {
            name,
            fingers: legend(&text, layout),
            text,
            rates_chords: matches!(args.lesson, Some(LessonKind::Chords)),
            finds_letters,
        })
    }
}

/// Returns a text of a language, or characters of the layout if it cannot type any of them.
fn built_in(
    name: &'static str,
    texts: &[&str],
    setup: &LoadedSetup,
    number: usize,
) -> Result<(&'static str, String), Failure> {
    let (layout, finds_letters) = (&setup.layout, setup.finds_letters());
    let can_type = |text: &&&str| taps_for_text(text, layout, finds_letters).is_ok();
    let possible: Vec<&&str> = texts.iter().filter(can_type).collect();
    if possible.is_empty() {
        Ok(("characters", text::choose(TextChoice::Default, layout)?))
    } else {
        Ok((name, possible[number % possible.len()].to_string()))
    }
}

/// Returns a text with plain letters in place of those with accents that the layout cannot type, and without opening marks that it
/// cannot type. Prints a message if it differs.
fn typeable(text: String, setup: &LoadedSetup) -> String {
    let plainer = without_accents(&text, |character| {
        taps_for_text(character, &setup.layout, setup.finds_letters()).is_ok()
    });
    if plainer != text {
        say!("the layout has no keys for letters with accents; the lesson has plain ones");
    }
    plainer
}

/// Does what [`typeable`] does for a layout that `can_type` a character.
fn without_accents(text: &str, can_type: impl Fn(&str) -> bool) -> String {
    let mut plainer = String::with_capacity(text.len());
    for character in text.chars() {
        let own = character.to_string();
        if character.is_ascii() || can_type(&own) {
            plainer.push(character);
        } else if character.is_uppercase() {
            let lower = character.to_lowercase();
            plainer.extend(lower.map(plain).flat_map(char::to_uppercase));
        } else if !matches!(character, '¿' | '¡') {
            plainer.push(plain(character));
        }
    }
    plainer
}

/// Returns the fingers of each character of a text that bent fingers type. Empty if none of them is a chord: the board shows the key of
/// each character then.
fn legend(text: &str, layout: &Layout) -> ChordLegend {
    let fingers_of = |character: char| {
        let strokes = taps_for_text(&character.to_string(), layout, false).ok()?;
        let targets: Vec<TargetId> = match strokes.as_slice() {
            [HandAction::Chord(targets)] => targets.clone(),
            [action] => action.target().into_iter().collect(),
            _ => return None,
        };
        let mut fingers: Vec<Finger> = targets
            .into_iter()
            .filter_map(|target| layout.scene.target(target)?.0.bent_by(target))
            .collect();
        fingers.sort_by_key(|finger| finger.index());
        (!fingers.is_empty()).then_some((character, fingers))
    };
    let legend: ChordLegend = text.chars().filter_map(fingers_of).collect();
    let mut known = legend.values();
    if known.any(|chord| chord.len() > 1) {
        legend
    } else {
        ChordLegend::new()
    }
}

/// Returns the characters that several fingers type together, each three times, few fingers first.
fn chords(layout: &Layout) -> Result<String, Failure> {
    let fingers = |character: char| {
        let strokes = taps_for_text(&character.to_string(), layout, false).ok()?;
        match strokes.as_slice() {
            [HandAction::Chord(fingers)] => Some(fingers.len()),
            _ => None,
        }
    };
    let visible = ('!'..='~').filter_map(|character| Some((fingers(character)?, character)));
    let mut chords: Vec<(usize, char)> = visible.collect();
    if chords.is_empty() {
        return Err(Failure::wrong_use(format!(
            "`{}` has no chords of bent fingers; choose another lesson, or a layout such as `chords-bend`",
            escape(&layout.name)
        )));
    }
    chords.sort_by_key(|(count, _)| *count);
    chords.truncate(MAX_CHORDS);
    let groups = chords
        .iter()
        .map(|(_, character)| character.to_string().repeat(CHORD_REPETITIONS));
    let has_space = taps_for_text(" ", layout, false).is_ok();
    let separator = if has_space { " " } else { "" };
    Ok(groups.collect::<Vec<_>>().join(separator))
}

fn read(path: &Path) -> Result<String, Failure> {
    let cannot_read = |reason: String| {
        let path = escape_path(path);
        Failure::wrong_use(format!("cannot read the text {path}: {reason}"))
    };
    let file = files::open_regular(path).map_err(|error| cannot_read(error.to_string()))?;
    let text = read_up_to(MAX_FILE_BYTES, file).map_err(|error| cannot_read(error.to_string()))?;
    // Editors of Windows write a byte order mark.
    Ok(first_line(text.trim_start_matches(BYTE_ORDER_MARK)))
}

/// Reads a text of which only the first bytes count, at most `limit`. A character that the limit cuts is left out.
fn read_up_to(limit: u64, file: impl Read) -> io::Result<String> {
    let mut bytes = Vec::new();
    file.take(limit).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == limit
        && let Err(error) = std::str::from_utf8(&bytes)
        && error.error_len().is_none()
    {
        bytes.truncate(error.valid_up_to());
    }
    String::from_utf8(bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

/// Returns the beginning of a text as one line, and prints a message if the text is longer.
fn first_line(text: &str) -> String {
    let (line, is_cut) = one_line(text);
    if is_cut {
        say!("the lesson is the first {MAX_CHARACTERS} characters of the text");
    }
    line
}

/// Returns the beginning of a text with single spaces between its words, and `true` if there is more.
fn one_line(text: &str) -> (String, bool) {
    let words: Vec<&str> = text.split_whitespace().collect();
    let line = words.join(" ");
    match line.char_indices().nth(MAX_CHARACTERS) {
        Some((end, _)) => (line[..end].to_owned(), true),
        None => (line, false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan::files::Load;
    use ademan::setup::Setup;

    fn on(layout: &str) -> LoadedSetup {
        let setup = Setup {
            layout: layout.to_owned(),
            ..Setup::default()
        };
        setup.load_files().unwrap()
    }

    #[test]
    fn the_texts_of_both_languages_are_for_every_keyboard_with_letters() {
        for layout in ["qwerty-flat", "spanish-flat", "dvorak-flat", "chords-bend"] {
            let setup = on(layout);
            for (number, text) in ENGLISH.iter().chain(&SPANISH).enumerate() {
                let texts = &[*text];
                let found = built_in("name", texts, &setup, number).unwrap();
                assert_eq!(found, ("name", (*text).to_owned()), "{layout}");
            }
        }
    }

    #[test]
    fn accents_that_a_layout_cannot_type_are_left_out() {
        let us = |text: &str| without_accents(text, |character| character.is_ascii());
        assert_eq!(us("¿El niño comió en Ávila?"), "El nino comio en Avila?");
        assert_eq!(us("日本 €"), "日本 €", "they have no plain letter");
        let spanish = |text: &str| without_accents(text, |character| "ñ¿".contains(character));
        assert_eq!(spanish("¿niño, razón?"), "¿niño, razon?");
    }

    #[test]
    fn a_layout_without_letters_gets_its_own_characters() {
        let (name, text) = built_in("english", &ENGLISH, &on("numpad"), 3).unwrap();
        assert_eq!((name, text.as_str()), ("characters", "3.14159*2-0.5"));
        assert!(built_in("english", &ENGLISH, &on("arrows"), 0).is_err());
    }

    #[test]
    fn chords_of_few_fingers_come_first_and_a_board_of_keys_has_none() {
        let text = chords(&Layout::load("chords-bend").unwrap()).unwrap();
        let groups: Vec<&str> = text.split(' ').collect();
        // Of two fingers, as the comment of the layout file lists them.
        for two in ["iii", "nnn", "sss", "rrr", "hhh"] {
            let place = groups.iter().position(|group| *group == two);
            assert!(place.is_some_and(|place| place < 10), "{two} in {text}");
        }
        let place = groups.iter().position(|group| *group == "qqq").unwrap();
        assert!(place >= 10, "q takes four fingers: {text}");
        assert!(chords(&Layout::load("qwerty-flat").unwrap()).is_err());
    }

    #[test]
    fn the_fingers_of_a_text_are_known_if_some_bend_together() {
        let layout = Layout::load("chords-bend").unwrap();
        let fingers = legend("the X", &layout);
        assert_eq!(fingers[&'t'], [Finger::Middle]);
        assert_eq!(fingers[&'h'], [Finger::Middle, Finger::Ring]);
        assert_eq!(fingers[&' '], [Finger::Thumb]);
        assert!(!fingers.contains_key(&'X'), "Shift is a chord before it");
        let keys = Layout::load("qwerty-flat").unwrap();
        assert!(legend("the X", &keys).is_empty());
    }

    #[test]
    fn a_long_file_may_be_cut_inside_a_character_and_an_invalid_one_is_refused() {
        let read = |limit, bytes: &[u8]| read_up_to(limit, bytes).ok();
        assert_eq!(read(2, "aéb".as_bytes()), Some("a".to_owned()));
        assert_eq!(read(3, "aéb".as_bytes()), Some("aé".to_owned()));
        assert_eq!(read(9, "aéb".as_bytes()), Some("aéb".to_owned()));
        assert_eq!(read(9, b"a\xc3"), None, "it ends in the middle");
        assert_eq!(read(3, b"a\xc3b"), None, "Latin-1");
    }

    #[test]
    fn a_text_becomes_one_line_of_bounded_length() {
        assert_eq!(one_line(" a\tb\r\n\n c "), ("a b c".to_owned(), false));
        let (line, is_cut) = one_line(&"ab ".repeat(2000));
        assert_eq!((line.chars().count(), is_cut), (MAX_CHARACTERS, true));
        let whole = "é".repeat(MAX_CHARACTERS);
        assert_eq!(one_line(&whole), (whole.clone(), false));
    }
}
