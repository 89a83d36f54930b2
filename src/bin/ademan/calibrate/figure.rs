//! A picture of a hand in a calibration pose, from above and from the side, as dots of braille characters.

use ademan::calibrate::CalibrationPose;
use ademan::estimate::Estimate;
use ademan::hand::{Dof, Finger, Joint, Side};
use ademan::kinematics::{ArmModel, BoneLengths, HandPose};
use ademan::time::Timestamp;
use parry3d::math::{Vec2, Vec3};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use ratatui::widgets::Widget;

use crate::view::look::Look;

/// The length of the drawn forearm, as a fraction of the distance from elbow to wrist.
const FOREARM: f32 = 0.4;

/// A hand in a pose, as lines in space.
pub struct Figure {
    strokes: Vec<Stroke>,
}

struct Stroke {
    ends: [Vec3; 2],
    /// The width in metres.
    width: f32,
}

/// A view of the figure: its name, and the direction of its columns and rows in the world.
struct View {
    name: &'static str,
    right: Vec3,
    down: Vec3,
}

impl Figure {
    /// Creates the figure of a pose for the hand of a side; `None` if the arm model cannot be made.
    pub fn new(pose: CalibrationPose, side: Side) -> Option<Self> {
        let bones = BoneLengths::from_hand_and_forearm(0.189, 0.262).ok()?;
        let arm = ArmModel::anthropometric(side, &bones).ok()?;
        let estimate = Estimate::new(Timestamp(0), pose.angles());
        let shows_arm = pose.expected(Dof::ElbowFlexion).deviation < 0.1;
        Some(Self {
            strokes: strokes(&arm.forward(&estimate), shows_arm),
        })
    }

    /// Draws both views, one above the other.
    pub fn draw(&self, buffer: &mut Buffer, area: Rect, look: Look) {
        let above = View {
            name: "from above",
            right: Vec3::NEG_Z,
            down: Vec3::X,
        };
        let side = View {
            name: "from the side",
            right: Vec3::NEG_Z,
            down: Vec3::NEG_Y,
        };
        let half = area.height / 2;
        let upper = Rect::new(area.x, area.y, area.width, half);
        let lower = Rect::new(area.x, area.y + half, area.width, area.height - half);
        self.draw_view(&above, buffer, upper, look);
        self.draw_view(&side, buffer, lower, look);
    }

    fn draw_view(&self, view: &View, buffer: &mut Buffer, area: Rect, look: Look) {
        if area.height < 3 || area.width < 8 {
            return;
        }
        let label = Line::styled(view.name, look.faint());
        label.render(Rect::new(area.x, area.y, area.width, 1), buffer);
        let room = Rect::new(area.x, area.y + 1, area.width, area.height - 1);
        let mut dots = Dots::new(room.width, room.height);
        let flat = |point: Vec3| Vec2::new(point.dot(view.right), point.dot(view.down));
        let ends = || self.strokes.iter().flat_map(|stroke| stroke.ends).map(flat);
        let low = ends().fold(Vec2::INFINITY, Vec2::min);
        let high = ends().fold(Vec2::NEG_INFINITY, Vec2::max);
        let size = (high - low).max(Vec2::splat(0.1)) + Vec2::splat(0.03);
        let scale = (dots.size() / size).min_element();
        let center = (low + high) / 2.0;
        let place = |point: Vec3| (flat(point) - center) * scale + dots.size() / 2.0;
        let strokes: Vec<_> = self
            .strokes
            .iter()
            .map(|stroke| (stroke.ends.map(place), stroke.width * scale / 2.0))
            .collect();
        for (stroke_ends, radius) in strokes {
            dots.draw(stroke_ends, radius);
        }
        dots.write(buffer, room);
    }
}

fn strokes(pose: &HandPose, shows_arm: bool) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    let mut add = |from: Option<Vec3>, to: Option<Vec3>, width| {
        if let (Some(from), Some(to)) = (from, to) {
            let ends = [from, to];
            strokes.push(Stroke { ends, width });
        }
    };
    let at = |joint| pose.position(joint);
    let wrist = at(Joint::Wrist);
    let elbow = at(Joint::Elbow);
    let forearm = elbow.zip(wrist).map(|(elbow, wrist)| {
        if shows_arm {
            elbow
        } else {
            wrist + (elbow - wrist) * FOREARM
        }
    });
    add(forearm, wrist, 0.03);
    if shows_arm {
        // The upper arm hangs down behind the elbow, where the model has no shoulder.
        let shoulder = at(Joint::Shoulder).or(elbow.map(|elbow| elbow + Vec3::new(0.0, 0.0, 0.25)));
        add(shoulder, elbow, 0.035);
    }
    let knuckle = |finger: Finger| at(finger.joints()[1]);
    for pair in Finger::ALL[1..].windows(2) {
        add(knuckle(pair[0]), knuckle(pair[1]), 0.012);
    }
    for &finger in Finger::ALL {
        let joints = finger.joints();
        add(wrist, at(joints[0]), 0.01);
        for pair in joints.windows(2) {
            add(at(pair[0]), at(pair[1]), 0.009);
        }
    }
    strokes
}

