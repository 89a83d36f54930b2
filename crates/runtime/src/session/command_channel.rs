//! The channel that carries commands to the session loop, from any thread.
//!
//! The queue is bounded. A full queue refuses commands, except `Stop`, which needs no room: a flag carries it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};

use super::estimator_swap::EstimatorSwap;
use super::layout_link::{LayoutLink, LayoutSwap, LoopLayoutLink};
use super::reply::{Reply, ReplySender, RequestError};
use super::waker::{WakeTarget, Waker};
use ademan_core::command::{Command, CommandOrigin};

/// Commands of clients that wait for a busy loop: one of each client of the control socket. A command whose client has given up still
/// waits.
const CLIENT_COMMANDS: usize = 16;

/// Commands that wait for a busy loop: commands of clients, and 8 of panic keys and signals, whose room clients cannot take.
const QUEUE_LENGTH: usize = CLIENT_COMMANDS + 8;

/// Time that [`CommandSender::request`] waits for a reply.
const REPLY_TIMEOUT: Duration = Duration::from_secs(2);

/// A command, its origin, and the channel for its reply, if one is expected.
#[derive(Clone, Debug)]
pub(super) struct QueuedCommand {
    pub command: Command,
    pub origin: CommandOrigin,
    pub reply: Option<ReplySender>,
}

/// A command in the queue.
#[derive(Debug)]
struct WaitingCommand {
    queued: QueuedCommand,
    /// The permit of a client, which is returned when the command is received.
    _permit: Option<ClientPermit>,
}

/// One of [`CLIENT_COMMANDS`] permits to queue a command of a client, until it is dropped.
#[derive(Debug)]
struct ClientPermit(Arc<AtomicUsize>);

impl ClientPermit {
    /// Takes a permit; `taken` is the number of all that are taken. Returns `None` if there is none left.
    fn try_acquire(taken: &Arc<AtomicUsize>) -> Option<Self> {
        let one_more = |count: usize| (count < CLIENT_COMMANDS).then_some(count + 1);
        taken
            .fetch_update(Ordering::AcqRel, Ordering::Acquire, one_more)
            .ok()?;
        Some(Self(Arc::clone(taken)))
    }
}

impl Drop for ClientPermit {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::AcqRel);
    }
}

/// Counters of requested pauses, and of pauses that a `Resume` has ended.
///
/// Each pause is counted twice: before and after it enters the queue. A `Resume` ends the pauses that were counted before it entered the
/// queue. A pause after it in the queue therefore stays requested, even if the threads that send them interrupt each other. A pause
/// that enters the queue at the same time may stay requested, too.
#[derive(Debug, Default)]
struct PauseNotes {
    noted: AtomicUsize,
    ended: AtomicUsize,
}

impl PauseNotes {
    fn note(&self) {
        self.noted.fetch_add(1, Ordering::SeqCst);
    }

    /// Returns the number of notes so far.
    fn known(&self) -> usize {
        self.noted.load(Ordering::SeqCst)
    }

    /// Ends the first `known` notes.
    fn end(&self, known: usize) {
        self.ended.fetch_max(known, Ordering::SeqCst);
    }

    fn is_pause_requested(&self) -> bool {
        let ended = self.ended.load(Ordering::SeqCst);
        self.known() > ended
    }
}

/// Sends commands to a session. Clones send to the same session.
#[derive(Clone, Debug)]
pub struct CommandSender {
    origin: CommandOrigin,
    queue: Sender<WaitingCommand>,
    /// Number of permits of clients that are taken.
    client_permits: Arc<AtomicUsize>,
    estimators: Sender<EstimatorSwap>,
    stop: Arc<AtomicBool>,
    pauses: Arc<PauseNotes>,
    waker: Waker,
}

impl CommandSender {
    /// Returns a sender to the same session whose commands have this origin. The sender of a new channel has the
    /// origin [`Client`](CommandOrigin::Client).
    #[must_use]
    pub fn with_origin(&self, origin: CommandOrigin) -> Self {
        Self {
            origin,
            ..self.clone()
        }
    }

    /// Sends a command without waiting for its execution. A second `Stop` has no effect.
    pub fn send(&self, command: Command) -> Result<(), RequestError> {
        self.enqueue(command, None)
    }

