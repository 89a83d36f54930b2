//! A person clicks on the targets of rings, sees the cursor and corrects (ISO/TS 9241-411:2012, annex B).
//!
//! ```text
//!  target ─▶ person (sees the cursor 100 ms later) ─▶ movement of the hand ─▶ sensors ─▶ Pipeline ─▶ cursor ─┐
//!                        └───────────────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! The times of movements come from the person's own constants of Fitts's law, and are an input. A pointer adds late, noisy and curved
//! paths of the cursor, which take corrections, and clicks that slip.

mod cursor;
mod person;

use serde::{Deserialize, Serialize};

use self::cursor::{Cursor, IdealCursor, ScreenCursor};
use self::person::Pointing;
use super::station::Station;
use crate::measures::{PointerPath, PointingResult, Ring, distance};

/// Number of targets in a ring, 13 to 25 in studies. It is odd, so that each movement crosses the ring.
const TARGETS: usize = 13;
/// The diameter of a ring, as a fraction of the height of the screen.
const DIAMETER: f64 = 0.7;
/// The widths of the targets, as fractions of the height of the screen: 96, 48 and 24 px of 800.
const WIDTHS: [f64; 3] = [0.12, 0.06, 0.03];

/// The figures of one person with a pointer.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointingScore {
    /// A series for each width of targets, the widest first.
    pub series: Vec<PointingSeries>,
    /// The throughput of the same person with a cursor that follows the hand at once and without errors, in bits per second; `None`
    /// for a pointer whose velocity follows the hand.
    pub ideal_throughput: Option<f64>,
}

/// The figures of one ring.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointingSeries {
    /// The diameter of the targets, in pixels.
    pub width_px: f64,
    /// The diameter of the ring, in pixels.
    pub ring_px: f64,
    /// The figures of the clicks.
    pub result: PointingResult,
    /// Number of clicks beside the target that began with the cursor on it.
    pub slips: usize,
    /// The mean distance that the cursor moved from the beginning of a click to the click, in pixels.
    pub slip_px: f64,
    /// The number of clicks on targets, the first one included, which starts the clock.
    pub clicks: usize,
    /// Number of targets that were given up, because the cursor did not reach them or no click came.
    pub given_up: usize,
}

impl PointingScore {
    /// Returns the mean throughput of the series, in bits per second; 0 without a series.
    pub fn throughput(&self) -> f64 {
        let sum: f64 = self.series.iter().map(|it| it.result.throughput).sum();
        sum / self.series.len().max(1) as f64
    }

    /// Returns the mean of a figure over the clicks of all series; 0 without a click.
    pub fn mean(&self, figure: impl Fn(&PointingResult) -> f64) -> f64 {
        let results = self.series.iter().map(|it| &it.result);
        let sum: f64 = results.map(|it| figure(it) * it.targets as f64).sum();
        sum / self.clicks().max(1) as f64
    }

    /// Returns the number of clicks in all series.
    pub fn clicks(&self) -> usize {
        self.series.iter().map(|it| it.result.targets).sum()
    }
}

impl Station {
    /// Clicks on rings of targets with the pointer of the layout; `None` if it has none that moves a cursor, or none that the hand can
    /// use.
    pub fn point(&mut self, seed: u64) -> Option<PointingScore> {
        let settings = self.layout.pointer.clone()?;
        let hand = self.hands.iter().position(|hand| {
            let side = settings.side.unwrap_or(hand.side());
            side == hand.side()
        })?;
        let screen = [settings.screen_px.x, settings.screen_px.y].map(f64::from);
        let mut score = PointingScore::default();
        let mut ideal = Vec::new();
        for (index, width) in WIDTHS.into_iter().enumerate() {
            let ring = Ring {
                targets: TARGETS,
                center: [screen[0] / 2.0, screen[1] / 2.0],
                diameter: DIAMETER * screen[1],
                width: width * screen[1],
            };
            let seed = crate::people::mix(seed ^ index as u64);
            let cursor = ScreenCursor::new(self, screen);
            let (series, jacobian) = self.series(cursor, &settings, (hand, seed), ring)?;
            score.series.push(series);
            if let Some(jacobian) = jacobian {
                let ideal_cursor = IdealCursor::new(screen, jacobian);
                let (ideal_series, _) = self.series(ideal_cursor, &settings, (hand, seed), ring)?;
                ideal.push(ideal_series.result.throughput);
            }
        }
        let sum: f64 = ideal.iter().sum();
        score.ideal_throughput = (!ideal.is_empty()).then(|| sum / ideal.len() as f64);
        Some(score)
    }

    /// Clicks on each target of a ring once. Also returns what the person has learned of the cursor.
    fn series(
        &mut self,
        cursor: impl Cursor,
        settings: &crate::device::pointer::PointerSettings,
        (hand, seed): (usize, u64),
        ring: Ring,
    ) -> Option<(PointingSeries, Option<person::Jacobian>)> {
        let period = 1.0 / self.source.rate_hz();
        let waits = self.layout.scene.starts_at_hand() || starts_at_hand(settings);
        let hand = &mut self.hands[hand];
        let mut pointing = Pointing::begin(hand, cursor, settings, (seed, period), waits)?;
        let mut series = PointingSeries {
            width_px: ring.width,
            ring_px: ring.diameter,
            ..PointingSeries::default()
        };
        let (mut movements, mut slip) = (Vec::new(), 0.0);
        let mut last = None;
        for click in 0..=ring.targets {
            let to = ring.target(click);
            let Some(clicked) = pointing.click_on(to, ring.width) else {
                series.given_up += 1;
                last = None;
                continue;
            };
            let is_hit = distance(clicked.place, to) <= ring.width / 2.0;
            let was_on = distance(clicked.meant, to) <= ring.width / 2.0;
            series.slips += usize::from(was_on && !is_hit);
            slip += distance(clicked.meant, clicked.place);
            if let Some((place, seconds)) = last.replace((clicked.place, clicked.seconds)) {
                let mut path = PointerPath::new(&ring, click, place);
                for position in &clicked.path {
                    path.go_to(*position);
                }
                movements.push(path.click(clicked.seconds - seconds));
            }
        }
        series.clicks = ring.targets + 1 - series.given_up;
        series.slip_px = slip / series.clicks.max(1) as f64;
        series.result = PointingResult::new(&movements);
        let jacobian = pointing.jacobian();
        Some((series, jacobian))
    }
}

fn starts_at_hand(settings: &crate::device::pointer::PointerSettings) -> bool {
    let frame = settings.mode.frame();
    frame.is_some_and(|frame| frame.anchor == crate::contact::surface::Anchor::Start)
}
