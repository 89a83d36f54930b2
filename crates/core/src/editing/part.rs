//! The parts of a layout that can be selected and edited, and their positions in the text.

use crate::contact::TargetId;
use crate::document::Node;
use crate::layout::KindSpec;
use crate::layout::controls::{self, with_control_kinds};

/// A part of a layout, by its indices in the file, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// The layout as a whole: `name`, `description`, `chord_timeout_ms`.
    Layout,
    /// A board: its fields and the fields of its `pose`.
    Board(usize),
    /// A row of keys.
    Row {
        /// Index of the board.
        board: usize,
        /// Index in its `rows`.
        row: usize,
    },
    /// A key of a row.
    RowKey {
        /// Index of the board.
        board: usize,
        /// Index of the row.
        row: usize,
        /// Index in the row.
        column: usize,
    },
    /// A key of its own, or another control on a board.
    Control {
        /// Index of the board.
        board: usize,
        /// List that contains it.
        kind: ControlKind,
        /// Index in that list.
        index: usize,
    },
    /// An option of a radio group.
    RadioOption {
        /// Index of the board.
        board: usize,
        /// Index of the group in `radios`.
        radio: usize,
        /// Index of the option.
        option: usize,
    },
    /// A trigger.
    Trigger(usize),
    /// The pointer.
    Pointer,
    /// Targets in space that move as one.
    Space(usize),
    /// A target in space.
    SpaceTarget {
        /// Index of the space.
        space: usize,
        /// Index of the target.
        index: usize,
    },
    /// A layer, from 0: the base layer is not in the file.
    Layer(usize),
    /// A chord.
    Chord(usize),
    /// A sequence, by its index in the map. Its value is the list of its steps.
    Sequence(usize),
}

/// A key, for editors.
const KEY: KindSpec = KindSpec {
    table: "Key",
    name: "key",
    words: ["Key", "Tecla"],
    new: "",
};

/// Declares the kinds of controls.
macro_rules! control_kind {
    ($($kind:ident $list:ident: $module:ident::$schema:ident,)+) => {
        /// The kinds of controls on a board: one list of the board each.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum ControlKind {
            /// Single keys.
            Key,
            $(
                #[doc = concat!("The controls of the list `", stringify!($list), "`.")]
                $kind,
            )+
        }

        impl ControlKind {
            /// All kinds, in the order in which a layout numbers their targets.
            pub const ALL: &[Self] = &[Self::Key, $(Self::$kind),+];

            /// Returns the field of a board that lists them.
            pub const fn list(self) -> &'static str {
                match self {
                    Self::Key => "keys",
                    $(Self::$kind => stringify!($list),)+
                }
            }

            /// Returns the names, the table of fields, and the text of a new control.
            pub const fn spec(self) -> KindSpec {
                match self {
                    Self::Key => KEY,
                    $(Self::$kind => controls::$module::KIND,)+
                }
            }
        }
    };
}
with_control_kinds!(control_kind);

impl ControlKind {
    /// Returns the name in messages.
    pub const fn name(self) -> &'static str {
        self.spec().name
    }
}

impl Part {
    /// Returns the control at an index of the list of its kind on a board.
    pub const fn control(board: usize, kind: ControlKind, index: usize) -> Self {
        Self::Control { board, kind, index }
    }

    /// Returns the index of the board: its own, or of the board that it is on.
    pub const fn board(self) -> Option<usize> {
        match self {
            Self::Board(board)
            | Self::Row { board, .. }
            | Self::RowKey { board, .. }
            | Self::Control { board, .. }
            | Self::RadioOption { board, .. } => Some(board),
            _ => None,
        }
    }

    /// Returns `true` if it is a key, alone or in a row.
    pub const fn is_key(self) -> bool {
        match self {
            Self::RowKey { .. } => true,
            Self::Control { kind, .. } => matches!(kind, ControlKind::Key),
            _ => false,
        }
    }

