//! A script in, a transcript out: the simulated hand plays every kind of movement, through the pipeline.

use crate::support::checked::Judged;
use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::device::Events;
use ademan::hand::Finger;
use ademan::kinematics::HandPose;
use ademan::output::{Sink, Transcript};
use ademan::setup::{ArmSetup, LoadedSetup, Setup};
use ademan::sim::SimulatedTypist;
use parry3d::math::Vec3;

fn assembly(layout: &str) -> LoadedSetup {
    let setup = Setup {
        layout: layout.into(),
        ..Setup::default()
    };
    setup.load_files().expect("a shipped layout")
}

fn hand(assembly: &LoadedSetup, script: &str) -> Result<SimulatedTypist, String> {
    let hand = assembly.scripted(script, &Hc11Format::default(), 0.0, 0);
    hand.map_err(|error| error.to_string())
}

/// What comes out of a script: the poses of the hand, and the lines of the transcript.
fn play(assembly: &LoadedSetup, script: &str) -> (Vec<HandPose>, Vec<String>) {
    let mut hand = hand(assembly, script).unwrap_or_else(|error| panic!("{error}"));
    let mut pipeline = Judged::of(assembly);
    let mut lines = Vec::new();
    let mut transcript = Transcript::new("test", &mut lines);
    transcript.set_target_names(&assembly.layout.target_names());
    let mut poses = Vec::new();
    let mut events = Events::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        events.clear();
        let frame = pipeline.step(&reading, &mut events);
        let frame = frame.unwrap_or_else(|reason| panic!("{reason} at {:?}", reading.time));
        poses.push(frame.pose);
        transcript.send(&events).expect("memory takes everything");
    }
    events.clear();
    pipeline.stop(&mut events);
    assert!(events.is_empty(), "nothing is down at the end: {events:?}");
    drop(transcript);
    let text = String::from_utf8(lines).expect("a transcript is text");
    (poses, text.lines().map(str::to_owned).collect())
}

/// The events of a script without their times.
fn events(layout: &str, script: &str) -> Vec<String> {
    let (_, lines) = play(&assembly(layout), script);
    lines.iter().map(|line| line[13..].to_owned()).collect()
}

/// The same without depths.
fn keys(layout: &str, script: &str) -> Vec<String> {
    let mut events = events(layout, script);
    events.retain(|event| !event.starts_with("depth"));
    events
}

/// Where the pad of the index finger is in the frame of a key, in each pose, in metres.
fn on_key(assembly: &LoadedSetup, name: &str, poses: &[HandPose]) -> Vec<Vec3> {
    let key = assembly.layout.key(name).expect("the layout has it");
    let (surface, target) = assembly
        .layout
        .scene
        .target(key.face.target)
        .expect("a target");
    let pad = |pose: &HandPose| {
        let world_from_surface = surface.world_from_surface(pose).expect("an elbow");
        let world_from_target = world_from_surface * target.surface_from_target;
        let tip = pose.fingertip(Finger::Index).expect("an index finger");
        world_from_target.inverse_transform_point(tip) - Vec3::Z * pose.tip_radius
    };
    poses.iter().map(pad).collect()
}

/// The distance of thumb and index finger in each pose, in mm.
fn gaps(poses: &[HandPose]) -> Vec<f32> {
    let gap = |pose: &HandPose| {
        let (thumb, index) = (pose.fingertip(Finger::Thumb), pose.fingertip(Finger::Index));
        thumb.unwrap().distance(index.unwrap()) * 1e3
    };
    poses.iter().map(gap).collect()
}

#[test]
fn taps_and_presses_are_keys_that_go_down_and_up() {
    let script = "tap Q; press W -3 4\nwait 200; lift # and again\ntap Space 30 0; press 'E'";
    let downs_and_ups = [
        "down Q",
        "up   Q",
        "down W",
        "up   W",
        "down Space",
        "up   Space",
        "down E",
        "up   E",
    ];
    assert_eq!(keys("qwerty-flat", script), downs_and_ups);
}

