//! The 6-DoF mouse, heard by programs over the real socket.
mod client;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use self::client::{Client, PATIENCE};
use crate::support::binary::ademan;
use crate::support::process::Process;
use ademan::device::{Axis, Capabilities, EventKind, OutputEvent};
use ademan::output::{self, OutputError, Sink};
use ademan::time::Timestamp;
use tempfile::TempDir;

fn open(path: &Path) -> Result<Box<dyn Sink>, OutputError> {
    output::open(
        &format!("spacenav:{}", path.display()),
        &Capabilities::default(),
    )
}

fn server() -> (Box<dyn Sink>, PathBuf, TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("spnav.sock");
    (open(&path).expect("the socket can be made"), path, folder)
}

fn at(millis: u64, action: EventKind) -> OutputEvent {
    OutputEvent {
        time: Timestamp(millis * 1000),
        kind: action,
    }
}

fn axis(millis: u64, axis: Axis, value: f32) -> OutputEvent {
    at(millis, EventKind::Axis(axis, value))
}

fn down(millis: u64, name: &str) -> OutputEvent {
    at(millis, EventKind::KeyDown(name.parse().expect("a key")))
}

fn up(millis: u64, name: &str) -> OutputEvent {
    at(millis, EventKind::KeyUp(name.parse().expect("a key")))
}

