//! A filter that notes what the devices type, and passes it on to a decoder.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use parry3d::math::Vec2;

use super::keyboard::{KeyPlaces, Touch};
use crate::contact::TargetId;
use crate::device::pressed_keys::PressedKeys;
use crate::device::{EventKind, Events, KeyCode, OutputEvent};
use crate::hand::Side;
use crate::layout::Layout;
use crate::pipeline::PressFilter;
use crate::pipeline::press_filter::FilterInput;
use crate::sim::UsTextField;
use crate::time::Timestamp;

/// The text that the devices type, and a decoder after them that lives as long as a person types.
pub(crate) struct Recorder {
    decoder: Box<dyn PressFilter>,
    keys: KeyPlaces,
    /// The transform of each key from the frame of its board to the frame of the key.
    centers: Vec<(TargetId, parry3d::math::Pose)>,
    literal: UsTextField,
    touches: Vec<Touch>,
}

impl Recorder {
    pub(crate) fn new(layout: &Layout, decoder: Box<dyn PressFilter>) -> Self {
        let centers = layout.keys.iter().filter_map(|key| {
            let (_, target) = layout.scene.target(key.face.target)?;
            Some((key.face.target, target.surface_from_target.inverse()))
        });
        Self {
            keys: KeyPlaces::new(layout, decoder.finds_letters()),
            decoder,
            centers: centers.collect(),
            literal: UsTextField::new(),
            touches: Vec::new(),
        }
    }

    pub(crate) fn keys(&self) -> &KeyPlaces {
        &self.keys
    }

    /// Ends a phrase: the person goes to another line. Returns what the devices typed, and the taps.
    pub(crate) fn end_phrase(&mut self) -> (String, Vec<Touch>) {
        let time = Timestamp::default();
        let mut events = Events::new();
        let enter = KeyCode::for_us_character('\n').next();
        events.extend(enter.map(|(enter, _)| OutputEvent {
            time,
            kind: EventKind::KeyDown(enter),
        }));
        let held = PressedKeys::default();
        let input = FilterInput {
            time,
            side: Side::Right,
            may_type: true,
            presses: &[],
            held: &held,
            contact: None,
        };
        self.decoder.filter(&input, &mut events);
        let literal = std::mem::take(&mut self.literal);
        (literal.text().to_owned(), std::mem::take(&mut self.touches))
    }

    fn note(&mut self, input: &FilterInput, events: &Events) {
        for event in events {
            self.literal.handle(event);
        }
        for press in input.presses {
            let center = self
                .centers
                .iter()
                .find(|(target, _)| *target == press.target);
            let point = center.map_or(Vec2::ZERO, |(_, target_from_surface)| {
                (*target_from_surface * press.point).truncate()
            });
            let Some(touch) = self.keys.touch(press.target, point) else {
                continue;
            };
            match touch.character {
                '\u{8}' => _ = self.touches.pop(),
                _ => self.touches.push(touch),
            }
        }
    }
}

/// A recorder in the pipelines of all phrases of a person.
#[derive(Clone)]
pub(crate) struct SharedRecorder(Arc<Mutex<Recorder>>);

impl SharedRecorder {
    pub(crate) fn new(recorder: Recorder) -> Self {
        Self(Arc::new(Mutex::new(recorder)))
    }

    pub(crate) fn lock(&self) -> MutexGuard<'_, Recorder> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl PressFilter for SharedRecorder {
    fn filter(&mut self, input: &FilterInput, events: &mut Events) {
        let mut recorder = self.lock();
        recorder.note(input, events);
        recorder.decoder.filter(input, events);
    }

    fn reset(&mut self) {
        self.lock().decoder.reset();
    }

    fn finds_letters(&self) -> bool {
        self.lock().decoder.finds_letters()
    }
}
