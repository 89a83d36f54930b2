//! A serial line behind a TCP converter, on the loopback address.

use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

use crate::support::source::next_within;
use ademan::capture::hc11::{BODY_BYTES, Framing, PACKET_BYTES, encode};
use ademan::capture::loopback::open_tcp_loopback;
use ademan::capture::{CaptureError, Hc11Format, Sample, Source, SourceEvent, SourceUri, open};

/// Longer than anything here takes on a busy machine.
const LIMIT: Duration = Duration::from_secs(60);

fn converter() -> (TcpListener, SourceUri) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let name = format!("tcp:{address}?protocol=hc11&baud=115200");
    (listener, name.parse().expect("the name of a source"))
}

fn accept(listener: &TcpListener) -> TcpStream {
    listener.accept().expect("the source connects").0
}

fn stream(first: u8, frames: u8) -> Vec<u8> {
    (first..first + frames)
        .flat_map(|number| encode(Framing::Double06, &[number; BODY_BYTES]))
        .collect()
}

fn next(source: &mut dyn Source) -> Result<SourceEvent, CaptureError> {
    next_within(source, LIMIT)
}

/// The first count of the next reading.
fn next_count(source: &mut dyn Source) -> u16 {
    match next(source) {
        Ok(SourceEvent::Reading(reading)) => match reading.sample {
            Sample::Channels(channels) => channels.counts[0],
            other => panic!("not channels: {other:?}"),
        },
        other => panic!("no reading: {other:?}"),
    }
}

#[test]
fn a_connection_that_drops_in_a_frame_is_lost_once_and_made_again() {
    let (listener, name) = converter();
    let mut source = open(&name).unwrap();
    let mut peer = accept(&listener);
    let bytes = stream(10, 6);
    peer.write_all(&bytes[..2 * PACKET_BYTES + 30]).unwrap();
    assert_eq!(
        (next_count(&mut *source), next_count(&mut *source)),
        (10, 11)
    );

    drop(peer);
    let error = next(&mut *source).unwrap_err();
    assert!(error.is_recoverable(), "{error}");
    assert_eq!(source.next().unwrap(), SourceEvent::Idle);

    let mut peer = accept(&listener);
    peer.write_all(&bytes[2 * PACKET_BYTES + 30..]).unwrap();
    assert_eq!(
        (next_count(&mut *source), next_count(&mut *source)),
        (13, 14)
    );
    let counts = source.stats();
    assert_eq!((counts.losses, counts.readings), (1, 4));
    assert_eq!(counts.skipped_bytes as usize, PACKET_BYTES);
}

#[test]
fn a_peer_that_falls_silent_is_given_up_after_five_seconds() {
    let (listener, name) = converter();
    let mut source = open(&name).unwrap();
    let mut peer = accept(&listener);
    peer.write_all(&stream(10, 2)).unwrap();
    assert_eq!(next_count(&mut *source), 10);
    let start = Instant::now();
    let error = next(&mut *source).unwrap_err();
    assert!(
        error.to_string().contains("nothing was received for 5 s"),
        "{error}"
    );
    assert!(
        start.elapsed() > Duration::from_secs(4),
        "{:?}",
        start.elapsed()
    );
    accept(&listener);
}

#[test]
fn a_refused_connection_cannot_be_opened() {
    let (listener, name) = converter();
    drop(listener);
    let error = open(&name).err().expect("nobody listens");
    assert!(matches!(error, CaptureError::Open { .. }), "{error}");
    assert!(
        error.to_string().contains("check that the server is on"),
        "{error}"
    );
}

#[test]
fn a_source_may_leave_a_wire_and_come_again() {
    let mut wire = open_tcp_loopback(Hc11Format::default()).unwrap();
    wire.writer.write_all(b"nobody listens").unwrap();
    for first in [10, 20] {
        let mut source = open(&wire.uri).unwrap();
        let start = Instant::now();
        let mut seen = None;
        while seen.is_none() && start.elapsed() < LIMIT {
            // What is sent before the end of the former connection is seen gets lost.
            wire.writer.write_all(&stream(first, 3)).unwrap();
            if let SourceEvent::Reading(_) = source.next().unwrap() {
                seen = Some(next_count(&mut *source));
            }
        }
        assert_eq!(seen, Some(u16::from(first) + 1));
    }
}
