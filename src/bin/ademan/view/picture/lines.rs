//! The lines above and below the boards.

use std::borrow::Cow;

use ademan::command::TextMode;
use ademan::hand::{Finger, Side};
use ademan::message::escape;
use ademan::pipeline::PipelineState;
use ademan::session::counted;
use ademan::session::view::{FingerBend, Fingertip};
use ratatui::text::{Line, Span};

use super::cut::cut;
use super::{LineGroup, Picture, bends, values};
use crate::view::look::{finger_mark, hand_name};

impl Picture<'_> {
    /// Returns the first line: the state, the layout, the source and the outputs, and what is left out.
    pub(super) fn title(&self, left_out: &[&str], width: u16) -> Line<'static> {
        let (layout, state) = (&self.view.layout, &self.view.state);
        let mut words = format!(" {}", state.state);
        if let (PipelineState::Paused, Some(origin)) = (state.state, state.paused_by) {
            words += &format!(" by {}", origin.description());
        }
        if let (PipelineState::Paused, None) = (state.state, state.paused_by) {
            words += &straighten(&state.bends);
        }
        if state.awaits_hand {
            words += ": hold your hand open for a second";
        }
        words.push(' ');
        let mut rest = String::new();
        if !left_out.is_empty() {
            rest += &format!(" no room for {} ·", left_out.join(", "));
        }
        rest += &format!(" {}", escape(&layout.name));
        if let Some(headset) = &state.headset {
            rest += &format!(" · {headset}");
        }
        if !state.source.is_empty() {
            rest += &format!(
                " · {} → {}",
                escape(&state.source),
                output_name(&state.output)
            );
        }
        let room = usize::from(width).saturating_sub(words.chars().count());
        let rest = cut(&rest, room as u16).into_owned();
        Line::from(vec![
            Span::styled(words, self.look.state(state.state)),
            Span::styled(rest, self.look.faint()),
        ])
    }

    /// Returns the lines below the boards, the most important group first.
    pub(super) fn lines_below(&self, width: u16) -> Vec<LineGroup> {
        let keys = if self.task.is_empty() {
            vec![self.keys(width)]
        } else {
            self.task
                .iter()
                .map(|line| Line::from(cut(line, width).into_owned()))
                .collect()
        };
        let groups = [
            ("fingers", self.fingers(width)),
            ("bends", bends::lines(self, width)),
            ("keys", keys),
            ("words", self.words(width)),
            ("values", values::lines(self.view, width)),
            ("counts", vec![self.counts(width)]),
        ];
        let groups = groups
            .into_iter()
            .map(|(name, lines)| LineGroup { name, lines });
        groups.filter(|group| !group.lines.is_empty()).collect()
    }

    /// Returns a line for each hand with the heights of its fingertips over the nearest board, in millimetres.
    fn fingers(&self, width: u16) -> Vec<Line<'static>> {
        let tips = &self.view.state.fingertips;
        let sides = [Side::Left, Side::Right];
        let seen = |side: &Side| tips.iter().any(|tip| tip.side == *side);
        let sides: Vec<Side> = sides.into_iter().filter(seen).collect();
        let lines = sides.iter().map(|&side| {
            let mut spans = Vec::new();
            if sides.len() > 1 {
                spans.push(Span::raw(format!("{} ", hand_name(side))));
            }
            let has_names = width >= 76 && sides.len() == 1;
            for &finger in Finger::ALL {
                let of_finger = tips
                    .iter()
                    .filter(|tip| tip.side == side && tip.finger == finger);
                let Some(tip) = nearest(of_finger) else {
                    continue;
                };
                let mark = finger_mark(finger, tip.height_mm < 0.0);
                spans.push(Span::styled(mark.to_string(), self.look.fingertip(finger)));
                let name = if has_names { finger.name() } else { "" };
                let space = if has_names { " " } else { "" };
                spans.push(Span::raw(format!("{space}{name} {:<4.0}", tip.height_mm)));
            }
            spans.push(Span::raw(if width >= 56 {
                "mm above the board"
            } else {
                "mm"
            }));
            Line::from(spans)
        });
        lines.collect()
    }

    /// Returns the keys that are down, and the text so far; without one, the latest keys that were pressed.
    fn keys(&self, width: u16) -> Line<'static> {
        let state = &self.view.state;
        let down: Vec<&str> = state.keys.iter().map(|key| key.name()).collect();
        let down = if down.is_empty() {
            "no key is down".to_owned()
        } else {
            format!("down: {}", down.join(" "))
        };
        let down = cut(&down, width).into_owned();
        let room = usize::from(width).saturating_sub(down.chars().count() + 10);
        let typed = if state.typed.is_empty() {
            latest_keys(&state.recent, room)
        } else {
            format!("\"{}\"", state.typed_end(room.saturating_sub(2)))
        };
        let style = if state.keys.is_empty() {
            self.look.faint()
        } else {
            self.look.pressed()
        };
        let mut spans = vec![Span::styled(down, style)];
        if !typed.is_empty() {
            spans.push(Span::styled(format!("   typed {typed}"), self.look.faint()));
        }
        Line::from(spans)
    }

    /// Returns a line with the candidates of the text decoder, if it changes anything.
    fn words(&self, width: u16) -> Vec<Line<'static>> {
        let state = &self.view.state;
        let Some(mode) = state.text_mode.filter(|mode| *mode != TextMode::Literal) else {
            return Vec::new();
        };
        let words = state.candidates.iter().zip(1..);
        let words: String = words
            .map(|(word, number)| format!("   {number} {}", escape(word)))
            .collect();
        let line = format!("text {mode}{words}");
        vec![Line::from(cut(&line, width).into_owned())]
    }

    /// Returns the number and rate of readings and everything that went wrong.
    fn counts(&self, width: u16) -> Line<'static> {
        let state = &self.view.state;
        let counts = &state.counts;
        let mut line = counted(counts.received, "reading");
        // It is measured over a second.
        if state.readings_per_second > 0.0 {
            line += &format!(", {:.0}/s", state.readings_per_second);
        }
        let problems = [
            (counts.rejected, ["rejected"; 2]),
            (counts.dropped, ["dropped"; 2]),
            (
                counts.losses,
                ["loss of the device", "losses of the device"],
            ),
            (counts.stalls, ["stall", "stalls"]),
            (counts.suppressed, ["event suppressed", "events suppressed"]),
            (counts.dropped_presses, ["press dropped", "presses dropped"]),
        ];
        for (count, names) in problems.iter().filter(|(count, _)| *count > 0) {
            line += &format!(", {count} {}", names[usize::from(*count > 1)]);
        }
        if problems.iter().all(|(count, _)| *count == 0) {
            line += ", no losses";
        }
        Line::styled(cut(&line, width).into_owned(), self.look.faint())
    }
}

/// Returns the names of the latest keys that fit into this number of columns.
fn latest_keys(recent: &[String], mut room: usize) -> String {
    let mut names = Vec::new();
    for key in recent.iter().rev() {
        let length = key.chars().count() + 1;
        if length > room {
            break;
        }
        room -= length;
        names.push(escape(key));
    }
    names.reverse();
    names.join(" ")
}

/// Returns the words for a person whose output is not armed because fingers are bent; empty if none is.
fn straighten(bends: &[FingerBend]) -> String {
    let bent = bends.iter().filter(|bend| bend.bend > bend.release_at);
    let names: Vec<&str> = bent.map(|bend| bend.finger.name()).collect();
    if names.is_empty() {
        String::new()
    } else {
        format!(": straighten {}", names.join(", "))
    }
}

/// Returns the names of the outputs in words.
fn output_name(output: &str) -> Cow<'_, str> {
    match output {
        "none" => "this view only".into(),
        _ => escape(output),
    }
}

/// Returns the fingertip over the nearest board.
fn nearest<'a>(tips: impl Iterator<Item = &'a Fingertip>) -> Option<&'a Fingertip> {
    tips.min_by(|tip, other| tip.height_mm.abs().total_cmp(&other.height_mm.abs()))
}
