//! A setup with all files that it names.

use super::{ArmSetup, DEFAULT_ARM, LearnedFile, OtherHand, Setup, SetupError, kind};
use crate::capture::SourceUri;
use crate::sim::LayoutFeed;
use crate::text::{self, Language, Learned};
use ademan_core::command::{ProfileName, TextMode};
use ademan_core::device::Capabilities;
use ademan_core::document::{Document, DocumentError};
use ademan_core::estimate::{
    ChannelMap, Estimator, EstimatorSettings, FusedEstimator, HandEstimator, Smoothing,
};
use ademan_core::hand::{JointAngles, Side};
use ademan_core::kinematics::{ArmModel, half_bent_fingers};
use ademan_core::layout::{Fit, Glove, Layout, Person};
use ademan_core::message::escape;
use ademan_core::names::UnknownName;
use ademan_core::pipeline::{LayoutInstance, MAIN_PROFILE, Pipeline, PipelineSettings};

/// A setup with all files that it names, checked.
#[derive(Clone, Debug)]
pub struct LoadedSetup {
    /// The setup as written.
    pub setup: Setup,
    /// The glove, unless the source needs none.
    pub glove: Option<Glove>,
    /// The layout at the start decides which glove the first hand wears: it is simulated, and the setup names none.
    pub has_glove_of_layout: bool,
    /// The arm.
    pub arm: ArmModel,
    /// The glove and the arm of the other hand.
    pub other_hand: Option<GloveAndArm>,
    /// The person; the default one if the setup names none.
    pub person: Person,
    /// The person who is simulated, whose hand may differ from the hand of the setup.
    pub simulated_person: Person,
    /// The layout that is active at the start.
    pub layout: Layout,
    /// The further layouts, in the order of the setup.
    pub profiles: Vec<Profile>,
    /// The documents of all files, with the kind of each.
    pub(super) documents: Vec<(String, Document)>,
    /// `false` for the setup of a recording, whose names are not paths on this machine.
    pub(super) has_files: bool,
    /// The names of recorded permissions that differ from the permissions in use.
    pub ignored_permissions: Vec<&'static str>,
    estimator: EstimatorSettings,
    pub(super) pipeline: PipelineSettings,
    /// The language of the text decoder; `None` without one.
    pub(super) language: Option<Language>,
    /// Knowledge of the text decoder about the person.
    pub(super) learned: Learned,
    /// The reason why there is no text decoder although the setup asks for one.
    pub text_error: Option<String>,
    /// The changes of the active layout, for the simulated hands of the setup.
    pub layout_feed: LayoutFeed,
}

/// The glove and the arm of a hand.
#[derive(Clone, Debug)]
pub struct GloveAndArm {
    /// The glove, unless the source needs none.
    pub glove: Option<Glove>,
    /// The arm.
    pub arm: ArmModel,
}

/// A layout and its name in the setup.
#[derive(Clone, Debug)]
pub struct Profile {
    /// The name in keys and commands.
    pub name: String,
    /// The layout.
    pub layout: Layout,
    /// The mode of the text decoder, if it differs from the mode of the setup.
    pub text: Option<TextMode>,
}

/// Reads the document of a kind and name.
type ReadDocument<'a> = &'a dyn Fn(&str, &str) -> Result<Document, DocumentError>;

/// Reads files and keeps their documents.
struct Loader<'a> {
    read: ReadDocument<'a>,
    documents: Vec<(String, Document)>,
}

