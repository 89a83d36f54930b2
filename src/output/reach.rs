//! What each kind of output can carry, and what is said when none of them can.

use super::platform;
use crate::device::{KeyKind, Need, Needs};

/// What an output can carry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reach {
    /// Everything.
    #[default]
    All,
    /// Everything, as a record: what it hears is for another output to carry where there is one.
    Record,
    /// What a desktop takes: no gamepad and no axes.
    Desktop,
    /// What devices of the Linux kernel take: positions of keys but no characters, and no 6-DoF axes.
    Uinput,
    /// What a 6-DoF mouse has: its six axes, and the face buttons of a gamepad as its four buttons.
    Spacenav,
}

/// The codes that are the buttons of a 6-DoF mouse, in the order of their numbers, from 0.
pub const SPACENAV_BUTTONS: [&str; 4] = ["PadSouth", "PadEast", "PadNorth", "PadWest"];

impl Reach {
    /// Whether it can carry this.
    pub fn carries(self, need: Need) -> bool {
        self.lack(need).is_none()
    }

    /// What it has not got for this need; `None` where it can carry it.
    fn lack(self, need: Need) -> Option<&'static str> {
        match (self, need) {
            (Self::Desktop, Need::Code(code)) => match code.kind() {
                KeyKind::Pad => Some("has no gamepad"),
                KeyKind::Key if !platform::has(code) => Some("has no such key on this system"),
                KeyKind::Key | KeyKind::Mouse => None,
            },
            (Self::Desktop, Need::Axis(axis)) if axis.is_of_gamepad() => Some("has no gamepad"),
            (Self::Desktop | Self::Uinput, Need::Axis(axis)) if !axis.is_of_gamepad() => {
                Some("has no 6-DoF axes")
            }
            (Self::Uinput, Need::Write) => {
                Some("has keys, of which the receiver's keymap makes characters")
            }
            (Self::Spacenav, Need::Axis(axis)) if !axis.is_of_gamepad() => None,
            (Self::Spacenav, Need::Code(code)) if SPACENAV_BUTTONS.contains(&code.name()) => None,
            (Self::Spacenav, _) => Some("has 6-DoF axes and four buttons, no more"),
            _ => None,
        }
    }
}

/// The place of the output that carries this: the first that can. Records carry only what goes
/// nowhere else because there are none but records.
pub fn carrier(reaches: &[Reach], need: Need) -> Option<usize> {
    let only_records = reaches.iter().all(|reach| *reach == Reach::Record);
    let can = |reach: &Reach| (only_records || *reach != Reach::Record) && reach.carries(need);
    reaches.iter().position(can)
}

/// What the output at a place is to carry.
pub fn share(reaches: &[Reach], place: usize, needs: &Needs) -> Needs {
    let is_carried_here = |need: &Need| carrier(reaches, *need) == Some(place);
    needs.iter().filter(is_carried_here).collect()
}

