//! `ademan person`: creates, shows and explains files about a person.

use std::io::{self, Write};
use std::path::PathBuf;

use ademan::document::{Document, FileKind, quote};
use ademan::files::OpenDocument;
use ademan::hand::{Finger, FingerSet, Side};
use ademan::kinematics::{BoneLengths, HandReach};
use ademan::layout::{HandUse, Motion, Person, person_field_tables};
use ademan::message::escape;

use crate::failure::Failure;
use crate::list::{ListArgs, Row, documents, invalid};
use crate::setup_args::{number_in, one_of};
use crate::{complete, field_list, new_file};

/// Create and show persons: the size of the hands, and how a simulated person moves them
#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  ademan person new me --hand left --length 172\n  ademan person show me.ron\n  ademan demo --person adult\n  ademan layout check qwerty-flat --person me.ron"
)]
pub enum Args {
    /// Create a person file
    #[command(
        after_help = "Examples:\n  ademan person new me --hand left --length 172\n  ademan person new me --from adult"
    )]
    New {
        /// File to create (.ron is added), or `-` for the standard output; an existing file is not overwritten
        #[arg(default_value = "person")]
        file: PathBuf,
        /// The hand that types, or the first of two
        #[arg(long, value_name = "SIDE", default_value = "right", value_parser = one_of::<Side>(Side::NAMES))]
        hand: Side,
        /// Hand length in mm, from the wrist crease to the end of the middle finger
        #[arg(long, value_name = "MM", value_parser = length)]
        length: Option<f64>,
        /// Person to copy: the name of one that comes with the program, or a file
        #[arg(long, add = complete::person(), conflicts_with_all = ["hand", "length"])]
        from: Option<String>,
    },
    /// Show a person, with the lengths of the bones and the reach
    #[command(after_help = "Example: ademan person show left-small")]
    Show {
        /// A person file, or the name of a person who comes with the program
        #[arg(add = complete::person())]
        file: String,
    },
    /// List the persons who come with the program, and the ones in the configuration folder
    #[command(after_help = "Example: ademan person list")]
    List(ListArgs),
    /// List the fields of person files, with units, ranges, defaults and sources
    #[command(after_help = "Examples:\n  ademan person fields\n  ademan person fields tremor")]
    Fields(field_list::Args),
}

pub fn run(args: Args) -> Result<(), Failure> {
    match args {
        Args::New {
            file,
            hand,
            length,
            from,
        } => new(&file, hand, length, from.as_deref()),
        Args::Show { file } => show(&file),
        Args::List(args) => list(&args),
        Args::Fields(args) => {
            field_list::print_tables(&args, person_field_tables(), "ademan person fields")
        }
    }
}

fn length(text: &str) -> Result<f64, String> {
    number_in(text, 100.0, 300.0, "mm")
}

/// Loads a person: a shipped name or a file.
pub fn load(name: &str) -> Result<Person, Failure> {
    Ok(Person::parse(&Document::open_kind(
        FileKind::Person,
        name,
    )?)?)
}

fn new(
    file: &std::path::Path,
    hand: Side,
    length: Option<f64>,
    from: Option<&str>,
) -> Result<(), Failure> {
    let path = new_file::with_extension(file, "ron");
    let next = "ademan person show FILE && ademan demo --person FILE";
    let Some(from) = from else {
        let text = text(&new_file::name_of(&path), hand, length);
        return new_file::create(&path, &text, "a person", next);
    };
    let document = Document::open_kind(FileKind::Person, from)?;
    let person = Person::parse(&document)?;
    let text = new_file::renamed(&document.text, &person.name, &path);
    let origin = format!("a copy of {}", document.file);
    new_file::create(&path, &text, &origin, next)
}

/// Returns a person file with these values, and the further fields as comments.
fn text(name: &str, hand: Side, length: Option<f64>) -> String {
    let name = match name {
        "-" => quote("person"),
        name => quote(name),
    };
    let length = match length {
        Some(millimetres) => format!("    hand_length_mm: {millimetres},"),
        None => "    // From the wrist crease to the end of the middle finger; the other lengths follow from it.\n    // hand_length_mm: 183,".to_owned(),
    };
    format!(
        "// A person. `ademan person fields` lists all fields with units, ranges, defaults and sources. Every field is optional.\n\
         Person(\n    name: {name},\n    side: \"{hand}\",\n{length}\n    \
         // Elbow to wrist crease. Without it, average proportions apply.\n    \
         // forearm_length_mm: 247,\n\n    \
         // The simulated person, as in `ademan demo`. Without these lines, it makes no errors.\n    \
         // fingers: [\"thumb\", \"index\", \"middle\", \"ring\", \"little\"],\n    \
         // speed: 0.8,\n    \
         // tremor: (amplitude_mm: 3, frequency_hz: 5),\n    \
         // scatter: (x_mm: 1.3, y_mm: 1.15),\n)\n"
    )
}

