//! All commands with their fields, for help texts and error messages.

use super::TextMode;

/// Name, fields and description of a command, for help texts and error messages.
#[derive(Clone, Copy, Debug)]
pub struct CommandSpec {
    /// Name in JSON and on the command line.
    pub name: &'static str,
    /// One sentence without a full stop.
    pub summary: &'static str,
    /// Default label of a key that issues the command.
    pub key_label: &'static str,
    /// Required fields, in the order of the command line.
    pub fields: &'static [FieldSpec],
}

/// A field of a command.
#[derive(Clone, Copy, Debug)]
pub struct FieldSpec {
    /// Name in JSON, with the unit.
    pub name: &'static str,
    /// Description for a help text.
    pub summary: &'static str,
    /// A value for the example of a help text.
    pub example: &'static str,
    /// Accepted values.
    pub kind: FieldKind,
}

/// Accepted values of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldKind {
    /// A number in a closed range.
    Number {
        /// Smallest value.
        min: f32,
        /// Largest value.
        max: f32,
    },
    /// A whole number in a closed range.
    Whole {
        /// Smallest value.
        min: u8,
        /// Largest value.
        max: u8,
    },
    /// A name of at most [`ProfileName`](super::ProfileName)'s capacity.
    Name,
    /// One of these words.
    OneOf(&'static [&'static str]),
}

/// All commands, in the order of the help text.
pub const SPECS: &[CommandSpec] = &[
    plain(
        "state",
        "Report the state, the active layout and the statistics",
        "State",
    ),
    plain(
        "pause",
        "Release everything and suppress all events",
        "Pause",
    ),
    plain(
        "resume",
        "End a pause; output is armed once the hand is clear of every control",
        "Resume",
    ),
    plain("toggle-pause", "Pause, or resume if paused", "Pause"),
    CommandSpec {
        name: "profile",
        summary: "Activate another layout of the setup",
        key_label: "Profile",
        fields: &[FieldSpec {
            name: "name",
            summary: "Name of the profile",
            example: "numbers",
            kind: FieldKind::Name,
        }],
    },
    plain(
        "next-profile",
        "Activate the next layout of the setup",
        "Profile",
    ),
    plain(
        "recenter",
        "Move the boards below the index fingertip of the hand seen last",
        "Center",
    ),
    CommandSpec {
        name: "nudge",
        summary: "Move the boards, in mm",
        key_label: "Move",
        fields: &[
            number("x_mm", "To the right", "0", -1000.0, 1000.0),
            number("y_mm", "Up", "0", -1000.0, 1000.0),
            number("z_mm", "Towards you", "-5", -1000.0, 1000.0),
        ],
    },
    CommandSpec {
        name: "tilt",
        summary: "Rotate each board about its rows",
        key_label: "Tilt",
        fields: &[number(
            "deg",
            "Degrees; positive raises the far edge",
            "2.5",
            -90.0,
            90.0,
        )],
    },
    CommandSpec {
        name: "scale",
        summary: "Make the boards larger or smaller",
        key_label: "Size",
        fields: &[number(
            "factor",
            "Ratio of the new size to the present one",
            "0.9",
            0.5,
            2.0,
        )],
    },
    plain(
        "zero",
        "Correct a glove that has slipped: use the angles of the resting hand as its rest pose",
        "Zero",
    ),
    plain(
        "undo-zero",
        "Undo `zero`: return to the angles before it",
        "Undo zero",
    ),
    plain(
        "undo-learning",
        "Discard the ranges that `--learn-ranges` has learned, and return to the calibration",
        "Unlearn",
    ),
    CommandSpec {
        name: "text",
        summary: "Correct words at their end, only suggest, or neither; for a run with --decoder",
        key_label: "Text",
        fields: &[FieldSpec {
            name: "mode",
            summary: "What the text decoder changes",
            example: "auto",
            kind: FieldKind::OneOf(TextMode::NAMES),
        }],
    },
    CommandSpec {
        name: "candidate",
        summary: "Replace the word that is being typed by a candidate of the text decoder",
        key_label: "Word",
        fields: &[FieldSpec {
            name: "number",
            summary: "Number of the candidate; 1 is the most probable",
            example: "1",
            kind: FieldKind::Whole { min: 1, max: 3 },
        }],
    },
    plain(
        "forget-learned",
        "Forget, in this run, what the text decoder has learned about you; its file stays",
        "Forget",
    ),
    plain(
        "save-learned",
        "Write what the text decoder has learned about you to the file of --learned",
        "Learned",
    ),
    plain(
        "allow-keys",
        "Allow all sources to press keys, including a headset and other sources on the network, until the session ends or another sender replaces the present one",
        "Keys",
    ),
    plain(
        "forbid-keys",
        "Release everything, and allow the sources only to point",
        "No keys",
    ),
    plain(
        "save",
        "Write the poses and the size of the boards to the layout file",
        "Save",
    ),
    plain("reload", "Read the layout files again", "Reload"),
    plain("stop", "Release everything and end the session", "Stop"),
];

const fn plain(name: &'static str, summary: &'static str, key_label: &'static str) -> CommandSpec {
    CommandSpec {
        name,
        summary,
        key_label,
        fields: &[],
    }
}

const fn number(
    name: &'static str,
    summary: &'static str,
    example: &'static str,
    min: f32,
    max: f32,
) -> FieldSpec {
    FieldSpec {
        name,
        summary,
        example,
        kind: FieldKind::Number { min, max },
    }
}
