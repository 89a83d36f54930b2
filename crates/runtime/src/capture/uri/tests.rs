//! Tests of parsing and formatting source URIs.

use std::num::NonZeroU32;

use super::*;
use crate::capture::hc11::{Framing, Hc11Format};

fn stream(scheme: &str, address: &str, format: impl Into<StreamFormat>) -> SourceUri {
    let mut transports = TRANSPORTS.iter();
    let transport = transports.find(|transport| transport.scheme.name == scheme);
    SourceUri::Stream(StreamUri::new(
        transport.unwrap(),
        address.to_owned(),
        format,
    ))
}

fn hc11(framing: Framing, baud: u32) -> Hc11Format {
    Hc11Format {
        framing,
        baud: NonZeroU32::new(baud).unwrap(),
    }
}

#[test]
fn a_stream_of_one_hand_shows_the_hand_of_the_setup_unless_it_states_one() {
    let shown = |protocol: &str, sides: &[Side]| {
        let uri = format!("udp:127.0.0.1:9000?protocol={protocol}");
        match uri.parse::<SourceUri>() {
            Ok(SourceUri::Stream(stream)) => stream.for_sides(sides).format.hand(),
            other => panic!("{other:?}"),
        }
    };
    let left = &[Side::Left];
    assert_eq!(shown("markers", left), Some(Side::Left));
    assert_eq!(shown("markers", &[Side::Right]), Some(Side::Right));
    assert_eq!(shown("markers&hand=right", left), Some(Side::Right));
    assert_eq!(shown("markers&hand=left", &[]), Some(Side::Left));
    assert_eq!(shown("hand-landmarks", left), Some(Side::Right));
    assert_eq!(shown("opentrack", left), None, "it has no such option");
}

#[test]
fn a_default_that_is_stated_is_written_again() {
    for text in [
        "file:glove.txt?protocol=lucidgloves&max=4095&baud=115200",
        "udp:127.0.0.1:9000?protocol=markers&hand=right",
        "udp:127.0.0.1:9000?protocol=markers",
        "tcp:glove.local:4001?protocol=hc11&baud=9600",
    ] {
        let uri: SourceUri = text.parse().unwrap();
        assert_eq!(uri.to_string(), text);
    }
}

#[test]
fn every_kind_of_source_has_a_uri() {
    let default = Hc11Format::default();
    let slow = hc11(Framing::Double06, 9600);
    let text_line = StreamFormat::new(&crate::capture::protocol::text_line::PROTOCOL);
    let text_line_at = |baud| StreamFormat {
        baud: NonZeroU32::new(baud),
        ..text_line.clone()
    };
    let mut text_line_50_hz = text_line.clone();
    let rate = text_line_50_hz.protocol.options[0];
    text_line_50_hz.options.set(rate, "50").unwrap();
    let table = [
        (
            "serial:/dev/ttyUSB0",
            stream("serial", "/dev/ttyUSB0", default),
        ),
        (
            "serial:/dev/ttyUSB0?protocol=hc11&baud=9600",
            stream("serial", "/dev/ttyUSB0", slow),
        ),
        (
            "serial:COM3?framing=hash",
            stream("serial", "COM3", hc11(Framing::Hash, 115_200)),
        ),
        (
            "serial:COM3?protocol=text-line",
            stream("serial", "COM3", text_line_at(115_200)),
        ),
        (
            "file:a b.raw?baud=1",
            stream("file", "a b.raw", hc11(Framing::Double06, 1)),
        ),
        ("file:what?", stream("file", "what?", default)),
        ("file:what?now.raw", stream("file", "what?now.raw", default)),
        (
            "file:what?a=b?protocol=hc11",
            stream("file", "what?a=b", default),
        ),
        (
            "tcp:glove.local:4001",
            stream("tcp", "glove.local:4001", default),
        ),
        (
            "tcp:[::1]:4001?baud=9600",
            stream("tcp", "[::1]:4001", slow),
        ),
        (
            "tcp:angles.local:10002?protocol=text-line",
            stream("tcp", "angles.local:10002", text_line.clone()),
        ),
        (
            "udp:127.0.0.1:9000?protocol=text-line",
            stream("udp", "127.0.0.1:9000", text_line.clone()),
        ),
        ("stdin:", stream("stdin", "", default)),
        (
            "stdin:?protocol=text-line",
            stream("stdin", "", text_line.clone()),
        ),
        (
            "recording:x?baud=2.mcap",
            SourceUri::Recording {
                path: "x?baud=2.mcap".into(),
            },
        ),
        (
            "typist:really? a=b & c: d",
            SourceUri::Typist {
                text: "really? a=b & c: d".into(),
                format: None,
            },
        ),
        (
            "typist:what?a=b",
            SourceUri::Typist {
                text: "what?a=b".into(),
                format: None,
            },
        ),
        (
            "typist:what?protocol=text-line&rate_hz=50",
            SourceUri::Typist {
                text: "what".into(),
                format: Some(text_line_50_hz),
            },
        ),
        ("file:a?protocol=hc11&", stream("file", "a", default)),
        ("file:a?&", stream("file", "a?&", default)),
        (
            "script:tap Q; wait 5",
            SourceUri::Script {
                script: "tap Q; wait 5".into(),
            },
        ),
    ];
    for (text, expected) in table {
        let uri: SourceUri = text.parse().unwrap();
        assert_eq!(uri, expected, "{text}");
        assert_eq!(uri.to_string().parse::<SourceUri>().unwrap(), uri, "{text}");
    }
}

