//! Why something of the system cannot be used, and the commands that change that: told by whoever meets it,
//! and by the [doctor](crate::doctor) before anybody does.

use std::fmt;
use std::path::Path;

/// Lets the new rules count without a start of the machine.
const RULES_COUNT: &str = "sudo udevadm control --reload && sudo udevadm trigger";

/// Gives the nodes of uinput and of USB serial adapters to groups.
const RULES: &str = "ademan setup --print udev | sudo tee /etc/udev/rules.d/60-ademan.rules";

/// The protocol through which a program is a keyboard.
pub const KEYBOARD_PROTOCOL: &str = "zwp_virtual_keyboard_manager_v1";

/// The protocol through which a program is a pointer.
pub const POINTER_PROTOCOL: &str = "zwlr_virtual_pointer_manager_v1";

/// A compositor whose program is not known.
const A_COMPOSITOR: &str = "the compositor";

/// What members of a new group have to do.
const LOG_IN_AGAIN: &str = "log in again";

/// Why something cannot be used, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Advice {
    /// What is the matter, in lower case and without a full stop.
    pub reason: String,
    /// Lines for a shell, one after the other; there may be none.
    pub commands: Vec<String>,
    /// What is to be done after that, or instead where there are no commands; may be empty.
    pub next_step: String,
}

impl Advice {
    /// Something that no command mends: only what to do.
    pub fn new(reason: impl Into<String>, then: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
            commands: Vec::new(),
            next_step: then.into(),
        }
    }

    fn with(reason: impl Into<String>, commands: &[&str], then: &str) -> Self {
        Self {
            reason: reason.into(),
            commands: commands.iter().map(|line| (*line).to_owned()).collect(),
            next_step: then.into(),
        }
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut steps: Vec<_> = self
            .commands
            .iter()
            .map(|line| format!("`{line}`"))
            .collect();
        steps.extend((!self.next_step.is_empty()).then(|| self.next_step.clone()));
        match steps.is_empty() {
            true => write!(f, "{}", self.reason),
            false => write!(f, "{}; {}", self.reason, steps.join(", ")),
        }
    }
}

/// Who may read and write a device, seen from a user who may not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AccessDenied {
    /// The members of this group, and this user is none.
    NotInGroup(String),
    /// The members of this group; this user has become one and has not logged in since.
    LoginRequired(String),
    /// Its owner only.
    OwnerOnly,
    /// Nobody has looked.
    Unknown,
}

/// There is no `/dev/uinput`, or nothing behind it: the module is not loaded.
pub fn uinput_not_loaded() -> Advice {
    Advice::with(
        "/dev/uinput is not there; load the kernel module",
        &[
            "sudo modprobe uinput",
            "ademan setup --print modules | sudo tee /etc/modules-load.d/ademan.conf",
        ],
        "",
    )
}

/// The running kernel has no module `uinput` that could be loaded.
pub fn uinput_not_in_kernel() -> Advice {
    Advice::new(
        "/dev/uinput is not there, and the running kernel has no module `uinput`",
        "use a kernel that has it (CONFIG_INPUT_UINPUT; Debian: linux-image-amd64), or the output `desktop`",
    )
}

/// The module is loaded and the node is not there.
pub fn uinput_node_missing() -> Advice {
    Advice::new(
        "the module `uinput` is loaded, and /dev/uinput is not there: this is a container",
        "start the container with `--device /dev/uinput`",
    )
}

/// This user may not write to `/dev/uinput`.
pub fn uinput_denied(denied: &AccessDenied) -> Advice {
    const WHAT: &str = "no permission to use /dev/uinput";
    match denied {
        AccessDenied::NotInGroup(group) => Advice::with(
            format!("{WHAT}, which is for the group `{group}`"),
            &[&join(group)],
            LOG_IN_AGAIN,
        ),
        AccessDenied::LoginRequired(group) => not_yet(WHAT, group),
        AccessDenied::OwnerOnly | AccessDenied::Unknown => Advice::with(
            format!("{WHAT}; give it to a group of its own"),
            &[
                "sudo groupadd --system --force uinput",
                &join("uinput"),
                RULES,
                RULES_COUNT,
            ],
            LOG_IN_AGAIN,
        ),
    }
}

