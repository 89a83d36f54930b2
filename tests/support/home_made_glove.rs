//! A glove as people make them, with a rule of its own, on a pseudo-terminal.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use serialport::{SerialPort, TTYPort};

use super::glove::pseudo_terminal;
use super::process::Process;

/// The time between two lines.
const PERIOD: Duration = Duration::from_millis(10);

/// The largest change of a bend from one line to the next: a fist takes 0.3 s.
const STEP: f64 = 0.035;

/// The bends of the five fingers, from the thumb on: 0 straight, 1 closed.
pub type Bends = [f64; 5];

/// A glove with one bend sensor for each finger.
#[derive(Clone)]
pub struct Build {
    /// The counts of the straight and of the closed finger. They fall if its wires are exchanged.
    pub ranges: [(f64, f64); 5],
    /// The finger of the sensor at each key, from the key `A` on.
    pub order: [usize; 5],
    /// The largest difference of a count from the exact one.
    pub noise: i64,
    /// It sends a trigger, which the firmware derives from the index finger.
    pub has_trigger: bool,
    /// The end of each line.
    pub rest: &'static str,
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
    order: [0, 1, 2, 3, 4],
    noise: 8,
    has_trigger: false,
    rest: "",
};

impl Build {
    /// Returns a line of a hand with these bends. A sensor answers the first part of a bend more strongly than the last.
    pub fn line(&self, bends: Bends, random: &mut fastrand::Rng) -> String {
        let mut line = String::new();
        let mut index = 0;
        let bends = self.order.map(|finger| bends[finger]);
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
    pub fn chords(&self) -> String {
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

/// Returns how a person bends the fingers in a pose. Ring and little finger hardly bend without each other.
pub fn bends(pose: &str) -> Bends {
    match pose {
        "rest" => [0.15, 0.28, 0.3, 0.32, 0.3],
        "fist" => [1.0; 5],
        "pinch" => [0.45, 0.48, 0.02, 0.03, 0.04],
        "thumb-bent" => [1.0, 0.01, 0.0, 0.0, 0.0],
        "index-bent" => [0.02, 1.0, 0.06, 0.0, 0.0],
        "middle-bent" => [0.0, 0.15, 1.0, 0.4, 0.1],
        "ring-bent" => [0.0, 0.0, 0.35, 1.0, 0.7],
        "little-bent" => [0.0, 0.0, 0.15, 0.75, 1.0],
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
        let (mut master, port) = pseudo_terminal();
        let pose = Arc::new(Mutex::new(bends("flat")));
        let ends = Arc::new(AtomicBool::new(false));
        let (taken, is_ended) = (pose.clone(), ends.clone());
        thread::spawn(move || {
            let mut random = fastrand::Rng::with_seed(8);
            let mut present = [0.0; 5];
            while !is_ended.load(Ordering::Relaxed) {
                let goal = *taken.lock().expect("no panic");
                for (bend, target) in present.iter_mut().zip(goal) {
                    *bend += (target - *bend).clamp(-STEP, STEP);
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

    /// Bends the fingers to these bends and keeps them there.
    pub fn bend(&self, bends: Bends) {
        *self.pose.lock().expect("no panic") = bends;
    }

    /// Runs a command that calibrates, and takes the poses that it asks for.
    pub fn pose_for(&self, mut command: Command) -> Output {
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut program = Process::start(&mut command).expect("it starts");
        let stdout = program.0.stdout.take().expect("it is piped");
        let mut stderr = program.0.stderr.take().expect("it is piped");
        let mut out = String::new();
        for line in BufReader::new(stdout).lines() {
            let line = line.expect("a line");
            if let Some((_, asked)) = line.split_once(": ").filter(|_| line.starts_with("pose ")) {
                let (pose, _) = asked.split_once(':').expect("a pose");
                self.bend(bends(pose));
            }
            out += &(line + "\n");
        }
        let mut errors = String::new();
        stderr.read_to_string(&mut errors).expect("text");
        println!("{out}{errors}");
        Output {
            status: program.0.wait().expect("it ends"),
            stdout: out.into_bytes(),
            stderr: errors.into_bytes(),
        }
    }
}

impl Drop for Wearer {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
    }
}
