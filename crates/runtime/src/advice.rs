//! Advice for missing permissions and services: the reason and the shell commands that help.
//!
//! Sources and outputs add it to their errors; the [doctor](crate::doctor) gives it in advance.

use ademan_core::estimate::Rejection;
use ademan_core::message::{escape, escape_path, shell_word};
use std::fmt;
use std::io;
use std::path::Path;

/// Applies new udev rules without a reboot.
const RELOAD_UDEV: &str = "sudo udevadm control --reload && sudo udevadm trigger";

/// Installs the rules that give the nodes of uinput and of USB serial adapters to groups.
const INSTALL_RULES: &str = "ademan system-files udev | sudo tee /etc/udev/rules.d/60-ademan.rules";

/// Wayland protocol of virtual keyboards.
pub const KEYBOARD_PROTOCOL: &str = "zwp_virtual_keyboard_manager_v1";

/// Wayland protocol of virtual pointers.
pub const POINTER_PROTOCOL: &str = "zwlr_virtual_pointer_manager_v1";

/// Name of a compositor whose program is not known.
const UNKNOWN_COMPOSITOR: &str = "the compositor";

/// Next step of a new member of a group.
const LOG_IN_AGAIN: &str = "log in again";

/// The reason why something cannot be used, and the steps that help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Advice {
    /// Reason, in lower case and without a full stop.
    pub reason: String,
    /// Shell commands, in order; may be empty.
    pub commands: Vec<String>,
    /// Step after the commands, or instead of them; may be empty.
    pub next_step: String,
}

impl Advice {
    /// Creates advice without commands.
    pub fn new(reason: impl Into<String>, next_step: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
            commands: Vec::new(),
            next_step: next_step.into(),
        }
    }

    fn with_commands(reason: impl Into<String>, commands: &[&str], next_step: &str) -> Self {
        Self {
            reason: reason.into(),
            commands: commands.iter().map(|line| (*line).to_owned()).collect(),
            next_step: next_step.into(),
        }
    }
}

/// The reason, then the commands and the next step, in one line.
impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut steps: Vec<_> = self
            .commands
            .iter()
            .map(|line| format!("`{line}`"))
            .collect();
        steps.extend((!self.next_step.is_empty()).then(|| self.next_step.clone()));
        if steps.is_empty() {
            write!(f, "{}", self.reason)
        } else {
            write!(f, "{}; {}", self.reason, steps.join(", "))
        }
    }
}

/// Returns the advice for a thread or a process that the operating system refuses to start.
pub fn no_thread(error: &io::Error) -> Advice {
    Advice::new(
        format!("cannot start a thread or process: {error}"),
        "close other programs, or raise the limit of processes (`ulimit -u`)",
    )
}

/// Reason why the user may not open a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AccessDenied {
    /// The device belongs to this group, and the user is not a member.
    NotInGroup(String),
    /// The device belongs to this group, and the user became a member after the login.
    LoginRequired(String),
    /// Only the owner may open the device.
    OwnerOnly,
    /// The reason is not known.
    Unknown,
}

/// Returns the advice for a kernel without a loaded `uinput` module.
pub fn uinput_not_loaded() -> Advice {
    Advice::with_commands(
        "/dev/uinput does not exist: the kernel module `uinput` is not loaded",
        &[
            "sudo modprobe uinput",
            "ademan system-files modules | sudo tee /etc/modules-load.d/ademan.conf",
        ],
        "",
    )
}

/// Returns the advice for a kernel that has no `uinput` module.
pub fn uinput_not_in_kernel() -> Advice {
    Advice::new(
        "/dev/uinput does not exist, and the running kernel has no module `uinput`",
        "use a kernel that has it (CONFIG_INPUT_UINPUT; Debian: linux-image-amd64), or the output `desktop`",
    )
}

/// Returns the advice for a loaded module without a device node.
pub fn uinput_node_missing() -> Advice {
    Advice::new(
        "the kernel module `uinput` is loaded, but /dev/uinput does not exist, as in a container",
        "start the container with `--device /dev/uinput`",
    )
}

