//! The calibration of a glove while it is edited: gains, offsets, inversions and ranges, with undo.

use ademan_core::document::{Document, DocumentError};
use ademan_core::estimate::{AffineMap, ChannelMap, CountRange};
use ademan_core::hand::JointAngles;
use ademan_core::layout::{Glove, write_calibration};

/// Largest angle of the full range of a channel, in degrees. A sensor that covers a joint with a tenth of its range has one of
/// 1000°.
pub const MAX_FULL_RANGE_DEG: f64 = 3000.0;

/// Smallest angle of the full range of a channel, in degrees. 0 would measure nothing.
pub const MIN_FULL_RANGE_DEG: f64 = 1.0;

/// A value that an edit changes. Edits of one value in one movement of the mouse are undone together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditKind {
    /// Gain of a row.
    Gain(usize),
    /// Offset of a row.
    Offset(usize),
    /// Direction of a channel.
    Inversion(usize),
    /// Range of a channel.
    Range(usize),
    /// All values, by a calibration.
    All,
}

/// The values of a glove that are edited.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The enabled rows of the glove.
    pub map: ChannelMap,
    /// The angles at rest.
    pub rest: JointAngles,
}

/// A glove file and its edited calibration.
#[derive(Clone, Debug)]
pub struct GloveEditor {
    document: Document,
    glove: Glove,
    now: Calibration,
    saved: Calibration,
    undone: Vec<Calibration>,
    done: Vec<Calibration>,
    /// The edit in progress, such as a drag.
    open: Option<EditKind>,
}

impl GloveEditor {
    /// Opens a glove file. Fails if the text is not a glove.
    pub fn new(document: &Document) -> Result<Self, DocumentError> {
        let glove = Glove::parse(document)?;
        let now = Calibration {
            map: glove.map.clone(),
            rest: glove.rest_pose,
        };
        Ok(Self {
            document: document.clone(),
            glove,
            saved: now.clone(),
            now,
            undone: Vec::new(),
            done: Vec::new(),
            open: None,
        })
    }

    /// Returns the file as it was opened.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Returns the glove as it was opened.
    pub fn glove(&self) -> &Glove {
        &self.glove
    }

    /// Returns the present calibration.
    pub fn calibration(&self) -> &Calibration {
        &self.now
    }

    /// Returns the present rows.
    pub fn map(&self) -> &ChannelMap {
        &self.now.map
    }

    /// Returns `true` if there are changes that are not saved.
    pub fn is_changed(&self) -> bool {
        self.now != self.saved
    }

    /// Returns the angle of the full range of a row, in degrees; negative if the angle falls with the counts.
    pub fn full_range_deg(&self, row: usize) -> f64 {
        let gain = self.now.map.rows()[row].calibration.gain;
        (gain * f64::from(self.now.map.full_scale())).to_degrees()
    }

    /// Sets the angle of the full range of a row, in degrees. Its sign stays, and so does the count at 0°.
    pub fn set_full_range_deg(&mut self, row: usize, degrees: f64) {
        let old = self.now.map.rows()[row].calibration;
        let degrees = degrees.abs().clamp(MIN_FULL_RANGE_DEG, MAX_FULL_RANGE_DEG);
        let gain = degrees.to_radians() / f64::from(self.now.map.full_scale());
        let gain = gain.copysign(old.gain);
        let zero = old.apply_inverse(0.0);
        let new = AffineMap::from_counts(-zero, gain, 0.0);
        self.set_calibration(EditKind::Gain(row), row, new);
    }

    /// Returns the count at which the angle of a row is 0.
    pub fn zero_count(&self, row: usize) -> f64 {
        let map = &self.now.map;
        let row = &map.rows()[row];
        let linear = row.calibration.apply_inverse(0.0);
        map.linearity(row.channel).apply_inverse(linear)
    }

    /// Sets the count at which the angle of a row is 0.
    pub fn set_zero_count(&mut self, row: usize, count: f64) {
        let map = &self.now.map;
        let own = &map.rows()[row];
        let zero = map.linearity(own.channel).apply(count);
        let new = AffineMap::from_counts(-zero, own.calibration.gain, 0.0);
        self.set_calibration(EditKind::Offset(row), row, new);
    }

