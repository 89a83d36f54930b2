//! One recording of each kind of source, in `tests/recordings`, with the transcript that it gives.
//!
//! `ADEMAN_WRITE=1 cargo test --test cli source_recordings` records them again with `ademan record`; review the transcripts.

use std::fs;
use std::path::{Path, PathBuf};

use ademan::capture::protocol::PROTOCOLS;
use ademan::capture::protocol::lucidgloves::Fields;

use crate::support::lucidgloves::{RATE_HZ, TEXT, chords, legacy};
use crate::{ademan, run, text};

/// The text of the sources that show an arm.
const TYPED: &str = "hi";

/// One of this many lines of a LucidGloves build is recorded, to keep the recording small.
const THINNING: usize = 3;

/// The protocols whose lines consist of lines of other protocols, which are recorded, and the protocols that show no hand: an
/// inertial sensor has no position.
const UNRECORDED: [&str; 2] = ["holistic", "imu"];

/// A recording, the protocol of its source with its options, and how it is made.
struct Recording {
    name: &'static str,
    protocol: &'static str,
    origin: Origin,
}

enum Origin {
    /// The simulated hand on the default layout.
    Typist,
    /// A LucidGloves build that types chords, as lines of this encoding.
    Chords(fn(&Fields) -> String),
}

const fn typist(name: &'static str, protocol: &'static str) -> Recording {
    Recording {
        name,
        protocol,
        origin: Origin::Typist,
    }
}

const fn lucidgloves(name: &'static str, encode: fn(&Fields) -> String) -> Recording {
    Recording {
        name,
        protocol: "lucidgloves",
        origin: Origin::Chords(encode),
    }
}

const RECORDINGS: [Recording; 13] = [
    typist("hc11", "hc11&baud=19200"),
    typist("hc11-hash", "hc11&framing=hash&baud=19200"),
    typist("text-line", "text-line&rate_hz=30"),
    typist("markers", "markers&rate_hz=30"),
    typist("bvh", "bvh"),
    typist("body-landmarks", "body-landmarks"),
    typist("hand-landmarks", "hand-landmarks&camera=head"),
    typist("openxr", "openxr"),
    typist("webxr", "webxr"),
    typist("opentrack", "opentrack"),
    typist("vmc", "vmc"),
    lucidgloves("lucidgloves-alpha", Fields::encode),
    lucidgloves("lucidgloves-legacy", legacy),
];

impl Recording {
    fn path(&self, extension: &str) -> PathBuf {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings");
        folder.join(format!("{}.{extension}", self.name))
    }

    /// Returns the protocol without its options.
    fn protocol_name(&self) -> &str {
        self.protocol.split('&').next().unwrap_or_default()
    }

    /// Returns the keys that type the text of the recording.
    fn keys(&self) -> Vec<String> {
        let typed = match self.origin {
            Origin::Typist => TYPED,
            Origin::Chords(_) => TEXT,
        };
        typed
            .chars()
            .map(|letter| letter.to_uppercase().collect())
            .collect()
    }

    /// Records the source in place of the file that is there.
    fn record(&self) {
        let folder = tempfile::tempdir().expect("a folder");
        let mut command = ademan(["record", "recording.mcap"]);
        // The recording names its source: a path on this machine would stand in it.
        command.current_dir(&folder);
        match self.origin {
            Origin::Typist => {
                let source = format!("typist:{TYPED}?protocol={}", self.protocol);
                command.args(["--source", &source]);
            }
            Origin::Chords(encode) => {
                let lines: String = chords().iter().step_by(THINNING).map(encode).collect();
                fs::write(folder.path().join("glove.txt"), lines).expect("room on the disk");
                let rate_hz = RATE_HZ / THINNING as f64;
                let source = format!("file:glove.txt?protocol=lucidgloves&rate_hz={rate_hz}");
                command.args(["--source", &source]);
                command.args(["--layout", "chords-bend"]);
            }
        }
        let output = command.output().expect("the program starts");
        assert!(output.status.success(), "{output:?}");
        let path = self.path("mcap");
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::copy(folder.path().join("recording.mcap"), &path).expect("room on the disk");
        fs::write(self.path("out"), self.replay()).expect("room on the disk");
    }

    /// Returns the transcript of the recording.
    fn replay(&self) -> String {
        run(["replay", text(&self.path("mcap"))]).done().out
    }
}

#[test]
fn a_recording_of_each_kind_of_source_gives_its_transcript() {
    for recording in RECORDINGS {
        let name = recording.name;
        if std::env::var_os("ADEMAN_WRITE").is_some() {
            recording.record();
        }
        let expected = fs::read_to_string(recording.path("out"));
        let expected = expected.unwrap_or_else(|error| panic!("the transcript of {name}: {error}"));
        assert_eq!(recording.replay(), expected, "{name}");
        let keys: Vec<&str> = expected
            .lines()
            .filter_map(|line| line.split_once(" down ").map(|(_, key)| key.trim()))
            .collect();
        assert_eq!(keys, recording.keys(), "{name}");
    }
}

#[test]
fn every_protocol_has_a_recording() {
    for protocol in PROTOCOLS {
        let mut recordings = RECORDINGS.iter();
        let is_recorded = recordings.any(|recording| recording.protocol_name() == protocol.name);
        assert!(
            is_recorded || UNRECORDED.contains(&protocol.name),
            "{}",
            protocol.name
        );
    }
}
