//! Scripts: what a simulated hand is to do, as people write it.
//!
//! One order on each line, or several with `;` between them; from `#` on it is a comment. Names with
//! blanks stand in quotes. Lengths are in millimetres, angles in degrees, times in milliseconds.

mod tokens;

use std::ops::{Range, RangeInclusive};
use std::path::Path;
use std::time::Duration;

use parry3d::math::Vec2;

use super::action::{HandAction, TargetPoint};
use crate::contact::{TargetId, TargetNames};
use crate::document::{Document, DocumentError};
use crate::hand::{Dof, Finger};
use crate::names::{UnknownName, named_enum};
use tokens::{Token, tokenize};

/// What a script is called in messages that was not read from a file.
const INLINE: &str = "script";
/// The furthest that a place can be from another one, in mm.
const FAR_MM: f64 = 2_000.0;
/// The longest that one order takes, in ms.
const LONG_MS: f64 = 600_000.0;
/// The largest angle of a joint, in degrees.
const JOINT_DEG: f64 = 360.0;
/// The longest way around a target, in degrees.
const ROUND_DEG: f64 = 3_600.0;

named_enum! {
    /// The first word of an order.
    enum Verb ("order") {
        Tap = "tap",
        Press = "press",
        Push = "push",
        Slide = "slide",
        Arc = "arc",
        Lift = "lift",
        Wait = "wait",
        Set = "set",
        Bend = "bend",
        Roll = "roll",
        Pinch = "pinch",
        Unpinch = "unpinch",
        Point = "point",
    }
}

/// How each order is written.
const FORMS: [&str; Verb::COUNT] = [
    "tap NAME [X Y]",
    "press NAME [X Y]",
    "push NAME SHARE",
    "slide X Y [MS]",
    "arc DEG [MS]",
    "lift",
    "wait MS",
    "set JOINT DEG [MS]",
    "bend FINGER DEG [MS]",
    "roll DEG [MS]",
    "pinch [MS]",
    "unpinch [MS]",
    "point X Y Z [MS]",
];

/// Orders, and where each stands in its text.
#[derive(Clone, Debug)]
pub struct Script {
    document: Document,
    orders: Vec<HandAction>,
    places: Vec<Range<usize>>,
}

impl Script {
    /// Reads a script for targets with these names: the file at a path, or the script itself.
    ///
    /// It is a file where there is one. Otherwise it is taken for a script when it has more than one word
    /// or is an order, and for a file that is missing when not.
    pub fn open(path_or_text: &str, names: &TargetNames) -> Result<Self, DocumentError> {
        let is_order = path_or_text.parse::<Verb>().is_ok();
        let has_words = path_or_text.contains([' ', '\t', '\n', ';']);
        let is_text = is_order || has_words;
        match is_text && !Path::new(path_or_text).is_file() {
            true => Self::parse(Document::new(INLINE, path_or_text), names),
            false => Self::parse(Document::from_path(path_or_text)?, names),
        }
    }

    /// Reads the script in a document.
    pub fn parse(document: Document, names: &TargetNames) -> Result<Self, DocumentError> {
        let mut orders = Vec::new();
        let mut places = Vec::new();
        let wrong = |(place, message): ScriptError| {
            DocumentError::at(&document.file, &document.text, place, message)
        };
        for words in tokenize(&document.text).map_err(wrong)? {
            let (first, last) = (&words[0], &words[words.len() - 1]);
            places.push(first.span.start..last.span.end);
            orders.push(order(&words, names).map_err(wrong)?);
        }
        if orders.is_empty() {
            let message = "there is no order in the script: write one such as `tap NAME`";
            return Err(DocumentError::for_file(&document.file, message));
        }
        Ok(Self {
            document,
            orders,
            places,
        })
    }

    /// The file that it comes from, as its user named it; `script` for one that is no file.
    pub fn file(&self) -> &str {
        &self.document.file
    }

