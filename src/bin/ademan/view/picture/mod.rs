//! One picture of the live view.
//!
//! ```text
//!  running  QWERTY, 19 mm  typist:hello > transcript      state, layout, source and outputs
//!  ┌───┐┌───┐                                             boards side by side, pointer and targets in space
//!  fingers ① thumb 31 …                                   heights over the board
//!  down    ShiftLeft H                                    keys that are down, or the task of the demo
//!  Volume  ▕█████░░░░░▏ 0.50                              controls and axes
//!  3218 readings, 174/s, no losses                        counts
//!  armed: nothing is typed into other programs            messages
//! ```

mod bends;
mod boards;
mod cut;
mod lines;
mod parts;
mod space;
#[cfg(test)]
mod tests;
mod values;

use ademan::contact::TargetId;
use ademan::layout::KeySize;
use ademan::session::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::Line;
use ratatui::widgets::Widget;

use self::cut::cut;
use self::parts::{Part, PartKind, arrange};
use super::look::Look;
use crate::messages;

/// Minimum number of rows for messages, if they have that many.
const MIN_MESSAGES: u16 = 2;

/// Most rows of boards with styles.
const MAX_ROWS: u16 = 100;

/// Groups of lines that are shown even if no board fits: the fingertips or bends, and the keys or the task.
const ESSENTIAL_GROUPS: usize = 2;

/// The content of a picture.
pub struct Picture<'a> {
    pub view: &'a View,
    /// Lines of the command.
    pub task: &'a [String],
    /// Oldest first.
    pub messages: &'a [String],
    pub look: Look,
}

/// Draws the boards of a view without fingertips, each key in its own style, in as many rows as they need.
pub fn boards_with_styles(
    view: &View,
    look: Look,
    width: u16,
    style: impl Fn(TargetId) -> Style,
) -> Buffer {
    let sizes = [KeySize::Labelled, KeySize::Bordered, KeySize::Compact];
    let arranged = sizes.into_iter().find_map(|size| {
        let mut parts = boards::parts(&view.layout, size);
        arrange(&mut parts, width, MAX_ROWS).then_some(parts)
    });
    let parts = arranged.unwrap_or_default();
    let columns = parts.iter().map(|part| part.x + part.width).max();
    let rows = parts.iter().map(|part| part.y + part.height).max();
    let area = Rect::new(0, 0, columns.unwrap_or(0), rows.unwrap_or(0));
    let mut buffer = Buffer::empty(area);
    let picture = Picture {
        view,
        task: &[],
        messages: &[],
        look,
    };
    for part in &parts {
        let part_area = Rect::new(part.x, part.y, part.width, part.height);
        if let PartKind::Board(_, grid) = &part.kind {
            boards::draw_keys(&picture, grid, &mut buffer, part_area, &style);
        }
    }
    look.apply(&mut buffer);
    buffer
}

