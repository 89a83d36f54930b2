//! The layout editor without its view: a text, the edits of it, and what they lead to.
//!
//! The RON text is the truth. An [`Edit`] becomes replacements of parts of the text, so that comments, order and the spelling of
//! numbers stay in everything that is not edited. The loader reads the text after each edit, with its faults: controls may
//! overlap, share a name or have no action while they are edited. Only brackets have to be balanced.
//!
//! ```text
//!  Edit ──▶ edit(text) ──▶ Patch ──▶ text ──▶ loader ──▶ layout with faults, problems
//!                            └──▶ history: undo, redo
//! ```
//!
//! # For a view
//!
//! - [`LayoutEditor::open`] opens a file; a layout that comes with the program is opened as an unsaved copy.
//! - A click on a [`TargetId`] of [`LayoutEditor::layout`] selects [`LayoutEditor::part_of`], and [`Part::board`] tells the
//!   board. [`LayoutEditor::unplaced`] are the controls of the text that are not in
//!   the layout because of an error, as far as their places are written.
//! - [`LayoutEditor::apply`] makes an edit, which is one step of [`undo`](LayoutEditor::undo). While a drag lasts,
//!   [`LayoutEditor::amend`] replaces the last edit by one with the whole distance of the drag, so that a drag is one step.
//!   Both select the parts that were edited or added. An edit that changes nothing is no step.
//!   [`LayoutEditor::after`] tells the problems that an edit would lead to, which is not made.
//! - [`LayoutEditor::value`] is a field as written (`None`: the default), [`FieldSpec`]s of [`fields_of`] are the fields that a
//!   part can have, with units and ranges, for forms. [`Edit::SetField`] sets any of them.
//! - [`LayoutEditor::problems`] lists all errors and warnings with bytes of the text and the part there.
//! - [`LayoutEditor::save`] and [`LayoutEditor::save_as`] write the file; [`LayoutEditor::poll`], a few times a second, reads changes
//!   that other programs made, merges them, or reports a conflict. [`LayoutEditor::start_recovery`] keeps unsaved work.
//! - [`ReachCheck`] adds warnings about controls out of reach of the hands of the session.
//! - [`EditorTrial`] gives the text to the running session while it is edited.
//! - An error of any of these is for the status line: it says what failed, why, and what to do.

mod after;
mod anchor;
mod file;
mod history;
mod problems;
mod reach;
mod recovery;
mod steps;
mod trial;
#[cfg(test)]
mod fault_tests;
#[cfg(test)]
mod file_tests;
#[cfg(test)]
mod random_tests;
#[cfg(test)]
pub(crate) mod tests;

pub use self::anchor::ANCHOR;
pub use self::file::{Change, Conflict, FileState, Resolution, SaveError};
pub use self::problems::{Problem, Severity};
pub use self::reach::ReachCheck;
pub use self::recovery::UnsavedWork;
pub use self::trial::EditorTrial;
pub use ademan_core::editing::{
    AlignEdge, Binding, BoardAxis, ControlKind, Edit, EditError, Edited, FieldSpec, FieldType,
    NewPart, Part, Patch, Place, PlaceTo, Slot, beside, can_turn, edit, fields_of,
    has_parts_in_space,
};

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use self::file::EditedFile;
use self::history::History;
use self::recovery::Recovery;
use ademan_core::contact::TargetId;
use ademan_core::document::{Document, DocumentError, FileKind, Node, quote, read_tree};
use ademan_core::editing;
use ademan_core::layout::{Fit, Layout, LayoutDraft};
use ademan_runtime::files::OpenDocument;

/// The default of a field that its board gives.
const AS_THE_BOARD: &str = "as the board";

/// A layout that is being edited.
pub struct LayoutEditor {
    file: EditedFile,
    text: String,
    fit: Fit,
    /// `None` while brackets are not balanced.
    tree: Option<Node>,
    layout: Option<Arc<Layout>>,
    /// The targets of `layout` in its text.
    layout_targets: Vec<Part>,
    /// `layout` was read from the present text.
    is_read: bool,
    problems: Vec<Problem>,
    /// The parts with an error.
    faulty: BTreeSet<Part>,
    selection: Vec<Part>,
    history: History,
    /// Number of changes of the text.
    revision: u64,
    recovery: Option<Recovery>,
}

impl LayoutEditor {
    /// Opens the layout with a name, as [`Document::open_kind`] finds it, for these hands. One that comes with the program is an unsaved
    /// copy: [`save`](Self::save) fails until [`save_as`](Self::save_as) has given it a file.
    ///
    /// A file that is not a valid layout is opened, too: [`problems`](Self::problems) lists the reasons. One that is empty begins
    /// with a layout without controls, which is not saved.
    pub fn open(name: &str, fit: Fit) -> Result<Self, DocumentError> {
        let document = Document::open_kind(FileKind::Layout, name)?;
        let file = EditedFile::open(&document);
        let text = match document.path.filter(|_| document.text.trim().is_empty()) {
            Some(path) => blank_layout(&path),
            None => document.text,
        };
        Ok(Self::new(file, text, fit))
    }

