//! One text, typed on one layout through the bytes of each protocol.

use ademan::capture::protocol::PROTOCOLS;
use ademan::capture::protocol::lucidgloves::Fields;
use ademan::capture::{Source, SourceEvent, SourceUri};
use ademan::device::{EventKind, Events};
use ademan::setup::{LoadedSetup, PositionSmoothingSetup, Setup, SmoothingSetup};
use ademan::sim::{UsTextField, error_rate};
use ademan::time::Timestamp;

use crate::support::checked::CheckedPipeline;
use crate::support::lucidgloves;

const TEXT: &str = "hola mundo 42";

/// A protocol with its options, and the noise of such sensors: counts of a glove, degrees of angles, millimetres of
/// positions.
struct Row {
    protocol: &'static str,
    noise: f64,
    unit: &'static str,
}

const fn row(protocol: &'static str, noise: f64, unit: &'static str) -> Row {
    Row {
        protocol,
        noise,
        unit,
    }
}

/// Every protocol that shows the arm and the index finger.
const ROWS: [Row; 13] = [
    row("hc11", 0.5, "counts"),
    row("hc11&framing=hash", 0.5, "counts"),
    row("text-line", 0.1, "°"),
    row("vmc", 0.1, "°"),
    row("markers", 0.1, "mm"),
    row("bvh", 0.1, "mm"),
    row("openxr", 0.3, "mm"),
    row("webxr", 0.3, "mm"),
    row("hand-landmarks&camera=head&rate_hz=60", 0.5, "mm"),
    row("hand-landmarks&camera=head", 0.5, "mm"),
    row("body-landmarks&rate_hz=60", 0.5, "mm"),
    row("body-landmarks", 0.5, "mm"),
    row("opentrack", 0.3, "mm"),
];

/// A text that was typed, and the times of the presses.
#[derive(Default)]
struct Typed {
    text: String,
    presses: Vec<Timestamp>,
    readings: u32,
    first: Timestamp,
    last: Timestamp,
}

impl Typed {
    fn rate_hz(&self) -> f64 {
        f64::from(self.readings - 1) / self.last.since(self.first).as_secs_f64()
    }

    /// Returns the mean time from the presses of another hand to these, in milliseconds.
    fn lag_ms(&self, exact: &Self) -> f64 {
        let pairs = self.presses.iter().zip(&exact.presses);
        let lags =
            pairs.map(|(press, exact_press)| (press.0 as f64 - exact_press.0 as f64) / 1000.0);
        lags.sum::<f64>() / exact.presses.len() as f64
    }
}

/// Returns the setup of a source, with or without filters.
fn setup(source: &str, layout: &str, has_filters: bool) -> LoadedSetup {
    let mut setup = Setup {
        source: Some(source.parse().expect("a source")),
        layout: layout.into(),
        ..Setup::default()
    };
    if !has_filters {
        setup.smoothing = SmoothingSetup::Off;
        setup.position_smoothing = PositionSmoothingSetup::Off;
    }
    setup.load_files().expect("a valid setup")
}

/// Types the text through the setup of a protocol.
fn typed(row: &Row, noise: f64, has_filters: bool) -> Typed {
    let source = format!("typist:{TEXT}?protocol={}", row.protocol);
    let setup = setup(&source, "qwerty-flat", has_filters);
    let format = setup.setup.source.as_ref().and_then(SourceUri::format);
    let stream = setup.encoded_typist(TEXT, format.expect("a protocol"), noise, 5);
    play(&mut stream.expect("a hand that types"), &setup)
}

/// Types the chords of a LucidGloves build, which does not measure the arm.
fn typed_chords(encode: fn(&Fields) -> String, noise: i64, has_filters: bool) -> Typed {
    let mut random = fastrand::Rng::with_seed(5);
    let fields = lucidgloves::chords().into_iter();
    let fields = fields.map(|fields| lucidgloves::with_noise(fields, noise, &mut random));
    let lines: String = fields.map(|fields| encode(&fields)).collect();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("glove.txt");
    std::fs::write(&path, lines).expect("room on the disk");
    let source = format!("file:{}?protocol=lucidgloves", path.display());
    let setup = setup(&source, "chords-bend", has_filters);
    let uri = setup.setup.source.as_ref().expect("a source");
    let mut file = setup.open_source(uri).expect("a file");
    play(&mut *file, &setup)
}

