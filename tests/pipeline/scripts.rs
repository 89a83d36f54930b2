//! Scripts of the simulated hand: each kind of movement through the whole pipeline, script in, transcript out.

use crate::support::checked::CheckedPipeline;
use crate::support::wearer::shipped_setup;
use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::device::Events;
use ademan::hand::Finger;
use ademan::kinematics::HandPose;
use ademan::output::{Sink, Transcript};
use ademan::setup::{ArmSetup, LoadedSetup, Setup};
use ademan::sim::SimulatedTypist;
use parry3d::math::Vec3;

fn hand(setup: &LoadedSetup, script: &str) -> Result<SimulatedTypist, String> {
    let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
    hand.map_err(|error| error.to_string())
}

/// Plays a script. Returns the poses of the hand and the lines of the transcript.
fn play(setup: &LoadedSetup, script: &str) -> (Vec<HandPose>, Vec<String>) {
    let mut hand = hand(setup, script).unwrap_or_else(|error| panic!("{error}"));
    let mut pipeline = CheckedPipeline::new(setup);
    let mut lines = Vec::new();
    let mut transcript = Transcript::new("test", &mut lines);
    transcript.set_target_names(&setup.layout.target_names());
    let mut poses = Vec::new();
    let mut events = Events::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        let output = pipeline.step(&reading, &mut events);
        let output = output.unwrap_or_else(|reason| panic!("{reason} at {:?}", reading.time));
        poses.push(output.pose);
        transcript
            .send(&events)
            .expect("writing to memory succeeds");
    }
    events.clear();
    pipeline.stop(&mut events);
    assert!(events.is_empty(), "keys are pressed at the end: {events:?}");
    drop(transcript);
    let text = String::from_utf8(lines).expect("a transcript is UTF-8");
    (poses, text.lines().map(str::to_owned).collect())
}

/// Returns the events of a script without their times.
fn events(layout: &str, script: &str) -> Vec<String> {
    let (_, lines) = play(&shipped_setup(layout), script);
    lines.iter().map(|line| line[13..].to_owned()).collect()
}

/// Returns the events of a script without times and depths.
fn keys(layout: &str, script: &str) -> Vec<String> {
    let mut events = events(layout, script);
    events.retain(|event| !event.starts_with("depth"));
    events
}

/// Returns the pad of the index finger in each pose, in the frame of a key (metres).
fn on_key(setup: &LoadedSetup, name: &str, poses: &[HandPose]) -> Vec<Vec3> {
    let key = setup.layout.key(name).expect("the layout has this key");
    let (surface, target) = setup
        .layout
        .scene
        .target(key.face.target)
        .expect("the key is in the scene");
    let pad = |pose: &HandPose| {
        let world_from_surface = surface
            .world_from_surface(pose)
            .expect("the arm has an elbow");
        let world_from_target = world_from_surface * target.surface_from_target;
        let tip = pose
            .fingertip(Finger::Index)
            .expect("the arm has an index finger");
        world_from_target.inverse_transform_point(tip) - Vec3::Z * pose.tip_radius
    };
    poses.iter().map(pad).collect()
}

/// Returns the distance of thumb and index finger in each pose, in mm.
fn gaps(poses: &[HandPose]) -> Vec<f32> {
    let gap = |pose: &HandPose| {
        let (thumb, index) = (pose.fingertip(Finger::Thumb), pose.fingertip(Finger::Index));
        thumb.unwrap().distance(index.unwrap()) * 1e3
    };
    poses.iter().map(gap).collect()
}

#[test]
fn taps_and_presses_press_and_release_keys() {
    let script = "tap Q; press W -3 4\nwait 200; lift # and again\ntap Space 30 0; press 'E'";
    let expected = [
        "down Q",
        "up   Q",
        "down W",
        "up   W",
        "down Space",
        "up   Space",
        "down E",
        "up   E",
    ];
    assert_eq!(keys("qwerty-flat", script), expected);
}