#[test]
fn a_path_in_an_option_may_contain_the_characters_that_separate_options() {
    let text = "headset:127.0.0.1:8443?page=a%26b=1/what%3Fc=d/100%/%2526&layout=x%26y.ron";
    let uri: SourceUri = text.parse().unwrap();
    let SourceUri::Stream(stream) = &uri else {
        panic!("{uri:?}");
    };
    let pages = stream.pages.as_ref().expect("a page");
    assert_eq!(pages.folder, "a&b=1/what?c=d/100%/%26");
    assert_eq!(pages.layout.as_deref(), Some("x&y.ron"));
    assert_eq!(uri.to_string().parse::<SourceUri>().unwrap(), uri);
    let with_token = "tcp+tls:desk:8443?token_file=a%26b/desk.token";
    let secure: SourceUri = with_token.parse().unwrap();
    assert_eq!(secure.token_file(), Some("a&b/desk.token"));
    assert_eq!(secure.to_string().parse::<SourceUri>().unwrap(), secure);
}

#[test]
fn the_rate_of_a_headset_is_the_rate_of_the_source_and_not_of_a_file_of_its_lines() {
    let format = StreamFormat::new(&crate::capture::protocol::joint_sets::OPENXR);
    for (text, rate_hz) in [
        ("openxr:", None),
        // The default rate of a file.
        ("openxr:?rate_hz=30", Some(30)),
        ("openxr:?rate_hz=1000&protocol=openxr", Some(1000)),
    ] {
        let uri: SourceUri = text.parse().unwrap();
        let SourceUri::Stream(stream) = &uri else {
            panic!("{uri:?}");
        };
        assert_eq!((stream.rate_hz, &stream.format), (rate_hz, &format));
        assert!(uri.is_openxr() && !uri.is_remote(), "{text}");
        assert_eq!(uri.to_string().parse::<SourceUri>().unwrap(), uri, "{text}");
    }
}

#[test]
fn every_example_is_a_valid_uri_of_its_scheme() {
    for scheme in schemes() {
        let uri: SourceUri = scheme.example.parse().unwrap();
        let start = format!("{}:", scheme.name);
        assert!(uri.to_string().starts_with(&start), "{}", scheme.example);
        assert!(scheme.syntax.starts_with(&start), "{}", scheme.syntax);
    }
}