#[test]
fn a_push_goes_to_its_share_of_the_travel_and_to_the_next_one_without_coming_up() {
    let script =
        "push ArrowUp 0.5; wait 300; push ArrowUp 0.8; wait 300; push ArrowUp 0.15; wait 300";
    let (_, lines) = play(&assembly("arrows"), script);
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
fn a_push_that_is_less_than_a_press_sends_no_key() {
    assert_eq!(keys("arrows", "push ArrowLeft 0.15; wait 100"), [""; 0]);
}

#[test]
fn sliding_off_a_key_lets_go_of_it_before_the_finger_lifts() {
    let script = "press Numpad5; wait 100; slide 0 19; wait 1000; lift";
    let (_, lines) = play(&assembly("numpad"), script);
    let time = |line: &String| line[..12].trim().parse::<f64>().expect("a time in ms");
    let [down, up] = &lines[..] else {
        panic!("{lines:?}");
    };
    assert!(down.ends_with("down Numpad5") && up.ends_with("up   Numpad5"));
    assert!(time(up) - time(down) < 500.0, "{lines:?}");
}

#[test]
fn the_fingertip_goes_around_the_middle_counter_clockwise_as_seen_from_the_front() {
    let assembly = assembly("arrows");
    let (poses, lines) = play(
        &assembly,
        "press ArrowDown 6 0; wait 300; arc 270 2000; wait 300",
    );
    let places: Vec<(f32, f32)> = on_key(&assembly, "ArrowDown", &poses)
        .into_iter()
        .filter(|at| at.z < -0.018)
        .map(|at| (at.y.atan2(at.x).to_degrees(), at.truncate().length() * 1e3))
        .collect();
    assert!(
        places.iter().all(|(_, radius)| (4.0..8.0).contains(radius)),
        "{places:?}"
    );
    let way: f32 = places
        .windows(2)
        .map(|pair| (pair[1].0 - pair[0].0 + 540.0).rem_euclid(360.0) - 180.0)
        .sum();
    assert!((250.0..290.0).contains(&way), "{way}°");
    assert!(!lines.is_empty());
}

#[test]
fn places_and_slides_are_along_the_axes_of_a_key_that_is_turned() {
    let assembly = assembly("qwerty-arc");
    let script = "press P; wait 600; slide -30 0 1000; wait 600";
    let (poses, lines) = play(&assembly, script);
    let down: Vec<Vec3> = on_key(&assembly, "P", &poses)
        .into_iter()
        .filter(|at| at.z < 0.0)
        .map(|at| at * 1e3)
        .collect();
    // A count of the elbow's channel moves the fingertip by 3 mm.
    let was_at = |x: f32| {
        let goal = Vec3::new(x, 0.0, -6.0);
        down.iter().filter(|at| at.distance(goal) < 4.0).count() > 50
    };
    assert!(was_at(0.0) && was_at(-30.0), "{down:?}");
    assert_eq!(lines.len(), 2, "{lines:?}");
}

#[test]
fn other_fingers_bend_by_themselves_and_together() {
    let assembly = assembly("arrows");
    let (poses, _) = play(&assembly, "bend middle 60 & bend ring 40 400; wait 300");
    let flexion = |finger: Finger| {
        let heights = poses
            .iter()
            .map(|pose| pose.fingertip(finger).expect("a fingertip").y);
        let (first, lowest) = (heights.clone().next(), heights.fold(f32::MAX, f32::min));
        first.expect("a first frame") - lowest
    };
    assert!(flexion(Finger::Middle) > 0.05 && flexion(Finger::Ring) > 0.04);
    assert!(flexion(Finger::Index) < 0.002 && flexion(Finger::Little) < 0.002);
}

#[test]
fn two_fingers_press_two_keys_at_once() {
    let script = "press J; set middle-pip-flexion 40 & bend middle 20; wait 200\n\
        bend middle 45; wait 200; bend middle 20; wait 200; lift";
    let downs_and_ups = ["down J", "down 8", "up   8", "up   J"];
    assert_eq!(keys("qwerty-flat", script), downs_and_ups);
}

#[test]
fn a_fingertip_that_is_down_keeps_its_place_while_the_forearm_rolls() {
    let script = "press ArrowDown; wait 200; roll 20 500; wait 200; roll 0 500; wait 200; lift";
    assert_eq!(keys("arrows", script), ["down ArrowDown", "up   ArrowDown"]);
}

#[test]
fn thumb_and_index_finger_meet_stay_together_and_part() {
    let assembly = assembly("arrows");
    let script =
        "point 140 -40 -240; pinch; wait 600; point 120 -20 -290; wait 600; unpinch; wait 600";
    let (poses, _) = play(&assembly, script);
    let gaps = gaps(&poses);
    let first = gaps.iter().position(|gap| *gap < 15.0).expect("they meet");
    let last = gaps.iter().rposition(|gap| *gap < 15.0).expect("they meet");
    assert!(gaps[first..=last].iter().all(|gap| *gap < 15.0), "{gaps:?}");
    assert!(gaps[..100].iter().all(|gap| *gap > 45.0));
    assert!(gaps[gaps.len() - 150..].iter().all(|gap| *gap > 45.0));
}

#[test]
fn small_and_large_hands_pinch_wherever_they_point() {
    for hand_length_mm in [165.0, 190.0, 205.0] {
        let setup = Setup {
            arm: ArmSetup::Measured {
                hand_length_mm,
                forearm_length_mm: hand_length_mm * 1.34,
            },
            layout: "arrows".into(),
            ..Setup::default()
        };
        let assembly = setup.load_files().expect("a person of these measures");
        for place in ["100 -100 -280", "150 -40 -300", "120 -70 -300"] {
            let script = format!("point {place}; pinch; wait 500; unpinch; wait 500");
            let (poses, _) = play(&assembly, &script);
            let gaps = gaps(&poses);
            let last = gaps.iter().rposition(|gap| *gap < 15.0);
            let last = last.unwrap_or_else(|| panic!("{hand_length_mm} at {place}: {gaps:?}"));
            // The movement takes 53 frames, and the filter some more to follow.
            let apart = gaps[last + 70];
            assert!(apart > 45.0, "{hand_length_mm} at {place}: {apart} mm");
        }
    }
}

#[test]
fn the_fingertip_goes_to_a_place_in_space() {
    let assembly = assembly("arrows");
    let (poses, lines) = play(&assembly, "point 150 30 -300; wait 1000");
    let way = poses.iter().map(|pose| {
        let elbow = pose.position(ademan::hand::Joint::Elbow).expect("an elbow");
        (pose.fingertip(Finger::Index).expect("a tip") - elbow) * 1e3
    });
    let goal = Vec3::new(150.0, 30.0, -300.0);
    let nearest = way.map(|at| at.distance(goal)).fold(f32::MAX, f32::min);
    assert!(nearest < 4.0, "{nearest} mm");
    assert_eq!(lines, [""; 0]);
}

#[test]
fn what_cannot_be_done_is_told_with_its_place_before_the_hand_moves() {
    let table = [
        (
            "tap ArrowUp\nslide 500 0",
            "script:2:1: the fingertip is not down",
        ),
        (
            "press ArrowUp; slide 0 500",
            "script:1:16: `ArrowUp` is 465 mm out of reach",
        ),
        (
            "press ArrowUp; arc 90",
            "script:1:16: the fingertip is in the middle",
        ),
        (
            "point 150 -20 -280; pinch; point 150 -50 -280",
            "script:1:28: thumb and index finger stay 2",
        ),
        ("point 0 0 -2000", "script:1:1: this place is 1"),
        (
            "set shoulder-x 10",
            "script:1:1: the glove has no sensor for `shoulder-x`",
        ),
        (
            "wait 5; set elbow-flexion 170",
            "script:1:9: `elbow-flexion` goes from 0° to 125° with this glove, not to 170°",
        ),
        (
            "tap ArowUp",
            "script:1:5: unknown target `ArowUp`, did you mean `ArrowUp`?",
        ),
    ];
    let assembly = assembly("arrows");
    for (script, message) in table {
        let error = hand(&assembly, script).err();
        let error = error.unwrap_or_else(|| panic!("{script} is played"));
        assert!(error.starts_with(message), "{script}: {error}");
    }
}

#[test]
fn a_script_plays_the_same_every_time() {
    let script = "tap Numpad7; press Numpad5; slide 5 5; arc 90; lift; pinch; unpinch";
    let assembly = assembly("numpad");
    let counts = || {
        let mut hand = assembly
            .scripted(script, &Hc11Format::default(), 1.5, 3)
            .unwrap();
        std::iter::from_fn(move || hand.next_counts()).collect::<Vec<_>>()
    };
    assert_eq!(counts(), counts());
}

#[test]
fn a_script_is_a_source_in_a_file_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("media keys.txt");
    std::fs::write(&path, "# one key\ntap Numpad1\n").expect("a file");
    let assembly = assembly("numpad");
    let name = format!("script:{}", path.display());
    let source = assembly
        .open_source(&name.parse().expect("a source"))
        .expect("it opens");
    assert_eq!(source.name(), name);
    let missing = assembly.open_source(&"script:none.txt".parse().expect("a source"));
    let error = missing.err().expect("no such file").to_string();
    assert_eq!(error, "none.txt: there is no such file");
}

