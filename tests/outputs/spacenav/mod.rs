//! The output `spacenav`, as clients of its socket receive it.
mod client;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use self::client::{Client, TIMEOUT};
use crate::support::binary::ademan;
use crate::support::full_pipe::full_pipe;
use crate::support::process::Process;
use crate::support::x11::wait_for;
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
    (open(&path).expect("a new socket"), path, folder)
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

#[test]
fn a_client_of_version_0_receives_motion_at_its_sensitivity_and_buttons() {
    let (mut sink, path, _folder) = server();
    let mut plain = Client::connect(&path);
    let mut sensitive = Client::connect(&path);
    plain.sync();
    sensitive.send(&[2.0_f32.to_bits() as i32]);
    sensitive.sync();
    let turned = axis(20, Axis::TurnY, -1.0);
    sink.send(&[
        axis(20, Axis::MoveX, 0.1),
        axis(20, Axis::MoveZ, 0.2),
        turned,
    ])
    .unwrap();
    assert_eq!(plain.receive(), [0, 35, 70, 0, 0, 0, -350, 1]);
    assert_eq!(sensitive.receive(), [0, 70, 140, 0, 0, 0, -700, 1]);
    sink.send(&[down(30, "PadEast"), axis(36, Axis::MoveX, 0.0)])
        .unwrap();
    assert_eq!(plain.receive(), [1, 1, 1, 0, 0, 0, 0, 0]);
    assert_eq!(plain.receive(), [0, 0, 70, 0, 0, 0, -350, 16]);
    sink.send(&[up(40, "PadEast")]).unwrap();
    assert_eq!(plain.receive(), [2, 1, 0, 0, 0, 0, 0, 0]);
}

#[test]
fn a_client_connect_version_1_queries_the_device_and_selects_events() {
    let (mut sink, path, _folder) = server();
    let mut client = Client::connect_version_1(&path);
    let [letters @ .., left] = client.request(0x2000, 0);
    let name: Vec<u8> = letters.into_iter().flat_map(i32::to_ne_bytes).collect();
    assert_eq!(&name[..left as usize], b"Ademan");
    assert_eq!(client.request(0x2001, 0)[6], path.as_os_str().len() as i32);
    for _ in 0..(path.as_os_str().len() - 1) / 24 {
        assert_eq!(client.receive::<8>()[7] >> 16, 1, "the path continues");
    }
    assert_eq!(
        (client.request(0x2002, 0)[0], client.request(0x2003, 0)[0]),
        (6, 4)
    );
    assert_eq!(client.request(0x1004, 0)[0], 0x07);
    assert_eq!(client.request(0x1001, 0.5_f32.to_bits() as i32)[6], 0);
    assert_eq!(client.request(0x3000, 0)[6], -1);

    sink.send(&[axis(1, Axis::MoveY, 1.0)]).unwrap();
    assert_eq!(client.receive(), [0, 0, 0, 175, 0, 0, 0, 1]);
    assert_eq!(client.request(0x1003, 0x02)[6], 0);
    sink.send(&[axis(2, Axis::MoveY, 0.0), down(2, "PadSouth")])
        .unwrap();
    assert_eq!(client.receive::<8>()[..3], [1, 0, 1], "button events only");
}

#[test]
fn closing_centers_axes_releases_buttons_and_removes_the_socket() {
    let (mut sink, path, _folder) = server();
    let mut client = Client::connect(&path);
    client.sync();
    sink.send(&[axis(1, Axis::TurnX, 1.0), down(1, "PadWest")])
        .unwrap();
    sink.close().unwrap();
    let received = client.read_to_end();
    assert!(received.contains(&[1, 3, 1, 0, 0, 0, 0, 0]), "{received:?}");
    assert!(received.contains(&[2, 3, 0, 0, 0, 0, 0, 0]), "{received:?}");
    let motion = received.iter().rev().find(|packet| packet[0] == 0);
    assert_eq!(motion.expect("a motion")[1..7], [0; 6]);
    assert!(!path.exists());
    let error = sink.send(&[axis(2, Axis::TurnX, 0.5)]).unwrap_err();
    assert!(error.to_string().contains("it is closed"), "{error}");
}

