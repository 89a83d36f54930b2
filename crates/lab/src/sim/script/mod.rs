//! Scripts for a simulated hand.
//!
//! Each step is a line, or ends with `;`. A step is one action, or several joined by `&`. A comment begins with `#`.
//! Names with blanks are quoted. Lengths are in millimetres, angles in degrees, times in milliseconds.

mod tokens;

use std::ops::{Range, RangeInclusive};
use std::time::Duration;

use parry3d::math::Vec2;

use super::action::{HandAction, TargetPoint};
use crate::contact::{TargetId, TargetNames};
use crate::document::{Document, DocumentError};
use crate::hand::{BodyAngle, Dof, Finger, Input};
use crate::names::{UnknownName, named_enum};
pub use tokens::{SyntaxError, Token, tokenize};

/// Name of a script in messages that was not read from a file.
const INLINE: &str = "script";
/// Largest coordinate and offset, in mm.
const MAX_LENGTH_MM: f64 = 2_000.0;
/// Longest duration of an action, in ms.
const MAX_TIME_MS: f64 = 600_000.0;
/// Largest joint angle, in degrees.
const MAX_JOINT_DEG: f64 = 360.0;
/// Largest angle of head, foot or knee, in degrees.
const MAX_BODY_DEG: f64 = 150.0;
/// Largest angle of an arc, in degrees.
const MAX_ARC_DEG: f64 = 3_600.0;

named_enum! {
    /// The first word of an action.
    enum Verb ("action") {
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
        Input = "input",
    }
}

/// Syntax of each action.
const SYNTAX: [&str; Verb::COUNT] = [
    "tap NAME [X Y]",
    "press NAME [X Y]",
    "push NAME FRACTION",
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
    "input NAME VALUE",
];

/// A list of actions with their positions in the text.
#[derive(Clone, Debug)]
pub struct Script {
    document: Document,
    actions: Vec<HandAction>,
    spans: Vec<Range<usize>>,
}

impl Script {
    /// Returns `true` for a text that is a script rather than the path of one: it has more than one word, or is an action.
    pub fn is_script(text: &str) -> bool {
        text.contains([' ', '\t', '\n', ';']) || text.parse::<Verb>().is_ok()
    }

    /// Parses a text for targets with these names.
    pub fn from_text(text: &str, names: &TargetNames) -> Result<Self, DocumentError> {
        if text.trim().is_empty() {
            let message = "the script is empty; name a file, or write an action such as `tap NAME`";
            return Err(DocumentError::for_file(INLINE, message));
        }
        Self::parse(Document::new(INLINE, text), names)
    }

    /// Parses a document.
    pub fn parse(document: Document, names: &TargetNames) -> Result<Self, DocumentError> {
        let mut actions = Vec::new();
        let mut spans = Vec::new();
        let located = |error: SyntaxError| {
            DocumentError::at(&document.file, &document.text, error.span, error.message)
        };
        for tokens in tokenize(&document.text).map_err(located)? {
            spans.push(span_of(&tokens));
            actions.push(parse_step(&tokens, names).map_err(located)?);
        }
        if actions.is_empty() {
            let message = "the script has no action; write one such as `tap NAME`";
            return Err(DocumentError::for_file(&document.file, message));
        }
        Ok(Self {
            document,
            actions,
            spans,
        })
    }

    /// Returns the path as the user wrote it; `script` for a script that is not a file.
    pub fn file(&self) -> &str {
        &self.document.file
    }

    /// Returns the actions; at least one.
    pub fn actions(&self) -> &[HandAction] {
        &self.actions
    }

    /// Returns the text.
    pub fn text(&self) -> &str {
        &self.document.text
    }

    /// Iterates over the steps with their actions for targets with other names, or the reason why there is none.
    pub(super) fn actions_for<'a>(
        &'a self,
        names: &'a TargetNames,
    ) -> impl Iterator<Item = (&'a str, Result<HandAction, String>)> {
        let text = &self.document.text;
        self.spans.iter().map(move |span| {
            let step = text.get(span.clone()).unwrap_or_default();
            // The text was parsed before, so that only a name can be unknown.
            let action = tokenize(step).and_then(|tokens| match tokens.first() {
                Some(tokens) => parse_step(tokens, names),
                None => Ok(HandAction::Lift),
            });
            (step, action.map_err(|error| error.message))
        })
    }

    /// Returns the script without the actions on some targets; `None` if no action is left.
    pub(super) fn without(mut self, is_left_out: impl Fn(TargetId) -> bool) -> Option<Self> {
        let is_kept = |action: &HandAction| !action.target().is_some_and(&is_left_out);
        let steps = self.actions.into_iter().zip(self.spans);
        (self.actions, self.spans) = steps.filter(|(action, _)| is_kept(action)).unzip();
        (!self.actions.is_empty()).then_some(self)
    }

    /// Creates an error at an action, given its index in [`actions`](Self::actions).
    pub fn error(&self, action: usize, message: impl std::fmt::Display) -> DocumentError {
        let span = self.spans.get(action).cloned().unwrap_or(0..0);
        DocumentError::at(&self.document.file, &self.document.text, span, message)
    }
}

