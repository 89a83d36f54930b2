//! Messages of a session for its user.

use std::fmt;

use parry3d::math::Vec3;

use super::reload::LayoutReport;
use crate::advice;
use crate::capture::{Haptics, SourceUri};
use crate::message_limits::HeldBack;
use crate::share::{ShareFormat, ShareTarget};
use ademan_core::command::CommandOrigin;
use ademan_core::estimate::Rejection;
use ademan_core::hand::{Dof, Finger, FingerSet, Side};
use ademan_core::message::{escape, escape_line};
use ademan_core::pipeline::HandLoss;

/// The instruction at the start of a layout that is placed by the hand.
pub const AWAITING_HAND: &str =
    "hold your hand open and still for a second: the layout is placed there";

/// The reason for a stall of the output in which no keystroke was dropped.
const OUTPUT_STALLED: &str = "everything is released: this program or its output did not respond in time; this machine is too busy, or \
                              the program was stopped";

/// The control that is nearest to a hand.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestTarget {
    /// The name; `None` for the range of the pointer.
    pub name: Option<String>,
    /// The vector to it: to the right, up, towards the wearer, in metres.
    pub way: Vec3,
    /// `true` if it is on a board, which `recenter` moves.
    pub is_on_board: bool,
}

/// A message for the user, one or more lines as [`Display`](fmt::Display).
#[derive(Debug)]
pub enum Notice {
    /// A source on the network has the role `pointer`, so that it presses no keys of the layout.
    PointerOnly {
        /// The source.
        source: SourceUri,
        /// The ways to let it press keys, as part of a message.
        remedy: String,
    },
    /// A source of another machine presses keys of the layout without a credential and without encryption.
    Unprotected(SourceUri),
    /// The session waits for a device, for this reason.
    WaitingForSource(String),
    /// The device that the session waited for is open.
    SourceFound(SourceUri),
    /// The session reads from this live source.
    Listening(SourceUri),
    /// This server of joint angles or poses listens.
    Sharing(ShareTarget),
    /// No source accepts this feedback.
    NoHaptics(Haptics),
    /// There is no default path for a control socket.
    NoControlSocket,
    /// Output waits until the hand is clear of every control.
    Disarmed,
    /// Fingers that press by bending are bent: the output is not armed until they are straight.
    BentFingers(FingerSet),
    /// The layout is placed where an open hand is held still.
    AwaitingHand,
    /// A hand moves and reaches nothing: its side and the nearest control.
    Unreached(Side, Option<NearestTarget>),
    /// Touches become events.
    Armed {
        /// `true` if the events reach other programs.
        has_effect: bool,
    },
    /// A pause with this origin was requested.
    Paused(CommandOrigin),
    /// No readings arrive; everything is released.
    Stalled,
    /// The device was lost or the machine was suspended.
    SourceLost(String),
    /// This many readings gave no joint angles.
    Rejected(u64, Rejection),
    /// This many readings were dropped because the loop was late.
    Dropped(u64),
    /// This many presses and characters were dropped by the output.
    DroppedPresses(u64),
    /// The output has stalled, but dropped nothing: its thread or the watchdog has released the keys of a program that was late.
    OutputStalled,
    /// This many system keys were suppressed.
    SystemKeysSuppressed(u64),
    /// Keys were suppressed because of the role of their source.
    KeysSuppressed {
        /// The number of keys.
        count: u64,
        /// `true` if `ademan ctl` can reach the session.
        has_control_socket: bool,
    },
    /// This many pointer events were suppressed because of the role of their source.
    PointingSuppressed(u64),
    /// Sensors of these fingers are faulty; their keys are released. Empty after a recovery.
    UntrustedFingers(FingerSet),
    /// Parts of this hand are not trusted because too many of their readings are implausible; their keys are released.
    Implausible(Side, ImplausibleParts),
    /// The readings of this hand are plausible again.
    Plausible(Side),
    /// This hand touches nothing, for this reason; what it held is released. Readings of something else still arrive.
    HandLost(Side, HandLoss),
    /// This hand is tracked again.
    HandFound(Side),
    /// The watchdog exited unexpectedly or does not respond.
    WatchdogLost,
    /// The tray, notifications or the application with the focus are not available, for this reason.
    DesktopFailed(String),
    /// A file that the session writes is incomplete, for this reason.
    FileIncomplete(String),
    /// Outcome of a change to a layout.
    Layout(LayoutReport),
    /// The parts that a simulated hand leaves out, and the reason.
    SimulatedHand(String),
    /// Notices of one kind and source that were held back, as there was one of them a short time ago.
    HeldBack(Box<HeldBack<Notice>>),
    /// This many notices were dropped because the receiver was too slow.
    Missed(u64),
}

