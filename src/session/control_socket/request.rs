//! One line of a client → what it asks for.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};

use crate::names::{UnknownName, named_enum};
use crate::session::Order;

/// The longest line that is read, in bytes without its end: 4 KiB.
pub const MAX_LINE_BYTES: usize = 4096;

named_enum! {
    /// What can be asked for.
    pub enum RequestKind ("request") {
        /// How the run is.
        State = "state",
        /// Let go of everything and let nothing out.
        Pause = "pause",
        /// Go on.
        Resume = "resume",
        /// Read the layout file again.
        Reload = "reload",
        /// Put another layout of the setup in force.
        Profile = "profile",
        /// The one after the one in force.
        NextProfile = "next-profile",
        /// Bring the boards to where the hand is.
        Recentre = "recentre",
        /// Move the boards.
        Nudge = "nudge",
        /// Turn the boards.
        Tilt = "tilt",
        /// Make the boards larger or smaller.
        Scale = "scale",
        /// Write where the boards are into the layout file.
        Save = "save",
        /// Tell from now on what happens.
        Subscribe = "subscribe",
        /// End the run.
        Stop = "stop",
    }
}

named_enum! {
    /// What a request is written with.
    enum Field ("field") {
        Ask = "ask",
        Name = "name",
        X = "x_mm",
        Y = "y_mm",
        Z = "z_mm",
        Degrees = "deg",
        Factor = "factor",
    }
}

/// A request that makes sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Request {
    /// For the run.
    Order(Order),
    /// For whoever reads the layout file.
    Reload,
    /// For whoever looks after the layout in force: larger or smaller boards.
    Scale(f32),
    /// For the same: where the boards are, into the file.
    Save,
    /// For the server itself.
    Subscribe,
    /// For whoever ends the run.
    Stop,
}

impl Request {
    /// Reads a line. `profiles` are the names of the layouts of the setup, in order.
    pub fn parse(line: &[u8], profiles: &[String]) -> Result<Self, String> {
        let text = str::from_utf8(line).map_err(|_| "the line is not UTF-8".to_owned())?;
        let mut written: Written = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let ask = written
            .ask
            .take()
            .ok_or(r#"there is no `ask`: say what to do, such as {"ask":"state"}"#)?;
        let request = match ask
            .parse()
            .map_err(|error: UnknownName| error.to_string())?
        {
            RequestKind::State => Self::Order(Order::State),
            RequestKind::Pause => Self::Order(Order::Pause),
            RequestKind::Resume => Self::Order(Order::Resume),
            RequestKind::Reload => Self::Reload,
            RequestKind::Profile => Self::Order(Order::Profile(written.profile(profiles)?)),
            RequestKind::NextProfile => Self::Order(Order::NextProfile),
            RequestKind::Recentre => Self::Order(Order::Recentre),
            RequestKind::Nudge => {
                let mut axis = |field| written.number(field, -1000.0, 1000.0);
                let millimetres = [axis(Field::X)?, axis(Field::Y)?, axis(Field::Z)?];
                Self::Order(Order::Nudge(millimetres.map(|value| (value * 1e-3) as f32)))
            }
            RequestKind::Tilt => {
                let degrees = written.number(Field::Degrees, -90.0, 90.0)?;
                Self::Order(Order::Tilt(degrees.to_radians() as f32))
            }
            RequestKind::Scale => {
                let factor = written.number(Field::Factor, 0.5, 2.0)?;
                Self::Scale(factor as f32)
            }
            RequestKind::Save => Self::Save,
            RequestKind::Subscribe => Self::Subscribe,
            RequestKind::Stop => Self::Stop,
        };
        match written.rest() {
            Some(field) => Err(format!("`{ask}` takes no `{field}`")),
            None => Ok(request),
        }
    }
}

/// Reads a line as the socket does, and says what is wrong with it. `profiles` are the names of the layouts of
/// the setup, in order. Nothing is asked for.
pub fn validate(line: &[u8], profiles: &[String]) -> Result<(), String> {
    Request::parse(line, profiles).map(drop)
}

/// The fields of a line; those that were used are taken out.
#[derive(Default)]
struct Written {
    ask: Option<String>,
    name: Option<String>,
    numbers: [Option<f64>; Field::COUNT],
}

impl Written {
    fn number(&mut self, field: Field, low: f64, high: f64) -> Result<f64, String> {
        let number = self.numbers[field.index()]
            .take()
            .ok_or_else(|| format!("there is no `{field}`"))?;
        match (low..=high).contains(&number) {
            true => Ok(number),
            false => Err(format!("`{field}` is {low} to {high}, not {number}")),
        }
    }

    fn profile(&mut self, profiles: &[String]) -> Result<u8, String> {
        let name = self.name.take().ok_or("there is no `name`")?;
        let place = profiles.iter().position(|profile| *profile == name);
        place
            .and_then(|place| u8::try_from(place).ok())
            .ok_or_else(|| {
                let names = profiles.iter().map(String::as_str);
                let unknown = UnknownName::new("profile", &name, names);
                match unknown.nearest {
                    Some(_) => unknown.to_string(),
                    None => format!("{unknown}; there is {}", profiles.join(", ")),
                }
            })
    }

