//! A setup with all that it names, read and checked.

use ron::ser::PrettyConfig;

use super::{ArmSetup, OtherHand, Setup, SetupError};
use crate::capture::recording::{RecordedSetup, Replay};
use crate::capture::{self, Hc11Format, MergedSource, Source, SourceUri};
use crate::command::ProfileName;
use crate::device::Capabilities;
use crate::document::{Document, DocumentError};
use crate::estimate::{Estimator, EstimatorSettings};
use crate::kinematics::ArmModel;
use crate::layout::{Glove, Layout};
use crate::names::UnknownName;
use crate::pipeline::{
    LayoutInstance, MAIN_PROFILE, Pipeline, PipelineSettings, SourcePermissions,
};

/// What the layout that is in force at first is called.

/// A setup with all that it names, checked.
#[derive(Clone, Debug)]
pub struct LoadedSetup {
    /// The setup.
    pub setup: Setup,
    /// The glove.
    pub glove: Glove,
    /// The arm that wears it.
    pub arm: ArmModel,
    /// The glove and arm of the other hand.
    pub other_hand: Option<GloveAndArm>,
    /// The layout that is in force at first.
    pub layout: Layout,
    /// The further layouts, in the order of the setup.
    pub profiles: Vec<Profile>,
    documents: Vec<(String, Document)>,
    estimator: EstimatorSettings,
    arming: PipelineSettings,
}

/// A glove and the arm that wears it.
#[derive(Clone, Debug)]
pub struct GloveAndArm {
    /// The glove.
    pub glove: Glove,
    /// The arm.
    pub arm: ArmModel,
}

/// A layout and what it is called in its setup.
#[derive(Clone, Debug)]
pub struct Profile {
    /// What keys, gestures and commands call it.
    pub name: String,
    /// The layout.
    pub layout: Layout,
}

/// Gives the document of a kind and name.
type Read<'a> = &'a dyn Fn(&str, &str) -> Result<Document, DocumentError>;

/// What a recording calls the files behind a setup.
mod kind {
    pub const SETTINGS: &str = "settings";
    pub const GLOVE: &str = "glove";
    pub const ARM: &str = "arm";
    pub const OTHER_GLOVE: &str = "other-glove";
    pub const OTHER_ARM: &str = "other-arm";
    pub const LAYOUT: &str = "layout";

    /// That of a further layout.
    pub fn of_profile(name: &str) -> String {
        format!("layout:{name}")
    }
}

/// Reads documents and keeps them.
struct Reader<'a> {
    read: Read<'a>,
    documents: Vec<(String, Document)>,
}

impl Reader<'_> {
    fn read(&mut self, kind: &str, name: &str) -> Result<Document, DocumentError> {
        let document = (self.read)(kind, name)?;
        self.documents.push((kind.into(), document.clone()));
        Ok(document)
    }

    fn layout(&mut self, kind: &str, name: &str) -> Result<Layout, DocumentError> {
        Layout::from_document(self.read(kind, name)?)
    }

    fn worn(
        &mut self,
        (glove_kind, arm_kind): (&str, &str),
        glove: &str,
        hand: &ArmSetup,
    ) -> Result<GloveAndArm, SetupError> {
        let glove = Glove::parse(&self.read(glove_kind, glove)?)?;
        let arm = match hand {
            ArmSetup::Model(name) => {
                ArmModel::parse(&self.read(arm_kind, name)?)?.for_side(glove.side)
            }
            ArmSetup::Measured { .. } => {
                let bones = hand.bones()?.expect("it is measured");
                ArmModel::anthropometric(glove.side, &bones)
                    .map_err(|error| SetupError::Value(error.to_string()))?
            }
        };
        Ok(GloveAndArm { glove, arm })
    }
}

