//! Setups: sources, gloves, arms, layouts, output and limits, as written in a file and as loaded.

mod body_points;
mod check;
mod first;
mod learned_file;
mod loaded;
mod outputs;
mod person;
mod reach;
mod reach_advice;
mod recorded;
mod schema;
mod simulated;
mod sources;
mod text;
mod token_roles;
mod wearer;
mod without_devices;

pub use first::{MirroredLayout, OWN_SETUP};
pub use learned_file::LearnedFile;
pub use loaded::{GloveAndArm, LoadedSetup, Profile};
pub use outputs::continued_outputs;
pub use reach::{HandReach, ReachReport, TargetOutOfReach};
pub use recorded::ReplaySettings;
pub use schema::{setup_field_tables, setup_json_schema};
pub use simulated::{SIMULATED_HAND, UnpressableControl};
pub use sources::NamedSource;

use std::iter;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::capture::protocol::lucidgloves;
use crate::capture::recording::kind;
use crate::capture::{CaptureError, Haptics, SourceUri};
use crate::files::OpenDocument;
use crate::output::DesktopPart;
use crate::share::ShareTarget;
use crate::sim::TypistError;
use crate::text::{Language, TextModeSchema, TextSetup};
use ademan_core::document::{
    Document, DocumentError, FileKind, Format, Structure, first_error, schema,
};
use ademan_core::hand::Side;
use ademan_core::layout::Layout;
use ademan_core::message::escape_line;
use ademan_core::pipeline::SourceRole;

/// The gloves of a setup that names none, for the right hand and for the left hand.
const DEFAULT_GLOVES: [&str; 2] = ["unam-hc11", "unam-hc11-left"];
/// As [`DEFAULT_GLOVES`], for sources that speak the protocol of LucidGloves.
const DEFAULT_LUCIDGLOVES: [&str; 2] = ["lucidgloves", "lucidgloves-left"];
/// The arm model of a setup that names none.
const DEFAULT_ARM: &str = "unam";

schema! {
    /// A setup as written. Every field has a default.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "Setup", default, deny_unknown_fields)]
    pub struct Setup {
        /// The source of the readings, such as `serial:/dev/ttyUSB0?baud=9600`.
        pub source: Option<SourceUri>,
        /// The events that the source may cause. Default: all, or pointer events if the source is on the network.
        pub role: Option<SourceRole>,
        /// The source of the arm, if the fingers have another one: a camera beside a glove.
        pub arm_source: Option<SourceUri>,
        /// The events that the source of the arm may cause. The hand causes only those that both of its sources may.
        pub arm_role: Option<SourceRole>,
        /// The glove: a shipped name or a path. Default: the glove of the protocol, such as `unam-hc11`, if the source provides channels.
        pub glove: Option<String>,
        /// The person: a shipped name or a path. Sets the side and, unless `arm` names a model or lengths, the arms.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub person: Option<String>,
        /// The arm.
        pub arm: ArmSetup,
        /// The other hand of a setup with two hands.
        pub other_hand: Option<OtherHand>,
        /// The layout that is active at the start: a shipped name or a path.
        pub layout: String,
        /// Further layouts that keys and commands can activate.
        pub profiles: Vec<ProfileSetup>,
        /// The profiles that a run activates when an application gets the focus, on X11 and sway. For other applications it
        /// activates `main`.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub profiles_by_application: Vec<ApplicationProfile>,
        /// The outputs, separated by commas: `transcript`, `desktop`, `uinput`, `none`, …. A file names a transcript without a folder.
        pub output: String,
        /// The part of the desktop in which absolute positions of the pointer are, such as one of several monitors. Default: the
        /// whole desktop.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub desktop_part: Option<DesktopPart>,
        /// Formats and addresses in which the hand is shared with other programs: `web:127.0.0.1:8080`. A recording's are not used.
        pub share: Vec<ShareTarget>,
        /// A run shows an icon with its state and a menu in the tray of the desktop.
        pub tray: bool,
        /// A run shows pauses and losses as notifications of the desktop.
        pub notify: bool,
        /// Feedback to the gloves while a session runs, when a finger touches or presses.
        pub haptics: Haptics,
        /// The text decoder. Without one, and without a mode or keys of a layout for it, keys type what they say, and nothing is spent on it.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub text: Option<TextSetup>,
        /// The filter of the joint angles.
        pub smoothing: SmoothingSetup,
        /// The filter of joint positions, for sources that measure them.
        pub position_smoothing: PositionSmoothingSetup,
        /// The range of a finger sensor may widen while the glove is worn, by at most 15 % at each end of the calibrated one.
        pub learn_ranges: bool,
        /// Time without readings after which everything is released, 20 to 10000 ms, and at least three packet periods of the source
        /// (2 s at most).
        pub stall_timeout_ms: u32,
        /// Output is armed by the first reading. Otherwise it is armed after the hand has been clear of every key.
        pub arm_immediately: bool,
        /// Maximum number of presses per second and source, 1 to 1000. Beyond it everything is released and the session pauses.
        /// Default: 60, or 20 if the source is on the network.
        pub max_presses_per_second: Option<u32>,
        /// Keys that act on the system can be pressed: Meta, PrintScreen, and F1 to F12, Delete and Backspace with Control and Alt.
        pub allow_system_keys: bool,
        /// Keys of the real keyboards that pause the session while all of them are down. An empty list reads no keyboard.
        pub panic_keys: Vec<String>,
    }
}