    /// A field that nothing asked for.
    fn rest(&self) -> Option<Field> {
        let is_left = |field: &&Field| match field {
            Field::Ask => self.ask.is_some(),
            Field::Name => self.name.is_some(),
            field => self.numbers[field.index()].is_some(),
        };
        Field::ALL.iter().find(is_left).copied()
    }
}

impl<'de> Deserialize<'de> for Written {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(WrittenVisitor)
    }
}

struct WrittenVisitor;

impl<'de> Visitor<'de> for WrittenVisitor {
    type Value = Written;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(r#"an object, such as {"ask":"state"}"#)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Written, A::Error> {
        let mut written = Written::default();
        while let Some(field) = map.next_key::<Field>()? {
            let is_second = match field {
                Field::Ask => written.ask.replace(map.next_value()?).is_some(),
                Field::Name => written.name.replace(map.next_value()?).is_some(),
                field => written.numbers[field.index()]
                    .replace(map.next_value()?)
                    .is_some(),
            };
            if is_second {
                return Err(A::Error::custom(format!("`{field}` is there twice")));
            }
        }
        Ok(written)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Request, String> {
        Request::parse(line.as_bytes(), &["desk".into(), "sofa".into()])
    }

    fn error(line: &str) -> String {
        parse(line).unwrap_err()
    }

    #[test]
    fn every_request_is_read_in_the_units_of_the_engine() {
        for &ask in RequestKind::ALL {
            let fields = match ask {
                RequestKind::Profile => r#","name":"sofa""#,
                RequestKind::Nudge => r#","x_mm":10,"y_mm":0.0,"z_mm":-5"#,
                RequestKind::Tilt => r#","deg":-90"#,
                RequestKind::Scale => r#","factor":1.5"#,
                _ => "",
            };
            let request = parse(&format!(r#"{{"ask":"{ask}"{fields}}}"#));
            match request.unwrap() {
                Request::Order(order) => {
                    let word = format!("{order:?}").to_lowercase();
                    assert!(word.starts_with(&ask.name().replace('-', "")), "{word}");
                }
                Request::Reload => assert_eq!(ask, RequestKind::Reload),
                Request::Scale(factor) => assert_eq!((ask, factor), (RequestKind::Scale, 1.5)),
                Request::Save => assert_eq!(ask, RequestKind::Save),
                Request::Subscribe => assert_eq!(ask, RequestKind::Subscribe),
                Request::Stop => assert_eq!(ask, RequestKind::Stop),
            }
        }
        assert_eq!(
            parse(r#"{"ask":"nudge","z_mm":-5,"x_mm":10,"y_mm":0}"#),
            Ok(Request::Order(Order::Nudge([0.01, 0.0, -0.005])))
        );
        assert_eq!(
            parse(r#"{"name":"sofa","ask":"profile"}"#),
            Ok(Request::Order(Order::Profile(1)))
        );
        let quarter = -std::f32::consts::FRAC_PI_2;
        assert_eq!(
            parse("{\"ask\":\"tilt\",\"deg\":-90}\r"),
            Ok(Request::Order(Order::Tilt(quarter)))
        );
    }

    #[test]
    fn what_is_wrong_is_told_with_the_nearest_name() {
        let table = [
            (
                r#"{"ask":"paus"}"#,
                "unknown request `paus`, did you mean `pause`?",
            ),
            (
                r#"{"aks":"pause"}"#,
                "unknown field `aks`, did you mean `ask`? at line 1 column 6",
            ),
            (
                r#"{"ask":"profile","name":"soffa"}"#,
                "unknown profile `soffa`, did you mean `sofa`?",
            ),
            (
                r#"{"ask":"profile","name":"garden"}"#,
                "unknown profile `garden`; there is desk, sofa",
            ),
            (r#"{"ask":"pause","deg":1}"#, "`pause` takes no `deg`"),
            (r#"{"ask":"save","name":"x"}"#, "`save` takes no `name`"),
            (r#"{"ask":"tilt"}"#, "there is no `deg`"),
            (r#"{"ask":"profile"}"#, "there is no `name`"),
            (
                r#"{"ask":"scale","factor":0}"#,
                "`factor` is 0.5 to 2, not 0",
            ),
            (r#"{"ask":"tilt","deg":1e308}"#, "`deg` is -90 to 90, not 1"),
            (
                r#"{"ask":"tilt","deg":1e999}"#,
                "number out of range at line 1",
            ),
            (
                r#"{"ask":"tilt","deg":"1"}"#,
                "invalid type: string \"1\", expected f64 at line 1",
            ),
            (
                r#"{"ask":"pause","ask":"stop"}"#,
                "`ask` is there twice at line 1",
            ),
            ("{}", "there is no `ask`: say what to do"),
            ("", "EOF while parsing a value"),
            ("[1]", "invalid type: sequence, expected an object, such as"),
            (r#"{"ask":"state"}{"ask":"stop"}"#, "trailing characters"),
        ];
        for (line, expected) in table {
            let error = error(line);
            assert!(error.starts_with(expected), "{line}: {error}");
        }
        assert_eq!(
            Request::parse(b"\xff", &[]),
            Err("the line is not UTF-8".into())
        );
    }

    #[test]
    fn json_that_is_as_deep_as_a_line_is_long_is_refused() {
        for deep in ["[", "{\"ask\":", "{\"deg\":["] {
            let line = deep.repeat(MAX_LINE_BYTES / deep.len());
            error(&line);
        }
    }
}