/// Waits until a file is there.
fn wait_for(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(
            start.elapsed() < PATIENCE,
            "{} is not there",
            path.display()
        );
        thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_client_of_version_0_hears_motion_at_its_own_sensitivity_and_buttons() {
    let (mut sink, path, _folder) = server();
    let mut plain = Client::connect(&path);
    let mut keen = Client::connect(&path);
    plain.settle();
    keen.say(&[2.0_f32.to_bits() as i32]);
    keen.settle();
    let turned = axis(20, Axis::TurnY, -1.0);
    sink.send(&[
        axis(20, Axis::MoveX, 0.1),
        axis(20, Axis::MoveZ, 0.2),
        turned,
    ])
    .unwrap();
    assert_eq!(plain.hear(), [0, 35, 70, 0, 0, 0, -350, 1]);
    assert_eq!(keen.hear(), [0, 70, 140, 0, 0, 0, -700, 1]);
    sink.send(&[down(30, "PadEast"), axis(36, Axis::MoveX, 0.0)])
        .unwrap();
    assert_eq!(plain.hear(), [1, 1, 1, 0, 0, 0, 0, 0]);
    assert_eq!(plain.hear(), [0, 0, 70, 0, 0, 0, -350, 16]);
    sink.send(&[up(40, "PadEast")]).unwrap();
    assert_eq!(plain.hear(), [2, 1, 0, 0, 0, 0, 0, 0]);
}

#[test]
fn a_client_of_version_1_asks_for_what_it_wants_to_know_and_hear() {
    let (mut sink, path, _folder) = server();
    let mut client = Client::of_version_1(&path);
    let [letters @ .., left] = client.ask(0x2000, 0);
    let name: Vec<u8> = letters.into_iter().flat_map(i32::to_ne_bytes).collect();
    assert_eq!(&name[..left as usize], b"Ademan");
    assert_eq!(client.ask(0x2001, 0)[6], path.as_os_str().len() as i32);
    for _ in 0..(path.as_os_str().len() - 1) / 24 {
        assert_eq!(client.hear::<8>()[7] >> 16, 1, "the path goes on");
    }
    assert_eq!((client.ask(0x2002, 0)[0], client.ask(0x2003, 0)[0]), (6, 4));
    assert_eq!(client.ask(0x1004, 0)[0], 0x07);
    assert_eq!(client.ask(0x1001, 0.5_f32.to_bits() as i32)[6], 0);
    assert_eq!(client.ask(0x3000, 0)[6], -1);

    sink.send(&[axis(1, Axis::MoveY, 1.0)]).unwrap();
    assert_eq!(client.hear(), [0, 0, 0, 175, 0, 0, 0, 1]);
    assert_eq!(client.ask(0x1003, 0x02)[6], 0);
    sink.send(&[axis(2, Axis::MoveY, 0.0), down(2, "PadSouth")])
        .unwrap();
    assert_eq!(client.hear::<8>()[..3], [1, 0, 1], "buttons only");
}

#[test]
fn at_the_end_everything_is_at_rest_and_up_and_the_socket_is_gone() {
    let (mut sink, path, _folder) = server();
    let mut client = Client::connect(&path);
    client.settle();
    sink.send(&[axis(1, Axis::TurnX, 1.0), down(1, "PadWest")])
        .unwrap();
    sink.close().unwrap();
    let heard = client.rest();
    assert!(heard.contains(&[1, 3, 1, 0, 0, 0, 0, 0]), "{heard:?}");
    assert!(heard.contains(&[2, 3, 0, 0, 0, 0, 0, 0]), "{heard:?}");
    let motion = heard.iter().rev().find(|packet| packet[0] == 0);
    assert_eq!(motion.expect("a motion")[1..7], [0; 6]);
    assert!(!path.exists());
    let error = sink.send(&[axis(2, Axis::TurnX, 0.5)]).unwrap_err();
    assert!(error.to_string().contains("it is closed"), "{error}");
}

#[test]
fn who_never_reads_is_cut_off_and_no_other_notices() {
    let (mut sink, path, _folder) = server();
    let mut deaf = Client::connect(&path);
    deaf.settle();
    let mut client = Client::connect(&path);
    client.settle();
    let start = Instant::now();
    let mut frame = 0;
    // Whoever was cut off cannot say anything any more.
    let is_cut_off = |deaf: &mut Client| std::io::Write::write_all(&mut deaf.0, &[0; 4]).is_err();
    while !is_cut_off(&mut deaf) {
        frame += 1;
        let value = [0.5, 1.0][frame % 2];
        sink.send(&[axis(frame as u64, Axis::MoveX, value)])
            .unwrap();
        assert_eq!(client.hear::<8>()[1], (value * 350.0) as i32);
        assert!(start.elapsed() < PATIENCE, "{frame} frames");
        thread::sleep(Duration::from_millis(2));
    }
    sink.send(&[axis(frame as u64, Axis::MoveX, 0.0)]).unwrap();
    assert_eq!(client.hear::<8>()[..7], [0; 7]);
    assert_eq!(sink.coalesced_motions(), 0);
}

#[test]
fn the_sixteen_that_are_there_stay_when_another_one_comes() {
    let (mut sink, path, _folder) = server();
    let mut clients: Vec<_> = (0..16).map(|_| Client::of_version_1(&path)).collect();
    assert_eq!(Client::connect(&path).rest(), Vec::<[i32; 8]>::new());
    sink.send(&[down(1, "PadNorth")]).unwrap();
    for client in &mut clients {
        assert_eq!(client.hear::<8>()[..3], [1, 2, 1]);
    }
    clients.pop();
    let start = Instant::now();
    // Its place is free as soon as the server has seen it go.
    while !Client::connect(&path).is_welcome() {
        assert!(start.elapsed() < PATIENCE);
    }
}

#[test]
fn the_socket_is_its_owners_and_a_second_server_is_refused_with_the_reason() {
    let (sink, path, folder) = server();
    let mode = std::fs::symlink_metadata(&path)
        .unwrap()
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o600);
    let refused = open(&path).err().expect("it is taken").to_string();
    assert!(
        refused.contains("another program listens there"),
        "{refused}"
    );
    assert!(
        refused.contains("use another path: spacenav:PATH"),
        "{refused}"
    );
    drop(sink);
    // As after a crash.
    drop(std::os::unix::net::UnixListener::bind(&path).unwrap());
    open(&path).expect("it is taken over");
    let long = folder.path().join("x".repeat(108));
    let refused = open(&long).err().expect("it is too long").to_string();
    assert!(refused.contains("at most 107"), "{refused}");
}

/// How the hand moves the lever of the layout `workshop`.
const LEVER: &str = "script:wait 2000; press Lift; slide 25 0; wait 300; lift";

/// The real program, and a hand that plays a script on a layout.
fn run(layout: &str, source: &str, output: &str) -> Command {
    let mut command = ademan(["run", "--armed", "--control", "off", "--layout", layout]);
    command.args(["--source", source, "--output", output]);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command
}

/// Height, the second axis: it leaves rest, and ends there.
fn assert_lifted(heights: &[i32]) {
    assert!(
        heights.iter().any(|height| height.abs() > 30),
        "{heights:?}"
    );
    assert_eq!(heights.last(), Some(&0), "{heights:?}");
}