/// Why none of these outputs can carry something, and what to do about it; `None` where all is carried.
pub fn refusal(names: &[&str], reaches: &[Reach], needs: &Needs) -> Option<String> {
    let need = needs
        .iter()
        .find(|need| carrier(reaches, *need).is_none())?;
    let lacks: Vec<_> = names
        .iter()
        .zip(reaches)
        .filter_map(|(name, reach)| Some(format!("`{name}` {}", reach.lack(need)?)))
        .collect();
    let others = [
        ("uinput", Reach::Uinput),
        ("desktop", Reach::Desktop),
        ("spacenav", Reach::Spacenav),
    ];
    let what_to_do = match others.iter().find(|(_, reach)| reach.carries(need)) {
        Some((other, _)) => format!("add the output `{other}`: `{},{other}`", names.join(",")),
        None => "leave it out of the layout, or watch it with the output `transcript`".into(),
    };
    let lacks = lacks.join(", ");
    Some(format!(
        "{lacks}, and the layout needs {need}; {what_to_do}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::Axis;
    use crate::output::tests::key;

    fn code(name: &str) -> Need {
        Need::Code(key(name))
    }

    /// What is said of a single need.
    fn said(outputs: &[(&str, Reach)], need: Need) -> Option<String> {
        let (names, reaches): (Vec<_>, Vec<_>) = outputs.iter().copied().unzip();
        refusal(&names, &reaches, &Needs::from_iter([need]))
    }

    #[test]
    fn what_an_output_cannot_carry_is_told_with_a_way_out() {
        let desktop = [("desktop", Reach::Desktop)];
        let uinput = [("uinput", Reach::Uinput)];
        let spacenav = [("spacenav", Reach::Spacenav)];
        let both = [desktop[0], uinput[0]];
        let table = [
            (
                &desktop[..],
                code("PadSouth"),
                "`desktop` has no gamepad, and the layout needs `PadSouth`; \
                 add the output `uinput`: `desktop,uinput`",
            ),
            (
                &desktop[..],
                Need::Axis(Axis::LeftX),
                "`desktop` has no gamepad, and the layout needs `LeftX`; \
                 add the output `uinput`: `desktop,uinput`",
            ),
            (
                &uinput[..],
                Need::Write,
                "`uinput` has keys, of which the receiver's keymap makes characters, and the layout \
                 needs characters; add the output `desktop`: `uinput,desktop`",
            ),
            (
                &both[..],
                Need::Axis(Axis::TurnZ),
                "`desktop` has no 6-DoF axes, `uinput` has no 6-DoF axes, and the layout needs `TurnZ`; \
                 add the output `spacenav`: `desktop,uinput,spacenav`",
            ),
            (
                &spacenav[..],
                code("PadStart"),
                "`spacenav` has 6-DoF axes and four buttons, no more, and the layout needs `PadStart`; \
                 add the output `uinput`: `spacenav,uinput`",
            ),
        ];
        for (outputs, need, text) in table {
            assert_eq!(said(outputs, need).as_deref(), Some(text));
        }
        let carried = [
            code("A"),
            code("MouseLeft"),
            Need::Move,
            Need::Place,
            Need::Scroll,
        ];
        for need in carried {
            assert_eq!(said(&desktop, need), None, "{need}");
            assert_eq!(said(&uinput, need), None, "{need}");
            assert!(said(&spacenav, need).is_some(), "{need}");
        }
        let carried = [
            Need::Axis(Axis::MoveX),
            Need::Axis(Axis::TurnZ),
            code("PadWest"),
        ];
        for need in carried {
            assert_eq!(said(&spacenav, need), None, "{need}");
        }
    }

    #[test]
    fn the_first_output_that_can_carries_and_a_record_only_where_there_is_no_other() {
        use Reach::{All, Desktop, Record, Spacenav, Uinput};
        let table: [(&[Reach], Need, Option<usize>); 10] = [
            (&[Desktop, Uinput], code("A"), Some(0)),
            (&[Uinput, Desktop], code("A"), Some(0)),
            (&[Desktop, Uinput], code("PadSouth"), Some(1)),
            (&[Uinput, Desktop], Need::Write, Some(1)),
            (&[Record, Desktop], Need::Write, Some(1)),
            (&[Record, Desktop], code("PadSouth"), None),
            (&[Record, Record], code("PadSouth"), Some(0)),
            (&[Uinput, Spacenav], Need::Axis(Axis::TurnX), Some(1)),
            (&[Uinput, Spacenav], code("PadSouth"), Some(0)),
            (&[Desktop, All], Need::Axis(Axis::TurnX), Some(1)),
        ];
        for (reaches, need, place) in table {
            assert_eq!(carrier(reaches, need), place, "{need} to {reaches:?}");
        }
    }

    #[test]
    fn every_need_is_in_the_share_of_one_output() {
        let needs = Needs::from_iter([code("A"), code("PadSouth"), Need::Write, Need::Scroll]);
        let reaches = [Reach::Uinput, Reach::Record, Reach::Desktop];
        let of_uinput = Needs::from_iter([code("A"), code("PadSouth"), Need::Scroll]);
        assert_eq!(share(&reaches, 0, &needs), of_uinput);
        assert_eq!(share(&reaches, 1, &needs), Needs::default());
        assert_eq!(share(&reaches, 2, &needs), Needs::from_iter([Need::Write]));
    }
}