    /// Sends a command and waits up to 2 s for its reply. `Stop` is confirmed at once.
    pub fn request(&self, command: Command) -> Result<Reply, RequestError> {
        self.request_with_timeout(command, REPLY_TIMEOUT)
    }

    /// Sends a command and waits for its reply as [`request`](Self::request) does, for at most `timeout`.
    pub fn request_with_timeout(
        &self,
        command: Command,
        timeout: Duration,
    ) -> Result<Reply, RequestError> {
        let (reply, replies) = bounded(1);
        self.enqueue(command, Some(reply))?;
        if command == Command::Stop {
            return Ok(Reply::Done);
        }
        replies.recv_timeout(timeout).map_err(|error| match error {
            RecvTimeoutError::Timeout => RequestError::TimedOut,
            RecvTimeoutError::Disconnected => RequestError::Ended,
        })?
    }

    /// Returns `true` after a pause by a signal, the panic keys or the loss of the watchdog, even if the queue was full, until a
    /// `Resume` or `TogglePause` is queued. The commands may never be executed: the session may have ended, or end before it starts.
    pub fn is_pause_requested(&self) -> bool {
        self.pauses.is_pause_requested()
    }

    /// Sends an estimator without waiting. The queue has room for one.
    pub(super) fn send_estimator(&self, swap: EstimatorSwap) -> Result<(), RequestError> {
        self.estimators.try_send(swap).map_err(refusal)?;
        self.waker.wake();
        Ok(())
    }

    fn enqueue(&self, command: Command, reply: Option<ReplySender>) -> Result<(), RequestError> {
        command.check()?;
        match command {
            // The pause of a suspend ends by itself, and its end resumes no other pause.
            _ if self.origin == CommandOrigin::Suspend => self.put(command, reply),
            Command::Pause if self.origin != CommandOrigin::Client => {
                self.pauses.note();
                let put = self.put(command, reply);
                self.pauses.note();
                put
            }
            // `TogglePause` ends a counted pause, or requests a pause of a client, which is not counted.
            Command::Resume | Command::TogglePause => {
                let known = self.pauses.known();
                self.put(command, reply)?;
                self.pauses.end(known);
                Ok(())
            }
            _ => self.put(command, reply),
        }
    }

    /// Adds a command to the queue, and wakes the loop.
    fn put(&self, command: Command, reply: Option<ReplySender>) -> Result<(), RequestError> {
        if command == Command::Stop {
            self.stop.store(true, Ordering::Release);
        } else {
            let permit = if self.origin == CommandOrigin::Client {
                let taken = ClientPermit::try_acquire(&self.client_permits);
                Some(taken.ok_or(RequestError::QueueFull)?)
            } else {
                None
            };
            let queued = QueuedCommand {
                command,
                origin: self.origin,
                reply,
            };
            let waiting = WaitingCommand {
                queued,
                _permit: permit,
            };
            self.queue.try_send(waiting).map_err(refusal)?;
        }
        self.waker.wake();
        Ok(())
    }
}

fn refusal<T>(error: TrySendError<T>) -> RequestError {
    match error {
        TrySendError::Full(_) => RequestError::QueueFull,
        TrySendError::Disconnected(_) => RequestError::Ended,
    }
}

/// The end of the channel for the session loop.
#[derive(Debug)]
pub struct CommandReceiver {
    queue: Receiver<WaitingCommand>,
    estimators: Receiver<EstimatorSwap>,
    stop: Arc<AtomicBool>,
    waker: Waker,
    layouts: Option<LoopLayoutLink>,
}

/// A message to the session loop.
pub(super) enum Message {
    Command(QueuedCommand),
    LayoutSwap(LayoutSwap),
    EstimatorSwap(EstimatorSwap),
}

/// Creates a channel. Commands stay queued until a session loop receives them.
pub fn command_channel() -> (CommandSender, CommandReceiver) {
    let (sender, queue) = bounded(QUEUE_LENGTH);
    let (estimator_sender, estimators) = bounded(1);
    let (stop, waker) = (Arc::default(), Waker::default());
    let receiver = CommandReceiver {
        queue,
        estimators,
        stop: Arc::clone(&stop),
        waker: waker.clone(),
        layouts: None,
    };
    let sender = CommandSender {
        origin: CommandOrigin::Client,
        queue: sender,
        client_permits: Arc::default(),
        estimators: estimator_sender,
        stop,
        pauses: Arc::default(),
        waker,
    };
    (sender, receiver)
}