impl Loader<'_> {
    fn document(&mut self, kind: &str, name: &str) -> Result<Document, DocumentError> {
        let document = (self.read)(kind, name)?;
        self.documents.push((kind.into(), document.clone()));
        Ok(document)
    }

    fn layout(&mut self, kind: &str, name: &str, fit: Fit) -> Result<Layout, DocumentError> {
        Layout::for_hands(self.document(kind, name)?, fit)
    }

    fn glove(&mut self, kind: &str, name: Option<&str>) -> Result<Option<Glove>, DocumentError> {
        let document = name.map(|name| self.document(kind, name)).transpose()?;
        document.as_ref().map(Glove::parse).transpose()
    }

    /// Loads a person, the default one without a name.
    fn person(&mut self, name: Option<&str>) -> Result<Person, DocumentError> {
        match name {
            Some(name) => Person::parse(&self.document(kind::PERSON, name)?),
            None => Ok(Person::default()),
        }
    }

    /// Loads an arm of a person and mirrors it for the side of the glove.
    fn arm(
        &mut self,
        kind: &str,
        arm: &ArmSetup,
        person: &Person,
        side: Side,
    ) -> Result<ArmModel, SetupError> {
        match arm {
            ArmSetup::Person => match person.arm(side) {
                Some(person_arm) => {
                    person_arm.map_err(|error| SetupError::Value(error.to_string()))
                }
                None => self.arm_model(kind, DEFAULT_ARM, side),
            },
            ArmSetup::Model(name) => self.arm_model(kind, name, side),
            ArmSetup::Measured { .. } => {
                let bones = arm.bone_lengths()?.expect("the arm is measured");
                ArmModel::anthropometric(side, &bones)
                    .map_err(|error| SetupError::Value(error.to_string()))
            }
        }
    }

    fn arm_model(&mut self, kind: &str, name: &str, side: Side) -> Result<ArmModel, SetupError> {
        Ok(ArmModel::parse(&self.document(kind, name)?)?.for_side(side))
    }

    fn other_hand(
        &mut self,
        other: &OtherHand,
        first_source: Option<&SourceUri>,
        person: &Person,
        first_side: Side,
    ) -> Result<GloveAndArm, SetupError> {
        let side = first_side.opposite();
        // Without a person, the default glove is the left one. If the first glove is a left one too, the check below fails.
        let default_side = person.side.map_or(Side::Left, Side::opposite);
        let name = other.glove_name(first_source, default_side);
        let glove = self.glove(kind::OTHER_GLOVE, name)?;
        if glove.as_ref().is_some_and(|glove| glove.side != side) {
            return Err(SetupError::Value(format!(
                "both gloves are for the {first_side} hand, `other_hand` needs a glove for the {side} hand"
            )));
        }
        let arm = self.arm(kind::OTHER_ARM, &other.arm, person, side)?;
        Ok(GloveAndArm { glove, arm })
    }

    /// Loads the knowledge of the text decoder about the person.
    fn learned(&mut self, setup: &Setup) -> Result<Learned, DocumentError> {
        let name = setup.text.as_ref().and_then(|text| text.learned.as_ref());
        match name {
            Some(name) => Learned::parse(&self.document(kind::LEARNED, name)?),
            None => Ok(Learned::default()),
        }
    }

    fn profiles(&mut self, setup: &Setup, fit: Fit) -> Result<Vec<Profile>, SetupError> {
        setup.check_profile_names()?;
        let mut profiles: Vec<Profile> = Vec::new();
        for profile in &setup.profiles {
            let name = &profile.name;
            profiles.push(Profile {
                name: name.clone(),
                layout: self.layout(&kind::profile(name), &profile.layout, fit)?,
                text: profile.text.map(TextMode::from),
            });
        }
        Ok(profiles)
    }
}