#[test]
fn the_example_of_a_script_plays_on_the_arrows() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scripts/arrows.txt");
    let downs_and_ups = [
        "down ArrowUp",
        "up   ArrowUp",
        "down ArrowRight",
        "up   ArrowRight",
        "down ArrowDown",
        "up   ArrowDown",
    ];
    assert_eq!(keys("arrows", path), downs_and_ups);
}

#[test]
fn an_angle_that_was_set_stays_near_it_while_the_fingertip_goes_elsewhere() {
    let assembly = assembly("arrows");
    let middle = |script: &str| {
        let (poses, _) = play(&assembly, script);
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
fn things_in_space_are_selected_where_the_fingertip_goes() {
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
fn the_joints_of_an_arm_point_click_and_scroll() {
    let played = keys(
        "joint",
        "set wrist-deviation 15 & set wrist-flexion 15; pinch; wait 100; unpinch; wait 400; \
         bend little 70; set wrist-flexion 0; bend little 0",
    );
    let place = |event: &str| played.iter().position(|it| it.starts_with(event));
    let (down, up) = (place("down MouseLeft"), place("up   MouseLeft"));
    assert_eq!(up, down.map(|down| down + 1), "{played:?}");
    let place_at = |at: usize| {
        let words = played[at].split_whitespace().skip(1);
        words.map(|it| it.parse().unwrap()).collect::<Vec<f32>>()
    };
    let clicked_at = place_at(down.expect("a click") - 1);
    // 27/32 of the way to the right, and 45/60 of the way down.
    assert!((clicked_at[0] - 27.0 / 32.0).abs() < 0.03, "{clicked_at:?}");
    assert!((clicked_at[1] - 0.75).abs() < 0.03, "{clicked_at:?}");
    let scrolled = played
        .iter()
        .filter_map(|event| event.strip_prefix("scroll +0 "));
    let scrolled: f32 = scrolled.map(|clicks| clicks.parse::<f32>().unwrap()).sum();
    // A quarter of 1080 pixels, 60 a click.
    assert!((scrolled - 540.0).abs() < 60.0, "{scrolled}");
}

#[test]
fn a_target_in_space_is_no_key_to_tap() {
    let refused = hand(&assembly("space"), "tap Moon")
        .err()
        .expect("it is refused");
    assert!(
        refused.contains("on no board") && refused.contains("`point X Y Z`"),
        "{refused}"
    );
}
