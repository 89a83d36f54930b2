//! Objects as lines of JSON, of the kinds that a client asks for.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;

use serde_json::Value;

use super::{share_source, typist};

/// Sends a request and returns the lines that follow, as JSON.
fn ask(address: &str, request: &str) -> impl Iterator<Item = Value> + use<> {
    let mut client = TcpStream::connect(address).expect("it listens");
    client.write_all(request.as_bytes()).expect("it reads");
    let lines = BufReader::new(client).lines().map_while(Result::ok);
    lines.map(|line| serde_json::from_str(&line).expect("JSON"))
}

#[test]
fn a_client_gets_the_kinds_that_it_asks_for_at_its_rate() {
    // Both clients of a slow machine are connected before the first key.
    let taps = "; tap H; tap O; tap L; tap A".repeat(2);
    let source = format!("script:wait 5000{taps}");
    let (_hand, address) = share_source(&source, "json:127.0.0.1:0");
    let all = r#"["readings","angles","pose","touches","events","commands","layout","scene"]"#;
    let request = |kinds: &str, rate: &str| format!("{{\"kinds\":{kinds}{rate}}}\n");
    let slow = ask(
        &address,
        &request(r#"["pose","events"]"#, r#","rate_hz":20"#),
    );
    let fast = ask(&address, &request(all, ""));
    let count = |objects: Vec<Value>| {
        let mut counts: BTreeMap<String, Vec<Value>> = BTreeMap::new();
        for object in objects {
            let kind = object["kind"].as_str().expect("a kind").to_owned();
            counts.entry(kind).or_default().push(object);
        }
        counts
    };
    let slow = std::thread::spawn(|| slow.collect());
    let (fast, slow) = (count(fast.collect()), count(slow.join().expect("lines")));
    let kinds: Vec<_> = slow.keys().map(String::as_str).collect();
    assert_eq!(kinds, ["events", "pose"]);
    assert_eq!(slow["events"], fast["events"]);
    let time = |object: &Value| object["time_us"].as_u64().expect("a time");
    let times: Vec<u64> = slow["pose"].iter().map(time).collect();
    let seconds = (times[times.len() - 1] - times[0]) as f64 * 1e-6;
    let rate = (times.len() - 1) as f64 / seconds;
    println!("{rate:.1} poses per second of {seconds:.1} s");
    assert!(rate < 20.5, "{rate}");
    for kind in [
        "readings", "angles", "pose", "touches", "events", "layout", "scene",
    ] {
        assert!(fast.contains_key(kind), "{kind}");
    }
    assert!(fast["pose"].len() > 3 * slow["pose"].len());
    assert_eq!(fast["angles"][0]["side"], "right");
    assert_eq!(fast["layout"].len(), 1);
    let targets = fast["layout"][0]["boards"][0]["targets"].as_array();
    assert!(targets.expect("targets").len() > 20);
    let down = |scene: &Value| !scene["keys"].as_array().expect("keys").is_empty();
    assert!(fast["scene"].iter().any(down), "a key is down");
    let last = fast["scene"].last().expect("a scene");
    assert!(!down(last), "{last}");
}

#[test]
fn a_request_that_is_wrong_too_long_or_one_too_many_ends_the_connection_with_the_reason() {
    let (_typist, address) = typist(&"hola ".repeat(100), "json");
    let good = "{\"kinds\":[\"commands\"]}\n";
    for (request, reason) in [
        (
            "GET / HTTP/1.1\r\nHost: a\r\n\r\n".to_owned(),
            "not a request",
        ),
        (
            "{\"kinds\":[\"poses\"]}\n".to_owned(),
            "did you mean `pose`?",
        ),
        ("{\"kinds\":[],\"rate\":1}\n".to_owned(), "unknown field"),
        (
            "{\"kinds\":[],\"rate_hz\":0}\n".to_owned(),
            "rate_hz is 0.1 to",
        ),
        (
            "{\"kinds\":[],\"rate_hz\":1e999}\n".to_owned(),
            "not a request",
        ),
        ("[".repeat(3000) + "\n", "not a request"),
        ("x".repeat(5000), "at most 4096 bytes"),
        ("x".repeat(5000) + "\n", "at most 4096 bytes"),
        (good.repeat(11), "more than 10 requests"),
    ] {
        let objects: Vec<Value> = ask(&address, &request).collect();
        let [object] = &objects[..] else {
            panic!("{request}: {objects:?}");
        };
        assert_eq!(object["kind"], "error");
        let error = object["error"].as_str().expect("a text");
        assert!(error.contains(reason), "{request}: {error}");
    }
    let objects = ask(
        &address,
        "{\"kinds\":[\"pose\"]}\n{\"kinds\":[\"scene\"]}\n",
    );
    let scene = objects.take(20).last().expect("an object");
    assert_eq!(scene["kind"], "scene", "the last request counts");
}