impl LoadedSetup {
    pub(super) fn new(setup: Setup, read: Read) -> Result<Self, SetupError> {
        let mut reader = Reader {
            read,
            documents: Vec::new(),
        };
        let kinds = (kind::GLOVE, kind::ARM);
        let GloveAndArm { glove, arm } = reader.worn(kinds, &setup.glove, &setup.arm)?;
        let other = match &setup.other_hand {
            Some(other) => Some(other_hand(&mut reader, other, &glove)?),
            None => None,
        };
        let layout = reader.layout(kind::LAYOUT, &setup.layout)?;
        let mut profiles: Vec<Profile> = Vec::new();
        for named in &setup.profiles {
            let is_taken = profiles.iter().any(|other| other.name == named.name);
            if ProfileName::from(&named.name).is_err() {
                let message = format!("the profile name `{}` is longer than 64 bytes", named.name);
                return Err(SetupError::Value(message));
            }
            if named.name == MAIN_PROFILE || is_taken {
                let message = format!("there is a profile `{}` already", named.name);
                return Err(SetupError::Value(message));
            }
            profiles.push(Profile {
                name: named.name.clone(),
                layout: reader.layout(&kind::of_profile(&named.name), &named.layout)?,
            });
        }
        let assembly = Self {
            glove,
            arm,
            other_hand: other,
            layout,
            profiles,
            documents: reader.documents,
            estimator: EstimatorSettings {
                smoothing: setup.smoothing()?,
                ..EstimatorSettings::default()
            },
            arming: setup.arming()?,
            setup,
        };
        for layout in assembly.layouts() {
            assembly.check_profiles(layout)?;
            assembly.refuse_system_keys(layout)?;
        }
        Ok(assembly)
    }

    /// All layouts, the one that is in force at first before the others.
    pub fn layouts(&self) -> impl Iterator<Item = &Layout> {
        let further = self.profiles.iter().map(|profile| &profile.layout);
        std::iter::once(&self.layout).chain(further)
    }

    /// What the layouts are called, in the same order.
    pub fn profile_names(&self) -> impl Iterator<Item = &str> {
        let further = self.profiles.iter().map(|profile| profile.name.as_str());
        std::iter::once(MAIN_PROFILE).chain(further)
    }

    /// Everything that the layouts can ever send.
    pub fn required_capabilities(&self) -> Capabilities {
        let mut needs = Capabilities::default();
        for layout in self.layouts() {
            needs.extend(layout.required_capabilities().iter());
        }
        needs
    }

    /// The controls of a layout that is or takes the place of one of this setup's.
    pub fn controls(&self, layout: &Layout) -> Result<LayoutInstance, SetupError> {
        self.check_profiles(layout)?;
        self.refuse_system_keys(layout)?;
        Ok(controls(layout))
    }

    /// A layout may ask for keys that act on the system; that they are pressed is up to the setup.
    fn refuse_system_keys(&self, layout: &Layout) -> Result<(), SetupError> {
        let codes = layout.required_capabilities().keys;
        match codes.into_iter().find(|code| code.is_system_key()) {
            Some(code) if !self.setup.allow_system_keys => Err(SetupError::Value(format!(
                "{}: its key `{code}` acts on the system and not just on one program; take it out, or allow \
                 such keys with `allow_system_keys: true` in the setup",
                layout.file
            ))),
            _ => Ok(()),
        }
    }

    /// Checks that the setup has every profile that a layout names.
    fn check_profiles(&self, layout: &Layout) -> Result<(), SetupError> {
        let is_unknown = |name: &&String| self.profile_names().all(|other| other != *name);
        let Some(name) = layout.profiles.iter().find(is_unknown) else {
            return Ok(());
        };
        let error = UnknownName::new("profile", name, self.profile_names());
        Err(SetupError::Value(format!(
            "{}: {error}; list it under `profiles` of the setup",
            layout.file
        )))
    }

    /// A pipeline that has seen nothing yet.
    pub fn pipeline(&self) -> Pipeline {
        let controls = |layout| {
            self.controls(layout)
                .expect("the profiles were looked up when the setup was assembled")
        };
        let estimator = |glove: &Glove| Estimator::new(self.estimator).with_channels(&glove.map);
        let pipeline = Pipeline::new(
            estimator(&self.glove),
            self.arm.clone(),
            controls(&self.layout),
            self.arming,
        );
        let further = self.profiles.iter().map(|profile| {
            let name = ProfileName::from(&profile.name);
            let name = name.expect("the length is checked when the setup is loaded");
            (name, controls(&profile.layout))
        });
        let pipeline = pipeline.with_profiles(further);
        let pipeline = match &self.other_hand {
            Some(other) => pipeline.with_second_hand(estimator(&other.glove), other.arm.clone()),
            None => pipeline,
        };
        let further = self.sources().skip(1).map(|(_, rights)| rights);
        further.fold(pipeline, Pipeline::with_second_source)
    }

