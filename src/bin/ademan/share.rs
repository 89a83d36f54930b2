//! `ademan share`: a session that shares the hand and types nothing.

use ademan::capture::{Hc11Format, Source};
use ademan::session::{Notice, NoticeReceiver, SessionOptions};
use ademan::share::ShareTarget;

use crate::demo::looping;
use crate::failure::Failure;
use crate::setup_args::SetupArgs;
use crate::{complete, messages, session, stats};

/// The page of `--web`.
const PAGE: &str = "web:127.0.0.1:8080";

/// Show the hand in a browser, or share it with other programs, without typing
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan share --web\n  ademan share --web --source 'serial:/dev/ttyUSB0?baud=9600'\n  ademan share web:127.0.0.1:8081 vmc:127.0.0.1:39539 --source typist:hello\n\nNothing is sent to an output. Without a source, a simulated hand types. `ademan run --share` types and shares."
)]
pub struct Args {
    /// Formats and addresses, as of `ademan run --share` (docs/sharing.md): `json`, `ws`, `web`, `text-line`, `angles`, `pose`,
    /// `vmc`, `opentrack`. Without any, the page of --web
    #[arg(value_name = "FORMAT:ADDRESS:PORT")]
    targets: Vec<ShareTarget>,
    /// Share a page that shows the hand over its boards, at http://127.0.0.1:8080/
    #[arg(long)]
    web: bool,
    /// Setup file; the flags override it. The default is setup.ron in the configuration folder, if it exists
    #[arg(long, value_name = "FILE", add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
    /// Wait for a device that is not connected yet
    #[arg(long)]
    wait: bool,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let mut setup = args.flags.read_setup(args.setup.as_deref())?;
    setup.output = "none".into();
    let mut share = args.targets;
    share.append(&mut setup.share);
    let page = PAGE.parse().expect("a format and an address");
    if share.is_empty() || args.web && !share.contains(&page) {
        share.push(page);
    }
    let setup = setup.load_files()?;
    let source = match &setup.setup.source {
        Some(_) => None,
        None => {
            let hand = looping::hand(&setup, &Hc11Format::default())?;
            Some(Box::new(hand) as Box<dyn Source>)
        }
    };
    session::prepare()?;
    if source.is_some() {
        say!("no source is given: a simulated hand types; `--source` shares yours, Ctrl-C ends");
    }
    let options = SessionOptions {
        source,
        speed: Some(1.0),
        wait_for_source: args.wait,
        share,
        watch_layouts: true,
        report_status: true,
        on_notice: Some(print_notices()),
        ..SessionOptions::default()
    };
    stats::report(session::start(setup, options)?.join()?)
}

/// Returns a receiver that prints notices but those about typing.
fn print_notices() -> NoticeReceiver {
    Box::new(|notice| {
        let is_of_typing = matches!(
            notice,
            Notice::Armed { .. }
                | Notice::Disarmed
                | Notice::BentFingers(_)
                | Notice::AwaitingHand
                | Notice::Unreached(..)
        );
        if !is_of_typing {
            messages::print_notice(&notice);
        }
    })
}
