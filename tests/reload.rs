//! The real binary, while its layout file is saved.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::hc11::{BODY_BYTES, Framing, encode};
use ademan::capture::{LineSettings, Reading, Sample, hc11};
use ademan::contact::Phase;
use ademan::device::Events;
use ademan::layout::Layout;
use ademan::settings::Setup;
use ademan::time::Timestamp;
use crossbeam_channel::{Receiver, unbounded};
use tempfile::TempDir;

/// How long anything on a busy machine may take before the test gives up.
const PATIENCE: Duration = Duration::from_secs(30);

/// How long the hand takes to be seen in another posture.
const MOVE: Duration = Duration::from_millis(500);

type Posture = [u8; BODY_BYTES];

/// The glove with the index finger over the H key, and with the key pushed in.
fn postures() -> (Posture, Posture) {
    let assembly = Setup::default().assemble().expect("the default setup");
    let typist = assembly.typist("h", &LineSettings::default(), 0.0, 0);
    let mut typist = typist.expect("h can be typed");
    let mut pipeline = assembly.pipeline();
    let mut over = None;
    for frame in 1.. {
        let counts = typist.next_counts().expect("the key goes down");
        let posture = std::array::from_fn(|channel| counts[channel] as u8);
        over.get_or_insert(posture);
        let reading = Reading {
            time: Timestamp(5_729 * frame),
            side: None,
            sample: Sample::Channels(hc11::channels(&posture)),
        };
        let frame = pipeline.step(&reading, &mut Events::new());
        let touches = &frame.expect("an able hand").touches;
        if touches
            .iter()
            .any(|touch| touch.phase == Phase::Held && touch.depth == 1.0)
        {
            return (over.expect("it began over the key"), posture);
        }
    }
    unreachable!("the loop has no end of its own");
}

/// `ademan run` with a layout file of its own, and somebody who wears the glove.
struct Run {
    program: Child,
    posture: Arc<Mutex<Posture>>,
    over: Posture,
    down: Posture,
    typed: Receiver<String>,
    told: Receiver<String>,
    folder: TempDir,
}

impl Run {
    /// On the layout `qwerty-flat`, with the key H held.
    fn with_held_key(arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("my.ron"), shipped("qwerty-flat")).expect("a file");
        // A machine that holds the hand up for a moment shall not end the press.
        let setup = "Setup(layout: \"my.ron\", stall_ms: 10000)";
        std::fs::write(folder.path().join("setup.ron"), setup).expect("a file");
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let source = format!("tcp:{}", listener.local_addr().expect("an address"));
        let mut program = Command::new(env!("CARGO_BIN_EXE_ademan"))
            .args(["run", "setup.ron", "--source", &source])
            .args(arguments)
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        let (over, down) = postures();
        let posture = Arc::new(Mutex::new(over));
        let worn = posture.clone();
        thread::spawn(move || wear(&listener, &worn));
        let typed = lines(program.stdout.take().expect("it is piped"));
        let told = lines(program.stderr.take().expect("it is piped"));
        let run = Self {
            program,
            posture,
            over,
            down,
            typed,
            told,
            folder,
        };
        run.wait_until_told("armed: touches are typed, Ctrl-C ends");
        run.push_down();
        assert_eq!(run.typed(), "down H");
        run
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("my.ron")
    }

    fn save(&self, text: &str) -> Instant {
        std::fs::write(self.path(), text).expect("the file can be written");
        Instant::now()
    }

    fn push_down(&self) {
        *self.posture.lock().expect("nobody panics with it") = self.down;
    }

    fn lift(&self) {
        *self.posture.lock().expect("nobody panics with it") = self.over;
    }

    /// The next event, without its time.
    fn typed(&self) -> String {
        let line = self.typed.recv_timeout(PATIENCE);
        let line = line.expect("something is typed");
        let words: Vec<&str> = line.split_whitespace().skip(1).collect();
        words.join(" ")
    }

    fn told(&self) -> String {
        let line = self.told.recv_timeout(PATIENCE);
        line.expect("something is told")
    }

    fn wait_until_told(&self, line: &str) {
        while self.told() != line {}
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// Sends the posture at the pace of the line until nobody listens.
fn wear(listener: &TcpListener, posture: &Mutex<Posture>) {
    let (mut line, _) = listener.accept().expect("the program connects");
    loop {
        let packet = encode(Framing::Double06, &posture.lock().expect("no panic"));
        if line.write_all(&packet).is_err() {
            return;
        }
        thread::sleep(LineSettings::default().frame_period());
    }
}

fn lines(stream: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, lines) = unbounded();
    thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            let _ = sender.send(line);
        }
    });
    lines
}