#[test]
fn a_push_reaches_its_depth_and_the_next_push_does_not_lift() {
    let script =
        "push ArrowUp 0.5; wait 300; push ArrowUp 0.8; wait 300; push ArrowUp 0.15; wait 300";
    let (_, lines) = play(&shipped_setup("arrows"), script);
    let depths: Vec<f32> = lines
        .iter()
        .filter_map(|line| line[13..].strip_prefix("depth ArrowUp ")?.parse().ok())
        .collect();
    let near = |wanted: f32| {
        let found = depths
            .iter()
            .filter(|depth| (**depth - wanted).abs() < 0.08);
        found.count()
    };
    assert!(
        near(0.5) > 0 && near(0.8) > 0 && near(0.15) > 0,
        "{depths:?}"
    );
    let deepest = depths.iter().copied().fold(0.0, f32::max);
    assert!(deepest < 0.9, "{deepest}");
    assert_eq!(keys("arrows", script), ["down ArrowUp", "up   ArrowUp"]);
}

#[test]
fn a_shallow_push_presses_no_key() {
    assert_eq!(keys("arrows", "push ArrowLeft 0.15; wait 100"), [""; 0]);
}

#[test]
fn sliding_off_a_key_releases_it_before_the_finger_lifts() {
    let script = "press Numpad5; wait 100; slide 0 19; wait 1000; lift";
    let (_, lines) = play(&shipped_setup("numpad"), script);
    let time = |line: &String| {
        line[..12]
            .trim()
            .parse::<f64>()
            .expect("the line begins with a time in ms")
    };
    let [down, up] = &lines[..] else {
        panic!("{lines:?}");
    };
    assert!(down.ends_with("down Numpad5") && up.ends_with("up   Numpad5"));
    assert!(time(up) - time(down) < 500.0, "{lines:?}");
}

#[test]
fn an_arc_is_counter_clockwise_seen_from_the_front() {
    let setup = shipped_setup("arrows");
    let (poses, lines) = play(
        &setup,
        "press ArrowDown 6 0; wait 300; arc 270 2000; wait 300",
    );
    let polar: Vec<(f32, f32)> = on_key(&setup, "ArrowDown", &poses)
        .into_iter()
        .filter(|at| at.z < -0.018)
        .map(|at| (at.y.atan2(at.x).to_degrees(), at.truncate().length() * 1e3))
        .collect();
    assert!(
        polar.iter().all(|(_, radius)| (4.0..8.0).contains(radius)),
        "{polar:?}"
    );
    let turned: f32 = polar
        .windows(2)
        .map(|pair| (pair[1].0 - pair[0].0 + 540.0).rem_euclid(360.0) - 180.0)
        .sum();
    assert!((250.0..290.0).contains(&turned), "{turned}°");
    assert!(!lines.is_empty());
}

#[test]
fn offsets_and_slides_follow_the_axes_of_a_rotated_key() {
    let setup = shipped_setup("qwerty-arc");
    let script = "press P; wait 600; slide -30 0 1000; wait 600";
    let (poses, lines) = play(&setup, script);
    let down: Vec<Vec3> = on_key(&setup, "P", &poses)
        .into_iter()
        .filter(|at| at.z < 0.0)
        .map(|at| at * 1e3)
        .collect();
    // One count of the elbow's channel moves the fingertip by 3 mm.
    let stays_at = |x: f32| {
        let goal = Vec3::new(x, 0.0, -6.0);
        down.iter().filter(|at| at.distance(goal) < 4.0).count() > 50
    };
    assert!(stays_at(0.0) && stays_at(-30.0), "{down:?}");
    assert_eq!(lines.len(), 2, "{lines:?}");
}

#[test]
fn other_fingers_bend_alone_and_together() {
    let setup = shipped_setup("arrows");
    let (poses, _) = play(&setup, "bend middle 60 & bend ring 40 400; wait 300");
    let drop = |finger: Finger| {
        let heights = poses
            .iter()
            .map(|pose| pose.fingertip(finger).expect("the arm has this finger").y);
        let (first, lowest) = (heights.clone().next(), heights.fold(f32::MAX, f32::min));
        first.expect("there is a first pose") - lowest
    };
    assert!(drop(Finger::Middle) > 0.05 && drop(Finger::Ring) > 0.04);
    assert!(drop(Finger::Index) < 0.002 && drop(Finger::Little) < 0.002);
}

#[test]
fn two_fingers_press_two_keys_at_once() {
    let script = "press J; set middle-pip-flexion 40 & bend middle 20; wait 200\n\
        bend middle 45; wait 200; bend middle 20; wait 200; lift";
    let expected = ["down J", "down 8", "up   8", "up   J"];
    assert_eq!(keys("qwerty-flat", script), expected);
}