impl CommandReceiver {
    /// Creates a receiver without senders, for a loop that ends with its source.
    pub fn disconnected() -> Self {
        command_channel().1
    }

    /// Creates the link of a layout manager to the loop. Without one, the commands `Scale`, `Save` and `Reload` fail.
    pub fn link_layouts(&mut self) -> LayoutLink {
        let (manager_end, loop_end) = LayoutLink::new(self.waker.clone());
        self.layouts = Some(loop_end);
        manager_end
    }

    /// Returns the link to the layout manager.
    pub(super) fn layouts(&self) -> Option<&LoopLayoutLink> {
        self.layouts.as_ref()
    }

    /// Sets the thread that receives messages; every message wakes it.
    pub(super) fn attach(&self, target: WakeTarget) {
        self.waker.attach(target);
    }

    /// Returns `true` after a `Stop`.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }

    /// Returns the next message, if there is one. Never waits.
    pub(super) fn try_next(&self) -> Option<Message> {
        self.waker.receive(|| {
            let swap = self.layouts.as_ref().and_then(LoopLayoutLink::try_swap);
            let estimator = || self.estimators.try_recv().ok().map(Message::EstimatorSwap);
            let command = || Some(Message::Command(self.queue.try_recv().ok()?.queued));
            let swap = swap.map(Message::LayoutSwap);
            swap.or_else(estimator).or_else(command)
        })
    }

    /// Waits for `Stop`, at most for `timeout`. Returns `true` if it came. Other commands stay queued.
    pub(super) fn wait_for_stop(&self, timeout: Duration) -> bool {
        self.attach(WakeTarget::Parked(thread::current()));
        let deadline = Instant::now() + timeout;
        while !self.is_stopped() {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return false;
            }
            thread::park_timeout(left);
        }
        true
    }
}

