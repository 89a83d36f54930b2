//! Scripts on the shipped panels and boards.

use ademan::document::Document;
use ademan::estimate::{Estimate, JointAngles};
use ademan::files::Load;
use ademan::hand::{Dof, Finger, Joint};
use ademan::kinematics::ArmModel;
use ademan::layout::Layout;
use ademan::time::Timestamp;

use crate::rig::Rig;

fn rig(name: &str) -> Rig {
    let document = Document::shipped(name).expect("a shipped layout");
    Rig::new(&document.text)
}

#[test]
fn the_shipped_touchpad_moves_clicks_scrolls_and_has_two_buttons() {
    let mut rig = rig("touch-pad");
    rig.run("index Pad 0 0 up; index Pad 0 0 1; index Pad 0 0 up");
    rig.run("index Pad 20 0 up; wait 400; index Pad 20 0 1; index Pad 30 0 1; index Pad 30 0 up; wait 400");
    rig.run(
        "index Pad 0 0 up & middle Pad 15 0 up; index Pad 0 0 1 & middle Pad 15 0 1; index Pad 0 \
             12 1 & middle Pad 15 12 1",
    );
    rig.run("index Pad 0 0 up & middle Pad 15 0 up; thumb MouseRight tap; thumb MouseLeft tap");
    let events = rig.events();
    let kinds: Vec<&str> = events.split(' ').map(|event| &event[..2]).collect();
    assert_eq!(
        kinds,
        ["dn", "up", "mo", "sc", "dn", "up", "dn", "up"],
        "{events}"
    );
    assert!(events.ends_with("dn:MouseRight up:MouseRight dn:MouseLeft up:MouseLeft"));
}

const KEYS: [(&str, Finger); 5] = [
    ("T", Finger::Thumb),
    ("I", Finger::Index),
    ("M", Finger::Middle),
    ("R", Finger::Ring),
    ("L", Finger::Little),
];

/// Returns orders that place the fingertips of the default hand, relative to its wrist: the fingers of
/// `pressing` are bent at each joint by 5° more than the half-bent posture, the others by 5° less.
fn fingertips(pressing: &str) -> String {
    let document = Document::shipped("unam").expect("the default arm");
    let arm = ArmModel::parse(&document).expect("the default arm");
    let mut angles = JointAngles::default();
    angles.set(Dof::ElbowFlexion, 35_f64.to_radians());
    for &dof in Dof::ALL {
        let Some(finger) = dof.finger() else {
            continue;
        };
        let name = dof.name();
        let half = match name.rsplit_once('-') {
            Some((joint, "flexion")) if joint.starts_with("thumb") => 20.0,
            Some((joint, "flexion")) if joint.ends_with("mcp") => 20.0,
            Some((joint, "flexion")) if joint.ends_with("pip") => 30.0,
            Some((_, "flexion")) => 15.0,
            _ => continue,
        };
        let presses = KEYS
            .iter()
            .any(|&(key, of)| of == finger && pressing.contains(key));
        let bend: f64 = if presses { 5.0 } else { -5.0 };
        angles.set(dof, (half + bend).to_radians());
    }
    let pose = arm.forward(&Estimate::new(Timestamp(0), angles));
    let wrist = pose.position(Joint::Wrist).expect("a wrist");
    let order = |&finger: &Finger| {
        let tip = (pose.fingertip(finger).expect("a fingertip") - wrist) * 1e3;
        format!("tip {finger} {} {} {}", tip.x, tip.y, tip.z)
    };
    Finger::ALL
        .iter()
        .map(order)
        .collect::<Vec<_>>()
        .join(" & ")
}

#[test]
fn the_default_hand_types_every_letter_on_the_five_chord_keys() {
    let layout = Layout::load("chords-five").expect("the shipped board");
    let name = |target| {
        let front = layout.face(target).expect("a key");
        front.name.clone()
    };
    let own = layout
        .keys
        .iter()
        .map(|key| (key.face.name.clone(), key.action(0).expect("an action")));
    let together = layout.chords.iter().map(|chord| {
        let keys: String = chord.keys.iter().map(|&target| name(target)).collect();
        (keys, chord.action)
    });
    let (open, mut sent) = (fingertips(""), Vec::new());
    for (keys, action) in own.chain(together) {
        let mut rig = rig("chords-five");
        rig.run(&format!(
            "{open}; {}; wait 100; {open}; wait 100",
            fingertips(&keys)
        ));
        let events = rig.events();
        match action {
            ademan::device::KeyAction::Key(code) => {
                assert_eq!(events, format!("dn:{code} up:{code}"), "{keys}");
                sent.push(code.name());
            }
            _ => assert_eq!((events.as_str(), keys.as_str()), ("", "TIMRL")),
        }
    }
    sent.sort_unstable();
    let letters: Vec<String> = ('A'..='Z').map(String::from).collect();
    let mut wanted: Vec<&str> = letters.iter().map(String::as_str).collect();
    wanted.extend(["Space", "Backspace", "Enter", "Period"]);
    wanted.sort_unstable();
    assert_eq!(sent, wanted);
}

#[test]
fn all_five_chord_keys_are_a_one_shot_shift() {
    let (open, all) = (fingertips(""), fingertips("TIMRL"));
    let mut rig = rig("chords-five");
    rig.run(&format!(
        "{open}; {all}; wait 100; {open}; {}; wait 100; {open}",
        fingertips("I")
    ));
    assert_eq!(rig.events(), "dn:ShiftLeft dn:E up:E up:ShiftLeft");
}
