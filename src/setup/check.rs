//! Checks of a setup, and the settings of the stages that follow from it.

use std::time::Duration;

use super::{ArmSetup, OtherHand, Setup, SetupError, SmoothingSetup};
use crate::capture::SourceUri;
use crate::estimate::{OneEuroSettings, Smoothing};
use crate::kinematics::BoneLengths;
use crate::pipeline::{PipelineSettings, PressRateLimit, SourcePermissions, SourceRole};

impl Setup {
    /// Checks all values.
    pub(super) fn check(&self) -> Result<(), SetupError> {
        self.smoothing_filter()?;
        self.pipeline_settings()?;
        if let Some(other) = &self.other_hand {
            other.arm.bone_lengths()?;
        }
        self.arm.bone_lengths().map(drop)
    }

    /// Returns the filter of the joint angles.
    pub(super) fn smoothing_filter(&self) -> Result<Smoothing, SetupError> {
        let (min_cutoff_hz, beta, derivative_cutoff_hz) = match self.smoothing {
            SmoothingSetup::Default => return Ok(Smoothing::default()),
            SmoothingSetup::Off => return Ok(Smoothing::Off),
            SmoothingSetup::RecursiveAverage => return Ok(Smoothing::RecursiveAverage),
            SmoothingSetup::OneEuro {
                min_cutoff_hz,
                beta,
                derivative_cutoff_hz,
            } => (min_cutoff_hz, beta, derivative_cutoff_hz),
        };
        let is_cutoff = |cutoff_hz: f64| (1e-3..=1e4).contains(&cutoff_hz);
        if !is_cutoff(min_cutoff_hz)
            || !is_cutoff(derivative_cutoff_hz)
            || !(0.0..=1e4).contains(&beta)
        {
            let message = "`smoothing`: cutoffs are 0.001 to 10000 Hz, `beta` is 0 to 10000";
            return Err(SetupError::Value(message.into()));
        }
        Ok(Smoothing::OneEuro(OneEuroSettings {
            min_cutoff_hz,
            beta,
            derivative_cutoff_hz,
        }))
    }

    /// Returns the settings of the pipeline.
    pub(super) fn pipeline_settings(&self) -> Result<PipelineSettings, SetupError> {
        if let Some(other @ (0 | 1001..)) = self.max_presses_per_second {
            let message = format!("`max_presses_per_second` is 1 to 1000, not {other}");
            return Err(SetupError::Value(message));
        }
        let stall_timeout_ms = self.stall_timeout_ms;
        if !(20..=10_000).contains(&stall_timeout_ms) {
            let message = format!("`stall_timeout_ms` is 20 to 10000, not {stall_timeout_ms}");
            return Err(SetupError::Value(message));
        }
        if let Some(OtherHand {
            source: None,
            role: Some(_),
            ..
        }) = self.other_hand
        {
            let message = "`other_hand` has a `role` but no `source`; set the `role` of the first source, which provides both hands";
            return Err(SetupError::Value(message.into()));
        }
        Ok(PipelineSettings {
            arm_immediately: self.arm_immediately,
            stall_timeout: Duration::from_millis(stall_timeout_ms.into()),
            permissions: self.permissions(self.source.as_ref(), self.role),
            allow_system_keys: self.allow_system_keys,
            ..PipelineSettings::default()
        })
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

impl ArmSetup {
    /// Returns the bone lengths of a measured arm.
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
