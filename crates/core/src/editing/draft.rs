//! A text during an edit: its tree, and the replacements so far.

use std::ops::Range;

use super::error::EditError;
use super::part::{ControlKind, Part};
use super::patch::Patch;
use crate::document::{Item, Node, read_tree, reindented};

/// The outcome of an edit.
#[derive(Clone, Debug, PartialEq)]
pub struct Edited {
    /// Patches, in the order in which they apply. Empty if nothing changes.
    pub patches: Vec<Patch>,
    /// The text after them.
    pub text: String,
    /// The parts that were edited or added, by their indices in the new text.
    pub parts: Vec<Part>,
}

/// A text that is being edited.
pub(super) struct Draft {
    text: String,
    tree: Node,
    /// Patches that are applied.
    patches: Vec<Patch>,
    /// Replacements in `text`, which apply together.
    pending: Patch,
}

impl Draft {
    pub fn new(text: &str) -> Result<Self, EditError> {
        Ok(Self {
            tree: read_tree(text).ok_or(EditError::Unreadable)?,
            text: text.to_owned(),
            patches: Vec::new(),
            pending: Patch::default(),
        })
    }

    /// Returns the text without the pending replacements.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the tree of [`text`](Self::text).
    pub fn tree(&self) -> &Node {
        &self.tree
    }

    /// Returns the value of a part.
    pub fn node(&self, part: Part) -> Result<&Node, EditError> {
        let node = part.node(&self.text, &self.tree);
        node.ok_or(EditError::NoPart(part.kind_name()))
    }

    /// Returns the text of a value without the indentation that its lines share, as [`push`](Self::push) adds it.
    pub fn text_of(&self, node: &Node) -> String {
        let indent = indent_of_line(&self.text, node.range.start);
        reindented(node.text(&self.text), &indent, "")
    }

    /// Returns the value of a field, `pose.tilt_deg`, if it is written.
    pub fn field(&self, part: Part, field: &str) -> Option<&Node> {
        let node = part.node(&self.text, &self.tree)?;
        node.at(&self.text, field.split('.'))
    }

    /// Returns the number of values in a list, 0 if it is not written.
    pub fn count(&self, part: Part, list: &str) -> usize {
        self.field(part, list).map_or(0, |node| node.items().len())
    }

    /// Returns the options of a radio group; `None` for any other part.
    pub fn radio_options(&self, part: Part) -> Option<Vec<Part>> {
        let Part::Control {
            board,
            kind: ControlKind::Radio,
            index: radio,
        } = part
        else {
            return None;
        };
        let options = (0..self.count(part, "options")).map(|option| Part::RadioOption {
            board,
            radio,
            option,
        });
        Some(options.collect())
    }

    /// Returns the number in a field, or `default` if it is not written.
    pub fn number(&self, part: Part, field: &str, default: f64) -> Result<f64, EditError> {
        match self.field(part, field) {
            None => Ok(default),
            Some(node) => {
                let number = node.number(&self.text);
                number.ok_or_else(|| EditError::Field(field.to_owned()))
            }
        }
    }

    /// Returns the numbers in the parentheses of a field, if it is written.
    pub fn numbers<const N: usize>(
        &self,
        part: Part,
        field: &str,
    ) -> Result<Option<[f64; N]>, EditError> {
        let Some(node) = self.field(part, field) else {
            return Ok(None);
        };
        let error = || EditError::Field(field.to_owned());
        let items = node.items().iter();
        let numbers: Option<Vec<f64>> = items.map(|item| item.value.number(&self.text)).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.map(Some).ok_or_else(error)
    }

    /// Replaces bytes of the text.
    pub fn replace(&mut self, range: Range<usize>, text: impl Into<String>) {
        self.pending.replace(range, text);
    }

    /// Replaces a number, unless it has that value already.
    pub fn set_number(
        &mut self,
        part: Part,
        field: &str,
        number: f64,
        default: f64,
    ) -> Result<(), EditError> {
        if written(self.number(part, field, default)?) == written(number) {
            return Ok(());
        }
        self.set(part, field, &written(number))
    }