    /// Edits a new layout without controls, which has no file yet.
    pub fn empty(fit: Fit) -> Self {
        Self::from_text(NEW_LAYOUT, &blank_layout(Path::new(NEW_LAYOUT)), fit)
    }

    /// Edits a text that has no file. `name` stands for it in messages.
    pub fn from_text(name: &str, text: &str, fit: Fit) -> Self {
        let document = Document::new(name, text);
        let file = EditedFile::unsaved(name).with_text(&document.text);
        Self::new(file, document.text, fit)
    }

    fn new(file: EditedFile, text: String, fit: Fit) -> Self {
        let mut editor = Self {
            file,
            text,
            fit,
            tree: None,
            layout: None,
            layout_targets: Vec::new(),
            is_read: false,
            problems: Vec::new(),
            faulty: BTreeSet::new(),
            selection: Vec::new(),
            history: History::default(),
            revision: 0,
            recovery: None,
        };
        editor.read();
        editor
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The name of the file in messages.
    pub fn name(&self) -> &str {
        self.file.name()
    }

    /// The path of the file; `None` for an unsaved copy.
    pub fn path(&self) -> Option<&Path> {
        self.file.path()
    }

    /// The hands that the layout fits.
    pub fn fit(&self) -> Fit {
        self.fit
    }

    /// The layout of the last text that could be read, to be drawn: it may have faults. `None` if there has been none.
    pub fn layout(&self) -> Option<&Arc<Layout>> {
        self.layout.as_ref()
    }

    /// Returns the layout of the present text for the design hand, which has the positions and sizes of the file, if
    /// [`layout`](Self::layout) is for another hand. Its targets have the same ids.
    pub fn design_layout(&self) -> Option<Layout> {
        if !self.is_read || self.fit == Fit::default() {
            return None;
        }
        let document = Document::new(self.file.name(), self.text.as_str());
        let draft = LayoutDraft::read(&document, Fit::default()).ok()?;
        let is_alike = draft.sources().len() == self.layout_targets.len();
        let (layout, _) = draft.into_parts();
        is_alike.then_some(layout)
    }

    /// Returns `true` if [`layout`](Self::layout) was read from the present text.
    pub fn is_read(&self) -> bool {
        self.is_read
    }

    /// Returns `true` if the text can be read as far as its parts: it can be edited.
    pub fn is_editable(&self) -> bool {
        self.tree.is_some()
    }

    /// Returns `true` if a part has an error.
    pub fn is_faulty(&self, part: Part) -> bool {
        self.faulty.contains(&part)
    }

    /// Returns `true` if a session can use the layout: there is no error.
    pub fn is_valid(&self) -> bool {
        !self
            .problems
            .iter()
            .any(|it| it.severity == Severity::Error)
    }

    /// The problems of the text, in its order.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Counts the changes of the text, for views that keep what they computed from it.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The selected parts.
    pub fn selection(&self) -> &[Part] {
        &self.selection
    }

    /// Selects parts. Those that are not in the text are left out.
    pub fn select(&mut self, parts: impl IntoIterator<Item = Part>) {
        let mut selection = Vec::new();
        for part in parts {
            if self.node(part).is_some() && !selection.contains(&part) {
                selection.push(part);
            }
        }
        self.selection = selection;
    }

    /// Returns the part of a target of [`layout`](Self::layout); `None` if the text has other parts by now.
    pub fn part_of(&self, target: TargetId) -> Option<Part> {
        let part = editing::part_of(&self.layout_targets, target)?;
        self.is_read.then_some(part)
    }

    /// Returns the controls of a board that [`layout`](Self::layout) does not have because of an error, with their places as written.
    pub fn unplaced(&self, board: usize) -> Vec<(Part, Place)> {
        let Some(tree) = &self.tree else {
            return Vec::new();
        };
        let placed: BTreeSet<Part> = if self.is_read {
            self.layout_targets.iter().copied().collect()
        } else {
            BTreeSet::new()
        };
        let mut missing = editing::targets(&self.text, tree);
        missing.retain(|part| part.board() == Some(board) && !placed.contains(part));
        editing::places(&self.text, missing)
    }

    /// Returns the part at a byte of the text, such as the byte at the cursor.
    pub fn part_at(&self, offset: usize) -> Option<Part> {
        let tree = self.tree.as_ref()?;
        Some(editing::part_at(&self.text, tree, offset))
    }

    /// Returns the bytes of a part in the text. A key of a row has the bytes of the row.
    pub fn range_of(&self, part: Part) -> Option<std::ops::Range<usize>> {
        Some(self.node(part)?.range.clone())
    }

    /// Returns the range of a field of a part in the text.
    pub fn range_of_value(&self, part: Part, field: &str) -> Option<std::ops::Range<usize>> {
        let node = self.node(part)?.at(&self.text, field.split('.'))?;
        Some(node.range.clone())
    }

    /// Returns a field of a part as written, such as `4.0` or `Box(17, 17)`; `None` if it is not written. `field` is as in
    /// [`Edit::SetField`].
    pub fn value(&self, part: Part, field: &str) -> Option<&str> {
        let node = self.node(part)?.at(&self.text, field.split('.'))?;
        Some(node.text(&self.text))
    }

    /// Returns a [`value`](Self::value) that is written for the part alone: none for a key in a row, whose text is the row.
    pub fn own_value(&self, part: Part, field: &str) -> Option<&str> {
        let value = self.value(part, field);
        value.filter(|_| !matches!(part, Part::RowKey { .. }))
    }

    /// Returns the number in a field; `None` if none is written.
    pub fn number(&self, part: Part, field: &str) -> Option<f64> {
        let node = self.node(part)?.at(&self.text, field.split('.'))?;
        node.number(&self.text)
    }

    /// Returns the value of a field that is not written: of the board for one that is as the board, else as its description gives it.
    pub fn default_of(&self, part: Part, field: &FieldSpec) -> String {
        let board = part.board().map(Part::Board);
        let board = board.filter(|_| field.default == AS_THE_BOARD);
        let Some(board) = board else {
            return field.default.to_owned();
        };
        if let Some(written) = self.value(board, field.name) {
            return written.to_owned();
        }
        let of_board = fields_of(board);
        let own = of_board.iter().find(|own| own.name == field.name);
        own.map_or(field.default, |own| own.default).to_owned()
    }

    /// Returns the name of a part in layers, chords and messages, if it has one.
    pub fn part_name(&self, part: Part) -> Option<String> {
        editing::name_of(&self.text, self.tree.as_ref()?, part)
    }

    /// Returns the selected parts as text, for the clipboard and [`Edit::Paste`]: controls, or boards, triggers and targets in space.
    /// `None` without any of them.
    pub fn copied(&self) -> Option<String> {
        editing::copied(&self.text, &self.selection)
    }

    /// Returns the number of parts in a list of the layout: `boards`, `layers`, `chords`, `triggers`, `spaces` or `sequences`.
    pub fn count(&self, list: &str) -> usize {
        let list = self
            .node(Part::Layout)
            .and_then(|layout| layout.field(&self.text, list));
        list.map_or(0, |list| list.items().len())
    }

    /// Returns the names of the selected keys.
    pub fn selected_keys(&self) -> Vec<String> {
        let keys = self.selection().iter().filter(|part| part.is_key());
        keys.filter_map(|key| self.part_name(*key)).collect()
    }

    /// Returns the centers of the targets of a space, in millimetres.
    pub fn targets_in(&self, space: usize) -> Vec<[f64; 3]> {
        let center = |index| {
            let node = self.node(Part::SpaceTarget { space, index })?;
            let at = node
                .field(self.text(), "at_mm")
                .map_or(&[][..], |at| at.items());
            let number = |axis: usize| at.get(axis)?.value.number(self.text());
            let axes = [0, 1, 2];
            Some(axes.map(|axis| number(axis).unwrap_or_default()))
        };
        (0..).map_while(center).collect()
    }

    fn node(&self, part: Part) -> Option<&Node> {
        part.node(&self.text, self.tree.as_ref()?)
    }

    /// Reads the present text.
    fn read(&mut self) {
        self.revision += 1;
        self.update_recovery();
        self.tree = read_tree(&self.text);
        let (text, tree) = (&self.text, self.tree.as_ref());
        let document = Document::new(self.file.name(), text.as_str());
        match LayoutDraft::read(&document, self.fit) {
            Ok(draft) => {
                let parts = tree.map(|tree| editing::parts_of(text, tree, draft.sources()));
                let parts = parts.unwrap_or_default();
                self.problems = problems::of_draft(&draft, &parts, text, tree);
                let (layout, faulty) = draft.into_parts();
                let faulty = faulty.iter();
                self.faulty = faulty
                    .filter_map(|target| editing::part_of(&parts, *target))
                    .collect();
                self.layout = Some(Arc::new(layout));
                self.layout_targets = parts;
                self.is_read = true;
            }
            Err(error) => {
                self.problems = problems::of_error(&error, text, tree);
                self.faulty = BTreeSet::new();
                self.is_read = false;
            }
        }
        let errors = self.problems.iter();
        let errors = errors.filter(|problem| problem.severity == Severity::Error);
        self.faulty
            .extend(errors.filter_map(|problem| problem.part));
    }
}

/// Name of the file of a new layout.
const NEW_LAYOUT: &str = "new-layout.ron";

/// Returns a layout without controls whose name is made of the name of its file.
fn blank_layout(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let words = stem.split(|letter: char| !letter.is_alphanumeric());
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    let mut letters = words.join(" ");
    if let Some(first) = letters.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    format!(
        "Layout(\n    name: {},\n    boards: [],\n)\n",
        quote(&letters)
    )
}
