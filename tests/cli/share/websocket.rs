//! WebSockets: clients that others wrote, and pages of other sites.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::Command;

use serde_json::Value;

use super::typist;
use crate::support::python::python;

/// Reads objects with two packages, and tries to connect from a page of another site.
const CLIENT: &str = r##"
import asyncio, collections, json, sys
import websocket, websockets

request = json.dumps({"kinds": ["layout", "pose", "events", "scene"], "rate_hz": 50})

async def asynchronous(uri):
    counts = collections.Counter()
    async with websockets.connect(uri) as socket:
        await socket.send(request)
        while counts["events"] < 2 or counts["pose"] < 20:
            counts[json.loads(await socket.recv())["kind"]] += 1
        await (await socket.ping(b"still there?"))
    try:
        async with websockets.connect(uri, origin="http://example.com"):
            refused = None
    except websockets.exceptions.InvalidStatus as error:
        refused = error.response.status_code
    async with websockets.connect(uri) as socket:
        await socket.send("?")
        error = json.loads(await socket.recv())["error"]
        try:
            await socket.recv()
        except websockets.exceptions.ConnectionClosed:
            error += " closed"
    return counts, refused, error

def synchronous(uri):
    counts = collections.Counter()
    socket = websocket.create_connection(uri, suppress_origin=True, timeout=60)
    socket.send(request)
    while counts["events"] < 2 or counts["pose"] < 20:
        counts[json.loads(socket.recv())["kind"]] += 1
    socket.close()
    try:
        websocket.create_connection(uri, origin="http://example.com")
        refused = None
    except websocket.WebSocketBadStatusException as error:
        refused = error.status_code
    return counts, refused

print(json.dumps([asyncio.run(asynchronous(sys.argv[1])), synchronous(sys.argv[1])]))
"##;

#[test]
fn two_python_clients_read_a_typing_hand_and_other_pages_are_refused() {
    let packages = ["websockets==15.0.1", "websocket-client==1.9.0"];
    let python = match python("websocket-clients", "websocket, websockets", &packages) {
        Ok(python) => python,
        Err(reason) => {
            println!("SKIPPED: cannot install the packages of WebSockets: {reason}");
            return;
        }
    };
    let (_typist, address) = typist(&"hola ".repeat(100), "ws");
    let uri = format!("ws://{address}/");
    let output = Command::new(python).args(["-c", CLIENT, &uri]).output();
    let output = output.expect("it runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let read: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    println!("{read}");
    for client in 0..2 {
        let counts = &read[client][0];
        assert_eq!(counts["layout"], 1, "{counts}");
        assert!(counts["scene"].as_u64() > Some(10), "{counts}");
    }
    assert_eq!(read[0][1], 403, "a page of example.com");
    assert_eq!(
        read[1][1], 403,
        "that package sends the address as ws: origin"
    );
    let error = read[0][2].as_str().expect("a text");
    assert!(
        error.contains("not a request") && error.ends_with("closed"),
        "{error}"
    );
}

/// Sends a request to a server and returns the answer.
fn answer(address: &str, request: &str) -> String {
    let mut client = TcpStream::connect(address).expect("it listens");
    client.write_all(request.as_bytes()).expect("it reads");
    let mut answer = Vec::new();
    client.read_to_end(&mut answer).expect("an answer");
    String::from_utf8(answer).expect("UTF-8")
}

#[test]
fn only_the_pages_of_this_address_are_served_and_only_to_it() {
    let (_typist, address) = typist(&"hola ".repeat(100), "web");
    let get = |path: &str, headers: &str| {
        let request = format!("GET {path} HTTP/1.1\r\n{headers}\r\n");
        answer(&address, &request)
    };
    let port = address.rsplit(':').next().expect("a port");
    let own = format!("Host: {address}\r\n");
    for host in [&own, &format!("Host: localhost:{port}\r\n")] {
        let page = get("/", host);
        assert!(page.starts_with("HTTP/1.1 200 OK\r\n"), "{page}");
        assert!(page.contains("Content-Security-Policy: default-src 'none'"));
        assert!(page.contains("frame-ancestors 'none'"));
        assert!(!page.contains("Access-Control-Allow-Origin"));
    }
    for (path, headers, status) in [
        ("/viewer.js", own.as_str(), "200 OK"),
        ("/viewer.css", &own, "200 OK"),
        ("/../Cargo.toml", &own, "404 Not Found"),
        ("/ws", &own, "426 Upgrade Required"),
        ("http://example.com/ws", &own, "403 Forbidden"),
        (&format!("http://{address}/"), &own, "403 Forbidden"),
        ("//example.com/ws", &own, "403 Forbidden"),
        ("*", &own, "403 Forbidden"),
        (&address, &own, "403 Forbidden"),
        ("/", "", "403 Forbidden"),
        ("/", "Host: example.com\r\n", "403 Forbidden"),
        (
            "/",
            &format!("Host: example.com:{port}\r\n"),
            "403 Forbidden",
        ),
        ("/", &format!("{own}{own}"), "403 Forbidden"),
        (
            "/ws",
            &format!("{own}Origin: http://example.com\r\n"),
            "403 Forbidden",
        ),
        ("/ws", &format!("{own}Origin: null\r\n"), "403 Forbidden"),
        (
            "/",
            &format!("{own}X: {}\r\n", "x".repeat(9000)),
            "431 Request",
        ),
    ] {
        let answer = get(path, headers);
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status}")),
            "{path} {headers}: {answer}"
        );
    }
    let post = answer(&address, &format!("POST / HTTP/1.1\r\n{own}\r\n"));
    assert!(post.starts_with("HTTP/1.1 400 "), "{post}");
}