    /// Returns `true` if the angles of a channel fall with its counts.
    pub fn is_inverted(&self, channel: usize) -> bool {
        let mut rows = self.now.map.rows().iter();
        rows.any(|row| row.channel == channel && row.calibration.gain < 0.0)
    }

    /// Exchanges the ends of a channel, as exchanged wires do: the angles at a count are those at the count as far from the other
    /// end.
    pub fn invert(&mut self, channel: usize) {
        let full_scale = f64::from(self.now.map.full_scale());
        let rows = self.now.map.rows().iter();
        let calibrations: Vec<_> = rows
            .map(|row| {
                if row.channel == channel {
                    AffineMap {
                        gain: -row.calibration.gain,
                        offset: row.calibration.apply(full_scale),
                    }
                } else {
                    row.calibration
                }
            })
            .collect();
        let curvatures = self.now.map.curvatures().iter();
        let curvatures = curvatures.map(|&(own, counts)| {
            if own == channel {
                (own, -counts)
            } else {
                (own, counts)
            }
        });
        let ranges = self.now.map.ranges().iter();
        let ranges = ranges.map(|&(own, (low, high))| {
            if own == channel {
                (own, (full_scale - high, full_scale - low))
            } else {
                (own, (low, high))
            }
        });
        let map = self.now.map.clone().with_calibrations(&calibrations);
        let map = map
            .with_curvatures(curvatures.collect())
            .with_ranges(ranges.collect());
        self.edit(EditKind::Inversion(channel), map);
    }

    /// Sets the range of a channel in counts. The ends are kept within the full scale and in order; `None` removes the range.
    pub fn set_range(&mut self, channel: usize, range: Option<CountRange>) {
        let full_scale = f64::from(self.now.map.full_scale());
        let mut ranges = self.now.map.ranges().to_vec();
        ranges.retain(|(own, _)| *own != channel);
        if let Some((low, high)) = range {
            let low = low.clamp(0.0, full_scale - 1.0);
            ranges.push((channel, (low, high.clamp(low + 1.0, full_scale))));
            ranges.sort_by_key(|(own, _)| *own);
        }
        let map = self.now.map.clone().with_ranges(ranges);
        self.edit(EditKind::Range(channel), map);
    }

    /// Sets all values, as a guided calibration finds them.
    pub fn set_all(&mut self, calibration: Calibration) {
        self.close_edit();
        self.replace(EditKind::All, calibration);
        self.close_edit();
    }

    /// Ends the edit in progress, so that the next edit is undone separately.
    pub fn close_edit(&mut self) {
        self.open = None;
    }

    /// Returns `true` if there is an edit to undo.
    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// Returns `true` if there is an undone edit to repeat.
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Undoes the last edit, also one that was saved.
    pub fn undo(&mut self) {
        self.close_edit();
        if let Some(previous) = self.done.pop() {
            self.undone.push(std::mem::replace(&mut self.now, previous));
        }
    }

    /// Repeats an undone edit.
    pub fn redo(&mut self) {
        self.close_edit();
        if let Some(next) = self.undone.pop() {
            self.done.push(std::mem::replace(&mut self.now, next));
        }
    }

    /// Returns the text of the file with the present calibration. Everything else in it is as it was opened.
    pub fn text(&self) -> Result<String, DocumentError> {
        let rest = if self.now.rest == self.glove.rest_pose {
            JointAngles::default()
        } else {
            self.now.rest
        };
        write_calibration(&self.document, &self.now.map, &rest)
    }

    /// Notes that the present calibration was saved.
    pub fn set_saved(&mut self) {
        self.saved = self.now.clone();
    }

    fn set_calibration(&mut self, kind: EditKind, row: usize, new: AffineMap) {
        let rows = self.now.map.rows().iter();
        let mut calibrations: Vec<_> = rows.map(|it| it.calibration).collect();
        calibrations[row] = new;
        let map = self.now.map.clone().with_calibrations(&calibrations);
        self.edit(kind, map);
    }

    fn edit(&mut self, kind: EditKind, map: ChannelMap) {
        let rest = self.now.rest;
        self.replace(kind, Calibration { map, rest });
    }