    /// Replaces those numbers in the parentheses of a field that change, or writes the field.
    pub fn set_numbers<const N: usize>(
        &mut self,
        part: Part,
        field: &str,
        new: [f64; N],
    ) -> Result<(), EditError> {
        let Some(old) = self.numbers::<N>(part, field)? else {
            return self.set(part, field, &format!("({})", new.map(written).join(", ")));
        };
        for (index, (before, after)) in old.into_iter().zip(new).enumerate() {
            if written(before) != written(after) {
                self.set(part, &format!("{field}.{index}"), &written(after))?;
            }
        }
        Ok(())
    }

    /// Writes a field, or a value of a list by its index: in place of its value, or after the last one.
    pub fn set(&mut self, part: Part, field: &str, value: &str) -> Result<(), EditError> {
        if let Some(node) = self.field(part, field) {
            let range = node.range.clone();
            self.replace(range, value);
            return Ok(());
        }
        let error = || EditError::Field(field.to_owned());
        let (group, name) = match field.rsplit_once('.') {
            Some((path, name)) => (self.field(part, path).ok_or_else(error)?, name),
            None => (self.node(part)?, field),
        };
        let new = match group.group.as_ref().map(|group| group.bracket) {
            Some(b'(') => format!("{name}: {value}"),
            // The value after the last one of a list.
            Some(b'[') => value.to_owned(),
            _ => return Err(error()),
        };
        let (range, text) = appended(&self.text, group, &new);
        self.replace(range, text);
        Ok(())
    }

    /// Removes a field, or a value of a list by its index. Does nothing if it is not written.
    pub fn unset(&mut self, part: Part, field: &str) -> Result<(), EditError> {
        let (group, name) = match field.rsplit_once('.') {
            Some((path, name)) => (self.field(part, path), name),
            None => (Some(self.node(part)?), field),
        };
        if let Some(group) = group
            && let Some(index) = match name.parse() {
                Ok(index) => Some(index).filter(|&index| index < group.items().len()),
                Err(_) => group
                    .items()
                    .iter()
                    .position(|item| is_named(&self.text, item, name)),
            }
        {
            let range = removed(&self.text, group, index);
            self.replace(range, "");
        }
        Ok(())
    }

    /// Adds values at the end of a list, a field of `part` that is written if it is missing. All lines of a value are indented.
    pub fn push(&mut self, part: Part, list: &str, values: &[String]) -> Result<(), EditError> {
        if values.is_empty() {
            return Ok(());
        }
        let node = self.node(part)?;
        let Some(node) = node.field(&self.text, list) else {
            let indent = indent_in(&self.text, node);
            let lines = lines(values, &indent);
            return self.set(part, list, &format!("[{lines}]"));
        };
        let indent = indent_in(&self.text, node);
        let (range, text) = if !node.items().is_empty() {
            let separator = separator_in(&self.text, node);
            let values: Vec<String> = values.iter().map(|it| indented(it, &indent)).collect();
            appended(&self.text, node, &values.join(&separator))
        } else if has_line_of_its_own(&self.text, node, list) {
            appended(&self.text, node, &lines(values, &indent))
        } else {
            appended(&self.text, node, &values.join(", "))
        };
        self.replace(range, text);
        Ok(())
    }

    /// Adds an entry at the end of a map.
    pub fn push_entry(&mut self, map: &Node, entry: &str) {
        let (range, text) = appended(&self.text, map, entry);
        self.replace(range, text);
    }

    /// Removes a value of a list or map.
    pub fn remove(&mut self, group: &Node, index: usize) {
        let range = removed(&self.text, group, index);
        self.replace(range, "");
    }

    /// Applies the pending replacements.
    pub fn commit(&mut self) -> Result<(), EditError> {
        if self.pending.is_empty() {
            return Ok(());
        }
        self.pending.merge_deletions();
        let patch = std::mem::take(&mut self.pending);
        let (text, _) = patch.apply(&self.text).ok_or(EditError::Overlap)?;
        self.tree = read_tree(&text).ok_or(EditError::Unreadable)?;
        self.text = text;
        self.patches.push(patch);
        Ok(())
    }

