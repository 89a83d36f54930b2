//! Controls and other parts as text, for the clipboard.

use std::collections::{BTreeMap, BTreeSet};

use super::add::add_first_board;
use super::clipboard_parts;
use super::draft::{Draft, written};
use super::duplicate::{Names, copy};
use super::error::EditError;
use super::fields::fields_of;
use super::geometry::without_children;
use super::names::{canonical, signal_names, targets_in};
use super::part::{ControlKind, Part};
use super::rows::SourceRow;
use crate::document::{Node, quote, quoted_content};
use crate::layout::quantity::Size;

/// The maps of a layout with entries about controls by their names.
const MAPS: [&str; 2] = ["labels", "signals"];

/// Returns controls as the text of a board, `(keys: [..], sliders: [..])`, for `paste`, with their labels and signals after them. Each
/// has the size that it has on its board. Without controls, boards, triggers and targets in space are returned as the text of a layout,
/// `(boards: [..], triggers: [..], spaces: [..])`. `None` without any of them among the parts.
pub fn copied(text: &str, parts: &[Part]) -> Option<String> {
    let draft = &Draft::new(text).ok()?;
    let mut lists: BTreeMap<ControlKind, Vec<String>> = BTreeMap::new();
    let row_key = |source: &SourceRow, board: usize, column: usize| -> Option<String> {
        let action = format!("code: {}", quote(source.code(column)?));
        let key = source.key_with(column, &action, [0.0; 2]);
        with_size(draft, board, ControlKind::Key, &key).ok()
    };
    for part in without_children(parts) {
        match part {
            Part::RowKey { board, row, column } => {
                let source = SourceRow::read(draft, board, row).ok()?;
                let key = row_key(&source, board, column)?;
                lists.entry(ControlKind::Key).or_default().push(key);
            }
            Part::Row { board, row } => {
                let source = SourceRow::read(draft, board, row).ok()?;
                for column in 0..source.len() {
                    let key = row_key(&source, board, column)?;
                    lists.entry(ControlKind::Key).or_default().push(key);
                }
            }
            Part::Control { board, kind, .. } => {
                let control_text = draft.node(part).ok()?.text(draft.text());
                let control_text = with_size(draft, board, kind, control_text).ok()?;
                lists.entry(kind).or_default().push(control_text);
            }
            Part::RadioOption { board, .. } => {
                let group = part.parent()?;
                let group_text = draft.node(group).ok()?.text(draft.text());
                let group_text = with_size(draft, board, ControlKind::Radio, group_text).ok()?;
                let groups = lists.entry(ControlKind::Radio).or_default();
                if !groups.contains(&group_text) {
                    groups.push(group_text);
                }
            }
            _ => {}
        }
    }
    let lists = lists.into_iter();
    let mut lists: Vec<(&str, Vec<String>)> =
        lists.map(|(kind, texts)| (kind.list(), texts)).collect();
    if lists.is_empty() {
        lists = clipboard_parts::lists(draft, parts).ok()?;
    }
    let lists: Vec<String> = lists.into_iter().map(in_lines).collect();
    let names = mentioned_names(draft, parts);
    let maps = MAPS.map(|map| entries(draft, map, &names));
    (!lists.is_empty()).then(|| format!("(\n{}{})", lists.concat(), maps.concat()))
}

/// Returns the names of the targets in parts that are copied, and of their values; empty without a map that may have entries for them.
fn mentioned_names(draft: &Draft, parts: &[Part]) -> BTreeSet<String> {
    // The names of 10 000 keys take long.
    let is_mentioned = MAPS.map(|map| draft.field(Part::Layout, map).is_some());
    if !is_mentioned.contains(&true) {
        return BTreeSet::new();
    }
    // An option is copied with its group.
    let whole = parts.iter().map(|part| match part {
        Part::RadioOption { .. } => part.parent().unwrap_or(*part),
        _ => *part,
    });
    let whole: Vec<Part> = whole.collect();
    signal_names(draft, &targets_in(draft, &whole))
}

/// Returns a list as a field in lines of its own.
fn in_lines((list, texts): (&str, Vec<String>)) -> String {
    let texts = texts.join(",\n        ");
    format!("    {list}: [\n        {texts},\n    ],\n")
}

