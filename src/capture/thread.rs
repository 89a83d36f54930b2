//! A source on a thread of its own, behind a bounded channel.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, SendTimeoutError, Sender, bounded};

use super::awake::Awake;
use super::{Capture, CaptureError, Counts, PATIENCE, Reading, Source};

/// What a capture thread sends.
///
/// After [`Failed`](Self::Failed) or [`End`](Self::End) the channel is disconnected. A thread that is
/// stopped by dropping its [`Captured`] sends neither.
#[derive(Clone, Debug)]
pub enum Arrival {
    /// A reading.
    Reading {
        /// What the sensor saw.
        reading: Reading,
        /// When the capture thread had it.
        arrived: Instant,
        /// What has come in up to and with this reading.
        counts: Counts,
    },
    /// The device is gone and the source looks for it, or it was interrupted; readings may follow. Never superseded, and always
    /// before the readings that came after it.
    Lost(CaptureError),
    /// The source gave up, or panicked.
    Failed(CaptureError),
    /// The stream is over.
    End(Counts),
}

/// Arrivals that wait for whoever takes them: enough for a pause of 90 ms at 115 200 baud, few enough that
/// nobody acts on a hand of long ago.
const WAITING_ARRIVALS: usize = 16;

/// How long dropping a [`Captured`] waits for its thread; a device that blocks longer is left behind.
const JOIN_LIMIT: Duration = Duration::from_secs(1);

/// A source that runs on its own thread. Dropping it stops the thread, within [`PATIENCE`] and one second at most.
#[derive(Debug)]
pub struct Captured {
    arrivals: Receiver<Arrival>,
    name: String,
    frame_period: Option<Duration>,
    is_live: bool,
    stop: Arc<AtomicBool>,
    /// Disconnected when the thread is over.
    over: Receiver<()>,
    thread: Option<JoinHandle<()>>,
}

/// Moves `source` to a thread of its own.
///
/// When nobody takes what arrives, a [live](Source::is_live) source drops its oldest readings and counts
/// them in [`Counts::superseded`]; any other source waits.
pub fn on_thread(source: impl Source + 'static) -> Result<Captured, CaptureError> {
    let name = source.name().to_owned();
    let frame_period = source.frame_period();
    let is_live = source.is_live();
    let (sender, arrivals) = bounded(WAITING_ARRIVALS);
    let (thread_is_over, over) = bounded(0);
    let stop = Arc::new(AtomicBool::new(false));
    let mut outlet = Outlet {
        sender,
        waiting: arrivals.clone(),
        is_live,
        stop: stop.clone(),
        superseded: 0,
    };
    let source_name = name.clone();
    let run = move || {
        let _over_at_the_end: Sender<()> = thread_is_over;
        capture(source, source_name, &mut outlet);
    };
    let thread = std::thread::Builder::new()
        .name("capture".to_owned())
        .spawn(run);
    let thread = thread.map_err(|error| CaptureError::Open {
        source_name: name.clone(),
        reason: format!("no thread for it: {error}; close other programs"),
    })?;
    Ok(Captured {
        arrivals,
        name,
        frame_period,
        is_live,
        stop,
        over,
        thread: Some(thread),
    })
}

impl Captured {
    /// Where the arrivals come out, for `recv`, `try_recv` and `select!`.
    pub fn arrivals(&self) -> &Receiver<Arrival> {
        &self.arrivals
    }

    /// The [name](Source::name) of the source.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The [time between two readings](Source::frame_period) of the source.
    pub fn frame_period(&self) -> Option<Duration> {
        self.frame_period
    }

    /// Whether the source is [live](Source::is_live).
    pub fn is_live(&self) -> bool {
        self.is_live
    }
}

impl Drop for Captured {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
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
        run(source, &mut Awake::default(), outlet);
    }));
    if let Err(panic) = whole_run {
        outlet.send(|_| {
            Arrival::Failed(CaptureError::Malformed {
                source_name: name,
                reason: format!("it panicked: {}; please report this", panic_text(&*panic)),
            })
        });
    }
}

