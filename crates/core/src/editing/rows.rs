//! Keys of rows as single keys.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::draft::{Draft, written};
use super::error::EditError;
use super::part::{ControlKind, Part, words};
use crate::document::quote;
use crate::layout::quantity::Pitch;

/// Makes single keys of the keys of rows among these parts, and returns the parts by their new indices. A row all of whose
/// keys are among the parts takes their place if `whole_rows` is set.
pub(super) fn take_out(
    draft: &mut Draft,
    parts: &[Part],
    whole_rows: bool,
) -> Result<Vec<Part>, EditError> {
    let mut columns: BTreeMap<(usize, usize), BTreeSet<usize>> = BTreeMap::new();
    for part in parts {
        if let Part::RowKey { board, row, column } = *part {
            columns.entry((board, row)).or_default().insert(column);
        }
    }
    let mut new_parts: BTreeMap<Part, Part> = BTreeMap::new();
    let mut new_keys: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    // By board and row: the rows that the split of a row adds to its board, −1 if the row disappears.
    let mut added_rows: BTreeMap<(usize, usize), isize> = BTreeMap::new();
    for ((board, row), row_columns) in columns {
        let source = SourceRow::read(draft, board, row)?;
        let part = Part::Row { board, row };
        if whole_rows && row_columns.len() == source.words.len() {
            for column in row_columns {
                new_parts.insert(Part::RowKey { board, row, column }, part);
            }
            continue;
        }
        let keys = new_keys.entry(board).or_default();
        let first = draft.count(Part::Board(board), ControlKind::Key.list());
        for &column in &row_columns {
            let key = Part::control(board, ControlKind::Key, first + keys.len());
            new_parts.insert(Part::RowKey { board, row, column }, key);
            keys.push(source.key(column)?);
        }
        let segments = source.split(draft, &row_columns)?;
        added_rows.insert((board, row), segments as isize - 1);
    }
    for (board, keys) in new_keys {
        draft.push(Part::Board(board), ControlKind::Key.list(), &keys)?;
    }
    draft.commit()?;
    let moved = |part: Part| match part {
        Part::Row { board, row } => {
            let before = added_rows.range((board, 0)..(board, row));
            let added: isize = before.map(|(_, added)| added).sum();
            Part::Row {
                board,
                row: row.saturating_add_signed(added),
            }
        }
        other => other,
    };
    let mut result = Vec::new();
    for part in parts {
        let part = moved(new_parts.get(part).copied().unwrap_or(*part));
        if !result.contains(&part) || !matches!(part, Part::Row { .. }) {
            result.push(part);
        }
    }
    Ok(result)
}

/// A row as written.
pub(super) struct SourceRow {
    part: Part,
    at_mm: [f64; 2],
    pitch_mm: f64,
    size_mm: Option<String>,
    /// Key codes as written.
    words: Vec<String>,
}

impl SourceRow {
    pub fn read(draft: &Draft, board: usize, row: usize) -> Result<Self, EditError> {
        let part = Part::Row { board, row };
        draft.node(part)?;
        let error = |field: &str| EditError::Field(field.to_owned());
        let pitch = draft.number(Part::Board(board), "pitch_mm", Pitch::default().get())?;
        let keys = draft.field(part, "keys").ok_or_else(|| error("keys"))?;
        let size = draft.field(part, "size_mm");
        Ok(Self {
            part,
            at_mm: draft
                .numbers(part, "at_mm")?
                .ok_or_else(|| error("at_mm"))?,
            pitch_mm: draft.number(part, "pitch_mm", pitch)?,
            size_mm: size.map(|size| size.text(draft.text()).to_owned()),
            words: words(draft.text(), keys)
                .into_iter()
                .map(|word| draft.text()[word].to_owned())
                .collect(),
        })
    }

    /// Returns the number of its keys.
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// Returns the center of a key.
    pub fn center(&self, column: usize) -> [f64; 2] {
        let [x, y] = self.at_mm;
        [x + self.pitch_mm * column as f64, y]
    }

    /// Returns a single key in place of one of the row.
    fn key(&self, column: usize) -> Result<String, EditError> {
        let code = self.words.get(column).ok_or(EditError::NoPart("key"))?;
        Ok(self.key_with(column, &format!("code: {}", quote(code)), [0.0; 2]))
    }

    /// Returns a single key with these fields for the action, at an offset from one of the row.
    pub fn key_with(&self, column: usize, action: &str, offset: [f64; 2]) -> String {
        let [x, y] = self.center(column);
        let (x, y) = (written(x + offset[0]), written(y + offset[1]));
        let size = self.size_mm.as_ref();
        let size = size.map_or(String::new(), |size| format!(", size_mm: {size}"));
        format!("({action}, at_mm: ({x}, {y}){size})")
    }

    /// Returns the key code at a column.
    pub fn code(&self, column: usize) -> Option<&str> {
        self.words.get(column).map(String::as_str)
    }

    /// Removes columns from the text: what is left becomes one row for each run of columns. Returns their number.
    pub fn split(&self, draft: &mut Draft, columns: &BTreeSet<usize>) -> Result<usize, EditError> {
        let runs = self.runs(columns);
        let (board, list, index) = self.part.place().ok_or(EditError::NoPart("row"))?;
        if runs.is_empty() {
            let list = draft.field(board, list).ok_or(EditError::NoPart("row"))?;
            let list = list.clone();
            draft.remove(&list, index);
            return Ok(0);
        }
        let node = draft.node(self.part)?;
        let (row, text) = (node.range.clone(), draft.text());
        let line = text[..row.start]
            .rfind('\n')
            .map_or(0, |newline| newline + 1);
        let indent = &text[line..row.start];
        let separator = if indent.trim().is_empty() {
            format!(",\n{indent}")
        } else {
            ", ".to_owned()
        };
        let rows: Result<Vec<String>, EditError> = runs
            .iter()
            .map(|run| self.with_columns(draft, run))
            .collect();
        let rows = rows?.join(&separator);
        draft.replace(row, rows);
        Ok(runs.len())
    }

    /// Returns the runs of columns that are not among these.
    fn runs(&self, columns: &BTreeSet<usize>) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for column in (0..self.words.len()).filter(|column| !columns.contains(column)) {
            match runs.last_mut() {
                Some(run) if run.end == column => run.end += 1,
                _ => runs.push(column..column + 1),
            }
        }
        runs
    }

    /// Returns the text of the row with some of its columns.
    fn with_columns(&self, draft: &Draft, columns: &Range<usize>) -> Result<String, EditError> {
        let text = draft.text();
        let row = draft.node(self.part)?.range.clone();
        let keys = draft
            .field(self.part, "keys")
            .ok_or_else(|| EditError::Field("keys".into()))?;
        let words = words(text, keys);
        let mut patch = super::patch::Patch::default();
        let kept = words[columns.start].start..words[columns.end - 1].end;
        let all = words[0].start..words[words.len() - 1].end;
        patch.replace(all.start - row.start..kept.start - row.start, "");
        patch.replace(kept.end - row.start..all.end - row.start, "");
        if columns.start > 0 {
            let x = draft
                .field(self.part, "at_mm.0")
                .ok_or_else(|| EditError::Field("at_mm".into()))?;
            let range = x.range.start - row.start..x.range.end - row.start;
            patch.replace(range, written(self.center(columns.start)[0]));
        }
        let (text, _) = patch.apply(&text[row]).ok_or(EditError::Overlap)?;
        Ok(text)
    }
}