/// The parts of a hand whose readings are implausible.
#[derive(Clone, Debug, PartialEq)]
pub struct ImplausibleParts {
    /// The angles, and the sensor channels that measure them.
    pub angles: Vec<(Dof, Option<usize>)>,
    /// `true` if the whole hand is not trusted.
    pub is_hand: bool,
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PointerOnly { source, remedy } => write!(
                f,
                "{} is on the network and only a pointer: it presses no keys of the layout; {remedy}",
                escape(&source.to_string())
            ),
            Self::Unprotected(source) => write!(
                f,
                "{} presses keys and has neither password nor encryption: anyone who answers there, or can change what the network \
                 carries, can type here; use `tcp+tls:`, or a network of your own",
                escape(&source.to_string())
            ),
            Self::WaitingForSource(reason) => {
                write!(f, "waiting: {}; Ctrl-C ends", escape_line(reason))
            }
            Self::SourceFound(source) => write!(f, "found {}", escape(&source.to_string())),
            Self::Listening(source) => write!(
                f,
                "listening to {}, Ctrl-C ends",
                escape(&source.to_string())
            ),
            Self::Sharing(target) => write_sharing(f, target),
            Self::NoHaptics(kind) => write!(
                f,
                "no feedback: `haptics` is {}, but no glove supports it; it needs `protocol=lucidgloves` over `serial:`, `tcp:` or \
                 `udp:`",
                kind.name()
            ),
            Self::NoControlSocket => write!(f, "{}", advice::no_runtime_dir()),
            Self::Disarmed => {
                f.write_str("paused: hold the hand clear of all keys for a moment to arm")
            }
            Self::BentFingers(fingers) => write!(
                f,
                "paused: straighten {}: a bent finger types nothing until it has been straight; `ademan calibrate` corrects a glove whose straight fingers look bent",
                finger_names(*fingers)
            ),
            Self::AwaitingHand => f.write_str(AWAITING_HAND),
            Self::Unreached(side, nearest) => write_unreached(f, *side, nearest.as_ref()),
            Self::Armed { has_effect: true } => {
                f.write_str("armed: touches are sent to other programs, Ctrl-C ends")
            }
            Self::Armed { has_effect: false } => {
                f.write_str("armed: nothing is typed into other programs, Ctrl-C ends")
            }
            Self::Paused(origin) => write_paused(f, *origin),
            Self::Stalled => f.write_str("stalled: no readings, everything is released"),
            Self::SourceLost(reason) => f.write_str(reason),
            Self::Rejected(count, reason) => {
                let why = advice::rejection(*reason);
                write!(f, "{} rejected: {why}", counted(*count, "reading"))
            }
            Self::Dropped(count) => write!(
                f,
                "{} dropped: this machine is too busy, or the program was stopped",
                counted(*count, "reading")
            ),
            Self::DroppedPresses(count) => write!(
                f,
                "{} dropped: the output did not accept them within 250 ms or before a pause, has no such key, cannot type \
                 a text now (Control or Alt is held, or the keymap has too few unused keys), or another window got the focus \
                 before a correction",
                counted(*count, "keystroke")
            ),
            Self::OutputStalled => f.write_str(OUTPUT_STALLED),
            Self::SystemKeysSuppressed(count) => write!(
                f,
                "{} suppressed that would act on the system; `allow_system_keys: true` in the setup allows them",
                counted(*count, "key")
            ),
            Self::KeysSuppressed {
                count,
                has_control_socket,
            } => write_keys_suppressed(f, *count, *has_control_socket),
            Self::PointingSuppressed(count) => write!(
                f,
                "{} suppressed, as the source is only for keys; `role: Both` next to it in the setup lets it point",
                counted(*count, "pointer event")
            ),
            Self::UntrustedFingers(fingers) => write_untrusted(f, *fingers),
            Self::Implausible(side, parts) => write_implausible(f, *side, parts),
            Self::Plausible(side) => {
                write!(f, "the readings of the {side} hand are plausible again")
            }
            Self::HandLost(side, loss) => write_lost(f, *side, *loss),
            Self::HandFound(side) => write!(f, "the {side} hand is tracked again"),
            Self::WatchdogLost => {
                f.write_str("the watchdog exited or hangs: everything is released")
            }
            Self::DesktopFailed(reason) => f.write_str(&escape_line(reason)),
            Self::FileIncomplete(reason) => write!(f, "{reason}; the session continues without it"),
            Self::Layout(report) => report.fmt(f),
            Self::SimulatedHand(message) => f.write_str(&escape_line(message)),
            Self::HeldBack(held_back) => held_back.fmt(f),
            Self::Missed(count) => write!(
                f,
                "{} dropped: not read in time",
                counted(*count, "message")
            ),
        }
    }
}

