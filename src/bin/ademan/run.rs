//! `ademan run`: a session that types.

use std::path::{Path, PathBuf};
use std::thread;

use ademan::capture::Haptics;
use ademan::command::Command;
use ademan::message::escape;
use ademan::session::{ControlSocket, SessionOptions};
use ademan::setup::LoadedSetup;
use ademan::share::ShareTarget;
use ademan::{output, priority};

use crate::failure::Failure;
use crate::output_list::OutputList;
use crate::root_args::RootArgs;
use crate::setup_args::{SetupArgs, named};
use crate::view::{self, LiveView, ViewKind, Views};
use crate::{
    complete, messages, pause_signals, recording_size, release_keys, session, sound, stats,
    watchdog,
};

/// The output without any other.
const TRANSCRIPT: &str = "transcript";

/// Type with a glove
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan run --source typist:hello\n  ademan run --source 'serial:/dev/ttyUSB0?baud=9600' --output desktop\n  ademan run my-setup.ron --record today.mcap\n  ademan run my-setup.ron --share web:127.0.0.1:8080\n  ademan run my-setup.ron --wait\n  ademan run my-setup.ron --view log\n\nThe session starts paused. It is armed after the hand has been clear of every key for 300 ms. A layout file is activated when it is saved. Ctrl-C releases everything and ends the session."
)]
pub struct Args {
    /// Setup file (see `ademan setup new`); the flags override it. The default is setup.ron in the configuration folder, if it
    /// exists: ~/.config/ademan on Linux
    #[arg(add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
    /// Outputs, separated by commas. Each event goes to the first one that supports it, and to all transcripts
    #[arg(long, value_name = "OUTPUTS", add = complete::outputs(), value_parser = OutputList)]
    output: Option<String>,
    /// Record the session to this file. It contains everything that is typed
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Record the poses of the hands to this BVH file, for animation programs. They show what is typed
    #[arg(long, value_name = "FILE")]
    record_bvh: Option<PathBuf>,
    /// Share the hand with programs on this machine: a page for a browser with `web:127.0.0.1:8080`; `json`, `ws`,
    /// `text-line`, `angles`, `pose`, `vmc` or `opentrack` in the same way. With other machines: `text-line+tls:192.168.1.7:10002`
    /// (see `ademan token`) or `zenoh:KEY`. May be given several times
    #[arg(long, value_name = "FORMAT:ADDRESS:PORT")]
    share: Vec<ShareTarget>,
    /// Show an icon with the state and a menu in the tray of the desktop (Linux; needs a build with `--features tray`)
    #[arg(long)]
    tray: bool,
    /// Show pauses and a lost hand or source as notifications of the desktop (Linux; needs a build with `--features tray`)
    #[arg(long)]
    notify: bool,
    /// Play a click for each press, `--sound=0.8` at 0.8 of the full volume (Linux; needs a build with `--features sound`)
    #[arg(long, value_name = "VOLUME", num_args = 0..=1, require_equals = true, default_missing_value = sound::DEFAULT, value_parser = sound::volume)]
    sound: Option<f32>,
    /// Feedback to a LucidGloves glove: hold a finger that presses (force), vibrate on touch and press (pulse), both or off
    #[arg(long, value_name = "KIND", value_parser = named(Haptics::ALL, Haptics::name))]
    haptics: Option<Haptics>,
    /// Wait for a device that is not connected yet
    #[arg(long)]
    wait: bool,
    /// Type from the first reading on, without waiting until the hand is clear of every key
    #[arg(long)]
    armed: bool,
    #[command(flatten)]
    root: RootArgs,
    /// Control socket for `ademan ctl` and `ademan watch`, or `off`. The default is in $XDG_RUNTIME_DIR
    #[arg(long, value_name = "PATH|off")]
    control: Option<PathBuf>,
    /// Display. The default is `board` if standard output is a terminal, and `log` otherwise
    #[arg(long, value_name = "KIND")]
    view: Option<ViewKind>,
}

impl Args {
    /// Sets the source if none is named, which must be standard input, and the layout unless a layout or a setup is named.
    pub fn with_defaults(mut self, source: &str, layout: &str) -> Result<Self, Failure> {
        let layout = self.setup.is_none().then_some(layout);
        self.flags.default_to(source, layout)?;
        Ok(self)
    }
}

