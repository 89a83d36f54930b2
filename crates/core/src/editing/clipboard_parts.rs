//! Boards, triggers and targets in space as text, for the clipboard.

use std::collections::BTreeMap;

use super::draft::Draft;
use super::duplicate::{Names, check_bent, copied_board, copy};
use super::error::EditError;
use super::geometry::without_children;
use super::part::Part;
use crate::document::reindented;

/// Creates the part with an index in its list.
type PartAt = fn(usize) -> Part;

/// The lists of a layout with such parts.
const LISTS: [(&str, PartAt); 3] = [
    ("boards", Part::Board),
    ("triggers", Part::Trigger),
    ("spaces", Part::Space),
];

/// Returns `true` if a text that [`copied`](super::copied) has made has boards, triggers or targets in space in place of controls.
pub fn has_parts_in_space(text: &str) -> bool {
    source(text).is_some()
}

/// Returns the text of a clipboard if it has such parts.
pub(super) fn source(text: &str) -> Option<Draft> {
    let source = Draft::new(text).ok()?;
    let mut lists = LISTS.iter();
    let has_parts = lists.any(|(list, _)| source.count(Part::Layout, list) > 0);
    has_parts.then_some(source)
}

/// Returns the boards, triggers and targets in space among parts, in lists as a layout has them. A space has only those of its
/// targets that are among the parts.
pub(super) fn lists(
    draft: &Draft,
    parts: &[Part],
) -> Result<Vec<(&'static str, Vec<String>)>, EditError> {
    let (mut boards, mut triggers) = (Vec::new(), Vec::new());
    let mut targets: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for part in without_children(parts) {
        match part {
            Part::Board(_) => boards.push(draft.text_of(draft.node(part)?)),
            Part::Trigger(_) => triggers.push(draft.text_of(draft.node(part)?)),
            Part::Space(space) => {
                targets.insert(space, (0..draft.count(part, "targets")).collect());
            }
            Part::SpaceTarget { space, index } => targets.entry(space).or_default().push(index),
            _ => {}
        }
    }
    let mut spaces = Vec::new();
    for (space, own) in targets {
        spaces.push(space_with(draft, space, &own)?);
    }
    let lists = [
        ("boards", boards),
        ("triggers", triggers),
        ("spaces", spaces),
    ];
    let filled = lists.into_iter().filter(|(_, texts)| !texts.is_empty());
    let indented = |text: String| reindented(&text, "", "        ");
    let filled = filled.map(|(list, texts)| (list, texts.into_iter().map(indented).collect()));
    Ok(filled.collect())
}

/// Returns the text of a space with some of its targets.
fn space_with(draft: &Draft, space: usize, targets: &[usize]) -> Result<String, EditError> {
    let (mut own, part) = draft_of_space(draft, space)?;
    for index in 0..own.count(part, "targets") {
        if !targets.contains(&index) {
            own.unset(part, &format!("targets.{index}"))?;
        }
    }
    own.commit()?;
    Ok(own.node(part)?.text(own.text()).to_owned())
}

/// Returns a layout with a copy of a space alone, and the part that the copy is there.
fn draft_of_space(draft: &Draft, space: usize) -> Result<(Draft, Part), EditError> {
    let text = draft.text_of(draft.node(Part::Space(space))?);
    let own = Draft::new(&format!("(spaces: [{text}])"))?;
    Ok((own, Part::Space(0)))
}

/// Adds the parts of the text of a clipboard, under names that are free. Returns them.
pub(super) fn paste(
    draft: &mut Draft,
    source: &Draft,
    names: &mut Names,
    by_mm: [f64; 2],
) -> Result<Vec<Part>, EditError> {
    let mut new_parts = Vec::new();
    for (list, part) in LISTS {
        let first = draft.count(Part::Layout, list);
        let mut texts = Vec::new();
        for index in 0..source.count(Part::Layout, list) {
            let (own, new) = (part(index), first + index);
            texts.push(match own {
                Part::Board(board) => {
                    check_bent(draft, source, board)?;
                    copied_board(source, names, board, by_mm)?
                }
                Part::Space(space) => copied_space(source, names, space, by_mm)?,
                _ => copy(source, names, own, by_mm)?,
            });
            if let Part::Space(_) = own {
                // A plan selects targets, not their space.
                let targets = 0..source.count(own, "targets");
                let target_at = |target| Part::SpaceTarget {
                    space: new,
                    index: target,
                };
                new_parts.extend(targets.map(target_at));
            } else {
                new_parts.push(part(new));
            }
        }
        draft.push(Part::Layout, list, &texts)?;
    }
    Ok(new_parts)
}

