//! Tests of the places of clients.

use std::io::Read;
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use super::clients::{ClientSlot, Clients, MAX_CLIENTS};
use super::line_writer::LineWriter;

struct Peer(UnixStream);

impl Peer {
    fn is_connected(&mut self) -> bool {
        self.0.set_nonblocking(true).unwrap();
        self.0.read(&mut [0]).is_err()
    }
}

fn connect(clients: &Clients) -> Option<(Peer, ClientSlot)> {
    let (peer, stream) = UnixStream::pair().unwrap();
    let slot = clients.add(Arc::new(LineWriter::new(Arc::new(stream)).unwrap()))?;
    Some((Peer(peer), slot))
}

fn full() -> (Clients, Vec<(Peer, ClientSlot)>) {
    let clients = Clients::default();
    let connected = (0..MAX_CLIENTS).map(|_| connect(&clients).unwrap());
    (clients.clone(), connected.collect())
}

#[test]
fn the_client_that_never_sent_a_request_is_disconnected_first_then_the_one_that_was_idle_longest() {
    let (clients, mut connected) = full();
    for index in [0, 3, 1] {
        assert!(connected[index].1.begin_request());
        connected[index].1.end_request();
    }
    let mut next = |expected: usize| {
        connected.push(connect(&clients).expect("a place"));
        let (_, newest) = connected.last().unwrap();
        assert!(newest.begin_request());
        assert!(!connected[expected].0.is_connected(), "{expected}");
        assert!(!connected[expected].1.begin_request(), "{expected}");
    };
    for expected in [2].into_iter().chain(4..MAX_CLIENTS).chain([0, 3, 1]) {
        next(expected);
    }
    assert!(connect(&clients).is_none(), "all others are busy");
    connected.pop();
    assert!(connect(&clients).is_some());
}

#[test]
fn a_place_is_left_beside_subscribers() {
    let (clients, mut connected) = full();
    for (_, slot) in &connected[1..] {
        assert!(slot.subscribe());
        assert!(slot.begin_request());
        slot.end_request();
    }
    assert!(!connected[0].1.subscribe());
    let (_, command) = connect(&clients).expect("a place");
    assert!(!connected[0].0.is_connected());
    assert!(!command.subscribe());
    drop(connected.pop());
    assert!(command.subscribe());
}

/// A client has its response before its thread notes that the request is over, and may connect again before then.
#[test]
fn a_client_whose_request_is_about_to_end_makes_room() {
    let makes_room = |leaves: bool| {
        let (clients, mut connected) = full();
        for (_, slot) in &connected {
            assert!(slot.begin_request());
        }
        let (_peer, busy) = connected.pop().unwrap();
        thread::scope(|scope| {
            let added = scope.spawn(|| connect(&clients).is_some());
            thread::sleep(Duration::from_millis(20));
            if leaves {
                drop(busy)
            } else {
                busy.end_request()
            }
            added.join().unwrap()
        })
    };
    for leaves in [false, true] {
        // A busy machine may end the request when the new client has given up.
        assert!((0..20).any(|_| makes_room(leaves)), "{leaves}");
    }
}
