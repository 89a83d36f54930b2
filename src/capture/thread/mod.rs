//! A source on a thread of its own, behind a bounded channel.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{JoinHandle, Thread};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded, select};

use super::cancel::{CancelHandle, cancel_token};
use super::suspend::SuspendDetector;
use super::{CancelToken, CaptureError, Reading, Source, SourceEvent, SourceStats};

/// What a capture thread sends.
///
/// After [`Failed`](Self::Failed) or [`End`](Self::End) the channel is disconnected. A thread that is
/// stopped by dropping its [`Captured`] sends neither.
#[derive(Clone, Debug)]
pub enum CaptureEvent {
    /// A reading.
    Reading {
        /// What the sensor saw.
        reading: Reading,
        /// When the capture thread had it.
        received_at: Instant,
        /// What has come in up to and with this reading.
        stats: SourceStats,
    },
    /// Bytes come of which none belongs to a reading: what has come in by now. At most twice a second.
    Noise(SourceStats),
    /// The device is gone and the source looks for it, or it was interrupted; readings may follow. Never superseded, and always
    /// before the readings that came after it.
    Lost(CaptureError),
    /// The source gave up, or panicked.
    Failed(CaptureError),
    /// The stream is over.
    End(SourceStats),
}

/// Arrivals that wait for whoever takes them: enough for a pause of 90 ms at 115 200 baud, few enough that
/// nobody acts on a hand of long ago.
const WAITING_ARRIVALS: usize = 16;

/// How often is told of bytes that are no readings.
const NOISE: Duration = Duration::from_millis(500);

/// How long dropping a [`Captured`] waits for its thread; a device that blocks longer is left behind.
const JOIN_LIMIT: Duration = Duration::from_secs(1);

/// A source that runs on its own thread. Dropping it stops the thread: at once where the source
/// [heeds](Source::heed) that, else within [`PATIENCE`](super::PATIENCE), and within one second at most.
#[derive(Debug)]
pub struct CaptureThread {
    events: Receiver<CaptureEvent>,
    name: String,
    packet_period: Option<Duration>,
    is_live: bool,
    /// Rings when it is dropped.
    bell: Option<CancelHandle>,
    /// Disconnected when the thread is over.
    over: Receiver<()>,
    thread: Option<JoinHandle<()>>,
}

/// Moves `source` to a thread of its own.
///
/// When nobody takes what arrives, a [live](Source::is_live) source drops its oldest readings and counts
/// them in [`Counts::superseded`]; any other source waits.
pub fn spawn(mut source: impl Source + 'static) -> Result<CaptureThread, CaptureError> {
    let name = source.name().to_owned();
    let frame_period = source.packet_period();
    let is_live = source.is_live();
    let (sender, arrivals) = bounded(WAITING_ARRIVALS);
    let (thread_is_over, over) = bounded(0);
    let refuse = |what: &str, error| CaptureError::Open {
        source_name: name.clone(),
        reason: format!("no {what} for it: {error}; close other programs"),
    };
    let (bell, interrupt) = cancel_token().map_err(|error| refuse("pipe", error))?;
    source.set_cancel_token(&interrupt);
    let mut outlet = Outlet {
        sender,
        waiting: arrivals.clone(),
        is_live,
        interrupt,
        superseded: 0,
        waiter: Waiter(std::thread::current()),
    };
    let source_name = name.clone();
    let run = move || {
        let _over_at_the_end: Sender<()> = thread_is_over;
        capture(source, source_name, &mut outlet);
    };
    let thread = std::thread::Builder::new()
        .name("capture".to_owned())
        .spawn(run);
    let thread = thread.map_err(|error| refuse("thread", error))?;
    Ok(CaptureThread {
        events: arrivals,
        name,
        packet_period: frame_period,
        is_live,
        bell: Some(bell),
        over,
        thread: Some(thread),
    })
}

impl CaptureThread {
    /// Where the arrivals come out, for `recv`, `try_recv` and `select!`. With each of them, and when there will be no
    /// more, the thread that made this is [unparked](std::thread::Thread::unpark), so that it may wait by parking.
    pub fn events(&self) -> &Receiver<CaptureEvent> {
        &self.events
    }

    /// The [name](Source::name) of the source.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The [time between two readings](Source::frame_period) of the source.
    pub fn packet_period(&self) -> Option<Duration> {
        self.packet_period
    }

    /// Whether the source is [live](Source::is_live).
    pub fn is_live(&self) -> bool {
        self.is_live
    }
}

impl Drop for CaptureThread {
    fn drop(&mut self) {
        self.bell = None;
        if self.over.recv_timeout(JOIN_LIMIT) == Err(RecvTimeoutError::Timeout) {
            tracing::warn!("{} does not stop, its thread is left behind", self.name);
            return;
        }
        if let Some(thread) = self.thread.take() {
            // The thread catches the panics of its source; there is nothing else to hear of.
            let _ = thread.join();
        }
    }
}