    /// Returns the outcome of the edit.
    pub fn finish(mut self, parts: Vec<Part>) -> Result<Edited, EditError> {
        self.commit()?;
        Ok(Edited {
            patches: self.patches,
            text: self.text,
            parts,
        })
    }
}

/// Returns a number as it is written, with at most two decimals.
pub(super) fn written(number: f64) -> String {
    ((number * 100.0).round() / 100.0 + 0.0).to_string()
}

fn is_named(text: &str, item: &Item, name: &str) -> bool {
    item.key
        .as_ref()
        .is_some_and(|key| &text[key.clone()] == name)
}

/// Returns the offset of an item: of its key if it has one, or else of its value.
fn item_start(item: &Item) -> usize {
    item.key
        .as_ref()
        .map_or(item.value.range.start, |key| key.start)
}

/// Returns the blanks before an offset if nothing else is before it in its line.
fn indent_before(text: &str, offset: usize) -> Option<&str> {
    let line = text[..offset].rfind('\n').map_or(0, |newline| newline + 1);
    let before = &text[line..offset];
    before.trim().is_empty().then_some(before)
}

/// Returns the blanks before the fields of a group.
fn indent_in(text: &str, group: &Node) -> String {
    let first = group.items().first();
    let own = first.and_then(|item| indent_before(text, item_start(item)));
    own.map_or_else(|| indent_of_line(text, group.range.start), str::to_owned)
}

/// Returns the blanks at the start of the line of an offset.
fn indent_of_line(text: &str, offset: usize) -> String {
    let line = text[..offset].rfind('\n').map_or(0, |newline| newline + 1);
    let rest = text[line..].trim_start_matches(' ');
    " ".repeat(text[line..].len() - rest.len())
}

/// Returns the values of a list, each in a line of its own; `indent` is the indentation of the line of the list.
fn lines(values: &[String], indent: &str) -> String {
    let inner = format!("{indent}    ");
    let values = values.iter();
    let lines: String = values
        .map(|value| format!("\n{inner}{},", indented(value, &inner)))
        .collect();
    format!("{lines}\n{indent}")
}

/// Returns a value with all lines except the first one indented.
fn indented(value: &str, indent: &str) -> String {
    reindented(value, "", indent)
}

/// Returns `true` if the line of a list begins with its field.
fn has_line_of_its_own(text: &str, list: &Node, field: &str) -> bool {
    let before = &text[..list.range.start];
    let line = before.rfind('\n').map(|newline| &before[newline..]);
    let line = line.and_then(|line| line.trim().strip_prefix(field));
    line.is_some_and(|rest| rest.trim() == ":")
}

/// Returns the text between two items of a group: a line break if the last item is at the start of a line.
fn separator_in(text: &str, group: &Node) -> String {
    let last = group.items().last();
    match last.and_then(|item| indent_before(text, item_start(item))) {
        Some(indent) => format!(",\n{indent}"),
        None => ", ".to_owned(),
    }
}

/// Returns the replacement that adds an item at the end of a group.
fn appended(text: &str, group: &Node, new: &str) -> (Range<usize>, String) {
    match group.items().last() {
        Some(last) => {
            let end = last.value.range.end;
            (end..end, format!("{}{new}", separator_in(text, group)))
        }
        None => {
            let start = group
                .group
                .as_ref()
                .map_or(group.range.end, |group| group.inside.start);
            (start..start, new.to_owned())
        }
    }
}

