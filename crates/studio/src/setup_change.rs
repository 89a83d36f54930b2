//! Changes of the setup from the window: each leads to another session in place of the present one.

use ademan_core::document::{Document, FileKind};
use ademan_core::hand::Side;
use ademan_core::layout::{Fit, Layout, Person};
use ademan_runtime::capture::SourceUri;
use ademan_runtime::files::OpenDocument;
use ademan_runtime::output;
use ademan_runtime::setup::{ArmSetup, LoadedSetup, Setup, SetupError};

/// A change of the setup, which the next session has.
#[derive(Clone, Debug, PartialEq)]
pub enum SetupChange {
    /// The layout that is active at the start: a shipped name or a path.
    Layout(String),
    /// The source. `None` for the simulated hand.
    Source(Option<SourceUri>),
    /// The glove: a shipped name or a path. `None` for the glove of the protocol.
    Glove(Option<String>),
    /// The person: a shipped name or a path.
    Person(Option<String>),
    /// The arm model: a shipped name or a path. `None` for the arm of the person.
    Arm(Option<String>),
    /// The outputs, separated by commas.
    Output(String),
    /// All of it: the path of a setup file.
    File(String),
}

impl SetupChange {
    /// Returns `true` if the session after the change of a setup may have another glove.
    pub fn may_change_glove(&self, present: &LoadedSetup) -> bool {
        match self {
            Self::Source(_) | Self::Glove(_) | Self::File(_) => true,
            // The default glove is for the hand of the person.
            Self::Person(name) => {
                let side = name.as_deref().and_then(side_of_person);
                let sides = [side, present.person.side].map(|it| it.unwrap_or(Side::Right));
                let is_default = present.setup.glove.is_none() || present.has_glove_of_layout;
                is_default && sides[0] != sides[1]
            }
            Self::Layout(name) => {
                let used = present.layout.uses_inputs();
                present.has_glove_of_layout && uses_inputs(name, present.layout.fit) == Some(!used)
            }
            Self::Arm(_) | Self::Output(_) => false,
        }
    }

    /// Returns a setup with the change. Roles that were given to the old source do not pass to the next one. Fails as a
    /// setup file does.
    pub fn apply(&self, setup: Setup) -> Result<Setup, SetupError> {
        Ok(match self.clone() {
            Self::Layout(layout) => Setup { layout, ..setup },
            Self::Source(source) => with_source(setup, source),
            Self::Glove(glove) => Setup { glove, ..setup },
            Self::Person(person) => Setup { person, ..setup },
            Self::Arm(model) => Setup {
                arm: model.map_or(ArmSetup::Person, ArmSetup::Model),
                ..setup
            },
            Self::Output(output) => Setup { output, ..setup },
            Self::File(path) => Setup::load(&path)?,
        })
    }

    /// Returns `true` if the session starts paused, because it reaches other programs through outputs that were chosen just now.
    pub fn needs_resume(&self, next: &Setup) -> bool {
        let is_output_chosen = matches!(self, Self::Output(_) | Self::File(_));
        is_output_chosen && output::has_effect(&next.output)
    }
}

/// Returns the hand of a person by the name of the file; `None` if the file has none, or cannot be read, which its load reports.
fn side_of_person(name: &str) -> Option<Side> {
    let document = Document::open_kind(FileKind::Person, name).ok()?;
    Person::parse(&document).ok()?.side
}

/// Returns `true` if a layout uses inputs of a glove; `None` if it cannot be used, which its load reports.
fn uses_inputs(name: &str, fit: Fit) -> Option<bool> {
    let document = Document::open_kind(FileKind::Layout, name).ok()?;
    let layout = Layout::for_hands(document, fit).ok()?;
    Some(layout.uses_inputs())
}

fn with_source(setup: Setup, source: Option<SourceUri>) -> Setup {
    let is_simulated = source.is_none();
    let setup = Setup {
        source,
        role: None,
        ..setup
    };
    if !is_simulated {
        return setup;
    }
    // The simulated hand is the only source.
    Setup {
        arm_source: None,
        arm_role: None,
        other_hand: setup.other_hand.map(|mut hand| {
            (hand.source, hand.role) = (None, None);
            (hand.arm_source, hand.arm_role) = (None, None);
            hand
        }),
        ..setup
    }
}

#[cfg(test)]
mod tests {
    use ademan_core::pipeline::SourceRole;
    use ademan_runtime::setup::OtherHand;

    use super::*;

    fn uri(text: &str) -> Option<SourceUri> {
        Some(text.parse().expect("a source"))
    }