/// Returns the bytes from the first token to the last.
fn span_of(tokens: &[Token]) -> Range<usize> {
    match tokens {
        [] => 0..0,
        [first, .., last] => first.span.start..last.span.end,
        [only] => only.span.clone(),
    }
}

/// Parses a step: an action, or angles joined by `&`.
fn parse_step(tokens: &[Token], names: &TargetNames) -> Result<HandAction, SyntaxError> {
    let Some(join) = tokens.iter().find(|token| token.is_join()) else {
        return parse_action(tokens, names);
    };
    let mut angles = Vec::new();
    let mut time = None;
    for part in tokens.split(Token::is_join) {
        if part.is_empty() {
            let message = "an action is missing beside this `&`";
            return Err(SyntaxError::new(join.span.clone(), message));
        }
        let HandAction::SetAngles(part_angles, part_time) = parse_action(part, names)? else {
            let message = "only `set`, `bend` and `roll` can be joined by `&`";
            return Err(SyntaxError::new(span_of(part), message));
        };
        angles.extend(part_angles);
        time = time.max(part_time);
    }
    Ok(HandAction::SetAngles(angles, time))
}

fn parse_action(tokens: &[Token], names: &TargetNames) -> Result<HandAction, SyntaxError> {
    let first = &tokens[0];
    let unknown = |error: UnknownName| SyntaxError::new(first.span.clone(), error.to_string());
    let verb: Verb = first.text.parse().map_err(unknown)?;
    let mut arguments = Arguments {
        verb,
        last_span: first.span.clone(),
        rest: tokens[1..].iter(),
    };
    let action = match verb {
        Verb::Tap => HandAction::Tap(arguments.target_point(names)?),
        Verb::Press => HandAction::Press(arguments.target_point(names)?),
        Verb::Push => HandAction::Push(arguments.target(names)?, arguments.fraction()?),
        Verb::Slide => HandAction::Slide(arguments.point2()?, arguments.time()?),
        Verb::Arc => {
            let radians = arguments.degrees(MAX_ARC_DEG)?.to_radians() as f32;
            HandAction::Arc(radians, arguments.time()?)
        }
        Verb::Lift => HandAction::Lift,
        Verb::Wait => HandAction::Wait(milliseconds(arguments.number("MS", 0.0..=MAX_TIME_MS)?)),
        Verb::Set => arguments.angle("JOINT", str::parse)?,
        Verb::Bend => arguments.angle("FINGER", |name| Ok(mcp_flexion(name.parse()?)))?,
        Verb::Roll => {
            let radians = arguments.degrees(MAX_JOINT_DEG)?.to_radians();
            let angles = vec![(Dof::ForearmSupination, radians)];
            HandAction::SetAngles(angles, arguments.time()?)
        }
        Verb::Pinch => HandAction::Pinch(arguments.time()?),
        Verb::Unpinch => HandAction::Unpinch(arguments.time()?),
        Verb::Point => {
            let position = arguments.point2()?.extend(arguments.metres("Z")?);
            HandAction::Point(position, arguments.time()?)
        }
        Verb::Input => {
            let token = arguments.token("NAME")?;
            if let Ok(angle) = token.text.parse::<BodyAngle>() {
                let degrees = arguments.number("DEG", -MAX_BODY_DEG..=MAX_BODY_DEG)?;
                HandAction::SetBody(angle, degrees.to_radians())
            } else {
                let inputs = Input::NAMES.iter().chain(BodyAngle::NAMES).copied();
                let unknown_input = |_: UnknownName| {
                    let error = UnknownName::one_of("input", token.text, inputs);
                    SyntaxError::new(token.span.clone(), error.to_string())
                };
                let input: Input = token.text.parse().map_err(unknown_input)?;
                HandAction::SetInput(input, arguments.number("VALUE", -1.0..=1.0)?)
            }
        }
    };
    arguments.finish()?;
    Ok(action)
}