/// Returns the bytes to remove for an item of a group: whole lines if nothing else is in them.
fn removed(text: &str, group: &Node, index: usize) -> Range<usize> {
    let items = group.items();
    let item = &items[index];
    let start = item_start(item);
    let end = item.comma.map_or(item.value.range.end, |comma| comma + 1);
    let line_end = text[end..].find('\n').map(|at| end + at + 1);
    if let (Some(indent), Some(line_end)) = (indent_before(text, start), line_end) {
        let after = text[end..line_end].trim();
        if after.is_empty() || after.starts_with("//") {
            return start - indent.len()..line_end;
        }
    }
    match (item.comma, index.checked_sub(1)) {
        (None, Some(before)) => items[before].value.range.end..end,
        _ => {
            let blanks = text[end..].len() - text[end..].trim_start_matches(' ').len();
            start..end + blanks
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "(
    // first
    boards: [
        (a: 1, b: (2.50, 3)), // one
        (
            a: 2, // two
            c: [4],
        ),
    ],
)";

    fn after(change: impl FnOnce(&mut Draft) -> Result<(), EditError>) -> String {
        let mut draft = Draft::new(TEXT).unwrap();
        change(&mut draft).unwrap();
        draft.finish(Vec::new()).unwrap().text
    }

    #[test]
    fn a_field_is_replaced_added_and_removed_in_the_style_around_it() {
        let (one, two) = (Part::Board(0), Part::Board(1));
        assert_eq!(
            after(|draft| draft.set_numbers(one, "b", [2.5, 7.0])),
            TEXT.replace("2.50, 3", "2.50, 7")
        );
        assert_eq!(
            after(|draft| draft.set(one, "d", "x")),
            TEXT.replace("3))", "3), d: x)")
        );
        assert_eq!(
            after(|draft| draft.set(two, "d", "x")),
            TEXT.replace("[4],", "[4],\n            d: x,")
        );
        assert_eq!(
            after(|draft| draft.unset(one, "a")),
            TEXT.replace("a: 1, ", "")
        );
        assert_eq!(
            after(|draft| draft.unset(two, "a")),
            TEXT.replace("            a: 2, // two\n", "")
        );
        assert_eq!(
            after(|draft| draft.unset(one, "b")),
            TEXT.replace(", b: (2.50, 3)", "")
        );
    }

    #[test]
    fn items_of_an_empty_list_get_lines_if_the_list_has_one() {
        let text = "(\n    boards: [],\n    spaces: [(targets: [])],\n)";
        let mut draft = Draft::new(text).unwrap();
        let board = "(\n    a: 1,\n)".to_owned();
        draft.push(Part::Layout, "boards", &[board]).unwrap();
        draft
            .push(Part::Space(0), "targets", &["5".into()])
            .unwrap();
        assert_eq!(
            draft.finish(Vec::new()).unwrap().text,
            "(\n    boards: [\n        (\n            a: 1,\n        ),\n    ],\n    spaces: [(targets: [5])],\n)"
        );
    }

    #[test]
    fn the_lines_of_a_text_in_quotes_are_the_same_in_a_copy() {
        let text =
            "(\n    boards: [\n        (\n            a: \"x\n        y\",\n        ),\n    ],\n)";
        let mut draft = Draft::new(text).unwrap();
        let copy = draft.text_of(draft.node(Part::Board(0)).unwrap());
        assert_eq!(copy, "(\n    a: \"x\n        y\",\n)");
        draft.push(Part::Layout, "boards", &[copy]).unwrap();
        let board = "        (\n            a: \"x\n        y\",\n        ),\n";
        assert_eq!(
            draft.finish(Vec::new()).unwrap().text,
            text.replace(board, &board.repeat(2))
        );
    }

    #[test]
    fn an_item_is_added_and_removed_with_its_lines() {
        assert_eq!(
            after(|draft| draft.push(Part::Layout, "boards", &["()".into()])),
            TEXT.replace("        ),\n    ]", "        ),\n        (),\n    ]")
        );
        assert_eq!(
            after(|draft| draft.push(Part::Board(1), "c", &["5".into(), "6".into()])),
            TEXT.replace("[4]", "[4, 5, 6]")
        );
        assert_eq!(
            after(|draft| {
                let list = draft.field(Part::Layout, "boards").unwrap().clone();
                draft.remove(&list, 0);
                Ok(())
            }),
            TEXT.replace("        (a: 1, b: (2.50, 3)), // one\n", "")
        );
    }
}
