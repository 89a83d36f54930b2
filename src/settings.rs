//! The setup: source, glove, hand, layout and output, as a file names them and as they are used.

use std::path::Path;
use std::time::Duration;

use ron::ser::PrettyConfig;
use serde::{Deserialize, Serialize};

use crate::capture::recording::{RecordedSetup, Replay};
use crate::capture::{self, CaptureError, LineSettings, Source, SourceName};
use crate::estimate::{Estimator, EstimatorSettings, OneEuroSettings, Smoothing};
use crate::kinematics::{ArmModel, BoneLengths};
use crate::lab::{self, TypingHand, Typist, TypistError, TypistSettings};
use crate::layout::{Document, Glove, Key, Layout, LayoutError};
use crate::pipeline::{Arming, Controls, Pipeline};

/// A setup as its file says it; every field has a default that works.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Setup", default, deny_unknown_fields)]
pub struct Setup {
    /// Where readings come from, such as `serial:/dev/ttyUSB0?baud=9600`.
    pub source: Option<SourceName>,
    /// The glove: a shipped name or a file.
    pub glove: String,
    /// The arm that wears it.
    pub hand: Hand,
    /// The layout: a shipped name or a file.
    pub layout: String,
    /// Where events go: `transcript`, `desktop`, `uinput` or `none`.
    pub output: String,
    /// The filter on the angles.
    pub smoothing: SmoothingChoice,
    /// How long readings may stay away before everything is let go, in ms; at least three frames of
    /// the source are allowed in any case.
    pub stall_ms: u32,
    /// Whether the first reading arms, instead of a hand that is seen off all keys.
    pub armed: bool,
}

/// The arm that wears the glove.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Hand {
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

impl Hand {
    /// The bones of an arm that was measured.
    fn bones(&self) -> Result<Option<BoneLengths>, SetupError> {
        let Self::Measured {
            hand_length_mm,
            forearm_length_mm,
        } = self
        else {
            return Ok(None);
        };
        BoneLengths::of(hand_length_mm * 1e-3, forearm_length_mm * 1e-3)
            .map(Some)
            .map_err(SetupError::Value)
    }
}

