//! Layouts with faults, for drawings and editors.

use std::collections::BTreeSet;
use std::ops::Range;

use super::model::Layout;
use crate::contact::TargetId;
use crate::document::{Document, DocumentError, DocumentFault, Node, read_tree};

/// A layout as far as its text could be read, and the faults that prevent its use.
///
/// Controls that overlap, have the name of another one or no action are in the layout. A control without a valid position is not.
#[derive(Clone, Debug)]
pub struct LayoutDraft {
    /// The layout, to be drawn only: with faults, names may not be unique.
    layout: Layout,
    errors: DocumentError,
    faults: Vec<LayoutFault>,
    /// The bytes of the text with the name or key code of each target.
    sources: Vec<Range<usize>>,
}

/// A fault of a layout.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayoutFault {
    /// Message and position.
    pub fault: DocumentFault,
    /// The controls that have it: both of an overlap, none if the fault is not about controls of the layout.
    pub targets: Vec<TargetId>,
}

impl LayoutDraft {
    /// Creates a draft. `known` are faults whose controls are known.
    pub(super) fn new(
        layout: Layout,
        errors: DocumentError,
        known: Vec<(DocumentFault, Vec<TargetId>)>,
        sources: Vec<Range<usize>>,
    ) -> Self {
        let mut draft = Self {
            layout,
            errors,
            faults: Vec::new(),
            sources,
        };
        if !draft.errors.is_none() {
            draft.collect_faults(known);
        }
        draft
    }

    fn collect_faults(&mut self, known: Vec<(DocumentFault, Vec<TargetId>)>) {
        let text = &self.layout.text;
        let tree = read_tree(text);
        let is_known = |fault: &DocumentFault| {
            known.iter().any(|(own, targets)| {
                !targets.is_empty()
                    && own.line() == fault.line()
                    && own.message() == fault.message()
            })
        };
        let others = self.errors.errors().iter().filter(|fault| !is_known(fault));
        let others = others.map(|fault| LayoutFault {
            fault: fault.clone(),
            targets: self.targets_around(fault, tree.as_ref()),
        });
        let mut faults: Vec<LayoutFault> = others.collect();
        let known = known
            .into_iter()
            .filter(|(_, targets)| !targets.is_empty())
            .map(|(fault, targets)| LayoutFault { fault, targets });
        faults.extend(known);
        faults.sort_by_key(|it| (it.fault.line(), it.fault.column()));
        self.faults = faults;
    }

    /// Returns the control whose parentheses or key code are around a fault.
    fn targets_around(&self, fault: &DocumentFault, tree: Option<&Node>) -> Vec<TargetId> {
        let text = &self.layout.text;
        let position = fault.byte_range(text);
        let ids = || (0..).map(TargetId).zip(&self.sources);
        let on_name = ids().find(|(_, source)| source.contains(&position.start));
        if let (Some(_), Some((target, _))) = (fault.line(), on_name) {
            return vec![target];
        }
        let Some(control) = fault
            .line()
            .and(tree)
            .and_then(|tree| control_around(text, tree, position.start))
        else {
            return Vec::new();
        };
        let inside = ids().filter(|(_, source)| control.contains(&source.start));
        inside.map(|(target, _)| target).collect()
    }

    /// Returns the layout, to be drawn and edited. It may be used only if there are no [`faults`](Self::faults).
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the faults, in the order of the file.
    pub fn faults(&self) -> &[LayoutFault] {
        &self.faults
    }

    /// Returns the faults as the error with which the layout is refused, if there are any.
    pub fn error(&self) -> Option<&DocumentError> {
        (!self.errors.is_none()).then_some(&self.errors)
    }

    /// Returns the controls with a fault.
    pub fn faulty(&self) -> BTreeSet<TargetId> {
        let faults = self.faults.iter();
        faults
            .flat_map(|fault| fault.targets.iter().copied())
            .collect()
    }

    /// Returns the bytes of the text with the name or key code of each target, by id.
    pub fn sources(&self) -> &[Range<usize>] {
        &self.sources
    }

    /// Returns the layout, or its faults as an error.
    pub fn into_layout(self) -> Result<Layout, DocumentError> {
        if self.errors.is_none() {
            Ok(self.layout)
        } else {
            Err(self.errors)
        }
    }

    /// Returns the layout and the controls with a fault.
    pub fn into_parts(self) -> (Layout, BTreeSet<TargetId>) {
        let faulty = self.faulty();
        (self.layout, faulty)
    }

    /// Reads a document for the design hand, with its faults; see [`read`](Self::read).
    pub fn from_document(document: &Document) -> Result<Self, DocumentError> {
        Self::read(document, super::Fit::default())
    }
}

