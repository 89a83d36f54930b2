//! Gloves, from `layouts/gloves/*.ron`: the joint angle that each channel measures.

use serde::Deserialize;

use crate::capture::MAX_CHANNELS;
use crate::document::{Document, DocumentError};
use crate::estimate::{AffineMap, ChannelMap, ChannelRow, MAX_ROWS};
use crate::hand::{Dof, Side};

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
}

#[derive(Deserialize)]
#[serde(rename = "Glove", deny_unknown_fields)]
struct GloveSchema<'a> {
    name: String,
    side: Side,
    /// The largest count of a channel.
    full_scale_counts: u16,
    #[serde(borrow)]
    rows: Vec<RowSchema<'a>>,
}

/// The calibration of an angle: offset_rad + (count + offset_counts) × full_scale_rad / full_scale_counts.
#[derive(Deserialize)]
#[serde(rename = "Row", deny_unknown_fields)]
struct RowSchema<'a> {
    label: &'a str,
    dof: Dof,
    channel: usize,
    offset_counts: f64,
    full_scale_rad: f64,
    offset_rad: f64,
    /// The reason why the row is disabled.
    disabled: Option<String>,
}

impl Glove {
    /// Loads the glove with this name or path.
    pub fn load(name: &str) -> Result<Self, DocumentError> {
        Self::parse(&Document::open(name)?)
    }

    /// Parses a document.
    pub fn parse(document: &Document) -> Result<Self, DocumentError> {
        let schema: GloveSchema = document.parse()?;
        let full_scale = schema.full_scale_counts;
        if full_scale < 2 {
            return Err(document.error_at(
                &document.text,
                "`full_scale_counts` must be the largest count of a channel, such as 255 for 8 bits",
            ));
        }
        if schema.rows.len() > MAX_ROWS {
            let message = format!(
                "a glove has at most {MAX_ROWS} rows, this one has {}",
                schema.rows.len()
            );
            return Err(document.error_at(&document.text, message));
        }
        for row in &schema.rows {
            row.check(document)?;
        }
        let map = |is_included: &dyn Fn(&RowSchema) -> bool| {
            let rows = schema.rows.iter().filter(|row| is_included(row));
            ChannelMap::new(rows.map(|row| row.build(full_scale)).collect(), full_scale)
        };
        Ok(Self {
            map: map(&|row| row.disabled.is_none()),
            full_map: map(&|_| true),
            name: schema.name,
            side: schema.side,
        })
    }
}

impl RowSchema<'_> {
    fn check(&self, document: &Document) -> Result<(), DocumentError> {
        if self.channel >= MAX_CHANNELS {
            let message = format!(
                "channel {} does not exist, channels are 0 to {}",
                self.channel,
                MAX_CHANNELS - 1
            );
            return Err(document.error_at(self.label, message));
        }
        let numbers = [self.offset_counts, self.full_scale_rad, self.offset_rad];
        let is_valid = |number: &f64| (-1e6..=1e6).contains(number);
        if !numbers.iter().all(is_valid) || self.full_scale_rad == 0.0 {
            let message = format!(
                "the row of {} needs finite numbers, and a `full_scale_rad` other than 0",
                self.dof
            );
            return Err(document.error_at(self.label, message));
        }
        Ok(())
    }

    fn build(&self, full_scale: u16) -> ChannelRow {
        let rad_per_count = self.full_scale_rad / f64::from(full_scale);
        ChannelRow {
            label: self.label.to_owned(),
            dof: self.dof,
            channel: self.channel,
            calibration: AffineMap::from_counts(self.offset_counts, rad_per_count, self.offset_rad),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let glove = Glove::load("unam-hc11").unwrap();
        assert_eq!(glove.map.rows().len(), 22);
        assert_eq!(glove.full_map.rows().len(), 26);
        assert_eq!(glove.side, Side::Right);
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
            channel.starts_with("g.ron:2:10: channel 64 does not exist"),
            "{channel}"
        );
        assert!(row("1", "0").contains("other than 0"));
        assert!(row("1", "NaN").contains("finite"));
        let unknown = error("label: \"a\", dof: \"elbow-flexoin\"");
        assert!(
            unknown.contains("did you mean `elbow-flexion`?"),
            "{unknown}"
        );
    }
}