/// Returns the text of a space whose targets have new names, at an offset.
fn copied_space(
    source: &Draft,
    names: &mut Names,
    space: usize,
    by_mm: [f64; 2],
) -> Result<String, EditError> {
    let (mut own, part) = draft_of_space(source, space)?;
    for index in 0..own.count(part, "targets") {
        let target = Part::SpaceTarget { space: 0, index };
        let text = copy(&own, names, target, by_mm)?;
        let range = own.node(target)?.range.clone();
        own.replace(range, text);
    }
    own.commit()?;
    Ok(own.node(part)?.text(own.text()).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editing::{Edit, Edited, copied, edit};
    use crate::layout::Layout;

    const LAYOUT: &str = "Layout(
    name: \"a\",
    boards: [
        (
            pose: (anchor: elbow, forward_mm: 320),
            rows: [(at_mm: (0, 0), keys: \"A B\")],
        ),
    ],
    triggers: [(name: \"Pinch\", when: Pinch(finger: \"index\"))],
    spaces: [
        (
            pose: (anchor: elbow),
            targets: [
                (name: \"Moon\", at_mm: (120, 0, -300), shape: Ball(50)),
                (name: \"Earth\", at_mm: (200, 0, -270), shape: Ball(70)),
            ],
        ),
    ],
    labels: {\"A\": \"x\", \"B\": \"y\"},
)
";

    const EARTH: Part = Part::SpaceTarget { space: 0, index: 1 };

    /// Copies a board, a trigger and a target, and adds them to another layout.
    fn carry(to: &str) -> Edited {
        let parts = [Part::Board(0), Part::Trigger(0), EARTH];
        let text = copied(LAYOUT, &parts).unwrap();
        assert!(has_parts_in_space(&text));
        let paste = Edit::Paste {
            board: 0,
            text,
            by_mm: [0.0, 0.0],
        };
        let edited = edit(to, &paste).unwrap();
        Layout::parse(&edited.text, "a.ron").unwrap_or_else(|error| panic!("{error}"));
        edited
    }

    #[test]
    fn boards_triggers_and_targets_are_pasted_into_an_empty_layout() {
        let edited = carry("Layout(\n    name: \"b\",\n    boards: [],\n)\n");
        let target = Part::SpaceTarget { space: 0, index: 0 };
        assert_eq!(edited.parts, [Part::Board(0), Part::Trigger(0), target]);
        for own in [
            "(code: \"B\", at_mm: (19, 0))",
            "(name: \"Pinch\", when: Pinch(finger: \"index\"))",
            "(name: \"Earth\", at_mm: (200, 0, -270), shape: Ball(70))",
            "labels: {\"A\": \"x\", \"B\": \"y\"}",
        ] {
            assert!(edited.text.contains(own), "{own}: {}", edited.text);
        }
        assert!(!edited.text.contains("Moon"), "{}", edited.text);
    }

    #[test]
    fn boards_triggers_and_targets_have_names_of_their_own_beside_the_originals() {
        let edited = carry(LAYOUT);
        let target = Part::SpaceTarget { space: 1, index: 0 };
        assert_eq!(edited.parts, [Part::Board(1), Part::Trigger(1), target]);
        for own in [
            "name: \"B 2\"",
            "(name: \"Pinch 2\", when:",
            "(name: \"Earth 2\", at_mm: (200, 0, -270)",
            "\"B\": \"y\", \"A 2\": \"x\", \"B 2\": \"y\"}",
        ] {
            assert!(edited.text.contains(own), "{own}: {}", edited.text);
        }
    }

    #[test]
    fn a_board_of_bent_fingers_is_pasted_once_for_each_hand() {
        let bent = "(contact: Bend, pose: (anchor: wrist), hand: \"right\", \
                    keys: [(code: \"A\", finger: \"index\", at_mm: (0, 0))])";
        let layout = format!("Layout(name: \"a\", boards: [{bent}])");
        let text = copied(&layout, &[Part::Board(0)]).unwrap();
        let paste = Edit::Paste {
            board: 0,
            text,
            by_mm: [0.0, 0.0],
        };
        let left = layout.replace("right", "left");
        for (to, boards) in [("Layout(name: \"a\", boards: [])", 1), (&left, 2)] {
            let edited = edit(to, &paste).unwrap();
            assert_eq!(edited.text.matches("contact: Bend").count(), boards);
        }
        assert!(edit(&layout, &paste).is_err(), "the hand has such a board");
    }

    #[test]
    fn layers_and_controls_are_no_parts_in_space() {
        assert_eq!(copied(LAYOUT, &[Part::Layer(0), Part::Layout]), None);
        let row = copied(LAYOUT, &[Part::Row { board: 0, row: 0 }]).unwrap();
        assert!(!has_parts_in_space(&row), "{row}");
        assert!(!has_parts_in_space("not a layout"));
    }
}
