//! The screen of a calibration: the pose, its picture, the sensors and the keys.

use ademan::calibrate::{CaptureState, LiveChannel, Procedure};
use ademan::estimate::{ChannelMap, ChannelRow};
use ademan::hand::Side;
use ademan::message::escape;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::Widget;

use super::figure::Figure;
use crate::messages;
use crate::view::look::Look;

/// The smallest width of the picture and of the sensors.
const MIN_PICTURE: u16 = 34;
const SENSORS: u16 = 45;

/// The width of the name of a joint, with a blank.
const NAME: usize = 21;

/// The width of the bar of a sensor.
const BAR: usize = 12;

/// The width of the bar of the time for which a pose is held.
const HOLD_BAR: usize = 20;

/// The rows above picture and sensors, and those below without the message.
const ROWS_ABOVE: u16 = 4;
const ROWS_BELOW: u16 = 3;

/// The most rows of a message.
const MAX_MESSAGE: usize = 4;

/// The content of the screen.
pub struct Screen<'a> {
    pub glove: &'a str,
    pub side: Side,
    pub source: &'a str,
    /// The channels of the glove; `None` if they are not known.
    pub map: Option<&'a ChannelMap>,
    /// The largest count of a channel.
    pub full_scale: u16,
    pub procedure: &'a Procedure,
    pub state: CaptureState,
    /// A message about the source, empty for none.
    pub message: &'a str,
    pub look: Look,
}

