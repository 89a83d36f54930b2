//! The order of the events of a step: releases before presses.

use crate::device::{EventKind, OutputEvent};

/// Moves releases before presses. Each device emits its releases first, but does not know the events of the others. A
/// release stays after a press of the same key; times remain in order.
pub(super) fn move_releases_first(events: &mut [OutputEvent]) {
    let is_press = |event: &OutputEvent| matches!(event.kind, EventKind::KeyDown(_));
    let Some(mut first_press) = events.iter().position(is_press) else {
        return;
    };
    for index in first_press + 1..events.len() {
        let EventKind::KeyUp(code) = events[index].kind else {
            continue;
        };
        let own_press = EventKind::KeyDown(code);
        if events[first_press..index]
            .iter()
            .any(|event| event.kind == own_press)
        {
            continue;
        }
        events[first_press..=index].rotate_right(1);
        let time = events[first_press].time;
        first_press += 1;
        for event in &mut events[first_press..=index] {
            event.time = event.time.max(time);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::KeyCode;
    use crate::time::Timestamp;

    /// Parses `+KEY` (press) or `-KEY` (release).
    fn event(time: u64, text: &str) -> OutputEvent {
        let code: KeyCode = text[1..].parse().unwrap();
        OutputEvent {
            time: Timestamp(time),
            kind: match text.as_bytes()[0] {
                b'+' => EventKind::KeyDown(code),
                _ => EventKind::KeyUp(code),
            },
        }
    }

    fn reordered(script: &str) -> String {
        let words = script.split_whitespace().enumerate();
        let mut events: Vec<_> = words.map(|(time, word)| event(time as u64, word)).collect();
        move_releases_first(&mut events);
        assert!(events.windows(2).all(|pair| pair[0].time <= pair[1].time));
        let signs = events.iter().map(|event| match event.kind {
            EventKind::KeyDown(code) => format!("+{code}"),
            EventKind::KeyUp(code) => format!("-{code}"),
            _ => unreachable!(),
        });
        signs.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn releases_precede_presses_except_those_of_the_same_key() {
        assert_eq!(reordered("+A -B +C -D -A"), "-B -D +A +C -A");
        assert_eq!(reordered("-A +A -A -B"), "-A -B +A -A");
        assert_eq!(reordered("+A +B"), "+A +B");
        assert_eq!(reordered("-A -B"), "-A -B");
    }
}
