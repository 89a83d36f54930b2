//! Landmarks of a body over the network.

use std::io::Write;
use std::net::{TcpListener, UdpSocket};
use std::time::Duration;

use ademan::capture::protocol::body_landmarks::encode;
use ademan::capture::{Sample, Source, SourceEvent, SourceUri, open};
use ademan::hand::Side;

use crate::support::body::taps;
use crate::support::free_address::free_address;
use crate::support::source::next_within;

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Returns the next `count` samples of a source.
fn samples(source: &mut dyn Source, count: usize) -> Vec<Sample> {
    let next = |_| match next_within(source, TIMEOUT) {
        Ok(SourceEvent::Reading(reading)) => reading.sample,
        other => panic!("no reading: {other:?}"),
    };
    (0..count).map(next).collect()
}

fn uri(text: &str) -> SourceUri {
    text.parse().expect("a source URI")
}

#[test]
fn a_tcp_server_delivers_landmarks_and_invalid_lines_keep_the_connection() {
    let bodies = taps(&[Side::Right]);
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let mut source = open(&uri(&format!("tcp:{address}?protocol=body-landmarks"))).unwrap();
    let (mut peer, _) = listener.accept().expect("the source connects");
    peer.write_all(encode(&bodies[0]).as_bytes()).unwrap();
    let collapsed = encode(&bodies[0]).replacen("],[", "]],[[", 1);
    for invalid in [
        "{}\n",
        "[[[[\n",
        "{\"pose_world_landmarks\":[[0,0,0]]}\r\n",
        &collapsed,
    ] {
        peer.write_all(invalid.as_bytes()).unwrap();
    }
    peer.write_all(encode(&bodies[20]).as_bytes()).unwrap();
    let received = samples(&mut *source, 2);
    let expected = [&bodies[0], &bodies[20]].map(|body| Sample::Body(body.clone()));
    assert_eq!(received, expected);
    let stats = source.stats();
    assert_eq!((stats.readings, stats.losses, stats.resyncs), (2, 0, 1));
}

#[test]
fn datagrams_deliver_landmarks_and_those_too_short_or_too_long_are_skipped() {
    let bodies = taps(&[Side::Right]);
    let sender = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let address = free_address();
    let mut source = open(&uri(&format!("udp:{address}?protocol=body-landmarks"))).unwrap();
    let whole = encode(&bodies[3]);
    let too_long = format!("{}{}", " ".repeat(30_000), whole.trim_end());
    let without_line_end = encode(&bodies[18]);
    for datagram in [
        &*encode(&bodies[0]),
        &whole[..400],
        &too_long,
        without_line_end.trim_end(),
    ] {
        sender.send_to(datagram.as_bytes(), address).unwrap();
    }
    let received = samples(&mut *source, 2);
    let expected = [&bodies[0], &bodies[18]].map(|body| Sample::Body(body.clone()));
    assert_eq!(received, expected);
    assert_eq!(source.stats().skipped_bytes, 400 + too_long.len() as u64);
}
