//! A recording of the simulated typist, forwards and backwards.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::*;
use crate::history::{Moment, SentEvent};
use crate::model::StudioModel;
use ademan_core::document::Document;
use ademan_core::hand::Finger;
use ademan_core::snapshot::Snapshot;
use ademan_core::time::Timestamp;
use ademan_runtime::capture::recording::Replay;
use ademan_runtime::capture::{Hc11Format, Reading, Source, SourceEvent};
use ademan_runtime::recorder::Recorder;
use ademan_runtime::session::{command_channel, replay};
use ademan_runtime::setup::{ArmSetup, Setup};

/// Records the typist on a layout.
fn record(folder: &Path, text: &str) -> PathBuf {
    record_with(ArmSetup::default(), folder, text)
}

/// Records the typist with an arm.
fn record_with(arm: ArmSetup, folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("typist.mcap");
    let setup = Setup {
        arm,
        output: "none".into(),
        ..Setup::default()
    };
    let setup = setup.load_files().unwrap();
    let format = Hc11Format::default();
    let typist = setup.typist(text, &format, 0.0, 0).unwrap();
    let recorded = setup.recorded_setup();
    let recorded = recorded.with_packet_period(Some(typist.packet_period()));
    let mut recorder = Recorder::create(&path, &recorded).unwrap();
    let mut observe = |step: &ademan_core::snapshot::StepView, _: &_, _: Option<_>| {
        recorder.write(&step.to_snapshot()).unwrap();
    };
    replay(&setup, typist, &command_channel().1, &mut observe).unwrap();
    recorder.finish().unwrap();
    path
}

/// A player with the model that it changes.
struct Shown {
    player: Player,
    model: StudioModel,
}

impl Shown {
    /// Opens a recording and loads it to its end.
    fn open(path: &Path) -> Self {
        let recording = Recording::open(path, None).unwrap();
        let model = recording.first_model();
        let player = Player::open(recording).unwrap();
        let mut shown = Self { player, model };
        shown.player.apply(Move::Pause);
        let start = std::time::Instant::now();
        while !shown.player.is_complete() {
            assert!(start.elapsed().as_secs() < 60, "it is not loaded");
            shown.advance(Duration::ZERO);
            std::thread::yield_now();
        }
        shown.advance(Duration::ZERO);
        shown
    }

    fn advance(&mut self, elapsed: Duration) {
        self.player.advance(elapsed, &mut self.model);
    }

    fn show(&mut self, index: usize) -> Content {
        self.player.apply(Move::Step(index));
        self.advance(Duration::ZERO);
        assert!(self.player.is_shown());
        Content::new(&self.model)
    }
}

/// All digits of a model.
#[derive(Clone, Default, PartialEq)]
struct Content {
    state: String,
    history: Vec<u32>,
    events: Vec<SentEvent>,
}

impl Content {
    fn new(model: &StudioModel) -> Self {
        let view = &model.view;
        let state = (&model.poses, &model.contacts, &model.angles, &model.stats);
        Self {
            state: format!("{state:?} {:?} {:?}", view.boards, view.state),
            history: model.history.moments().flat_map(bits).collect(),
            events: model.history.events().copied().collect(),
        }
    }
}

/// The bits of a moment. Unknown values are NaN, which differ from themselves.
fn bits(moment: &Moment) -> impl Iterator<Item = u32> {
    let heights = moment.heights_mm.iter().flatten();
    let values = moment.degrees.iter().chain(heights).copied();
    let values: Vec<u32> = values.map(f32::to_bits).collect();
    let pressing = moment.pressing.map(|set| {
        let fingers = Finger::ALL.iter().filter(|finger| set.contains(**finger));
        fingers.map(|finger| 1_u32 << finger.index()).sum::<u32>()
    });
    values
        .into_iter()
        .chain([moment.time.0 as u32])
        .chain(pressing)
}

/// The models of a straight replay at some steps.
fn straight(path: &Path, indices: &[usize]) -> Vec<Content> {
    let recording = Recording::open(path, None).unwrap();
    let mut model = recording.first_model();
    let mut contents = vec![Content::default(); indices.len()];
    let mut index = 0;
    let mut observe = |step: &ademan_core::snapshot::StepView, _: &_, view: Option<_>| {
        if let Some(view) = view {
            model.view = view;
        }
        // This replay takes another time than the recorded session did.
        model.update(&Snapshot {
            latency: None,
            ..step.to_snapshot()
        });
        for (content, _) in contents
            .iter_mut()
            .zip(indices)
            .filter(|(_, i)| **i == index)
        {
            *content = Content::new(&model);
        }
        index += 1;
    };
    let source = Replay::open(path).unwrap();
    replay(&recording.setup, source, &command_channel().1, &mut observe).unwrap();
    contents
}

