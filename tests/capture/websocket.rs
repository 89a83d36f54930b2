//! Lines over a WebSocket, and clients that are refused.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use ademan::capture::protocol::joint_sets::{self, WEBXR};
use ademan::capture::{CaptureError, Source, SourceEvent, open};
use ademan::hand::{Joint, JointPositions, Side};
use glam::DVec3;
use tungstenite::client::IntoClientRequest;
use tungstenite::protocol::frame::Frame;
use tungstenite::protocol::frame::coding::{Data, OpCode};
use tungstenite::{Message, WebSocket};

use crate::serial::wait_for_warning;
use crate::support::free_address::free_address;
use crate::support::source::next_within;

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Opens a source at a free port.
fn source(options: &str) -> (Box<dyn Source>, SocketAddr) {
    let address = free_address();
    let uri = format!("ws:{address}?protocol=webxr{options}");
    let uri = uri.parse().expect("a source URI");
    (open(&uri).expect("the port is free"), address)
}

/// Connects with these headers.
fn connect(
    address: SocketAddr,
    headers: &[(&'static str, &str)],
) -> Result<WebSocket<TcpStream>, String> {
    let mut request = format!("ws://{address}/")
        .into_client_request()
        .expect("a valid request");
    for (name, value) in headers {
        let value = value.parse().expect("a header");
        request.headers_mut().insert(*name, value);
    }
    let stream = TcpStream::connect(address).map_err(|error| error.to_string())?;
    stream.set_read_timeout(Some(TIMEOUT)).expect("a timeout");
    let connected = tungstenite::client(request, stream);
    connected
        .map(|(socket, _)| socket)
        .map_err(|error| error.to_string())
}

fn line(x: f64) -> String {
    let mut hand = JointPositions::default();
    hand.set(Joint::Wrist, DVec3::new(x, 1.0, 0.0));
    joint_sets::encode(&WEBXR, None, &[(Side::Right, hand)])
}

fn next_wrist(source: &mut dyn Source) -> f64 {
    match next_within(source, TIMEOUT) {
        Ok(SourceEvent::Reading(reading)) => {
            let ademan::capture::Sample::Joints { positions } = reading.sample else {
                panic!("joints");
            };
            positions.get(Joint::Wrist).expect("a wrist").x
        }
        other => panic!("no reading: {other:?}"),
    }
}

fn next_loss(source: &mut dyn Source) -> String {
    match next_within(source, TIMEOUT) {
        Err(error @ CaptureError::Lost { .. }) => error.to_string(),
        other => panic!("no loss: {other:?}"),
    }
}

/// Checks that a second client is refused and does not wait for its turn.
fn assert_refused(address: SocketAddr) {
    let error = connect(address, &[]).expect_err("one client at a time");
    assert!(!error.contains("WouldBlock"), "{error}");
}

/// Returns `true` if the server has closed the connection of a client, and not only sent nothing.
fn is_closed(client: &mut WebSocket<TcpStream>) -> bool {
    match client.read() {
        Ok(_) => false,
        Err(tungstenite::Error::Io(error)) => error.kind() != ErrorKind::WouldBlock,
        Err(_) => true,
    }
}

fn send(socket: &mut WebSocket<TcpStream>, message: impl Into<Message>) {
    socket.send(message.into()).expect("the server reads");
}

#[test]
fn messages_are_lines_and_a_client_that_leaves_is_lost_until_the_next_one() {
    let (mut source, address) = source("");
    let mut first = connect(address, &[]).expect("a program is admitted");
    send(&mut first, line(0.25));
    send(&mut first, "noise");
    send(&mut first, line(0.5).repeat(2));
    let received = [(); 3].map(|()| next_wrist(&mut *source));
    assert_eq!(received, [0.25, 0.5, 0.5]);
    assert_eq!(source.stats().invalid.total(), 1, "noise");
    first.close(None).expect("the server reads");
    drop(first);
    let loss = next_loss(&mut *source);
    assert!(loss.contains("client"), "{loss}");
    let mut second = connect(address, &[]).expect("the next client is admitted");
    send(&mut second, line(0.75));
    assert_eq!(next_wrist(&mut *source), 0.75);
}

#[test]
fn pages_of_other_sites_and_other_host_names_are_refused() {
    let (mut source, address) = source("&origin=http://localhost:8000");
    let rebound = format!("attacker.example:{}", address.port());
    for headers in [
        [("Origin", "https://attacker.example"), ("X-Other", "1")],
        [("Origin", "null"), ("X-Other", "1")],
        [
            ("Origin", "http://localhost:8000.attacker.example"),
            ("X-Other", "1"),
        ],
        [("Origin", "http://localhost:8000"), ("Host", &rebound)],
        [("X-Other", "1"), ("Host", &rebound)],
    ] {
        let error = connect(address, &headers).expect_err("refused");
        assert!(error.contains("403"), "{headers:?}: {error}");
    }
    let mut page = connect(address, &[("Origin", "http://localhost:8000")]).expect("admitted");
    send(&mut page, line(0.25));
    assert_eq!(next_wrist(&mut *source), 0.25);
}

#[test]
fn an_address_without_a_message_gives_a_warning() {
    let (mut source, address) = source("");
    let _client = connect(address, &[]).expect("a client that sends nothing");
    let warning = format!("no message has arrived at ws:{address}?protocol=webxr for 5 s");
    wait_for_warning(&mut *source, &warning);
}

#[test]
fn binary_and_endless_messages_end_the_connection() {
    let (mut source, address) = source("");
    let mut client = connect(address, &[]).expect("admitted");
    send(&mut client, line(0.25));
    assert_eq!(next_wrist(&mut *source), 0.25);
    send(&mut client, vec![1_u8, 2, 3]);
    assert!(next_loss(&mut *source).contains("binary"));
    let mut next_client = connect(address, &[]).expect("admitted");
    send(&mut next_client, line(0.5));
    assert_eq!(next_wrist(&mut *source), 0.5);
    let _ = next_client.send("x".repeat(70_000).into());
    let loss = next_loss(&mut *source);
    assert!(
        loss.to_lowercase().contains("too long") || loss.contains("capacity"),
        "{loss}"
    );
}

#[test]
fn a_second_client_and_one_that_sends_no_request_do_not_disturb_the_first() {
    let (mut source, address) = source("");
    // Sends part of a request and then nothing: it is disconnected, and the next one has its turn.
    let mut slow = TcpStream::connect(address).expect("it listens");
    slow.write_all(b"GET / HTTP/1.1\r\n").expect("it is read");
    slow.set_read_timeout(Some(TIMEOUT)).expect("a timeout");
    match slow.read(&mut [0]) {
        Ok(count) => assert_eq!(count, 0, "an answer"),
        Err(error) => assert_ne!(error.kind(), ErrorKind::WouldBlock, "still connected"),
    }
    let mut first = connect(address, &[]).expect("admitted");
    send(&mut first, line(0.25));
    assert_eq!(next_wrist(&mut *source), 0.25);
    for _ in 0..20 {
        send(&mut first, line(0.25));
        assert_eq!(next_wrist(&mut *source), 0.25);
        assert_refused(address);
    }
    send(&mut first, line(0.5));
    assert_eq!(next_wrist(&mut *source), 0.5);
}

#[test]
fn clients_that_say_nothing_keep_no_other_client_out() {
    let (mut source, address) = source("");
    // Neither those without a request nor those without a message.
    let idle: Vec<_> = (0..100).map(|_| TcpStream::connect(address)).collect();
    let silent: Vec<_> = (0..20).map(|_| connect(address, &[])).collect();
    assert!(silent.iter().all(Result::is_ok), "all may speak");
    let mut first = connect(address, &[]).expect("admitted");
    send(&mut first, line(0.25));
    assert_eq!(next_wrist(&mut *source), 0.25);
    // Now that one is active, the others are closed.
    for mut client in silent.into_iter().flatten() {
        assert!(is_closed(&mut client), "only one client is read");
    }
    send(&mut first, line(0.5));
    assert_eq!(next_wrist(&mut *source), 0.5);
    assert_refused(address);
    drop(idle);
}

#[test]
fn messages_that_are_no_packets_keep_no_other_client_out() {
    let (mut source, address) = source("");
    let mut noisy = connect(address, &[]).expect("admitted");
    send(&mut noisy, line(0.25));
    assert_eq!(next_wrist(&mut *source), 0.25);
    // It was active, and sends only noise from now on.
    let start = std::time::Instant::now();
    let mut other = loop {
        send(&mut noisy, "noise");
        let _ = source.next().expect("it is not lost");
        std::thread::sleep(Duration::from_millis(5));
        match connect(address, &[]) {
            Ok(other) => break other,
            Err(_) => assert!(start.elapsed() < TIMEOUT, "never admitted"),
        }
    };
    send(&mut other, line(0.5));
    assert_eq!(next_wrist(&mut *source), 0.5);
    assert!(is_closed(&mut noisy), "the other one takes its place");
    send(&mut other, line(0.75));
    assert_eq!(next_wrist(&mut *source), 0.75);
}

#[test]
fn a_client_that_leaves_without_a_packet_is_no_loss_of_the_hand() {
    let (mut source, address) = source("");
    let mut first = connect(address, &[]).expect("admitted");
    for _ in 0..5 {
        let mut other = connect(address, &[]).expect("admitted");
        send(&mut other, "noise");
        other.close(None).expect("the server reads");
        let _ = source.next().expect("nothing is lost");
    }
    send(&mut first, line(0.25));
    assert_eq!(next_wrist(&mut *source), 0.25);
}

/// Sends frames, after a line that makes the client the active one, and returns the reason why it is lost.
fn loss_by_flood(mut frame: impl FnMut(usize) -> Message) -> String {
    let (mut source, address) = source("");
    let mut client = connect(address, &[]).expect("admitted");
    send(&mut client, line(0.25));
    assert_eq!(next_wrist(&mut *source), 0.25);
    let sent = (0..1_000_000).take_while(|index| client.send(frame(*index)).is_ok());
    assert!(sent.count() < 1_000_000, "it is disconnected");
    next_loss(&mut *source)
}

#[test]
fn a_flood_of_frames_that_are_no_messages_ends_the_connection() {
    let pongs = loss_by_flood(|_| Message::Pong(Vec::new().into()));
    assert!(pongs.contains("2000 frames in a second"), "{pongs}");
    let fragments = loss_by_flood(|index| {
        let data = if index == 0 {
            Data::Text
        } else {
            Data::Continue
        };
        Message::Frame(Frame::message(Vec::new(), OpCode::Data(data), false))
    });
    assert!(fragments.contains("without a message"), "{fragments}");
}

#[test]
fn other_addresses_and_origins_are_refused_with_a_remedy() {
    for (uri, remedy) in [
        ("ws:[::ffff:0.0.0.0]:9001", "write `ws:127.0.0.1:PORT`"),
        ("ws:[::ffff:192.0.2.2]:9001", "write `ws:127.0.0.1:PORT`"),
        ("udp:[::ffff:0.0.0.0]:9001", "write `udp:127.0.0.1:PORT`"),
        ("udp:[::ffff:192.0.2.2]:9001", "write `udp:127.0.0.1:PORT`"),
        ("ws:0.0.0.0:9001", "write `ws:127.0.0.1:PORT`"),
        ("ws:example.org:9001", "write `ws:127.0.0.1:PORT`"),
        ("ws:127.0.0.1", "port from 1 to 65535"),
        ("ws:127.0.0.1:9001?origin=*", "without a path"),
        ("ws:127.0.0.1:9001?origin=http://a/b", "without a path"),
        ("udp:127.0.0.1:9001?origin=http://a", "option `origin`"),
    ] {
        let uri = if uri.contains('?') {
            format!("{uri}&protocol=webxr")
        } else {
            format!("{uri}?protocol=webxr")
        };
        let error = uri.parse::<ademan::capture::SourceUri>().expect_err(&uri);
        assert!(error.to_string().contains(remedy), "{uri}: {error}");
    }
    let uri = "ws:127.0.0.1:9001?protocol=webxr&origin=http://localhost:8000";
    let parsed: ademan::capture::SourceUri = uri.parse().expect("valid");
    assert_eq!(parsed.to_string(), uri);
    assert!(parsed.is_remote());
}
