//! Checks of a setup, and the settings of the stages that follow from it.

use std::ops::RangeInclusive;
use std::time::Duration;

use super::{
    ApplicationProfile, ArmSetup, OtherHand, PositionSmoothingSetup, Setup, SetupError,
    SmoothingSetup,
};
use crate::capture::{PositionNoise, SourceUri};
use crate::text::Language;
use ademan_core::command::ProfileName;
use ademan_core::device::{KeyCode, KeyKind};
use ademan_core::estimate::{LANDMARK_SMOOTHING, MARKER_SMOOTHING, OneEuroSettings, Smoothing};
use ademan_core::kinematics::BoneLengths;
use ademan_core::message::escape;
use ademan_core::names::UnknownName;
use ademan_core::pipeline::{
    MAIN_PROFILE, PipelineSettings, PressRateLimit, SourcePermissions, SourceRole,
};

/// The valid values of `stall_timeout_ms`.
pub(super) const STALL_TIMEOUTS_MS: RangeInclusive<u32> = 20..=10_000;

/// The valid values of `max_presses_per_second`.
pub(super) const PRESSES_PER_SECOND: RangeInclusive<u32> = 1..=1_000;

impl Setup {
    /// Checks all values. Returns the errors.
    pub(super) fn check(&self) -> Vec<SetupError> {
        let other = self.other_hand.as_ref();
        let checks = [
            self.smoothing_filter().map(drop),
            self.check_position_filter(),
            self.check_press_rate(),
            self.check_stall_timeout(),
            self.check_desktop_part(),
            self.check_other_role(),
            self.check_panic_keys(),
            self.check_language(),
            self.check_profile_names(),
            self.check_profiles_by_application(),
            other.map_or(Ok(()), |hand| hand.arm.bone_lengths().map(drop)),
            self.arm.bone_lengths().map(drop),
        ];
        checks.into_iter().filter_map(Result::err).collect()
    }

    fn check_language(&self) -> Result<(), SetupError> {
        let Some(text) = &self.text else {
            return Ok(());
        };
        let checked = Language::check_name(&text.language);
        checked.map_err(|reason| SetupError::Value(format!("`language`: {reason}")))
    }

    /// Checks the names of the panic keys. A session checks that a keyboard has them.
    fn check_panic_keys(&self) -> Result<(), SetupError> {
        for name in &self.panic_keys {
            let message = match name.parse::<KeyCode>() {
                Ok(key) if key.kind() == KeyKind::Keyboard => continue,
                Ok(key) => format!("`panic_keys`: `{key}` is not a key of a keyboard"),
                Err(error) => format!("`panic_keys`: {error}"),
            };
            return Err(SetupError::Value(message));
        }
        Ok(())
    }

    /// Checks that each profile has a name of its own, which a command line and a message can hold.
    pub(super) fn check_profile_names(&self) -> Result<(), SetupError> {
        for (index, profile) in self.profiles.iter().enumerate() {
            let name = &profile.name;
            let mut before = self.profiles[..index].iter();
            let shown = escape(name);
            let reason = if ProfileName::from(name).is_err() {
                format!("the name `{shown}` is longer than 64 bytes")
            } else if name.trim() != name || name.is_empty() || name.contains(char::is_control) {
                format!(
                    "the name `{shown}` is empty, has a blank at an end or a control character; write one such as `media`"
                )
            } else if name == MAIN_PROFILE {
                format!("the name `{shown}` is the name of the first layout; choose another one")
            } else if before.any(|other| other.name == *name) {
                format!("the name `{shown}` is the name of two profiles")
            } else {
                continue;
            };
            return Err(SetupError::Value(format!("`profiles`: {reason}")));
        }
        Ok(())
    }

    /// Checks that the rules name profiles of the setup, and each application once.
    fn check_profiles_by_application(&self) -> Result<(), SetupError> {
        let rules = &self.profiles_by_application;
        let names = || {
            let further = self.profiles.iter().map(|profile| profile.name.as_str());
            std::iter::once(MAIN_PROFILE).chain(further)
        };
        for (index, rule) in rules.iter().enumerate() {
            let ApplicationProfile {
                application,
                profile,
            } = rule;
            let reason = if application.trim().is_empty() {
                "the name of an application is empty; `xprop WM_CLASS`, or `swaymsg -t get_tree` on sway, prints the names".into()
            } else if rules[..index]
                .iter()
                .any(|other| other.matches(application))
            {
                format!("two rules for `{}`", escape(application))
            } else if !names().any(|name| name == profile) {
                let unknown = UnknownName::new("profile", profile, names());
                format!("{unknown}; add it to `profiles`")
            } else {
                continue;
            };
            let message = format!("`profiles_by_application`: {reason}");
            return Err(SetupError::Value(message));
        }
        Ok(())
    }

    /// Returns the filter of the joint angles.
    pub(super) fn smoothing_filter(&self) -> Result<Smoothing, SetupError> {
        Ok(match self.smoothing {
            SmoothingSetup::Default => Smoothing::default(),
            SmoothingSetup::Off => Smoothing::Off,
            SmoothingSetup::RecursiveAverage => Smoothing::RecursiveAverage,
            SmoothingSetup::OneEuro {
                min_cutoff_hz,
                beta,
                derivative_cutoff_hz,
            } => Smoothing::OneEuro(checked(
                "smoothing",
                OneEuroSettings {
                    min_cutoff_hz,
                    beta,
                    derivative_cutoff_hz,
                },
            )?),
        })
    }

