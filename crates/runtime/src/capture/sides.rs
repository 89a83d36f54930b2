//! A source that measures both hands, as one reading for each hand of a setup.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::{
    CancelToken, CaptureError, HeadsetList, Reading, Sample, SampleKind, Source, SourceEvent,
    SourceStats, SourceWait,
};
use ademan_core::hand::Side;

/// A source that repeats each reading of both arms, once for each side. If one converter carries two gloves, readings of sensor channels
/// are repeated, too.
///
/// Readings of one hand pass unchanged if the setup has that hand. Other readings are left out.
pub struct SidedSource {
    source: Box<dyn Source>,
    sides: ArrayVec<Side, { Side::COUNT }>,
    /// `true` if readings have the sensor channels of both gloves.
    has_two_gloves: bool,
    /// The latest reading, and the sides for which it was not returned.
    pending: Option<Reading>,
    remaining: ArrayVec<Side, { Side::COUNT }>,
    /// Readings returned beyond the readings of the source.
    repeated: u64,
    /// Readings of the source that were left out, and the side and the kind of the latest one.
    left_out: u64,
    latest_left_out: Option<(Side, SampleKind)>,
    /// `true` if a reading was returned, or a message said why none was.
    is_explained: bool,
}

/// Number of readings of another hand after which a source probably shows no hand of the setup: 1 to 3 s.
const MANY_LEFT_OUT: u64 = 100;

impl SidedSource {
    /// Creates a source with a reading for each of `sides`.
    pub fn new(source: Box<dyn Source>, sides: impl IntoIterator<Item = Side>) -> Self {
        Self {
            source,
            sides: sides.into_iter().collect(),
            has_two_gloves: false,
            pending: None,
            remaining: ArrayVec::new(),
            repeated: 0,
            left_out: 0,
            latest_left_out: None,
            is_explained: false,
        }
    }

    /// Creates a source with the sensor channels of the gloves of all `sides`.
    pub fn with_two_gloves(source: Box<dyn Source>, sides: impl IntoIterator<Item = Side>) -> Self {
        Self {
            has_two_gloves: true,
            ..Self::new(source, sides)
        }
    }

    /// Warns once that the source shows only another hand.
    fn explain(&mut self) {
        if self.is_explained {
            return;
        }
        if let Some((side, kind)) = self.latest_left_out {
            self.is_explained = true;
            // Sources of bone rotations have no such option.
            let option = match kind {
                SampleKind::Bones => String::new(),
                _ => format!("`hand={side}` to the options of the source, or "),
            };
            tracing::warn!(
                "{} shows only the {side} hand, which the setup does not use: add {option}`other_hand` to the setup for both hands",
                self.source.name()
            );
        }
    }

    /// Counts a reading that is left out, and warns if there are many.
    fn leave_out(&mut self, side: Side, kind: SampleKind) -> SourceEvent {
        self.left_out += 1;
        self.latest_left_out = Some((side, kind));
        if self.left_out >= MANY_LEFT_OUT {
            self.explain();
        }
        SourceEvent::Idle
    }

    /// Returns the pending reading for the next side.
    fn next_side(&mut self) -> Option<Reading> {
        let side = self.remaining.pop_at(0)?;
        let mut reading = if self.remaining.is_empty() {
            self.pending.take()?
        } else {
            self.pending.clone()?
        };
        reading.side = Some(side);
        Some(reading)
    }
}

impl Source for SidedSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if let Some(reading) = self.next_side() {
            self.repeated += 1;
            return Ok(SourceEvent::Reading(reading));
        }
        let event = self.source.next()?;
        if matches!(event, SourceEvent::End) {
            self.explain();
        }
        let SourceEvent::Reading(reading) = event else {
            return Ok(event);
        };
        let kind = reading.sample.kind();
        if let Some(side) = reading.side.filter(|side| !self.sides.contains(side)) {
            return Ok(self.leave_out(side, kind));
        }
        let mut sides = self.sides.clone();
        if let Sample::Bones { bones } = &reading.sample {
            let mut shown = Side::ALL
                .iter()
                .filter(|side| !bones.arm(**side).is_empty());
            sides.retain(|side| !bones.arm(*side).is_empty());
            if let Some(side) = shown.next().filter(|_| sides.is_empty()) {
                return Ok(self.leave_out(*side, kind));
            }
        }
        self.is_explained |= !sides.is_empty();
        if reading.side.is_some() {
            return Ok(SourceEvent::Reading(reading));
        }
        let is_of_two_gloves = self.has_two_gloves && kind == SampleKind::Channels;
        if !kind.shows_both_arms() && !is_of_two_gloves {
            return Ok(SourceEvent::Reading(reading));
        }
        self.remaining = sides;
        self.pending = Some(reading);
        let first = self.next_side();
        Ok(first.map_or(SourceEvent::Idle, SourceEvent::Reading))
    }

    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        self.source.set_cancel_token(cancel);
    }

    fn set_polled(&mut self) -> bool {
        self.source.set_polled()
    }

    fn wait(&self) -> Option<SourceWait<'_>> {
        if self.remaining.is_empty() {
            self.source.wait()
        } else {
            None
        }
    }

    fn headsets(&self) -> Option<HeadsetList> {
        self.source.headsets()
    }

    fn name(&self) -> &str {
        self.source.name()
    }

    fn packet_period(&self) -> Option<Duration> {
        self.source.packet_period()
    }

    fn is_live(&self) -> bool {
        self.source.is_live()
    }

    fn stop(&mut self) {
        self.source.stop();
    }

    fn stats(&self) -> SourceStats {
        let stats = self.source.stats();
        SourceStats {
            readings: stats.readings + self.repeated - self.left_out,
            left_out: self.left_out,
            ..stats
        }
    }
}