    #[test]
    fn another_source_has_no_role_of_the_one_before() {
        let setup = Setup {
            source: uri("serial:/dev/ttyUSB7"),
            role: Some(SourceRole::Both),
            arm_source: uri("udp:127.0.0.1:9000"),
            ..Setup::default()
        };
        let change = SetupChange::Source(uri("ws:127.0.0.1:9001"));
        let next = change.apply(setup.clone()).expect("a setup");
        assert_eq!(next.source, uri("ws:127.0.0.1:9001"));
        assert_eq!(next.role, None);
        assert_eq!(next.arm_source, setup.arm_source);
    }

    #[test]
    fn the_simulated_hand_is_the_only_source() {
        let setup = Setup {
            source: uri("serial:/dev/ttyUSB7"),
            arm_source: uri("udp:127.0.0.1:9000"),
            other_hand: Some(OtherHand {
                source: uri("serial:/dev/ttyUSB8"),
                ..OtherHand::default()
            }),
            ..Setup::default()
        };
        let next = SetupChange::Source(None).apply(setup).expect("a setup");
        assert_eq!(next.source_uris().count(), 0);
        assert!(next.other_hand.is_some());
    }

    #[test]
    fn a_person_with_the_other_hand_brings_another_default_glove() {
        let folder = tempfile::tempdir().expect("a folder");
        let person = |side: &str| {
            let path = folder.path().join(format!("{side}.ron"));
            std::fs::write(&path, format!("Person(side: \"{side}\")")).expect("a file");
            SetupChange::Person(path.to_str().map(str::to_owned))
        };
        let load = |glove: Option<&str>| {
            let setup = Setup {
                source: uri("typist:hello"),
                glove: glove.map(str::to_owned),
                ..Setup::default()
            };
            setup.load_files().expect("the shipped files")
        };
        assert!(person("left").may_change_glove(&load(None)));
        assert!(!person("right").may_change_glove(&load(None)));
        assert!(!person("left").may_change_glove(&load(Some("unam-hc11"))));
    }

    #[test]
    fn a_layout_with_inputs_brings_another_simulated_glove() {
        let load = |layout: &str, glove: Option<&str>| {
            let setup = Setup {
                layout: layout.to_owned(),
                glove: glove.map(str::to_owned),
                ..Setup::default()
            };
            setup.load_files().expect("the shipped files")
        };
        let change = |layout: &str| SetupChange::Layout(layout.to_owned());
        let (plain, inputs) = ("numpad", "lucidgloves-controller");
        for (from, to, expected) in [
            (plain, inputs, true),
            (inputs, plain, true),
            (plain, "arrows", false),
            (inputs, inputs, false),
            (plain, "no-such-layout", false),
        ] {
            let may_change = change(to).may_change_glove(&load(from, None));
            assert_eq!(may_change, expected, "{from} {to}");
        }
        let named = load(plain, Some("lucidgloves"));
        assert!(!change(inputs).may_change_glove(&named));
        let left = SetupChange::Person(Some("left-small".to_owned()));
        assert!(left.may_change_glove(&load(inputs, None)));
    }

    #[test]
    fn only_outputs_that_were_chosen_wait_for_the_person() {
        let typing = Setup {
            output: "desktop".to_owned(),
            ..Setup::default()
        };
        let output = |names: &str| SetupChange::Output(names.to_owned());
        for (change, next, is_paused) in [
            (output("desktop"), typing.clone(), true),
            (
                SetupChange::File("mine.ron".to_owned()),
                typing.clone(),
                true,
            ),
            (SetupChange::Glove(None), typing, false),
            (output("transcript"), Setup::default(), false),
        ] {
            assert_eq!(change.needs_resume(&next), is_paused, "{change:?}");
        }
    }

    #[test]
    fn each_other_change_replaces_one_part() {
        let name = || "mine".to_owned();
        for (change, expected) in [
            (
                SetupChange::Layout(name()),
                Setup {
                    layout: name(),
                    ..Setup::default()
                },
            ),
            (
                SetupChange::Glove(Some(name())),
                Setup {
                    glove: Some(name()),
                    ..Setup::default()
                },
            ),
            (
                SetupChange::Person(Some(name())),
                Setup {
                    person: Some(name()),
                    ..Setup::default()
                },
            ),
            (
                SetupChange::Arm(Some(name())),
                Setup {
                    arm: ArmSetup::Model(name()),
                    ..Setup::default()
                },
            ),
            (
                SetupChange::Output("none".to_owned()),
                Setup {
                    output: "none".to_owned(),
                    ..Setup::default()
                },
            ),
        ] {
            let next = change.apply(Setup::default()).expect("a setup");
            assert_eq!(next, expected, "{change:?}");
        }
        let missing = SetupChange::File("no/such/setup.ron".to_owned());
        assert!(missing.apply(Setup::default()).is_err());
    }
}