    /// The orders; at least one.
    pub fn actions(&self) -> &[HandAction] {
        &self.orders
    }

    /// An error at an order, by its place in [`orders`](Self::orders).
    pub fn error(&self, order: usize, message: impl std::fmt::Display) -> DocumentError {
        let place = self.places.get(order).cloned().unwrap_or(0..0);
        DocumentError::at(&self.document.file, &self.document.text, place, message)
    }
}

/// Where something is wrong, and what.
type ScriptError = (Range<usize>, String);

/// The order that these words make; those that are joined by `&` are one.
fn order(words: &[Token], names: &TargetNames) -> Result<HandAction, ScriptError> {
    if !words.iter().any(Token::is_join) {
        return single(words, names);
    }
    let mut angles = Vec::new();
    let mut time = None;
    for part in words.split(Token::is_join) {
        let (Some(first), Some(last)) = (part.first(), part.last()) else {
            let join = words.iter().find(|word| word.is_join());
            let place = join.map_or(0..0, |join| join.span.clone());
            return Err((place, "an order is missing beside this `&`".into()));
        };
        let HandAction::SetAngles(turned, takes) = single(part, names)? else {
            let message = "only `set`, `bend` and `roll` can be joined by `&`";
            return Err((first.span.start..last.span.end, message.into()));
        };
        angles.extend(turned);
        time = time.max(takes);
    }
    Ok(HandAction::SetAngles(angles, time))
}

fn single(words: &[Token], names: &TargetNames) -> Result<HandAction, ScriptError> {
    let first = &words[0];
    let verb: Verb = first
        .text
        .parse()
        .map_err(|error: UnknownName| (first.span.clone(), error.to_string()))?;
    let mut words = Arguments {
        verb,
        place: first.span.clone(),
        rest: words[1..].iter(),
    };
    let order = match verb {
        Verb::Tap => HandAction::Tap(words.spot(names)?),
        Verb::Press => HandAction::Press(words.spot(names)?),
        Verb::Push => HandAction::Push(words.target(names)?, words.share()?),
        Verb::Slide => HandAction::Slide(words.metres2()?, words.time()?),
        Verb::Arc => HandAction::Arc(words.degrees(ROUND_DEG)?.to_radians() as f32, words.time()?),
        Verb::Lift => HandAction::Lift,
        Verb::Wait => HandAction::Wait(milliseconds(words.number("MS", 0.0..=LONG_MS)?)),
        Verb::Set => words.turn("JOINT", str::parse)?,
        Verb::Bend => words.turn("FINGER", |name| Ok(knuckle(name.parse()?)))?,
        Verb::Roll => {
            let radians = words.degrees(JOINT_DEG)?.to_radians();
            HandAction::SetAngles(vec![(Dof::ForearmSupination, radians)], words.time()?)
        }
        Verb::Pinch => HandAction::Pinch(words.time()?),
        Verb::Unpinch => HandAction::Unpinch(words.time()?),
        Verb::Point => {
            let place = words.metres2()?.extend(words.metres("Z")?);
            HandAction::Point(place, words.time()?)
        }
    };
    words.end()?;
    Ok(order)
}

/// What bends a finger as a whole.
const fn knuckle(finger: Finger) -> Dof {
    match finger {
        Finger::Thumb => Dof::ThumbMcpFlexion,
        Finger::Index => Dof::IndexMcpFlexion,
        Finger::Middle => Dof::MiddleMcpFlexion,
        Finger::Ring => Dof::RingMcpFlexion,
        Finger::Little => Dof::LittleMcpFlexion,
    }
}

/// The words after the first one of an order.
struct Arguments<'a> {
    verb: Verb,
    /// Where the last word stood that was taken.
    place: Range<usize>,
    rest: std::slice::Iter<'a, Token<'a>>,
}

impl<'a> Arguments<'a> {
    fn word(&mut self, what: &str) -> Result<&'a Token<'a>, ScriptError> {
        let Some(word) = self.rest.next() else {
            return Err(self.wrong(format!("{what} is missing after this")));
        };
        self.place = word.span.clone();
        Ok(word)
    }

