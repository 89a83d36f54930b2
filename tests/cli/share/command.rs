//! `ademan share`: a hand for other programs, and nothing typed.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::Stdio;

use crate::support::process::{Process, signal};
use crate::{ademan, run};

#[test]
fn without_a_source_a_simulated_hand_is_shared_until_an_interrupt_and_nothing_is_typed() {
    let mut command = ademan(["share", "json:127.0.0.1:0", "web:127.0.0.1:0"]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut process = Process::start(&mut command).expect("the program starts");
    let stderr = BufReader::new(process.0.stderr.take().expect("it is piped"));
    let mut messages = stderr.lines().map_while(Result::ok);
    let first = messages.next().expect("a message");
    assert!(first.contains("a simulated hand types"), "{first}");
    let mut address_of = |format: &str| {
        let start = format!("sharing {format}:");
        messages.find_map(|line| {
            let (address, _) = line.strip_prefix(&start)?.split_once(": ")?;
            Some(address.to_owned())
        })
    };
    let json = address_of("json").expect("a message about the lines");
    let page = address_of("web").expect("a message about the page");

    let mut client = TcpStream::connect(json).expect("it listens");
    client
        .write_all(b"{\"kinds\":[\"pose\",\"events\"]}\n")
        .expect("it reads");
    let mut lines = BufReader::new(client).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.contains("\"pose\"")));
    assert!(lines.any(|line| line.contains("\"key-down\"")));

    let mut browser = TcpStream::connect(&page).expect("it listens");
    let request = format!("GET / HTTP/1.1\r\nHost: {page}\r\n\r\n");
    browser.write_all(request.as_bytes()).expect("it reads");
    let mut answer = String::new();
    browser.read_to_string(&mut answer).expect("UTF-8");
    assert!(answer.starts_with("HTTP/1.1 200 OK"), "{answer}");

    signal("INT", process.0.id());
    assert!(process.0.wait().expect("a child process").success());
    let mut transcript = String::new();
    let mut stdout = process.0.stdout.take().expect("it is piped");
    stdout.read_to_string(&mut transcript).expect("UTF-8");
    assert_eq!(transcript, "");
}

#[test]
fn pages_and_plain_lines_are_refused_beyond_this_machine_with_a_remedy() {
    for (target, remedy) in [
        ("json:192.0.2.2:1", "add `+tls`"),
        ("ws:192.0.2.2:1", "ssh -L"),
        ("web:192.0.2.2:8080", "ssh -L"),
        ("ws+tls:192.0.2.2:1", "ssh -L"),
        ("web+tls:192.0.2.2:1", "ssh -L"),
    ] {
        let refused = run(["share", target]);
        assert_eq!(refused.code, Some(2), "{target}: {}", refused.err);
        assert!(refused.err.contains(remedy), "{target}: {}", refused.err);
    }
}

#[test]
fn two_servers_at_one_port_are_refused_by_their_names() {
    let refused = run(["share", "json:127.0.0.1:8091", "web:127.0.0.1:8091"]).exited(2);
    refused.reported("`json:127.0.0.1:8091` and `web:127.0.0.1:8091` listen on the same port");
}