fn list(args: &ListArgs) -> Result<(), Failure> {
    let rows = documents(FileKind::Person).map(|(name, document)| {
        let person = document.and_then(|document| Person::parse(&document));
        Row {
            summary: person.map_or_else(|error| invalid(&error), |person| summary(&person)),
            name,
            example: None,
        }
    });
    args.print(&rows.collect::<Vec<Row>>())
}

/// Returns the hands and fingers of a person in one line.
fn summary(person: &Person) -> String {
    let side = person.side.unwrap_or(Side::Right);
    let hands = match person.hands {
        HandUse::Both => format!("{side} hand first"),
        HandUse::One => format!("only the {side} hand"),
    };
    let length = person.bones.map_or(String::new(), |bones| {
        format!(", hand of {:.0} mm", bones.hand * 1e3)
    });
    format!("{hands}{length}, {}", pressing(person.fingers))
}

fn pressing(fingers: FingerSet) -> String {
    if fingers.is_empty() {
        "presses with the finger that the layout needs".to_owned()
    } else {
        format!("presses with {}", names(fingers))
    }
}

fn names(fingers: FingerSet) -> String {
    let named = Finger::ALL
        .iter()
        .filter(|finger| fingers.contains(**finger));
    let named: Vec<&str> = named.map(|finger| finger.name()).collect();
    named.join(", ")
}

fn show(file: &str) -> Result<(), Failure> {
    let person = load(file)?;
    let mut lines = vec![
        if person.name.is_empty() {
            escape(file).into_owned()
        } else {
            escape(&person.name).into_owned()
        },
        format!("  hands     {}", summary(&person)),
    ];
    if !person.resting.is_empty() {
        lines.push(format!("  resting   {}", names(person.resting)));
    }
    match &person.bones {
        Some(bones) => {
            lines.extend(bone_lines(bones));
            let arm = person.arm(person.side.unwrap_or(Side::Right));
            let arm = arm.and_then(Result::ok);
            lines.extend(
                arm.and_then(|arm| arm.reach())
                    .map(|reach| reach_line(&reach)),
            );
        }
        None => lines.push("  bones     from the arm model `unam`: the file has no length".into()),
    }
    lines.extend(motion_lines(&person.motion));
    Ok(writeln!(io::stdout(), "{}", lines.join("\n"))?)
}

fn bone_lines(bones: &BoneLengths) -> Vec<String> {
    let mm = |metres: f64| format!("{:.0}", metres * 1e3);
    let all = |lengths: &[f64; 3]| lengths.map(mm).join(" + ");
    let mut lines = vec![
        format!(
            "  hand      {} mm long, {} mm broad",
            mm(bones.hand),
            mm(bones.breadth)
        ),
        format!(
            "  arm       forearm {} mm, upper arm {} mm",
            mm(bones.forearm),
            mm(bones.upper_arm)
        ),
        format!(
            "  thumb     {} mm from the wrist joint of the thumb",
            all(&bones.thumb)
        ),
    ];
    let fingers = Finger::ALL.iter().skip(1).zip(&bones.phalanges);
    lines.extend(fingers.map(|(finger, lengths)| {
        format!(
            "  {:<9} {} mm from the knuckle",
            finger.name(),
            all(lengths)
        )
    }));
    lines
}

fn reach_line(reach: &HandReach) -> String {
    format!(
        "  reach     index fingertip {:.0} mm from the elbow in the typing posture, {:.0} mm from the wrist of a flat hand",
        reach.from_elbow.length() * 1e3,
        reach.length * 1e3
    )
}

/// Returns the errors of the simulated person, without those that it does not make.
fn motion_lines(motion: &Motion) -> Vec<String> {
    let mut lines = vec![format!("  speed     {}", motion.speed)];
    let deviation = motion.scatter.deviation * 1e3;
    let parts = motion.scatter.parts;
    if motion.scatter != Default::default() {
        lines.push(format!(
            "  scatter   {:.2} mm along rows, {:.2} mm across, {:.2} mm in depth; {:.4} and {:.4} of the squared size",
            deviation.x, deviation.y, deviation.z, parts.x, parts.y
        ));
    }
    for &finger in Finger::ALL {
        let offset = motion.offsets[finger.index()] * 1e3;
        if offset.length() > 0.0 {
            lines.push(format!(
                "  offset    {finger}: {:.1} mm to the right, {:.1} mm away",
                offset.x, offset.y
            ));
        }
    }
    if motion.tremor.amplitude > 0.0 {
        lines.push(format!(
            "  tremor    {:.2} mm at {} Hz",
            motion.tremor.amplitude * 1e3,
            motion.tremor.frequency_hz
        ));
    }
    if motion.enslaving > 0.0 {
        lines.push(format!("  enslaving {}", motion.enslaving));
    }
    lines
}