#[test]
fn a_client_that_does_not_read_is_disconnected_without_an_effect_on_others() {
    let (mut sink, path, _folder) = server();
    let mut blocked = Client::connect(&path);
    blocked.sync();
    let mut client = Client::connect(&path);
    client.sync();
    let start = Instant::now();
    let mut step = 0;
    // Writing to a disconnected socket fails.
    let is_disconnected = |blocked_client: &mut Client| {
        std::io::Write::write_all(&mut blocked_client.0, &[0; 4]).is_err()
    };
    while !is_disconnected(&mut blocked) {
        step += 1;
        let value = [0.5, 1.0][step % 2];
        sink.send(&[axis(step as u64, Axis::MoveX, value)]).unwrap();
        assert_eq!(client.receive::<8>()[1], (value * 350.0) as i32);
        assert!(start.elapsed() < TIMEOUT, "{step} steps");
        thread::sleep(Duration::from_millis(2));
    }
    sink.send(&[axis(step as u64, Axis::MoveX, 0.0)]).unwrap();
    assert_eq!(client.receive::<8>()[..7], [0; 7]);
    assert_eq!(sink.coalesced_motions(), 0);
}

#[test]
fn the_seventeenth_client_is_rejected() {
    let (mut sink, path, _folder) = server();
    let mut clients: Vec<_> = (0..16).map(|_| Client::connect_version_1(&path)).collect();
    assert_eq!(Client::connect(&path).read_to_end(), Vec::<[i32; 8]>::new());
    sink.send(&[down(1, "PadNorth")]).unwrap();
    for client in &mut clients {
        assert_eq!(client.receive::<8>()[..3], [1, 2, 1]);
    }
    clients.pop();
    // The server accepts another client as soon as it has seen the disconnection.
    assert!(wait_for(|| Client::connect(&path).is_accepted()));
}

#[test]
fn the_socket_is_private_and_a_second_server_is_an_error() {
    let (sink, path, folder) = server();
    let mode = std::fs::symlink_metadata(&path)
        .unwrap()
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o600);
    let error = open(&path).err().expect("the socket is in use").to_string();
    assert!(error.contains("another program listens there"), "{error}");
    assert!(error.contains("use another path: spacenav:PATH"), "{error}");
    drop(sink);
    // A socket left behind by a crash.
    drop(std::os::unix::net::UnixListener::bind(&path).unwrap());
    open(&path).expect("the socket is replaced");
    let long = folder.path().join("x".repeat(108));
    let long_error = open(&long).err().expect("the path is too long").to_string();
    assert!(long_error.contains("at most 107"), "{long_error}");
}

/// Moves the lever of the layout `workshop`, once clients of a slow machine are connected.
const LEVER: &str = "script:wait 6000; press Lift; slide 25 0; wait 300; lift";

/// Returns a command in which a simulated hand plays a script on a layout.
fn run(layout: &str, source: &str, output: &str) -> Command {
    let mut command = ademan(["run", "--armed", "--control", "off", "--layout", layout]);
    command.args(["--source", source, "--output", output]);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command
}

/// Checks values of the second axis, the height: it leaves its center and returns to it.
fn assert_lifted(heights: &[i32]) {
    assert!(
        heights.iter().any(|height| height.abs() > 30),
        "{heights:?}"
    );
    assert_eq!(heights.last(), Some(&0), "{heights:?}");
}

#[test]
fn a_lever_sends_motion() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ademan/spnav.sock");
    // `none` receives everything else.
    let mut program = run("workshop", LEVER, "spacenav,none");
    let mut program = Process::start(program.env("XDG_RUNTIME_DIR", folder.path())).unwrap();
    assert!(wait_for(|| path.exists()), "no socket");
    let above = std::fs::metadata(path.parent().unwrap()).unwrap();
    assert_eq!(above.permissions().mode() & 0o777, 0o700);
    let received = Client::connect(&path).read_to_end();
    assert!(received.iter().all(|packet| packet[0] == 0), "{received:?}");
    let others = |packet: &[i32; 8]| [packet[1], packet[3], packet[4], packet[5], packet[6]];
    assert!(
        received.iter().all(|packet| others(packet) == [0; 5]),
        "{received:?}"
    );
    assert_lifted(&received.iter().map(|packet| packet[2]).collect::<Vec<_>>());

    assert!(program.0.wait().unwrap().success());
    let lines = BufReader::new(program.0.stderr.take().unwrap()).lines();
    let lines: Vec<_> = lines.map_while(Result::ok).collect();
    let with = format!("SPNAV_SOCKET={}", path.display());
    let paths = lines.iter().filter(|line| line.ends_with(&with));
    assert_eq!(paths.count(), 1, "{lines:#?}");
}