    /// A message about the last word that was taken, with how the order is written.
    fn wrong(&self, message: String) -> ScriptError {
        let form = FORMS[self.verb.index()];
        (self.place.clone(), format!("{message}: write `{form}`"))
    }

    fn has_more(&self) -> bool {
        !self.rest.as_slice().is_empty()
    }

    fn target(&mut self, names: &TargetNames) -> Result<TargetId, ScriptError> {
        let word = self.word("NAME")?;
        names.find(word.text).ok_or_else(|| {
            let unknown = UnknownName::new("target", word.text, names.iter());
            (word.span.clone(), unknown.to_string())
        })
    }

    fn spot(&mut self, names: &TargetNames) -> Result<TargetPoint, ScriptError> {
        let target = self.target(names)?;
        Ok(match self.has_more() {
            true => TargetPoint {
                target,
                offset: self.metres2()?,
            },
            false => TargetPoint::center(target),
        })
    }

    /// An angle by its name, and what it comes to.
    fn turn(
        &mut self,
        what: &str,
        dof: impl Fn(&str) -> Result<Dof, UnknownName>,
    ) -> Result<HandAction, ScriptError> {
        let word = self.word(what)?;
        let dof = dof(word.text).map_err(|error| (word.span.clone(), error.to_string()))?;
        let radians = self.degrees(JOINT_DEG)?.to_radians();
        Ok(HandAction::SetAngles(vec![(dof, radians)], self.time()?))
    }

    fn share(&mut self) -> Result<f32, ScriptError> {
        Ok(self.number("SHARE", 0.0..=1.0)? as f32)
    }

    fn degrees(&mut self, most: f64) -> Result<f64, ScriptError> {
        self.number("DEG", -most..=most)
    }

    /// Millimetres, in metres.
    fn metres(&mut self, what: &str) -> Result<f32, ScriptError> {
        Ok((self.number(what, -FAR_MM..=FAR_MM)? * 1e-3) as f32)
    }

    fn metres2(&mut self) -> Result<Vec2, ScriptError> {
        Ok(Vec2::new(self.metres("X")?, self.metres("Y")?))
    }

    /// How long it takes, where that is said.
    fn time(&mut self) -> Result<Option<Duration>, ScriptError> {
        match self.has_more() {
            true => Ok(Some(milliseconds(self.number("MS", 0.0..=LONG_MS)?))),
            false => Ok(None),
        }
    }

    fn number(&mut self, what: &str, range: RangeInclusive<f64>) -> Result<f64, ScriptError> {
        let word = self.word(what)?;
        let number: f64 = word
            .text
            .parse()
            .map_err(|_| self.wrong(format!("{what} is a number, not `{}`", word.text)))?;
        if range.contains(&number) {
            return Ok(number);
        }
        let (low, high) = range.into_inner();
        Err(self.wrong(format!("{what} is {low} to {high}, not {number}")))
    }

    fn end(&mut self) -> Result<(), ScriptError> {
        let Some(word) = self.rest.next() else {
            return Ok(());
        };
        self.place = word.span.clone();
        Err(self.wrong(format!("`{}` is too much", word.text)))
    }
}