schema! {
    /// The other hand of a setup with two hands.
    #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "OtherHand", default, deny_unknown_fields)]
    pub struct OtherHand {
        /// The source of its readings. Default: the first source provides both hands.
        pub source: Option<SourceUri>,
        /// The events that its source may cause.
        pub role: Option<SourceRole>,
        /// The source of the arm. Default: the source of the first hand, if it shows both arms.
        pub arm_source: Option<SourceUri>,
        /// The events that the source of the arm may cause.
        pub arm_role: Option<SourceRole>,
        /// The glove: a shipped name or a path. Default: the glove of the protocol, such as `unam-hc11-left`, if the source
        /// provides channels.
        pub glove: Option<String>,
        /// The arm.
        pub arm: ArmSetup,
    }
}

schema! {
    /// A layout and its name in the setup.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "Profile", deny_unknown_fields)]
    pub struct ProfileSetup {
        /// The name. `main` is the layout that is active at the start.
        pub name: String,
        /// The layout: a shipped name or a path.
        pub layout: String,
        /// The changes of the text decoder in this layout. Default: as in the setup, or in the file of the layout.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub text: Option<TextModeSchema>,
    }
}

schema! {
    /// The profile for an application.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "ApplicationProfile", deny_unknown_fields)]
    pub struct ApplicationProfile {
        /// Class or instance of its windows on X11, or its `app_id` on Wayland, in upper or lower case.
        pub application: String,
        /// The name of the profile.
        pub profile: String,
    }
}

impl ApplicationProfile {
    /// Returns `true` if the rule is for an application of this name.
    pub fn matches(&self, name: &str) -> bool {
        self.application.eq_ignore_ascii_case(name)
    }
}

schema! {
    /// An arm.
    #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "Arm", deny_unknown_fields)]
    pub enum ArmSetup {
        /// The arm of the person of the setup; the arm model `unam` if there is none, or no length in its file.
        #[default]
        Person,
        /// An arm model: a shipped name or a path.
        Model(String),
        /// An arm of average proportions.
        Measured {
            /// Wrist crease to the end of the middle finger, 100 to 300 mm.
            hand_length_mm: f64,
            /// Elbow to wrist crease, 100 to 500 mm.
            forearm_length_mm: f64,
        },
    }
}

schema! {
    /// The filter of the joint angles.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "Smoothing", deny_unknown_fields)]
    pub enum SmoothingSetup {
        /// A 1-Euro filter with default settings.
        #[default]
        Default,
        /// None.
        Off,
        /// The recursive averages of the founding system, with its errors corrected.
        RecursiveAverage,
        /// A 1-Euro filter.
        OneEuro {
            /// Cutoff frequency at rest, 0.001 to 10000 Hz.
            min_cutoff_hz: f64,
            /// Increase of the cutoff frequency, 0 to 10000 Hz per rad/s.
            beta: f64,
            /// Cutoff frequency of the speed, 0.001 to 10000 Hz.
            derivative_cutoff_hz: f64,
        },
    }
}

schema! {
    /// The filter of joint positions.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "PositionSmoothing", deny_unknown_fields)]
    pub enum PositionSmoothingSetup {
        /// A 1-Euro filter for landmarks, a faster one for markers, none for motion capture files and headsets.
        #[default]
        Default,
        /// None.
        Off,
        /// A 1-Euro filter.
        OneEuro {
            /// Cutoff frequency at rest, 0.001 to 10000 Hz.
            min_cutoff_hz: f64,
            /// Increase of the cutoff frequency, 0 to 10000 Hz per m/s.
            beta: f64,
            /// Cutoff frequency of the speed, 0.001 to 10000 Hz.
            derivative_cutoff_hz: f64,
        },
    }
}