fn readings(path: &Path) -> Vec<Reading> {
    let mut replay = Replay::open(path).unwrap();
    let mut readings = Vec::new();
    loop {
        match replay.next().unwrap() {
            SourceEvent::Reading(reading) => readings.push(reading),
            SourceEvent::End => return readings,
            _ => {}
        }
    }
}

const TEXT: &str = "the quick brown fox jumps over the lazy dog again and again until the recording is longer than the history";

#[test]
fn scrubbing_back_and_forth_shows_what_a_straight_replay_shows() {
    let folder = tempfile::tempdir().unwrap();
    let path = record(folder.path(), TEXT);
    let mut shown = Shown::open(&path);
    let last = shown.player.len() - 1;
    let (_, end) = shown.player.range().unwrap();
    assert!(end.seconds() > 35.0, "the history drops moments: {end:?}");
    let mut indices = vec![
        last,
        0,
        last / 2,
        last / 2 - 1,
        3,
        last - 1,
        last / 3,
        1,
        last,
    ];
    // One of them is within a press: a letter takes 75 readings, a press at least 15.
    indices.extend((0..5).map(|step| last / 2 + 15 * step));
    let expected = straight(&path, &indices);
    for (&index, wanted) in indices.iter().zip(&expected) {
        assert!(shown.show(index) == *wanted, "step {index} of {last}");
    }
    let is_pressed = |content: &Content| content.state.contains("is_pressed: true");
    assert!(expected.iter().any(is_pressed));
    assert!(!expected[0].history.is_empty() && !expected[0].events.is_empty());
}

#[test]
fn what_is_not_drawn_of_the_arm_of_a_recording_is_said_at_each_step() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = Document::shipped("unam").unwrap().text;
    let end = shipped.rfind(')').unwrap();
    let shapes = r#"shapes: [(file: "a.obj", joint: "wrist")])"#;
    let arm = folder.path().join("own.ron");
    std::fs::write(&arm, format!("{}{shapes}", &shipped[..end])).unwrap();
    let arm = ArmSetup::Model(arm.display().to_string());
    let path = record_with(arm, folder.path(), "hi");
    let mut shown = Shown::open(&path);
    let last = shown.player.len() - 1;
    for index in [last, 0] {
        shown.show(index);
        let errors: Vec<&str> = shown.model.shapes.errors().collect();
        assert_eq!(errors.len(), 1, "step {index}: {errors:?}");
        assert!(errors[0].contains("a.obj"), "{errors:?}");
    }
}

#[test]
fn playing_reaches_the_end_and_starts_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = record(folder.path(), "hello");
    let mut shown = Shown::open(&path);
    shown.player.apply(Move::Play);
    shown.player.apply(Move::Speed(10.0));
    shown.advance(Duration::from_millis(100));
    let player = &shown.player;
    let (start, end) = player.range().unwrap();
    let played = player.time().since(start).as_secs_f64();
    assert!((0.9..=1.0).contains(&played), "{played} s");
    shown.advance(Duration::from_secs(3600));
    let ended = &mut shown.player;
    assert_eq!((ended.time(), ended.is_playing()), (end, false));
    ended.apply(Move::Play);
    shown.advance(Duration::ZERO);
    let restarted = &shown.player;
    assert_eq!((restarted.time(), restarted.is_playing()), (start, true));
}

#[test]
fn a_gap_of_an_hour_is_played_in_two_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let path = record(folder.path(), "hello");
    let with_gap = folder.path().join("gap.mcap");
    let setup = Replay::open(&path).unwrap().setup().clone();
    let mut recorder = Recorder::create(&with_gap, &setup).unwrap();
    let mut recorded = readings(&path);
    for reading in &mut recorded[20..] {
        reading.time = reading.time + Duration::from_secs(3600);
    }
    for reading in &recorded {
        recorder.write_reading(reading).unwrap();
    }
    recorder.finish().unwrap();
    let mut shown = Shown::open(&with_gap);
    let [before, after] = [19_usize, 20].map(|index| recorded[index].time);
    shown.player.apply(Move::Time(before));
    let position = shown.player.position();
    shown.player.apply(Move::Play);
    shown.advance(Duration::from_millis(1_900));
    assert_eq!(shown.player.position(), position);
    shown.advance(Duration::from_millis(200));
    let played = shown.player.time().since(after);
    assert!(played >= Duration::from_millis(80), "{played:?}");
}

