//! Lines to a client: a response has the field `ok`, a notification the field `event` or `command`.

use serde::Serialize;

use super::ProfileInfo;
use crate::capture::{HeadsetStatus, InvalidPackets};
use crate::session::reply::{LearnedRanges, SessionStatus};
use crate::session::view::{PoseNumbers, View, ViewState, pose_numbers};
use crate::trace::{PressJson, command_json, event_json};
use ademan_core::command::CommandOrigin;
use ademan_core::contact::{Press, TargetNames};
use ademan_core::device::{CursorPosition, OutputEvent, TimedCommand};
use ademan_core::estimate::Rejection;
use ademan_core::hand::Dof;
use ademan_core::layout::{Fit, Layout};
use ademan_core::pipeline::{PipelineState, Suppressed};
use ademan_core::snapshot::Stats;
use ademan_text::filter::LearnedSummary;

/// A line without the newline.
pub(super) type JsonLine = Box<str>;

/// Returns the response to a request that was executed; `text` describes the outcome.
pub(super) fn success(text: Option<&str>) -> JsonLine {
    json(&Success { ok: true, text })
}

/// Returns the response to a request that was refused or failed.
pub(super) fn failure(error: &str) -> JsonLine {
    json(&Failure { ok: false, error })
}

/// The parts of a state that the session loop does not know.
#[derive(Default)]
pub(super) struct SessionContext<'a> {
    /// Profiles of the setup, in order.
    pub profiles: &'a [ProfileInfo],
    /// Application of the rule that holds.
    pub application: Option<&'a str>,
    /// Headset that a source waits for.
    pub headset: Option<HeadsetStatus>,
    /// Reasons why files are incomplete.
    pub incomplete: &'a [String],
}

/// Returns the response to `state`.
pub(super) fn state(status: &SessionStatus, context: SessionContext) -> JsonLine {
    let SessionContext {
        profiles,
        application,
        headset,
        incomplete,
    } = context;
    let profile = profiles.get(status.profile);
    let rejected: u64 = status.stats.rejected.iter().sum();
    json(&StateResponse {
        ok: true,
        state: status.state,
        paused: status.paused_by.is_some(),
        paused_by: status.paused_by,
        profile: profile.map(|profile| profile.name.as_str()),
        application,
        layout: profile.map(|profile| profile.file.as_str()),
        steps: status.stats.accepted + rejected,
        stats: StatsResponse::new(&status.stats),
        dropped_presses: status.stats.dropped_presses,
        pointer: status.cursor.as_ref().map(CursorJson::from),
        learned: status.learned.as_ref().map(LearnedJson::from),
        typing: status.typing.as_ref().map(TypingJson::from),
        headset,
        incomplete,
    })
}

/// Returns the notification of a new state.
pub(super) fn state_notification(
    state: PipelineState,
    paused_by: Option<CommandOrigin>,
) -> JsonLine {
    json(&NotificationLine::State {
        state,
        paused: paused_by.is_some(),
        paused_by,
    })
}

/// Returns the notification of a changed layout file; `active` tells whether its content is active.
pub(super) fn reload_notification(active: bool, text: &str) -> JsonLine {
    json(&NotificationLine::Reload { active, text })
}

/// Returns the notification of lines that were dropped because the client reads too slowly.
pub(super) fn missed_notification(count: u64) -> JsonLine {
    json(&NotificationLine::Missed { count })
}

/// Returns the notification of an output event, as the stage `events` of a trace.
pub(super) fn event_notification(
    event: &OutputEvent,
    names: &TargetNames,
    buffer: &mut Vec<u8>,
) -> JsonLine {
    String::from_utf8_lossy(event_json(event, names, buffer)).into()
}

/// Returns the notification of a press with its evidence, as the stage `presses` of a trace.
pub(super) fn press_notification(press: &Press, names: &TargetNames) -> JsonLine {
    json(&NotificationLine::Press(PressJson::new(press, names)))
}

/// Returns the notification of a command that a device issued, as the stage `commands` of a trace.
pub(super) fn command_notification(issued: &TimedCommand, buffer: &mut Vec<u8>) -> JsonLine {
    String::from_utf8_lossy(command_json(issued, buffer)).into()
}

/// Returns the notification of the layout that the following views show.
pub(super) fn layout_notification(layout: &Layout) -> JsonLine {
    json(&NotificationLine::Layout {
        file: &layout.file,
        text: &layout.text,
        fit: Some(&layout.fit).filter(|fit| **fit != Fit::default()),
    })
}