/// Returns the entries of a map of the layout with these names, as a field in a line; empty without any.
fn entries(draft: &Draft, map: &str, names: &BTreeSet<String>) -> String {
    let text = draft.text();
    let node = draft.field(Part::Layout, map);
    let items = node.map_or(&[][..], Node::items).iter();
    let own = items.filter_map(|item| {
        let key = &text[item.key.clone()?];
        let name = quoted_content(key)?;
        let is_own = names.contains(name) || names.contains(&canonical(name));
        is_own.then(|| format!("{key}: {}", item.value.text(text)))
    });
    let own: Vec<String> = own.collect();
    if own.is_empty() {
        String::new()
    } else {
        format!("    {map}: {{{}}},\n", own.join(", "))
    }
}

/// Returns the text of a control of a board with its size, which it may have from the board.
fn with_size(
    draft: &Draft,
    board: usize,
    kind: ControlKind,
    text: &str,
) -> Result<String, EditError> {
    let list = kind.list();
    let mut own = Draft::new(&format!("(boards: [({list}: [{text}])])"))?;
    let size = default_outline(draft, board);
    for part in outlined(&own, kind, 0) {
        if own.field(part, "size_mm").is_none() {
            own.set(part, "size_mm", &size)?;
        }
    }
    own.commit()?;
    let control = Part::control(0, kind, 0);
    let node = own.node(control)?;
    Ok(node.text(own.text()).to_owned())
}

/// Returns the parts of a control of the first board whose outline is the outline of the board by default.
fn outlined(draft: &Draft, kind: ControlKind, index: usize) -> Vec<Part> {
    let board = 0;
    let control = Part::Control { board, kind, index };
    let options = draft.radio_options(control).unwrap_or_default();
    let parts = options.into_iter().chain([control]);
    let is_of_board = |part: &Part| {
        let fields = fields_of(*part);
        let mut sizes = fields.iter().filter(|field| field.name == "size_mm");
        sizes.any(|size| size.default == "as the board")
    };
    parts.filter(is_of_board).collect()
}

/// Returns the outline of the controls of a board that have none of their own, as text.
fn default_outline(draft: &Draft, board: usize) -> String {
    match draft.field(Part::Board(board), "size_mm") {
        Some(outline) => outline.text(draft.text()).to_owned(),
        None => format!("Box({0}, {0})", written(Size::default().get())),
    }
}

/// Adds the parts of a text, under names that are free: controls to a board, others to the layout. Returns them.
pub(super) fn paste(
    draft: &mut Draft,
    board: usize,
    text: &str,
    by_mm: [f64; 2],
) -> Result<Vec<Part>, EditError> {
    let mut names = Names::new(draft);
    let (source, root, new_parts) = match clipboard_parts::source(text) {
        Some(source) => {
            let new_parts = clipboard_parts::paste(draft, &source, &mut names, by_mm)?;
            (source, Part::Layout, new_parts)
        }
        None => {
            let source = source_of_controls(draft, board, text)?;
            let new_parts = paste_controls(draft, &source, &mut names, (board, by_mm))?;
            (source, Part::Board(0), new_parts)
        }
    };
    if new_parts.is_empty() {
        return Err(nothing());
    }
    for map in MAPS {
        let entries = source.field(root, map);
        paste_entries(draft, (&source, entries), &names, map)?;
    }
    draft.commit().map(|()| new_parts)
}

/// Returns the error of a clipboard that has nothing to paste.
fn nothing() -> EditError {
    EditError::Selection("the clipboard has no parts of a layout; copy some first")
}

/// Returns the controls of a text on a board of their own. A size is left out where the board that gets them has the same. A layout
/// without boards gets one.
fn source_of_controls(draft: &mut Draft, board: usize, text: &str) -> Result<Draft, EditError> {
    if !text.trim_start().starts_with('(') {
        return Err(nothing());
    }
    let mut source = Draft::new(&format!("(boards: [{text}])")).map_err(|_| nothing())?;
    add_first_board(draft)?;
    let outline = default_outline(draft, board);
    for &kind in ControlKind::ALL {
        for index in 0..source.count(Part::Board(0), kind.list()) {
            for part in outlined(&source, kind, index) {
                let size = source.field(part, "size_mm");
                if size.is_some_and(|size| is_same(size.text(source.text()), &outline)) {
                    source.unset(part, "size_mm")?;
                }
            }
        }
    }
    source.commit()?;
    Ok(source)
}

/// Adds controls to a board at an offset. Returns them.
fn paste_controls(
    draft: &mut Draft,
    source: &Draft,
    names: &mut Names,
    (board, by_mm): (usize, [f64; 2]),
) -> Result<Vec<Part>, EditError> {
    let mut new_parts = Vec::new();
    for &kind in ControlKind::ALL {
        let first = draft.count(Part::Board(board), kind.list());
        let mut texts = Vec::new();
        for index in 0..source.count(Part::Board(0), kind.list()) {
            let own = Part::control(0, kind, index);
            texts.push(copy(source, names, own, by_mm)?);
            let index = first + index;
            new_parts.push(Part::Control { board, kind, index });
        }
        draft.push(Part::Board(board), kind.list(), &texts)?;
    }
    Ok(new_parts)
}

