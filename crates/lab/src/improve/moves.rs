//! The freedoms of a layout: what a search may change, and the text with the changes.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::contact::TargetId;
use crate::device::{KeyAction, KeyCode};
use crate::document::{Document, DocumentError, Node, quoted_content, read_tree};
use crate::editing::{ControlKind, Edit, EditError, Part, Patch, edit, parts_of};
use crate::layout::{Layout, LayoutDraft};
use crate::message::escape;
use crate::names::named_enum;
use crate::people::Draw;

named_enum! {
    /// The properties that a search changes.
    pub enum MoveKind ("move") {
        /// Poses of boards, and positions of rows and controls on them.
        Positions = "positions",
        /// Scales and pitches of boards, and sizes of controls.
        Sizes = "sizes",
        /// The keys of letters; of digits if the phrases have no letters.
        Assignment = "assignment",
    }
}

/// The word that keeps the poses of all boards.
const BOARDS: &str = "boards";
/// The first steps, in millimetres or degrees.
const BOARD_STEP: f64 = 12.0;
const PART_STEP: f64 = 3.0;
const TURN_STEP: f64 = 5.0;
const SIZE_STEP: f64 = 1.5;
const SCALE_STEP: f64 = 0.06;
/// The smallest step, as a part of the first one.
const SMALLEST: f64 = 0.1;

/// A number that may change.
#[derive(Clone, Debug, PartialEq)]
struct Freedom {
    part: Part,
    change: Change,
    step: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    /// Along an axis of the board, or of the world for a board.
    Shift(usize),
    Turn,
    Tilt,
    /// Width or depth.
    Size(usize),
    /// A field of a board with a number.
    Number(&'static str, f64),
    /// Width or depth of the keys of a board without a size of their own.
    Outline(usize, [f64; 2]),
}

/// The word of a key code in the text.
#[derive(Clone, Debug, PartialEq)]
struct Slot {
    range: Range<usize>,
    /// The frequency of its character in the phrases.
    uses: f64,
}

/// Everything that a search may change of a layout.
#[derive(Clone, Debug)]
pub struct Moves {
    text: String,
    freedoms: Vec<Freedom>,
    slots: Vec<Slot>,
}

/// Changes of a layout, and the next steps.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    offsets: Vec<f64>,
    steps: Vec<f64>,
    /// The index of the word in each slot.
    order: Vec<usize>,
}

impl State {
    /// Takes over the lengths of the next steps.
    pub(super) fn keep_steps(&mut self, from: &Self) {
        self.steps.clone_from(&from.steps);
    }
}

/// A part of a state that is changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// A number.
    Number(usize),
    /// The words of slots.
    Swap,
}

/// Reason why nothing of a layout can be changed.
#[derive(Debug, thiserror::Error)]
pub enum NoMoves {
    /// The layout cannot be read.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// A name of a control that the layout does not have.
    #[error("nothing is named `{}`; `ademan layout show` names the controls, and `boards` keeps the poses of all boards", escape(.0))]
    Name(String),
    /// Nothing is left.
    #[error("the layout has no {0} that may change{1}")]
    Nothing(&'static str, &'static str),
}

impl Moves {
    /// Finds what may change, without the controls that are kept. A kept control stays where it is on its board, keeps its size and
    /// its key.
    pub fn new(
        document: &Document,
        kinds: &[MoveKind],
        keep: &[String],
        phrases: &[String],
    ) -> Result<Self, NoMoves> {
        let draft = LayoutDraft::from_document(document)?;
        let sources = draft.sources().to_vec();
        let layout = draft.into_layout()?;
        let text = document.text.clone();
        let tree = read_tree(&text).ok_or(NoMoves::Nothing("parts", ""))?;
        let parts = parts_of(&text, &tree, &sources);
        let keeps_boards = keep.iter().any(|name| name == BOARDS);
        let mut kept = BTreeSet::new();
        for name in keep.iter().filter(|name| *name != BOARDS) {
            let target = layout.target_names().find(name);
            kept.insert(target.ok_or_else(|| NoMoves::Name(name.clone()))?);
        }
        let finder = Finder {
            text: &text,
            tree: &tree,
            layout: &layout,
            parts: &parts,
            kept: &kept,
            keeps_boards,
        };
        let (mut freedoms, mut slots) = (Vec::new(), Vec::new());
        let is_first = |(index, kind): &(usize, &MoveKind)| !kinds[..*index].contains(kind);
        for (_, kind) in kinds.iter().enumerate().filter(is_first) {
            let before = freedoms.len() + slots.len();
            match kind {
                MoveKind::Positions => finder.positions(&mut freedoms),
                MoveKind::Sizes => finder.sizes(&mut freedoms),
                MoveKind::Assignment => slots = finder.slots(&sources, phrases),
            }
            let count = freedoms.len() + slots.len() - before;
            let is_enough = count > usize::from(*kind == MoveKind::Assignment);
            if !is_enough {
                let why = match kind {
                    MoveKind::Assignment => {
                        "; it needs two keys or chords of letters that are not kept"
                    }
                    _ => "; fingers that bend need no place, and what is kept stays",
                };
                return Err(NoMoves::Nothing(kind.name(), why));
            }
        }
        Ok(Self {
            text,
            freedoms,
            slots,
        })
    }

