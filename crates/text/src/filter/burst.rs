//! Edits as the events of one step.

use crate::Edit;
use crate::correction::MAX_EDITS;
use arrayvec::ArrayVec;

use super::keys::{TextKeys, Typed};
use ademan_core::device::pressed_keys::PressedKeys;
use ademan_core::device::{EventKind, Events, KeyCode, OutputEvent};
use ademan_core::time::Timestamp;

/// The events of a burst: each edit is a tap, and a capital has a Shift that goes down and comes up. They fit into one step beside
/// the releases of some keys.
type Kinds = ArrayVec<EventKind, { 2 * MAX_EDITS + 16 }>;

const SHIFTS: [KeyCode; 2] = [KeyCode::SHIFT_LEFT, KeyCode::SHIFT_RIGHT];

/// Edits that have not been copied, because there are too many.
#[derive(Debug)]
pub(super) struct TooMany;

/// Copies edits.
pub(super) fn copy(edits: &[Edit]) -> Result<ArrayVec<Edit, MAX_EDITS>, TooMany> {
    ArrayVec::try_from(edits).map_err(|_| TooMany)
}

/// Appends the events of edits. Returns `false`, and appends nothing, if a character cannot be typed, if a key of it is `held` by a
/// control, or if there is no room for them and `waiting` further events.
pub(super) fn append(
    edits: &[Edit],
    keys: &TextKeys,
    held: &PressedKeys,
    time: Timestamp,
    waiting: usize,
    events: &mut Events,
) -> bool {
    if edits.is_empty() {
        return true;
    }
    let Some(kinds) = kinds(edits, keys, held) else {
        return false;
    };
    // Releases precede presses, so the release of a held Shift cannot follow a press of this step.
    let releases_first = matches!(kinds.first(), Some(EventKind::KeyUp(_)));
    if releases_first && events.iter().any(|event| event.kind.is_press()) {
        return false;
    }
    // The room that the release of everything takes.
    let reserved = held.count() + waiting + 8;
    if events.remaining_capacity() < kinds.len() + reserved {
        return false;
    }
    events.extend(kinds.into_iter().map(|kind| OutputEvent { time, kind }));
    true
}

/// Returns `true` if events begin with the Backspace of a multitap key, which has its release and a letter right after it. It deletes
/// that letter and undoes no correction.
pub(super) fn replaces_letter(events: &[OutputEvent]) -> bool {
    let [press, release, letter, ..] = events else {
        return false;
    };
    press.kind == EventKind::KeyDown(KeyCode::BACKSPACE)
        && release.kind == EventKind::KeyUp(KeyCode::BACKSPACE)
        && letter.kind.is_press()
        && [release.time, letter.time] == [press.time; 2]
}

/// Returns `true` if the character at an index belongs to a longer text of one key, whose characters have one time.
pub(super) fn is_part_of_text(events: &[OutputEvent], index: usize) -> bool {
    let is_same = |other: Option<&OutputEvent>| {
        other.is_some_and(|other| {
            matches!(other.kind, EventKind::Character(_)) && other.time == events[index].time
        })
    };
    let before = index.checked_sub(1).and_then(|before| events.get(before));
    is_same(before) || is_same(events.get(index + 1))
}

/// Returns the events of edits.
fn kinds(edits: &[Edit], keys: &TextKeys, held: &PressedKeys) -> Option<Kinds> {
    let mut kinds = Kinds::new();
    let held_shifts = || {
        SHIFTS
            .into_iter()
            .filter(move |shift| held.contains(*shift))
    };
    kinds.extend(held_shifts().map(EventKind::KeyUp));
    let mut is_shifted = false;
    for edit in edits {
        let typed = match edit {
            Edit::Backspace => Typed::Key(KeyCode::BACKSPACE, false),
            Edit::Type(character) => keys.typed(*character)?,
        };
        let shift = matches!(typed, Typed::Key(_, true));
        if shift != is_shifted {
            kinds.try_push(shift_event(shift)).ok()?;
            is_shifted = shift;
        }
        match typed {
            Typed::Key(code, _) if held.contains(code) => return None,
            Typed::Key(code, _) => {
                kinds.try_push(EventKind::KeyDown(code)).ok()?;
                kinds.try_push(EventKind::KeyUp(code)).ok()?;
            }
            Typed::Character(character) => {
                kinds.try_push(EventKind::Character(character)).ok()?;
            }
        }
    }
    if is_shifted {
        kinds.try_push(shift_event(false)).ok()?;
    }
    for shift in held_shifts() {
        kinds.try_push(EventKind::KeyDown(shift)).ok()?;
    }
    Some(kinds)
}

fn shift_event(is_down: bool) -> EventKind {
    if is_down {
        EventKind::KeyDown(KeyCode::SHIFT_LEFT)
    } else {
        EventKind::KeyUp(KeyCode::SHIFT_LEFT)
    }
}
