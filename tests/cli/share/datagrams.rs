//! Datagrams for receivers that others wrote, and for the sources of the program.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read};
use std::net::UdpSocket;
use std::process::{Command, Stdio};
use std::time::Duration;

use super::{is_part_of, share};
use crate::ademan;
use crate::support::free_address::free_address;
use crate::support::process::{Process, signal};
use crate::support::python::python;
use crate::text_line::pressed_keys;

/// Receives VMC with python-osc: prints its port, then the messages of 60 datagrams, one line of JSON each.
const OSC_RECEIVER: &str = r##"
import json, sys
from pythonosc.dispatcher import Dispatcher
from pythonosc.osc_server import BlockingOSCUDPServer

frames = 0
def received(address, *arguments):
    global frames
    frames += address == "/VMC/Ext/OK"
    print(json.dumps([address, *arguments]))

dispatcher = Dispatcher()
dispatcher.set_default_handler(received)
server = BlockingOSCUDPServer(("127.0.0.1", 0), dispatcher)
server.timeout = 60
print(server.server_address[1], flush=True)
while frames < 60:
    server.handle_request()
"##;

/// Bones of a right arm whose glove measures all fingers.
const BONES: [&str; 18] = [
    "RightHand",
    "RightIndexDistal",
    "RightIndexIntermediate",
    "RightIndexProximal",
    "RightLittleDistal",
    "RightLittleIntermediate",
    "RightLittleProximal",
    "RightLowerArm",
    "RightMiddleDistal",
    "RightMiddleIntermediate",
    "RightMiddleProximal",
    "RightRingDistal",
    "RightRingIntermediate",
    "RightRingProximal",
    "RightThumbDistal",
    "RightThumbIntermediate",
    "RightThumbProximal",
    "RightUpperArm",
];

#[test]
fn python_osc_receives_the_bones_of_a_typing_hand() {
    let python = match python("osc-receiver", "pythonosc", &["python-osc==1.9.3"]) {
        Ok(python) => python,
        Err(reason) => {
            println!("SKIPPED: cannot install the package python-osc: {reason}");
            return;
        }
    };
    let mut receiver = Command::new(python);
    receiver.args(["-c", OSC_RECEIVER]).stdout(Stdio::piped());
    let mut receiver = Process::start(&mut receiver).expect("it starts");
    let stdout = BufReader::new(receiver.0.stdout.take().expect("it is piped"));
    let mut lines = stdout.lines().map_while(Result::ok);
    let port = lines.next().expect("its port");
    let (_typist, _) = share("hola hola", &format!("vmc:127.0.0.1:{port}"));
    let mut bones: BTreeMap<String, Vec<[f64; 4]>> = BTreeMap::new();
    let (mut times, mut states) = (Vec::new(), Vec::new());
    for line in lines {
        let message: Vec<serde_json::Value> = serde_json::from_str(&line).expect("JSON");
        let number = |index: usize| message[index].as_f64().expect("a number");
        match message[0].as_str().expect("an address") {
            "/VMC/Ext/OK" => states.push(number(1)),
            "/VMC/Ext/T" => times.push(number(1)),
            "/VMC/Ext/Bone/Pos" => {
                let name = message[1].as_str().expect("a name").to_owned();
                let rotation = std::array::from_fn(|axis| number(5 + axis));
                bones.entry(name).or_default().push(rotation);
            }
            other => panic!("{other}"),
        }
    }
    println!("{} datagrams of {} bones", times.len(), bones.len());
    assert!(!states.is_empty() && states.iter().all(|&state| state == 1.0));
    assert!(
        times.is_sorted() && times.last() > times.first(),
        "{times:?}"
    );
    let names: Vec<_> = bones.keys().map(String::as_str).collect();
    assert_eq!(names, BONES);
    let lengths = bones
        .values()
        .flatten()
        .map(|it| it.iter().map(|x| x * x).sum::<f64>());
    assert!(
        lengths
            .into_iter()
            .all(|length| (length - 1.0).abs() < 1e-4)
    );
    // The palm of the T pose faces down: a finger of the right hand bends about the axis that points to the viewer, which
    // is −Z in the left-handed frame of Unity.
    let bent = &bones["RightIndexProximal"][0];
    assert!(bent[2].abs() > bent[0].abs().max(bent[1].abs()), "{bent:?}");
}

#[test]
fn another_program_types_the_bones_that_the_first_one_sends() {
    let text = "hola hola";
    let port = free_address().port();
    let source = format!("udp:127.0.0.1:{port}?protocol=vmc");
    let arguments = "run --control off --armed --role both --source";
    let mut second = ademan(arguments.split(' ').chain([source.as_str()]));
    second.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut second = Process::start(&mut second).expect("the program starts");
    let stderr = BufReader::new(second.0.stderr.take().expect("it is piped"));
    let mut messages = stderr.lines().map_while(Result::ok);
    let listens = messages.find(|line| line.contains(&source));
    assert!(listens.is_some(), "it listens");
    let reader = std::thread::spawn(move || messages.count());
    let (mut first, _) = share(text, &format!("vmc:127.0.0.1:{port}"));
    assert!(first.0.wait().expect("a child process").success());
    signal("TERM", second.0.id());
    let mut transcript = String::new();
    let mut stdout = second.0.stdout.take().expect("it is piped");
    stdout.read_to_string(&mut transcript).expect("UTF-8");
    reader.join().expect("the messages");
    let typed = pressed_keys(&transcript).concat().replace("Space", " ");
    println!("typed {typed}");
    assert!(is_part_of(&typed, &text.to_uppercase()), "{typed}");
}

#[test]
fn opentrack_receives_the_movement_of_the_wrist() {
    let receiver = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let timeout = Some(Duration::from_secs(60));
    receiver.set_read_timeout(timeout).expect("a socket");
    let address = receiver.local_addr().expect("it is bound");
    let (_typist, _) = share("hola", &format!("opentrack:{address}"));
    let mut largest = [0.0_f64; 6];
    let mut buffer = [0; 100];
    let mut count = 0;
    while largest[0] + largest[2] < 0.5 {
        let length = receiver.recv(&mut buffer).expect("a datagram");
        assert_eq!(length, 48);
        for (extreme, bytes) in largest.iter_mut().zip(buffer.as_chunks().0) {
            let number = f64::from_le_bytes(*bytes);
            assert!(count > 0 || number.abs() < 1e-3, "{number} at the start");
            *extreme = extreme.max(number.abs());
        }
        count += 1;
    }
    println!("{count} datagrams, at most {largest:?}");
    assert!(largest.iter().all(|it| it.is_finite()), "{largest:?}");
}