fn shipped(name: &str) -> String {
    Layout::load(name).expect("a shipped layout").text
}

#[test]
fn a_saved_layout_lets_go_of_the_held_key_and_is_typed_on() {
    let run = Run::with_held_key(&[]);
    let saved = run.save(&shipped("dvorak-flat"));
    assert_eq!(run.typed(), "up H");
    let elapsed = saved.elapsed();
    println!("from the save to the release: {elapsed:?}");
    // The bound is 200 ms; a busy machine gets more.
    assert!(elapsed < Duration::from_secs(1), "{elapsed:?}");
    assert_eq!(run.told(), "my.ron: in force from now on");

    thread::sleep(MOVE);
    assert!(run.typed.is_empty(), "the finger has not left the key");
    run.lift();
    thread::sleep(MOVE);
    run.push_down();
    assert_eq!(run.typed(), "down D");
}

#[test]
fn a_broken_file_is_told_with_its_place_and_the_held_key_stays_held() {
    let run = Run::with_held_key(&[]);
    run.save("Layout(\n    nmae: \"My board\",\n)\n");
    assert_eq!(
        run.told(),
        "my.ron:2:5: unknown field `nmae`, did you mean `name`?"
    );
    assert_eq!(run.told(), " 2 |     nmae: \"My board\",");
    assert_eq!(run.told(), "   |     ^^^^");
    assert_eq!(run.told(), "the layout in force stays");
    std::fs::remove_file(run.path()).expect("the file is there");
    assert_eq!(run.told(), "my.ron: there is no such file");
    assert_eq!(run.told(), "the layout in force stays");
    assert!(run.typed.is_empty(), "the key stays held");
    run.lift();
    assert_eq!(run.typed(), "up H");

    run.save(&shipped("dvorak-flat"));
    assert_eq!(run.told(), "my.ron: in force from now on");
    thread::sleep(MOVE);
    run.push_down();
    assert_eq!(run.typed(), "down D");
}

#[test]
fn a_hundred_saves_in_a_second_end_on_the_last_one_and_no_key_is_stuck() {
    let run = Run::with_held_key(&[]);
    let (qwerty, dvorak) = (shipped("qwerty-flat"), shipped("dvorak-flat"));
    for save in 0..100 {
        run.save(&format!("// {save}\n{}", [&qwerty, &dvorak][save % 2]));
        thread::sleep(Duration::from_millis(8));
    }
    assert_eq!(run.typed(), "up H");
    // A machine that holds the test up between two saves sees more than one new layout.
    while run.told.recv_timeout(Duration::from_secs(2)).is_ok() {}
    run.lift();
    thread::sleep(MOVE);
    run.push_down();
    assert_eq!(run.typed(), "down D");
    run.lift();
    assert_eq!(run.typed(), "up D");
}

#[test]
fn a_run_that_is_recorded_keeps_its_layout_and_says_so() {
    let run = Run::with_held_key(&["--record", "hand.mcap"]);
    run.save(&shipped("dvorak-flat"));
    assert_eq!(
        run.told(),
        "my.ron: not used, as a recording is of one layout; start again to use it"
    );
    assert!(run.typed.is_empty(), "the key stays held");
    run.lift();
    assert_eq!(run.typed(), "up H");
}
