//! `ademan bridge blender`: an add-on that moves bones and properties in Blender, its table of mappings, and its channels.

use ademan::estimate::JointLimits;
use ademan::hand::{Dof, Joint};

use crate::arm::OutputArgs;
use crate::failure::Failure;

macro_rules! part {
    ($name:literal) => {
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/examples/bridges/blender/",
            $name
        ))
    };
}

/// The parts of the add-on, which Blender installs as one file. The table is between two of them.
const RECEIVER: &str = part!("receiver.py");
const HAND: &str = part!("hand.py");
const TABLE: &str = part!("table.py");
const PANEL: &str = part!("panel.py");

/// The table of mappings with which the add-on starts.
const STARTING_TABLE: &str = part!("starting_table.json");

/// Print an add-on for Blender that moves bones and properties by a shared hand and bakes key frames
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan bridge blender --output ademan_blender.py\n  ademan bridge blender --table --output hands.json\n  ademan bridge blender --channels\n  ademan run --source serial:/dev/ttyUSB0 --share pose:127.0.0.1:10003\n\nIn Blender: Edit > Preferences > Add-ons > Install. The panel is in the sidebar (N) of the 3D view."
)]
pub struct Args {
    /// Print the table of mappings with which the add-on starts, as JSON, to edit and to name in the panel
    #[arg(long, conflicts_with = "channels")]
    table: bool,
    /// Print the channels that a table may name, with their ranges and units
    #[arg(long)]
    channels: bool,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let text = match (args.table, args.channels) {
        (true, _) => STARTING_TABLE.to_owned(),
        (_, true) => channels(),
        _ => add_on(),
    };
    args.output.write(|out| Ok(out.write_all(text.as_bytes())?))
}

/// Returns the add-on as one file.
fn add_on() -> String {
    let table = format!("STARTING_TABLE = r\"\"\"{STARTING_TABLE}\"\"\"\n");
    [RECEIVER, &table, HAND, TABLE, PANEL].join("\n\n")
}

/// Returns the table of the channels.
fn channels() -> String {
    let limits = JointLimits::human();
    let row = |[channel, from, to, unit, meaning]: [&str; 5]| {
        format!("{channel:<24} {from:>8} {to:>8} {unit:<5} {meaning}\n")
    };
    let mut text = row(["channel", "from", "to", "unit", "meaning"]);
    for &dof in Dof::ALL {
        let Some(meaning) = meaning(dof) else {
            continue;
        };
        let (low, high) = limits.range(dof);
        let (low, high) = (format!("{low:.3}"), format!("{high:.3}"));
        text += &row([dof.name(), &low, &high, "rad", meaning]);
    }
    text += &row(["JOINT.x", "", "", "m", "position, to the right"]);
    text += &row(["JOINT.y", "", "", "m", "position, forward"]);
    text += &row(["JOINT.z", "", "", "m", "position, up"]);
    for (channel, range, axis) in [
        ("JOINT.rx", "3.142", "the first angle"),
        ("JOINT.ry", "1.571", "the second angle"),
        ("JOINT.rz", "3.142", "the third angle"),
    ] {
        let meaning = format!(
            "{axis} of the turn in Blender's order XYZ; X along the bone, Y to the palm side"
        );
        text += &row([channel, &format!("-{range}"), range, "rad", &meaning]);
    }
    text += "\nJOINT is one of:\n";
    for joint in Joint::ALL {
        text += &format!("  {joint}\n");
    }
    text
}

/// Returns what an angle measures; `None` if positions and orientations of joints do not show it.
fn meaning(dof: Dof) -> Option<&'static str> {
    match dof {
        Dof::ShoulderZ | Dof::ShoulderY | Dof::ShoulderX | Dof::ForearmSecondBone => None,
        Dof::ElbowFlexion => Some("0 if the arm is straight"),
        Dof::ForearmSupination => Some("0 with the palm down, positive when it turns up"),
        Dof::WristDeviation => Some("positive to the little finger"),
        Dof::WristFlexion => Some("positive to the palm"),
        _ if dof.name().ends_with("abduction") => Some("sideways, positive to the little finger"),
        _ => Some("bending, positive to the palm"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_starting_table_is_in_the_add_on_and_names_bones_once() {
        assert!(add_on().contains(STARTING_TABLE));
        let table: serde_json::Value = serde_json::from_str(STARTING_TABLE).expect("JSON");
        let bones = table["bones"].as_array().expect("a list");
        let targets: std::collections::BTreeSet<_> = bones
            .iter()
            .map(|row| row["target"].as_str().expect("a text"))
            .collect();
        assert_eq!(targets.len(), bones.len());
        for row in bones {
            let joint = row["joint"].as_str().expect("a text");
            joint.parse::<Joint>().expect("a joint");
        }
        let attach = table["attach"].as_array().expect("a list");
        for row in attach {
            let channel = row["channel"].as_str().expect("a text");
            let name = channel.split('.').next().expect("a name");
            let is_known = if name.len() == channel.len() {
                channel
                    .parse::<Dof>()
                    .is_ok_and(|dof| meaning(dof).is_some())
            } else {
                name.parse::<Joint>().is_ok()
            };
            assert!(is_known, "{channel}");
        }
    }
}