/// The format of setup files.
const FORMAT: Format = Format {
    name: "Setup",
    remedy: "; `ademan setup new NAME` writes a setup to start from",
    reread: |text| first_error::<Setup>(text),
    structures: || {
        vec![
            Structure::of::<Setup>("Setup"),
            Structure::of::<OtherHand>("other_hand"),
            Structure::of::<ProfileSetup>("profiles"),
            Structure::of::<ApplicationProfile>("profiles_by_application"),
            Structure::of::<DesktopPart>("desktop_part"),
            Structure::of::<TextSetup>("text"),
        ]
    },
};

/// The reason why a setup cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// A file is missing or invalid.
    #[error(transparent)]
    File(#[from] DocumentError),
    /// A value is invalid.
    #[error("{}", escape_line(.0))]
    Value(String),
    /// The source cannot be opened.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// The simulated hand cannot type the text.
    #[error(transparent)]
    Typist(#[from] TypistError),
}

impl SetupError {
    /// Returns the error at the value of the field that the message names first, or at the text in it that the message quotes next.
    fn at_field(self, document: &Document) -> DocumentError {
        let message = self.to_string();
        let mut quoted = message.split('`').skip(1).step_by(2);
        let value = quoted.next().and_then(|field| document.field_value(field));
        match value {
            Some(value) => {
                let part = quoted.next().map(|name| format!("\"{name}\""));
                let start = part.as_deref().and_then(|part| value.rfind(part));
                let at = start.map_or(value, |start| &value[start..]);
                let length = part
                    .filter(|_| start.is_some())
                    .map_or(at.len(), |it| it.len());
                document.error_at(&at[..length], message)
            }
            None => DocumentError::for_file(&document.file, message),
        }
    }
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            source: None,
            role: None,
            arm_source: None,
            arm_role: None,
            glove: None,
            person: None,
            arm: ArmSetup::default(),
            other_hand: None,
            layout: "qwerty-flat".into(),
            profiles: Vec::new(),
            profiles_by_application: Vec::new(),
            output: "transcript".into(),
            desktop_part: None,
            share: Vec::new(),
            tray: false,
            notify: false,
            haptics: Haptics::Off,
            text: None,
            smoothing: SmoothingSetup::Default,
            position_smoothing: PositionSmoothingSetup::Default,
            learn_ranges: false,
            stall_timeout_ms: 200,
            arm_immediately: false,
            max_presses_per_second: None,
            allow_system_keys: false,
            panic_keys: Vec::new(),
        }
    }
}

impl Setup {
    /// Returns the sources that it names.
    pub fn source_uris(&self) -> impl Iterator<Item = &SourceUri> {
        let other = self.other_hand.as_ref();
        let of_other = other.map(|hand| [&hand.source, &hand.arm_source]);
        let own = [&self.source, &self.arm_source];
        own.into_iter()
            .chain(of_other.into_iter().flatten())
            .flatten()
    }

    /// Loads a setup file. Paths in it become relative to the working folder, and transcripts get a new file in the
    /// [`transcript_folder`](crate::files::transcript_folder).
    pub fn load(path: &str) -> Result<Self, SetupError> {
        let document = Document::open_kind(FileKind::Setup, path)?;
        let mut setup: Self = document.parse_as(&FORMAT)?;
        let errors = setup.check().into_iter();
        if let Some(error) = DocumentError::all(errors.map(|error| error.at_field(&document))) {
            return Err(error.into());
        }
        let folder = document.path.as_deref().and_then(Path::parent);
        let folder = folder.unwrap_or(Path::new(""));
        for (kind, name) in setup.file_names() {
            *name = Document::resolve(folder, kind, name)?;
        }
        setup.start_sources_in(folder);
        if let Some(text) = &mut setup.text {
            let model = Some(&mut text.language).filter(|name| Language::is_file(name));
            for name in model.into_iter().chain(&mut text.learned) {
                *name = folder.join(&name).to_string_lossy().into_owned();
            }
        }
        setup.output = outputs::with_new_transcripts(&setup.output)
            .map_err(|error| error.at_field(&document))?;
        Ok(setup)
    }

    /// Loads all files that the setup names.
    pub fn load_files(self) -> Result<LoadedSetup, SetupError> {
        let mut loaded = LoadedSetup::new(self, &|kind, name| {
            if kind == kind::LEARNED {
                return LearnedFile::read(name);
            }
            Document::open_kind(recorded::file_kind(kind), name)
        })?;
        loaded.load_language(text::read_model);
        if let Some(note) = loaded.person_note() {
            tracing::info!("{note}");
        }
        Ok(loaded)
    }

