//! Gloves as people make them, with a rule of their own, on a pseudo-terminal: calibrated, found and typed with.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use ademan::document::Document;
use ademan::files::Load;
use ademan::hand::{Dof, Input};
use ademan::layout::Glove;
use serialport::{SerialPort, TTYPort};
use tempfile::TempDir;

use crate::support::process::{Process, lock_spawning};
use crate::support::run::TIMEOUT;
use crate::text_line::pressed_keys;
use crate::{ademan, file, run};

/// The time between two lines.
const PERIOD: Duration = Duration::from_millis(10);

/// The largest change of a bend from one line to the next: a fist takes 0.3 s.
const STEP: f64 = 0.035;

/// The bends of the five fingers, from the thumb on: 0 straight, 1 closed.
type Bends = [f64; 5];

/// A glove with one bend sensor for each finger.
#[derive(Clone)]
pub struct Build {
    /// The counts of the straight and of the closed finger. They fall if its wires are exchanged.
    ranges: [(f64, f64); 5],
    /// The largest difference of a count from the exact one.
    noise: i64,
    /// It sends a trigger, which the firmware derives from the index finger.
    has_trigger: bool,
    /// What each line ends with.
    rest: &'static str,
}

/// A glove without a calibration of its own: the wires of the middle finger are exchanged.
pub const BUILD: Build = Build {
    ranges: [
        (640.0, 2710.0),
        (600.0, 3100.0),
        (3010.0, 700.0),
        (810.0, 2950.0),
        (720.0, 2640.0),
    ],
    noise: 8,
    has_trigger: false,
    rest: "",
};

impl Build {
    /// Returns a line of a hand with these bends. A sensor answers the first part of a bend more strongly than the last.
    fn line(&self, bends: Bends, random: &mut fastrand::Rng) -> String {
        let mut line = String::new();
        let mut index = 0;
        for ((key, bend), (straight, closed)) in ('A'..).zip(bends).zip(self.ranges) {
            let answer = bend.powf(0.93);
            let exact = straight + answer * (closed - straight);
            let count = exact.round() as i64 + random.i64(-self.noise..=self.noise);
            line += &format!("{key}{count}");
            if key == 'B' {
                index = count;
            }
        }
        if self.has_trigger {
            line += &format!("P{}", (2 * (index - 2047)).max(0));
        }
        line + self.rest + "\n"
    }

    /// Returns the lines of a hand that types `hoda` with the layout `chords-bend`.
    fn chords(&self) -> String {
        let mut random = fastrand::Rng::with_seed(3);
        let straight = [0.0; 5];
        let chords: [Bends; 4] = [
            [0.0, 0.0, 1.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 0.0, 1.0, 1.0],
            [0.0, 0.0, 0.0, 1.0, 0.0],
        ];
        let mut hand = vec![straight; 60];
        for chord in chords {
            let at = |step: usize| chord.map(|finger| 0.8 * finger * step as f64 / 12.0);
            hand.extend((1..=12).chain([12; 12]).map(at));
            hand.extend((0..12).rev().chain([0; 12]).map(at));
        }
        hand.extend([straight; 60]);
        let lines = hand.iter().map(|bends| self.line(*bends, &mut random));
        lines.collect()
    }
}

/// Returns how a person bends the fingers in a pose.
fn bends(pose: &str) -> Bends {
    match pose {
        "rest" => [0.15, 0.28, 0.3, 0.32, 0.3],
        "fist" => [1.0; 5],
        "pinch" => [0.45, 0.48, 0.02, 0.03, 0.04],
        "thumb-bent" => [1.0, 0.01, 0.0, 0.0, 0.0],
        "index-bent" => [0.02, 1.0, 0.06, 0.0, 0.0],
        "middle-bent" => [0.0, 0.05, 1.0, 0.1, 0.02],
        "ring-bent" => [0.0, 0.0, 0.12, 1.0, 0.15],
        "little-bent" => [0.0, 0.0, 0.02, 0.14, 1.0],
        _ => [0.0, 0.01, 0.0, 0.01, 0.0],
    }
}

/// A person in a glove on a serial line.
pub struct Wearer {
    port: TTYPort,
    pose: Arc<Mutex<Bends>>,
    ends: Arc<AtomicBool>,
}

impl Wearer {
    pub fn start(build: Build) -> Self {
        let _lock = lock_spawning();
        let (master, port) = TTYPort::pair().expect("a pseudo-terminal");
        // Clones are closed in child processes, which would otherwise keep the line open.
        let (mut master, port) = (
            master.try_clone_native().expect("a descriptor"),
            port.try_clone_native().expect("a descriptor"),
        );
        master.set_timeout(TIMEOUT).expect("a time-out");
        let pose = Arc::new(Mutex::new(bends("flat")));
        let ends = Arc::new(AtomicBool::new(false));
        let (taken, is_ended) = (pose.clone(), ends.clone());
        thread::spawn(move || {
            let mut random = fastrand::Rng::with_seed(8);
            let mut present = [0.0; 5];
            while !is_ended.load(Ordering::Relaxed) {
                let goal = *taken.lock().expect("no panic");
                for (bend, goal) in present.iter_mut().zip(goal) {
                    *bend += (goal - *bend).clamp(-STEP, STEP);
                }
                let line = build.line(present, &mut random);
                if master.write_all(line.as_bytes()).is_err() {
                    return;
                }
                thread::sleep(PERIOD);
            }
        });
        Self { port, pose, ends }
    }