/// Returns the bytes of the control of a board around an offset: the item of one of its lists.
fn control_around(text: &str, tree: &Node, offset: usize) -> Option<Range<usize>> {
    let item_around = |node: &Node| {
        let mut items = node.items().iter();
        items
            .find(|item| item.value.range.contains(&offset))
            .map(|item| item.value.clone())
    };
    let boards = tree.in_some(text).field(text, "boards")?;
    let list = item_around(item_around(boards)?.in_some(text))?;
    let is_list = text[list.range.clone()].starts_with('[');
    let control = is_list.then(|| item_around(&list)).flatten()?;
    Some(control.range)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Wearer;

    fn draft(boards: &str) -> LayoutDraft {
        let text = format!("Layout(name: \"a\", boards: [{boards}])");
        LayoutDraft::from_document(&Document::new("a.ron", text)).unwrap()
    }

    fn messages(draft: &LayoutDraft) -> Vec<(&str, Vec<u32>)> {
        let faults = draft.faults().iter();
        faults
            .map(|it| {
                let targets = it.targets.iter().map(|target| target.0).collect();
                (it.fault.message(), targets)
            })
            .collect()
    }

    #[test]
    fn controls_that_overlap_or_share_a_name_are_in_the_layout_with_their_faults() {
        let draft = draft(
            "(pose: (anchor: elbow), keys: [\n\
             (code: \"A\", at_mm: (0, 0)),\n\
             (code: \"B\", at_mm: (10, 0)),\n\
             (code: \"A\", at_mm: (40, 0)),\n\
             (action: NoOp, name: \"idle\", at_mm: (80, 0)),\n\
             (code: \"C\", at_mm: (12, 0))])",
        );
        assert_eq!(draft.layout().keys.len(), 5);
        assert_eq!(
            messages(&draft),
            [
                (
                    "the key `B` overlaps the key `A` of line 2 by 7 mm",
                    vec![1, 0]
                ),
                (
                    "duplicate name `A`: there is a key with this name in line 2, set another `name`",
                    vec![2]
                ),
                (
                    "the key `idle` has no action and takes part in no chord, remove it",
                    vec![3]
                ),
                (
                    "the key `C` overlaps the key `A` of line 2 by 5 mm",
                    vec![4, 0]
                ),
                (
                    "the key `C` overlaps the key `B` of line 3 by 15 mm",
                    vec![4, 1]
                ),
            ]
        );
        assert_eq!(draft.faulty().len(), 5);
        let error = draft.into_layout().unwrap_err();
        assert_eq!(
            error.errors().len(),
            5,
            "all faults are in the error: {error}"
        );
    }

    #[test]
    fn a_control_with_a_wrong_action_or_axis_keeps_its_place() {
        let draft = draft(
            "(pose: (anchor: elbow), keys: [(code: \"Nope\", at_mm: (0, 0))], sliders: [\n\
             (name: \"one\", at_mm: (0, 40), length_mm: 60, output: Axis(\"LeftX\")),\n\
             (name: \"two\", at_mm: (0, 80), length_mm: 60, output: Axis(\"LeftX\")),\n\
             (name: \"three\", at_mm: (0, 120), length_mm: 60, output: Axis(\"Sideways\"))])",
        );
        let targets: Vec<Vec<u32>> = messages(&draft).into_iter().map(|(_, it)| it).collect();
        assert_eq!(targets, [vec![0], vec![2], vec![3]]);
        assert_eq!(draft.layout().keys.len(), 1);
        assert_eq!(draft.layout().controls.len(), 3);
    }

    #[test]
    fn a_face_beyond_its_arc_and_an_empty_board_are_drawn() {
        let draft = draft(
            "(pose: (anchor: elbow), keys: []), (pose: (anchor: elbow), shape: Arc(radius_mm: 60), \
             keys: [(code: \"A\", at_mm: (400, 0))])",
        );
        assert_eq!(draft.layout().boards.len(), 2);
        let faults = messages(&draft);
        assert!(faults[0].0.contains("board 1 has no keys"), "{faults:?}");
        assert!(faults[1].0.contains("beyond the ends"), "{faults:?}");
        assert!(draft.layout().keys[0].face.outline.center.is_finite());
    }

    #[test]
    fn a_picture_has_the_outlines_and_the_list_of_the_faults() {
        let draft = draft(
            "(pose: (anchor: elbow), keys: [(code: \"A\", at_mm: (0, 0)),\n\
             (code: \"B\", at_mm: (10, 0)), (code: \"C\", at_mm: (60, 0))])",
        );
        let wearer = Wearer {
            faults: draft.faults().to_vec(),
            ..Wearer::default()
        };
        let svg = draft.layout().to_svg(&wearer).unwrap();
        assert_eq!(svg.matches("class=\"fault\"").count(), 2, "{svg}");
        assert!(
            svg.contains("overlaps the key `A` of line 1 by 7 mm"),
            "{svg}"
        );
        let clean = draft.layout().to_svg(&Wearer::default()).unwrap();
        assert!(!clean.contains("class=\"fault\"") && !clean.contains("Problems"));
    }

    #[test]
    fn a_shipped_layout_has_no_faults() {
        let document = Document::shipped("media").unwrap();
        let draft = LayoutDraft::from_document(&document).unwrap();
        assert_eq!(draft.faults(), []);
        assert!(draft.error().is_none());
        assert!(draft.into_layout().is_ok());
    }

    #[test]
    fn a_text_that_is_no_layout_is_an_error() {
        let document = Document::new("a.ron", "Layout(name: \"a\", boards: [(");
        assert!(LayoutDraft::from_document(&document).is_err());
    }
}