impl LoadedSetup {
    /// Loads all files of a setup with `read`, which gets the kind and the name of each.
    pub(super) fn new(setup: Setup, read: ReadDocument) -> Result<Self, SetupError> {
        let mut loader = Loader {
            read,
            documents: Vec::new(),
        };
        let person = loader.person(setup.person.as_deref())?;
        let glove_name = setup.glove_name(person.side.unwrap_or(Side::Right));
        let glove = loader.glove(kind::GLOVE, glove_name)?;
        let measured = setup.source.as_ref().and_then(SourceUri::hand);
        let side = glove.as_ref().map(|glove| glove.side).or(measured);
        let side = side.or(person.side).unwrap_or(Side::Right);
        setup.check_person(&person, glove.is_some(), side)?;
        let arm = loader.arm(kind::ARM, &setup.arm, &person, side)?;
        let other_hand = match &setup.other_hand {
            Some(other) => Some(loader.other_hand(other, setup.source.as_ref(), &person, side)?),
            None => None,
        };
        let fit = Fit::new(&arm, other_hand.as_ref().map(|hand| &hand.arm))?;
        let layout = loader.layout(kind::LAYOUT, &setup.layout, fit)?;
        if layout.uses_inputs() && setup.has_default_simulated_glove() {
            let setup = setup.with_simulated_inputs(side);
            return Ok(Self {
                has_glove_of_layout: true,
                ..Self::new(setup, read)?
            });
        }
        let mut loaded = Self {
            glove,
            has_glove_of_layout: setup.has_default_simulated_glove(),
            arm,
            other_hand,
            simulated_person: person.clone(),
            person,
            layout,
            profiles: loader.profiles(&setup, fit)?,
            learned: loader.learned(&setup)?,
            documents: loader.documents,
            has_files: true,
            ignored_permissions: Vec::new(),
            estimator: EstimatorSettings {
                smoothing: setup.smoothing_filter()?,
                ..EstimatorSettings::default()
            },
            pipeline: setup.pipeline_settings()?,
            language: None,
            text_error: None,
            layout_feed: LayoutFeed::default(),
            setup,
        };
        loaded.add_text_setup();
        loaded.check_roles()?;
        // The source of the arm limits the first hand too.
        let permissions = loaded.sources().next().map(|(_, combined)| combined);
        loaded.pipeline.permissions = permissions.unwrap_or(loaded.pipeline.permissions);
        loaded.check_parts()?;
        loaded.check_ports()?;
        loaded.check_ranges()?;
        loaded.setup.check_position_filter()?;
        for checked in loaded.layouts() {
            loaded.check_layout(checked)?;
        }
        Ok(loaded)
    }

    /// Checks that the glove of a hand has the ranges that are to be learned.
    fn check_ranges(&self) -> Result<(), SetupError> {
        let has_ranges = || self.gloves().any(|glove| !glove.map.ranges().is_empty());
        if !self.setup.learn_ranges || has_ranges() {
            return Ok(());
        }
        Err(SetupError::Value(
            "`learn_ranges` needs a glove with `range_counts`, from which sensors drift: calibrate the glove with `ademan calibrate`, which writes them, or remove `learn_ranges`".into(),
        ))
    }

    /// Returns the gloves of both hands, the first hand first.
    pub fn gloves(&self) -> impl Iterator<Item = &Glove> {
        let other = self.other_hand.iter().flat_map(|hand| &hand.glove);
        self.glove.iter().chain(other)
    }

    /// Returns all layouts. The first one is active at the start.
    pub fn layouts(&self) -> impl Iterator<Item = &Layout> {
        let further = self.profiles.iter().map(|profile| &profile.layout);
        std::iter::once(&self.layout).chain(further)
    }

    /// Returns the names of the layouts, in the same order.
    pub fn profile_names(&self) -> impl Iterator<Item = &str> {
        let further = self.profiles.iter().map(|profile| profile.name.as_str());
        std::iter::once(MAIN_PROFILE).chain(further)
    }

    /// Returns the file of the first arm; `None` if the arm is made from lengths.
    pub fn arm_document(&self) -> Option<&Document> {
        self.document(kind::ARM)
    }

    /// Returns the first document of a kind.
    fn document(&self, kind: &str) -> Option<&Document> {
        let mut documents = self.documents.iter();
        let (_, document) = documents.find(|(other, _)| other == kind)?;
        Some(document)
    }