    pub fn port(&self) -> String {
        self.port.name().expect("a name")
    }

    /// Runs `ademan calibrate` in a folder, and takes the poses that it asks for. Returns the exit code, the output and the errors.
    fn calibrate(&self, folder: &TempDir, arguments: &[&str]) -> (i32, String, String) {
        let source = format!("serial:{}?protocol=lucidgloves", self.port());
        let mut command = ademan(["calibrate", "--countdown", "0.5", "--source", &source]);
        command.args(arguments).current_dir(folder.path());
        self.pose_for(command)
    }

    /// Runs a command that calibrates, and takes the poses that it asks for. Returns the exit code, the output and the errors.
    pub fn pose_for(&self, mut command: Command) -> (i32, String, String) {
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut program = Process::start(&mut command).expect("it starts");
        let stdout = program.0.stdout.take().expect("it is piped");
        let mut stderr = program.0.stderr.take().expect("it is piped");
        let mut out = String::new();
        for line in BufReader::new(stdout).lines() {
            let line = line.expect("a line");
            if let Some((_, asked)) = line.split_once(": ").filter(|_| line.starts_with("pose ")) {
                let (pose, _) = asked.split_once(':').expect("a pose");
                *self.pose.lock().expect("no panic") = bends(pose);
            }
            out += &(line + "\n");
        }
        let mut errors = String::new();
        stderr.read_to_string(&mut errors).expect("text");
        let status = program.0.wait().expect("it ends");
        println!("{out}{errors}");
        (status.code().expect("no signal"), out, errors)
    }
}

impl Drop for Wearer {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
    }
}

fn read_glove(folder: &TempDir, name: &str) -> Glove {
    let text = fs::read_to_string(folder.path().join(name)).expect("a file");
    println!("{text}");
    Glove::parse(&Document::new(name, text)).expect("a glove")
}

/// Returns the angle of a joint in degrees at a bend of all fingers.
fn degrees(glove: &Glove, build: &Build, dof: Dof, bend: f64) -> f64 {
    let quiet = Build {
        noise: 0,
        ..build.clone()
    };
    let line = quiet.line([bend; 5], &mut fastrand::Rng::with_seed(0));
    let fields = ademan::capture::protocol::lucidgloves::Fields::parse(line.as_bytes());
    let channels = fields.expect("a packet").channels(4095);
    let mut rows = glove.map.rows().iter();
    let row = rows
        .find(|row| row.dof == dof)
        .expect("the joint is measured");
    let count = f64::from(channels.counts[row.channel]);
    glove.map.radians(row, count).to_degrees()
}

/// Asserts that a glove file bends the fingers of a build as the person does, types with it, and keeps what the glove does not measure.
fn assert_usable(folder: &TempDir, name: &str, build: &Build) {
    let glove = read_glove(folder, name);
    for (dof, bent) in [
        (Dof::IndexMcpFlexion, 90.0),
        (Dof::MiddlePipFlexion, 100.0),
        (Dof::LittleDipFlexion, 70.0),
    ] {
        let [straight, closed] = [0.0, 1.0].map(|bend| degrees(&glove, build, dof, bend));
        assert!(straight.abs() < 8.0, "{dof}: {straight}");
        assert!((closed - bent).abs() < 12.0, "{dof}: {closed}");
    }
    let shipped = Glove::load("lucidgloves").expect("a glove").map;
    let elbow = |map: &ademan::estimate::ChannelMap| {
        let mut assumed = map.assumed_angles().iter();
        let elbow = assumed.find(|(dof, _)| *dof == Dof::ElbowFlexion);
        elbow.expect("it is assumed").1
    };
    assert!((elbow(&glove.map) - elbow(&shipped)).abs() < 1e-9);
    assert_eq!(glove.map.inputs().len(), Input::ALL.len());
    assert_eq!(glove.map.inputs(), shipped.inputs());

    let path = file(folder, "chords.txt", build.chords());
    let source = format!("file:{path}?protocol=lucidgloves&rate_hz=100");
    let glove = folder.path().join(name);
    let glove = glove.to_str().expect("UTF-8");
    let arguments = ["run", "--source", &source, "--layout", "chords-bend"];
    let typed = run(arguments.into_iter().chain(["--glove", glove])).done();
    assert_eq!(
        pressed_keys(&typed.out),
        ["H", "O", "D", "A"],
        "{}",
        typed.err
    );
}

