//! `ademan trace`: the results of a stage, one JSON object per line, or the jitter and lag of the hand.

use std::io::{self, BufWriter, Write};

use ademan::capture::Sample;
use ademan::capture::bvh::parent_of;
use ademan::command::Command;
use ademan::geometry::EulerOrder;
use ademan::hand::Joint;
use ademan::kinematics::HandPose;
use ademan::message::escape_json;
use ademan::session::SessionHandle;
use ademan::setup::{PositionSmoothingSetup, Setup, SmoothingSetup};
use ademan::snapshot::Snapshot;
use ademan::trace::Stage;
use ademan::trace::hand_signals::HandSignals;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use glam::{DMat3, DQuat};

use crate::body::{AnglesLine, body_of_landmarks, json, order};
use crate::failure::Failure;
use crate::sensor_tables::SensorTables;
use crate::setup_args::SetupArgs;
use crate::traced_setup::TracedSetup;
use crate::{complete, stats};

/// Print the results of a stage, one JSON object per line
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan trace angles --source serial:/dev/ttyUSB0 | head\n  ademan trace touches --source 'typist:hello' --layout qwerty-arc\n  ademan trace body --euler zxy --source 'udp:127.0.0.1:9000?protocol=body-landmarks'\n  ademan trace --stats --source 'file:hands.jsonl?protocol=hand-landmarks'"
)]
pub struct Args {
    /// Stage, or `body`: the angles of the eleven joints of a body, from its T pose, as `ademan body angles` prints them
    #[arg(value_parser = traced(), required_unless_present = "stats")]
    stage: Option<Traced>,
    /// Order of the Euler angles of `body`, `zxy` by default; with `angles`, also print the rotation of each joint relative to its parent
    #[arg(long, value_name = "ORDER", value_parser = order, conflicts_with = "stats")]
    euler: Option<EulerOrder>,
    /// Print the jitter at rest, the lag of the filters and the parameters of each bend sensor at the end, in place of the results
    #[arg(long, conflicts_with = "stage")]
    stats: bool,
    /// Print the statistics as one JSON object
    #[arg(long, requires = "stats")]
    json: bool,
    /// Setup file. Without it, a recording has its own setup, and another source setup.ron in the configuration folder, if it exists
    #[arg(long, add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
}

/// The lines that are printed.
#[derive(Clone, Copy)]
enum Traced {
    Stage(Stage),
    Body,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let has_euler = matches!(
        args.stage,
        Some(Traced::Body | Traced::Stage(Stage::Angles))
    );
    if args.euler.is_some() && !has_euler {
        return Err(Failure::wrong_use("`--euler` is for `angles` and `body`"));
    }
    let traced = TracedSetup::open(&args.flags, args.setup.as_deref())?;
    let signals = if args.stats {
        Some(HandSignals::new(traced.load(without_filters)?.pipeline()))
    } else {
        None
    };
    let as_json = args.json;
    let setup = traced.load(|_| {})?;
    let sensors = SensorTables::new(&setup);
    let session = traced.start(setup)?;
    let printed = match (args.stage, signals) {
        (Some(stage), _) => print(&session, stage, args.euler),
        (None, Some(signals)) => print_stats(&session, signals, sensors, as_json),
        (None, None) => Ok(true),
    };
    session.commands().send(Command::Stop)?;
    let summary = session.join()?;
    if printed? {
        stats::check_cut(&summary.stats)
    } else {
        stats::report(summary)
    }
}

fn without_filters(setup: &mut Setup) {
    setup.smoothing = SmoothingSetup::Off;
    setup.position_smoothing = PositionSmoothingSetup::Off;
}

/// Name of the angles of a body.
const BODY: &str = "body";

/// Bytes of a write to the standard output while more results are waiting: about 40 poses.
const WRITE_BYTES: usize = 1 << 17;

