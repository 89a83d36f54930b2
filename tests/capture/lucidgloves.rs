//! LucidGloves over every transport.

use std::io::Write;
use std::net::{TcpListener, UdpSocket};
use std::time::Duration;

use ademan::capture::protocol::StreamFormat;
use ademan::capture::protocol::lucidgloves::{FULL_SCALE, Fields, PROTOCOL};
use ademan::capture::{Sample, SourceEvent, open, open_loopback};

use crate::serial::log;
use crate::support::free_address::free_address;
use crate::support::lucidgloves::chords;
use crate::support::run::accept;
use crate::support::source::next_within;
use crate::text_line::{samples, uri};

/// Returns lines of a moving hand and their samples.
fn lines() -> (Vec<String>, Vec<Sample>) {
    let fields = &chords()[50..60];
    let sample = |line: &Fields| Sample::Channels(line.channels(FULL_SCALE));
    (
        fields.iter().map(Fields::encode).collect(),
        fields.iter().map(sample).collect(),
    )
}

#[test]
fn a_serial_glove_is_read_past_its_boot_messages() {
    let (lines, expected) = lines();
    let mut loopback = open_loopback(StreamFormat::new(&PROTOCOL)).expect("a pseudo-terminal");
    let mut source = open(&loopback.uri).expect("it opens");
    let stream = format!(
        "rst:0x1 (POWERON_RESET),boot:0x13\r\n{}",
        lines.concat().replace('\n', "\r\n")
    );
    for piece in stream.as_bytes().chunks(11) {
        loopback.writer.write_all(piece).expect("there is room");
    }
    assert_eq!(samples(&mut *source, expected.len()), expected);
}

#[test]
fn a_legacy_line_that_began_before_its_serial_port_was_opened_is_dropped() {
    let mut loopback = open_loopback(StreamFormat::new(&PROTOCOL)).expect("a pseudo-terminal");
    let mut source = open(&loopback.uri).expect("it opens");
    let rest = "&1000&1000&1000&1000&2047&2047&0&0&0&0&0&0";
    // The digits `10` were lost.
    let stream = format!("95{rest}\n1095{rest}\n");
    loopback.writer.write_all(stream.as_bytes()).unwrap();
    let whole = Fields::parse(format!("1095{rest}").as_bytes()).expect("a packet");
    let expected = Sample::Channels(whole.channels(FULL_SCALE));
    assert_eq!(samples(&mut *source, 1), [expected]);
}

#[test]
fn a_legacy_line_that_began_before_the_connection_to_a_tcp_bridge_is_dropped() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let mut source = open(&uri(&format!("tcp:{address}?protocol=lucidgloves"))).unwrap();
    let rest = "&1000&1000&1000&1000&2047&2047&0&0&0&0&0&0";
    let whole = Fields::parse(format!("1095{rest}").as_bytes()).expect("a packet");
    let expected = Sample::Channels(whole.channels(FULL_SCALE));
    // Also after the connection was lost and opened again.
    for _ in 0..2 {
        let mut peer = accept(&listener);
        let stream = format!("95{rest}\n1095{rest}\n");
        peer.write_all(stream.as_bytes()).unwrap();
        assert_eq!(samples(&mut *source, 1), std::slice::from_ref(&expected));
        drop(peer);
        let lost = next_within(&mut *source, Duration::from_secs(60)).unwrap_err();
        assert!(lost.is_recoverable(), "{lost}");
    }
}

#[test]
fn a_tcp_bridge_of_a_wireless_glove_sends_blank_lines() {
    let (lines, expected) = lines();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let mut source = open(&uri(&format!("tcp:{address}?protocol=lucidgloves"))).unwrap();
    let (mut peer, _) = listener.accept().expect("the source connects");
    peer.write_all(lines.join("\r\n").as_bytes()).unwrap();
    assert_eq!(samples(&mut *source, expected.len()), expected);
    let stats = source.stats();
    assert_eq!((stats.resyncs, stats.losses), (0, 0));
}

#[test]
fn datagrams_of_a_glove_are_whole_packets_and_cut_ones_are_dropped() {
    let (lines, expected) = lines();
    let sender = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let address = free_address();
    let mut source = open(&uri(&format!("udp:{address}?protocol=lucidgloves"))).unwrap();
    let (start, end) = lines[0].split_at(1);
    for datagram in [start, end, "", "A1B"] {
        sender.send_to(datagram.as_bytes(), address).unwrap();
    }
    for line in &lines {
        sender.send_to(line.trim_end().as_bytes(), address).unwrap();
    }
    assert_eq!(samples(&mut *source, expected.len()), expected);
    assert_eq!(source.stats().skipped_bytes, lines[0].len() as u64 + 3);
}

#[test]
fn counts_of_ten_bits_that_are_read_as_twelve_bits_give_one_warning() {
    log();
    let folder = tempfile::tempdir().expect("a folder");
    let warnings = |name: &str, divisor: i64, option: &str| {
        let lines = chords().into_iter().map(|mut fields| {
            fields.curls = fields.curls.map(|curl| curl.map(|count| count / divisor));
            fields.encode()
        });
        let path = folder.path().join(name);
        std::fs::write(&path, lines.collect::<String>().repeat(6)).expect("space");
        let address = format!("file:{}?protocol=lucidgloves{option}", path.display());
        let mut source = open(&uri(&address)).expect("it opens");
        while source.next().expect("lines") != SourceEvent::End {}
        assert!(source.stats().readings > 1000);
        let text = String::from_utf8_lossy(&log().lock().unwrap()).into_owned();
        let is_warning = |line: &&str| line.contains(&address) && line.contains("`max=1023`");
        text.lines().filter(is_warning).count()
    };
    assert_eq!(warnings("ten-bits", 4, ""), 1);
    assert_eq!(warnings("ten-bits-stated", 4, "&max=1023"), 0);
    assert_eq!(warnings("twelve-bits-stated", 4, "&max=4095"), 0);
    assert_eq!(warnings("twelve-bits", 1, ""), 0);
}