    /// The sources of the setup and what each may do: the first, then that of the other hand where it has one.
    pub fn sources(&self) -> impl Iterator<Item = (Option<&SourceUri>, SourcePermissions)> {
        let setup = &self.setup;
        let first = (setup.source.as_ref(), setup.role);
        let other = setup.other_hand.as_ref();
        let other = other.filter(|hand| hand.source.is_some());
        let other = other.map(|hand| (hand.source.as_ref(), hand.role));
        let sources = std::iter::once(first).chain(other);
        sources.map(|(source, role)| (source, setup.rights(source, role)))
    }

    /// Opens a source, and that of the other hand where the setup names one.
    pub fn open_source(&self, source: &SourceUri) -> Result<Box<dyn Source>, SetupError> {
        let first = self.open_one(source)?;
        let other = self.setup.other_hand.as_ref();
        let (Some(name), Some(worn)) = (
            other.and_then(|hand| hand.source.as_ref()),
            &self.other_hand,
        ) else {
            return Ok(first);
        };
        let other = self.open_one(name)?;
        let hands = [(self.glove.side, first), (worn.glove.side, other)];
        Ok(Box::new(MergedSource::start(hands)?))
    }

    fn open_one(&self, source: &SourceUri) -> Result<Box<dyn Source>, SetupError> {
        match source {
            SourceUri::Recording { path } => Ok(Box::new(Replay::open(path)?)),
            SourceUri::Typist { text } => Ok(Box::new(self.typist(
                text,
                &Hc11Format::default(),
                0.0,
                0,
            )?)),
            SourceUri::Script { script } => Ok(Box::new(self.scripted(
                script,
                &Hc11Format::default(),
                0.0,
                0,
            )?)),
            _ => Ok(capture::open(source)?),
        }
    }

    /// The texts behind this setup: what a recording needs to be replayed as it was.
    pub fn recorded_setup(&self) -> RecordedSetup {
        let setup = ron::ser::to_string_pretty(&self.setup, PrettyConfig::new().struct_names(true))
            .expect("a setup is plain data");
        let settings = RecordedSetup::default().with(kind::SETTINGS, "settings", &setup);
        self.documents
            .iter()
            .fold(settings, |recorded, (kind, document)| {
                recorded.with(kind, &document.file, &document.text)
            })
    }

    /// The setup behind a recording; a glove or a layout that is named goes before the recorded one.
    pub fn from_recording(
        recorded: &RecordedSetup,
        glove: Option<&str>,
        layout: Option<&str>,
    ) -> Result<Self, SetupError> {
        let document = |kind: &str| {
            let entry = recorded.get(kind)?;
            Some(Document::new(entry.name.as_str(), entry.text.as_str()))
        };
        let setup: Setup = match document(kind::SETTINGS) {
            Some(settings) => settings.parse()?,
            None => Setup::default(),
        };
        Self::new(setup, &|kind, name| {
            let given = match kind {
                kind::GLOVE => glove,
                kind::LAYOUT => layout,
                _ => None,
            };
            match (given, document(kind)) {
                (Some(name), _) => Document::open(name),
                (None, Some(document)) => Ok(document),
                (None, None) => Document::open(name),
            }
        })
    }
}

/// The controls of a layout that is alone in its setup.
pub fn controls(layout: &Layout) -> LayoutInstance {
    let (scene, names) = (layout.scene.clone(), layout.target_names());
    LayoutInstance::new(scene, names, layout.devices())
        .with_texts(layout.texts.clone())
        .with_auto_recenter(layout.boards.iter().map(|board| board.auto_recenter))
}

fn other_hand(
    reader: &mut Reader,
    other: &OtherHand,
    first: &Glove,
) -> Result<GloveAndArm, SetupError> {
    let kinds = (kind::OTHER_GLOVE, kind::OTHER_ARM);
    let worn = reader.worn(kinds, &other.glove, &other.arm)?;
    if worn.glove.side == first.side {
        return Err(SetupError::Value(format!(
            "both gloves are for the {} hand, `other_hand` is for the other one",
            first.side
        )));
    }
    Ok(worn)
}