    /// Returns the number of numbers, and of keys, that may change.
    pub fn count(&self) -> (usize, usize) {
        (self.freedoms.len(), self.slots.len())
    }

    /// Returns the original.
    pub fn start(&self) -> State {
        State {
            offsets: vec![0.0; self.freedoms.len()],
            steps: self.freedoms.iter().map(|it| it.step).collect(),
            order: (0..self.slots.len()).collect(),
        }
    }

    /// Returns a state beside another one.
    pub(super) fn propose(&self, from: &State, draw: &mut Draw) -> (State, Step) {
        let mut state = from.clone();
        let numbers = self.freedoms.len();
        let is_swap = match (numbers, self.slots.len()) {
            (0, _) => true,
            (_, 0) => false,
            _ => draw.happens(0.5),
        };
        if !is_swap {
            let index = draw.index(numbers);
            state.offsets[index] += state.steps[index];
            return (state, Step::Number(index));
        }
        // Frequent characters matter more. One swap in four is of three keys, which leaves local optima.
        let first = self.frequent(&state, draw);
        let mut other = || loop {
            let other = draw.index(self.slots.len());
            if other != first {
                return other;
            }
        };
        let (second, third) = (other(), other());
        state.order.swap(first, second);
        if third != second && draw.happens(0.25) {
            state.order.swap(second, third);
        }
        (state, Step::Swap)
    }

    fn frequent(&self, state: &State, draw: &mut Draw) -> usize {
        let weight = |slot: &usize| 1.0 + self.slots[*slot].uses;
        let all: f64 = state.order.iter().map(weight).sum();
        let mut left = draw.between(0.0, all);
        for (index, word) in state.order.iter().enumerate() {
            left -= weight(word);
            if left <= 0.0 {
                return index;
            }
        }
        state.order.len() - 1
    }

    /// Learns from a step: a good one is longer next time, and after a bad one the next is back and shorter.
    pub(super) fn learn(&self, state: &mut State, step: Step, is_good: bool) {
        let Step::Number(index) = step else { return };
        let smallest = self.freedoms[index].step * SMALLEST;
        let own = &mut state.steps[index];
        let length = if is_good {
            own.abs() * 1.4
        } else {
            own.abs() * 0.75
        };
        let direction = if is_good { own.signum() } else { -own.signum() };
        *own = direction * length.max(smallest);
    }