/// This user may not open a serial port.
pub fn serial_port_denied(port: &str, denied: &AccessDenied) -> Advice {
    let what = format!("this user may not open {port}");
    match denied {
        AccessDenied::NotInGroup(group) => Advice::with(
            format!("{what}, which is for the group `{group}`"),
            &[&join(group)],
            LOG_IN_AGAIN,
        ),
        AccessDenied::LoginRequired(group) => not_yet(&what, group),
        AccessDenied::OwnerOnly => Advice::with(
            format!("{what}, which is for its owner only"),
            &[&join("dialout"), RULES, RULES_COUNT],
            LOG_IN_AGAIN,
        ),
        AccessDenied::Unknown => Advice::with(
            format!(
                "{what}; `ls -l {port}` shows the group that may (usually `dialout` or `uucp`): join it"
            ),
            &[&join("dialout")],
            "log in again; `ademan doctor` says more",
        ),
    }
}

/// No X server answers at this `DISPLAY`, or none is named.
pub fn no_display(display: Option<&str>) -> Advice {
    let what_to_do = "start this from a graphical session, or use the output `uinput`";
    match display {
        Some(display) => Advice::new(format!("no display answers at `{display}`"), what_to_do),
        None => Advice::new("DISPLAY is not set", what_to_do),
    }
}

/// Nobody speaks Wayland at this socket.
pub fn no_compositor(socket: &Path, reason: &str) -> Advice {
    Advice::new(
        format!("no compositor answers at {}: {reason}", socket.display()),
        "start this from a graphical session, or use the output `uinput`",
    )
}

/// The compositor, by the name of its program where that is known, lets no program be a keyboard.
pub fn no_virtual_keyboard(program: Option<&str>) -> Advice {
    let program = program.unwrap_or(A_COMPOSITOR);
    Advice::new(
        format!("{program} has no {KEYBOARD_PROTOCOL}: it lets no program press keys so"),
        "use the output `uinput`",
    )
}

/// The compositor, by the name of its program where that is known, lets no program be a pointer.
pub fn no_virtual_pointer(program: Option<&str>) -> Advice {
    let program = program.unwrap_or(A_COMPOSITOR);
    Advice::new(
        format!("{program} has no {POINTER_PROTOCOL}: it lets no program move the pointer so"),
        "let the output `uinput` move the pointer",
    )
}

/// There is a compositor, and this program does not know its language.
pub fn built_without_wayland() -> Advice {
    Advice::new(
        "WAYLAND_DISPLAY is set, and this program was built for X11: its keys would reach no program of Wayland",
        "build it with `--features wayland`, or use the output `uinput`; for programs of X11 only, unset \
         WAYLAND_DISPLAY",
    )
}

/// There is no folder for the control socket.
pub fn no_runtime_dir() -> Advice {
    Advice::new(
        "no control socket: XDG_RUNTIME_DIR names no folder",
        "--control PATH makes one",
    )
}

/// The user of this program may do everything.
pub fn running_as_root() -> Advice {
    Advice::new(
        "root is not the one to type with a glove: whatever reaches this program could do everything",
        "start it as yourself (`ademan doctor` says what is missing for that), or insist with --allow-root",
    )
}

fn not_yet(what: &str, group: &str) -> Advice {
    Advice::new(
        format!("{what} yet: you have joined its group `{group}`, and this session is older"),
        LOG_IN_AGAIN,
    )
}

fn join(group: &str) -> String {
    format!("sudo usermod --append --groups {group} $USER")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_is_a_line_with_commands_to_copy() {
        let group = AccessDenied::NotInGroup("dialout".into());
        let later = AccessDenied::LoginRequired("dialout".into());
        let port = |denied| serial_port_denied("/dev/ttyUSB0", denied).to_string();
        let expected = [
            "this user may not open /dev/ttyUSB0, which is for the group `dialout`; \
             `sudo usermod --append --groups dialout $USER`, log in again",
            "this user may not open /dev/ttyUSB0 yet: you have joined its group `dialout`, and this session is \
             older; log in again",
        ];
        assert_eq!([port(&group), port(&later)], expected);
    }

    #[test]
    fn nobody_is_told_to_be_root() {
        for denied in [
            AccessDenied::NotInGroup("input".into()),
            AccessDenied::OwnerOnly,
            AccessDenied::Unknown,
        ] {
            for advice in [
                uinput_denied(&denied),
                serial_port_denied("/dev/ttyS0", &denied),
            ] {
                let text = advice.to_string();
                assert!(!text.contains("as root"), "{text}");
                assert!(!text.contains("chmod"), "{text}");
                assert!(text.contains("sudo usermod"), "{text}");
            }
        }
    }
}
