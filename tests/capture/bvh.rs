//! Motion capture files as a source.

use std::fs;
use std::io::Write;
use std::net::TcpListener;

use ademan::capture::{CaptureError, SourceEvent, open};

use crate::support::source::{TYPING_RATE_HZ, bvh_text, next_within};
use crate::text_line::{TIMEOUT, samples, type_with, uri};

const TEXT: &str = "Hola";

#[test]
fn a_motion_capture_file_is_typed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    fs::write(&path, bvh_text(TEXT)).unwrap();
    let uri = format!("file:{}?protocol=bvh", path.display());
    let (text, readings) = type_with(open(&uri.parse().unwrap()).unwrap());
    assert_eq!(text, TEXT);
    let frame_10 = (10.0 / TYPING_RATE_HZ * 1e6) as u64;
    assert!(
        readings[9].time.0.abs_diff(frame_10) <= 1,
        "{:?}",
        readings[9].time
    );
}

#[test]
fn a_damaged_file_gives_its_frames_and_then_the_line_of_the_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    let mut text = bvh_text(TEXT);
    text.extend_from_slice(b"1 2 3\n");
    fs::write(&path, &text).unwrap();
    let mut source = open(&uri(&format!("file:{}?protocol=bvh", path.display()))).unwrap();
    let mut frames = 0;
    let error = loop {
        match next_within(&mut *source, TIMEOUT) {
            Ok(SourceEvent::Reading(_)) => frames += 1,
            Ok(other) => panic!("{other:?} instead of an error"),
            Err(error) => break error,
        }
    };
    let lines = text.iter().filter(|&&byte| byte == b'\n').count();
    assert!(matches!(error, CaptureError::Malformed { .. }), "{error}");
    let message = error.to_string();
    assert!(
        message.contains(&format!("line {lines}: `1` follows the last of {frames}")),
        "{message}"
    );
    assert_eq!(source.next().unwrap(), SourceEvent::End);
}

#[test]
fn a_stream_over_tcp_starts_again_with_each_connection() {
    let text = bvh_text("h");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let mut source = open(&uri(&format!("tcp:{address}?protocol=bvh"))).unwrap();
    let (mut peer, _) = listener.accept().expect("the source connects");
    let motion = text.windows(7).position(|at| at == b"MOTION\n").unwrap();
    peer.write_all(&text[..motion + 4000]).unwrap();
    let first = samples(&mut *source, 3);
    drop(peer);
    loop {
        match next_within(&mut *source, TIMEOUT) {
            Ok(SourceEvent::Reading(_)) => {}
            Err(CaptureError::Lost { .. }) => break,
            other => panic!("{other:?} instead of a loss"),
        }
    }
    let server = std::thread::spawn(move || {
        let (mut next_peer, _) = listener.accept().expect("the source connects again");
        next_peer.write_all(&text).unwrap();
        next_peer
    });
    assert_eq!(samples(&mut *source, 3), first);
    drop(server.join());
}

#[test]
fn datagrams_cannot_carry_a_motion_capture_file() {
    let error = "udp:127.0.0.1:9000?protocol=bvh".parse::<ademan::capture::SourceUri>();
    let message = error.unwrap_err().to_string();
    assert!(
        message.contains("needs a stream from its start"),
        "{message}"
    );
}