/// The filter on the angles, as the file says it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum SmoothingChoice {
    /// 1-Euro with our tuning.
    #[default]
    Default,
    /// None.
    Off,
    /// The filters of the thesis that the glove comes from, corrected.
    Thesis,
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
    File(#[from] LayoutError),
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
            glove: "unam-hc11".into(),
            hand: Hand::Model("unam".into()),
            layout: "qwerty-flat".into(),
            output: "transcript".into(),
            smoothing: SmoothingChoice::Default,
            stall_ms: 200,
            armed: false,
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
            .map_err(|error| LayoutError::of_file(&document.file, error))?;
        let folder = Path::new(path).parent().unwrap_or(Path::new(""));
        let seen_from_folder = |name: &mut String| {
            let path = folder.join(&*name);
            if path.is_file() {
                *name = path.display().to_string();
            }
        };
        seen_from_folder(&mut setup.glove);
        seen_from_folder(&mut setup.layout);
        if let Hand::Model(name) = &mut setup.hand {
            seen_from_folder(name);
        }
        Ok(setup)
    }

    /// Whether all numbers make sense.
    fn check(&self) -> Result<(), SetupError> {
        self.smoothing()?;
        self.arming()?;
        self.hand.bones().map(drop)
    }

    /// Reads all files that the setup names.
    pub fn assemble(self) -> Result<Assembly, SetupError> {
        let glove = Document::open(&self.glove)?;
        let arm = match &self.hand {
            Hand::Model(name) => Some(Document::open(name)?),
            Hand::Measured { .. } => None,
        };
        let layout = Document::open(&self.layout)?;
        Assembly::new(self, glove, arm, layout)
    }

    fn smoothing(&self) -> Result<Smoothing, SetupError> {
        let SmoothingChoice::OneEuro {
            min_cutoff_hz,
            beta,
            derivative_cutoff_hz,
        } = self.smoothing
        else {
            return Ok(match self.smoothing {
                SmoothingChoice::Off => Smoothing::Off,
                SmoothingChoice::Thesis => Smoothing::Thesis,
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

    fn arming(&self) -> Result<Arming, SetupError> {
        if !(20..=10_000).contains(&self.stall_ms) {
            let message = format!("`stall_ms` is 20 to 10000, not {}", self.stall_ms);
            return Err(SetupError::Value(message));
        }
        Ok(Arming {
            at_once: self.armed,
            stall: Duration::from_millis(self.stall_ms.into()),
            ..Arming::default()
        })
    }
}

/// The controls of a layout, to be put in the place of others.
pub fn controls(layout: &Layout) -> Controls {
    Controls::new(
        layout.scene.clone(),
        layout.target_names(),
        layout.devices(),
    )
    .with_texts(layout.texts.clone())
}

/// A setup with all that it names, checked.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// The setup.
    pub setup: Setup,
    /// The glove.
    pub glove: Glove,
    /// The arm that wears it.
    pub arm: ArmModel,
    /// The layout.
    pub layout: Layout,
    documents: Vec<(&'static str, Document)>,
    estimator: EstimatorSettings,
    arming: Arming,
}

impl Assembly {
    fn new(
        setup: Setup,
        glove: Document,
        arm: Option<Document>,
        layout: Document,
    ) -> Result<Self, SetupError> {
        let glove_used = Glove::parse(&glove)?;
        let arm_used = match (setup.hand.bones()?, &arm) {
            (Some(bones), _) => ArmModel::anthropometric(glove_used.side, &bones)
                .map_err(|error| SetupError::Value(error.to_string()))?,
            (None, Some(arm)) => ArmModel::parse(arm)?,
            (None, None) => return Err(SetupError::Value("the arm model is missing".into())),
        };
        let estimator = EstimatorSettings {
            smoothing: setup.smoothing()?,
            ..EstimatorSettings::default()
        };
        let arming = setup.arming()?;
        let layout_used = Layout::parse(&layout.text, &layout.file)?;
        let documents = [
            Some((GLOVE, glove)),
            arm.map(|arm| (ARM, arm)),
            Some((LAYOUT, layout)),
        ];
        Ok(Self {
            glove: glove_used,
            arm: arm_used,
            layout: layout_used,
            documents: documents.into_iter().flatten().collect(),
            estimator,
            arming,
            setup,
        })
    }

    /// A pipeline that has seen nothing yet.
    pub fn pipeline(&self) -> Pipeline {
        Pipeline::new(
            Estimator::new(self.glove.map.clone(), self.estimator),
            self.arm.clone(),
            controls(&self.layout),
            self.arming,
        )
    }

    /// A simulated hand that types `text` on this layout with this glove, at the pace of `line`.
    pub fn typist(
        &self,
        text: &str,
        line: &LineSettings,
        noise_counts: f64,
        seed: u64,
    ) -> Result<Typist, SetupError> {
        let settings = TypistSettings {
            name: format!("typist:{text}"),
            frame_period: line.frame_period(),
            noise_counts,
            seed,
        };
        let taps = lab::taps(text, &self.layout.keyboard_bindings());
        let taps = taps.map_err(TypistError::from)?;
        let (scene, arm, map) = (&self.layout.scene, &self.arm, &self.glove.map);
        Typist::new(&settings, &taps, scene, arm, map).map_err(|error| self.named(error))
    }

    /// An error of the typist, with the key's name instead of its number.
    fn named(&self, error: TypistError) -> SetupError {
        match error {
            TypistError::OutOfReach { key, metres } => SetupError::Value(format!(
                "cannot type on {}: key `{}` is {:.0} mm out of reach of the simulated hand; move the board nearer or make it smaller",
                self.layout.file,
                self.layout.key_of(key).map_or("?", |key| &key.front.name),
                metres * 1e3,
            )),
            error => error.into(),
        }
    }

    /// The keys that the simulated hand cannot press, and how far beyond its reach each is, in metres.
    pub fn out_of_reach(&self) -> Vec<(&Key, f64)> {
        let hand = TypingHand::new(&self.arm, &self.glove.map);
        let scene = &self.layout.scene;
        let keys = self.layout.keys.iter();
        keys.filter_map(|key| Some((key, hand.stroke(scene, key.front.target).err()?)))
            .collect()
    }

    /// Opens a source.
    pub fn open(&self, source: &SourceName) -> Result<Box<dyn Source>, SetupError> {
        match source {
            SourceName::Recording { path } => Ok(Box::new(Replay::open(path)?)),
            SourceName::Typist { text } => Ok(Box::new(self.typist(
                text,
                &LineSettings::default(),
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
        let settings = RecordedSetup::default().with(SETTINGS, "settings", &setup);
        self.documents
            .iter()
            .fold(settings, |recorded, (kind, document)| {
                recorded.with(kind, &document.file, &document.text)
            })
    }

    /// The setup behind a recording; a glove or a layout that is named goes before the recorded one.
    pub fn recorded(
        recorded: &RecordedSetup,
        glove: Option<&str>,
        layout: Option<&str>,
    ) -> Result<Self, SetupError> {
        let document = |kind: &str| {
            let entry = recorded.get(kind)?;
            Some(Document::new(entry.name.as_str(), entry.text.as_str()))
        };
        let setup: Setup = match document(SETTINGS) {
            Some(settings) => settings.parse()?,
            None => Setup::default(),
        };
        let named = |kind, given: Option<&str>, name: &str| match (given, document(kind)) {
            (Some(name), _) => Document::open(name),
            (None, Some(document)) => Ok(document),
            (None, None) => Document::open(name),
        };
        let glove = named(GLOVE, glove, &setup.glove)?;
        let layout = named(LAYOUT, layout, &setup.layout)?;
        let arm = match &setup.hand {
            Hand::Model(name) => Some(named(ARM, None, name)?),
            Hand::Measured { .. } => None,
        };
        Self::new(setup, glove, arm, layout)
    }
}

const SETTINGS: &str = "settings";
const GLOVE: &str = "glove";
const ARM: &str = "arm";
const LAYOUT: &str = "layout";
