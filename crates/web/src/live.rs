//! Sensors that measure now, such as a webcam, and boards that are put under the hands that they see; and hands without readings.

use std::sync::Arc;
use std::time::Duration;

use ademan_core::calibrate::positions::{HoldAdvice, OpenHand};
use ademan_core::capture::{Reading, Sample};
use ademan_core::device::Events;
use ademan_core::document::{Document, DocumentError};
use ademan_core::hand::{JointPositions, Side};
use ademan_core::layout::Layout;
use ademan_core::objects::SceneState;
use ademan_core::time::Timestamp;
use serde::Serialize;

use crate::hand::{FollowedHand, Hand};
use crate::session::{NAME, PageSession};
use crate::under_hand::BoardsUnderHand;

/// Silence of a sensor after which its hands are lost. A slow machine finds hands in four images a second, and what is typed stays in the
/// page.
pub const MAX_SILENCE: Duration = Duration::from_millis(600);

/// The fraction of the second for which the other hand must have been held, too, when one hand is done.
const OTHER_HAND: f32 = 0.6;

/// The state of a sensor that measures now.
#[derive(Debug, Default)]
pub struct Live {
    /// The hands that are to be held open, by side.
    holding: Option<[OpenHand; Side::COUNT]>,
    advice: Option<HoldAdvice>,
    placement: Option<BoardsUnderHand>,
    /// The time of the latest reading.
    latest: Option<Timestamp>,
    /// `true` if the hands were lost because there are no readings.
    is_silent: bool,
    /// The news that the page has received.
    told: LiveNews,
}

/// The news about the place of the boards for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
struct LiveNews {
    /// The fraction of the second for which the hand has been held, in percent; `None` if the boards are not to be placed.
    holding: Option<u8>,
    /// The request to the person.
    advice: Option<&'static str>,
    /// `true` if the boards are under the hands.
    is_placed: bool,
}

/// The result of bytes of a sensor.
#[derive(Debug, Serialize)]
pub struct Pushed {
    /// Number of readings.
    readings: usize,
    /// The error in the latest line, if it was refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
}

impl PageSession {
    /// Receives bytes of a sensor that measures now, which move the hands. `format` is the protocol with its options.
    pub fn push_live(&mut self, format: &str, bytes: &[u8]) -> Result<Pushed, String> {
        if !matches!(&self.hand, Hand::Followed(hand) if hand.is_of(format, true)) {
            let hand = FollowedHand::live(format, self.time)?;
            // A change of options of the same sensor keeps the placement of the boards, and a request of the person for one.
            let live = std::mem::take(&mut self.live);
            self.release();
            self.live = live;
            self.follow(hand);
        }
        let Hand::Followed(hand) = &mut self.hand else {
            return Err("no sensor moves the hands".to_owned());
        };
        let readings = hand.push(bytes, self.time);
        self.live.is_silent = false;
        Ok(Pushed {
            readings,
            refused: hand.last_error(),
        })
    }

    /// Puts the boards under the hands of the sensor once they are held open and still for a second. A layout that waits for an open
    /// hand by itself starts to wait again.
    pub fn place_under_hands(&mut self) {
        self.lose_hands();
        if self.pipeline.layout().starts_at_hand() {
            let mut events = Events::new();
            // It cannot fail: the layout is placed again.
            let _ = self.pipeline.recenter(&mut events);
            self.write_events(&events);
            let text = "hold your open hand still for a second";
            return self.lines.add_notice(text);
        }
        self.live.holding = Some(Default::default());
        self.live.advice = Some(HoldAdvice::Show);
    }

    /// Reads a layout for the hands in use.
    pub(crate) fn layout_of(&self, text: &str) -> Result<Layout, DocumentError> {
        let document = Document::new(NAME, text);
        let Some(placement) = &self.live.placement else {
            return Layout::for_hands(document, self.fit);
        };
        let mut layout = Layout::for_hands(document, placement.fit())?;
        placement.place(&mut layout);
        Ok(layout)
    }

    /// Follows the readings of a period: releases what a silent sensor holds, or a recording that has a gap or ends, and places boards.
    pub(crate) fn follow_live(&mut self, readings: &[Reading]) {
        if !readings.is_empty() {
            self.live.latest = Some(self.time);
            self.live.is_silent = false;
        }
        let of_readings = self.live.latest.map(|last| self.time.since(last));
        let silence = match &self.hand {
            Hand::Followed(hand) => hand.silence(self.time).or(of_readings),
            Hand::Recorded(_) => of_readings,
            _ => None,
        };
        if silence.is_some_and(|it| it > MAX_SILENCE) && !self.live.is_silent {
            self.live.is_silent = true;
            self.lose_hands();
        }
        if let Some(holding) = &mut self.live.holding {
            for reading in readings {
                if let (Some(side), Sample::Joints { positions }) = (reading.side, &reading.sample)
                {
                    let own = &mut holding[side.index()];
                    let advice = own.update(reading.time, positions);
                    // The advice about a hand that is seen counts.
                    if advice != HoldAdvice::Show || holding.iter().all(|it| it.progress() == 0.0) {
                        self.live.advice = Some(advice);
                    }
                }
            }
            if holding.iter().any(|it| it.progress() >= 1.0) {
                self.place();
            }
        }
        self.tell_live();
    }

    fn place(&mut self) {
        let Some(holding) = self.live.holding.take() else {
            return;
        };
        let readings = holding.each_ref().map(|hand| -> &[JointPositions] {
            if hand.progress() >= OTHER_HAND {
                hand.readings()
            } else {
                &[]
            }
        });
        let placed = BoardsUnderHand::measure(readings).map_err(|error| error.to_string());
        let placed = placed.and_then(|placement| {
            self.live.placement = Some(placement);
            let layout = self.layout_of(&self.layout.text);
            layout.map_err(|error| error.to_string())
        });
        match placed {
            Ok(layout) => self.move_boards(layout),
            Err(text) => self.lines.add_notice(&text),
        }
    }

    /// Ends the placement by a sensor: the boards return to the poses of the layout.
    pub(crate) fn end_live(&mut self) {
        let live = std::mem::take(&mut self.live);
        self.live.told = live.told;
        if live.placement.is_some()
            && let Ok(layout) = self.layout_of(&self.layout.text)
        {
            self.move_boards(layout);
        }
        self.tell_live();
    }

    /// Replaces the layout by the same layout with other poses of its boards.
    pub(crate) fn move_boards(&mut self, layout: Layout) {
        self.adopt(Arc::new(layout));
        // Until a hand is seen, a viewer shows the boards at the poses of the layout, not at their previous poses.
        self.scene = SceneState::default();
        let lines = self.layout_lines();
        self.lines.bytes_mut().extend_from_slice(lines.as_bytes());
    }

    fn tell_live(&mut self) {
        let live = &self.live;
        let progress = live.holding.as_ref().map(|holding| {
            let progress = holding.iter().map(OpenHand::progress);
            (progress.fold(0.0, f32::max) * 20.0) as u8 * 5
        });
        let news = LiveNews {
            holding: progress,
            advice: progress.and(live.advice).map(|advice| match advice {
                HoldAdvice::Show => "show your open hand",
                HoldAdvice::Open => "stretch your fingers",
                HoldAdvice::Hold => "hold still",
            }),
            is_placed: live.placement.is_some(),
        };
        if news != live.told {
            self.lines.add("live", &news);
            self.live.told = news;
        }
    }
}