#[test]
fn a_lever_returns_to_its_center_while_nobody_reads_the_standard_streams() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("spnav.sock");
    let ((_out, stdout), (_err, stderr)) = (full_pipe(), full_pipe());
    // The transcript comes first, so that the server waits for it, if anything does.
    let output = format!("transcript,spacenav:{},none", path.display());
    let mut command = run("workshop", LEVER, &output);
    let mut program = Process::start(command.stdout(stdout).stderr(stderr)).unwrap();
    assert!(wait_for(|| path.exists()), "no socket");
    let received = Client::connect(&path).read_to_end();
    assert_lifted(&received.iter().map(|packet| packet[2]).collect::<Vec<_>>());
    assert!(program.0.wait().unwrap().success());
}

/// Compiles a client with Debian's libspnav. Returns `None` with a message if it is not installed.
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
            println!("SKIPPED: libspnav is not installed");
        }
        Err(error) => println!("SKIPPED: no C compiler: {error}"),
    }
    None
}

/// Returns the lines of two clients, at the default and at the doubled sensitivity, while a hand plays a script.
fn lines_of_two_clients(layout: &str, source: &str) -> Option<[Vec<String>; 2]> {
    let folder = tempfile::tempdir().unwrap();
    let client = compiled_client(folder.path())?;
    let path = folder.path().join("spnav.sock");
    let output = format!("spacenav:{},none", path.display());
    let _program = Process::start(&mut run(layout, source, &output)).unwrap();
    assert!(wait_for(|| path.exists()), "no socket");
    let clients = ["1", "2"].map(|sensitivity| {
        let mut client = Command::new(&client);
        client.arg(sensitivity).env("SPNAV_SOCKET", &path);
        Process::start(client.stdout(Stdio::piped())).unwrap()
    });
    let lines = clients.map(|mut process| {
        let lines = BufReader::new(process.0.stdout.take().unwrap()).lines();
        lines.map_while(Result::ok).collect::<Vec<_>>()
    });
    for client_lines in &lines {
        let greeting = [
            "protocol 1, device Ademan, 6 axes, 4 buttons",
            "sensitivity 0",
            "ids -1, type 0, settings -1",
        ];
        assert_eq!(client_lines[..3], greeting);
    }
    println!("{:#?}", lines[0]);
    Some(lines.map(|lines| lines[3..].to_vec()))
}

#[test]
fn libspnav_clients_receive_the_lever_at_their_own_sensitivity() {
    let Some(lines) = lines_of_two_clients("workshop", LEVER) else {
        return;
    };
    let height = |line: &String| -> i32 {
        let words: Vec<&str> = line.split(' ').collect();
        assert_eq!(words[0], "motion", "{line}");
        words[2].parse().expect("a number")
    };
    let [plain, sensitive] =
        lines.map(|client_lines| client_lines.iter().map(height).collect::<Vec<_>>());
    assert_lifted(&plain);
    let twice: Vec<_> = plain.iter().map(|lifted| 2 * lifted).collect();
    assert_eq!(sensitive, twice);
}

#[test]
fn libspnav_clients_receive_buttons() {
    let source = "script:wait 6000; tap PadSouth; tap PadWest";
    let Some(lines) = lines_of_two_clients("game", source) else {
        return;
    };
    for client_lines in lines {
        let expected = [
            "button 0 down",
            "button 0 up",
            "button 3 down",
            "button 3 up",
        ];
        let buttons: Vec<_> = client_lines
            .iter()
            .filter(|line| line.starts_with("button"))
            .collect();
        assert_eq!(buttons, expected);
    }
}
