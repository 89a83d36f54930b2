//! `ademan studio`: a session in a window.

#[cfg(feature = "studio")]
mod attach;
#[cfg(feature = "studio")]
mod first;
#[cfg(all(feature = "studio", feature = "tls"))]
mod headset;
#[cfg(feature = "studio")]
mod mesa;
#[cfg(feature = "studio")]
mod next_session;
#[cfg(feature = "studio")]
mod sessions;
#[cfg(feature = "studio")]
mod source;
#[cfg(feature = "studio")]
mod window;
#[cfg(feature = "studio")]
use self::window::open;

#[cfg(all(feature = "studio", feature = "tls"))]
use self::headset::link as headset_link;

/// Returns no link: without TLS no source waits for headsets.
#[cfg(all(feature = "studio", not(feature = "tls")))]
fn headset_link(
    _: &ademan::setup::LoadedSetup,
) -> Result<Option<ademan::studio::headset::HeadsetLink>, Failure> {
    Ok(None)
}

#[cfg(not(feature = "studio"))]
mod unsupported;
#[cfg(not(feature = "studio"))]
use self::unsupported::open;

use std::path::PathBuf;

use ademan::capture::SourceUri;
use ademan::pipeline::SourceRole;

use crate::complete;
use crate::failure::Failure;
use crate::root_args::RootArgs;
use crate::setup_args::role;
use crate::source_value::{self, SourceValue};

/// Watch a hand, its boards and its sensors in a window
#[derive(Clone, clap::Args)]
#[command(
    after_help = "Examples:\n  ademan studio\n  ademan studio --layout media\n  ademan studio my-setup.ron\n  ademan studio --source 'serial:/dev/ttyUSB0?baud=9600' --glove mine\n  ademan studio --recording session.mcap\n  ademan studio --overlay my-setup.ron\n  ademan studio --attach\n\nWithout arguments it shows the session of `ademan run`, if one runs, and sends commands to it; closing the window leaves that session running. Otherwise it opens a session of its own. Without a source, a simulated hand plays the layout in a loop; the first start without settings asks for the source, the hand and the layout. Nothing is sent to other programs unless a setup file names an output, or one is chosen in the window. Closing the window releases everything and ends the session."
)]
pub struct Args {
    /// Setup file (see `ademan setup new`); the flags override it. setup.ron in the configuration folder is used only if it is
    /// named here
    #[arg(add = complete::setup())]
    setup: Option<String>,
    #[arg(long, value_name = "URI", value_parser = SourceValue, add = complete::source(), help = "Source of readings", long_help = source_value::help())]
    source: Option<SourceUri>,
    /// Events that the source may cause: pointer, keys or both. The default is both, and pointer for a source on the
    /// network
    #[arg(long, value_parser = role(), conflicts_with = "recording")]
    role: Option<SourceRole>,
    /// Glove: the name of one that comes with the program, or a file
    #[arg(long, add = complete::glove())]
    glove: Option<String>,
    /// Person: the name of one that comes with the program (see `ademan person list`), or a file
    #[arg(long, value_name = "FILE", add = complete::person())]
    person: Option<String>,
    /// Layout: the name of one that comes with the program (see `ademan layout list`), or a file
    #[arg(long, add = complete::layout())]
    layout: Option<String>,
    /// Recording to show in place of a session: forwards, backwards and step by step
    #[arg(long, value_name = "FILE", conflicts_with_all = ["source", "setup", "person"], add = complete::recording())]
    recording: Option<PathBuf>,
    /// Show the session of another program through its control socket. The default PATH is the socket of `ademan run` without --control.
    /// `off` opens a session of its own even if another one runs
    #[arg(long, value_name = "PATH", num_args = 0..=1, conflicts_with_all = ["source", "role", "setup", "glove", "person", "layout", "recording", "overlay"])]
    attach: Option<Option<PathBuf>>,
    /// Show the boards and fingertips over other programs, above all windows; clicks pass through
    #[arg(long, conflicts_with = "recording")]
    overlay: bool,
    /// Move the overlay and choose its opacity, typing into no program; both are kept
    #[arg(long, requires = "overlay")]
    place: bool,
    #[command(flatten)]
    root: RootArgs,
}

impl Args {
    /// Returns `true` if nothing says what to show.
    #[cfg(feature = "studio")]
    fn is_plain(&self) -> bool {
        let names = [&self.setup, &self.glove, &self.layout, &self.person];
        names.iter().all(|name| name.is_none())
            && self.source.is_none()
            && self.role.is_none()
            && self.recording.is_none()
            && self.attach.is_none()
            && !self.overlay
    }
}

pub fn run(args: Args) -> Result<(), Failure> {
    open(args)
}
