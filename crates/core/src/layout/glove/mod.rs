//! Gloves, from `layouts/gloves/*.ron`: the joint angle that each channel measures.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::glove_numbers::{Channel, FullScaleCounts, FullScaleRad, OffsetCounts, OffsetRad};
use crate::document::{
    Document, DocumentError, Format, Spanned, Structure, Table, first_error, schema, tables_of,
};
use crate::estimate::{
    AffineMap, ChannelMap, ChannelRow, CountRange, InputRow, JointLimits, MAX_CURVATURE,
    MAX_HYSTERESIS, MAX_ROWS,
};
use crate::hand::{Dof, Input, JointAngles, Side};
use crate::names::UnknownName;

/// A glove.
#[derive(Clone, Debug)]
pub struct Glove {
    /// Name for displays.
    pub name: String,
    /// The hand that it is for.
    pub side: Side,
    /// The enabled rows.
    pub map: ChannelMap,
    /// The angles of the wearer's hand at rest, in radians; none if the file has none.
    pub rest_pose: JointAngles,
}

schema! {
    /// A glove file.
    #[derive(Deserialize)]
    #[serde(rename = "Glove", deny_unknown_fields)]
    struct GloveSchema<'a> {
        /// Name for displays.
        name: String,
        /// The hand that wears it.
        side: Side,
        /// The largest count of a channel, such as 255 for 8 bits.
        full_scale_counts: FullScaleCounts,
        /// The joint angles that the channels measure.
        #[serde(borrow)]
        rows: Vec<RowSchema<'a>>,
        /// The sticks, triggers and buttons.
        #[serde(borrow, default)]
        inputs: Vec<InputSchema<'a>>,
        /// The angles that the glove does not measure, in degrees.
        #[serde(default)]
        assumed_deg: BTreeMap<Dof, f64>,
        /// The angles of the hand at rest, in degrees.
        #[serde(default)]
        rest_deg: BTreeMap<Dof, f64>,
        /// The counts by which a channel is above a straight line in the middle of the full scale, by channel.
        #[serde(default)]
        curvature_counts: BTreeMap<usize, f64>,
        /// The counts by which a channel differs at one bend after closing and after opening, because its sensor lags behind the
        /// movement, by channel. `ademan calibrate --hysteresis` measures them.
        #[serde(default)]
        hysteresis_counts: BTreeMap<usize, f64>,
        /// The smallest and the largest count in the poses of the calibration, by channel.
        #[serde(default)]
        range_counts: BTreeMap<usize, CountRange>,
        /// Counts are at the ends of their range in normal use. Otherwise such a count is a broken wire.
        #[serde(default)]
        uses_full_range: bool,
    }
}

schema! {
    /// An input, with the value (count − `zero_counts`) / (`full_counts` − `zero_counts`), within −1 and 1.
    #[derive(Deserialize)]
    #[serde(rename = "Input", deny_unknown_fields)]
    struct InputSchema<'a> {
        /// Name of the input, such as `"trigger"`.
        #[serde(borrow)]
        input: Spanned<'a>,
        /// Index of the channel.
        channel: Channel,
        /// Count at which the value is 0.
        zero_counts: f64,
        /// Count at which the value is 1.
        full_counts: f64,
    }
}

schema! {
    /// A joint angle: `offset_rad` + (count + `offset_counts`) × `full_scale_rad` / `full_scale_counts`.
    #[derive(Deserialize)]
    #[serde(rename = "Row", deny_unknown_fields)]
    struct RowSchema<'a> {
        /// Name of the sensor for displays.
        label: &'a str,
        /// The angle.
        dof: Dof,
        /// Index of the channel.
        channel: Channel,
        /// Offset that is added to the count.
        offset_counts: OffsetCounts,
        /// Change of the angle over the full scale, not 0.
        full_scale_rad: FullScaleRad,
        /// Offset that is added to the angle.
        offset_rad: OffsetRad,
        /// The reason why the row is disabled. Default: the row is enabled.
        disabled: Option<String>,
    }
}

/// The format of glove files.
const FORMAT: Format = Format {
    name: "Glove",
    remedy: "; `ademan glove new NAME` writes a glove to start from",
    reread: |text| first_error::<GloveSchema>(text),
    structures: || {
        vec![
            Structure::of::<GloveSchema>("Glove"),
            Structure::of::<RowSchema>("rows"),
            Structure::of::<InputSchema>("inputs"),
        ]
    },
};

/// Returns the tables of the fields of a glove file.
pub fn glove_field_tables() -> Vec<Table> {
    tables_of::<GloveSchema>()
}

impl Glove {
    /// Parses a document.
    pub fn parse(document: &Document) -> Result<Self, DocumentError> {
        let schema: GloveSchema = document.parse_as(&FORMAT)?;
        let FullScaleCounts(full_scale) = schema.full_scale_counts;
        let error = |message: String| document.error_at(&document.text, message);
        if schema.rows.len() > MAX_ROWS {
            let count = schema.rows.len();
            let message = format!("a glove has at most {MAX_ROWS} rows, this one has {count}");
            return Err(error(message));
        }
        let inputs = schema.inputs.iter().map(|input| input.build(document));
        let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
        let assumed = schema.assumed_angles().map_err(error)?;
        let rest_pose = schema.rest_pose().map_err(error)?;
        let curvatures = schema.curvatures().map_err(error)?;
        let hystereses = schema.hystereses().map_err(error)?;
        let ranges = schema.ranges().map_err(error)?;
        let rows = schema.rows.iter().filter(|row| row.disabled.is_none());
        let rows = rows.map(|row| row.build(full_scale)).collect();
        Ok(Self {
            map: ChannelMap::new(rows, full_scale)
                .with_inputs(inputs)
                .with_assumed_angles(assumed)
                .with_curvatures(curvatures)
                .with_hystereses(hystereses)
                .with_ranges(ranges)
                .with_full_range(schema.uses_full_range),
            rest_pose,
            name: schema.name,
            side: schema.side,
        })
    }
}

