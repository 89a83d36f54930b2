//! A peer that sends text between valid packets, and with it causes a message per packet.

use std::io::Write;
use std::net::TcpListener;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::support::binary::ademan;
use crate::support::press::Press;
use crate::support::process::{Process, signal};
use crate::support::run::{accept, line_receiver};
use crate::support::wearer::packets;

/// Time in which the peer sends.
const DURATION: Duration = Duration::from_secs(3);

#[test]
fn text_between_packets_causes_one_message_in_ten_seconds_and_a_count() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let source = format!("tcp:{}", listener.local_addr().expect("an address"));
    let mut command = ademan(["run", "--source", &source, "--control", "off"]);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let mut program = Process::start(&mut command).expect("the program starts");
    let lines = line_receiver(program.0.stderr.take().expect("it is piped"));
    let mut peer = accept(&listener);
    let clear = Press::for_text("h").clear();
    let mut piece = packets(&[clear; 3]);
    piece.extend(b"\r\nBUFFALO 3.4 (ext) - a line of text\r\n");
    let (start, mut sent) = (Instant::now(), 0);
    while start.elapsed() < DURATION {
        peer.write_all(&piece).expect("the program reads");
        sent += 1;
    }
    // The session ends with the summary of what was held back.
    signal("TERM", program.0.id());
    program.0.wait().expect("the program ends");
    let intervals = 1 + start.elapsed().as_secs() as usize / 10;

    // Up to the end of the stream: the last line comes right before the end of the program.
    let lines: Vec<_> = lines.iter().collect();
    println!("{sent} texts: {} lines, {lines:#?}", lines.len());
    for kind in ["it sent text", "stalled", "paused: hold", "rejected:"] {
        let count = lines.iter().filter(|line| line.contains(kind)).count();
        assert!(count <= 1 + intervals, "{kind}: {count} lines");
    }
    let summary = lines
        .iter()
        .find(|line| line.contains("it sent text") && line.contains("more of these in 10 s)"));
    assert!(summary.is_some(), "{lines:#?}");
}
