//! A glove on a real serial device whose wearer does what the test says.

use std::io::Write;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::thread::{self, JoinHandle};
use std::time::Instant;

use ademan::capture::hc11::{Framing, encode};
use ademan::capture::open_loopback;
use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, unbounded};

use super::press::{Posture, line};
use super::process::no_program_starts;

/// A glove that is plugged in.
///
/// It sends packets at the pace of its line, the last posture again and again.
pub struct Glove {
    link: PathBuf,
    orders: Option<Sender<Order>>,
    player: Option<JoinHandle<()>>,
}

enum Order {
    Play(Vec<Posture>),
    FallSilent,
    TalkNonsense,
}

impl Glove {
    /// Plugs it in; `link` becomes the name of its port, until it is unplugged.
    pub fn plug_in(link: &Path, posture: Posture) -> Self {
        let wire = {
            let _alone = no_program_starts();
            open_loopback(line()).expect("a pseudo terminal")
        };
        let port = wire.uri.serial_port().expect("a serial port");
        symlink(port, link).expect("a link to it");
        let (orders, received) = unbounded();
        let player = thread::spawn(move || play(wire.writer, &received, posture));
        Self {
            link: link.to_owned(),
            orders: Some(orders),
            player: Some(player),
        }
    }

    /// Takes these postures, one after the other, and stays in the last one.
    pub fn play(&self, postures: &[Posture]) {
        self.order(Order::Play(postures.to_vec()));
    }

    /// Sends nothing more, as a glove that is switched off behind an adapter that is still plugged in.
    pub fn fall_silent(&self) {
        self.order(Order::FallSilent);
    }

    /// Sends random bytes from now on.
    pub fn talk_nonsense(&self) {
        self.order(Order::TalkNonsense);
    }

    /// Pulls the cable; so does dropping it.
    pub fn unplug(&mut self) {
        let _ = std::fs::remove_file(&self.link);
        self.orders = None;
        if let Some(player) = self.player.take() {
            let _ = player.join();
        }
    }

    fn order(&self, order: Order) {
        let orders = self.orders.as_ref().expect("it is plugged in");
        orders.send(order).expect("the player is there");
    }
}

impl Drop for Glove {
    fn drop(&mut self) {
        self.unplug();
    }
}

fn play(mut line_end: Box<dyn Write + Send>, orders: &Receiver<Order>, posture: Posture) {
    let mut random = fastrand::Rng::with_seed(3);
    let mut playing = vec![posture];
    let mut place = 0;
    let mut is_nonsense = false;
    let mut due = Instant::now();
    loop {
        match orders.recv_deadline(due) {
            Ok(Order::Play(postures)) => (playing, place) = (postures, 0),
            Ok(Order::FallSilent) => playing.clear(),
            Ok(Order::TalkNonsense) => is_nonsense = true,
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                if let Some(posture) = playing.get(place) {
                    let mut packet = encode(Framing::Double06, posture);
                    if is_nonsense {
                        random.fill(&mut packet);
                    }
                    // A program that has ended does not listen.
                    let _ = line_end.write_all(&packet);
                    place = (place + 1).min(playing.len() - 1);
                }
                due = Instant::now() + line().packet_period();
            }
        }
    }
}