impl Picture<'_> {
    /// Draws the picture. What has no room is left out, and named.
    pub fn draw(&self, buffer: &mut Buffer, window: Rect) {
        if window.is_empty() {
            return;
        }
        let mut left_out: Vec<&str> = Vec::new();
        let below = self.lines_below(window.width);
        let latest = self.messages.iter().rev().take(MIN_MESSAGES.into());
        let messages = latest.map(|message| lines_of(message, window.width).len() as u16);
        let messages = MIN_MESSAGES.min(messages.sum());
        let count = |groups: &[LineGroup]| -> u16 {
            let lines = groups.iter().map(|group| group.lines.len() as u16);
            lines.sum()
        };
        let essential = below.len().min(ESSENTIAL_GROUPS);
        let rows_without = |reserved: u16| window.height.saturating_sub(1 + reserved);
        let parts = self.fitting_parts(
            window.width,
            rows_without(count(&below) + messages),
            rows_without(count(&below[..essential]) + messages.min(1)),
            &mut left_out,
        );
        let mut y = window.y + 1 + self.draw_parts(&parts, buffer, window);
        for LineGroup { name, lines } in below {
            if y + lines.len() as u16 + messages.min(1) > window.bottom() {
                left_out.push(name);
                continue;
            }
            for line in lines {
                line.render(Rect::new(window.x, y, window.width, 1), buffer);
                y += 1;
            }
        }
        let rest = window.bottom().saturating_sub(y);
        let shown = self.draw_messages(buffer, Rect::new(window.x, y, window.width, rest));
        if shown < messages.min(1) {
            left_out.push("messages");
        }
        let title = Rect::new(window.x, window.y, window.width, 1);
        self.title(&left_out, window.width).render(title, buffer);
        self.look.apply(buffer);
    }

    /// Returns the boards and spaces at the largest size at which all fit into `room` rows. If no size fits, returns as
    /// many as fit into `most` rows at the smallest size; other lines are left out to make room for them.
    fn fitting_parts(
        &self,
        width: u16,
        room: u16,
        most: u16,
        left_out: &mut Vec<&str>,
    ) -> Vec<Part> {
        for key_size in [KeySize::Labelled, KeySize::Bordered, KeySize::Compact] {
            let mut parts = self.parts(key_size);
            if arrange(&mut parts, width, room) {
                return parts;
            }
        }
        let mut parts = self.parts(KeySize::Compact);
        while !arrange(&mut parts, width, most) {
            let name = parts.pop().map_or("", |part| part.kind.name());
            if !left_out.contains(&name) {
                left_out.push(name);
            }
        }
        parts
    }

    /// Draws boards and spaces in the middle. Returns their height.
    fn draw_parts(&self, parts: &[Part], buffer: &mut Buffer, window: Rect) -> u16 {
        let height = parts.iter().map(|part| part.y + part.height).max();
        let columns = parts.iter().map(|part| part.x + part.width).max();
        let margin = window.width.saturating_sub(columns.unwrap_or(0)) / 2;
        for part in parts {
            let area = Rect::new(
                window.x + margin + part.x,
                window.y + 1 + part.y,
                part.width,
                part.height,
            );
            self.draw_part(part, buffer, area);
        }
        height.unwrap_or(0)
    }

    fn draw_part(&self, part: &Part, buffer: &mut Buffer, area: Rect) {
        match &part.kind {
            PartKind::Board(index, grid) => boards::draw(self, *index, grid, buffer, area),
            PartKind::Range => space::draw_range(self, buffer, area),
            PartKind::Space(index) => space::draw_space(self, *index, buffer, area),
        }
    }

    fn parts(&self, key_size: KeySize) -> Vec<Part> {
        let mut parts = boards::parts(&self.view.layout, key_size);
        parts.extend(space::parts(self.view, key_size));
        parts
    }

    /// Draws the latest messages that fit, and returns their number. Long ones break between words; the end of the latest one is cut if
    /// it has no room.
    fn draw_messages(&self, buffer: &mut Buffer, area: Rect) -> u16 {
        let room = usize::from(area.height);
        let (mut lines, mut count) = (Vec::new(), 0);
        for message in self.messages.iter().rev() {
            let mut own = lines_of(message, area.width);
            if own.len() > room && count == 0 && room > 0 {
                own.truncate(room);
                own[room - 1].push_str(" …");
            }
            if lines.len() + own.len() > room {
                break;
            }
            lines.splice(0..0, own);
            count += 1;
        }
        for (line, y) in lines.iter().zip(area.y..) {
            let text = cut(line, area.width);
            let area = Rect::new(area.x, y, area.width, 1);
            Line::styled(text, self.look.faint()).render(area, buffer);
        }
        count
    }
}

/// Returns the lines of a message in this many columns, at least one.
fn lines_of(message: &str, width: u16) -> Vec<String> {
    let broken = messages::row("", message, width.into());
    let mut lines: Vec<String> = broken.lines().map(str::to_owned).collect();
    if lines.is_empty() {
        lines.push(String::new());
    }
    lines
}

/// Lines that are shown or left out together.
struct LineGroup {
    name: &'static str,
    lines: Vec<Line<'static>>,
}