    /// Returns the path of the file of a layout, or `None` if it comes with the program or a recording.
    pub fn layout_path<'a>(&self, layout: &'a Layout) -> Option<&'a str> {
        let mut documents = self.documents.iter();
        let (_, document) = documents.find(|(_, document)| document.file == layout.file)?;
        let is_file = self.has_files && document.path.is_some();
        is_file.then_some(layout.file.as_str())
    }

    /// Returns the file with the knowledge of the text decoder; `None` if the setup names none, and for a recording.
    pub fn learned_file(&self) -> Option<LearnedFile> {
        let document = self.document(kind::LEARNED).filter(|_| self.has_files)?;
        Some(LearnedFile::new(&document.file, &document.text))
    }

    /// Returns everything that the layouts can ever emit.
    pub fn required_capabilities(&self) -> Capabilities {
        let mut capabilities = Capabilities::default();
        for layout in self.layouts() {
            capabilities.extend(self.capabilities_of(layout).iter());
        }
        capabilities
    }

    /// Returns everything that a layout, and the text decoder with it, can ever emit.
    pub fn capabilities_of(&self, layout: &Layout) -> Capabilities {
        let mut capabilities = layout.required_capabilities();
        if let Some((setup, _)) = self.setup.text.as_ref().zip(self.language.as_ref()) {
            capabilities.extend(text::capabilities(layout, setup.accents).iter());
        }
        capabilities
    }

    /// Checks that the setup allows the keys of a layout and has the profiles that it names.
    pub fn check_layout(&self, layout: &Layout) -> Result<(), SetupError> {
        let keys = layout.required_capabilities().keys;
        if let Some(code) = keys.into_iter().find(|code| code.is_system_key())
            && !self.setup.allow_system_keys
        {
            return Err(SetupError::Value(format!(
                "{}: the key `{code}` acts on the system; remove it, or set `allow_system_keys: true` in the setup",
                escape(&layout.file)
            )));
        }
        let is_unknown = |name: &&String| self.profile_names().all(|other| other != *name);
        if let Some(name) = layout.profiles.iter().find(is_unknown) {
            let error = UnknownName::new("profile", name, self.profile_names());
            return Err(SetupError::Value(format!(
                "{}: {error}; add it to `profiles` of the setup",
                escape(&layout.file)
            )));
        }
        Ok(())
    }

    /// Returns the reason why a layout that follows the other hand touches nothing with this setup, or `None`.
    pub fn missing_other_hand(&self, layout: &Layout) -> Option<&'static str> {
        if !layout.follows_other_hand() {
            None
        } else if self.other_hand.is_none() {
            Some(
                "`anchor: other` follows the other hand, and the setup has one hand: nothing is touched; set `other_hand`",
            )
        } else if self.glove.is_some() && !self.setup.is_seen_as_needed() {
            Some(
                "`anchor: other` needs a source that measures both hands in one room, and a glove does not: nothing is touched; \
                 use a camera or a headset",
            )
        } else {
            None
        }
    }

    /// Returns the glove file of the first hand, or `None` if its source needs none.
    pub fn glove_document(&self) -> Option<&Document> {
        self.document(kind::GLOVE)
    }

    /// Returns the path of the glove file of the first hand, or `None` if it comes with the program or a recording.
    pub fn glove_path(&self) -> Option<&str> {
        let document = self.glove_document()?;
        let is_file = self.has_files && document.path.is_some();
        is_file.then_some(document.file.as_str())
    }

    /// Returns the run-time instance of the layout of this setup, or of its replacement.
    ///
    /// # Errors
    /// Fails as [`check_layout`](Self::check_layout) does.
    pub fn layout_instance(&self, layout: &Layout) -> Result<LayoutInstance, SetupError> {
        self.profile_instance(0, layout)
    }

    /// Returns the run-time instance of a layout in place of the layout of a profile, by index in the order of
    /// [`layouts`](Self::layouts).
    ///
    /// # Errors
    /// Fails as [`check_layout`](Self::check_layout) does.
    pub fn profile_instance(
        &self,
        profile: usize,
        layout: &Layout,
    ) -> Result<LayoutInstance, SetupError> {
        self.check_layout(layout)?;
        let further = profile
            .checked_sub(1)
            .and_then(|index| self.profiles.get(index));
        Ok(self.instance(layout, further.and_then(|other| other.text)))
    }

    /// Returns a pipeline without readings.
    pub fn pipeline(&self) -> Pipeline {
        let pipeline = Pipeline::new(
            self.estimator(
                self.glove.as_ref(),
                self.setup.source.as_ref(),
                self.setup.arm_source.as_ref(),
            ),
            self.arm.clone(),
            self.instance(&self.layout, None),
            self.pipeline,
        );
        let profiles = self.profiles.iter().map(|profile| {
            let name = ProfileName::from(&profile.name);
            let name = name.expect("the length is checked when the setup is loaded");
            (name, self.instance(&profile.layout, profile.text))
        });
        let pipeline = pipeline.with_profiles(profiles);
        let pipeline = match &self.other_hand {
            Some(GloveAndArm { glove, arm }) => {
                let own = self.setup.other_hand.as_ref();
                let own = own.and_then(|hand| hand.source.as_ref());
                let source = own.or(self.setup.source.as_ref());
                let estimator = self.estimator(glove.as_ref(), source, self.other_arm_source());
                pipeline.with_second_hand(estimator, arm.clone())
            }
            None => pipeline,
        };
        let further_sources = self.sources().skip(1);
        further_sources.fold(pipeline, |pipeline, (_, permissions)| {
            pipeline.with_second_source(permissions)
        })
    }

    /// Returns the estimator of a hand, whose arm may have a source of its own.
    fn estimator(
        &self,
        glove: Option<&Glove>,
        source: Option<&SourceUri>,
        arm_source: Option<&SourceUri>,
    ) -> HandEstimator {
        let rest_pose = glove.map(|glove| glove.rest_pose).unwrap_or_default();
        let settings = |uri| self.estimator_settings(uri, &rest_pose);
        let fingers = Estimator::new(settings(source));
        let fingers = match glove {
            Some(glove) => fingers.with_channels(&glove.map),
            None => fingers,
        };
        let whole = source.filter(|source| source.has_parts());
        match arm_source.or(whole) {
            Some(arm_source) => {
                let arm = Estimator::new(settings(Some(arm_source)));
                FusedEstimator::new(arm, fingers, self.pipeline.stall_timeout).into()
            }
            None => fingers.into(),
        }
    }

    /// Returns the estimator of the first hand, or of its fingers if the arm has a source of its own, with this glove and filter
    /// instead of the setup's.
    pub(crate) fn finger_estimator(
        &self,
        map: Option<&ChannelMap>,
        rest_pose: &JointAngles,
        smoothing: Smoothing,
    ) -> Estimator {
        let fingers = Estimator::new(EstimatorSettings {
            smoothing,
            ..self.estimator_settings(self.setup.source.as_ref(), rest_pose)
        });
        match map {
            Some(map) => fingers.with_channels(map),
            None => fingers,
        }
    }

    /// Returns the filter of the joint angles.
    pub(crate) fn smoothing(&self) -> Smoothing {
        self.estimator.smoothing
    }

    fn estimator_settings(
        &self,
        source: Option<&SourceUri>,
        rest_pose: &JointAngles,
    ) -> EstimatorSettings {
        let rest_pose = if rest_pose.is_empty() {
            half_bent_fingers()
        } else {
            *rest_pose
        };
        EstimatorSettings {
            position_smoothing: self.setup.position_filter(source),
            rest_pose,
            learn_ranges: self.setup.learn_ranges,
            ..self.estimator
        }
    }
}
