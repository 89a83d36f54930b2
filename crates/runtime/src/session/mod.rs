//! A running setup: source, pipeline, outputs, and all threads around them.
//!
//! [`Session::start`] starts the threads and returns a [`SessionHandle`]. Commands go in through its [`CommandSender`],
//! from any thread; [`Snapshot`](ademan_core::snapshot::Snapshot)s of every step come out. `ademan run`, `demo`, `record` and
//! `replay` are clients of this module, as a graphical interface would be.
//!
//! ```text
//!  keys and gestures ─┐
//!  control socket ────┤                        ┌─ snapshots ──▶ observer, recorder, control socket
//!  panic keys ────────┼─ Command ──▶ event loop ┤
//!  SessionHandle ─────┘                 ▲       ├─ views ──▶ terminal, control socket
//!                                       │       └─ LayoutRequest ──▶ layout manager
//!                                       └──────────── LayoutSwap ◀───┘
//! ```

mod close_on_panic;
mod command_channel;
pub mod control_socket;
mod estimator_swap;
mod event_loop;
pub(crate) mod focus;
mod handle;
mod haptics;
mod latest;
mod layout_link;
mod layout_trial;
mod notice;
mod notice_thread;
mod observer;
mod options;
pub mod panic_keys;
mod recordings;
pub mod reload;
mod replay;
mod reply;
mod run_pipeline;
mod sensor_link;
mod snapshots;
mod source;
mod status;
mod tray;
pub mod view;
mod waker;
mod write_failures;
mod writer_thread;

use std::io;
use std::path::Path;
use std::process;
use std::sync::Arc;

use crossbeam_channel::Sender;
use hdrhistogram::Histogram;

use self::control_socket::{ControlError, ControlServer, Notifier, ProfileInfo, ServerContext};
use self::event_loop::run_observed;
use self::focus::FocusWatch;
use self::haptics::SessionHaptics;
use self::notice_thread::NoticeThread;
use self::observer::Observer;
use self::panic_keys::{PanicKeysError, PanicKeysWatch};
use self::reload::{FilePolicy, LayoutReport, LayoutSource};
use self::snapshots::SnapshotSender;
use self::status::StatusNotices;
use self::tray::Tray;
use self::view::{SessionNames, ViewHub, ViewPublisher};
use crate::advice;
use crate::capture::{CaptureError, Haptics, Source, SourceUri};
use crate::output::watchdog::WatchdogSettings;
use crate::output::{self, OutputError, Sink};
use crate::priority;
use crate::recorder::RecordError;
use crate::setup::{LoadedSetup, SetupError};
use crate::share::{ShareError, ShareHub};
use ademan_core::command::{Command, CommandOrigin};
use ademan_core::layout::Layout;
use ademan_core::message::escape;
use ademan_core::snapshot::Stats;

pub use self::command_channel::{CommandReceiver, CommandSender, command_channel};
#[doc(hidden)]
pub use self::event_loop::with_loop_step;
pub use self::focus::ActiveRule;
pub use self::handle::SessionHandle;
pub use self::layout_link::LayoutLink;
pub use self::layout_trial::{LayoutTrial, TrialOutcome};
pub use self::notice::{ImplausibleParts, Notice, counted};
pub use self::options::{ControlSocket, NoticeReceiver, SessionOptions, WatchdogProgram};
pub use self::replay::{first_view, replay};
pub use self::reply::{LearnedRanges, Reply, RequestError, SessionStatus};
pub use self::run_pipeline::run_pipeline;
pub use self::sensor_link::SensorLink;
pub use self::write_failures::WriteFailures;
pub use ademan_core::pipeline::CommandError;