    fn replace(&mut self, kind: EditKind, new: Calibration) {
        if new == self.now {
            return;
        }
        let old = std::mem::replace(&mut self.now, new);
        if self.open != Some(kind) {
            self.done.push(old);
        }
        self.open = Some(kind);
        self.undone.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn editor() -> GloveEditor {
        GloveEditor::new(&Document::shipped("unam-hc11").unwrap()).unwrap()
    }

    fn degrees(editor: &GloveEditor, row: usize, count: f64) -> f64 {
        let map = editor.map();
        map.radians(&map.rows()[row], count).to_degrees()
    }

    #[test]
    fn an_edited_gain_and_offset_are_written_and_everything_else_stays() {
        let mut editor = editor();
        assert!(!editor.is_changed());
        // The elbow: 31 counts at 0°, 2.5 rad over the full range.
        let elbow = 4;
        assert_eq!(editor.zero_count(elbow).round(), 31.0);
        editor.set_zero_count(elbow, 40.0);
        editor.set_full_range_deg(elbow, 180.0);
        assert!(degrees(&editor, elbow, 40.0).abs() < 1e-9);
        assert!((degrees(&editor, elbow, 40.0 + 127.5) - 90.0).abs() < 1e-9);
        let expected = editor.document().text.replace(
            "channel: 17, offset_counts: -31.0, full_scale_rad: 2.5,",
            "channel: 17, offset_counts: -40, full_scale_rad: 3.1416,",
        );
        assert_eq!(editor.text().unwrap(), expected);
    }

    #[test]
    fn one_drag_is_undone_at_once_and_a_second_one_on_its_own() {
        let mut editor = editor();
        let original = editor.calibration().clone();
        for count in [32.0, 33.0, 34.0] {
            editor.set_zero_count(4, count);
        }
        editor.close_edit();
        editor.set_zero_count(4, 50.0);
        editor.undo();
        assert_eq!(editor.zero_count(4).round(), 34.0);
        editor.undo();
        assert_eq!(*editor.calibration(), original);
        assert!(!editor.can_undo() && editor.can_redo() && !editor.is_changed());
        assert_eq!(editor.text().unwrap(), editor.document().text);
        editor.redo();
        editor.redo();
        assert_eq!(editor.zero_count(4).round(), 50.0);
        editor.set_saved();
        assert!(!editor.is_changed());
        editor.undo();
        assert!(editor.is_changed(), "the file has the other value");
    }

    #[test]
    fn an_inverted_channel_has_its_angles_at_the_other_end() {
        let mut editor = editor();
        let channel = 60;
        editor.set_range(channel, Some((20.0, 110.0)));
        let map = editor.map().clone().with_curvatures(vec![(channel, 8.0)]);
        editor.edit(EditKind::All, map);
        let rows: Vec<usize> = (0..editor.map().rows().len())
            .filter(|&row| editor.map().rows()[row].channel == channel)
            .collect();
        assert_eq!(rows.len(), 2, "one sensor over two joints");
        let before = degrees(&editor, rows[0], 90.0);
        editor.invert(channel);
        assert!(editor.is_inverted(channel));
        for &row in &rows {
            assert!((degrees(&editor, row, 255.0 - 90.0) - before).abs() < 1e-9);
        }
        assert_eq!(editor.map().range(channel), Some((145.0, 235.0)));
        let text = editor.text().unwrap();
        let read = Glove::parse(&Document::new("own.ron", text)).unwrap().map;
        let angle = read.radians(&read.rows()[rows[0]], 165.0).to_degrees();
        assert!((angle - before).abs() < 0.1, "{angle} instead of {before}");
        editor.invert(channel);
        assert!(!editor.is_inverted(channel));
    }

    #[test]
    fn impossible_values_are_clamped() {
        let mut editor = editor();
        editor.set_full_range_deg(4, 0.0);
        assert!((editor.full_range_deg(4) - MIN_FULL_RANGE_DEG).abs() < 1e-9);
        editor.set_range(17, Some((300.0, -5.0)));
        assert_eq!(editor.map().range(17), Some((254.0, 255.0)));
        assert!(editor.text().is_ok());
    }
}
