//! What each kind of output can carry, and what is said when none of them can.

use super::platform;
use crate::device::{Capabilities, Capability, KeyKind};

/// What an output can carry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutputKind {
    /// Everything.
    #[default]
    All,
    /// Everything, as a record: what it hears is for another output to carry where there is one.
    Log,
    /// What a desktop takes: no gamepad and no axes.
    Desktop,
    /// What devices of the Linux kernel take: positions of keys but no characters, and no 6-DoF axes.
    Uinput,
    /// What a 6-DoF mouse has: its six axes, and the face buttons of a gamepad as its four buttons.
    Spacenav,
}

/// The codes that are the buttons of a 6-DoF mouse, in the order of their numbers, from 0.
pub const SPACENAV_BUTTONS: [&str; 4] = ["PadSouth", "PadEast", "PadNorth", "PadWest"];

impl OutputKind {
    /// Whether it can carry this.
    pub fn supports(self, need: Capability) -> bool {
        self.missing_feature(need).is_none()
    }

    /// What it has not got for this need; `None` where it can carry it.
    fn missing_feature(self, need: Capability) -> Option<&'static str> {
        match (self, need) {
            (Self::Desktop, Capability::Key(code)) => match code.kind() {
                KeyKind::Gamepad => Some("has no gamepad"),
                KeyKind::Keyboard if !platform::has(code) => Some("has no such key on this system"),
                KeyKind::Keyboard | KeyKind::Mouse => None,
            },
            (Self::Desktop, Capability::Axis(axis)) if axis.is_gamepad() => Some("has no gamepad"),
            (Self::Desktop | Self::Uinput, Capability::Axis(axis)) if !axis.is_gamepad() => {
                Some("has no 6-DoF axes")
            }
            (Self::Uinput, Capability::Text) => {
                Some("has keys, of which the receiver's keymap makes characters")
            }
            (Self::Spacenav, Capability::Axis(axis)) if !axis.is_gamepad() => None,
            (Self::Spacenav, Capability::Key(code)) if SPACENAV_BUTTONS.contains(&code.name()) => {
                None
            }
            (Self::Spacenav, _) => Some("has 6-DoF axes and four buttons, no more"),
            _ => None,
        }
    }
}

/// The place of the output that carries this: the first that can. Records carry only what goes
/// nowhere else because there are none but records.
pub fn route(reaches: &[OutputKind], need: Capability) -> Option<usize> {
    let only_records = reaches.iter().all(|reach| *reach == OutputKind::Log);
    let can =
        |reach: &OutputKind| (only_records || *reach != OutputKind::Log) && reach.supports(need);
    reaches.iter().position(can)
}

/// What the output at a place is to carry.
pub fn routed_to(reaches: &[OutputKind], place: usize, needs: &Capabilities) -> Capabilities {
    let is_carried_here = |need: &Capability| route(reaches, *need) == Some(place);
    needs.iter().filter(is_carried_here).collect()
}

/// Why none of these outputs can carry something, and what to do about it; `None` where all is carried.
pub fn unsupported_reason(
    names: &[&str],
    reaches: &[OutputKind],
    needs: &Capabilities,
) -> Option<String> {
    let need = needs.iter().find(|need| route(reaches, *need).is_none())?;
    let lacks: Vec<_> = names
        .iter()
        .zip(reaches)
        .filter_map(|(name, reach)| Some(format!("`{name}` {}", reach.missing_feature(need)?)))
        .collect();
    let others = [
        ("uinput", OutputKind::Uinput),
        ("desktop", OutputKind::Desktop),
        ("spacenav", OutputKind::Spacenav),
    ];
    let what_to_do = match others.iter().find(|(_, reach)| reach.supports(need)) {
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

    fn code(name: &str) -> Capability {
        Capability::Key(key(name))
    }

    /// What is said of a single need.
    fn said(outputs: &[(&str, OutputKind)], need: Capability) -> Option<String> {
        let (names, reaches): (Vec<_>, Vec<_>) = outputs.iter().copied().unzip();
        unsupported_reason(&names, &reaches, &Capabilities::from_iter([need]))
    }

    #[test]
    fn what_an_output_cannot_carry_is_told_with_a_way_out() {
        let desktop = [("desktop", OutputKind::Desktop)];
        let uinput = [("uinput", OutputKind::Uinput)];
        let spacenav = [("spacenav", OutputKind::Spacenav)];
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
                Capability::Axis(Axis::LeftX),
                "`desktop` has no gamepad, and the layout needs `LeftX`; \
                 add the output `uinput`: `desktop,uinput`",
            ),
            (
                &uinput[..],
                Capability::Text,
                "`uinput` has keys, of which the receiver's keymap makes characters, and the layout \
                 needs characters; add the output `desktop`: `uinput,desktop`",
            ),
            (
                &both[..],
                Capability::Axis(Axis::TurnZ),
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
            Capability::RelativeMotion,
            Capability::AbsoluteMotion,
            Capability::Scroll,
        ];
        for need in carried {
            assert_eq!(said(&desktop, need), None, "{need}");
            assert_eq!(said(&uinput, need), None, "{need}");
            assert!(said(&spacenav, need).is_some(), "{need}");
        }
        let carried = [
            Capability::Axis(Axis::MoveX),
            Capability::Axis(Axis::TurnZ),
            code("PadWest"),
        ];
        for need in carried {
            assert_eq!(said(&spacenav, need), None, "{need}");
        }
    }

    #[test]
    fn the_first_output_that_can_carries_and_a_record_only_where_there_is_no_other() {
        use OutputKind::{All, Desktop, Log, Spacenav, Uinput};
        let table: [(&[OutputKind], Capability, Option<usize>); 10] = [
            (&[Desktop, Uinput], code("A"), Some(0)),
            (&[Uinput, Desktop], code("A"), Some(0)),
            (&[Desktop, Uinput], code("PadSouth"), Some(1)),
            (&[Uinput, Desktop], Capability::Text, Some(1)),
            (&[Log, Desktop], Capability::Text, Some(1)),
            (&[Log, Desktop], code("PadSouth"), None),
            (&[Log, Log], code("PadSouth"), Some(0)),
            (&[Uinput, Spacenav], Capability::Axis(Axis::TurnX), Some(1)),
            (&[Uinput, Spacenav], code("PadSouth"), Some(0)),
            (&[Desktop, All], Capability::Axis(Axis::TurnX), Some(1)),
        ];
        for (reaches, need, place) in table {
            assert_eq!(route(reaches, need), place, "{need} to {reaches:?}");
        }
    }

    #[test]
    fn every_need_is_in_the_share_of_one_output() {
        let needs = Capabilities::from_iter([
            code("A"),
            code("PadSouth"),
            Capability::Text,
            Capability::Scroll,
        ]);
        let reaches = [OutputKind::Uinput, OutputKind::Log, OutputKind::Desktop];
        let of_uinput = Capabilities::from_iter([code("A"), code("PadSouth"), Capability::Scroll]);
        assert_eq!(routed_to(&reaches, 0, &needs), of_uinput);
        assert_eq!(routed_to(&reaches, 1, &needs), Capabilities::default());
        assert_eq!(
            routed_to(&reaches, 2, &needs),
            Capabilities::from_iter([Capability::Text])
        );
    }
}