fn milliseconds(number: f64) -> Duration {
    Duration::from_secs_f64(number * 1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn script(text: &str) -> Result<Script, String> {
        let names = TargetNames::new(["Q", "Volume up"].map(str::to_owned));
        Script::parse(Document::new("a.txt", text), &names).map_err(|error| error.to_string())
    }

    fn orders(text: &str) -> Vec<HandAction> {
        script(text).unwrap().orders
    }

    #[test]
    fn every_order_is_written_with_its_own_name_first() {
        for (verb, form) in Verb::ALL.iter().zip(FORMS) {
            assert_eq!(form.split(' ').next(), Some(verb.name()));
        }
    }

    #[test]
    fn the_page_about_scripts_has_every_order() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/scripts.md");
        let page = std::fs::read_to_string(page).expect("the page is there");
        for form in FORMS {
            assert!(page.contains(&format!("| `{form}` |")), "{form}");
        }
    }

    #[test]
    fn orders_are_read_in_the_units_of_people() {
        let (q, up) = (TargetId(0), TargetId(1));
        let spot = TargetPoint {
            target: up,
            offset: Vec2::new(0.005, -0.0025),
        };
        let ms = Duration::from_millis;
        assert_eq!(
            orders("tap Q; press 'Volume up' 5 -2.5 # so\npush Q 0.5\nslide 1 2; slide 1 2 300"),
            [
                HandAction::tap(q),
                HandAction::Press(spot),
                HandAction::Push(q, 0.5),
                HandAction::Slide(Vec2::new(1e-3, 2e-3), None),
                HandAction::Slide(Vec2::new(1e-3, 2e-3), Some(ms(300))),
            ]
        );
        assert_eq!(
            orders("arc -180; lift; wait 1.5; pinch; unpinch 50; point 0 -45 -300"),
            [
                HandAction::Arc(-std::f32::consts::PI, None),
                HandAction::Lift,
                HandAction::Wait(Duration::from_micros(1_500)),
                HandAction::Pinch(None),
                HandAction::Unpinch(Some(ms(50))),
                HandAction::Point(Vec2::new(0.0, -0.045).extend(-0.3), None),
            ]
        );
    }

    #[test]
    fn joined_angles_are_one_order_that_takes_the_longest_time() {
        let radians = 30_f64.to_radians();
        let turned = [
            Dof::IndexMcpFlexion,
            Dof::WristFlexion,
            Dof::ForearmSupination,
        ];
        assert_eq!(
            orders("bend index 30 & set wrist-flexion 30 500 &roll 30 200"),
            [HandAction::SetAngles(
                turned.map(|dof| (dof, radians)).to_vec(),
                Some(Duration::from_millis(500))
            )]
        );
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place_and_what_would_be_right() {
        let table = [
            ("tap Q\nteh Q", "a.txt:2:1: unknown order `teh`"),
            (
                "tpa Q",
                "a.txt:1:1: unknown order `tpa`, did you mean `tap`?",
            ),
            (
                "tap Q; tap 'Volume pu'",
                "a.txt:1:12: unknown target `Volume pu`, did you mean `Volume up`?",
            ),
            (
                "push Q",
                "a.txt:1:6: SHARE is missing after this: write `push NAME SHARE`",
            ),
            ("push Q 1.5", "a.txt:1:8: SHARE is 0 to 1, not 1.5"),
            ("wait NaN", "a.txt:1:6: MS is 0 to 600000, not NaN"),
            (
                "slide 1 x",
                "a.txt:1:9: Y is a number, not `x`: write `slide X Y [MS]`",
            ),
            (
                "tap Q 5",
                "a.txt:1:7: Y is missing after this: write `tap NAME [X Y]`",
            ),
            ("lift Q", "a.txt:1:6: `Q` is too much: write `lift`"),
            (
                "set wirst-flexion 5",
                "a.txt:1:5: unknown degree of freedom `wirst-flexion`, did you mean `wrist-flexion`?",
            ),
            ("bend pinky 5", "a.txt:1:6: unknown finger `pinky`"),
            (
                "roll 5 & tap Q",
                "a.txt:1:10: only `set`, `bend` and `roll` can be joined by `&`",
            ),
            ("roll 5 &", "a.txt:1:8: an order is missing beside this `&`"),
            ("tap \"Q", "a.txt:1:5: the name has no closing \""),
            ("# nothing", "a.txt: there is no order in the script"),
        ];
        for (text, message) in table {
            let error = script(text)
                .err()
                .unwrap_or_else(|| panic!("{text} is read"));
            assert!(error.starts_with(message), "{text}: {error}");
        }
    }
}
