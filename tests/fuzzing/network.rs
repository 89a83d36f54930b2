//! Clients of shared hands, and messages of other machines.

use std::sync::{Arc, LazyLock};

use ademan::capture::protocol::{Decoder, PROTOCOLS, Protocol, ProtocolOptions, text_line};
use ademan::files::Load;
use ademan::hand::JointAngles;
use ademan::layout::Layout;
use ademan::share::{ShareTarget, answer};
use ademan::time::Timestamp;

/// Most bytes that a client without readings can cause: ten layouts.
const MAX_ANSWER_BYTES: usize = 1 << 19;

/// Serves a client of `json`, `ws` or `web`. The first byte is the format, the second the length of the pieces that the rest
/// arrives in. Returns `true` if the client is still connected at the end.
pub fn share_client(data: &[u8]) -> bool {
    static LAYOUT: LazyLock<Arc<Layout>> =
        LazyLock::new(|| Arc::new(Layout::load("arrows").expect("a shipped layout")));
    static TARGETS: LazyLock<[ShareTarget; 3]> = LazyLock::new(|| {
        ["json", "ws", "web"].map(|format| {
            let target = format!("{format}:127.0.0.1:8080");
            target.parse().expect("a format and an address")
        })
    });
    let [format, length, rest @ ..] = data else {
        return false;
    };
    let target = &TARGETS[usize::from(*format) % TARGETS.len()];
    let parts = rest.chunks(usize::from(*length).max(1));
    let answer = answer(target, &LAYOUT, parts);
    assert!(answer.bytes.len() < MAX_ANSWER_BYTES);
    let is_http = answer.bytes.starts_with(b"HTTP/1.1 ");
    assert!(answer.bytes.is_empty() || is_http || answer.bytes.starts_with(b"{\""));
    answer.is_connected && !answer.bytes.is_empty()
}

/// Returns beginnings of conversations: requests, the request of a page, and of a WebSocket with frames.
pub fn share_seeds() -> Vec<Vec<u8>> {
    let requests: &[u8] =
        b"{\"kinds\":[\"layout\",\"pose\"],\"rate_hz\":60}\n{\"kinds\":[\"layout\",\"events\"]}\n";
    let page: &[u8] = b"GET / HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nAccept: text/html\r\n\r\n";
    let socket: &[u8] =
        b"GET /ws HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nOrigin: http://127.0.0.1:8080\r\n\
        Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
        Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n\
        \x81\x8d\0\0\0\0{\"kinds\":[]} \x89\x80\0\0\0\0\x81\x94\0\0\0\0{\"kinds\":[\"layout\"]}";
    [(0, requests), (1, socket), (2, socket), (2, page)]
        .into_iter()
        .flat_map(|(format, bytes)| [7, 255].map(|length| [&[format, length], bytes].concat()))
        .collect()
}

/// Decodes messages of a router or datagrams, each of which holds whole packets. The first byte is the protocol; zero bytes
/// separate the messages. Returns `true` if there is a packet.
pub fn messages(data: &[u8]) -> bool {
    let Some((&protocol, rest)) = data.split_first() else {
        return false;
    };
    let protocol: &Protocol = PROTOCOLS[usize::from(protocol) % PROTOCOLS.len()];
    let mut decoder: Box<dyn Decoder> = (protocol.decoder)(&ProtocolOptions::default());
    let (mut packets, mut bytes) = (0, 0);
    for message in rest.split(|byte| *byte == 0) {
        decoder.push(message, &mut |_| packets += 1);
        decoder.finish(&mut |_| packets += 1);
        bytes += message.len() as u64;
        assert_eq!(
            decoder.pending_bytes(),
            0,
            "nothing waits for the next message"
        );
    }
    let stats = decoder.stats();
    assert_eq!((stats.readings, stats.bytes), (packets, bytes));
    assert!(stats.skipped_bytes <= bytes);
    packets > 0
}

/// Returns messages of the text line, with and without a time.
pub fn message_seeds() -> Vec<Vec<u8>> {
    let index = PROTOCOLS.iter().position(|it| **it == text_line::PROTOCOL);
    let mut messages = vec![index.expect("it is listed") as u8];
    for time in [None, Some(12_500), Some(25_000), Some(25_000)] {
        text_line::write(&JointAngles::default(), time.map(Timestamp), &mut messages);
        messages.push(0);
    }
    let others = super::lines::seeds()
        .into_iter()
        .chain(super::motion::marker_seeds());
    let all = (0..PROTOCOLS.len() as u8).flat_map(|protocol| {
        others
            .clone()
            .map(move |seed| [&[protocol], &seed[1..]].concat())
    });
    std::iter::once(messages).chain(all).collect()
}
