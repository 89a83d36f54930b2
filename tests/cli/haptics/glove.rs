//! A simulated LucidGloves build that keeps the lines that it receives.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use ademan::hand::Finger;
use crossbeam_channel::{Receiver, Sender, unbounded};
use serialport::{SerialPort, TTYPort};

use crate::support::free_address::free_address;
use crate::support::glove::pseudo_terminal;
use crate::support::lucidgloves::{curls, legacy};
use crate::support::run::TIMEOUT;

/// Time between two lines of readings.
const PERIOD: Duration = Duration::from_millis(10);

/// The lines that a glove may be connected by.
pub const CARRIERS: [Carrier; 3] = [Carrier::Serial, Carrier::Tcp, Carrier::Udp];

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carrier {
    Serial,
    Tcp,
    Udp,
}

/// Largest change of a curl from one line to the next: a press takes 0.12 s.
const STEP: f64 = 0.025;

/// A glove that sends the present curls of its fingers 100 times a second.
pub struct Glove {
    pub source: String,
    /// The lines of feedback that it has received.
    pub feedback: Receiver<String>,
    state: Arc<State>,
    /// The end of the serial line that the program opens, which keeps the settings of the line.
    _port: Option<TTYPort>,
}

#[derive(Default)]
struct State {
    /// The curls that the fingers move to.
    curls: Mutex<[f64; Finger::COUNT]>,
    is_silent: AtomicBool,
    /// It sends lines of the legacy encoding.
    is_legacy: bool,
    /// Ends the present connection.
    hangs_up: AtomicBool,
}

impl Glove {
    /// Starts a glove that reads all that it is sent.
    pub fn start(carrier: Carrier) -> Self {
        match carrier {
            Carrier::Serial => Self::serial(true, State::default()),
            Carrier::Tcp => Self::tcp(),
            Carrier::Udp => Self::udp(),
        }
    }

    /// Starts a glove on a serial line that speaks the legacy encoding.
    pub fn start_legacy() -> Self {
        let state = State {
            is_legacy: true,
            ..State::default()
        };
        Self::serial(true, state)
    }

    /// Starts a glove on a serial line that reads nothing, with a line that is full already.
    pub fn start_deaf() -> Self {
        let mut glove = Self::serial(false, State::default());
        let port = glove._port.as_mut().expect("a serial line");
        port.set_timeout(Duration::from_millis(100))
            .expect("a time-out");
        while port.write(&[b'\n'; 64]).is_ok() {}
        glove
    }

    /// Moves a finger to a curl, as a fraction.
    pub fn curl(&self, finger: Finger, curl: f64) {
        self.state.curls.lock().expect("no panic")[finger.index()] = curl;
    }

    /// Sends no more readings.
    pub fn fall_silent(&self) {
        self.state.is_silent.store(true, Ordering::Relaxed);
    }

    /// Ends the TCP connection. The next one is accepted.
    pub fn hang_up(&self) {
        self.state.hangs_up.store(true, Ordering::Relaxed);
    }

    /// Returns the next line of feedback.
    pub fn next_feedback(&self) -> String {
        let line = self.feedback.recv_timeout(TIMEOUT);
        line.expect("the glove receives a line")
    }

    fn serial(reads: bool, state: State) -> Self {
        let (mut master, port) = pseudo_terminal();
        let (sender, feedback) = unbounded();
        let state = Arc::new(state);
        let source = format!(
            "serial:{}?protocol=lucidgloves",
            port.name().expect("a name")
        );
        if reads {
            let reader = master.try_clone_native().expect("a descriptor");
            thread::spawn(move || keep_lines(reader, &sender));
        }
        let sent = state.clone();
        thread::spawn(move || send(&sent, |line| master.write_all(line).is_ok()));
        Self {
            source,
            feedback,
            state,
            _port: Some(port),
        }
    }

    fn tcp() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = listener.local_addr().expect("its address");
        let (sender, feedback) = unbounded();
        let state = Arc::new(State::default());
        let sent = state.clone();
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                serve(&sent, stream, &sender);
            }
        });
        Self::networked(format!("tcp:{address}"), feedback, state)
    }

    fn udp() -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        let program = free_address();
        let (sender, feedback) = unbounded();
        let state = Arc::new(State::default());
        let receiver = socket.try_clone().expect("a descriptor");
        thread::spawn(move || {
            let mut datagram = [0; 200];
            while let Ok(length) = receiver.recv(&mut datagram) {
                for line in String::from_utf8_lossy(&datagram[..length]).lines() {
                    let _ = sender.send(line.to_owned());
                }
            }
        });
        let sent = state.clone();
        // The program may not listen yet.
        let send_line =
            move |line: &[u8]| socket.send_to(line, program).is_ok() || !line.is_empty();
        thread::spawn(move || send(&sent, send_line));
        Self::networked(format!("udp:{program}"), feedback, state)
    }

    fn networked(address: String, feedback: Receiver<String>, state: Arc<State>) -> Self {
        Self {
            source: format!("{address}?protocol=lucidgloves"),
            feedback,
            state,
            _port: None,
        }
    }
}

/// Serves one connection.
fn serve(state: &State, mut stream: TcpStream, feedback: &Sender<String>) {
    let reader = stream.try_clone().expect("a descriptor");
    let feedback = feedback.clone();
    thread::spawn(move || keep_lines(reader, &feedback));
    send(state, |line| stream.write_all(line).is_ok());
    let _ = stream.shutdown(std::net::Shutdown::Both);
}

/// Sends the present curls until the connection ends.
fn send(state: &State, mut write: impl FnMut(&[u8]) -> bool) {
    let mut present = *state.curls.lock().expect("no panic");
    while !state.hangs_up.swap(false, Ordering::Relaxed) {
        let targets = *state.curls.lock().expect("no panic");
        for (curl, target) in present.iter_mut().zip(targets) {
            *curl += (target - *curl).clamp(-STEP, STEP);
        }
        let fields = curls(present);
        let line = if state.is_legacy {
            legacy(&fields)
        } else {
            fields.encode()
        };
        if !state.is_silent.load(Ordering::Relaxed) && !write(line.as_bytes()) {
            return;
        }
        thread::sleep(PERIOD);
    }
}

fn keep_lines(mut stream: impl Read, lines: &Sender<String>) {
    let mut line = Vec::new();
    let mut byte = [0];
    while matches!(stream.read(&mut byte), Ok(1)) {
        match byte[0] {
            b'\n' => {
                let text = String::from_utf8_lossy(&line).trim().to_owned();
                let _ = lines.send(text);
                line.clear();
            }
            byte => line.push(byte),
        }
    }
}
