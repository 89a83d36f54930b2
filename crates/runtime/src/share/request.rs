//! Requests of clients: the kinds of objects that they want, and how often.

use std::time::{Duration, Instant};

use serde::Deserialize;

use super::kinds::{KindSet, LineKind, ShareKind};
use super::lines::Line;
use super::step::SharedStep;
use ademan_core::hand::Side;
use ademan_core::message::escape;
use ademan_core::time::Timestamp;

/// Longest request, in bytes.
pub(super) const MAX_REQUEST_BYTES: usize = 4096;

/// Returns the reason why a longer request is refused.
pub(super) fn too_long() -> String {
    format!("a request has at most {MAX_REQUEST_BYTES} bytes")
}

/// Most requests of a client in a second.
pub(super) const MAX_REQUESTS_PER_SECOND: u32 = 10;

/// Range of the rate limit.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.1..=10_000.0;

/// A request as written: `{"kinds":["pose","events"],"rate_hz":30}`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    kinds: Vec<ShareKind>,
    rate_hz: Option<f64>,
}

/// The kinds that a client has asked for, and the limit of their rate.
#[derive(Debug, Default)]
pub(super) struct Subscription {
    kinds: KindSet,
    /// Shortest time between two objects of a continuous kind and a hand.
    period: Option<Duration>,
    /// The time from which the next one is due: of each hand, and of readings of both.
    due_at: [Option<Timestamp>; Side::COUNT + 1],
    /// `true` if the present step is due.
    is_due: bool,
    /// The number of the layout that was sent.
    layout: u64,
}

impl Subscription {
    /// Creates a subscription to one kind, of every step.
    pub fn to(kind: LineKind) -> Self {
        Self {
            kinds: KindSet::only(kind),
            ..Self::default()
        }
    }

    /// Reads a request. The error states what to send.
    pub fn parse(request: &[u8]) -> Result<Self, String> {
        let request: Request = serde_json::from_slice(request).map_err(|error| {
            let error = error.to_string();
            format!(
                r#"not a request: {}; send {{"kinds":["pose","events"],"rate_hz":60}}"#,
                escape(&error)
            )
        })?;
        if request
            .rate_hz
            .is_some_and(|rate| !RATES_HZ.contains(&rate))
        {
            return Err(format!(
                "rate_hz is {} to {}",
                RATES_HZ.start(),
                RATES_HZ.end()
            ));
        }
        Ok(Self {
            kinds: KindSet::of_objects(request.kinds),
            period: request
                .rate_hz
                .map(|rate| Duration::from_secs_f64(1.0 / rate)),
            ..Self::default()
        })
    }

    /// Returns the kinds that are wanted of a step, before [`wants`](Self::wants) is asked about its lines.
    pub fn start_step(&mut self, step: &SharedStep) -> KindSet {
        self.is_due = self.becomes_due(step);
        if self.is_due {
            self.kinds
        } else {
            self.kinds.without_continuous()
        }
    }

    /// Returns `true` if it is a subscription to nothing.
    pub fn is_empty(&self) -> bool {
        self.kinds == KindSet::default()
    }

    /// Returns `true` if a line of the present step is wanted.
    pub fn wants(&self, line: &Line) -> bool {
        self.kinds.contains(line.kind) && (self.is_due || !line.is_continuous)
    }

    /// Returns `true` if a layout is wanted and was not sent, and remembers it as sent.
    pub fn starts_layout(&mut self, number: u64) -> bool {
        let is_wanted = self.kinds.contains(LineKind::Object(ShareKind::Layout));
        is_wanted && std::mem::replace(&mut self.layout, number) != number
    }

    /// Forgets which layout was sent, as it may have been dropped.
    pub fn forget_layout(&mut self) {
        self.layout = 0;
    }

    fn becomes_due(&mut self, step: &SharedStep) -> bool {
        let (Some(period), Some(reading)) = (self.period, &step.snapshot.reading) else {
            return true;
        };
        let side = step.snapshot.pose.as_ref().map(|pose| pose.side);
        let due_at = &mut self.due_at[side.map_or(Side::COUNT, Side::index)];
        let now = reading.time;
        let next = match *due_at {
            // The time of a source may start again.
            Some(due) if now < due && due.since(now) <= period => return false,
            // The mean rate is exact although readings come at other times.
            Some(due) if now.since(due) < period => due + period,
            _ => now + period,
        };
        *due_at = Some(next);
        true
    }
}

/// A limit of the number of something within a second.
pub(super) struct RateLimit {
    max: u32,
    /// The name of what is counted, in the plural.
    name: &'static str,
    second: Instant,
    count: u32,
}

impl RateLimit {
    /// Creates a limit before the first one.
    pub fn new(max: u32, name: &'static str) -> Self {
        Self {
            max,
            name,
            second: Instant::now(),
            count: 0,
        }
    }

    /// Counts one. The error is the reason why it is one too many.
    pub fn count(&mut self) -> Result<(), String> {
        if self.second.elapsed() >= Duration::from_secs(1) {
            (self.second, self.count) = (Instant::now(), 0);
        }
        self.count = self.count.saturating_add(1);
        if self.count > self.max {
            return Err(format!("more than {} {} in a second", self.max, self.name));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_has_kinds_and_a_rate_within_its_range() {
        let error = |text: &str| {
            Subscription::parse(text.as_bytes())
                .err()
                .unwrap_or_default()
        };
        assert_eq!(error(r#"{"kinds":["pose"],"rate_hz":0.1}"#), "");
        assert_eq!(error(r#"{"kinds":[]}"#), "");
        for (text, part) in [
            ("", "send {\"kinds\""),
            ("{}", "missing field `kinds`"),
            (r#"{"kinds":"pose"}"#, "expected a sequence"),
            (r#"{"kinds":["pose"],"kinds":[]}"#, "duplicate field"),
            (r#"{"kinds":["psoe"]}"#, "did you mean `pose`?"),
            (r#"{"kinds":[],"rate_hz":-1}"#, "rate_hz is 0.1 to 10000"),
            (r#"{"kinds":[]} {}"#, "trailing characters"),
        ] {
            assert!(error(text).contains(part), "{text}: {}", error(text));
        }
        assert!(Subscription::parse(b"\xff").is_err());
    }

    #[test]
    fn the_eleventh_request_of_a_second_is_refused() {
        let mut limit = RateLimit::new(MAX_REQUESTS_PER_SECOND, "requests");
        assert!((0..10).all(|_| limit.count().is_ok()));
        assert!(limit.count().is_err());
    }
}
