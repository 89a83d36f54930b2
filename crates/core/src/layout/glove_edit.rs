//! Edits of the calibration in the text of a glove. Everything else in the text stays as it is.

use std::ops::Range;

use super::edit::{items_of, replace_ranges, stated, tree_of};
use super::glove::Glove;
use crate::document::{Document, DocumentError, Node, parse_ron};
use crate::estimate::{ChannelMap, ChannelRow, CountRange, JointLimits};
use crate::hand::{Dof, JointAngles};

/// Returns the text of a glove with the channels and calibrations of `map`, whose rows are those that are enabled in the text, in their
/// order, and with the angles of `rest`, unless it has none.
///
/// `offset_rad` stays, and so does the spelling of numbers that do not change. Returns an error if the text is not a glove.
pub fn write_calibration(
    document: &Document,
    map: &ChannelMap,
    rest: &JointAngles,
) -> Result<String, DocumentError> {
    let old = Glove::parse(document)?.map;
    let (text, tree) = (&document.text, tree_of(document)?);
    let full_scale = f64::from(map.full_scale());
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    let rows = items_of(&tree, text, "rows").iter().map(|item| &item.value);
    let enabled = rows.filter(|row| stated(row, text, "disabled").is_none());
    for ((row, old_row), new) in enabled.zip(old.rows()).zip(map.rows()) {
        let mut edit = |field: &str, number: String| {
            let old_number = row.field(text, field);
            edits.extend(old_number.map(|node| (node.range.clone(), number)));
        };
        if old_row.channel != new.channel {
            edit("channel", new.channel.to_string());
        }
        if old_row.calibration == new.calibration {
            continue;
        }
        let Some(offset_rad) = row.field(text, "offset_rad") else {
            continue;
        };
        let offset_rad: f64 = parse_ron(offset_rad.text(text), &document.file)?;
        let gain = written_gain(new.calibration.gain * full_scale);
        edit("full_scale_rad", gain.to_string());
        let offset = offset_counts(new, gain / full_scale, offset_rad);
        edit("offset_counts", offset.to_string());
    }
    let mut set = |name: &str, entries: Vec<String>| {
        edits.extend(set_field(text, &tree, name, &entries));
    };
    let counts_of =
        |(channel, counts): &(usize, f64)| format!("{channel}: {}", round(*counts, 1e2));
    if old.curvatures() != map.curvatures() {
        let entries = map.curvatures().iter().map(counts_of).collect();
        set("curvature_counts", entries);
    }
    if old.hystereses() != map.hystereses() {
        let entries = map.hystereses().iter().map(counts_of).collect();
        set("hysteresis_counts", entries);
    }
    if old.ranges() != map.ranges() {
        let entry = |(channel, (low, high)): &(usize, CountRange)| {
            format!("{channel}: ({}, {})", round(*low, 1e2), round(*high, 1e2))
        };
        let entries = map.ranges().iter().map(entry).collect();
        set("range_counts", entries);
    }
    if !rest.is_empty() {
        let entry = |(dof, radians): (_, f64)| format!("\"{dof}\": {}", degrees(dof, radians));
        set("rest_deg", rest.known().map(entry).collect());
    }
    Ok(replace_ranges(text, edits))
}

/// Returns a gain with four decimals that a glove file accepts: not 0.
fn written_gain(full_scale_rad: f64) -> f64 {
    match round(full_scale_rad, 1e4) {
        0.0 => 1e-4_f64.copysign(full_scale_rad),
        gain => gain.clamp(-1e6, 1e6),
    }
}

/// Returns the offset in counts of a row with this gain, as it is written, and this offset in radians.
fn offset_counts(row: &ChannelRow, gain: f64, offset_rad: f64) -> f64 {
    let counts = (row.calibration.offset - offset_rad) / gain;
    round(counts.clamp(-1e6, 1e6), 1e2)
}

/// Returns the edit that sets a map: in place of the old one, or after the full scale.
fn set_field(
    text: &str,
    glove: &Node,
    name: &str,
    entries: &[String],
) -> Option<(Range<usize>, String)> {
    let value = format!("{{{}}}", entries.join(", "));
    if let Some(old) = glove.field(text, name) {
        return Some((old.range.clone(), value));
    }
    let end = glove.field(text, "full_scale_counts")?.range.end;
    Some((end..end, format!(",\n    {name}: {value}")))
}

/// Returns an angle in degrees with one decimal, within the limits of its joint.
fn degrees(dof: Dof, radians: f64) -> f64 {
    let (low, high) = JointLimits::human().range(dof);
    let tenths = |angle: f64| angle.to_degrees() * 10.0;
    let (low, high) = ((tenths(low) - 1e-6).ceil(), (tenths(high) + 1e-6).floor());
    tenths(radians).round().clamp(low, high) / 10.0 + 0.0
}