#[test]
fn a_lever_moves_what_a_3d_program_shows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ademan/spnav.sock");
    // Whatever the lever is not for goes nowhere.
    let mut program = run("workshop", LEVER, "spacenav,none");
    let mut program = Process::start(program.env("XDG_RUNTIME_DIR", folder.path())).unwrap();
    wait_for(&path);
    let above = std::fs::metadata(path.parent().unwrap()).unwrap();
    assert_eq!(above.permissions().mode() & 0o777, 0o700);
    let heard = Client::connect(&path).rest();
    assert!(heard.iter().all(|packet| packet[0] == 0), "{heard:?}");
    let others = |packet: &[i32; 8]| [packet[1], packet[3], packet[4], packet[5], packet[6]];
    assert!(
        heard.iter().all(|packet| others(packet) == [0; 5]),
        "{heard:?}"
    );
    assert_lifted(&heard.iter().map(|packet| packet[2]).collect::<Vec<_>>());

    assert!(program.0.wait().unwrap().success());
    let told = BufReader::new(program.0.stderr.take().unwrap()).lines();
    let told: Vec<_> = told.map_while(Result::ok).collect();
    let with = format!("SPNAV_SOCKET={}", path.display());
    let lines = told.iter().filter(|line| line.ends_with(&with));
    assert_eq!(lines.count(), 1, "{told:#?}");
}

/// A 3D program, compiled with Debian's libspnav in this folder, or `None` where there is none.
fn compiled_client(folder: &Path) -> Option<PathBuf> {
    let client = folder.join("client");
    let source = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/outputs/spacenav/client.c"
    );
    let compiled = Command::new("cc")
        .arg(source)
        .arg("-o")
        .arg(&client)
        .args(["-lspnav", "-lm"])
        .output();
    match compiled {
        Ok(output) if output.status.success() => return Some(client),
        Ok(output) => {
            let reason = String::from_utf8_lossy(&output.stderr);
            let is_absent = reason.contains("spnav.h") || reason.contains("cannot find -lspnav");
            assert!(is_absent, "{reason}");
            println!("SKIPPED: libspnav is not there to be compiled with");
        }
        Err(error) => println!("SKIPPED: no C compiler: {error}"),
    }
    None
}

/// What two 3D programs tell, one at the usual sensitivity and one at twice that, while a hand plays a script.
fn told_by_two(layout: &str, source: &str) -> Option<[Vec<String>; 2]> {
    let folder = tempfile::tempdir().unwrap();
    let client = compiled_client(folder.path())?;
    let path = folder.path().join("spnav.sock");
    let output = format!("spacenav:{},none", path.display());
    let _program = Process::start(&mut run(layout, source, &output)).unwrap();
    wait_for(&path);
    let clients = ["1", "2"].map(|sensitivity| {
        let mut client = Command::new(&client);
        client.arg(sensitivity).env("SPNAV_SOCKET", &path);
        Process::start(client.stdout(Stdio::piped())).unwrap()
    });
    let told = clients.map(|mut client| {
        let told = BufReader::new(client.0.stdout.take().unwrap()).lines();
        told.map_while(Result::ok).collect::<Vec<_>>()
    });
    for told in &told {
        let greeting = [
            "protocol 1, device Ademan, 6 axes, 4 buttons",
            "sensitivity 0",
            "ids -1, type 0, settings -1",
        ];
        assert_eq!(told[..3], greeting);
    }
    println!("{:#?}", told[0]);
    Some(told.map(|told| told[3..].to_vec()))
}

#[test]
fn programs_with_libspnav_hear_the_lever_each_at_its_own_sensitivity() {
    let Some(told) = told_by_two("workshop", LEVER) else {
        return;
    };
    let height = |line: &String| -> i32 {
        let words: Vec<&str> = line.split(' ').collect();
        assert_eq!(words[0], "motion", "{line}");
        words[2].parse().expect("a number")
    };
    let [plain, keen] = told.map(|lines| lines.iter().map(height).collect::<Vec<_>>());
    assert_lifted(&plain);
    let twice: Vec<_> = plain.iter().map(|height| 2 * height).collect();
    assert_eq!(keen, twice);
}

#[test]
fn programs_with_libspnav_hear_the_keys_of_a_layout_that_are_buttons() {
    let source = "script:wait 2000; tap PadSouth; tap PadWest";
    let Some(told) = told_by_two("game", source) else {
        return;
    };
    for lines in told {
        let expected = [
            "button 0 down",
            "button 0 up",
            "button 3 down",
            "button 3 up",
        ];
        let buttons: Vec<_> = lines
            .iter()
            .filter(|line| line.starts_with("button"))
            .collect();
        assert_eq!(buttons, expected);
    }
}
