//! The setup of a first start: a source, the hand that it measures, a layout that it can use, and the text of the file.

use std::path::{Path, absolute, is_separator};

use super::{DEFAULT_GLOVES, DEFAULT_LUCIDGLOVES, LoadedSetup, Setup, SetupError, of_side};
use crate::capture::protocol::{PositionNoise, lucidgloves};
use crate::capture::{SampleKind, SourceUri};
use ademan_core::document::Document;
use ademan_core::hand::Side;
use ademan_core::layout::{Layout, mirror_layout};

/// The setup in the configuration folder that every run without another one uses.
pub const OWN_SETUP: &str = "setup.ron";

/// The keyboard of a hand whose arm is measured, and the one of fingers that bend anywhere.
const KEYBOARD: &str = "qwerty-flat";
const CHORDS: &str = "chords-bend";

/// The keyboard that starts where the hand is, for cameras.
const WEBCAM: &str = "webcam-qwerty";

/// The layout of a source that measures the movement of the arm only.
const ARM: &str = "arm-6dof";

/// The mirror image of a layout that comes with the program. It is no file yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MirroredLayout {
    /// Name of the layout that is mirrored.
    pub original: &'static str,
    /// Text of the file.
    pub text: String,
}

impl MirroredLayout {
    /// Returns its name, without the ending of a file.
    pub fn name(&self) -> String {
        format!("{}-left", self.original)
    }
}

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
        let candidates = self.candidates();
        for &candidate in candidates {
            let loaded = self.loaded_with(candidate)?;
            if loaded.reach_report(&loaded.layout).is_none() {
                return Ok(candidate);
            }
        }
        Ok(candidates.last().copied().unwrap_or(KEYBOARD))
    }

    /// Returns the mirror image of a layout that precedes the [proposed one](Self::proposed_layout), if the hand reaches its keys: the
    /// layouts for one hand are for a right one.
    pub fn mirrored_layout(&self) -> Result<Option<MirroredLayout>, SetupError> {
        for &candidate in self.candidates() {
            let loaded = self.loaded_with(candidate)?;
            if loaded.reach_report(&loaded.layout).is_none() {
                return Ok(None);
            }
            let text = mirror_layout(&Document::shipped(candidate)?)?;
            let mirrored = Layout::from_document(Document::new(candidate, text.as_str()))?;
            if loaded.reach_report(&mirrored).is_none() {
                return Ok(Some(MirroredLayout {
                    original: candidate,
                    text,
                }));
            }
        }
        Ok(None)
    }

    /// Returns the layouts for the source, in the order in which they are proposed.
    fn candidates(&self) -> &'static [&'static str] {
        let protocol = self.source.as_ref().and_then(SourceUri::protocol);
        let noise = protocol.map(|protocol| protocol.position_noise);
        match protocol.map(|protocol| protocol.sample) {
            Some(SampleKind::Displacement) => &[ARM],
            _ if noise == Some(PositionNoise::Landmarks) => &[WEBCAM, CHORDS],
            _ => &[KEYBOARD, CHORDS],
        }
    }

    fn loaded_with(&self, layout: &str) -> Result<LoadedSetup, SetupError> {
        let setup = Self {
            layout: layout.to_owned(),
            ..self.clone()
        };
        setup.load_files()
    }

    /// Returns the text of a setup file at `path`: source, glove and layout. A file beside it is named without its folder, and one
    /// elsewhere and a source by their whole paths, as the names of a setup start in its folder.
    pub fn first_text(&self, path: &Path) -> String {
        let mut fields = Vec::new();
        let mut whole = self.clone();
        if let Ok(working_folder) = absolute(".") {
            whole.start_sources_in(&working_folder);
        }
        if let Some(source) = &whole.source {
            fields.push(format!("source: {:?}", source.to_string()));
        }
        if let Some(glove) = &self.glove {
            fields.push(format!("glove: {:?}", name_from(path, glove)));
        }
        fields.push(format!("layout: {:?}", name_from(path, &self.layout)));
        let fields: String = fields
            .iter()
            .map(|field| format!("    {field},\n"))
            .collect();
        format!(
            "// Written by the first start. `ademan setup new` shows all fields.\n// It types into other programs with `--output desktop` only.\nSetup(\n{fields})\n"
        )
    }
}

/// Returns the name by which the setup file at `path` finds what `name` means in the working folder.
fn name_from(path: &Path, name: &str) -> String {
    let file = Path::new(name);
    let is_file_name = name.ends_with(".ron");
    let is_name = || !name.contains(is_separator) || Document::shipped(name).is_ok();
    if !is_file_name && is_name() {
        return name.to_owned();
    }
    let is_beside = is_file_name && file.parent() == path.parent();
    if let Some(alone) = file.file_name().filter(|_| is_beside) {
        return alone.to_string_lossy().into_owned();
    }
    let is_there = file.is_file() || Path::new(&format!("{name}.ron")).is_file();
    match absolute(file) {
        Ok(whole) if is_there => whole.to_string_lossy().into_owned(),
        _ => name.to_owned(),
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
    fn a_left_hand_with_an_arm_gets_the_mirror_image_of_the_keyboard() {
        let mirrored = |source: &str, side| {
            let setup = Setup::for_hand(Some(source.parse().unwrap()), side, None);
            setup.mirrored_layout().unwrap()
        };
        let serial = "serial:/dev/ttyUSB0";
        let layout = mirrored(serial, Side::Left).expect("a layout");
        assert_eq!(layout.original, KEYBOARD);
        let text = &layout.text;
        assert!(text.contains("hand: \"left\""), "{text}");
        assert_eq!(mirrored(serial, Side::Right), None);
        let curls = "serial:/dev/ttyUSB0?protocol=lucidgloves";
        assert_eq!(mirrored(curls, Side::Left), None, "it measures no arm");
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
        let layout = folder.path().join("left.ron");
        let beside = Setup {
            layout: layout.to_string_lossy().into_owned(),
            ..setup.clone()
        };
        let text = beside.first_text(&path);
        assert!(text.contains("layout: \"left.ron\""), "{text}");
        assert_eq!(Setup::load(path.to_str().unwrap()).unwrap(), setup);
        let shipped = Setup {
            glove: Some("unam-hc11-left".into()),
            ..setup
        };
        fs::write(&path, shipped.first_text(&path)).unwrap();
        assert_eq!(Setup::load(path.to_str().unwrap()).unwrap(), shipped);
    }

    #[test]
    fn a_file_of_the_working_folder_is_found_from_the_folder_of_the_setup() {
        let path = Path::new("/folder/setup.ron");
        let here = absolute("src/lib.rs").unwrap();
        let here = here.to_str().unwrap();
        for (name, expected) in [
            ("src/lib.rs", here),
            (here, here),
            ("/folder/mine.ron", "mine.ron"),
            ("unam-hc11", "unam-hc11"),
            ("keyboards/arrows", "keyboards/arrows"),
        ] {
            let setup = Setup {
                glove: Some(name.into()),
                layout: name.into(),
                ..Setup::default()
            };
            let text = setup.first_text(path);
            for field in ["glove", "layout"] {
                let line = format!("    {field}: {expected:?},\n");
                assert!(text.contains(&line), "{name}: {text}");
            }
        }
        let setup = Setup {
            source: "file:src/lib.rs?protocol=text-line".parse().ok(),
            ..Setup::default()
        };
        let text = setup.first_text(path);
        let start = format!("    source: \"file:{here}?");
        assert!(text.contains(&start), "{text}");
    }
}
