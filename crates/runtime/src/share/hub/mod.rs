//! The session's end of sharing.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded};

use crate::advice;
use crate::network::zenoh::Publisher;
use crate::network::{Gatekeeper, network_folder};
use crate::share::broadcast::Broadcast;
use crate::share::datagrams::DatagramSender;
use crate::share::lines::LineEncoder;
use crate::share::listener::{AcceptThread, Connection, listen};
use crate::share::step::SharedStep;
use crate::share::{ShareError, ShareLink, ShareTarget};
use ademan_core::hand::Side;
use ademan_core::layout::Layout;
use ademan_core::objects::SceneState;
use ademan_core::pipeline::Pipeline;
use ademan_core::snapshot::StepView;
use ademan_core::time::Timestamp;

/// Steps that wait for the thread.
const MAX_STEPS: usize = 64;

/// Connections that wait for the thread. Further ones wait in the kernel, where they take no file descriptors.
const MAX_CONNECTIONS: usize = 4;

/// Longest time in which the thread ends.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);

/// The servers and receivers of a session, until it is dropped.
pub struct ShareHub {
    targets: Vec<ShareTarget>,
    /// `None` while the hub is dropped.
    steps: Option<Sender<SharedStep>>,
    /// `true` if steps are sent somewhere even if there is no client.
    has_receivers: bool,
    clients: Arc<AtomicUsize>,
    scene: SceneState,
    started_at: Instant,
    /// The threads that accept connections, until they are dropped.
    _listeners: Vec<AcceptThread>,
    /// `None` without targets.
    thread: Option<JoinHandle<()>>,
    /// Disconnected when the thread ends.
    thread_ended: Receiver<()>,
}

/// Checks that no port is the port of two servers.
fn check_ports(targets: &[ShareTarget]) -> Result<(), ShareError> {
    for (index, second) in targets.iter().enumerate() {
        let listens = |target: &ShareTarget| target.listens_at() == Some(second.address);
        let first = targets[..index].iter().find(|target| listens(target));
        if let Some(first) = first.filter(|_| listens(second)) {
            return Err(ShareError::SamePort(Box::new([*first, *second])));
        }
    }
    Ok(())
}

impl ShareHub {
    /// Starts to share a session whose first hand is `first`, and whose first layout is `layout`.
    pub fn start(
        targets: &[ShareTarget],
        first: Side,
        layout: Arc<Layout>,
    ) -> Result<Self, ShareError> {
        let (steps, step_receiver) = bounded(MAX_STEPS);
        let (connections, connection_receiver) = bounded(MAX_CONNECTIONS);
        let (end, thread_ended) = bounded(0);
        let clients = Arc::new(AtomicUsize::new(0));
        let mut hub = Self {
            targets: targets.to_vec(),
            steps: Some(steps),
            has_receivers: false,
            clients: Arc::clone(&clients),
            scene: SceneState::default(),
            started_at: Instant::now(),
            _listeners: Vec::new(),
            thread: None,
            thread_ended,
        };
        if targets.is_empty() {
            return Ok(hub);
        }
        check_ports(targets)?;
        let (mut servers, mut senders, mut publishers) = (Vec::new(), Vec::new(), Vec::new());
        for target in &mut hub.targets {
            if target.format.is_datagram() {
                senders.push(DatagramSender::open(target, first)?);
                continue;
            }
            let server = servers.len();
            let keeper = match &target.link {
                ShareLink::Plain => None,
                ShareLink::Tls => Some(Gatekeeper::open(&network_folder()?)?),
                ShareLink::Zenoh(key) => {
                    let stream = Box::new(Publisher::open(target.address, key)?);
                    publishers.push(Connection { server, stream });
                    servers.push(*target);
                    continue;
                }
            };
            let connections = connections.clone();
            let listener = listen(server, target.address, keeper, connections)?;
            target.address = listener.address();
            servers.push(*target);
            hub._listeners.push(listener);
        }
        hub.has_receivers = !senders.is_empty();
        let encoder = LineEncoder::new(first, layout);
        let mut broadcast = Broadcast::new(
            step_receiver,
            connection_receiver,
            servers,
            senders,
            encoder,
            clients,
        );
        for publisher in publishers {
            broadcast.add(publisher);
        }
        let thread = thread::Builder::new().name("share".into());
        let spawned = thread.spawn(move || {
            let _end: Sender<()> = end;
            broadcast.run();
        });
        hub.thread = Some(
            spawned.map_err(|error| ShareError::NoThread(advice::no_thread(&error).to_string()))?,
        );
        Ok(hub)
    }

    /// Returns the targets with the ports at which servers listen.
    pub fn targets(&self) -> &[ShareTarget] {
        &self.targets
    }

    /// Shares a step. Does not wait: a step is dropped while 64 wait.
    pub fn push(&mut self, step: &StepView, pipeline: &Pipeline) {
        self.scene.follow_keys(step);
        if self.is_watched() {
            self.scene.update(step, pipeline);
            self.send(SharedStep {
                snapshot: step.to_snapshot(),
                layout: pipeline.layout().layout().cloned(),
                scene: self.scene.clone(),
                shared_at: Timestamp::default() + self.started_at.elapsed(),
            });
        }
    }

    /// Returns `true` if there is a client or a receiver.
    fn is_watched(&self) -> bool {
        self.has_receivers || self.clients.load(Ordering::Relaxed) > 0
    }

    fn send(&self, step: SharedStep) {
        if let Some(steps) = &self.steps {
            let _ = steps.try_send(step);
        }
    }
}

impl Drop for ShareHub {
    /// Writes what the clients accept at once, and closes all connections. Waits for 1 s at most: the end of the program
    /// closes them too.
    fn drop(&mut self) {
        self.steps = None;
        let Some(thread) = self.thread.take() else {
            return;
        };
        match self.thread_ended.recv_timeout(CLOSE_TIMEOUT) {
            Err(RecvTimeoutError::Timeout) => tracing::warn!(
                "the servers of --share did not end within {} s; their clients may miss the last lines",
                CLOSE_TIMEOUT.as_secs()
            ),
            _ => _ = thread.join(),
        }
    }
}

#[cfg(test)]
mod tests;