/// Rounds to a multiple of 1/`scale`. 0 has no sign.
fn round(value: f64, scale: f64) -> f64 {
    (value * scale).round() / scale + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::AffineMap;

    const COMMENTED: &str = r#"// My glove.
Glove(
    name: "mine", // after the left one
    side: "right",
    full_scale_counts: 255 /* 8 bits */,
    rows: [
        (label: "A", dof: "elbow-flexion", channel: 1, offset_counts: -30 /* straight */, full_scale_rad: 2.50, offset_rad: 0.5),
        (label: "B", dof: "elbow-flexion", channel: 3, offset_counts: 0, full_scale_rad: 1, offset_rad: 0, disabled: "loose"),
        // bent
        (label: "C", dof: "wrist-flexion", channel: 2, full_scale_rad: -2.0, offset_rad: 0.0, offset_counts: -25.0),
    ],
)
"#;

    fn document() -> Document {
        Document::new("mine.ron", COMMENTED)
    }

    fn map() -> ChannelMap {
        Glove::parse(&document()).unwrap().map
    }

    fn write(document: &Document, map: &ChannelMap) -> String {
        write_calibration(document, map, &JointAngles::default()).unwrap()
    }

    #[test]
    fn only_numbers_change_and_comments_stay() {
        let calibrations = [
            AffineMap::from_counts(-41.0, 3.25 / 255.0, 0.5),
            map().rows()[1].calibration,
        ];
        let new = map().with_calibrations(&calibrations);
        let text = write(&document(), &new);
        let expected = COMMENTED
            .replace("offset_counts: -30 ", "offset_counts: -41 ")
            .replace("2.50", "3.25");
        assert_eq!(text, expected);
    }

    #[test]
    fn an_unchanged_calibration_changes_nothing() {
        assert_eq!(write(&document(), &map()), COMMENTED);
    }

    #[test]
    fn exchanged_channels_are_written_and_read_again() {
        let exchanged = map().with_channels(|channel| 3 - channel);
        let text = write(&document(), &exchanged);
        let expected = COMMENTED
            .replace("channel: 1,", "channel: 0,")
            .replace("channel: 2,", "channel: 1,")
            .replace("channel: 0,", "channel: 2,");
        assert_eq!(text, expected);
        let read = Glove::parse(&Document::new("mine.ron", text)).unwrap();
        assert_eq!(read.map.rows(), exchanged.rows());
    }

    #[test]
    fn curvatures_are_added_and_then_replaced() {
        let curved = map().with_curvatures(vec![(1, 4.567), (2, -3.0)]);
        let text = write(&document(), &curved);
        let added = "full_scale_counts: 255,\n    curvature_counts: {1: 4.57, 2: -3} /* 8 bits */";
        assert_eq!(
            text,
            COMMENTED.replace("full_scale_counts: 255 /* 8 bits */", added)
        );
        let edited = Document::new("mine.ron", text);
        let cleared = write(&edited, &map());
        assert!(
            cleared.contains("curvature_counts: {} /* 8 bits */"),
            "{cleared}"
        );
    }

    #[test]
    fn hystereses_are_added_and_read_again() {
        let lagging = map().with_hystereses(vec![(1, 7.654)]);
        let text = write(&document(), &lagging);
        assert!(text.contains("hysteresis_counts: {1: 7.65}"), "{text}");
        let read = Glove::parse(&Document::new("mine.ron", text)).unwrap();
        assert_eq!(read.map.hystereses(), [(1, 7.65)]);
    }

    #[test]
    fn ranges_are_added_and_then_replaced() {
        let ranged = map().with_ranges(vec![(1, (6.0, 154.5)), (2, (30.0, 90.0))]);
        let text = write(&document(), &ranged);
        assert!(
            text.contains("range_counts: {1: (6, 154.5), 2: (30, 90)}"),
            "{text}"
        );
        let read = Document::new("mine.ron", text);
        assert_eq!(Glove::parse(&read).unwrap().map.ranges(), ranged.ranges());
        let cleared = write(&read, &map());
        assert!(
            cleared.contains("range_counts: {} /* 8 bits */"),
            "{cleared}"
        );
    }

    #[test]
    fn the_rest_pose_is_written_within_the_limits_and_read_back() {
        let mut rest = JointAngles::default();
        rest.set(Dof::ElbowFlexion, 0.61);
        rest.set(Dof::WristFlexion, -2.0);
        rest.set(Dof::IndexDipFlexion, -0.0001);
        let text = write_calibration(&document(), &map(), &rest).unwrap();
        let expected =
            r#"rest_deg: {"elbow-flexion": 35, "wrist-flexion": -70, "index-dip-flexion": 0}"#;
        assert!(text.contains(expected), "{text}");
        let read = Glove::parse(&Document::new("mine.ron", text)).unwrap();
        let degrees = read.rest_pose.get(Dof::WristFlexion).to_degrees();
        assert!((degrees + 70.0).abs() < 1e-9, "{degrees}");
    }

    #[test]
    fn every_written_calibration_is_read_back() {
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..300 {
            let mut calibration = || {
                let gain = 0.2 + random.f64() * 5.0;
                AffineMap::from_counts(-250.0 * random.f64(), gain / 255.0, random.f64())
            };
            let new = map().with_calibrations(&[calibration(), calibration()]);
            let text = write(&document(), &new);
            let read = Glove::parse(&Document::new("mine.ron", text)).unwrap().map;
            assert_eq!(read.rows().len(), new.rows().len());
            for (read_row, new_row) in read.rows().iter().zip(new.rows()) {
                for count in [0.0, 255.0] {
                    let error =
                        read_row.calibration.apply(count) - new_row.calibration.apply(count);
                    assert!(error.abs() < 1e-3, "{read_row:?} for {new_row:?}");
                }
            }
        }
    }
}