/// Prints all results of a stage, without delay if no more are waiting. Returns `false` if there are none.
fn print(session: &SessionHandle, traced: Traced, euler: Option<EulerOrder>) -> io::Result<bool> {
    let mut is_any = false;
    let mut out = BufWriter::with_capacity(WRITE_BYTES, io::stdout().lock());
    let mut buffer = Vec::new();
    let mut write = |json: &[u8]| {
        is_any = true;
        // It may contain names of a layout.
        let json = String::from_utf8_lossy(json);
        out.write_all(escape_json(&json).as_bytes())?;
        out.write_all(b"\n")?;
        if session.snapshots().is_empty() {
            out.flush()
        } else {
            Ok(())
        }
    };
    for snapshot in session.snapshots() {
        match (traced, euler) {
            (Traced::Body, _) => {
                let order = euler.unwrap_or(EulerOrder::Zxy);
                if let Some(line) = body_line(&snapshot, order) {
                    write(line.as_bytes())?;
                }
            }
            (Traced::Stage(stage), Some(order)) => {
                stage.for_each_json(&snapshot, &mut buffer, |_, json| {
                    let rotations = snapshot.pose.as_ref().map(|pose| rotations(pose, order));
                    let open = json.strip_suffix(b"}").unwrap_or(json);
                    let added = rotations.unwrap_or_default();
                    write(&[open, added.as_bytes(), b"}"].concat())
                })?;
            }
            (Traced::Stage(stage), None) => {
                stage.for_each_json(&snapshot, &mut buffer, |_, json| write(json))?;
            }
        }
    }
    out.flush()?;
    Ok(is_any)
}

/// Returns the line of a body; `None` if the reading has none, or one that does not determine all joints.
fn body_line(snapshot: &Snapshot, order: EulerOrder) -> Option<String> {
    let reading = snapshot.reading.as_ref()?;
    let Sample::Body(landmarks) = &reading.sample else {
        return None;
    };
    let body = body_of_landmarks(landmarks);
    let line = AnglesLine::new(Some(reading.time.0), order, &body).ok()?;
    Some(json(&line))
}

/// Returns the fields of the rotation of each joint relative to its parent, in degrees; for the shoulder, relative to
/// the world.
fn rotations(pose: &HandPose, order: EulerOrder) -> String {
    let known: Vec<Joint> = pose.known().map(|(joint, _)| joint).collect();
    let rotation = |joint: Joint| {
        let rotation = pose.get(joint).map(|pose| pose.rotation.as_dquat());
        rotation.unwrap_or_default()
    };
    let mut angles = serde_json::Map::new();
    for &joint in &known {
        let before = parent_of(joint, &known).map_or(DQuat::IDENTITY, rotation);
        let turn = DMat3::from_quat((before.inverse() * rotation(joint)).normalize());
        if let Some(turn) = order.angles(&turn) {
            let degrees = turn.map(f64::to_degrees);
            angles.insert(joint.name().to_owned(), degrees.to_vec().into());
        }
    }
    format!(
        ",\"order\":\"{order}\",\"euler_deg\":{}",
        serde_json::Value::Object(angles)
    )
}

/// Prints jitter and lag of each hand, and the parameters of its sensors, at the end of the source.
fn print_stats(
    session: &SessionHandle,
    mut signals: HandSignals,
    mut sensors: SensorTables,
    as_json: bool,
) -> io::Result<bool> {
    for snapshot in session.snapshots() {
        signals.update(&snapshot);
        if let Some(reading) = &snapshot.reading {
            sensors.push(reading);
        }
    }
    let mut out = io::stdout().lock();
    if as_json {
        let json = serde_json::json!({"hands": signals.to_json(), "sensors": sensors.to_json()});
        writeln!(out, "{}", escape_json(&json.to_string()))?;
    } else {
        write!(out, "{signals}{sensors}")?
    }
    Ok(true)
}

fn traced() -> impl TypedValueParser<Value = Traced> {
    let stages = Stage::ALL.iter().map(|stage| stage.name());
    PossibleValuesParser::new(stages.chain([BODY])).map(|name| match name.as_str() {
        BODY => Traced::Body,
        stage => {
            let stage = stage.parse();
            Traced::Stage(stage.expect("the parser accepts only names of stages"))
        }
    })
}
