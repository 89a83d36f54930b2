//! `ademan export`: the poses of a source as a BVH file.

use std::fs;
use std::path::{Path, PathBuf};

use ademan::command::Command;
use ademan::files;
use ademan::geometry::EulerOrder;
use ademan::hand::Side;
use ademan::message::escape_path;
use ademan::session::{SessionHandle, counted};
use ademan::trace::bvh::{self, PoseOptions};

use crate::complete;
use crate::failure::Failure;
use crate::setup_args::{SetupArgs, number_in};
use crate::traced_setup::TracedSetup;
use crate::{body, stats};

/// Write the poses of one or both hands to a BVH file for animation programs, without typing
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan export hand.bvh --source recording:session.mcap\n  ademan export hand.bvh --source serial:/dev/ttyUSB0 --rate-hz 60 --hand left"
)]
pub struct Args {
    /// BVH file to create; an existing file is not overwritten
    file: PathBuf,
    /// Frames per second
    #[arg(long, value_name = "HZ", default_value = "100", value_parser = rate)]
    rate_hz: f64,
    /// Hands to write
    #[arg(long, value_enum, default_value = "both")]
    hand: Hands,
    /// Order of the rotation channels; `zxy` is R = Rz · Rx · Ry
    #[arg(long, value_name = "ORDER", default_value = "zxy", value_parser = order)]
    order: EulerOrder,
    /// Setup file. Without it, a recording has its own setup, and another source setup.ron in the configuration folder, if it exists
    #[arg(long, add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
}

/// The hands of a file.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Hands {
    Left,
    Right,
    Both,
}

/// Number of poses from which the lengths of the bones come: a minute at 100 per second.
const MEASURED_POSES: usize = 6000;

pub fn run(args: Args) -> Result<(), Failure> {
    let traced = TracedSetup::open(&args.flags, args.setup.as_deref())?;
    let setup = traced.load(|_| {})?;
    let checked = files::check_absent(&args.file);
    checked
        .and_then(|()| files::check_destination(&args.file))
        .map_err(|error| Failure::cannot_create(&args.file, error))?;
    let session = traced.start(setup)?;
    let pose_options = PoseOptions {
        rate_hz: args.rate_hz,
        side: match args.hand {
            Hands::Left => Some(Side::Left),
            Hands::Right => Some(Side::Right),
            Hands::Both => None,
        },
        order: args.order,
        measured_poses: MEASURED_POSES,
    };
    let written = write(&session, &args.file, pose_options);
    session.commands().send(Command::Stop)?;
    let summary = session.join()?;
    let frames = written?;
    if frames > 0 {
        let count = counted(frames, "frame");
        say!("{count} written to {}", escape_path(&args.file));
    }
    stats::check_cut(&summary.stats)?;
    if frames == 0 {
        return Err(Failure::job(format!(
            "the source gave no pose of the hand, so {} is not written; look at its readings with `ademan trace readings`",
            escape_path(&args.file)
        )));
    }
    Ok(())
}

/// Writes the poses of a session to a file, which is created with the first one. Returns the number of frames.
fn write(session: &SessionHandle, path: &Path, options: PoseOptions) -> Result<u64, Failure> {
    let poses = session
        .snapshots()
        .iter()
        .filter_map(|snapshot| snapshot.pose);
    let mut poses = poses
        .filter(|pose| options.side.is_none_or(|side| side == pose.side))
        .skip_while(|pose| pose.known().next().is_none())
        .peekable();
    if poses.peek().is_none() {
        return Ok(0);
    }
    // Only its owner can read it: it shows what a hand typed.
    let file = files::create_private(path).map_err(|error| Failure::cannot_create(path, error))?;
    bvh::write_file(poses, file, options).map_err(|error| {
        let is_empty = fs::metadata(path).is_ok_and(|written| written.len() == 0);
        if is_empty {
            let _ = fs::remove_file(path);
        }
        let shown = escape_path(path);
        let kept = if is_empty {
            "nothing is written"
        } else {
            "it ends at the last whole second"
        };
        Failure::job(format!("cannot write {shown}: {error}; {kept}"))
    })
}

fn rate(text: &str) -> Result<f64, String> {
    number_in(text, 1.0, 1000.0, "frames per second")
}

fn order(text: &str) -> Result<EulerOrder, String> {
    let order = body::order(text)?;
    if order.is_proper() {
        Err("a joint of a BVH file turns about three different axes".to_owned())
    } else {
        Ok(order)
    }
}
