use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpStream, UdpSocket};
use std::time::{Duration, Instant};

use super::*;
use crate::files::Load;
use crate::output::tests::wait_until;
use ademan_core::estimate::JointAngles;
use ademan_core::hand::{Dof, FingerSet, Joint};
use ademan_core::kinematics::HandPose;
use ademan_core::pipeline::PipelineState;
use ademan_core::snapshot::Snapshot;
use parry3d::math::Pose;

const TIMEOUT: Duration = Duration::from_secs(60);

fn hub(targets: &[&str]) -> ShareHub {
    let targets: Vec<_> = targets.iter().map(|it| it.parse().unwrap()).collect();
    ShareHub::start(&targets, Side::Right, layout()).unwrap()
}

fn layout() -> Arc<Layout> {
    Arc::new(Layout::load("numpad").unwrap())
}

/// Returns a step of a hand whose wrist is at the origin.
fn step(time: u64) -> SharedStep {
    let mut pose = HandPose::new(Timestamp(time), Side::Right, 0.008);
    pose.set(Joint::Wrist, Pose::IDENTITY);
    let snapshot = Snapshot {
        state: PipelineState::Running,
        angles: Some(JointAngles::default()),
        pose: Some(pose),
        ..Snapshot::default()
    };
    SharedStep {
        snapshot,
        layout: None,
        scene: SceneState::default(),
        shared_at: Timestamp(time),
    }
}

impl ShareHub {
    /// Connects to the first server, as client `number`.
    fn connect(&mut self, number: usize) -> TcpStream {
        let stream = TcpStream::connect(self.targets[0].address).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        self.wait_for(number);
        stream
    }

    /// Shares steps until there are `clients`.
    fn wait_for(&mut self, clients: usize) {
        let start = Instant::now();
        while self.clients.load(Ordering::Relaxed) != clients {
            assert!(start.elapsed() < TIMEOUT, "not {clients} clients");
            self.send(step(1));
            thread::sleep(Duration::from_millis(1));
        }
    }
}

#[test]
fn a_client_that_reads_nothing_is_disconnected_and_the_others_are_served() {
    let mut hub = hub(&["text-line:127.0.0.1:0"]);
    let _silent = hub.connect(1);
    let reader = hub.connect(2);
    let lines = thread::spawn(move || {
        let lines = BufReader::new(reader).lines().map_while(Result::ok);
        lines
            .map(|line| line.split_ascii_whitespace().count())
            .collect::<Vec<_>>()
    });
    hub.wait_for(1);
    drop(hub);
    let lines = lines.join().unwrap();
    assert!(lines.len() > 100, "{} lines", lines.len());
    assert!(lines.iter().all(|&values| values == 64));
}

#[test]
fn a_client_that_sends_is_disconnected() {
    let mut hub = hub(&["pose:127.0.0.1:0"]);
    let mut browser = hub.connect(1);
    browser.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
    hub.wait_for(0);
    let mut rest = Vec::new();
    // The connection may be reset instead of closed, as not all that was sent was read.
    let _ = browser.read_to_end(&mut rest);
    assert!(rest.iter().all(|byte| *byte != b'<'));
}

/// Shares steps until the client receives something.
fn wait_for_lines(hub: &ShareHub, client: &mut TcpStream) {
    let interval = Some(Duration::from_millis(10));
    client.set_read_timeout(interval).unwrap();
    let start = Instant::now();
    let is_served = std::iter::repeat_with(|| {
        hub.send(step(1));
        client.read(&mut [0; 1024])
    });
    let served = is_served.take_while(|_| start.elapsed() < TIMEOUT);
    let first = served.flatten().next();
    assert!(first.is_some_and(|count| count > 0), "{first:?}");
}

#[test]
fn a_client_that_closes_its_connection_has_gone_also_without_a_step() {
    for format in ["json", "pose"] {
        let mut hub = hub(&[&format!("{format}:127.0.0.1:0")]);
        let clients: Vec<_> = (1..=128).map(|number| hub.connect(number)).collect();
        drop(clients);
        wait_until(format, || hub.clients.load(Ordering::Relaxed) == 0);
    }
}

