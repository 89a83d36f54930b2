//! Lines for a client: answers have an `ok`, news have an `event`.

use serde::Serialize;

use super::ProfileInfo;
use crate::contact::TargetNames;
use crate::device::OutputEvent;
use crate::estimate::Rejection;
use crate::pipeline::{PipelineState, Suppressed};
use crate::session::status::SessionStatus;
use crate::snapshot::Stats;
use crate::trace::event_json;

/// A line without its end.
pub(super) type JsonLine = Box<str>;

/// What was asked for is done; `text` says what came of it, where there is more to say.
pub(super) fn success(text: Option<&str>) -> JsonLine {
    json(&Done { ok: true, text })
}

/// What was asked for is not done, for this reason.
pub(super) fn failure(error: &str) -> JsonLine {
    json(&Refused { ok: false, error })
}

/// How the run is.
pub(super) fn state(run: &SessionStatus, profiles: &[ProfileInfo]) -> JsonLine {
    let profile = profiles.get(run.profile);
    let rejected: u64 = run.stats.rejected.iter().sum();
    json(&StateResponse {
        ok: true,
        state: run.state,
        paused: run.is_paused,
        profile: profile.map(|profile| profile.name.as_str()),
        layout: profile.map(|profile| profile.file.as_str()),
        steps: run.stats.accepted + rejected,
        stats: StatsResponse::of(&run.stats),
        refused_presses: run.dropped_presses,
    })
}

/// The engine does something else now.
pub(super) fn state_notification(state: PipelineState, paused: bool) -> JsonLine {
    json(&News::State { state, paused })
}

/// What became of a layout file.
pub(super) fn reload_notification(in_force: bool, text: &str) -> JsonLine {
    json(&News::Reload { in_force, text })
}

/// So much that happened was not told, as it was not read fast enough.
pub(super) fn missed_notification(count: u64) -> JsonLine {
    json(&News::Missed { count })
}

/// Something went out.
pub(super) fn event_notification(
    event: &OutputEvent,
    names: &TargetNames,
    buffer: &mut Vec<u8>,
) -> JsonLine {
    String::from_utf8_lossy(event_json(event, names, buffer)).into()
}

fn json(value: &impl Serialize) -> JsonLine {
    serde_json::to_string(value)
        .expect("memory takes what is written, and every key is a string")
        .into()
}

#[derive(Serialize)]
struct Done<'a> {
    ok: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<&'a str>,
}

#[derive(Serialize)]
struct Refused<'a> {
    ok: bool,
    error: &'a str,
}

#[derive(Serialize)]
struct StateResponse<'a> {
    ok: bool,
    state: PipelineState,
    paused: bool,
    profile: Option<&'a str>,
    layout: Option<&'a str>,
    steps: u64,
    stats: StatsResponse,
    refused_presses: u64,
}

#[derive(Serialize)]
struct StatsResponse {
    received: u64,
    accepted: u64,
    #[serde(serialize_with = "by_reason")]
    rejected: [u64; Rejection::COUNT],
    dropped: u64,
    stalls: u64,
    losses: u64,
    suppressed: Suppressed,
}

impl StatsResponse {
    fn of(tally: &Stats) -> Self {
        Self {
            received: tally.source.readings,
            accepted: tally.accepted,
            rejected: tally.rejected,
            dropped: tally.source.dropped,
            stalls: tally.stalls,
            losses: tally.source.losses,
            suppressed: tally.suppressed,
        }
    }
}

fn by_reason<S: serde::Serializer>(
    counts: &[u64; Rejection::COUNT],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(Rejection::ALL.iter().zip(counts))
}

#[derive(Serialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
enum News<'a> {
    State { state: PipelineState, paused: bool },
    Reload { in_force: bool, text: &'a str },
    Missed { count: u64 },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_says_who_is_in_force_and_accounts_for_every_reading() {
        let mut tally = Stats {
            accepted: 7,
            stalls: 1,
            ..Stats::default()
        };
        tally.source.readings = 10;
        tally.source.dropped = 1;
        tally.rejected[0] = 2;
        let run = SessionStatus {
            state: PipelineState::Paused,
            is_paused: true,
            profile: 0,
            stats: tally,
            dropped_presses: 3,
        };
        let profiles = [ProfileInfo {
            name: "My board".into(),
            file: "my.ron".into(),
        }];
        let line: serde_json::Value = serde_json::from_str(&state(&run, &profiles)).unwrap();
        let reason = Rejection::ALL[0].name();
        assert_eq!(line["stats"]["rejected"][reason], 2);
        assert_eq!(line["stats"]["received"], 10);
        assert_eq!(line["steps"], 9);
        assert_eq!(line["profile"], "My board");
        assert_eq!(line["layout"], "my.ron");
        assert_eq!(line["paused"], true);
        assert_eq!(line["state"], "paused");
        assert_eq!(line["refused_presses"], 3);
    }

    #[test]
    fn answers_and_news_are_one_line_each() {
        assert_eq!(&*success(None), r#"{"ok":true}"#);
        assert_eq!(
            &*failure("a.ron:1:2: \"no\"\nstays"),
            r#"{"ok":false,"error":"a.ron:1:2: \"no\"\nstays"}"#
        );
        assert_eq!(
            &*reload_notification(true, "x"),
            r#"{"event":"reload","in_force":true,"text":"x"}"#
        );
        assert_eq!(&*missed_notification(2), r#"{"event":"missed","count":2}"#);
        assert_eq!(
            &*state_notification(PipelineState::Paused, false),
            r#"{"event":"state","state":"paused","paused":false}"#
        );
    }
}