/// Returns the angle that `bend` sets.
const fn mcp_flexion(finger: Finger) -> Dof {
    match finger {
        Finger::Thumb => Dof::ThumbMcpFlexion,
        Finger::Index => Dof::IndexMcpFlexion,
        Finger::Middle => Dof::MiddleMcpFlexion,
        Finger::Ring => Dof::RingMcpFlexion,
        Finger::Little => Dof::LittleMcpFlexion,
    }
}

/// The tokens of an action after its verb.
struct Arguments<'a> {
    verb: Verb,
    /// Span of the last token that was read.
    last_span: Range<usize>,
    rest: std::slice::Iter<'a, Token<'a>>,
}

impl<'a> Arguments<'a> {
    fn token(&mut self, what: &str) -> Result<&'a Token<'a>, SyntaxError> {
        let Some(token) = self.rest.next() else {
            return Err(self.error(format!("{what} is missing after this")));
        };
        self.last_span = token.span.clone();
        Ok(token)
    }

    /// Creates an error at the last token that was read, with the syntax of the action.
    fn error(&self, message: String) -> SyntaxError {
        let syntax = SYNTAX[self.verb.index()];
        let message = format!("{message}; write `{syntax}`");
        SyntaxError::new(self.last_span.clone(), message)
    }

    fn has_more(&self) -> bool {
        !self.rest.as_slice().is_empty()
    }

    fn target(&mut self, names: &TargetNames) -> Result<TargetId, SyntaxError> {
        let token = self.token("NAME")?;
        names.find(token.text).ok_or_else(|| {
            let unknown = UnknownName::one_of("target", token.text, names.iter());
            SyntaxError::new(token.span.clone(), unknown.to_string())
        })
    }

    fn target_point(&mut self, names: &TargetNames) -> Result<TargetPoint, SyntaxError> {
        let target = self.target(names)?;
        Ok(if self.has_more() {
            TargetPoint {
                target,
                offset: self.point2()?,
            }
        } else {
            TargetPoint::center(target)
        })
    }

    /// Reads the name of an angle, the angle and the duration.
    fn angle(
        &mut self,
        what: &str,
        dof: impl Fn(&str) -> Result<Dof, UnknownName>,
    ) -> Result<HandAction, SyntaxError> {
        let token = self.token(what)?;
        let unknown = |error: UnknownName| SyntaxError::new(token.span.clone(), error.to_string());
        let dof = dof(token.text).map_err(unknown)?;
        let radians = self.degrees(MAX_JOINT_DEG)?.to_radians();
        Ok(HandAction::SetAngles(vec![(dof, radians)], self.time()?))
    }

    fn fraction(&mut self) -> Result<f32, SyntaxError> {
        Ok(self.number("FRACTION", 0.0..=1.0)? as f32)
    }

    fn degrees(&mut self, max: f64) -> Result<f64, SyntaxError> {
        self.number("DEG", -max..=max)
    }

    /// Reads a length in mm; returns metres.
    fn metres(&mut self, what: &str) -> Result<f32, SyntaxError> {
        let range = -MAX_LENGTH_MM..=MAX_LENGTH_MM;
        Ok((self.number(what, range)? * 1e-3) as f32)
    }

    fn point2(&mut self) -> Result<Vec2, SyntaxError> {
        Ok(Vec2::new(self.metres("X")?, self.metres("Y")?))
    }

    /// Reads the optional duration.
    fn time(&mut self) -> Result<Option<Duration>, SyntaxError> {
        if self.has_more() {
            let number = self.number("MS", 0.0..=MAX_TIME_MS)?;
            Ok(Some(milliseconds(number)))
        } else {
            Ok(None)
        }
    }

    fn number(&mut self, what: &str, range: RangeInclusive<f64>) -> Result<f64, SyntaxError> {
        let token = self.token(what)?;
        let number: f64 = token
            .text
            .parse()
            .map_err(|_| self.error(format!("{what} is a number, not `{}`", token.text)))?;
        if range.contains(&number) {
            return Ok(number);
        }
        let (min, max) = range.into_inner();
        Err(self.error(format!("{what} is {min} to {max}, not {number}")))
    }

    /// Checks that no token is left.
    fn finish(&mut self) -> Result<(), SyntaxError> {
        let Some(token) = self.rest.next() else {
            return Ok(());
        };
        self.last_span = token.span.clone();
        Err(self.error(format!("unexpected `{}`", token.text)))
    }
}

fn milliseconds(number: f64) -> Duration {
    Duration::from_secs_f64(number * 1e-3)
}

#[cfg(test)]
mod tests;