impl Drop for CommandReceiver {
    /// Drops the commands that wait: the queue keeps them as long as there are senders, and their clients would wait for replies.
    fn drop(&mut self) {
        while self.queue.try_recv().is_ok() {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::wait_until;

    #[test]
    fn stop_reaches_a_loop_whose_queue_is_full() {
        let (sender, receiver) = command_channel();
        while sender.send(Command::Resume).is_ok() {}
        assert_eq!(sender.send(Command::Pause), Err(RequestError::QueueFull));
        assert!(!receiver.is_stopped());
        assert_eq!(sender.request(Command::Stop), Ok(Reply::Done));
        assert!(receiver.wait_for_stop(Duration::ZERO));
    }

    #[test]
    fn clients_leave_room_for_the_pauses_of_panic_keys_and_signals() {
        let (sender, receiver) = command_channel();
        while sender.send(Command::Resume).is_ok() {}
        for origin in [
            CommandOrigin::PanicKeys,
            CommandOrigin::Signal,
            CommandOrigin::Watchdog,
        ] {
            let pause = sender.with_origin(origin).send(Command::Pause);
            assert_eq!(pause, Ok(()), "{origin}");
        }
        drop(receiver);
    }

    #[test]
    fn clients_that_send_together_take_their_places_and_no_others() {
        let (sender, receiver) = command_channel();
        let clients: Vec<_> = (0..4).map(|_| sender.clone()).collect();
        let send = |client: CommandSender| {
            move || {
                (0..100)
                    .filter(|_| client.send(Command::State).is_ok())
                    .count()
            }
        };
        let threads: Vec<_> = clients
            .into_iter()
            .map(|it| thread::spawn(send(it)))
            .collect();
        let sent: usize = threads.into_iter().map(|it| it.join().unwrap()).sum();
        assert_eq!(sent, CLIENT_COMMANDS);
        assert!(receiver.try_next().is_some());
        assert_eq!(sender.send(Command::State), Ok(()), "a place is free again");
        assert_eq!(sender.send(Command::State), Err(RequestError::QueueFull));
        drop(receiver);
        assert_eq!(sender.send(Command::State), Err(RequestError::Ended));
    }

    #[test]
    fn a_pause_of_another_origin_than_a_client_is_known_before_it_is_executed() {
        let (sender, receiver) = command_channel();
        sender.send(Command::Pause).unwrap();
        assert!(!sender.is_pause_requested());
        let signal = sender.with_origin(CommandOrigin::Signal);
        signal.send(Command::Pause).unwrap();
        assert!(sender.is_pause_requested());
        let suspend = sender.with_origin(CommandOrigin::Suspend);
        suspend.send(Command::Resume).unwrap();
        assert!(sender.is_pause_requested(), "it stays after Ctrl-Z");
        sender.send(Command::Resume).unwrap();
        assert!(!sender.is_pause_requested());
        suspend.send(Command::Pause).unwrap();
        assert!(!sender.is_pause_requested());
        signal.send(Command::Pause).unwrap();
        sender.send(Command::TogglePause).unwrap();
        assert!(!sender.is_pause_requested());
        drop(receiver);
        assert!(signal.send(Command::Pause).is_err());
        assert!(sender.is_pause_requested(), "the session has ended");
    }

    #[test]
    fn a_resume_that_finds_no_room_ends_no_pause() {
        let (sender, receiver) = command_channel();
        let signal = sender.with_origin(CommandOrigin::Signal);
        signal.send(Command::Pause).unwrap();
        while sender.send(Command::State).is_ok() {}
        assert_eq!(sender.send(Command::Resume), Err(RequestError::QueueFull));
        assert!(sender.is_pause_requested());
        while receiver.try_next().is_some() {}
        sender.send(Command::Resume).unwrap();
        assert!(!sender.is_pause_requested());
    }

    #[test]
    fn a_pause_that_is_queued_after_a_resume_is_not_ended_by_it() {
        let pauses = PauseNotes::default();
        // The pause is noted, the resume is queued, and then the pause.
        pauses.note();
        pauses.end(pauses.known());
        pauses.note();
        assert!(pauses.is_pause_requested());
        pauses.end(pauses.known());
        assert!(!pauses.is_pause_requested());
        // The pause comes while the resume is queued.
        let known = pauses.known();
        pauses.note();
        pauses.end(known);
        pauses.note();
        assert!(pauses.is_pause_requested());
    }

    #[test]
    fn commands_arrive_in_order_with_their_reply_channel() {
        let (sender, receiver) = command_channel();
        sender.send(Command::Pause).unwrap();
        sender.send(Command::Resume).unwrap();
        let next = || match receiver.try_next() {
            Some(Message::Command(queued)) => Some(queued.command),
            _ => None,
        };
        assert_eq!(
            [next(), next(), next()],
            [Some(Command::Pause), Some(Command::Resume), None]
        );
    }

    #[test]
    fn a_request_fails_when_the_session_ends() {
        let (sender, receiver) = command_channel();
        let session = thread::spawn(move || {
            while receiver.try_next().is_none() {
                thread::yield_now();
            }
        });
        assert_eq!(sender.request(Command::State), Err(RequestError::Ended));
        wait_until("the end of the session", || session.is_finished());
        session.join().unwrap();
        assert_eq!(sender.send(Command::Pause), Err(RequestError::Ended));
    }

    #[test]
    fn a_request_that_still_waits_fails_when_the_session_ends() {
        let (sender, receiver) = command_channel();
        let client = sender.clone();
        let timeout = Duration::from_secs(60);
        let request = thread::spawn(move || client.request_with_timeout(Command::State, timeout));
        wait_until("a request", || !receiver.queue.is_empty());
        drop(receiver);
        assert_eq!(request.join().unwrap(), Err(RequestError::Ended));
        drop(sender);
    }

    #[test]
    fn a_command_out_of_range_is_not_sent() {
        let (sender, receiver) = command_channel();
        let refused = sender.send(Command::Scale { factor: 3.0 });
        assert!(
            matches!(refused, Err(RequestError::Invalid(_))),
            "{refused:?}"
        );
        assert!(receiver.try_next().is_none());
    }

    #[test]
    fn a_command_wakes_a_parked_loop() {
        let (sender, receiver) = command_channel();
        let session = thread::spawn(move || {
            receiver.attach(WakeTarget::Parked(thread::current()));
            while receiver.try_next().is_none() {
                thread::park();
            }
        });
        sender.send(Command::Pause).unwrap();
        wait_until("the end of the session", || session.is_finished());
        session.join().unwrap();
    }
}