#[test]
fn the_client_that_has_been_silent_for_the_longest_time_makes_room_for_another() {
    let mut hub = hub(&["json:127.0.0.1:0"]);
    let request = b"{\"kinds\":[\"pose\"]}\n";
    let mut served = hub.connect(1);
    served.write_all(request).unwrap();
    wait_for_lines(&hub, &mut served);
    let mut silent: Vec<_> = (2..=128).map(|number| hub.connect(number)).collect();
    let mut others: Vec<_> = (0..2)
        .map(|_| TcpStream::connect(hub.targets[0].address).unwrap())
        .collect();
    for index in [0, 1] {
        assert_eq!(silent[index].read(&mut [0]).unwrap(), 0, "{index}");
    }
    silent.drain(..2);
    for client in others.iter_mut().chain(&mut silent[..2]) {
        client.write_all(request).unwrap();
        wait_for_lines(&hub, client);
    }
    wait_for_lines(&hub, &mut served);
}

#[test]
fn the_last_lines_of_a_session_reach_its_clients() {
    let mut hub = hub(&["pose:127.0.0.1:0"]);
    // Enough clients that lines wait several milliseconds for one write.
    let readers: Vec<_> = (1..=32).map(|number| hub.connect(number)).collect();
    for time in 1000..1032 {
        hub.send(step(time));
    }
    drop(hub);
    for reader in readers {
        let lines = BufReader::new(reader).lines().map_while(Result::ok);
        let last = lines.last().unwrap();
        assert!(last.starts_with(r#"{"time_us":1031,"#), "{last}");
    }
}

#[test]
fn text_lines_stop_while_the_hand_is_lost() {
    let mut hub = hub(&["text-line:127.0.0.1:0"]);
    let reader = BufReader::new(hub.connect(1));
    for number in 0..16 {
        let mut step = step(number);
        let mut angles = JointAngles::default();
        angles.set(Dof::WristFlexion, 0.001 * number as f64);
        let pose = step.snapshot.pose.as_mut().unwrap();
        match number {
            // An arm without fingers.
            0..4 => pose.untrusted = FingerSet::ALL,
            4..8 => angles.set(Dof::IndexMcpFlexion, 0.5),
            8..12 => pose.untrusted = FingerSet::ALL,
            _ => *pose = HandPose::new(pose.time, pose.side, pose.tip_radius),
        }
        step.snapshot.angles = Some(angles);
        hub.send(step);
    }
    drop(hub);
    let lines = reader.lines().map_while(Result::ok);
    let wrist = |line: String| line.split(' ').nth(4).unwrap().parse::<f64>().unwrap();
    let shown: Vec<f64> = lines.map(wrist).filter(|degrees| *degrees > 0.0).collect();
    assert_eq!(shown.len(), 7, "{shown:?}");
}

#[test]
fn the_ports_are_free_again_after_the_hub() {
    let hub = hub(&["angles:127.0.0.1:0", "pose:127.0.0.1:0"]);
    let targets = hub.targets().to_vec();
    drop(hub);
    let start = Instant::now();
    while ShareHub::start(&targets, Side::Right, layout()).is_err() {
        assert!(start.elapsed() < TIMEOUT, "a port is still in use");
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn datagrams_are_sent_without_a_client_and_an_absent_receiver_does_not_matter() {
    let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
    receiver.set_read_timeout(Some(TIMEOUT)).unwrap();
    let absent = UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = |socket: &UdpSocket| format!("vmc:{}", socket.local_addr().unwrap());
    let targets = [address(&absent), address(&receiver)];
    drop(absent);
    let hub = hub(&[&targets[0], &targets[1]]);
    let mut datagram = [0; 2048];
    for time in 0..3 {
        hub.send(step(1_000_000 * time));
        let length = receiver.recv(&mut datagram).unwrap();
        assert!(datagram[..length].starts_with(b"#bundle\0"));
    }
}
