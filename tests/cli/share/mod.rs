//! A hand shared with other programs.

mod blender;
mod blender_bridge;
mod command;
mod datagrams;
#[cfg(target_os = "linux")]
mod floods;
mod json;
mod page;
mod websocket;

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read};
use std::net::TcpStream;
use std::process::Stdio;

use crate::support::process::{Process, signal};
use crate::text_line::pressed_keys;
use crate::{ademan, run};

/// Starts a simulated hand that types and shares. Returns it, and the address of its server.
fn typist(text: &str, format: &str) -> (Process, String) {
    share(text, &format!("{format}:127.0.0.1:0"))
}

/// Starts a simulated hand that types and shares with a target. Returns it, and the address of the target.
fn share(text: &str, target: &str) -> (Process, String) {
    share_source(&format!("typist:{text}"), target)
}

/// Shares a source with a target. Returns the program, and the address of the target.
fn share_source(source: &str, target: &str) -> (Process, String) {
    let arguments = [
        "--control",
        "off",
        "--output",
        "none",
        "--source",
        source,
        "--share",
        target,
    ];
    let mut command = ademan(["run"].into_iter().chain(arguments));
    command.stderr(Stdio::piped());
    let mut process = Process::start(&mut command).expect("the program starts");
    let stderr = BufReader::new(process.0.stderr.take().expect("it is piped"));
    let mut lines = stderr.lines().map_while(Result::ok);
    let line = lines.find_map(|line| {
        let (shared, _) = line.strip_prefix("sharing ")?.split_once(": ")?;
        Some(shared.to_owned())
    });
    let shared_target = line.expect("a message about the target");
    let (_, address) = shared_target.split_once(':').expect("a format");
    (process, address.to_owned())
}

/// Returns `true` if another program has typed keys of a text in their order. A busy machine loses
/// some, and never adds one.
pub fn is_part_of(typed: &str, text: &str) -> bool {
    let mut rest = text.chars();
    typed.len() >= 5 && typed.chars().all(|key| rest.any(|other| other == key))
}

#[test]
fn another_program_types_what_the_first_one_shares() {
    // The text is long enough for a busy machine to start the second program.
    let text = "hola hola hola hola hola";
    let (mut first, address) = typist(text, "text-line");
    let source = format!("tcp:{address}?protocol=text-line");
    let arguments = [
        "--control",
        "off",
        "--armed",
        "--role",
        "both",
        "--source",
        &source,
    ];
    let mut second = ademan(["run"].into_iter().chain(arguments));
    second.stdout(Stdio::piped()).stderr(Stdio::null());
    let mut second = Process::start(&mut second).expect("the program starts");
    let status = first.0.wait().expect("a child process");
    assert!(status.success());
    signal("TERM", second.0.id());
    let mut transcript = String::new();
    let mut stdout = second.0.stdout.take().expect("it is piped");
    stdout.read_to_string(&mut transcript).expect("UTF-8");
    let typed = pressed_keys(&transcript).concat().replace("Space", " ");
    assert!(is_part_of(&typed, &text.to_uppercase()), "{typed}");
}

#[test]
fn poses_and_angles_are_shared_as_lines_of_json() {
    let pose = ["time_us", "side", "positions", "orientations"];
    let angles = ["time_us", "side", "angles"];
    for (format, fields) in [("pose", &pose[..]), ("angles", &angles[..])] {
        let (_typist, address) = typist(&"hola ".repeat(100), format);
        let client = TcpStream::connect(address).expect("it listens");
        let lines = BufReader::new(client).lines().map_while(Result::ok);
        let lines: Vec<serde_json::Value> = lines
            .take(20)
            .map(|line| serde_json::from_str(&line).expect("JSON"))
            .collect();
        assert_eq!(lines.len(), 20);
        for line in &lines {
            let object = line.as_object().expect("an object");
            let names: BTreeSet<_> = object.keys().map(String::as_str).collect();
            let expected: BTreeSet<_> = fields.iter().copied().collect();
            assert_eq!(names, expected, "no line names a key that is pressed");
            assert!(line[fields[2]].is_object(), "{line}");
        }
        let times: Vec<_> = lines.iter().map(|line| line["time_us"].as_u64()).collect();
        assert!(times.is_sorted(), "{times:?}");
    }
}

#[test]
fn an_address_that_others_can_reach_is_refused() {
    let share = |target: &str| run(["run", "--source", "typist:a", "--share", target]);
    let remote = share("text-line:0.0.0.0:10002").exited(2);
    remote.reported("every network of the machine");
    let port = std::net::TcpListener::bind("127.0.0.1:0").expect("a free port");
    let taken = share(&format!("pose:{}", port.local_addr().expect("it is bound"))).exited(2);
    taken.reported("choose another one");
}