    /// Returns the filter of the positions that a source measures.
    pub(super) fn position_filter(&self, source: Option<&SourceUri>) -> Option<OneEuroSettings> {
        match self.position_smoothing {
            PositionSmoothingSetup::Default => match source?.position_noise() {
                PositionNoise::Landmarks => Some(LANDMARK_SMOOTHING),
                PositionNoise::Markers => Some(MARKER_SMOOTHING),
                PositionNoise::None => None,
            },
            PositionSmoothingSetup::Off => None,
            PositionSmoothingSetup::OneEuro {
                min_cutoff_hz,
                beta,
                derivative_cutoff_hz,
            } => Some(OneEuroSettings {
                min_cutoff_hz,
                beta,
                derivative_cutoff_hz,
            }),
        }
    }

    /// Checks the filter of positions.
    pub(super) fn check_position_filter(&self) -> Result<(), SetupError> {
        match self.position_filter(None) {
            Some(settings) => checked("position_smoothing", settings).map(drop),
            None => Ok(()),
        }
    }

    /// Returns the settings of the pipeline.
    pub(super) fn pipeline_settings(&self) -> Result<PipelineSettings, SetupError> {
        self.check_press_rate()?;
        self.check_stall_timeout()?;
        self.check_other_role()?;
        Ok(PipelineSettings {
            arm_immediately: self.arm_immediately,
            stall_timeout: Duration::from_millis(self.stall_timeout_ms.into()),
            permissions: self.permissions(self.source.as_ref(), self.role),
            allow_system_keys: self.allow_system_keys,
            ..PipelineSettings::default()
        })
    }

    fn check_press_rate(&self) -> Result<(), SetupError> {
        match self.max_presses_per_second {
            Some(limit) => check_range("max_presses_per_second", limit, PRESSES_PER_SECOND),
            None => Ok(()),
        }
    }

    fn check_stall_timeout(&self) -> Result<(), SetupError> {
        check_range("stall_timeout_ms", self.stall_timeout_ms, STALL_TIMEOUTS_MS)
    }

    fn check_desktop_part(&self) -> Result<(), SetupError> {
        if self.desktop_part.is_none_or(|part| part.is_valid()) {
            return Ok(());
        }
        let message = "`desktop_part`: its edges are fractions of the desktop, 0 to 1, and `left` is less than `right` and `top` less than `bottom`";
        Err(SetupError::Value(message.into()))
    }

    /// Checks that a role of the other hand belongs to a source of its own.
    fn check_other_role(&self) -> Result<(), SetupError> {
        if let Some(OtherHand {
            source: None,
            role: Some(_),
            ..
        }) = self.other_hand
        {
            let message = "`other_hand` has a `role` but no `source`; set the `role` of the first source, which provides both hands";
            return Err(SetupError::Value(message.into()));
        }
        Ok(())
    }

    /// Returns the permissions of a source with this role. A source on the network has stricter defaults.
    pub(super) fn permissions(
        &self,
        source: Option<&SourceUri>,
        role: Option<SourceRole>,
    ) -> SourcePermissions {
        let defaults = match source {
            Some(source) if source.is_remote() => SourcePermissions::NETWORK,
            _ => SourcePermissions::LOCAL,
        };
        let rate_limit = self
            .max_presses_per_second
            .map(|per_second| PressRateLimit { per_second });
        SourcePermissions {
            role: role.unwrap_or(defaults.role),
            rate_limit: rate_limit.unwrap_or(defaults.rate_limit),
        }
    }
}

/// Checks that the whole number in `field` is in its range.
fn check_range(field: &str, value: u32, range: RangeInclusive<u32>) -> Result<(), SetupError> {
    if range.contains(&value) {
        return Ok(());
    }
    let (min, max) = range.into_inner();
    Err(SetupError::Value(format!(
        "`{field}` is {min} to {max}, not {value}"
    )))
}

/// Checks the settings of a filter in `field`.
fn checked(field: &str, settings: OneEuroSettings) -> Result<OneEuroSettings, SetupError> {
    let is_cutoff = |cutoff_hz: f64| (1e-3..=1e4).contains(&cutoff_hz);
    let is_valid = is_cutoff(settings.min_cutoff_hz)
        && is_cutoff(settings.derivative_cutoff_hz)
        && (0.0..=1e4).contains(&settings.beta);
    if is_valid {
        Ok(settings)
    } else {
        Err(SetupError::Value(format!(
            "`{field}`: cutoffs are 0.001 to 10000 Hz, `beta` is 0 to 10000"
        )))
    }
}

impl ArmSetup {
    /// Returns the bone lengths of a measured arm; `None` for another arm.
    pub(super) fn bone_lengths(&self) -> Result<Option<BoneLengths>, SetupError> {
        let Self::Measured {
            hand_length_mm,
            forearm_length_mm,
        } = self
        else {
            return Ok(None);
        };
        BoneLengths::from_hand_and_forearm(hand_length_mm * 1e-3, forearm_length_mm * 1e-3)
            .map(Some)
            .map_err(|reason| SetupError::Value(format!("`arm`: {reason}")))
    }
}