/// Returns the advice for a user who may not write to `/dev/uinput`.
pub fn uinput_denied(denied: &AccessDenied) -> Advice {
    const REASON: &str = "no permission to open /dev/uinput";
    match denied {
        AccessDenied::NotInGroup(group) => not_in_group(REASON, group),
        AccessDenied::LoginRequired(group) => login_required(REASON, group),
        AccessDenied::OwnerOnly | AccessDenied::Unknown => Advice::with_commands(
            format!("{REASON}; give it to a group of its own"),
            &[
                "sudo groupadd --system --force uinput",
                &join("uinput"),
                INSTALL_RULES,
                RELOAD_UDEV,
            ],
            LOG_IN_AGAIN,
        ),
    }
}

/// Returns the advice for a user who may not open a serial port.
pub fn serial_port_denied(port: &str, denied: &AccessDenied) -> Advice {
    let reason = format!("no permission to open {}", escape(port));
    match denied {
        AccessDenied::NotInGroup(group) => not_in_group(&reason, group),
        AccessDenied::LoginRequired(group) => login_required(&reason, group),
        AccessDenied::OwnerOnly => Advice::with_commands(
            format!("{reason}, which only its owner may open"),
            &[&join("dialout"), INSTALL_RULES, RELOAD_UDEV],
            LOG_IN_AGAIN,
        ),
        AccessDenied::Unknown => Advice::with_commands(
            format!(
                "{reason}; `ls -l {}` shows its group (usually `dialout` or `uucp`), which you can join",
                shell_word(port)
            ),
            &[&join("dialout")],
            "log in again; `ademan doctor` says more",
        ),
    }
}

/// Returns the advice for a missing X server; `display` is the value of `DISPLAY`.
pub fn no_display(display: Option<&str>) -> Advice {
    Advice::new(
        display_fault(display),
        "start this from a graphical session, or use the output `uinput`",
    )
}

/// Returns the advice for an X server that refuses the connection; `None` for one that does not answer.
#[cfg(target_os = "linux")]
pub(crate) fn refused_by_display(error: &x11rb::errors::ConnectError) -> Option<Advice> {
    Some(refused_display(&refusal_of_display(error)?))
}

/// Returns the reason that an X server states for its refusal; `None` for one that does not answer.
#[cfg(target_os = "linux")]
pub(crate) fn refusal_of_display(error: &x11rb::errors::ConnectError) -> Option<String> {
    use x11rb::errors::ConnectError::{SetupAuthenticate, SetupFailed};
    let bytes = match error {
        SetupFailed(refusal) => &refusal.reason,
        // Its length is not stated, so that the bytes up to whole words belong to it.
        SetupAuthenticate(refusal) => &refusal.reason,
        _ => return None,
    };
    let reason = String::from_utf8_lossy(bytes);
    Some(reason.trim_end_matches('\0').to_owned())
}

/// Returns the advice for an X server that refuses the connection for this reason.
pub fn refused_display(reason: &str) -> Advice {
    let reason = reason.trim();
    let next_step = if reason.starts_with("Maximum number of clients") {
        "close a program that uses it"
    } else {
        "start this as the user of that graphical session, with its XAUTHORITY"
    };
    let refusal = format!("the X server refuses the connection: {}", escape(reason));
    Advice::new(refusal, next_step)
}

/// Returns the advice for a missing X server that would tell which application has the focus; `display` is the value of `DISPLAY`.
pub fn no_focus(display: Option<&str>) -> Advice {
    Advice::new(
        display_fault(display),
        "start this from the graphical session whose focus is followed, or activate profiles with keys or `ademan ctl profile`",
    )
}

fn display_fault(display: Option<&str>) -> String {
    match display {
        Some(display) => format!("no X server answers at `{}`", escape(display)),
        None => "DISPLAY is not set".into(),
    }
}

/// Returns the advice for a Wayland socket without a compositor.
pub fn no_compositor(socket: &Path, reason: &str) -> Advice {
    Advice::new(
        format!("no compositor answers at {}: {reason}", escape_path(socket)),
        "start this from a graphical session, or use the output `uinput`",
    )
}

/// Returns the advice for a compositor without virtual keyboards; `program` is its name, if known.
pub fn no_virtual_keyboard(program: Option<&str>) -> Advice {
    let program = escape(program.unwrap_or(UNKNOWN_COMPOSITOR));
    Advice::new(
        format!("{program} does not support {KEYBOARD_PROTOCOL}, so programs cannot press keys"),
        "use the output `uinput`, or `ime:uinput` instead of `ime`",
    )
}