/// Adds the entries of a map after parts that are pasted, under the names of these, unless the layout has such entries.
fn paste_entries(
    draft: &mut Draft,
    (source, from): (&Draft, Option<&Node>),
    names: &Names,
    map: &str,
) -> Result<(), EditError> {
    let present = draft.field(Part::Layout, map).cloned();
    let mut added = Vec::new();
    for item in from.map_or(&[][..], Node::items) {
        let key = item.key.clone();
        let name = key.and_then(|range| quoted_content(&source.text()[range]));
        let Some(new) = name.and_then(|own| names.new_name(own)) else {
            continue;
        };
        let is_taken = |node: &Node| node.item(draft.text(), new).is_some();
        if !present.as_ref().is_some_and(is_taken) {
            let value = item.value.text(source.text());
            added.push(format!("{}: {value}", quote(new)));
        }
    }
    if added.is_empty() {
        return Ok(());
    }
    let Some(present) = present else {
        return draft.set(Part::Layout, map, &format!("{{{}}}", added.join(", ")));
    };
    if present.items().is_empty() {
        // Without an entry before them, they would have no commas.
        added = vec![added.join(", ")];
    }
    for entry in &added {
        draft.push_entry(&present, entry);
    }
    Ok(())
}

/// Returns `true` if two values differ in their spaces at most.
fn is_same(a: &str, b: &str) -> bool {
    let [a, b] = [a, b].map(|text| text.chars().filter(|c| !c.is_whitespace()));
    a.eq(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Layout;

    const fn control(kind: ControlKind) -> Part {
        Part::control(0, kind, 0)
    }

    /// Copies parts of a board with these fields, and returns the controls that are added to an empty board with others.
    fn carry(from: &str, parts: &[Part], to: &str) -> String {
        let clipboard = copied(&format!("(boards: [({from})])"), parts).unwrap();
        let mut draft = Draft::new(&format!("(boards: [(travel_mm: 3, {to})])")).unwrap();
        paste(&mut draft, 0, &clipboard, [0.0, 0.0]).unwrap();
        let words: Vec<&str> = draft.text().split_whitespace().collect();
        words.join(" ")
    }

    #[test]
    fn a_pasted_control_keeps_the_size_that_it_had() {
        let board = "rows: [(at_mm: (0, 0), keys: \"A\")],
            keys: [(code: \"B\", at_mm: (40, 0))],
            toggles: [(name: \"T\", at_mm: (80, 0))],
            radios: [(name: \"R\", options: [(name: \"one\", at_mm: (120, 0))])],
            knobs: [(name: \"K\", at_mm: (160, 0), diameter_mm: 30)]";
        let parts = [
            Part::RowKey {
                board: 0,
                row: 0,
                column: 0,
            },
            control(ControlKind::Key),
            control(ControlKind::Toggle),
            Part::RadioOption {
                board: 0,
                radio: 0,
                option: 0,
            },
            control(ControlKind::Knob),
        ];
        let wide = format!("size_mm: Box(22, 20), {board}");
        for (from, to, size) in [
            (board, "size_mm: Box(22, 20)", ", size_mm: Box(17, 17)"),
            (&wide, "", ", size_mm: Box(22, 20)"),
            (board, "", ""),
            (&wide, "size_mm: Box( 22,20 )", ""),
        ] {
            let pasted = carry(from, &parts, to);
            for key in [
                format!("(code: \"A\", at_mm: (0, 0){size})"),
                format!("(code: \"B\", at_mm: (40, 0){size})"),
                format!("(name: \"T\", at_mm: (80, 0){size})"),
                format!("(name: \"one\", at_mm: (120, 0){size})"),
                "(name: \"K\", at_mm: (160, 0), diameter_mm: 30)".to_owned(),
            ] {
                assert!(pasted.contains(&key), "{key}: {pasted}");
            }
        }
    }

    #[test]
    fn a_row_is_copied_as_its_keys() {
        let row = Part::Row { board: 0, row: 0 };
        let pasted = carry("rows: [(at_mm: (0, 0), keys: \"A B\")]", &[row], "");
        for key in [
            "(code: \"A\", at_mm: (0, 0))",
            "(code: \"B\", at_mm: (19, 0))",
        ] {
            assert!(pasted.contains(key), "{pasted}");
        }
    }

    #[test]
    fn controls_are_pasted_into_a_layout_without_boards() {
        let from = "(boards: [(keys: [(code: \"A\", at_mm: (0, 0))])])";
        let key = control(ControlKind::Key);
        let clipboard = copied(from, &[key]).unwrap();
        for to in ["Layout(name: \"a\", boards: [])", "Layout(name: \"a\")"] {
            let mut draft = Draft::new(to).unwrap();
            let pasted = paste(&mut draft, 0, &clipboard, [0.0, 0.0]).unwrap();
            assert_eq!(pasted, [key]);
            let layout = Layout::parse(draft.text(), "a.ron");
            let layout = layout.unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(layout.boards.len(), 1, "{}", draft.text());
            let nothing = paste(&mut Draft::new(to).unwrap(), 0, "(keys: [])", [0.0, 0.0]);
            assert!(nothing.is_err());
        }
    }

    #[test]
    fn a_pasted_control_has_the_label_and_the_signals_that_it_had() {
        let from = "(boards: [(
            keys: [(code: \"A\", at_mm: (0, 0))],
            sliders: [(name: \"S\", at_mm: (40, 0), length_mm: 40)],
            xy_pads: [(name: \"P\", at_mm: (90, 0), size_mm: Box(40, 40))],
        )],
        labels: {\"A\": \"x\", \"B\": \"y\"},
        signals: {\"S\": (control: 7), \"P y\": (control: 9), \"B\": (note: 60)})";
        let kinds = [ControlKind::Key, ControlKind::Slider, ControlKind::XyPad];
        let clipboard = copied(from, &kinds.map(control)).unwrap();
        let present = "(boards: [(sliders: [(name: \"S\", at_mm: (0, 0), length_mm: 40)])], \
                       labels: {\"C\": \"z\"}, signals: {\"S\": (control: 1)})";
        for (to, labels, signals) in [
            (
                "(boards: [(travel_mm: 3)])",
                "labels: {\"A\": \"x\"}",
                "signals: {\"S\": (control: 7), \"P y\": (control: 9)}",
            ),
            (
                present,
                "labels: {\"C\": \"z\", \"A\": \"x\"}",
                "signals: {\"S\": (control: 1), \"S 2\": (control: 7), \"P y\": (control: 9)}",
            ),
        ] {
            let mut draft = Draft::new(to).unwrap();
            paste(&mut draft, 0, &clipboard, [0.0, 0.0]).unwrap();
            let pasted = draft.text();
            assert!(pasted.contains(labels), "{labels}: {pasted}");
            assert!(pasted.contains(signals), "{signals}: {pasted}");
        }
    }

    #[test]
    fn controls_that_are_cut_are_pasted_with_all_of_their_labels() {
        let own = "labels: {\"A\": \"x\", \"B\": \"y\"}";
        let boards = "boards: [(rows: [(at_mm: (0, 0), keys: \"A B\")])]";
        let row = Part::Row { board: 0, row: 0 };
        let clipboard = copied(&format!("({boards}, {own})"), &[row]).unwrap();
        // A cut leaves the map without entries.
        let mut draft = Draft::new("(boards: [(travel_mm: 3)], labels: {})").unwrap();
        paste(&mut draft, 0, &clipboard, [0.0, 0.0]).unwrap();
        assert!(draft.text().contains(own), "{}", draft.text());
    }

    #[test]
    fn a_radio_group_has_the_signals_of_all_options_if_one_is_copied() {
        let signals = "signals: {\"one\": (control: 7), \"two\": (control: 8)}";
        let options = "(name: \"one\", at_mm: (0, 0)), (name: \"two\", at_mm: (40, 0))";
        let boards = format!("boards: [(radios: [(name: \"R\", options: [{options}])])]");
        let option = Part::RadioOption {
            board: 0,
            radio: 0,
            option: 1,
        };
        let clipboard = copied(&format!("({boards}, {signals})"), &[option]).unwrap();
        assert!(clipboard.contains(signals), "{clipboard}");
    }

    #[test]
    fn a_size_of_its_own_is_pasted_as_it_is() {
        let key = "keys: [(code: \"A\", at_mm: (0, 0), size_mm: Disc(9))]";
        let pasted = carry(key, &[control(ControlKind::Key)], "size_mm: Box(22, 20)");
        assert!(pasted.contains("(code: \"A\", at_mm: (0, 0), size_mm: Disc(9))"));
    }
}
