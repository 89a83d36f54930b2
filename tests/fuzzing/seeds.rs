//! Valid inputs for every target, most of them shipped files.

use ademan::document::Document;
use ademan::document::shipped_layouts;

use super::hostile;

fn shipped(name: &str) -> Vec<u8> {
    let document = Document::shipped(name).expect("a shipped file");
    document.text.into_bytes()
}

/// Returns every shipped layout, and hostile ones.
pub fn layouts() -> Vec<Vec<u8>> {
    shipped_layouts()
        .map(shipped)
        .chain(hostile::layouts())
        .collect()
}

/// Returns the shipped gloves.
pub fn gloves() -> Vec<Vec<u8>> {
    ["unam-hc11", "unam-hc11-left", "lucidgloves"]
        .map(shipped)
        .into()
}

/// Returns the marks of calibrations.
pub fn marks() -> Vec<Vec<u8>> {
    texts(&[
        "rest 0 1000000\nflat 2000000 3100000\nwrist-up 5000000 6000000\n",
        "fist 17200 18446744073709551615\n",
        "",
    ])
}

/// Returns the shipped arm.
pub fn arms() -> Vec<Vec<u8>> {
    vec![shipped("unam")]
}

/// Returns the shipped persons, and one with every kind of field.
pub fn persons() -> Vec<Vec<u8>> {
    let every = r#"Person(fingers: ["index"], resting: ["ring"], offsets_mm: {"index": (1, -2)}, scatter: (x_mm: 3, y_part: 0.01),
        joint_limits_deg: {"wrist-flexion": (-20, 30)}, tremor: (amplitude_mm: 3, frequency_hz: 5), speed: 0.5)"#;
    let mut persons = texts(&[every]);
    persons.extend([shipped("adult"), shipped("left-small")]);
    persons
}

/// Returns the example setup, and setups with the fields that it lacks.
pub fn setups() -> Vec<Vec<u8>> {
    texts(&[
        include_str!("../../examples/setup.ron"),
        r#"Setup(arm: Measured(hand_length_mm: 190, forearm_length_mm: 255), stall_timeout_ms: 300)"#,
        r#"Setup(other_hand: OtherHand(), profiles: [Profile(name: "numbers", layout: "numpad")])"#,
        r#"Setup(source: "tcp:[::1]:4001?baud=9600", smoothing: OneEuro(min_cutoff_hz: 1.5, beta: 0.3))"#,
        r#"Setup(role: Keys, other_hand: (source: "tcp:box:4001", role: Both))"#,
        r#"(arm_immediately: true, output: "uinput,transcript", smoothing: Off)"#,
    ])
}

/// Returns every request, and invalid ones.
pub fn requests() -> Vec<Vec<u8>> {
    texts(&[
        r#"{"command":"state"}"#,
        r#"{"command":"pause"}"#,
        r#"{"command":"resume"}"#,
        r#"{"command":"reload"}"#,
        r#"{"command":"profile","name":"numbers"}"#,
        r#"{"command":"next-profile"}"#,
        r#"{"command":"recenter"}"#,
        r#"{"command":"nudge","x_mm":12.5,"y_mm":0,"z_mm":-3e1}"#,
        r#"{"command":"tilt","deg":-7.5}"#,
        r#"{"command":"scale","factor":1.05}"#,
        r#"{"command":"zero"}"#,
        r#"{"command":"undo-zero"}"#,
        r#"{"command":"undo-learning"}"#,
        r#"{"command":"text","mode":"auto"}"#,
        r#"{"command":"candidate","number":2}"#,
        r#"{"command":"forget-learned"}"#,
        r#"{"command":"save-learned"}"#,
        r#"{"command":"save"}"#,
        r#"{"command":"subscribe"}"#,
        r#"{"command":"stop"}"#,
        r#"{"command":"state","name":"main"}"#,
    ])
}

/// Returns sources of every kind.
pub fn sources() -> Vec<Vec<u8>> {
    texts(&[
        "serial:/dev/ttyUSB0?protocol=hc11&baud=9600",
        "serial:COM3?framing=hash",
        "serial:usb-0403:6001",
        "tcp:192.168.1.7:4001?framing=double06",
        "tcp:[::1]:4001",
        "file:what?a=b?protocol=hc11",
        "recording:day.mcap",
        "typist:hello, world",
        "script:tap Q; wait 100",
    ])
}

/// Returns links with small texts, so that some damage still gives one.
pub fn links() -> Vec<Vec<u8>> {
    let texts = ["", "a", "Layout(name: \"a\", boards: [])", "é é é é é é"];
    let link = |text: &str| ademan::layout_link::layout_link("https://example.org/", text);
    texts.map(|text| link(text).into_bytes()).into()
}

/// Returns scripts with every order, for the arrow keys.
pub fn scripts() -> Vec<Vec<u8>> {
    texts(&[
        include_str!("../../examples/scripts/arrows.txt"),
        "tap ArrowUp 3 -2; press ArrowDown; wait 200; slide 5 5 300; arc 90 500; lift # and again",
        "push ArrowLeft 0.5; bend middle 60 & bend ring 40 400; roll 20 500; pinch; unpinch 200",
        "point 150 30 -300\nset elbow-flexion 30 & set wrist-flexion -20 100; tap 'ArrowUp'",
    ])
}

fn texts(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

/// Returns an input for each setup of the pipeline: the hand rests until output is armed, plays its movements, and is
/// disturbed.
pub fn pipeline() -> Vec<Vec<u8>> {
    let played = [&[184][..], &[183; 40]].concat();
    let orders = [
        &[208, 8, 184, 183, 183][..],
        &[232, 184, 183, 183, 233, 183, 234, 184],
        &[240, 1, 184, 183, 183, 239, 0, 2, 9, 184, 183, 183],
        &[242, 140, 130, 120, 184, 183, 245, 150, 184, 183, 248, 183],
        &[223, 17, 1, 0, 20, 184, 183, 220, 183, 183],
    ];
    let seed = |setup: u8| [&[setup][..], &played, &orders.concat()].concat();
    (0..10).map(seed).collect()
}