fn run(mut source: impl Source, awake: &mut Awake, outlet: &mut Outlet) {
    let mut interruptions = 0;
    while !outlet.is_stopped() {
        let news = source.next();
        if outlet.is_live && awake.has_slept() {
            // The clocks of readings stand still meanwhile: nobody else notices.
            interruptions += 1;
            let source_name = source.name().to_owned();
            let reason = "the machine has slept".to_owned();
            outlet.send(|_| {
                Arrival::Lost(CaptureError::Interrupted {
                    source_name,
                    reason,
                })
            });
        }
        let counts = || {
            let counts = source.counts();
            Counts {
                losses: counts.losses + interruptions,
                ..counts
            }
        };
        match news {
            Ok(Capture::Quiet) => {}
            Ok(Capture::Reading(reading)) => {
                let arrived = Instant::now();
                let counts = counts();
                outlet.send(|superseded| Arrival::Reading {
                    reading,
                    arrived,
                    counts: Counts {
                        superseded,
                        ..counts
                    },
                });
            }
            Ok(Capture::End) => {
                let counts = counts();
                outlet.send(|superseded| {
                    Arrival::End(Counts {
                        superseded,
                        ..counts
                    })
                });
                return;
            }
            Err(error) if error.is_recoverable() => outlet.send(|_| Arrival::Lost(error)),
            Err(error) => {
                outlet.send(|_| Arrival::Failed(error));
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
    sender: Sender<Arrival>,
    /// The same arrivals that the consumer takes, to take back the oldest.
    waiting: Receiver<Arrival>,
    is_live: bool,
    stop: Arc<AtomicBool>,
    superseded: u64,
}

impl Outlet {
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Sends what `arrival` makes of the number of superseded readings.
    fn send(&mut self, arrival: impl FnOnce(u64) -> Arrival) {
        if self.is_live {
            self.make_room();
        }
        let mut arrival = arrival(self.superseded);
        while let Err(SendTimeoutError::Timeout(back)) =
            self.sender.send_timeout(arrival, PATIENCE / 2)
        {
            if self.is_stopped() {
                return;
            }
            arrival = back;
        }
    }

    fn make_room(&mut self) {
        while self.sender.is_full() {
            match self.waiting.try_recv() {
                Ok(Arrival::Reading { .. }) => self.superseded += 1,
                Ok(loss) => self.keep_only(loss),
                // The consumer was faster.
                Err(_) => {}
            }
        }
    }

    /// Drops all that waits but the latest loss: a loss must stay before the readings that come after it.
    fn keep_only(&mut self, mut loss: Arrival) {
        while let Ok(arrival) = self.waiting.try_recv() {
            match arrival {
                Arrival::Reading { .. } => self.superseded += 1,
                later => loss = later,
            }
        }
        // There is room: the channel was empty a moment ago and nobody else sends.
        let _ = self.sender.try_send(loss);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Channels, Sample};
    use crate::time::Timestamp;

    const LIMIT: Duration = Duration::from_secs(10);

    fn reading(number: u64) -> Capture {
        Capture::Reading(Reading {
            time: Timestamp(number),
            side: None,
            sample: Sample::Channels(Channels {
                full_scale: 255,
                counts: Default::default(),
            }),
        })
    }

    fn lost() -> CaptureError {
        CaptureError::Lost {
            source_name: "script".to_owned(),
            reason: "cable out".to_owned(),
        }
    }

    type Step = fn(u64) -> Result<Capture, CaptureError>;

    /// Runs `step` with 0, 1, 2, …; after `steps` it is quiet, and says so through `done`.
    struct Script {
        step: Step,
        steps: u64,
        at: u64,
        is_live: bool,
        done: Sender<()>,
    }

    fn script(steps: u64, is_live: bool, step: Step) -> (Script, Receiver<()>) {
        let (done, is_done) = bounded(1);
        let script = Script {
            step,
            steps,
            at: 0,
            is_live,
            done,
        };
        (script, is_done)
    }

    impl Source for Script {
        fn next(&mut self) -> Result<Capture, CaptureError> {
            if self.at == self.steps {
                let _ = self.done.try_send(());
                std::thread::sleep(Duration::from_millis(5));
                return Ok(Capture::Quiet);
            }
            self.at += 1;
            (self.step)(self.at - 1)
        }

        fn name(&self) -> &str {
            "script"
        }

        fn is_live(&self) -> bool {
            self.is_live
        }

        fn counts(&self) -> Counts {
            Counts {
                readings: self.at,
                ..Counts::default()
            }
        }
    }

    fn brief(arrival: Arrival) -> String {
        match arrival {
            Arrival::Reading {
                reading, counts, ..
            } => {
                format!("{}({})", reading.time.0, counts.superseded)
            }
            Arrival::Lost(_) => "lost".to_owned(),
            Arrival::Failed(error) => format!("failed: {error}"),
            Arrival::End(_) => "end".to_owned(),
        }
    }

    fn everything(captured: &Captured) -> Vec<String> {
        captured.arrivals().try_iter().map(brief).collect()
    }

    #[test]
    fn a_live_source_drops_its_oldest_readings_and_counts_them() {
        let (source, done) = script(100, true, |step| Ok(reading(step)));
        let captured = on_thread(source).unwrap();
        done.recv_timeout(LIMIT).unwrap();
        let arrived = everything(&captured);
        assert_eq!(arrived.len(), WAITING_ARRIVALS);
        assert_eq!(arrived[0], "84(69)");
        assert_eq!(arrived[15], "99(84)");
    }

    #[test]
    fn a_loss_is_never_superseded_and_keeps_its_place() {
        let (source, done) = script(41, true, |step| match step {
            10 | 20 => Err(lost()),
            step => Ok(reading(step)),
        });
        let captured = on_thread(source).unwrap();
        done.recv_timeout(LIMIT).unwrap();
        let arrived = everything(&captured);
        assert_eq!(arrived[0], "lost");
        assert!(!arrived[1..].contains(&"lost".to_owned()));
        let readings = arrived.len() as u64 - 1;
        assert_eq!(arrived.last().unwrap(), &format!("40({})", 39 - readings));
    }

    #[test]
    fn a_recording_waits_until_its_readings_are_taken() {
        let (source, _done) = script(100, false, |step| match step {
            99 => Ok(Capture::End),
            step => Ok(reading(step)),
        });
        let captured = on_thread(source).unwrap();
        std::thread::sleep(Duration::from_millis(30));
        let arrived: Vec<String> = captured.arrivals().iter().map(brief).collect();
        let expected: Vec<String> = (0..99).map(|step| format!("{step}(0)")).collect();
        assert_eq!(arrived[..99], expected);
        assert_eq!(arrived[99..], ["end"]);
    }

    #[test]
    fn dropping_stops_a_thread_that_waits_for_room() {
        let (source, _done) = script(100, false, |step| Ok(reading(step)));
        let captured = on_thread(source).unwrap();
        while captured.arrivals().len() < WAITING_ARRIVALS {
            std::thread::yield_now();
        }
        let over = captured.over.clone();
        drop(captured);
        assert_eq!(
            over.try_recv(),
            Err(crossbeam_channel::TryRecvError::Disconnected)
        );
    }

    #[test]
    fn dropping_leaves_a_thread_behind_that_blocks() {
        static BLOCKS: AtomicBool = AtomicBool::new(false);
        let (source, _done) = script(1, true, |_| {
            BLOCKS.store(true, Ordering::SeqCst);
            std::thread::sleep(Duration::from_secs(5));
            Ok(Capture::Quiet)
        });
        let captured = on_thread(source).unwrap();
        while !BLOCKS.load(Ordering::SeqCst) {
            std::thread::yield_now();
        }
        let start = Instant::now();
        drop(captured);
        assert!(start.elapsed() < Duration::from_secs(4));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_machine_that_slept_loses_its_live_sources_before_the_next_reading() {
        use std::sync::atomic::AtomicU64;
        static ASLEEP: AtomicU64 = AtomicU64::new(0);
        for is_live in [true, false] {
            let (source, _done) = script(4, is_live, |step| {
                if step == 2 {
                    ASLEEP.fetch_add(3600, Ordering::SeqCst);
                }
                match step {
                    3 => Ok(Capture::End),
                    step => Ok(reading(step)),
                }
            });
            let mut awake = Awake::with(|| Duration::from_secs(ASLEEP.load(Ordering::SeqCst)));
            let (sender, waiting) = bounded(WAITING_ARRIVALS);
            let mut outlet = Outlet {
                sender,
                waiting: waiting.clone(),
                is_live,
                stop: Arc::default(),
                superseded: 0,
            };
            run(source, &mut awake, &mut outlet);
            let arrivals: Vec<Arrival> = waiting.try_iter().collect();
            let counted = |arrival: &Arrival| matches!(arrival, Arrival::End(counts) if counts.losses == u64::from(is_live));
            assert!(arrivals.iter().any(counted), "{arrivals:?}");
            let arrived: Vec<String> = arrivals.into_iter().map(brief).collect();
            let expected: &[&str] = match is_live {
                true => &["0(0)", "1(0)", "lost", "2(0)", "end"],
                false => &["0(0)", "1(0)", "2(0)", "end"],
            };
            assert_eq!(arrived, expected);
        }
    }

    #[test]
    fn a_panic_of_the_source_arrives_as_a_failure() {
        let (source, _done) = script(2, true, |step| match step {
            0 => Ok(reading(0)),
            _ => panic!("bad count"),
        });
        let captured = on_thread(source).unwrap();
        let arrived: Vec<String> = captured.arrivals().iter().map(brief).collect();
        assert_eq!(arrived[0], "0(0)");
        assert_eq!(
            arrived[1..],
            ["failed: cannot use script: it panicked: bad count; please report this"]
        );
    }

    #[test]
    fn a_source_that_gives_up_ends_the_channel() {
        let (source, _done) = script(1, true, |_| {
            Err(CaptureError::Malformed {
                source_name: "script".to_owned(),
                reason: "half a file".to_owned(),
            })
        });
        let captured = on_thread(source).unwrap();
        let arrived: Vec<String> = captured.arrivals().iter().map(brief).collect();
        assert_eq!(arrived, ["failed: cannot use script: half a file"]);
    }
}