impl Screen<'_> {
    pub fn draw(&self, buffer: &mut Buffer) {
        let window = buffer.area;
        let broken = messages::row("", self.message.trim_start(), window.width.into());
        let message: Vec<&str> = broken.lines().take(MAX_MESSAGE).collect();
        let message_rows = message.len().max(1) as u16;
        let line = |row: u16, line: Line, target: &mut Buffer| {
            if row < window.height {
                line.render(Rect::new(0, row, window.width, 1), target);
            }
        };
        line(0, self.title(), buffer);
        line(1, self.progress(), buffer);
        let [first, second] = self.instruction(window.width);
        line(2, first, buffer);
        line(3, second, buffer);
        let bottom = window.height.saturating_sub(ROWS_BELOW + message_rows);
        let room = bottom.saturating_sub(ROWS_ABOVE);
        let sensors = SENSORS.min(window.width);
        let picture = window.width.saturating_sub(sensors + 1);
        if picture >= MIN_PICTURE && room >= 8 {
            let area = Rect::new(0, ROWS_ABOVE, picture, room);
            if let Some(figure) = self
                .procedure
                .pose()
                .and_then(|pose| Figure::new(pose, self.side))
            {
                figure.draw(buffer, area, self.look);
            }
            self.draw_sensors(buffer, Rect::new(picture + 1, ROWS_ABOVE, sensors, room));
        } else {
            self.draw_sensors(buffer, Rect::new(0, ROWS_ABOVE, sensors, room));
        }
        line(bottom + 1, self.status(), buffer);
        for (row, words) in (bottom + 2..).zip(message) {
            line(row, Line::from(words), buffer);
        }
        let keys = " r repeat   b back   s skip   q quit";
        let last = bottom + 2 + message_rows;
        line(last, Line::styled(keys, self.look.faint()), buffer);
        self.look.apply(buffer);
    }

    fn title(&self) -> Line<'_> {
        let words = format!(" calibrating {}", escape(self.glove));
        Line::from(vec![
            Span::styled(words, Style::new().add_modifier(Modifier::BOLD)),
            Span::styled(format!("  {}", escape(self.source)), self.look.faint()),
        ])
    }

    /// Returns the number of the pose, and a mark for each pose: taken, present, skipped, to come.
    fn progress(&self) -> Line<'static> {
        let procedure = self.procedure;
        let marks = procedure.poses().iter().enumerate().map(|(index, &pose)| {
            let is_taken = procedure.observations().get(pose).is_some();
            match (index == procedure.index(), is_taken) {
                (true, _) => '▶',
                (false, true) => '●',
                (false, false) if index < procedure.index() => '–',
                (false, false) => '○',
            }
        });
        let marks: String = marks.collect();
        let number = (procedure.index() + 1).min(procedure.poses().len());
        Line::from(format!(
            " pose {number} of {}  {marks}",
            procedure.poses().len()
        ))
    }

    /// Returns the instruction of the pose, on two lines if it is long.
    fn instruction(&self, width: u16) -> [Line<'static>; 2] {
        let Some(pose) = self.procedure.pose() else {
            return [Line::from(""), Line::from("")];
        };
        let (name, text) = (pose.name(), pose.instruction());
        let room = usize::from(width).saturating_sub(name.len() + 4);
        let (first, second) = if text.len() > room {
            text[..room.min(text.len())]
                .rfind(' ')
                .map_or((text, ""), |blank| text.split_at(blank))
        } else {
            (text, "")
        };
        let bold = Style::new().add_modifier(Modifier::BOLD);
        [
            Line::from(vec![
                Span::styled(format!(" {name}: "), bold),
                Span::raw(first),
            ]),
            Line::from(second),
        ]
    }

    fn status(&self) -> Line<'static> {
        let words = match self.state {
            CaptureState::Preparing(left) if left.is_zero() => " take the pose".to_owned(),
            CaptureState::Preparing(left) => {
                format!(" get ready: {}", left.as_secs_f32().ceil())
            }
            CaptureState::Moving => " hold still".to_owned(),
            CaptureState::Holding(fraction) => {
                let full = (fraction * HOLD_BAR as f32).round() as usize;
                let full = full.min(HOLD_BAR);
                format!(
                    " hold still {}{}",
                    "█".repeat(full),
                    "·".repeat(HOLD_BAR - full)
                )
            }
            CaptureState::Captured => " done".to_owned(),
        };
        let is_held = matches!(
            self.state,
            CaptureState::Holding(_) | CaptureState::Captured
        );
        if is_held {
            Line::styled(words, self.look.pressed())
        } else {
            Line::styled(words, Style::new().add_modifier(Modifier::BOLD))
        }
    }

    /// Draws the sensors as far as there is room: first those that the pose is for.
    fn draw_sensors(&self, buffer: &mut Buffer, area: Rect) {
        let mut lines: Vec<Line> = match self.map {
            Some(map) => {
                let rows = self.sorted_rows(map).into_iter();
                rows.map(|row| self.sensor(map, row)).collect()
            }
            None => self.unknown_sensors(),
        };
        let room = usize::from(area.height);
        if lines.len() > room {
            let shown = room.saturating_sub(1);
            let more = format!("and {} more: enlarge the window", lines.len() - shown);
            lines.truncate(shown);
            lines.push(Line::styled(more, self.look.faint()));
        }
        for (line, row) in lines.into_iter().zip(0..area.height) {
            line.render(Rect::new(area.x, area.y + row, area.width, 1), buffer);
        }
    }

    /// Returns a row for each channel, those first that the pose is for. Of several joints of one channel, it is the one
    /// nearest to the body.
    fn sorted_rows<'m>(&self, map: &'m ChannelMap) -> Vec<&'m ChannelRow> {
        let mut rows: Vec<&ChannelRow> = map.rows().iter().collect();
        rows.sort_by_key(|row| (row.channel, row.dof));
        rows.dedup_by_key(|row| row.channel);
        let moves = |row: &ChannelRow| {
            self.procedure.pose().is_some_and(|pose| {
                let expected = pose.expected(row.dof).radians;
                pose.defines(row.dof) && expected != 0.0
            })
        };
        rows.sort_by_key(|row| (!moves(row), row.dof));
        rows
    }

    /// Returns the line of a sensor: joint, bar with the range so far and the present count, count and angle.
    fn sensor(&self, map: &ChannelMap, row: &ChannelRow) -> Line<'static> {
        let mut live = self.procedure.live().iter();
        let live = live.find(|live| live.channel == row.channel);
        let name = format!("{:<NAME$}", row.dof.name());
        let Some((live, count)) = live.and_then(|live| Some((live, live.count?))) else {
            return Line::styled(format!("{name}no readings"), self.look.faint());
        };
        let degrees = map.radians(row, f64::from(count)).to_degrees();
        let values = format!(" {count:>4} {degrees:>5.0}°");
        let bar = bar(live, map.full_scale());
        Line::from(format!("{name}{bar}{values}"))
    }

    /// Returns a line for each channel of an unknown glove, those first that have changed most.
    fn unknown_sensors(&self) -> Vec<Line<'static>> {
        let live = self.procedure.live().iter();
        let mut live: Vec<&LiveChannel> = live.filter(|live| live.count.is_some()).collect();
        let width = |channel: &LiveChannel| channel.range.map_or(0, |(low, high)| high - low);
        live.sort_by_key(|live| std::cmp::Reverse(width(live)));
        let line = |channel: &&LiveChannel| {
            let name = format!("channel {}", channel.channel);
            let count = channel.count.unwrap_or_default();
            let bar = bar(channel, self.full_scale);
            Line::from(format!("{name:<NAME$}{bar} {count:>4}"))
        };
        live.iter().map(line).collect()
    }
}

/// Returns a bar over the full scale: the range so far and the present count.
fn bar(live: &LiveChannel, full_scale: u16) -> String {
    let cell = |count: u16| {
        let cell = usize::from(count) * BAR / (usize::from(full_scale) + 1);
        cell.min(BAR - 1)
    };
    let range = live.range.map(|(low, high)| cell(low)..=cell(high));
    let cells = (0..BAR).map(|index| match live.count {
        Some(count) if cell(count) == index => '█',
        _ if range.as_ref().is_some_and(|range| range.contains(&index)) => '░',
        _ => '─',
    });
    cells.collect()
}