/// A grid of dots, two by four in each character.
struct Dots {
    columns: u16,
    rows: u16,
    cells: Vec<u8>,
}

/// The bits of the dots of a braille character by row and column.
const BITS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

impl Dots {
    fn new(columns: u16, rows: u16) -> Self {
        Self {
            columns,
            rows,
            cells: vec![0; usize::from(columns) * usize::from(rows)],
        }
    }

    /// Returns the numbers of dots in a row and in a column.
    fn size(&self) -> Vec2 {
        Vec2::new(f32::from(self.columns) * 2.0, f32::from(self.rows) * 4.0)
    }

    /// Draws a line with round ends.
    fn draw(&mut self, [from, to]: [Vec2; 2], radius: f32) {
        let radius = radius.max(0.5);
        let low = from.min(to) - Vec2::splat(radius);
        let high = (from.max(to) + Vec2::splat(radius)).min(self.size());
        for y in low.y.max(0.0) as u16..high.y.ceil().max(0.0) as u16 {
            for x in low.x.max(0.0) as u16..high.x.ceil().max(0.0) as u16 {
                let dot = Vec2::new(f32::from(x) + 0.5, f32::from(y) + 0.5);
                let along = to - from;
                let t = (dot - from).dot(along) / along.length_squared().max(1e-6);
                if dot.distance(from + along * t.clamp(0.0, 1.0)) <= radius {
                    self.set(x, y);
                }
            }
        }
    }

    fn set(&mut self, x: u16, y: u16) {
        let (column, row) = (x / 2, y / 4);
        if column < self.columns && row < self.rows {
            let cell = self.cell(column, row);
            self.cells[cell] |= BITS[usize::from(y % 4)][usize::from(x % 2)];
        }
    }

    /// Returns the index of a character.
    fn cell(&self, column: u16, row: u16) -> usize {
        usize::from(row) * usize::from(self.columns) + usize::from(column)
    }

    fn write(&self, buffer: &mut Buffer, area: Rect) {
        for row in 0..self.rows {
            for column in 0..self.columns {
                let bits = self.cells[self.cell(column, row)];
                if bits != 0 {
                    let character = char::from_u32(0x2800 + u32::from(bits)).unwrap_or(' ');
                    buffer[(area.x + column, area.y + row)].set_char(character);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(pose: CalibrationPose) -> String {
        let area = Rect::new(0, 0, 36, 16);
        let mut buffer = Buffer::empty(area);
        let look = Look {
            has_colors: false,
            is_unicode: true,
        };
        let figure = Figure::new(pose, Side::Right).unwrap();
        figure.draw(&mut buffer, area, look);
        let lines = (0..area.height).map(|row| {
            let cells = (0..area.width).map(|column| buffer[(column, row)].symbol());
            cells.collect::<String>().trim_end().to_owned()
        });
        lines.collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn a_picture_of_more_characters_than_a_u16_counts_is_drawn() {
        let area = Rect::new(0, 0, 600, 200);
        let mut buffer = Buffer::empty(area);
        let mut dots = Dots::new(area.width, area.height);
        dots.set(2 * 599, 4 * 199);
        dots.write(&mut buffer, area);
        assert_eq!(buffer[(599, 199)].symbol(), "⠁");
        assert_eq!(buffer[(0, 0)].symbol(), " ");
    }

    /// The palm is down again in the flat pose; the step exists for the forearm.
    #[test]
    fn every_pose_but_the_palm_down_has_a_picture_of_its_own() {
        assert_eq!(
            picture(CalibrationPose::PalmDown),
            picture(CalibrationPose::Flat)
        );
        let poses = CalibrationPose::GUIDED.iter().copied();
        let others = poses.filter(|&pose| pose != CalibrationPose::PalmDown);
        let mut pictures: Vec<String> = others.map(picture).collect();
        let count = pictures.len();
        pictures.sort();
        pictures.dedup();
        assert_eq!(pictures.len(), count, "{}", pictures.join("\n\n"));
    }
}