impl GloveSchema<'_> {
    /// Returns the angles at rest in radians. An error states what is wrong with one.
    fn rest_pose(&self) -> Result<JointAngles, String> {
        let mut angles = JointAngles::default();
        for (&dof, &degrees) in &self.rest_deg {
            angles.set(dof, radians_within_limits(dof, degrees)?);
        }
        Ok(angles)
    }

    /// Returns the assumed angles in radians. An error states what is wrong with one.
    fn assumed_angles(&self) -> Result<Vec<(Dof, f64)>, String> {
        let check = |(&dof, &degrees): (&Dof, &f64)| {
            let radians = radians_within_limits(dof, degrees)?;
            let mut enabled = self.rows.iter().filter(|row| row.disabled.is_none());
            if enabled.any(|row| row.dof == dof) {
                Err(format!(
                    "{dof} is both measured and assumed, remove one of them"
                ))
            } else {
                Ok((dof, radians))
            }
        };
        self.assumed_deg.iter().map(check).collect()
    }

    /// Returns an error if no row has a channel that a field states.
    fn require_row(&self, field: &str, channel: usize) -> Result<(), String> {
        if self.rows.iter().any(|row| row.channel.0 == channel) {
            return Ok(());
        }
        Err(format!("`{field}` has channel {channel}, which no row has"))
    }

    /// Returns the calibrated ranges of channels in counts. An error states what is wrong with one.
    fn ranges(&self) -> Result<Vec<(usize, CountRange)>, String> {
        let full_scale = f64::from(self.full_scale_counts.0);
        let check = |(&channel, &(low, high)): (&usize, &CountRange)| {
            self.require_row("range_counts", channel)?;
            if 0.0 <= low && low < high && high <= full_scale {
                Ok((channel, (low, high)))
            } else {
                Err(format!(
                    "the range of channel {channel} is ({low}, {high}); write the smaller count first, both within 0 to {full_scale}"
                ))
            }
        };
        self.range_counts.iter().map(check).collect()
    }

    /// Returns the hystereses of channels in counts. An error states what is wrong with one.
    fn hystereses(&self) -> Result<Vec<(usize, f64)>, String> {
        let limit = MAX_HYSTERESIS * f64::from(self.full_scale_counts.0);
        let check = |(&channel, &counts): (&usize, &f64)| {
            self.require_row("hysteresis_counts", channel)?;
            if (0.0..=limit).contains(&counts) {
                Ok((channel, counts))
            } else {
                Err(format!(
                    "the hysteresis of channel {channel} is {counts} counts, 0 to {limit} are possible"
                ))
            }
        };
        self.hysteresis_counts.iter().map(check).collect()
    }

    /// Returns the curvatures of channels in counts. An error states what is wrong with one.
    fn curvatures(&self) -> Result<Vec<(usize, f64)>, String> {
        let limit = MAX_CURVATURE * f64::from(self.full_scale_counts.0);
        let check = |(&channel, &counts): (&usize, &f64)| {
            self.require_row("curvature_counts", channel)?;
            if counts.abs() <= limit {
                Ok((channel, counts))
            } else {
                Err(format!(
                    "the curvature of channel {channel} is {counts} counts, at most {limit} are possible"
                ))
            }
        };
        self.curvature_counts.iter().map(check).collect()
    }
}

fn radians_within_limits(dof: Dof, degrees: f64) -> Result<f64, String> {
    let radians = degrees.to_radians();
    if radians.is_finite() && JointLimits::human().clamp(dof, radians) == radians {
        Ok(radians)
    } else {
        Err(format!(
            "{degrees}° for {dof} is outside the range of that joint"
        ))
    }
}

impl InputSchema<'_> {
    fn build(&self, document: &Document) -> Result<InputRow, DocumentError> {
        let name = self.input.text;
        let input: Input = name
            .parse()
            .map_err(|error: UnknownName| document.error_at(name, error))?;
        let (zero, full) = (self.zero_counts, self.full_counts);
        let is_valid = |number: f64| (-1e6..=1e6).contains(&number);
        if !is_valid(zero) || !is_valid(full) || zero == full {
            let message = format!(
                "the input `{input}` needs finite numbers, and a `full_counts` other than its `zero_counts`"
            );
            return Err(document.error_at(name, message));
        }
        Ok(InputRow {
            input,
            channel: self.channel.0,
            calibration: AffineMap::from_counts(-zero, 1.0 / (full - zero), 0.0),
        })
    }
}

impl RowSchema<'_> {
    fn build(&self, full_scale: u16) -> ChannelRow {
        let rad_per_count = self.full_scale_rad.0 / f64::from(full_scale);
        let (offset_counts, offset_rad) = (self.offset_counts.get(), self.offset_rad.get());
        ChannelRow {
            label: self.label.to_owned(),
            dof: self.dof,
            channel: self.channel.0,
            calibration: AffineMap::from_counts(offset_counts, rad_per_count, offset_rad),
        }
    }
}

#[cfg(test)]
mod tests;