impl Notice {
    /// Returns `true` for a notice that a person who wants only errors and warnings does not need.
    pub fn is_routine(&self) -> bool {
        matches!(
            self,
            Self::WaitingForSource(_)
                | Self::SourceFound(_)
                | Self::Listening(_)
                | Self::NoControlSocket
                | Self::Disarmed
                | Self::BentFingers(_)
                | Self::AwaitingHand
                | Self::Armed { .. }
        )
    }
}

fn write_sharing(f: &mut fmt::Formatter<'_>, target: &ShareTarget) -> fmt::Result {
    write!(f, "sharing {}: ", escape(&target.to_string()))?;
    if target.format == ShareFormat::Web {
        write!(f, "open http://{}/; ", target.address)?;
    }
    f.write_str("the angles of a hand reveal what it types")
}

fn write_keys_suppressed(
    f: &mut fmt::Formatter<'_>,
    count: u64,
    has_control_socket: bool,
) -> fmt::Result {
    let keys = counted(count, "key");
    write!(f, "{keys} suppressed, as the source is only a pointer; ")?;
    if has_control_socket {
        f.write_str("`ademan ctl allow-keys`, ")?;
    }
    f.write_str("`--role both` or `role: Both` next to it in the setup lets it type")
}

fn write_unreached(
    f: &mut fmt::Formatter<'_>,
    side: Side,
    nearest: Option<&NearestTarget>,
) -> fmt::Result {
    let Some(NearestTarget {
        name,
        way,
        is_on_board,
    }) = nearest
    else {
        return write!(
            f,
            "the {side} hand moves, but the source does not show the joints that the layout needs; `webcam-mouse` and \
             `webcam-qwerty` need only a hand"
        );
    };
    write!(f, "the {side} hand moves and reaches nothing: ")?;
    match name {
        Some(name) => write!(f, "`{}`", escape(name))?,
        None => f.write_str("the range of the pointer")?,
    }
    write!(f, " is {:.0} mm away", way.length() * 1e3)?;
    write_directions(f, *way * 1e3)?;
    f.write_str(if *is_on_board {
        "; `ademan ctl recenter` brings the boards below the hand, `ademan calibrate` corrects a glove, and a layout with \
         `anchor: start`, such as `webcam-qwerty`, is placed where the hand is"
    } else {
        "; `ademan calibrate` corrects a glove, and a layout with `anchor: start`, such as `webcam-mouse`, is placed where the \
         hand is"
    })
}

/// Writes the largest component of a vector in millimetres, and the others that are at least a quarter of it.
fn write_directions(f: &mut fmt::Formatter<'_>, way: Vec3) -> fmt::Result {
    let mut parts = [
        (way.x, ["to the right", "to the left"]),
        (way.y, ["up", "down"]),
        (-way.z, ["forward", "back"]),
    ];
    parts.sort_by(|one, other| other.0.abs().total_cmp(&one.0.abs()));
    let smallest = parts[0].0.abs() / 4.0;
    let parts = parts.iter().filter(|(part, _)| part.abs() >= smallest);
    for (index, (part, [positive, negative])) in parts.enumerate() {
        let separator = if index == 0 { ", " } else { " and " };
        let direction = if *part < 0.0 { negative } else { positive };
        write!(f, "{separator}{:.0} mm {direction}", part.abs())?;
    }
    Ok(())
}