    /// Returns the name of its kind in messages.
    pub const fn kind_name(self) -> &'static str {
        match self {
            Self::Layout => "layout",
            Self::Board(_) => "board",
            Self::Row { .. } => "row",
            Self::RowKey { .. } => "key",
            Self::Control { kind, .. } => kind.name(),
            Self::RadioOption { .. } => "radio option",
            Self::Trigger(_) => "trigger",
            Self::Pointer => "pointer",
            Self::Space(_) => "space",
            Self::SpaceTarget { .. } => "target",
            Self::Layer(_) => "layer",
            Self::Chord(_) => "chord",
            Self::Sequence(_) => "sequence",
        }
    }

    /// Returns the part that contains it: the board of a control, the row of a key.
    pub fn parent(self) -> Option<Self> {
        match self {
            Self::Layout => None,
            Self::Row { board, .. } | Self::Control { board, .. } => Some(Self::Board(board)),
            Self::RowKey { board, row, .. } => Some(Self::Row { board, row }),
            Self::RadioOption { board, radio, .. } => {
                Some(Self::control(board, ControlKind::Radio, radio))
            }
            Self::SpaceTarget { space, .. } => Some(Self::Space(space)),
            Self::Board(_)
            | Self::Trigger(_)
            | Self::Pointer
            | Self::Space(_)
            | Self::Layer(_)
            | Self::Chord(_)
            | Self::Sequence(_) => Some(Self::Layout),
        }
    }

    /// Returns the list that contains it: the part with that list, its field, and the index in it.
    pub(super) fn place(self) -> Option<(Self, &'static str, usize)> {
        let parent = self.parent()?;
        match self {
            Self::Board(index) => Some((parent, "boards", index)),
            Self::Row { row, .. } => Some((parent, "rows", row)),
            Self::Control { kind, index, .. } => Some((parent, kind.list(), index)),
            Self::RadioOption { option, .. } => Some((parent, "options", option)),
            Self::Trigger(index) => Some((parent, "triggers", index)),
            Self::Space(index) => Some((parent, "spaces", index)),
            Self::SpaceTarget { index, .. } => Some((parent, "targets", index)),
            Self::Layer(index) => Some((parent, "layers", index)),
            Self::Chord(index) => Some((parent, "chords", index)),
            Self::Sequence(index) => Some((parent, "sequences", index)),
            Self::Layout | Self::RowKey { .. } | Self::Pointer => None,
        }
    }

    /// Returns its value in the tree of a layout. A key of a row has the value of the row.
    pub fn node<'t>(self, text: &str, tree: &'t Node) -> Option<&'t Node> {
        match self {
            Self::Layout => return Some(tree.in_some(text)),
            Self::Pointer => return tree.in_some(text).field(text, "pointer"),
            Self::RowKey { .. } => return self.parent()?.node(text, tree),
            _ => {}
        }
        let (parent, list, index) = self.place()?;
        let list = parent.node(text, tree)?.field(text, list)?;
        Some(list.items().get(index)?.value.in_some(text))
    }
}

/// Returns the parts that are targets, in the order of their ids.
pub fn targets(text: &str, tree: &Node) -> Vec<Part> {
    let root = tree.in_some(text);
    let list = |node: &Node, name| node.field(text, name).map_or(0, |list| list.items().len());
    let mut targets = Vec::new();
    for board in 0..list(root, "boards") {
        let Some(node) = Part::Board(board).node(text, tree) else {
            continue;
        };
        for row in 0..list(node, "rows") {
            let codes = Part::Row { board, row }
                .node(text, tree)
                .and_then(|row| row.field(text, "keys")?.string(text))
                .unwrap_or_default();
            let columns = 0..codes.split_whitespace().count();
            targets.extend(columns.map(|column| Part::RowKey { board, row, column }));
        }
        for &kind in ControlKind::ALL {
            for index in 0..list(node, kind.list()) {
                let control = Part::Control { board, kind, index };
                let options = match kind {
                    ControlKind::Radio => control.node(text, tree).map(|it| list(it, "options")),
                    _ => None,
                };
                match options {
                    None => targets.push(control),
                    Some(options) => targets.extend((0..options).map(|option| Part::RadioOption {
                        board,
                        radio: index,
                        option,
                    })),
                }
            }
        }
    }
    targets.extend((0..list(root, "triggers")).map(Part::Trigger));
    targets.extend(root.field(text, "pointer").map(|_| Part::Pointer));
    for space in 0..list(root, "spaces") {
        let node = Part::Space(space).node(text, tree);
        let count = node.map_or(0, |node| list(node, "targets"));
        targets.extend((0..count).map(|index| Part::SpaceTarget { space, index }));
    }
    targets
}

/// Returns the parts of targets, by id. `sources` are the ranges of their names in the text; a part that could not be built has no
/// target.
pub fn parts_of(text: &str, tree: &Node, sources: &[std::ops::Range<usize>]) -> Vec<Part> {
    let all = targets(text, tree);
    if all.len() == sources.len() {
        return all;
    }
    let parts = sources
        .iter()
        .map(|source| part_at(text, tree, source.start));
    parts.collect()
}