#[test]
fn only_sources_of_joint_angles_need_no_glove() {
    let table = [
        ("serial:COM3", true),
        ("udp:127.0.0.1:9000?protocol=text-line", false),
        ("typist:hello", true),
        ("typist:hello?protocol=hc11", true),
        ("typist:hello?protocol=vmc", false),
    ];
    for (text, needs_glove) in table {
        let uri: SourceUri = text.parse().unwrap();
        assert_eq!(uri.needs_glove(), needs_glove, "{text}");
    }
}

#[test]
fn an_invalid_uri_names_the_nearest_valid_one() {
    let table = [
        (
            "seriel:/dev/ttyUSB0",
            "unknown kind of source `seriel`, did you mean `serial`?",
        ),
        ("/dev/ttyUSB0", "write `serial:/dev/ttyUSB0`"),
        ("COM3", "write `serial:COM3`"),
        ("typst", "did you mean `typist:…`?"),
        ("serial:", "`serial:` is followed by nothing"),
        ("typist:", "`typist:` is followed by nothing"),
        (
            "typist:?protocol=vmc",
            "there is no text before the options",
        ),
        (
            "typist:hi?protocol=vcm",
            "unknown protocol `vcm`, did you mean `vmc`?",
        ),
        (
            "typist:hi?protocol=vmc&delay_ms=5",
            "unknown option `delay_ms`",
        ),
        (
            "serial:?baud=9600",
            "there is no address before the options",
        ),
        (
            "serial:COM3?bauds=9600",
            "unknown option `bauds`, did you mean `baud`?",
        ),
        ("serial:COM3?baud", "not a list of options"),
        ("serial:COM3?baud=0", "`0` is not a bit rate"),
        ("serial:COM3?baud=fast", "`fast` is not a bit rate"),
        ("serial:COM3?baud=1&baud=2", "option `baud` is given twice"),
        (
            "serial:COM3?protocol=hc12",
            "unknown protocol `hc12`, did you mean `hc11`?",
        ),
        (
            "serial:COM3?framing=double6",
            "unknown framing `double6`, did you mean `double06`?",
        ),
        (
            "serial:COM3?protocol=text-line&framing=hash",
            "unknown option `framing`",
        ),
        (
            "file:a.txt?protocol=text-line&rate_hz=0",
            "`0` is not a number of lines per second from 0.1 to 10000",
        ),
        ("udp:0.0.0.0:9000", "datagrams carry no credential"),
        ("udp:192.168.1.7:9000", "write `udp:127.0.0.1:PORT`"),
        ("tcp:glove", "write `tcp:HOST:PORT`"),
        ("tcp:glove:99999", "write `tcp:HOST:PORT`"),
        ("tcp:glove:0", "a port from 1 to 65535"),
        ("tcp::4001", "write `tcp:HOST:PORT`"),
        ("udp:9000", "write `udp:ADDRESS:PORT`"),
        (
            "ws://127.0.0.1:9001",
            "write `ws:127.0.0.1:9001` without `//`",
        ),
        ("tcp://glove:4001/", "write `tcp:glove:4001` without `//`"),
        ("udp://127.0.0.1", "write `udp:127.0.0.1` without `//`"),
        ("stdin:now", "`stdin:` has no address"),
        ("openxr:monado", "`openxr:` has no address"),
        ("openxr:?rate_hz=0", "`0` is not a rate, write 1 to 1000"),
        ("openxr:?rate_hz=9.5", "`9.5` is not a rate"),
        ("openxr:?protocol=webxr", "leave out `protocol`"),
    ];
    for (text, part) in table {
        let error = text.parse::<SourceUri>().unwrap_err();
        assert!(matches!(error, CaptureError::InvalidUri { .. }), "{text}");
        let message = error.to_string();
        assert!(message.contains(part), "{text}: {message}");
        assert!(message.contains(text), "{text}: {message}");
    }
}
