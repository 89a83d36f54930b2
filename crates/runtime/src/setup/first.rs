//! The setup of a first start: a source, the hand that it measures, a layout that it can use, and the text of the file.

use std::path::Path;

use super::{DEFAULT_GLOVES, DEFAULT_LUCIDGLOVES, Setup, SetupError, of_side};
use crate::capture::protocol::{PositionNoise, lucidgloves};
use crate::capture::{SampleKind, SourceUri};
use ademan_core::hand::Side;

/// The setup in the configuration folder that every run without another one uses.
pub const OWN_SETUP: &str = "setup.ron";

/// The keyboard of a hand whose arm is measured, and the one of fingers that bend anywhere.
const KEYBOARD: &str = "qwerty-flat";
const CHORDS: &str = "chords-bend";

/// The keyboard that starts where the hand is, for cameras.
const WEBCAM: &str = "webcam-qwerty";

/// The layout of a source that measures the movement of the arm only.
const ARM: &str = "arm-6dof";

impl Setup {
    /// Returns the setup of a hand that a source measures, `None` for the simulated hand. A source that needs a glove gets the one that
    /// comes with the program for this side, unless `glove` names another.
    pub fn for_hand(source: Option<SourceUri>, side: Side, glove: Option<String>) -> Self {
        let source = source.map(|source| match source {
            SourceUri::Stream(mut stream) => {
                stream.format = stream.format.for_hand(side);
                SourceUri::Stream(stream)
            }
            other => other,
        });
        let protocol = source.as_ref().and_then(SourceUri::protocol);
        let gloves = if protocol == Some(&lucidgloves::PROTOCOL) {
            DEFAULT_LUCIDGLOVES
        } else {
            DEFAULT_GLOVES
        };
        let needs_glove = source.as_ref().is_none_or(SourceUri::needs_glove);
        let is_other_hand = side == Side::Left && needs_glove;
        Self {
            glove: glove.or_else(|| is_other_hand.then(|| of_side(gloves, side).to_owned())),
            source,
            ..Self::default()
        }
    }

    /// Returns the first layout whose keys the hand of the setup reaches, or the one of fingers that bend.
    pub fn proposed_layout(&self) -> Result<&'static str, SetupError> {
        let protocol = self.source.as_ref().and_then(SourceUri::protocol);
        let noise = protocol.map(|protocol| protocol.position_noise);
        let candidates: &[&'static str] = match protocol.map(|protocol| protocol.sample) {
            Some(SampleKind::Displacement) => &[ARM],
            _ if noise == Some(PositionNoise::Landmarks) => &[WEBCAM, CHORDS],
            _ => &[KEYBOARD, CHORDS],
        };
        for candidate in candidates {
            let setup = Self {
                layout: (*candidate).to_owned(),
                ..self.clone()
            };
            let loaded = setup.load_files()?;
            if loaded.reach_report(&loaded.layout).is_none() {
                return Ok(candidate);
            }
        }
        Ok(candidates.last().copied().unwrap_or(KEYBOARD))
    }

    /// Returns the text of a setup file at `path`: source, glove and layout. A glove file beside it is named without its folder.
    pub fn first_text(&self, path: &Path) -> String {
        let mut fields = Vec::new();
        if let Some(source) = &self.source {
            fields.push(format!("source: {:?}", source.to_string()));
        }
        if let Some(glove) = &self.glove {
            let file = Path::new(glove);
            let is_beside = file.parent() == path.parent() && glove.ends_with(".ron");
            let name = file.file_name().filter(|_| is_beside);
            let name = name.map_or(glove.clone(), |name| name.to_string_lossy().into_owned());
            fields.push(format!("glove: {name:?}"));
        }
        fields.push(format!("layout: {:?}", self.layout));
        let fields: String = fields
            .iter()
            .map(|field| format!("    {field},\n"))
            .collect();
        format!(
            "// Written by the first start. `ademan setup new` shows all fields.\n// It types into other programs with `--output desktop` only.\nSetup(\n{fields})\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_sensor_gets_a_layout_that_it_can_use() {
        let proposal = |source: Option<&str>, side| {
            let source = source.map(|source| source.parse().unwrap());
            let setup = Setup::for_hand(source, side, None);
            setup.proposed_layout().unwrap()
        };
        let serial = Some("serial:/dev/ttyUSB0");
        assert_eq!(proposal(serial, Side::Right), KEYBOARD);
        assert_eq!(proposal(None, Side::Right), KEYBOARD);
        let left = proposal(serial, Side::Left);
        assert_eq!(left, CHORDS, "the board of the right hand is out of reach");
        let curls = Some("serial:/dev/ttyUSB0?protocol=lucidgloves");
        assert_eq!(proposal(curls, Side::Right), CHORDS);
        let webcam = Some("udp:127.0.0.1:9000?protocol=hand-landmarks");
        assert_eq!(proposal(webcam, Side::Right), WEBCAM);
        let head = Some("udp:127.0.0.1:4242?protocol=opentrack");
        assert_eq!(proposal(head, Side::Right), ARM);
    }

    #[test]
    fn the_setup_file_has_the_answers_and_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a \"b\".ron");
        let glove = folder.path().join("mine.ron");
        let setup = Setup {
            source: Some(
                "serial:/dev/ttyUSB0?protocol=lucidgloves&baud=9600"
                    .parse()
                    .unwrap(),
            ),
            glove: Some(glove.to_string_lossy().into_owned()),
            layout: "chords-bend".into(),
            ..Setup::default()
        };
        fs::write(&path, setup.first_text(&path)).unwrap();
        assert!(setup.first_text(&path).contains("glove: \"mine.ron\""));
        assert_eq!(Setup::load(path.to_str().unwrap()).unwrap(), setup);
        let shipped = Setup {
            glove: Some("unam-hc11-left".into()),
            ..setup
        };
        fs::write(&path, shipped.first_text(&path)).unwrap();
        assert_eq!(Setup::load(path.to_str().unwrap()).unwrap(), shipped);
    }
}
