//! The setup: source, glove, hand, layout and output, as a file names them and as they are used.

mod loaded;
mod simulated;

pub use loaded::{GloveAndArm, LoadedSetup, Profile, controls};

use std::path::Path;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::capture::{CaptureError, SourceUri};
use crate::document::{Document, DocumentError};
use crate::estimate::{OneEuroSettings, Smoothing};
use crate::kinematics::BoneLengths;
use crate::pipeline::{PipelineSettings, PressRateLimit, SourcePermissions, SourceRole};
use crate::sim::TypistError;

/// A setup as its file says it; every field has a default that works.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Setup", default, deny_unknown_fields)]
pub struct Setup {
    /// Where readings come from, such as `serial:/dev/ttyUSB0?baud=9600`.
    pub source: Option<SourceUri>,
    /// What may come of the source. `None`: both pointer and keys, and of a source on the network just the pointer.
    pub role: Option<SourceRole>,
    /// The glove: a shipped name or a file.
    pub glove: String,
    /// The arm that wears it.
    pub arm: ArmSetup,
    /// The other hand, where two are used.
    pub other_hand: Option<OtherHand>,
    /// The layout: a shipped name or a file.
    pub layout: String,
    /// Further layouts, one of which can take the place of the first while tracking.
    pub profiles: Vec<ProfileSetup>,
    /// Where events go: `transcript`, `desktop`, `uinput`, `none`, or several of them with commas between.
    pub output: String,
    /// The filter on the angles.
    pub smoothing: SmoothingSetup,
    /// How long readings may stay away before everything is let go, in ms; at least three frames of
    /// the source are allowed in any case.
    pub stall_timeout_ms: u32,
    /// Whether the first reading arms, instead of a hand that is seen off all keys.
    pub arm_immediately: bool,
    /// The most presses that may come of one source in a second, 1 to 1000; after more, everything is let go
    /// of and the run pauses. `None`: 60, and 20 for a source on the network.
    pub max_presses_per_second: Option<u32>,
    /// Whether keys that act on the system may be pressed: Meta and PrintScreen, and F1 to F12, Delete and
    /// Backspace with Control and Alt.
    pub allow_system_keys: bool,
    /// Keys of the real keyboards of this machine that pause the run when all of them are down; none: no keyboard
    /// is read. See [`emergency`](crate::emergency).
    pub panic_keys: Vec<String>,
}

/// A second glove and who wears it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "OtherHand", default, deny_unknown_fields)]
pub struct OtherHand {
    /// Where its readings come from; `None` where the first source has both hands.
    pub source: Option<SourceUri>,
    /// What may come of that source, as of the first one.
    pub role: Option<SourceRole>,
    /// The glove: a shipped name or a file.
    pub glove: String,
    /// The arm that wears it.
    pub arm: ArmSetup,
}

impl Default for OtherHand {
    fn default() -> Self {
        Self {
            source: None,
            role: None,
            glove: "unam-hc11-left".into(),
            arm: ArmSetup::Model("unam".into()),
        }
    }
}

/// A layout and what keys, gestures and commands call it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Profile", deny_unknown_fields)]
pub struct ProfileSetup {
    /// What it is called; the layout that is in force at first is called `main`.
    pub name: String,
    /// A shipped name or a file.
    pub layout: String,
}

/// The arm that wears the glove.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ArmSetup {
    /// An arm model: a shipped name or a file.
    Model(String),
    /// An arm of average proportions, from two measures of a person.
    Measured {
        /// Wrist crease to the end of the middle finger, in mm.
        hand_length_mm: f64,
        /// Elbow to wrist crease, in mm.
        forearm_length_mm: f64,
    },
}

impl ArmSetup {
    /// The bones of an arm that was measured.
    fn bones(&self) -> Result<Option<BoneLengths>, SetupError> {
        let Self::Measured {
            hand_length_mm,
            forearm_length_mm,
        } = self
        else {
            return Ok(None);
        };
        BoneLengths::from_hand_and_forearm(hand_length_mm * 1e-3, forearm_length_mm * 1e-3)
            .map(Some)
            .map_err(SetupError::Value)
    }
}

/// The filter on the angles, as the file says it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum SmoothingSetup {
    /// 1-Euro with our tuning.
    #[default]
    Default,
    /// None.
    Off,
    /// The filters of the thesis that the glove comes from, corrected.
    RecursiveAverage,
    /// 1-Euro, tuned by hand.
    OneEuro {
        /// Cutoff at rest, in Hz.
        min_cutoff_hz: f64,
        /// Rise of the cutoff, in Hz per rad/s.
        beta: f64,
        /// Cutoff of the speed, in Hz.
        derivative_cutoff_hz: f64,
    },
}

