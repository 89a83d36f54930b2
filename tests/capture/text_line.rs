//! Text lines of joint angles over every transport, from the sensor to the typed text.

use std::fs;
use std::io::Write;
use std::net::{TcpListener, UdpSocket};
use std::time::Duration;

use ademan::capture::protocol::StreamFormat;
use ademan::capture::protocol::text_line::{self, angles, parse};
use ademan::capture::{
    Reading, Sample, Source, SourceEvent, SourceUri, StreamUri, open, open_loopback,
};
use ademan::device::Events;
use ademan::setup::Setup;
use ademan::sim::UsTextField;
use ademan::time::Timestamp;

use crate::support::free_address::free_address;
use crate::support::source::{next_within, text_lines};

/// Longest wait on a busy machine.
pub const TIMEOUT: Duration = Duration::from_secs(60);

const TEXT: &str = "Hola";

/// Line rate of the simulated hand.
const RATE_HZ: f64 = 170.0;

fn lines() -> Vec<String> {
    text_lines(TEXT)
}

fn sample(line: &str) -> Sample {
    Sample::Angles {
        angles: angles(&parse(line).expect("a valid line")),
    }
}

/// Returns the next `count` samples of a source.
pub fn samples(source: &mut dyn Source, count: usize) -> Vec<Sample> {
    let next = |_| match next_within(source, TIMEOUT) {
        Ok(SourceEvent::Reading(reading)) => reading.sample,
        other => panic!("no reading: {other:?}"),
    };
    (0..count).map(next).collect()
}

pub fn uri(text: &str) -> SourceUri {
    text.parse().expect("a source URI")
}

#[test]
fn a_tcp_server_delivers_angles_and_an_invalid_line_keeps_the_connection() {
    let lines = lines();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let mut source = open(&uri(&format!("tcp:{address}?protocol=text-line"))).unwrap();
    let (mut peer, _) = listener.accept().expect("the source connects");
    peer.write_all(lines[0].as_bytes()).unwrap();
    peer.write_all(b"1.0 2.0 NaN\r\n\n").unwrap();
    peer.write_all(lines[1].replace('\n', "\r\n").as_bytes())
        .unwrap();
    let received = samples(&mut *source, 2);
    assert_eq!(received, [sample(&lines[0]), sample(&lines[1])]);
    let stats = source.stats();
    assert_eq!((stats.readings, stats.losses), (2, 0));
    assert_eq!((stats.skipped_bytes, stats.resyncs), (14, 1));
}

#[test]
fn udp_datagrams_deliver_angles_with_or_without_a_line_end() {
    let lines = lines();
    let sender = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    // A port that was just free: the source reports an error if another program has taken it.
    let address = free_address();
    let mut source = open(&uri(&format!("udp:{address}?protocol=text-line"))).unwrap();
    for datagram in [
        lines[0].as_str(),
        "",
        "not a line",
        lines[1].trim_end(),
        &lines[2],
    ] {
        sender.send_to(datagram.as_bytes(), address).unwrap();
    }
    let received = samples(&mut *source, 3);
    let expected: Vec<Sample> = lines[..3].iter().map(|line| sample(line)).collect();
    assert_eq!(received, expected);
    assert_eq!(source.stats().skipped_bytes, 10);
}

#[test]
fn a_serial_port_delivers_angles() {
    let lines = lines();
    let format = StreamFormat::new(&text_line::PROTOCOL);
    let mut loopback = open_loopback(format).unwrap();
    let SourceUri::Stream(StreamUri {
        format: opened_format,
        ..
    }) = &loopback.uri
    else {
        panic!("{}", loopback.uri);
    };
    assert_eq!(opened_format.protocol.name, "text-line");
    let mut source = open(&loopback.uri).unwrap();
    loopback.writer.write_all(lines[0].as_bytes()).unwrap();
    loopback.writer.write_all(lines[1].as_bytes()).unwrap();
    let received = samples(&mut *source, 2);
    assert_eq!(received, [sample(&lines[0]), sample(&lines[1])]);
}

/// Steps the pipeline with every reading of a source. Returns the typed text and the readings.
pub fn type_with(mut source: impl Source) -> (String, Vec<Reading>) {
    let setup = Setup::default().load_files().expect("the default setup");
    let mut pipeline = setup.pipeline();
    let mut field = UsTextField::new();
    let mut readings = Vec::new();
    let mut events = Events::new();
    loop {
        match source.next().expect("a readable source") {
            SourceEvent::Reading(reading) => {
                events.clear();
                if let Err(rejection) = pipeline.step(&reading, &mut events) {
                    panic!("{rejection} at {:?}", reading.time);
                }
                events.iter().for_each(|event| field.handle(event));
                readings.push(reading);
            }
            SourceEvent::Idle | SourceEvent::Command(_) => {}
            SourceEvent::End => return (field.text().to_owned(), readings),
        }
    }
}

#[test]
fn a_file_of_angles_is_typed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("angles.txt");
    fs::write(&path, lines().concat()).unwrap();
    let uri = format!(
        "file:{}?protocol=text-line&rate_hz={RATE_HZ}",
        path.display()
    );
    let (text, readings) = type_with(open(&uri.parse().unwrap()).unwrap());
    assert_eq!(text, TEXT);
    assert_eq!(readings[9].time, Timestamp::from_seconds(10.0 / RATE_HZ));
}