/// Returns the advice for a compositor without virtual pointers; `program` is its name, if known.
pub fn no_virtual_pointer(program: Option<&str>) -> Advice {
    let program = escape(program.unwrap_or(UNKNOWN_COMPOSITOR));
    Advice::new(
        format!(
            "{program} does not support {POINTER_PROTOCOL}, so programs cannot move the pointer"
        ),
        "use the output `uinput` for the pointer",
    )
}

/// Returns the advice for a compositor that has an input method already.
#[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
pub fn input_method_taken() -> Advice {
    Advice::new(
        "another program is the input method of the compositor, which has one only",
        "end it (such as fcitx5, IBus, an on-screen keyboard, or another `ademan`), or use the output `desktop`",
    )
}

/// Returns the advice for a Wayland session if this program was built without Wayland support.
pub fn built_without_wayland() -> Advice {
    Advice::new(
        "WAYLAND_DISPLAY is set, but this program was built for X11, whose keys do not reach Wayland programs",
        "build it with `--features wayland`, or use the output `uinput`; to type only in X11 programs, unset \
         WAYLAND_DISPLAY",
    )
}

/// Returns the reason of a rejection, with what to do about a glove file of another glove.
pub fn rejection(reason: Rejection) -> String {
    let remedy = if reason == Rejection::WrongShape {
        "; other channels or counts than in the glove file, or no joints: name the glove of the source with --glove (`ademan gloves` \
         lists them)"
    } else {
        ""
    };
    format!("{reason}{remedy}")
}

/// Returns the advice for a missing runtime directory.
pub fn no_runtime_dir() -> Advice {
    Advice::new(
        "no control socket: XDG_RUNTIME_DIR names no folder",
        "name a path with --control PATH",
    )
}

/// Returns the advice for threads that get no high priority but this nice value.
pub fn no_priority(nice: i32) -> Advice {
    Advice::with_commands(
        format!(
            "the threads that press and release keys get nice {nice}: a busy machine can delay a release"
        ),
        &["echo \"$USER - nice -20\" | sudo tee /etc/security/limits.d/60-ademan.conf"],
        "log in again; for the user unit see docs/install.md",
    )
}

/// Returns the advice for a watchdog in the control group of the program.
pub fn watchdog_without_scope(is_session_running: bool) -> Advice {
    let reason = if is_session_running {
        "the watchdog of the running session is in the control group of the program"
    } else {
        "no user manager of systemd: a watchdog stays in the control group of the program"
    };
    Advice::new(
        reason,
        "if that group is killed as a whole, `ademan release-keys` or the next run releases the keys",
    )
}

/// Returns the advice for root.
pub fn running_as_root() -> Advice {
    Advice::new(
        "refusing to run as root: whatever reaches this program could type as root",
        "start it as a normal user (`ademan doctor` lists missing permissions), or pass --allow-root",
    )
}

fn not_in_group(reason: &str, group: &str) -> Advice {
    Advice::with_commands(
        format!("{reason}, which belongs to the group `{}`", escape(group)),
        &[&join(group)],
        LOG_IN_AGAIN,
    )
}

fn login_required(reason: &str, group: &str) -> Advice {
    Advice::new(
        format!(
            "{reason} yet: you joined its group `{}` after you logged in",
            escape(group)
        ),
        LOG_IN_AGAIN,
    )
}

fn join(group: &str) -> String {
    format!("sudo usermod --append --groups {} $USER", shell_word(group))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_is_one_line_with_commands() {
        let group = AccessDenied::NotInGroup("dialout".into());
        let later = AccessDenied::LoginRequired("dialout".into());
        let port = |denied| serial_port_denied("/dev/ttyUSB0", denied).to_string();
        let expected = [
            "no permission to open /dev/ttyUSB0, which belongs to the group `dialout`; \
             `sudo usermod --append --groups dialout $USER`, log in again",
            "no permission to open /dev/ttyUSB0 yet: you joined its group `dialout` after you logged in; \
             log in again",
        ];
        assert_eq!([port(&group), port(&later)], expected);
    }

    #[test]
    fn readings_of_another_glove_are_told_how_to_name_it() {
        let shape = rejection(Rejection::WrongShape);
        assert!(shape.starts_with("wrong-shape; "), "{shape}");
        assert!(shape.contains("--glove"), "{shape}");
        assert_eq!(rejection(Rejection::TooFast), "too-fast");
    }

    #[test]
    fn advice_never_suggests_root_or_open_permissions() {
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