/// Returns the innermost part at an offset of the text.
pub fn part_at(text: &str, tree: &Node, offset: usize) -> Part {
    let root = tree.in_some(text);
    let index_in = |node: &Node, name: &str| {
        let list = node.field(text, name)?;
        let holds = |item: &crate::document::Item| {
            let key = item.key.as_ref();
            let is_in_key = key.is_some_and(|key| key.contains(&offset));
            is_in_key || item.value.range.contains(&offset)
        };
        list.items().iter().position(holds)
    };
    if let Some(board) = index_in(root, "boards")
        && let Some(node) = Part::Board(board).node(text, tree)
    {
        if let Some(row) = index_in(node, "rows") {
            return row_part_at(text, tree, board, row, offset);
        }
        for &kind in ControlKind::ALL {
            let Some(index) = index_in(node, kind.list()) else {
                continue;
            };
            let control = Part::Control { board, kind, index };
            let option = control
                .node(text, tree)
                .filter(|_| kind == ControlKind::Radio);
            return match option.and_then(|radio| index_in(radio, "options")) {
                Some(option) => Part::RadioOption {
                    board,
                    radio: index,
                    option,
                },
                None => control,
            };
        }
        return Part::Board(board);
    }
    if let Some(space) = index_in(root, "spaces") {
        let targets = Part::Space(space).node(text, tree);
        let index = targets.and_then(|node| index_in(node, "targets"));
        return index.map_or(Part::Space(space), |index| Part::SpaceTarget {
            space,
            index,
        });
    }
    if let Some(index) = index_in(root, "triggers") {
        return Part::Trigger(index);
    }
    if let Some(index) = index_in(root, "layers") {
        return Part::Layer(index);
    }
    if let Some(index) = index_in(root, "chords") {
        return Part::Chord(index);
    }
    if let Some(index) = index_in(root, "sequences") {
        return Part::Sequence(index);
    }
    let pointer = root.field(text, "pointer");
    if pointer.is_some_and(|node| node.range.contains(&offset)) {
        Part::Pointer
    } else {
        Part::Layout
    }
}

fn row_part_at(text: &str, tree: &Node, board: usize, row: usize, offset: usize) -> Part {
    let part = Part::Row { board, row };
    let keys = part
        .node(text, tree)
        .and_then(|node| node.field(text, "keys"));
    let words = keys.map_or(Vec::new(), |keys| words(text, keys));
    let holds = |word: &std::ops::Range<usize>| word.contains(&offset);
    match words.iter().position(holds) {
        Some(column) => Part::RowKey { board, row, column },
        None => part,
    }
}

/// Returns the ranges of the words of a text in quotes.
pub(super) fn words(text: &str, quoted: &Node) -> Vec<std::ops::Range<usize>> {
    let content = quoted.string(text).unwrap_or_default();
    let offset = |word: &str| crate::document::byte_offset(text, word).unwrap_or_default();
    let range = |word: &str| offset(word)..offset(word) + word.len();
    content.split_whitespace().map(range).collect()
}

/// Returns the part that is a target.
pub fn part_of(targets: &[Part], target: TargetId) -> Option<Part> {
    targets.get(target.0 as usize).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Document, read_tree, shipped_layouts};
    use crate::layout::{Control, Layout};

    #[test]
    fn the_targets_of_the_text_are_those_of_the_layout() {
        for name in shipped_layouts() {
            let text = Document::shipped(name).unwrap().text;
            let tree = read_tree(&text).unwrap();
            let layout = Layout::parse(&text, name).unwrap();
            let parts = targets(&text, &tree);
            // Values of pads, the last ones, are not parts of their own.
            let values = layout.controls.iter().flat_map(Control::value_targets);
            let values = values.filter(|value| layout.control_at(*value).is_none());
            let count = layout.target_names().iter().count() - values.count();
            assert_eq!(parts.len(), count, "{name}");
            for part in parts {
                let node = part.node(&text, &tree).unwrap();
                let offset = match part {
                    Part::RowKey { column, .. } => {
                        words(&text, node.field(&text, "keys").unwrap())[column].start
                    }
                    _ => node.range.start,
                };
                assert_eq!(part_at(&text, &tree, offset), part, "{name}");
            }
        }
    }
}
