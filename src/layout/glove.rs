//! `layouts/gloves/*.ron`: which channel of a glove tells which angle.

use serde::Deserialize;

use crate::capture::MAX_CHANNELS;
use crate::document::Document;
use crate::document::DocumentError;
use crate::estimate::{AffineMap, ChannelMap, ChannelRow, MAX_ROWS};
use crate::hand::{Dof, Side};

/// A glove as its file describes it.
#[derive(Clone, Debug)]
pub struct Glove {
    /// What people call it.
    pub name: String,
    /// The hand that it is for.
    pub side: Side,
    /// The rows that are on.
    pub map: ChannelMap,
    /// All rows, also those that the file turns off.
    pub full_map: ChannelMap,
}

#[derive(Deserialize)]
#[serde(rename = "Glove", deny_unknown_fields)]
struct Written<'a> {
    name: String,
    side: Side,
    full_scale: u16,
    #[serde(borrow)]
    rows: Vec<WrittenRow<'a>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenRow<'a> {
    label: &'a str,
    dof: Dof,
    channel: usize,
    offset_counts: f64,
    turn_rad: f64,
    initial_rad: f64,
    /// Why the row does not count.
    off: Option<String>,
}

impl Glove {
    /// The glove with this name or path.
    pub fn load(name: &str) -> Result<Self, DocumentError> {
        Self::parse(&Document::open(name)?)
    }

    /// The glove that a document describes.
    pub fn parse(document: &Document) -> Result<Self, DocumentError> {
        let written: Written = document.parse()?;
        if written.full_scale < 2 {
            return Err(document.error_at(
                &document.text,
                "`full_scale` is the largest count of a channel, 255 for 8 bits",
            ));
        }
        if written.rows.len() > MAX_ROWS {
            let message = format!(
                "a glove has at most {MAX_ROWS} rows, this one has {}",
                written.rows.len()
            );
            return Err(document.error_at(&document.text, message));
        }
        for row in &written.rows {
            row.check(document)?;
        }
        let rows = |wanted: &dyn Fn(&WrittenRow) -> bool| -> Vec<ChannelRow> {
            let wanted = written.rows.iter().filter(|row| wanted(row));
            wanted.map(|row| row.checked(written.full_scale)).collect()
        };
        Ok(Self {
            map: ChannelMap::new(rows(&|row| row.off.is_none()), written.full_scale),
            full_map: ChannelMap::new(rows(&|_| true), written.full_scale),
            name: written.name,
            side: written.side,
        })
    }
}

impl WrittenRow<'_> {
    fn check(&self, document: &Document) -> Result<(), DocumentError> {
        if self.channel >= MAX_CHANNELS {
            let message = format!(
                "channel {} does not exist, they are 0 to {}",
                self.channel,
                MAX_CHANNELS - 1
            );
            return Err(document.error_at(self.label, message));
        }
        let numbers = [self.offset_counts, self.turn_rad, self.initial_rad];
        let usable = |number: &f64| (-1e6..=1e6).contains(number);
        if !numbers.iter().all(usable) || self.turn_rad == 0.0 {
            let message = format!(
                "the row of {} needs finite numbers, and a `turn_rad` other than 0",
                self.dof
            );
            return Err(document.error_at(self.label, message));
        }
        Ok(())
    }

    fn checked(&self, full_scale: u16) -> ChannelRow {
        let factor = self.turn_rad / f64::from(full_scale);
        ChannelRow {
            label: self.label.to_owned(),
            dof: self.dof,
            channel: self.channel,
            calibration: AffineMap::from_counts(self.offset_counts, factor, self.initial_rad),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(row: &str) -> String {
        let text =
            format!("Glove(name: \"g\", side: \"right\", full_scale: 255, rows: [\n({row}),\n])");
        Glove::parse(&Document::new("g.ron", text))
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn the_shipped_glove_has_22_rows_on_and_4_off() {
        let glove = Glove::load("unam-hc11").unwrap();
        assert_eq!(glove.map.rows().len(), 22);
        assert_eq!(glove.full_map.rows().len(), 26);
        assert_eq!(glove.side, Side::Right);
    }

    #[test]
    fn bad_rows_are_refused_at_their_place() {
        let row = |channel: &str, turn: &str| {
            error(&format!(
                "label: \"a\", dof: \"elbow-flexion\", channel: {channel}, offset_counts: 0, turn_rad: {turn}, initial_rad: 0"
            ))
        };
        let far = row("64", "1");
        assert!(
            far.starts_with("g.ron:2:10: channel 64 does not exist"),
            "{far}"
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
