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
    /// All rows, including the disabled ones.
    pub full_map: ChannelMap,
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
        if schema.rows.len() > MAX_ROWS {
            let message = format!(
                "a glove has at most {MAX_ROWS} rows, this one has {}",
                schema.rows.len()
            );
            return Err(document.error_at(&document.text, message));
        }
        let inputs: Vec<InputRow> = schema
            .inputs
            .iter()
            .map(|input| input.build(document))
            .collect::<Result<_, _>>()?;
        let assumed = schema
            .assumed_angles()
            .map_err(|message| document.error_at(&document.text, message))?;
        let rest_pose = schema
            .rest_pose()
            .map_err(|message| document.error_at(&document.text, message))?;
        let curvatures = schema
            .curvatures()
            .map_err(|message| document.error_at(&document.text, message))?;
        let hystereses = schema
            .hystereses()
            .map_err(|message| document.error_at(&document.text, message))?;
        let ranges = schema
            .ranges()
            .map_err(|message| document.error_at(&document.text, message))?;
        let map = |is_included: &dyn Fn(&RowSchema) -> bool| {
            let rows = schema.rows.iter().filter(|row| is_included(row));
            ChannelMap::new(rows.map(|row| row.build(full_scale)).collect(), full_scale)
                .with_inputs(inputs.clone())
                .with_assumed_angles(assumed.clone())
                .with_curvatures(curvatures.clone())
                .with_hystereses(hystereses.clone())
                .with_ranges(ranges.clone())
                .with_full_range(schema.uses_full_range)
        };
        Ok(Self {
            map: map(&|row| row.disabled.is_none()),
            full_map: map(&|_| true),
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
mod tests {
    use super::*;
    use crate::capture::protocol::lucidgloves;

    #[test]
    fn an_arm_in_place_of_a_glove_is_refused_with_the_list_of_gloves() {
        let error = Glove::parse(&Document::shipped("unam").unwrap()).unwrap_err();
        let expected = "expected `Glove(…)`, found `Arm`; `ademan gloves` lists the gloves";
        assert_eq!(error.message(), expected);
    }

    fn error(row: &str) -> String {
        let text = format!(
            "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, rows: [\n({row}),\n])"
        );
        Glove::parse(&Document::new("g.ron", text))
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn the_shipped_glove_has_22_enabled_and_4_disabled_rows() {
        let glove = Glove::parse(&Document::shipped("unam-hc11").unwrap()).unwrap();
        assert_eq!(glove.map.rows().len(), 22);
        assert_eq!(glove.full_map.rows().len(), 26);
        assert_eq!(glove.side, Side::Right);
    }

    #[test]
    fn the_shipped_lucidgloves_have_all_inputs_and_finger_joints() {
        for (name, side) in [
            ("lucidgloves", Side::Right),
            ("lucidgloves-left", Side::Left),
        ] {
            let map = Glove::parse(&Document::shipped(name).unwrap()).unwrap().map;
            assert_eq!(
                Glove::parse(&Document::shipped(name).unwrap())
                    .unwrap()
                    .side,
                side
            );
            for &input in Input::ALL {
                assert!(map.inputs().iter().any(|row| row.input == input), "{input}");
            }
            for &dof in Dof::ALL.iter().filter(|dof| dof.finger().is_some()) {
                assert!(map.rows().iter().any(|row| row.dof == dof), "{dof}");
            }
            assert_eq!(map.required_channels(), lucidgloves::CHANNELS);
            assert_eq!(map.full_scale(), lucidgloves::FULL_SCALE);
        }
    }

    #[test]
    fn invalid_inputs_and_assumed_angles_are_rejected() {
        let with = |fields: &str| {
            let text =
                format!("Glove(name: \"g\", side: \"right\", full_scale_counts: 255, {fields})");
            let glove = Glove::parse(&Document::new("g.ron", text));
            glove.unwrap_err().to_string()
        };
        let row = "label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 1, offset_rad: 0";
        for (fields, message) in [
            (
                r#"rows: [], inputs: [(input: "stick-z", channel: 1, zero_counts: 0, full_counts: 1)]"#.to_owned(),
                "did you mean `stick-x`?",
            ),
            (
                r#"rows: [], inputs: [(input: "menu", channel: 64, zero_counts: 0, full_counts: 1)]"#.to_owned(),
                "channel 64 does not exist",
            ),
            (
                r#"rows: [], inputs: [(input: "menu", channel: 1, zero_counts: 1, full_counts: 1)]"#.to_owned(),
                "a `full_counts` other than",
            ),
            (
                r#"rows: [], assumed_deg: {"elbow-flexion": 200}"#.to_owned(),
                "outside the range",
            ),
            (
                format!("rows: [({row})], assumed_deg: {{\"elbow-flexion\": 20}}"),
                "both measured and assumed",
            ),
        ] {
            let error = with(&fields);
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn an_angle_whose_row_is_disabled_may_be_assumed() {
        let row = "label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 1, offset_rad: 0";
        let text = format!(
            "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, rows: [({row}, disabled: \"loose\")], assumed_deg: {{\"elbow-flexion\": 90}})"
        );
        let glove = Glove::parse(&Document::new("g.ron", text)).unwrap();
        assert!(glove.map.rows().is_empty());
        let right_angle = 90_f64.to_radians();
        assert_eq!(
            glove.map.assumed_angles(),
            [(Dof::ElbowFlexion, right_angle)]
        );
    }

    #[test]
    fn a_curvature_is_of_a_channel_in_use_and_within_a_fifth_of_the_full_scale() {
        let row = "(label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 2.55, offset_rad: 0)";
        let parse = |curvature: &str| {
            let text = format!(
                "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, curvature_counts: {{{curvature}}}, rows: [{row}])"
            );
            Glove::parse(&Document::new("g.ron", text)).map_err(|error| error.to_string())
        };
        let map = parse("1: 25.5").unwrap().map;
        let radians = map.radians(&map.rows()[0], 127.5);
        assert!((radians - 1.02).abs() < 1e-9, "{radians}");
        assert!(
            parse("2: 1")
                .unwrap_err()
                .contains("channel 2, which no row has")
        );
        assert!(parse("1: 52").unwrap_err().contains("at most 51"));
        assert!(parse("1: NaN").unwrap_err().contains("at most 51"));
    }

    #[test]
    fn a_hysteresis_is_of_a_channel_in_use_and_within_a_fifth_of_the_full_scale() {
        let row = "(label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 2.55, offset_rad: 0)";
        let parse = |hysteresis: &str| {
            let text = format!(
                "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, hysteresis_counts: {{{hysteresis}}}, rows: [{row}])"
            );
            Glove::parse(&Document::new("g.ron", text)).map_err(|error| error.to_string())
        };
        let map = parse("1: 7.5").unwrap().map;
        assert_eq!((map.hysteresis(1), map.hysteresis(2)), (7.5, 0.0));
        for (hysteresis, message) in [
            ("2: 1", "channel 2, which no row has"),
            ("1: 52", "0 to 51 are possible"),
            ("1: -1", "0 to 51 are possible"),
            ("1: NaN", "0 to 51 are possible"),
        ] {
            let error = parse(hysteresis).unwrap_err();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn a_range_is_of_a_channel_in_use_and_rises_within_the_full_scale() {
        let row = "(label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 2.55, offset_rad: 0)";
        let parse = |range: &str| {
            let text = format!(
                "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, range_counts: {{{range}}}, rows: [{row}])"
            );
            Glove::parse(&Document::new("g.ron", text)).map_err(|error| error.to_string())
        };
        let map = parse("1: (6, 154)").unwrap().map;
        assert_eq!(map.range(1), Some((6.0, 154.0)));
        assert_eq!(map.range(2), None);
        for (range, message) in [
            ("2: (6, 154)", "channel 2, which no row has"),
            ("1: (154, 6)", "the smaller count first"),
            ("1: (6, 256)", "within 0 to 255"),
            ("1: (NaN, 100)", "the range of channel 1 is (NaN, 100)"),
        ] {
            let error = parse(range).unwrap_err();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn an_invalid_row_is_rejected_at_its_position() {
        let row = |channel: &str, full_scale: &str| {
            error(&format!(
                "label: \"a\", dof: \"elbow-flexion\", channel: {channel}, offset_counts: 0, full_scale_rad: {full_scale}, offset_rad: 0"
            ))
        };
        let channel = row("64", "1");
        assert!(
            channel.starts_with("g.ron:2:45: channel 64 does not exist, channels are 0 to 63\n"),
            "{channel}"
        );
        assert!(row("-1", "1").starts_with("g.ron:2:46: channel -1 does not exist"));
        assert!(row("1", "0").starts_with("g.ron:2:82: an angle that does not change is 0"));
        assert!(row("1", "NaN").starts_with("g.ron:2:82: NaN is out of range"));
        let escaped = error("label: \"a\\tb\", dof: \"elbow-flexion\"");
        assert!(
            escaped.contains(": this text must be written without `\\`\n"),
            "{escaped}"
        );
        let unknown = error("label: \"a\", dof: \"elbow-flexoin\"");
        assert!(
            unknown.contains("did you mean `elbow-flexion`?"),
            "{unknown}"
        );
    }
}