fn capture(source: impl Source, name: String, outlet: &mut Outlet) {
    let whole_run = catch_unwind(AssertUnwindSafe(|| {
        run(source, &mut SuspendDetector::default(), outlet);
    }));
    if let Err(panic) = whole_run {
        outlet.send(|_| {
            CaptureEvent::Failed(CaptureError::Malformed {
                source_name: name,
                reason: format!("it panicked: {}; please report this", panic_text(&*panic)),
            })
        });
    }
}

fn run(mut source: impl Source, awake: &mut SuspendDetector, outlet: &mut Outlet) {
    let mut interruptions = 0;
    let (mut told, mut told_bytes) = (Instant::now(), 0);
    while !outlet.interrupt.is_cancelled() {
        let news = source.next();
        if outlet.is_live && awake.was_suspended() {
            // The clocks of readings stand still meanwhile: nobody else notices.
            interruptions += 1;
            let source_name = source.name().to_owned();
            let reason = "the machine has slept".to_owned();
            outlet.send(|_| {
                CaptureEvent::Lost(CaptureError::Interrupted {
                    source_name,
                    reason,
                })
            });
        }
        let counts = || {
            let counts = source.stats();
            SourceStats {
                losses: counts.losses + interruptions,
                ..counts
            }
        };
        match news {
            Ok(SourceEvent::Idle) if told.elapsed() < NOISE => {}
            Ok(SourceEvent::Idle) => {
                told = Instant::now();
                let counts = counts();
                if std::mem::replace(&mut told_bytes, counts.bytes) < counts.bytes {
                    outlet.send(|superseded| {
                        CaptureEvent::Noise(SourceStats {
                            dropped: superseded,
                            ..counts
                        })
                    });
                }
            }
            Ok(SourceEvent::Reading(reading)) => {
                let arrived = Instant::now();
                let counts = counts();
                (told, told_bytes) = (arrived, counts.bytes);
                outlet.send(|superseded| CaptureEvent::Reading {
                    reading,
                    received_at: arrived,
                    stats: SourceStats {
                        dropped: superseded,
                        ..counts
                    },
                });
            }
            Ok(SourceEvent::End) => {
                let counts = counts();
                outlet.send(|superseded| {
                    CaptureEvent::End(SourceStats {
                        dropped: superseded,
                        ..counts
                    })
                });
                return;
            }
            Err(error) if error.is_recoverable() => outlet.send(|_| CaptureEvent::Lost(error)),
            Err(error) => {
                outlet.send(|_| CaptureEvent::Failed(error));
                return;
            }
        }
    }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no text")
}

/// The sending end. Only its thread sends, so room that it has made stays.
struct Outlet {
    sender: Sender<CaptureEvent>,
    /// The same arrivals that the consumer takes, to take back the oldest.
    waiting: Receiver<CaptureEvent>,
    is_live: bool,
    interrupt: CancelToken,
    superseded: u64,
    // After the sender, so that whoever is woken by its end finds the channel closed.
    waiter: Waiter,
}

/// The thread that takes what arrives, which may park until something does. To unpark it takes no lock; to wake
/// it through the channel would take one that it needs itself at once.
struct Waiter(Thread);

impl Waiter {
    fn wake(&self) {
        self.0.unpark();
    }
}

impl Drop for Waiter {
    fn drop(&mut self) {
        self.wake();
    }
}

impl Outlet {
    /// Sends what `arrival` makes of the number of superseded readings.
    fn send(&mut self, arrival: impl FnOnce(u64) -> CaptureEvent) {
        if self.is_live {
            self.make_room();
        }
        if let Err(TrySendError::Full(arrival)) = self.sender.try_send(arrival(self.superseded)) {
            select! {
                send(self.sender, arrival) -> _ => {}
                recv(self.interrupt.channel()) -> _ => {}
            }
        }
        self.waiter.wake();
    }

    fn make_room(&mut self) {
        while self.sender.is_full() {
            match self.waiting.try_recv() {
                Ok(CaptureEvent::Reading { .. }) => self.superseded += 1,
                // What comes next tells it all.
                Ok(CaptureEvent::Noise(_)) => {}
                Ok(loss) => self.keep_only(loss),
                // The consumer was faster.
                Err(_) => {}
            }
        }
    }

    /// Drops all that waits but the latest loss: a loss must stay before the readings that come after it.
    fn keep_only(&mut self, mut loss: CaptureEvent) {
        while let Ok(arrival) = self.waiting.try_recv() {
            match arrival {
                CaptureEvent::Reading { .. } => self.superseded += 1,
                CaptureEvent::Noise(_) => {}
                later => loss = later,
            }
        }
        // There is room: the channel was empty a moment ago and nobody else sends.
        let _ = self.sender.try_send(loss);
    }
}

#[cfg(test)]
mod tests;