/// Returns the notification of a view.
pub(super) fn view_notification(view: &View) -> JsonLine {
    json(&NotificationLine::View {
        state: &view.state,
        boards: view.boards.iter().map(pose_numbers).collect(),
        messages: &view.messages,
        missed: view.missed,
    })
}

/// Returns the notification of a new position of the cursor.
pub(super) fn cursor_notification(cursor: &CursorPosition) -> JsonLine {
    json(&NotificationLine::Pointer(CursorJson::from(cursor)))
}

fn json(value: &impl Serialize) -> JsonLine {
    serde_json::to_string(value)
        .expect("writing to memory succeeds, and every key is a string")
        .into()
}

#[derive(Serialize)]
struct Success<'a> {
    ok: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<&'a str>,
}

#[derive(Serialize)]
struct Failure<'a> {
    ok: bool,
    error: &'a str,
}

#[derive(Serialize)]
struct StateResponse<'a> {
    ok: bool,
    state: PipelineState,
    paused: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    paused_by: Option<CommandOrigin>,
    profile: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    application: Option<&'a str>,
    layout: Option<&'a str>,
    steps: u64,
    stats: StatsResponse,
    dropped_presses: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pointer: Option<CursorJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    learned: Option<LearnedJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    typing: Option<TypingJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    headset: Option<HeadsetStatus>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    incomplete: &'a [String],
}

/// The ranges of sensors that were learned: their number, and the joint and the widening of the widest one.
#[derive(Serialize)]
struct LearnedJson {
    channels: usize,
    largest: Dof,
    percent: u8,
}

impl From<&LearnedRanges> for LearnedJson {
    fn from(learned: &LearnedRanges) -> Self {
        Self {
            channels: learned.channels,
            largest: learned.largest.dof,
            percent: (learned.largest.largest() * 100.0).round() as u8,
        }
    }
}

/// Knowledge of the text decoder: the taps, their distance from the centers of keys, and the number of the person's words.
#[derive(Serialize)]
struct TypingJson {
    taps: u32,
    offset_mm: [f32; 2],
    scatter_mm: [f32; 2],
    words: usize,
}

impl From<&LearnedSummary> for TypingJson {
    fn from(typing: &LearnedSummary) -> Self {
        // A negative zero has no meaning here.
        let rounded = |(x, y): (f32, f32)| [x, y].map(|value| (value * 10.0).round() / 10.0 + 0.0);
        Self {
            taps: typing.taps.taps.round() as u32,
            offset_mm: rounded(typing.taps.offset_mm),
            scatter_mm: rounded(typing.taps.scatter_mm),
            words: typing.words,
        }
    }
}

/// The position of a cursor: in its range, 0..=1, and in each space in millimetres.
#[derive(Serialize)]
struct CursorJson {
    position: Option<[f32; 3]>,
    in_spaces_mm: Vec<Option<[f32; 3]>>,
}

impl From<&CursorPosition> for CursorJson {
    fn from(cursor: &CursorPosition) -> Self {
        let in_spaces = cursor.in_spaces.iter();
        Self {
            position: cursor.fractions.map(|position| position.to_array()),
            in_spaces_mm: in_spaces
                .map(|position| position.map(|position| (position * 1e3).to_array()))
                .collect(),
        }
    }
}

#[derive(Serialize)]
struct StatsResponse {
    received: u64,
    accepted: u64,
    #[serde(serialize_with = "by_reason")]
    rejected: [u64; Rejection::COUNT],
    /// Packets that gave no reading; only the reasons that occurred.
    invalid: InvalidPackets,
    dropped: u64,
    stalls: u64,
    losses: u64,
    suppressed: Suppressed,
}