pub fn run(args: Args) -> Result<(), Failure> {
    args.root.check(true)?;
    let mut setup = args.flags.read_setup(args.setup.as_deref())?;
    let is_output_given = args.output.is_some();
    setup.output = args.output.unwrap_or(setup.output);
    let view = choose_view(args.view, &setup.output, is_output_given)?;
    let is_replaced = view == ViewKind::Board && setup.output == TRANSCRIPT;
    if is_replaced {
        setup.output = "none".into();
    }
    setup.arm_immediately |= args.armed;
    setup.share.extend(args.share);
    setup.use_token_roles()?;
    let control_socket = match &args.control {
        Some(off) if off.as_os_str() == "off" => ControlSocket::Off,
        Some(path) => ControlSocket::Path(path.clone()),
        None => ControlSocket::Default,
    };
    let record_to = args.record;
    session::prepare()?;
    let setup_file = args.setup.as_deref().map(Path::new);
    let setup_file = setup_file.and_then(Path::file_name);
    let options = SessionOptions {
        name: setup_file.map(|file| file.to_string_lossy().into_owned()),
        speed: Some(1.0),
        wait_for_source: args.wait,
        watchdog: Some(watchdog::program(Command::Pause)?),
        record_to: record_to.clone(),
        record_bvh_to: args.record_bvh,
        share: setup.share.clone(),
        haptics: args.haptics.unwrap_or(setup.haptics),
        control_socket,
        watch_layouts: true,
        use_panic_keys: true,
        follow_focus: true,
        tray: args.tray || setup.tray,
        notify: args.notify || setup.notify,
        report_status: true,
        on_notice: (view != ViewKind::None).then(session::print_notices),
        ..SessionOptions::default()
    };
    let abandoned = output::release_abandoned_keys();
    release_keys::report(&abandoned);
    for reason in &abandoned.failed {
        complain!(
            "keys of a killed run may still be pressed: {reason}; `ademan release-keys` tries again"
        );
    }
    let setup = setup.load_files()?;
    for layout in setup.layouts() {
        if let Some(reason) = setup.unmeasured_body_point(layout) {
            let file = escape(&layout.file);
            return Err(Failure::wrong_use(format!("{file}: {reason}")));
        }
    }
    if view == ViewKind::Board {
        messages::hold();
        if is_replaced {
            say!("shown here only: add `--output desktop` to type into other programs");
        }
    }
    let checked = setup.clone();
    let growth = recording_size::Growth::new(&setup);
    let session = session::start(setup, options)?;
    if let Some(volume) = args.sound {
        sound::start(&session, volume)?;
    }
    report_reach(checked)?;
    pause_signals::install(session.commands().clone())?;
    let view =
        (view == ViewKind::Board).then(|| LiveView::open(Views::Session(session.add_viewer())));
    // The system prefers this thread for the delivery of signals. The view does not inherit its priority.
    priority::raise_thread_priority();
    if let Some(path) = &record_to {
        recording_size::announce(&session, path, growth);
    }
    let ended = session.join();
    drop(view);
    stats::report(ended?)
}

/// Returns what to show. A picture and a transcript cannot share a terminal: the picture replaces a transcript that is
/// only the default output.
fn choose_view(
    asked: Option<ViewKind>,
    output: &str,
    is_output_given: bool,
) -> Result<ViewKind, Failure> {
    let is_replaceable = output == TRANSCRIPT && !is_output_given;
    let would_mix = output::uses_stdout(output) && !is_replaceable;
    match asked {
        Some(ViewKind::Board) if !view::is_possible() => Err(Failure::wrong_use(
            "cannot draw a board: standard output is not a terminal in the foreground that can show a picture; use `--view log`",
        )),
        Some(ViewKind::Board) if would_mix => Err(Failure::wrong_use(
            "`--view board` and a transcript on standard output would mix; use `--view log`, or write the transcript to a file: `--output transcript:FILE`",
        )),
        Some(asked) => Ok(asked),
        None if view::is_possible() && !would_mix => Ok(ViewKind::Board),
        None => Ok(ViewKind::Log),
    }
}

/// Reports what the source of the setup does not measure, and the keys that its hand cannot reach, on a thread of its own: a large
/// layout takes seconds.
fn report_reach(setup: LoadedSetup) -> Result<(), Failure> {
    let report = move || {
        for layout in setup.layouts() {
            if let Some(missing) = setup.missing_other_hand(layout) {
                say!("{}: {missing}", escape(&layout.file));
            }
            if let Some(unmeasured) = setup.unmeasured_elbow(layout) {
                say!("{}: {unmeasured}", escape(&layout.file));
            }
            if let Some(report) = setup.reach_report(layout) {
                say!("{}: {report}", escape(&layout.file));
            }
        }
    };
    let thread = thread::Builder::new().name("reach".into()).spawn(report);
    thread.map(drop).map_err(Failure::no_thread)
}