#[test]
fn a_glove_that_sends_five_curls_is_calibrated_and_types_with_its_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let wearer = Wearer::start(BUILD);
    let (code, out, errors) = wearer.calibrate(&folder, &["--out", "mine"]);
    assert_eq!(code, 0, "{errors}");
    let score = out.lines().find_map(|line| line.strip_prefix("score "));
    let score = score.and_then(|line| line.strip_suffix(" of 100"));
    let score: u8 = score.expect("a score").parse().expect("a number");
    assert!(score > 60, "{score}");
    assert!(out.contains("index-mcp-abduction      not sent"), "{out}");
    assert!(
        out.contains("(middle-mcp-flexion) counts the other way"),
        "{out}"
    );
    assert!(!out.contains("dead"), "{out}");
    assert_usable(&folder, "mine.ron", &BUILD);
    // The recording knows what was not sent.
    let again = ["calibrate", "--from", "mine.mcap", "--out", "again.ron"];
    let again = ademan(again).current_dir(folder.path()).output();
    assert!(again.expect("it starts").status.success());
    let text = |name| fs::read(folder.path().join(name)).expect("a file");
    assert_eq!(text("again.ron"), text("mine.ron"));
}

#[test]
fn a_channel_that_is_sent_and_never_changes_is_dead() {
    let folder = tempfile::tempdir().expect("a folder");
    let build = Build {
        rest: "F2047G2047P0(BB)2047",
        ..BUILD
    };
    let wearer = Wearer::start(build);
    let (code, _, errors) = wearer.calibrate(&folder, &["--out", "mine"]);
    assert_eq!(code, 1, "{errors}");
    let reason = "channel 6 (index-mcp-abduction) stays at 2047 in every pose: the sensor is dead";
    assert!(errors.contains(reason), "{errors}");
    assert!(!errors.contains("channel 7"), "it was not sent: {errors}");
    assert!(!folder.path().join("mine.ron").exists());
}

#[test]
fn the_channels_of_a_glove_that_sends_five_curls_are_found() {
    let folder = tempfile::tempdir().expect("a folder");
    // It follows the index finger, and measures none.
    let build = Build {
        has_trigger: true,
        ..BUILD
    };
    let wearer = Wearer::start(build.clone());
    let (code, out, errors) = wearer.calibrate(&folder, &["--discover", "--out", "found"]);
    assert_eq!(code, 0, "{errors}");
    assert!(!out.contains("not clear"), "{out}");
    let glove = read_glove(&folder, "found.ron");
    let channels = |finger| {
        let rows = glove.map.rows().iter();
        let own = rows.filter(move |row| row.dof.finger() == Some(finger));
        own.map(|row| row.channel).collect::<Vec<_>>()
    };
    for (channel, &finger) in ademan::hand::Finger::ALL.iter().enumerate() {
        assert_eq!(channels(finger), [channel; 3], "{finger}");
    }
    assert_usable(&folder, "found.ron", &build);
}

#[test]
fn home_made_gloves_are_shown_without_a_glove() {
    for (kind, expected) in [
        ("curls", "score "),
        ("inverted", "(index-mcp-flexion) counts the other way"),
        ("narrow", "score "),
        ("noisy", "score "),
        (
            "dead",
            "(ring-mcp-flexion) stays at 2047 in every pose: the sensor is dead",
        ),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let demo = ["calibrate", "--demo", "--demo-glove", kind, "--out", "mine"];
        let ended = ademan(demo)
            .current_dir(folder.path())
            .output()
            .expect("it starts");
        let ended = crate::Ended::from(ended).done();
        println!("{kind}\n{}", ended.out);
        assert!(ended.out.contains(expected), "{kind}: {}", ended.out);
        assert_eq!(ended.out.contains("dead"), kind == "dead", "{}", ended.out);
        assert!(ended.out.contains("index-mcp-abduction      not sent"));
        let glove = read_glove(&folder, "mine.ron");
        assert_eq!(glove.map.inputs().len(), Input::ALL.len());
    }
    let folder = tempfile::tempdir().expect("a folder");
    let demo = [
        "calibrate",
        "--discover",
        "--demo",
        "--demo-glove",
        "curls",
        "--out",
        "found",
    ];
    let ended = ademan(demo)
        .current_dir(folder.path())
        .output()
        .expect("it starts");
    crate::Ended::from(ended).done();
    assert_eq!(read_glove(&folder, "found.ron").map.rows().len(), 15);
}

#[test]
fn a_glove_whose_protocol_is_not_named_is_recognised() {
    let wearer = Wearer::start(BUILD);
    let source = format!("serial:{}", wearer.port());
    let mut command = ademan(["run", "--source", &source]);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut program = Process::start(&mut command).expect("it starts");
    let stderr = program.0.stderr.take().expect("it is piped");
    let mut lines = BufReader::new(stderr).lines().map_while(Result::ok);
    let line = lines.find(|line| line.contains("no valid packet"));
    let line = line.expect("a warning");
    assert!(
        line.contains("looks like LucidGloves: add protocol=lucidgloves"),
        "{line}"
    );
}