    /// Returns the text of a state. Everything that does not change keeps its spelling and its comments.
    pub fn text(&self, state: &State) -> Result<String, EditError> {
        let mut patch = Patch::default();
        for (slot, &word) in self.slots.iter().zip(&state.order) {
            let own = &self.text[slot.range.clone()];
            let new = &self.text[self.slots[word].range.clone()];
            if own != new {
                patch.replace(slot.range.clone(), new);
            }
        }
        let mut text = edit(&self.text, &Edit::ReplaceText(patch))?.text;
        let mut outlines: Vec<(Part, [f64; 2])> = Vec::new();
        for (freedom, &offset) in self.freedoms.iter().zip(&state.offsets) {
            let parts = vec![freedom.part];
            let offset = rounded(offset, freedom.change);
            if offset == 0.0 {
                continue;
            }
            let change = match freedom.change {
                Change::Shift(axis) => {
                    let mut by_mm = [0.0; 3];
                    by_mm[axis] = offset;
                    Edit::Move { parts, by_mm }
                }
                Change::Turn => Edit::Turn {
                    parts,
                    degrees: offset,
                },
                Change::Tilt => Edit::Tilt {
                    parts,
                    degrees: offset,
                },
                Change::Size(axis) => {
                    let mut by_mm = [0.0; 2];
                    by_mm[axis] = offset;
                    Edit::Resize {
                        parts,
                        by_mm,
                        fixed: [0.0; 2],
                    }
                }
                Change::Number(field, old) => Edit::SetField {
                    parts,
                    field: field.to_owned(),
                    value: Some(short(old + offset)),
                },
                Change::Outline(axis, size) => {
                    let known = outlines.iter().position(|(part, _)| *part == freedom.part);
                    let known = known.unwrap_or_else(|| {
                        outlines.push((freedom.part, size));
                        outlines.len() - 1
                    });
                    outlines[known].1[axis] += offset;
                    let [width, depth] = outlines[known].1;
                    Edit::SetField {
                        parts,
                        field: "size_mm".to_owned(),
                        value: Some(format!("Box({}, {})", short(width), short(depth))),
                    }
                }
            };
            text = edit(&text, &change)?.text;
        }
        Ok(text)
    }

    /// Returns how many numbers and keys of a state differ from the original.
    pub fn changes(&self, state: &State) -> (usize, usize) {
        let offsets = self.freedoms.iter().zip(&state.offsets);
        let numbers = offsets.filter(|(it, offset)| rounded(**offset, it.change) != 0.0);
        let keys = state.order.iter().enumerate();
        let keys = keys.filter(|(slot, word)| slot != *word);
        (numbers.count(), keys.count())
    }
}

fn rounded(offset: f64, change: Change) -> f64 {
    let unit = match change {
        Change::Number("pose.scale", _) => 0.01,
        _ => 0.1,
    };
    (offset / unit).round() * unit
}

/// Writes a number with two decimals at most.
fn short(number: f64) -> String {
    ((number * 100.0).round() / 100.0).to_string()
}

struct Finder<'a> {
    text: &'a str,
    tree: &'a Node,
    layout: &'a Layout,
    parts: &'a [Part],
    kept: &'a BTreeSet<TargetId>,
    keeps_boards: bool,
}