fn write_lost(f: &mut fmt::Formatter<'_>, side: Side, loss: HandLoss) -> fmt::Result {
    let released = "what it held is released, and it touches nothing";
    match loss {
        HandLoss::NoReadings => write!(f, "no readings of the {side} hand: {released}"),
        HandLoss::NotSeen => write!(f, "the {side} hand is not tracked: {released}"),
        HandLoss::Stuck => write!(
            f,
            "the tracker of the {side} hand has repeated exactly the same positions for 5 s: what the hand held is released, and it \
             touches nothing until the positions change; if they stay the same while you move the hand, check the camera and restart \
             the tracker"
        ),
        HandLoss::TooFast => write!(
            f,
            "the {side} hand makes more presses than a person (`max_presses_per_second` of the setup): {released} until `ademan ctl \
             resume`"
        ),
    }
}

fn write_paused(f: &mut fmt::Formatter<'_>, origin: CommandOrigin) -> fmt::Result {
    write!(f, "paused by {}: ", origin.description())?;
    f.write_str(match origin {
        CommandOrigin::Layout => {
            "everything is released; that key or gesture, or `ademan ctl resume`, ends the pause"
        }
        CommandOrigin::Suspend => "everything is released until the program is continued",
        CommandOrigin::RateLimit => {
            "more presses than a person makes (`max_presses_per_second` of the setup); everything is released, and `ademan ctl \
             resume` ends the pause"
        }
        _ => "everything is released, and `ademan ctl resume` ends the pause",
    })
}

fn finger_names(fingers: FingerSet) -> String {
    let all = Finger::ALL.iter();
    let names = all.filter(|finger| fingers.contains(**finger));
    names
        .map(|finger| finger.name())
        .collect::<Vec<_>>()
        .join(", ")
}

fn write_untrusted(f: &mut fmt::Formatter<'_>, fingers: FingerSet) -> fmt::Result {
    if fingers.is_empty() {
        f.write_str("the sensors of all fingers work again")
    } else {
        write!(
            f,
            "ignored and released: {}; the source does not see them, or a sensor has been at an end of its range for 1 s: check its wire",
            finger_names(fingers)
        )
    }
}

fn write_implausible(
    f: &mut fmt::Formatter<'_>,
    side: Side,
    ImplausibleParts { angles, is_hand }: &ImplausibleParts,
) -> fmt::Result {
    if *is_hand {
        return write!(
            f,
            "the {side} hand is ignored and released: more than a third of its readings jump or are outside the range of a joint; \
             check wires and interference, `ademan trace --stats` shows the noise of each sensor"
        );
    }
    write!(f, "ignored and released on the {side} hand: ")?;
    for (index, (dof, channel)) in angles.iter().enumerate() {
        let separator = if index == 0 { "" } else { ", " };
        write!(f, "{separator}{dof}")?;
        if let Some(channel) = channel {
            write!(f, " (channel {channel})")?;
        }
    }
    f.write_str(
        "; the readings jump or are outside the range of the joint: check the wire, or calibrate with `ademan calibrate`",
    )
}

/// Returns a number with its noun: `1 key`, `2 keys`.
pub fn counted(count: u64, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_that_reaches_nothing_is_told_distance_directions_and_a_remedy() {
        let text = |name: Option<&str>, way| {
            let nearest = NearestTarget {
                name: name.map(str::to_owned),
                way,
                is_on_board: name.is_some(),
            };
            Notice::Unreached(Side::Left, Some(nearest)).to_string()
        };
        let far = text(Some("Q"), Vec3::new(0.01, -0.09, -0.4));
        let way = "the left hand moves and reaches nothing: `Q` is 410 mm away, 400 mm forward;";
        assert!(far.contains(way), "{far}");
        assert!(far.contains("`ademan ctl recenter`"), "{far}");
        let range = text(None, Vec3::new(-0.3, 0.3, 0.3));
        assert!(
            range.contains("the range of the pointer is 520 mm away, 300 mm to the left and 300 mm up and 300 mm back;"),
            "{range}"
        );
        let unknown = Notice::Unreached(Side::Right, None).to_string();
        assert!(unknown.contains("`webcam-mouse`"), "{unknown}");
    }
}
