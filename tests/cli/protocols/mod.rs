//! Every command that reads a source knows every protocol, over every transport that carries it.

mod carrier;
mod packets;

use std::io::{BufRead, BufReader};
use std::net::UdpSocket;
use std::process::Stdio;

use ademan::capture::SourceUri;
use ademan::capture::protocol::PROTOCOLS;

use self::carrier::{Carrier, Sender};
use self::packets::{Stream, streams};
use crate::support::free_address::free_address;
use crate::support::process::Process;
use crate::{ademan, run, text};

const STAGES: [&str; 3] = ["readings", "angles", "pose"];

/// The streams that a file can hold.
fn files() -> impl Iterator<Item = Stream> {
    streams().into_iter().filter(|stream| !stream.is_datagram)
}

#[test]
fn every_protocol_has_a_stream_here_and_is_listed_by_sources() {
    let listed = run(["sources"]).done().out;
    let streams = streams();
    for protocol in PROTOCOLS {
        let is_tried = streams
            .iter()
            .any(|stream| stream.protocol() == protocol.name);
        assert!(is_tried, "{} has no stream", protocol.name);
        assert!(
            listed.contains(&format!("?protocol={} ", protocol.name)),
            "{listed}"
        );
        assert!(listed.contains(protocol.summary), "{listed}");
    }
}

#[test]
fn the_examples_of_sources_are_valid() {
    let listed = run(["sources", "--json"]).done().out;
    let rows: Vec<serde_json::Value> = serde_json::from_str(&listed).expect("JSON");
    assert!(rows.len() > PROTOCOLS.len());
    for row in rows {
        let example = row["example"].as_str().expect("an example");
        let uri = example.split('\'').nth(1).expect("a quoted source");
        let parsed = uri.parse::<SourceUri>();
        assert!(parsed.is_ok(), "{example}: {parsed:?}");
    }
}

#[test]
fn trace_prints_every_stage_of_every_protocol() {
    let folder = tempfile::tempdir().unwrap();
    for stream in files() {
        let file = Sender::start(&stream, Carrier::File, folder.path());
        for (stage, part) in STAGES.into_iter().zip(stream.traced) {
            let traced = run(["trace", stage, "--source", &file.source]).done();
            let name = &stream.format;
            assert!(
                traced.out.contains(part),
                "{name} {stage}: {}",
                traced.out.lines().next().unwrap_or_default()
            );
            for line in traced.out.lines() {
                let json: serde_json::Value = serde_json::from_str(line).expect("a line of JSON");
                assert!(json["time_us"].is_u64(), "{name} {stage}: {line}");
            }
        }
    }
}

#[test]
fn record_and_replay_keep_the_readings_of_every_protocol() {
    let folder = tempfile::tempdir().unwrap();
    for (number, stream) in files().enumerate() {
        let file = Sender::start(&stream, Carrier::File, folder.path());
        let recording = folder.path().join(format!("{number}.mcap"));
        let recording = text(&recording);
        run(["record", recording, "--source", &file.source]).done();
        let recorded = format!("recording:{recording}");
        let [read, kept] = [&file.source, &recorded]
            .map(|source| run(["trace", "readings", "--source", source]).done().out);
        assert!(read == kept, "{}", stream.format);
        let replayed = run(["replay", recording]).done();
        assert!(
            replayed.err.contains(" accepted"),
            "{}: {}",
            stream.format,
            replayed.err
        );
    }
}

#[test]
fn trace_reads_every_protocol_over_every_transport() {
    let folder = tempfile::tempdir().unwrap();
    for stream in streams() {
        for carrier in Carrier::of(&stream) {
            let mut sender = Sender::start(&stream, carrier, folder.path());
            let mut command = ademan(["trace", "readings", "--source", &sender.source]);
            command
                .stdin(Stdio::piped())
                .stdout(Stdio::piped())
                .stderr(Stdio::inherit());
            let mut program = Process::start(&mut command).expect("it starts");
            sender.feed(program.0.stdin.take().expect("it is piped"));
            let out = BufReader::new(program.0.stdout.take().expect("it is piped"));
            let mut lines = out.lines().map_while(Result::ok);
            let found = lines.find(|line| line.contains(stream.traced[0]));
            assert!(found.is_some(), "{} over {carrier:?}", stream.format);
        }
    }
}

#[test]
fn doctor_states_what_a_source_sends_and_what_it_may_do() {
    let folder = tempfile::tempdir().unwrap();
    for stream in streams() {
        let protocol = PROTOCOLS.iter().find(|it| it.name == stream.protocol());
        let summary = protocol.expect("a protocol").summary;
        for carrier in Carrier::of(&stream) {
            let sender = Sender::start(&stream, carrier, folder.path());
            let found = run(["doctor", "--source", &sender.source]).done().out;
            let line = found.lines().find(|line| line.contains(" source "));
            let line = line.expect("a line about the source");
            assert!(line.starts_with("ok ") && line.contains(summary), "{line}");
            let is_network = !matches!(carrier, Carrier::File | Carrier::Stdin);
            assert_eq!(line.contains("only a pointer"), is_network, "{line}");
            assert_eq!(
                found.contains("`--role both` lets it type"),
                is_network,
                "{found}"
            );
        }
    }
}

#[test]
fn doctor_names_a_source_that_cannot_be_opened_and_the_remedy() {
    let taken = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let taken = taken
        .local_addr()
        .map(|address| (address, taken))
        .expect("its address");
    let closed = free_address();
    for (source, reason, remedy) in [
        (
            "file:/no/such.jsonl?protocol=holistic".to_owned(),
            "No such file",
            "# check the path",
        ),
        (
            "recording:/no/such.mcap".to_owned(),
            "No such file",
            "# check the path",
        ),
        (
            format!("udp:{}?protocol=vmc", taken.0),
            "Address already in use",
            "# another program or source has this port: choose a free one",
        ),
        (
            format!("tcp:{closed}?protocol=openxr"),
            "Connection refused",
            "# check that the server is on",
        ),
    ] {
        let found = run(["doctor", "--source", &source]).exited(1);
        found.printed(&format!("{source} cannot be opened: "));
        assert!(
            found.out.contains(reason) && found.out.contains(remedy),
            "{}",
            found.out
        );
    }
}