impl Finder<'_> {
    fn kept_parts(&self) -> impl Iterator<Item = &Part> {
        let kept = self.kept.iter();
        kept.filter_map(move |target| self.parts.get(target.0 as usize))
    }

    fn is_kept(&self, part: Part) -> bool {
        let mut kept = self.kept_parts();
        kept.any(|own| *own == part || own.parent() == Some(part))
    }

    fn has_kept(&self, board: usize) -> bool {
        self.kept_parts().any(|own| own.board() == Some(board))
    }

    fn is_touched(&self, board: usize) -> bool {
        let surface = self.layout.scene.surfaces().get(board);
        surface.is_some_and(|surface| {
            let mut targets = surface.targets();
            targets.any(|(target, _)| surface.bent_by(target).is_none())
        })
    }

    /// Returns rows and controls of boards that fingertips touch.
    fn on_boards(&self) -> Vec<Part> {
        let own = |part: &Part| match *part {
            Part::RowKey { board, row, .. } => Some(Part::Row { board, row }),
            Part::RadioOption { board, radio, .. } => {
                Some(Part::control(board, ControlKind::Radio, radio))
            }
            Part::Control { .. } => Some(*part),
            _ => None,
        };
        let parts: BTreeSet<Part> = self.parts.iter().filter_map(own).collect();
        let is_free = |part: &Part| {
            !self.is_kept(*part) && part.board().is_some_and(|board| self.is_touched(board))
        };
        parts.into_iter().filter(is_free).collect()
    }

    fn positions(&self, freedoms: &mut Vec<Freedom>) {
        let mut add = |part, change, step| freedoms.push(Freedom { part, change, step });
        for board in 0..self.layout.boards.len() {
            if self.keeps_boards || !self.is_touched(board) {
                continue;
            }
            for axis in 0..3 {
                add(Part::Board(board), Change::Shift(axis), BOARD_STEP);
            }
            add(Part::Board(board), Change::Turn, TURN_STEP);
            add(Part::Board(board), Change::Tilt, TURN_STEP);
        }
        for part in self.on_boards() {
            for axis in 0..2 {
                add(part, Change::Shift(axis), PART_STEP);
            }
        }
    }

    fn sizes(&self, freedoms: &mut Vec<Freedom>) {
        let mut add = |part, change, step| freedoms.push(Freedom { part, change, step });
        for index in 0..self.layout.boards.len() {
            let part = Part::Board(index);
            let node = part.node(self.text, self.tree);
            let Some(node) = node.filter(|_| self.is_touched(index) && !self.has_kept(index))
            else {
                continue;
            };
            let number = |field: &str| {
                let value = node.at(self.text, field.split('.'))?;
                value.number(self.text)
            };
            let scale = number("pose.scale").unwrap_or(1.0);
            add(part, Change::Number("pose.scale", scale), SCALE_STEP);
            if node.field(self.text, "rows").is_some() {
                let own = f64::from(self.layout.boards[index].pitch) * 1e3 / scale;
                let pitch = number("pitch_mm").unwrap_or(own);
                add(part, Change::Number("pitch_mm", pitch), SIZE_STEP);
            }
            let size = node.field(self.text, "size_mm");
            let sides = size.filter(|size| size.name(self.text) == Some("Box"));
            let side = |axis: usize| sides?.items().get(axis)?.value.number(self.text);
            if let Some(extent) = side(0).zip(side(1)) {
                for axis in 0..2 {
                    add(part, Change::Outline(axis, extent.into()), SIZE_STEP);
                }
            }
        }
        for part in self.on_boards() {
            let node = part.node(self.text, self.tree);
            let has = |field: &str| node.is_some_and(|it| it.field(self.text, field).is_some());
            match part {
                Part::Row { .. } => {}
                // A key without a size has the size of its board.
                Part::Control {
                    kind: ControlKind::Key,
                    ..
                } if !has("size_mm") => {}
                Part::Control {
                    kind: ControlKind::Radio,
                    ..
                } => {}
                _ => {
                    let sides = if has("diameter_mm") { 1 } else { 2 };
                    for axis in 0..sides {
                        add(part, Change::Size(axis), PART_STEP);
                    }
                }
            }
        }
    }

    /// Returns the words of key codes that may be exchanged.
    fn slots(&self, sources: &[Range<usize>], phrases: &[String]) -> Vec<Slot> {
        let all: String = phrases.concat().to_lowercase();
        let characters: Vec<char> = if all.chars().any(char::is_alphabetic) {
            ('a'..='z').collect()
        } else {
            ('0'..='9').collect()
        };
        let character = |code: KeyCode| {
            let mut candidates = characters.iter().copied();
            candidates.find(|it| KeyCode::for_us_character(*it).any(|(own, _)| own == code))
        };
        let slot = |range: Range<usize>, code: KeyCode| {
            let character = character(code)?;
            let uses = all.chars().filter(|it| *it == character).count() as f64;
            Some(Slot { range, uses })
        };
        let mut slots = Vec::new();
        for key in &self.layout.keys {
            let target = key.face.target;
            let Some(Some(KeyAction::Key(code))) = key.actions.first() else {
                continue;
            };
            let source = sources.get(target.0 as usize);
            let Some(source) = source.filter(|_| !self.kept.contains(&target)) else {
                continue;
            };
            // A key with a name of its own has the name there.
            if self.text[source.clone()].parse() == Ok(*code) {
                slots.extend(slot(source.clone(), *code));
            }
        }
        for chord in 0..self.layout.chords.len() {
            let node = Part::Chord(chord).node(self.text, self.tree);
            let word = node.and_then(|node| node.at(self.text, ["action", "0"]));
            let word = word.and_then(|word| {
                let content = quoted_content(&self.text[word.range.clone()])?;
                let code = content.parse().ok()?;
                let start = word.range.start + self.text[word.range.clone()].find(content)?;
                slot(start..start + content.len(), code)
            });
            slots.extend(word);
        }
        slots
    }
}
