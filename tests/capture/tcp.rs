//! HC11 packets from a TCP server, on the loopback address.

use std::io::Write;
use std::net::TcpListener;
use std::time::{Duration, Instant};

use ademan::capture::hc11::{BODY_BYTES, Framing, PACKET_BYTES, encode};
use ademan::capture::loopback::open_tcp_loopback;
use ademan::capture::{CaptureError, Hc11Format, Sample, Source, SourceEvent, SourceUri, open};

use crate::support::free_address::free_address;
use crate::support::run::accept;
use crate::support::source::next_within;

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

fn server() -> (TcpListener, SourceUri) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let uri = format!("tcp:{address}?protocol=hc11&baud=115200");
    (listener, uri.parse().expect("a source URI"))
}

/// Returns packets whose counts are all `first`, `first + 1`, ….
fn packets(first: u8, count: u8) -> Vec<u8> {
    (first..first + count)
        .flat_map(|number| encode(Framing::Double06, &[number; BODY_BYTES]))
        .collect()
}

fn next(source: &mut dyn Source) -> Result<SourceEvent, CaptureError> {
    next_within(source, TIMEOUT)
}

/// Returns the first count of the next reading.
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
fn a_connection_that_breaks_inside_a_packet_is_lost_once_and_reconnected() {
    let (listener, uri) = server();
    let mut source = open(&uri).unwrap();
    let mut peer = accept(&listener);
    let bytes = packets(10, 6);
    peer.write_all(&bytes[..2 * PACKET_BYTES + 30]).unwrap();
    assert_eq!(
        (next_count(&mut *source), next_count(&mut *source)),
        (10, 11)
    );

    drop(peer);
    let error = next(&mut *source).unwrap_err();
    assert!(error.is_recoverable(), "{error}");
    assert_eq!(source.next().unwrap(), SourceEvent::Idle);

    let mut next_peer = accept(&listener);
    next_peer
        .write_all(&bytes[2 * PACKET_BYTES + 30..])
        .unwrap();
    assert_eq!(
        (next_count(&mut *source), next_count(&mut *source)),
        (13, 14)
    );
    let stats = source.stats();
    assert_eq!((stats.losses, stats.readings), (1, 4));
    assert_eq!(stats.skipped_bytes as usize, PACKET_BYTES);
}

#[test]
fn a_silent_peer_is_lost_after_five_seconds() {
    let (listener, uri) = server();
    let mut source = open(&uri).unwrap();
    let mut peer = accept(&listener);
    peer.write_all(&packets(10, 2)).unwrap();
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
    let uri = format!("tcp:{}?protocol=hc11", free_address());
    let uri = uri.parse().expect("a source URI");
    let error = open(&uri).err().expect("the port is closed");
    assert!(matches!(error, CaptureError::Open { .. }), "{error}");
    assert!(
        error.to_string().contains("check that the server is on"),
        "{error}"
    );
}

#[test]
fn a_source_may_disconnect_from_a_loopback_and_connect_again() {
    let mut loopback = open_tcp_loopback(Hc11Format::default()).unwrap();
    loopback.writer.write_all(b"no reader").unwrap();
    for first in [10, 20] {
        let mut source = open(&loopback.uri).unwrap();
        let start = Instant::now();
        let mut received = None;
        while received.is_none() && start.elapsed() < TIMEOUT {
            // Packets are lost until the writer notices that the previous source has disconnected.
            loopback.writer.write_all(&packets(first, 3)).unwrap();
            if let SourceEvent::Reading(_) = source.next().unwrap() {
                received = Some(next_count(&mut *source));
            }
        }
        assert_eq!(received, Some(u16::from(first) + 1));
    }
}