/// Why a setup cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// A file is not as it should be.
    #[error(transparent)]
    File(#[from] DocumentError),
    /// A number makes no sense.
    #[error("{0}")]
    Value(String),
    /// The source cannot be opened.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// The simulated hand cannot type this.
    #[error(transparent)]
    Typist(#[from] TypistError),
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            source: None,
            role: None,
            glove: "unam-hc11".into(),
            arm: ArmSetup::Model("unam".into()),
            other_hand: None,
            layout: "qwerty-flat".into(),
            profiles: Vec::new(),
            output: "transcript".into(),
            smoothing: SmoothingSetup::Default,
            stall_timeout_ms: 200,
            arm_immediately: false,
            max_presses_per_second: None,
            allow_system_keys: false,
            panic_keys: Vec::new(),
        }
    }
}

impl Setup {
    /// The setup in a file. The files that it names are seen from its folder, where they are there.
    pub fn load(path: &str) -> Result<Self, SetupError> {
        let document = Document::open(path)?;
        let mut setup: Self = document.parse()?;
        setup
            .check()
            .map_err(|error| DocumentError::for_file(&document.file, error))?;
        let folder = Path::new(path).parent().unwrap_or(Path::new(""));
        let seen_from_folder = |name: &mut String| {
            let path = folder.join(&*name);
            if path.is_file() {
                *name = path.display().to_string();
            }
        };
        seen_from_folder(&mut setup.glove);
        seen_from_folder(&mut setup.layout);
        for profile in &mut setup.profiles {
            seen_from_folder(&mut profile.layout);
        }
        if let Some(other) = &mut setup.other_hand {
            seen_from_folder(&mut other.glove);
        }
        let other = setup.other_hand.as_mut().map(|other| &mut other.arm);
        for hand in [Some(&mut setup.arm), other].into_iter().flatten() {
            if let ArmSetup::Model(name) = hand {
                seen_from_folder(name);
            }
        }
        Ok(setup)
    }

    /// Whether all numbers make sense.
    fn check(&self) -> Result<(), SetupError> {
        self.smoothing()?;
        self.arming()?;
        if let Some(other) = &self.other_hand {
            other.arm.bones()?;
        }
        self.arm.bones().map(drop)
    }

    /// Reads all files that the setup names.
    pub fn load_files(self) -> Result<LoadedSetup, SetupError> {
        LoadedSetup::new(self, &|_, name| Document::open(name))
    }

    fn smoothing(&self) -> Result<Smoothing, SetupError> {
        let SmoothingSetup::OneEuro {
            min_cutoff_hz,
            beta,
            derivative_cutoff_hz,
        } = self.smoothing
        else {
            return Ok(match self.smoothing {
                SmoothingSetup::Off => Smoothing::Off,
                SmoothingSetup::RecursiveAverage => Smoothing::RecursiveAverage,
                _ => Smoothing::default(),
            });
        };
        let usable = |cutoff_hz: f64| (1e-3..=1e4).contains(&cutoff_hz);
        if !usable(min_cutoff_hz) || !usable(derivative_cutoff_hz) || !(0.0..=1e4).contains(&beta) {
            let message = "smoothing: cutoffs are 0.001 to 10000 Hz, `beta` is 0 to 10000";
            return Err(SetupError::Value(message.into()));
        }
        Ok(Smoothing::OneEuro(OneEuroSettings {
            min_cutoff_hz,
            beta,
            derivative_cutoff_hz,
        }))
    }

    fn arming(&self) -> Result<PipelineSettings, SetupError> {
        if let Some(other @ (0 | 1001..)) = self.max_presses_per_second {
            let message = format!("`max_presses_per_second` is 1 to 1000, not {other}");
            return Err(SetupError::Value(message));
        }
        if !(20..=10_000).contains(&self.stall_timeout_ms) {
            let message = format!(
                "`stall_timeout_ms` is 20 to 10000, not {}",
                self.stall_timeout_ms
            );
            return Err(SetupError::Value(message));
        }
        if let Some(OtherHand {
            source: None,
            role: Some(_),
            ..
        }) = self.other_hand
        {
            let message = "`role` of `other_hand` is that of its own `source`, and it names none: both hands have the \
                 role of the first source";
            return Err(SetupError::Value(message.into()));
        }
        Ok(PipelineSettings {
            arm_immediately: self.arm_immediately,
            stall_timeout: Duration::from_millis(self.stall_timeout_ms.into()),
            permissions: self.rights(self.source.as_ref(), self.role),
            allow_system_keys: self.allow_system_keys,
            ..PipelineSettings::default()
        })
    }

    /// What a source may do that is given this role, if any.
    fn rights(&self, source: Option<&SourceUri>, role: Option<SourceRole>) -> SourcePermissions {
        let usual = match source {
            Some(source) if source.is_remote() => SourcePermissions::NETWORK,
            _ => SourcePermissions::LOCAL,
        };
        let presses = self.max_presses_per_second;
        SourcePermissions {
            role: role.unwrap_or(usual.role),
            rate_limit: presses
                .map_or(usual.rate_limit, |per_second| PressRateLimit { per_second }),
        }
    }
}