    /// Returns the kinds and names of all files: layouts, gloves, arms and the person.
    fn file_names(&mut self) -> Vec<(FileKind, &mut String)> {
        let profiles = self.profiles.iter_mut();
        let layouts = iter::once(&mut self.layout).chain(profiles.map(|it| &mut it.layout));
        let mut names: Vec<_> = layouts.map(|name| (FileKind::Layout, name)).collect();
        let person = self.person.as_mut().map(|name| (FileKind::Person, name));
        names.extend(person);
        let other = self.other_hand.as_mut();
        let other = other.map(|other| (&mut other.glove, &mut other.arm));
        for (glove, arm) in iter::once((&mut self.glove, &mut self.arm)).chain(other) {
            names.extend(glove.as_mut().map(|name| (FileKind::Glove, name)));
            names.extend(arm.model_name().map(|name| (FileKind::Arm, name)));
        }
        names
    }

    /// Returns the name of the glove file of a first hand of `side`, or `None` if the source needs no glove.
    fn glove_name(&self, side: Side) -> Option<&str> {
        glove_name(&self.glove, self.source.as_ref(), side)
    }

    /// Returns `true` if a simulated hand wears a glove that the setup does not name.
    fn has_default_simulated_glove(&self) -> bool {
        let is_simulated = self.source.is_none() || self.has_simulated_hands();
        let name = self.glove_name(Side::Right);
        is_simulated && self.glove.is_none() && name == Some(DEFAULT_GLOVES[0])
    }

    /// Returns `true` if the source is a simulated person.
    pub fn has_simulated_hands(&self) -> bool {
        let is_simulated =
            |uri: &SourceUri| matches!(uri, SourceUri::Typist { .. } | SourceUri::Script { .. });
        self.source.as_ref().is_some_and(is_simulated)
    }

    /// Returns `true` if the source is a simulated person without a protocol, whose sensors measure what the layout needs.
    fn is_seen_as_needed(&self) -> bool {
        let source = self.source.as_ref();
        self.has_simulated_hands() && source.is_some_and(|it| it.protocol().is_none())
    }

    /// Returns the setup with simulated gloves that have a stick and buttons, the first one for a hand of `side`.
    fn with_simulated_inputs(self, side: Side) -> Self {
        let glove = |worn| Some(of_side(DEFAULT_LUCIDGLOVES, worn).to_owned());
        Self {
            glove: glove(side),
            other_hand: self.other_hand.map(|hand| OtherHand {
                glove: hand.glove.or(glove(side.opposite())),
                ..hand
            }),
            ..self
        }
    }
}

impl OtherHand {
    /// Returns the name of the glove file of a hand of `side`, or `None` if the source needs no glove. `first` is the source of a
    /// hand without one of its own.
    fn glove_name(&self, first: Option<&SourceUri>, side: Side) -> Option<&str> {
        let source = self.source.as_ref().or(first);
        glove_name(&self.glove, source, side)
    }
}

impl ArmSetup {
    fn model_name(&mut self) -> Option<&mut String> {
        match self {
            Self::Model(name) => Some(name),
            Self::Person | Self::Measured { .. } => None,
        }
    }
}

/// Returns the name of the glove of a hand.
fn glove_name<'a>(
    glove: &'a Option<String>,
    source: Option<&SourceUri>,
    side: Side,
) -> Option<&'a str> {
    let protocol = source.and_then(SourceUri::protocol);
    let defaults = if protocol == Some(&lucidgloves::PROTOCOL) {
        DEFAULT_LUCIDGLOVES
    } else {
        DEFAULT_GLOVES
    };
    let needs_glove = source.is_none_or(SourceUri::needs_glove);
    let default = needs_glove.then(|| of_side(defaults, side));
    glove.as_deref().or(default)
}

/// Returns the name of the glove that a simulated hand wears for a layout, if nothing names one.
pub fn simulated_glove(layout: &Layout, side: Side) -> &'static str {
    let gloves = if layout.uses_inputs() {
        DEFAULT_LUCIDGLOVES
    } else {
        DEFAULT_GLOVES
    };
    of_side(gloves, side)
}

fn of_side([right, left]: [&'static str; 2], side: Side) -> &'static str {
    match side {
        Side::Right => right,
        Side::Left => left,
    }
}