/// Reason why a session could not start or ended early.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// Neither the setup nor the options name a source.
    #[error(
        "no source is given: name one with --source or in the setup, such as serial:/dev/ttyUSB0, or try typist:hello"
    )]
    NoSource,
    /// The source of the setup cannot be opened.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The source failed.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// The output failed.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// There is no control socket.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// The panic keys cannot be watched.
    #[error(transparent)]
    PanicKeys(#[from] PanicKeysError),
    /// The recording cannot be created.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// Angles or poses cannot be shared.
    #[error(transparent)]
    Share(#[from] ShareError),
    /// The operating system refused a thread.
    #[error("{}", advice::no_thread(.0))]
    Thread(#[from] io::Error),
}

/// Result of a session that has ended.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Statistics of all readings.
    pub stats: Stats,
    /// Time from the arrival of the bytes that complete a reading to the call of the output, in ns, for steps with events.
    /// A protocol may complete a reading only with bytes of the next packet.
    pub latency_ns: Histogram<u64>,
    /// Reason why the recording is incomplete.
    pub record_error: Option<RecordError>,
}

/// A session that has not run yet: everything that its thread needs.
pub struct Session {
    setup: Arc<LoadedSetup>,
    options: SessionOptions,
    commands: CommandReceiver,
    command_sender: CommandSender,
    notices: NoticeThread,
    write_failures: WriteFailures,
    snapshots: SnapshotSender,
    views: ViewPublisher,
    view_hub: ViewHub,
    /// Sends once the outputs are open.
    start_signal: Option<Sender<()>>,
    /// Removes the socket when it is dropped.
    control: Option<ControlServer>,
    /// Programs that the hand is shared with.
    share: ShareHub,
    /// Ends its thread when it is dropped.
    _focus: Option<FocusWatch>,
    /// Ends its thread when it is dropped.
    _panic_keys: Option<PanicKeysWatch>,
}

impl Session {
    /// Starts a session on threads of its own.
    ///
    /// Errors in the setup, the control socket, the servers and the panic keys are returned at once; errors of the source and the
    /// output by [`SessionHandle::join`].
    pub fn start(
        setup: LoadedSetup,
        mut options: SessionOptions,
    ) -> Result<SessionHandle, SessionError> {
        if options.source.is_none() && setup.setup.source.is_none() {
            return Err(SessionError::NoSource);
        }
        recordings::check_files(&options)?;
        if options.output.is_none() {
            output::check(&setup.setup.output, &setup.required_capabilities())?;
        }
        let (command_sender, mut commands) = command_channel();
        let setup = Arc::new(setup);
        let (hub, views) = start_view_hub(&setup, &options)?;
        let on_notice = show_in_views(options.on_notice.take(), hub.clone());
        let notices = NoticeThread::start(on_notice)?;
        let write_failures = WriteFailures::new(notices.sender());
        let socket_path = options.control_socket.path();
        let mut control = socket_path
            .as_deref()
            .map(ControlServer::bind)
            .transpose()?;
        let mut panic_keys = None;
        if options.use_panic_keys {
            let keys = panic_keys::parse_keys(&setup.setup.panic_keys)?;
            let pause_commands = command_sender.with_origin(CommandOrigin::PanicKeys);
            // A full queue means that the loop stands still; then the watchdog releases everything.
            let pause = move || _ = pause_commands.send(Command::Pause);
            panic_keys = Some(panic_keys::watch(&keys, pause)?);
        }
        let layout = Arc::new(setup.layout.clone());
        let rule = ActiveRule::new(&setup.setup.profiles_by_application);
        let focus = if options.follow_focus {
            focus::watch(rule.clone(), &command_sender, notices.sender())?
        } else {
            None
        };
        let share = ShareHub::start(&options.share, setup.arm.side(), layout)?;
        let notifier = control.as_ref().map(ControlServer::notifier);
        start_layout_manager(&setup, &options, &mut commands, &notices, notifier)?;
        if let Some(control) = &mut control {
            control.serve(ServerContext {
                profiles: ProfileInfo::all(&setup),
                commands: command_sender.clone(),
                views: Some(hub.clone()),
                write_failures: write_failures.clone(),
                rule,
            })?;
        }
        let is_recorded = options.record_to.is_some();
        let sensors = SensorLink::new(Arc::clone(&setup), command_sender.clone(), is_recorded);
        let is_lossless = options.lossless_snapshots;
        let (snapshots, snapshot_receiver) = SessionHandle::snapshot_channel();
        let session = Self {
            setup,
            options,
            commands,
            command_sender: command_sender.clone(),
            notices,
            write_failures,
            snapshots: SnapshotSender {
                sender: Some(snapshots),
                is_lossless,
            },
            views,
            view_hub: hub.clone(),
            start_signal: None,
            control,
            share,
            _focus: focus,
            _panic_keys: panic_keys,
        };
        SessionHandle::spawn(session, command_sender, snapshot_receiver, hub, sensors)
    }

    /// Runs the session to its end on the calling thread.
    fn run(mut self) -> Result<Summary, SessionError> {
        let outcome = self.run_loop();
        // Clients see the end before the last notices are printed.
        drop(self.control.take());
        self.notices.finish();
        outcome
    }

    fn run_loop(&mut self) -> Result<Summary, SessionError> {
        self.report_source_roles();
        let Some(mut source) = self.open_source()? else {
            return Ok(Summary {
                stats: Stats::default(),
                latency_ns: event_loop::new_histogram(),
                record_error: None,
            });
        };
        if let Some(headsets) = source.headsets() {
            let hub = self.view_hub.clone();
            headsets.observe(move |status| hub.show_headset(status));
        }
        let mut sink = self.open_output()?;
        let mut haptics = self.start_haptics(&mut *source)?;
        let is_live = source.is_live();
        if is_live && !self.options.lossless_snapshots {
            sink.drop_when_full();
        }
        // A replay may wait for its observers as long as nothing outside can stay pressed.
        let has_effect = sink.has_effect();
        let may_wait = !is_live && !has_effect;
        let failures = self.write_failures.clone();
        sink.on_log_failure(Box::new(move |error| failures.report(error.to_string())));
        let mut recordings = self.start_recordings(source.packet_period(), may_wait)?;
        if let Some(uri) = self.opened_uri().filter(|_| is_live) {
            self.report_status(Notice::Listening(uri.clone()));
        }
        let wants_socket = self.options.control_socket == ControlSocket::Default;
        // Not on a system without control sockets, where the user cannot add one.
        if cfg!(unix) && self.control.is_none() && wants_socket {
            self.report_status(Notice::NoControlSocket);
        }
        for target in self.share.targets() {
            self.report_status(Notice::Sharing(*target));
        }
        let (commands, notices) = (self.command_sender.clone(), self.notices.sender());
        let mut tray = Tray::start(&self.options, &self.setup, commands, notices)?;
        if let Some(signal) = self.start_signal.take() {
            // The owner may have dropped its end.
            let _ = signal.send(());
        }
        let notice_sender = self.notices.sender();
        let reports = self.options.report_status;
        let has_socket = self.control.is_some();
        let mut status = reports.then(|| StatusNotices::new(has_effect, has_socket, notice_sender));
        let mut notifier = self.control.as_ref().map(ControlServer::notifier);
        let mut observers: Vec<&mut dyn Observer> = vec![
            &mut haptics,
            &mut status,
            &mut notifier,
            &mut tray,
            &mut recordings,
            &mut self.views,
            &mut self.share,
            &mut self.snapshots,
        ];
        let mut pipeline = self.setup.pipeline();
        // Not for a replay, which would take a processor from other programs. The thread of the source, which detects a pulled
        // cable, inherits the priority.
        if is_live {
            priority::raise_thread_priority();
        }
        let ended = run_observed(
            source,
            &mut pipeline,
            &mut *sink,
            &self.commands,
            &mut observers,
        );
        // The gloves free the fingers before the recording is completed, which may take seconds.
        drop(haptics);
        let record_error = recordings.finish();
        let summary = ended.inspect_err(|_| self.report_incomplete(record_error.as_ref()))?;
        Ok(Summary {
            record_error,
            ..summary
        })
    }

    /// Reports the reason why a recording is incomplete, unless a notice has stated one. The error of a session takes the place of the
    /// summary that would.
    fn report_incomplete(&self, record_error: Option<&RecordError>) {
        if let Some(error) = record_error
            && !self.write_failures.reasons().contains(&error.to_string())
        {
            tracing::error!("{error}");
        }
    }

    /// Starts the feedback to the gloves.
    fn start_haptics(&self, source: &mut dyn Source) -> io::Result<SessionHaptics> {
        let kind = self.options.haptics;
        let other = self.setup.other_hand.iter();
        let sides = std::iter::once(self.setup.arm.side()).chain(other.map(|it| it.arm.side()));
        let haptics = SessionHaptics::start(kind, source, sides)?;
        if kind != Haptics::Off && haptics.is_empty() {
            self.notices.sender().send(Notice::NoHaptics(kind));
        }
        Ok(haptics)
    }

    fn open_output(&mut self) -> Result<Box<dyn Sink>, OutputError> {
        if let Some(sink) = self.options.output.take() {
            return Ok(sink);
        }
        let (names, part) = (&self.setup.setup.output, self.setup.setup.desktop_part);
        let required = self.setup.required_capabilities();
        let Some(watchdog) = self.options.watchdog.take() else {
            return output::open_for_session(names, &required, part, None);
        };
        let commands = self.command_sender.with_origin(CommandOrigin::Watchdog);
        let notices = self.notices.sender();
        let WatchdogProgram {
            program,
            arguments,
            on_lost,
        } = watchdog;
        let settings = WatchdogSettings {
            program,
            arguments,
            on_lost: Arc::new(move || {
                let _ = commands.send(on_lost);
                notices.send(Notice::WatchdogLost);
            }),
        };
        output::open_for_session(names, &required, part, Some(&settings))
    }

    /// Returns the source that this session opens itself.
    fn opened_uri(&self) -> Option<&SourceUri> {
        self.setup.setup.source.as_ref()
    }

    fn report_status(&self, notice: Notice) {
        if self.options.report_status {
            self.notices.sender().send(notice);
        }
    }
}

/// Starts the thread that passes views of a session to displays.
fn start_view_hub(
    setup: &LoadedSetup,
    options: &SessionOptions,
) -> io::Result<(ViewHub, ViewPublisher)> {
    let source = match &options.source {
        Some(source) => source.name().to_owned(),
        None => {
            let sources = setup.sources().filter_map(|(source, _)| source);
            let names: Vec<_> = sources.map(ToString::to_string).collect();
            names.join(", ")
        }
    };
    let names = SessionNames {
        session: match &options.name {
            Some(name) => name.clone(),
            None => without_folders(&setup.setup.layout),
        },
        process: Some(process::id()),
        profiles: setup.profile_names().map(str::to_owned).collect(),
        source,
        output: setup.setup.output.clone(),
    };
    ViewHub::start(names, Arc::new(setup.layout.clone()))
}

/// Returns the name of a file or layout without its folders.
fn without_folders(path: &str) -> String {
    let name = Path::new(path).file_name();
    name.map_or_else(|| path.to_owned(), |name| name.to_string_lossy().into())
}

/// Returns a receiver of notices that adds them to the views, and passes them to `on_notice`.
fn show_in_views(mut on_notice: Option<NoticeReceiver>, hub: ViewHub) -> NoticeReceiver {
    Box::new(move |notice: Notice| {
        hub.show_message(notice.to_string());
        if let Some(on_notice) = &mut on_notice {
            on_notice(notice);
        }
    })
}

fn start_layout_manager(
    setup: &Arc<LoadedSetup>,
    options: &SessionOptions,
    commands: &mut CommandReceiver,
    notices: &NoticeThread,
    mut notifier: Option<Notifier>,
) -> io::Result<()> {
    let layouts: Vec<_> = setup
        .layouts()
        .map(|layout| LayoutSource {
            path: setup.layout_path(layout).map(str::to_owned),
            layout: layout.clone(),
        })
        .collect();
    let policy = FilePolicy {
        watch: options.watch_layouts,
        is_recorded: options.record_to.is_some(),
    };
    let learned = setup.learned_file();
    let hands = setup.layout_feed.clone();
    let (setup, has_sink) = (Arc::clone(setup), options.output.is_some());
    let required = setup.required_capabilities();
    let build = move |profile, layout: &Layout| {
        if !has_sink {
            let needed = setup.capabilities_of(layout);
            output::check_layout_change(&setup.setup.output, &required, &needed)
                .map_err(|reason| format!("{}: not used, as {reason}", escape(&layout.file)))?;
        }
        setup
            .profile_instance(profile, layout)
            .map_err(|error| error.to_string())
    };
    let notices = notices.sender();
    let hand_notices = notices.clone();
    hands.set_receiver(move |message| hand_notices.send(Notice::SimulatedHand(message)));
    let link = commands.link_layouts().with_hands(hands);
    let report = move |report: LayoutReport| {
        if let Some(notifier) = &mut notifier
            && !matches!(report, LayoutReport::Command(_))
        {
            notifier.notify_reload(&report);
        }
        notices.send(Notice::Layout(report));
    };
    reload::start(layouts, learned, link, policy, build, report)
}