#[test]
fn a_pressed_fingertip_keeps_its_position_while_the_forearm_rolls() {
    let script = "press ArrowDown; wait 200; roll 20 500; wait 200; roll 0 500; wait 200; lift";
    assert_eq!(keys("arrows", script), ["down ArrowDown", "up   ArrowDown"]);
}

#[test]
fn a_pinch_closes_holds_while_moving_and_opens() {
    let setup = shipped_setup("arrows");
    let script =
        "point 140 -40 -240; pinch; wait 600; point 120 -20 -290; wait 600; unpinch; wait 600";
    let (poses, _) = play(&setup, script);
    let gaps = gaps(&poses);
    let first = gaps
        .iter()
        .position(|gap| *gap < 15.0)
        .expect("the fingertips meet");
    let last = gaps
        .iter()
        .rposition(|gap| *gap < 15.0)
        .expect("the fingertips meet");
    assert!(gaps[first..=last].iter().all(|gap| *gap < 15.0), "{gaps:?}");
    assert!(gaps[..100].iter().all(|gap| *gap > 45.0));
    assert!(gaps[gaps.len() - 150..].iter().all(|gap| *gap > 45.0));
}

#[test]
fn hands_of_all_sizes_pinch_at_all_positions() {
    for hand_length_mm in [165.0, 190.0, 205.0] {
        let setup = Setup {
            arm: ArmSetup::Measured {
                hand_length_mm,
                forearm_length_mm: hand_length_mm * 1.34,
            },
            layout: "arrows".into(),
            ..Setup::default()
        };
        let setup = setup.load_files().expect("a person of this size");
        for position in ["100 -100 -280", "150 -40 -300", "120 -70 -300"] {
            let script = format!("point {position}; pinch; wait 500; unpinch; wait 500");
            let (poses, _) = play(&setup, &script);
            let gaps = gaps(&poses);
            let last = gaps.iter().rposition(|gap| *gap < 15.0);
            let last =
                last.unwrap_or_else(|| panic!("{hand_length_mm} mm at {position}: {gaps:?}"));
            // The movement takes 53 packets; the filter lags behind it.
            let apart = gaps[last + 70];
            assert!(
                apart > 45.0,
                "{hand_length_mm} mm at {position}: {apart} mm"
            );
        }
    }
}

#[test]
fn point_moves_the_fingertip_to_a_position_in_space() {
    let setup = shipped_setup("arrows");
    let (poses, lines) = play(&setup, "point 150 30 -300; wait 1000");
    let path = poses.iter().map(|pose| {
        let elbow = pose
            .position(ademan::hand::Joint::Elbow)
            .expect("the arm has an elbow");
        (pose
            .fingertip(Finger::Index)
            .expect("the arm has an index finger")
            - elbow)
            * 1e3
    });
    let goal = Vec3::new(150.0, 30.0, -300.0);
    let nearest = path.map(|at| at.distance(goal)).fold(f32::MAX, f32::min);
    assert!(nearest < 4.0, "{nearest} mm");
    assert_eq!(lines, [""; 0]);
}

#[test]
fn impossible_actions_are_refused_with_their_position() {
    let table = [
        (
            "tap ArrowUp\nslide 500 0",
            "script:2:1: the fingertip presses nothing",
        ),
        (
            "press ArrowUp; slide 0 500",
            "script:1:16: `ArrowUp` is 465 mm out of reach",
        ),
        (
            "press ArrowUp; arc 90",
            "script:1:16: the fingertip is at the center of the arc",
        ),
        (
            "point 150 -20 -280; pinch; point 150 -50 -280",
            "script:1:28: thumb and index finger stay 2",
        ),
        ("point 0 0 -2000", "script:1:1: this position is 1"),
        (
            "set shoulder-x 10",
            "script:1:1: the glove has no sensor for `shoulder-x`",
        ),
        (
            "wait 5; set elbow-flexion 170",
            "script:1:9: `elbow-flexion` ranges from 0° to 125° with this glove, and 170° is outside",
        ),
        (
            "tap ArowUp",
            "script:1:5: unknown target `ArowUp`, did you mean `ArrowUp`?",
        ),
    ];
    let setup = shipped_setup("arrows");
    for (script, message) in table {
        let error = hand(&setup, script).err();
        let error = error.unwrap_or_else(|| panic!("{script} is accepted"));
        assert!(error.starts_with(message), "{script}: {error}");
    }
}