impl StatsResponse {
    fn new(stats: &Stats) -> Self {
        Self {
            received: stats.source.readings,
            accepted: stats.accepted,
            rejected: stats.rejected,
            invalid: stats.source.invalid,
            dropped: stats.source.dropped,
            stalls: stats.stalls,
            losses: stats.source.losses,
            suppressed: stats.suppressed,
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
enum NotificationLine<'a> {
    State {
        state: PipelineState,
        paused: bool,
        #[serde(skip_serializing_if = "Option::is_none")]
        paused_by: Option<CommandOrigin>,
    },
    Reload {
        active: bool,
        text: &'a str,
    },
    Missed {
        count: u64,
    },
    Press(PressJson<'a>),
    Pointer(CursorJson),
    Layout {
        file: &'a str,
        text: &'a str,
        #[serde(skip_serializing_if = "Option::is_none")]
        fit: Option<&'a Fit>,
    },
    View {
        #[serde(flatten)]
        state: &'a ViewState,
        boards: Vec<PoseNumbers>,
        messages: &'a [String],
        missed: u64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::Headset;
    use ademan_core::estimate::LearnedRange;
    use ademan_text::filter::LearnedTaps;
    use serde_json::json;

    #[test]
    fn a_state_names_the_profile_and_counts_every_reading() {
        let mut stats = Stats {
            accepted: 7,
            stalls: 1,
            dropped_presses: 3,
            ..Stats::default()
        };
        stats.source.readings = 10;
        stats.source.dropped = 1;
        stats.rejected[0] = 2;
        let status = SessionStatus {
            state: PipelineState::Paused,
            paused_by: Some(CommandOrigin::RateLimit),
            profile: 0,
            stats,
            cursor: None,
            learned: LearnedRanges::new([learned(3, 0.02), learned(5, 0.11)].into_iter()),
            typing: Some(LearnedSummary {
                taps: LearnedTaps {
                    taps: 411.6,
                    offset_mm: (1.26, -0.04),
                    scatter_mm: (3.0, 2.5),
                    correlation: 0.1,
                },
                words: 2,
            }),
        };
        let profiles = [ProfileInfo {
            name: "My board".into(),
            file: "my.ron".into(),
        }];
        let context = SessionContext {
            profiles: &profiles,
            application: Some("foot"),
            ..SessionContext::default()
        };
        let line: serde_json::Value = serde_json::from_str(&state(&status, context)).unwrap();
        let reason = Rejection::ALL[0].name();
        assert_eq!(line["stats"]["rejected"][reason], 2);
        assert_eq!(line["stats"]["received"], 10);
        assert_eq!(line["steps"], 9);
        assert_eq!(line["profile"], "My board");
        assert_eq!(line["application"], "foot");
        assert_eq!(line["layout"], "my.ron");
        assert_eq!(line["paused"], true);
        assert_eq!(line["paused_by"], "rate-limit");
        assert_eq!(line["state"], "paused");
        assert_eq!(line["dropped_presses"], 3);
        let expected = json!({"channels": 2, "largest": "index-mcp-flexion", "percent": 11});
        assert_eq!(line["learned"], expected);
        let typing =
            json!({"taps": 412, "offset_mm": [1.3, 0.0], "scatter_mm": [3.0, 2.5], "words": 2});
        assert_eq!(line["typing"], typing);
        assert_eq!(line.get("headset"), None, "its source waits for none");
    }

    #[test]
    fn a_state_names_the_headset_or_says_that_none_is_connected() {
        let status = SessionStatus {
            state: PipelineState::Running,
            paused_by: None,
            profile: 0,
            stats: Stats::default(),
            cursor: None,
            learned: None,
            typing: None,
        };
        let headset = Headset::new("Quest 3", [192, 168, 1, 9].into());
        for (connected, expected) in [
            (None, json!({ "connected": null })),
            (
                Some(headset),
                json!({"connected": {"name": "Quest 3", "address": "192.168.1.9"}}),
            ),
        ] {
            let context = SessionContext {
                headset: Some(HeadsetStatus { connected }),
                ..SessionContext::default()
            };
            let line = state(&status, context);
            let line: serde_json::Value = serde_json::from_str(&line).unwrap();
            assert_eq!(line["headset"], expected);
        }
    }

    fn learned(channel: usize, above: f64) -> LearnedRange {
        LearnedRange {
            channel,
            dof: Dof::IndexMcpFlexion,
            below: 0.0,
            above,
        }
    }

    #[test]
    fn responses_and_notifications_are_one_line_each() {
        assert_eq!(&*success(None), r#"{"ok":true}"#);
        assert_eq!(
            &*failure("a.ron:1:2: \"no\"\nstays"),
            r#"{"ok":false,"error":"a.ron:1:2: \"no\"\nstays"}"#
        );
        assert_eq!(
            &*reload_notification(true, "x"),
            r#"{"event":"reload","active":true,"text":"x"}"#
        );
        assert_eq!(&*missed_notification(2), r#"{"event":"missed","count":2}"#);
        assert_eq!(
            &*state_notification(PipelineState::Paused, None),
            r#"{"event":"state","state":"paused","paused":false}"#
        );
    }
}