#[test]
fn a_recording_without_readings_does_not_play_for_ever() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("empty.mcap");
    let setup = Setup {
        output: "none".into(),
        ..Setup::default()
    };
    let recorded = setup.load_files().unwrap().recorded_setup();
    Recorder::create(&path, &recorded)
        .unwrap()
        .finish()
        .unwrap();
    let mut shown = Shown::open(&path);
    shown.player.apply(Move::Play);
    shown.advance(Duration::from_secs(1));
    assert!(!shown.player.is_playing());
}

#[test]
fn moves_stay_within_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = record(folder.path(), "hi");
    let mut player = Shown::open(&path).player;
    let last = player.len() - 1;
    let table = [
        (Move::By(-5), 0),
        (Move::By(1), 1),
        (Move::BySeconds(-1.0), 0),
        (Move::BySeconds(1e6), last),
        (Move::By(-1), last - 1),
        (Move::Step(usize::MAX), last),
        (Move::Time(Timestamp(0)), 0),
    ];
    for (change, index) in table {
        player.apply(change);
        assert_eq!(player.position(), index, "{change:?}");
    }
}

#[test]
fn a_recording_that_is_cut_is_shown_up_to_the_cut() {
    let folder = tempfile::tempdir().unwrap();
    let path = record(folder.path(), "hello");
    let whole = Shown::open(&path).player;
    assert_eq!(whole.problem(), None);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let mut shown = Shown::open(&path);
    let cut = &shown.player;
    assert!((20..whole.len()).contains(&cut.len()), "{}", cut.len());
    assert!(
        cut.problem()
            .is_some_and(|reason| reason.contains("the file ends"))
    );
    shown.show(usize::MAX);
    assert!(shown.model.poses.iter().any(Option::is_some));
}

#[test]
fn a_part_is_exported_with_the_same_readings() {
    let folder = tempfile::tempdir().unwrap();
    let path = record(folder.path(), "hello");
    let recording = Recording::open(&path, None).unwrap();
    let all = readings(&path);
    let (from, to) = (all[10].time, all[59].time);
    let part = default_name(&path);
    assert_eq!(part.file_name().unwrap(), "typist-part.mcap");
    assert_eq!(export(&recording, from..=to, &part, false).unwrap(), 50);
    assert_eq!(readings(&part), all[10..60]);
    assert_eq!(Shown::open(&part).player.problem(), None);
    assert_eq!(
        default_name(&path).file_name().unwrap(),
        "typist-part-2.mcap"
    );
}

#[test]
fn an_export_replaces_a_file_only_when_it_may() {
    let folder = tempfile::tempdir().unwrap();
    let path = record(folder.path(), "hi");
    let recording = Recording::open(&path, None).unwrap();
    let all = readings(&path);
    let range = || all[0].time..=all[9].time;
    let other = folder.path().join("other.mcap");
    std::fs::write(&other, "precious").unwrap();
    let refused = export(&recording, range(), &other, false);
    assert!(matches!(refused, Err(ExportError::Exists(_))));
    assert_eq!(std::fs::read(&other).unwrap(), b"precious");
    assert_eq!(export(&recording, range(), &other, true).unwrap(), 10);
    assert_eq!(readings(&other), all[..10]);
    let own = export(&recording, range(), &path, true);
    assert!(matches!(own, Err(ExportError::SameFile(_))));
    assert_eq!(readings(&path), all);
    let files = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(files, 2, "no temporary file is left");
}

#[cfg(unix)]
#[test]
fn an_export_replaces_nothing_but_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = record(folder.path(), "hi");
    let recording = Recording::open(&path, None).unwrap();
    let all = readings(&path);
    let socket = folder.path().join("socket.mcap");
    let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    let range = all[0].time..=all[9].time;
    let refused = export(&recording, range, &socket, true);
    assert!(matches!(refused, Err(ExportError::Replace { .. })));
    let kind = std::fs::symlink_metadata(&socket).unwrap().file_type();
    assert!(!kind.is_file());
}

#[test]
fn two_layouts_are_compared_on_the_same_readings() {
    let folder = tempfile::tempdir().unwrap();
    let path = record(folder.path(), "hello");
    let own = Recording::open(&path, None).unwrap().presses().unwrap();
    let other = Recording::open(&path, Some("dvorak-flat")).unwrap();
    let other = other.presses().unwrap();
    let [same, only_a, only_b] = compare(&own, &own).counts();
    assert_eq!((only_a, only_b), (0, 0));
    assert!(same >= 5, "{same} presses");
    let [_, other_a, other_b] = compare(&own, &other).counts();
    assert!(other_a > 0 && other_b > 0);
}