#[test]
fn a_script_gives_the_same_counts_every_time() {
    let script = "tap Numpad7; press Numpad5; slide 5 5; arc 90; lift; pinch; unpinch";
    let setup = shipped_setup("numpad");
    let counts = || {
        let mut hand = setup
            .scripted(script, &Hc11Format::default(), 1.5, 3)
            .unwrap();
        std::iter::from_fn(move || hand.next_counts()).collect::<Vec<_>>()
    };
    assert_eq!(counts(), counts());
}

#[test]
fn a_script_file_is_a_source() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("media keys.txt");
    std::fs::write(&path, "# one key\ntap Numpad1\n").expect("the file is written");
    let setup = shipped_setup("numpad");
    let name = format!("script:{}", path.display());
    let source = setup
        .open_source(&name.parse().expect("the URI is valid"))
        .expect("the source opens");
    assert_eq!(source.name(), name);
    let missing = setup.open_source(&"script:none.txt".parse().expect("the URI is valid"));
    let error = missing.err().expect("the file does not exist").to_string();
    assert_eq!(error, "none.txt: there is no such file");
}

#[test]
fn the_example_script_plays_on_the_arrow_keys() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scripts/arrows.txt");
    let expected = [
        "down ArrowUp",
        "up   ArrowUp",
        "down ArrowRight",
        "up   ArrowRight",
        "down ArrowDown",
        "up   ArrowDown",
    ];
    assert_eq!(keys("arrows", path), expected);
}

#[test]
fn a_set_angle_is_kept_while_the_fingertip_moves() {
    let setup = shipped_setup("arrows");
    let middle = |script: &str| {
        let (poses, _) = play(&setup, script);
        let during = &poses[poses.len() - 300];
        let tips = [Finger::Index, Finger::Middle].map(|finger| during.fingertip(finger).unwrap());
        tips[1].y - tips[0].y
    };
    let free = middle("point 150 0 -280; wait 2000");
    let bent = middle("set wrist-flexion -25; point 150 0 -280; wait 2000");
    assert!(
        bent - free > 0.005,
        "{bent} m and {free} m over the index fingertip"
    );
}

#[test]
fn targets_in_space_are_selected_by_the_fingertip() {
    let script = "point 60 0 -300; point 120 0 -300; point 200 0 -270; point 260 -20 -220; point 160 50 -320";
    assert_eq!(
        keys("space", script),
        [
            "select Moon",
            "unselect Moon",
            "select Earth",
            "unselect Earth",
            "select Play",
            "down MediaPlayPause",
            "up   MediaPlayPause",
            "unselect Play",
            "select Earth",
            "unselect Earth",
            "select Door",
            "unselect Door",
        ]
    );
}

#[test]
fn joints_of_the_arm_point_click_and_scroll() {
    let played = keys(
        "joint",
        "set wrist-deviation 15 & set wrist-flexion 15; pinch; wait 100; unpinch; wait 400; \
         bend little 70; set wrist-flexion 0; bend little 0",
    );
    let index_of = |event: &str| played.iter().position(|it| it.starts_with(event));
    let (down, up) = (index_of("down MouseLeft"), index_of("up   MouseLeft"));
    assert_eq!(up, down.map(|down| down + 1), "{played:?}");
    let numbers_at = |index: usize| {
        let words = played[index].split_whitespace().skip(1);
        words.map(|it| it.parse().unwrap()).collect::<Vec<f32>>()
    };
    let clicked_at = numbers_at(down.expect("there is a click") - 1);
    // Expected at 27/32 of the width and 45/60 of the height.
    assert!((clicked_at[0] - 27.0 / 32.0).abs() < 0.03, "{clicked_at:?}");
    assert!((clicked_at[1] - 0.75).abs() < 0.03, "{clicked_at:?}");
    let scrolled = played
        .iter()
        .filter_map(|event| event.strip_prefix("scroll +0 "));
    let scrolled: f32 = scrolled.map(|clicks| clicks.parse::<f32>().unwrap()).sum();
    // Expected: a quarter of 1080 pixels; 60 pixels are one detent.
    assert!((scrolled - 540.0).abs() < 60.0, "{scrolled}");
}

#[test]
fn a_target_in_space_cannot_be_tapped() {
    let error = hand(&shipped_setup("space"), "tap Moon")
        .err()
        .expect("the script is refused");
    assert!(
        error.contains("on no board") && error.contains("`point X Y Z`"),
        "{error}"
    );
}