fn play(source: &mut dyn Source, setup: &LoadedSetup) -> Typed {
    let mut pipeline = CheckedPipeline::new(setup);
    let (mut field, mut typed) = (UsTextField::new(), Typed::default());
    loop {
        let reading = match source.next().expect("a hand has no errors") {
            SourceEvent::Reading(reading) => reading,
            SourceEvent::Idle | SourceEvent::Command(_) => continue,
            SourceEvent::End => break,
        };
        if typed.readings == 0 {
            typed.first = reading.time;
        }
        (typed.readings, typed.last) = (typed.readings + 1, reading.time);
        let mut events = Events::new();
        let _ = pipeline.step(&reading, &mut events);
        for event in &events {
            field.handle(event);
            if matches!(event.kind, EventKind::KeyDown(_)) {
                typed.presses.push(event.time);
            }
        }
    }
    assert_eq!(source.stats().invalid.total(), 0);
    typed.text = field.text().to_owned();
    typed
}

/// Prints the row of a text that was typed with noise and filters. Returns its error rate.
fn print(name: &str, noise: &str, text: &str, typed: &Typed, exact: &Typed) -> f64 {
    assert_eq!(exact.text, text, "{name}: without noise and filters");
    let cer = error_rate(text, &typed.text);
    println!(
        "| `{name}` | {:.0} Hz | {noise} | {} | {:.1} % | {:.1} ms |",
        typed.rate_hz(),
        typed.text,
        100.0 * cer,
        typed.lag_ms(exact)
    );
    cer
}

#[test]
fn every_protocol_types_the_same_text_on_the_same_layout() {
    println!("| protocol | rate | noise | typed | CER | lag |");
    let mut failed = Vec::new();
    for row in &ROWS {
        let exact = typed(row, 0.0, false);
        let typed = typed(row, row.noise, true);
        let noise = format!("{} {}", row.noise, row.unit);
        if print(row.protocol, &noise, TEXT, &typed, &exact) > 0.0 {
            failed.push(row.protocol);
        }
    }
    for name in ["lucidgloves, alpha", "lucidgloves, legacy"] {
        let encode = match name {
            "lucidgloves, alpha" => Fields::encode,
            _ => lucidgloves::legacy,
        };
        let exact = typed_chords(encode, 0, false);
        let typed = typed_chords(encode, 16, true);
        if print(name, "16 counts", lucidgloves::TEXT, &typed, &exact) > 0.0 {
            failed.push(name);
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn the_noise_of_a_tracker_presses_no_key_twice() {
    let openxr = ROWS.iter().find(|row| row.protocol == "openxr");
    let openxr = openxr.expect("the protocol is in the table");
    for (noise, has_filters) in [(1.0, true), (1.0, false), (2.0, true), (2.0, false)] {
        let typed = typed(openxr, noise, has_filters);
        println!("{noise} mm, filters {has_filters}: {}", typed.text);
        assert!(
            typed.presses.len() <= TEXT.len(),
            "{noise} mm: {}",
            typed.text
        );
        if has_filters {
            assert_eq!(typed.text, TEXT, "{noise} mm");
        }
    }
}

#[test]
fn a_protocol_that_a_simulated_hand_does_not_speak_states_why() {
    for (source, reason) in [
        (
            "typist:h?protocol=hand-landmarks",
            "a simulated camera is worn on the head; write `camera=head`",
        ),
        (
            "typist:h?protocol=bvh&unit_mm=1000",
            "a simulated sensor only sends `unit_mm=10`",
        ),
        (
            "typist:h?protocol=lucidgloves",
            "the glove does not measure the arm, so only keys below the fingers can be pressed; choose a layout of fingers that bend, such as `chords-bend`, or play a script",
        ),
    ] {
        let setup = setup(source, "qwerty-flat", true);
        let opened = setup.open_source(setup.setup.source.as_ref().expect("a source"));
        let Err(error) = opened else {
            panic!("{source} was opened");
        };
        let message = error.to_string();
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn every_protocol_is_in_the_table() {
    for protocol in PROTOCOLS {
        let mut rows = ROWS.iter().map(|row| row.protocol.split('&').next());
        let is_listed = rows.any(|name| name == Some(protocol.name));
        assert!(
            is_listed || ["lucidgloves", "holistic", "imu"].contains(&protocol.name),
            "{}",
            protocol.name
        );
    }
}
