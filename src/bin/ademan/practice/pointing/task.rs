//! The targets of a pointing lesson: a ring, as in the multi-directional tapping test of ISO/TS 9241-411:2012, annex B.

use ademan::device::{EventKind, KeyCode, OutputEvent};
use ademan::measures::{Movement, PointerPath, PointingResult, Ring};
use ademan::time::Timestamp;

use crate::practice::PracticeTask;

/// Size of the screen of the lesson, in pixels: the screen of a small laptop. No program tells how large the real one is.
pub const SCREEN: [f64; 2] = [1280.0, 800.0];

/// Targets of the ring, 13 to 25 in studies: an odd number, so that each movement crosses it.
pub const TARGETS: usize = 13;

/// The ring.
const RING: Ring = Ring {
    targets: TARGETS,
    center: [SCREEN[0] / 2.0, SCREEN[1] / 2.0],
    diameter: 560.0,
    width: 90.0,
};

/// Columns and rows of the picture.
const COLUMNS: usize = 60;
const ROWS: usize = 17;

/// The pointer among the targets, and the movements so far.
pub struct PointingTask {
    cursor: [f64; 2],
    /// Number of clicks so far. The first one, on the first target, starts the clock.
    clicks: usize,
    /// The way since the last click, and the time of that click.
    last: Option<(PointerPath, Timestamp)>,
    movements: Vec<Movement>,
}

/// Returns the center of the target of a click, in pixels from the upper left corner.
pub fn target(click: usize) -> [f64; 2] {
    RING.target(click)
}

impl PointingTask {
    pub fn new() -> Self {
        Self {
            cursor: [SCREEN[0] / 2.0, SCREEN[1] / 2.0],
            clicks: 0,
            last: None,
            movements: Vec::new(),
        }
    }

    fn move_to(&mut self, position: [f64; 2]) {
        let position = [
            position[0].clamp(0.0, SCREEN[0]),
            position[1].clamp(0.0, SCREEN[1]),
        ];
        if let Some((path, _)) = &mut self.last {
            path.go_to(position);
        }
        self.cursor = position;
    }

    fn click(&mut self, time: Timestamp) {
        if let Some((path, earlier)) = &self.last {
            let seconds = time.since(*earlier).as_secs_f64();
            self.movements.push(path.click(seconds));
        }
        self.clicks += 1;
        self.last = Some((PointerPath::new(&RING, self.clicks, self.cursor), time));
    }

    /// Returns the figures of the movements so far.
    pub fn result(&self) -> PointingResult {
        PointingResult::new(&self.movements)
    }

    /// Returns the picture: the targets, the one to click on, and the pointer.
    fn picture(&self) -> Vec<String> {
        let mut rows = vec![vec!['·'; COLUMNS]; ROWS];
        let cell = |[x, y]: [f64; 2]| {
            let column = (x / SCREEN[0] * COLUMNS as f64) as usize;
            let row = (y / SCREEN[1] * ROWS as f64) as usize;
            (row.min(ROWS - 1), column.min(COLUMNS - 1))
        };
        for click in 0..TARGETS {
            let (row, column) = cell(target(click));
            rows[row][column] = 'o';
        }
        if !self.is_complete() {
            let (row, column) = cell(target(self.clicks));
            for (offset, sign) in [(-2_isize, '('), (-1, '('), (0, 'O'), (1, ')'), (2, ')')] {
                if let Some(place) = column.checked_add_signed(offset).filter(|it| *it < COLUMNS) {
                    rows[row][place] = sign;
                }
            }
        }
        let (row, column) = cell(self.cursor);
        rows[row][column] = '+';
        rows.into_iter().map(String::from_iter).collect()
    }
}

impl PracticeTask for PointingTask {
    fn handle(&mut self, event: &OutputEvent) -> bool {
        match event.kind {
            _ if self.is_complete() => return false,
            EventKind::MoveBy(x, y) => {
                self.move_to([self.cursor[0] + f64::from(x), self.cursor[1] + f64::from(y)]);
            }
            EventKind::MoveTo(x, y) => {
                self.move_to([f64::from(x) * SCREEN[0], f64::from(y) * SCREEN[1]]);
            }
            EventKind::KeyDown(KeyCode::MOUSE_LEFT) => self.click(event.time),
            _ => return false,
        }
        true
    }

    fn is_complete(&self) -> bool {
        self.movements.len() >= TARGETS
    }

    fn lines(&self) -> Vec<String> {
        let mut lines = self.picture();
        let result = self.result();
        lines.push(match self.clicks {
            0 => "point (+) at ((O)) and click; the first click starts the clock".to_owned(),
            _ => format!(
                "{} of {TARGETS} targets · {} missed · {:.2} s each · way {:.0} % straight · {:.2} bit/s",
                result.targets,
                result.misses,
                result.movement_s,
                result.path_efficiency * 100.0,
                result.throughput
            ),
        });
        lines
    }
}

#[cfg(test)]
mod tests {
    use ademan::measures::distance;

    use super::*;

    fn event(milliseconds: u64, kind: EventKind) -> OutputEvent {
        OutputEvent {
            time: Timestamp(milliseconds * 1000),
            kind,
        }
    }

    /// Clicks at a position of the screen.
    fn click(task: &mut PointingTask, milliseconds: u64, [x, y]: [f64; 2]) {
        let to = EventKind::MoveTo((x / SCREEN[0]) as f32, (y / SCREEN[1]) as f32);
        let button = KeyCode::MOUSE_LEFT;
        for kind in [to, EventKind::KeyDown(button), EventKind::KeyUp(button)] {
            task.handle(&event(milliseconds, kind));
        }
    }

    #[test]
    fn each_target_is_met_once_and_each_movement_crosses_the_ring() {
        for click in 1..TARGETS {
            assert!(distance(target(click), target(click - 1)) > RING.diameter * 0.9);
            assert!(
                (0..click).all(|earlier| distance(target(earlier), target(click)) > RING.width)
            );
        }
        assert!(distance(target(TARGETS), target(0)) < 1e-6);
    }

    #[test]
    fn the_first_click_starts_the_clock_and_a_click_beside_the_target_is_a_miss() {
        let mut task = PointingTask::new();
        for number in 0..=TARGETS {
            assert!(!task.is_complete());
            let [x, y] = target(number);
            let error = if number == 3 { RING.width } else { 2.0 };
            click(&mut task, 800 * number as u64, [x + error, y]);
        }
        assert!(task.is_complete());
        let result = task.result();
        assert_eq!((result.targets, result.misses), (TARGETS, 1));
        assert!((result.movement_s - 0.8).abs() < 1e-9, "{result:?}");
        assert!(result.path_efficiency > 0.999, "{result:?}");
        assert!(result.throughput > 1.0, "{result:?}");
        // Later clicks change nothing.
        click(&mut task, 60_000, [0.0, 0.0]);
        assert_eq!(task.result(), result);
    }

    #[test]
    fn relative_motion_stays_on_the_screen_and_a_detour_costs_efficiency() {
        let mut task = PointingTask::new();
        click(&mut task, 0, target(0));
        for (x, y) in [(5000, 0), (-5000, 0)] {
            assert!(task.handle(&event(10, EventKind::MoveBy(x, y))));
        }
        assert_eq!(task.cursor[0], 0.0);
        click(&mut task, 900, target(1));
        assert!(task.result().path_efficiency < 0.4, "{:?}", task.result());
        let picture = task.lines();
        assert!(
            picture.iter().any(|line| line.contains("((O))")),
            "{picture:?}"
        );
        assert!(picture.iter().any(|line| line.contains('+')), "{picture:?}");
    }
}
