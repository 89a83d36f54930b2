//! [`Facts`] → [`Finding`]s: each check is a function of what was found.

use super::facts::{Compositor, DeviceNode, Facts, RuntimeDir, UinputFacts, XDisplay};
use super::{CheckStatus, Finding, Requirements};
use crate::advice::{self, Advice, KEYBOARD_PROTOCOL, POINTER_PROTOCOL};
use crate::session::control_socket::{self, ControlError};

/// All checks, in the order of the way from the glove to the screen.
pub fn check(facts: &Facts, wants: &Requirements) -> Vec<Finding> {
    let mut findings = vec![user(facts)];
    findings.extend(ports(facts, wants));
    findings.push(uinput(&facts.uinput, wants));
    findings.push(display(facts, wants));
    findings.push(compositor(facts, wants));
    findings.push(sockets(&facts.runtime));
    findings
}

fn ok(check: &'static str, needed: bool, text: impl Into<String>) -> Finding {
    finding(check, CheckStatus::Ok, needed, Advice::new(text, ""))
}

fn finding(check: &'static str, state: CheckStatus, needed: bool, advice: Advice) -> Finding {
    Finding {
        check,
        state,
        needed,
        text: advice.reason,
        fix: advice.commands,
        then: advice.next_step,
    }
}

fn user(facts: &Facts) -> Finding {
    let user = &facts.user;
    if user.is_root {
        let advice = Advice::new(
            "root may do everything, so what follows says nothing of you",
            "ask again as the user who will run it; `ademan run` refuses root",
        );
        return finding("user", CheckStatus::Unknown, false, advice);
    }
    let groups = user.groups.join(" ");
    ok("user", false, format!("{}, groups: {groups}", user.name))
}

fn ports(facts: &Facts, wants: &Requirements) -> Vec<Finding> {
    if facts.ports.is_empty() {
        let advice = Advice::new(
            "no USB serial adapter is there",
            "plug the glove in; `ademan demo` needs none",
        );
        return vec![finding("serial port", CheckStatus::Missing, false, advice)];
    }
    let of_port =
        |(name, node): &(String, DeviceNode)| port(name, node, wants.ports.contains(name));
    facts.ports.iter().map(of_port).collect()
}

fn port(name: &str, node: &DeviceNode, needed: bool) -> Finding {
    let advice = match node {
        DeviceNode::Usable => return ok("serial port", needed, format!("{name} may be opened")),
        DeviceNode::Denied(denied) => advice::serial_port_denied(name, denied),
        DeviceNode::Absent => Advice::new(
            format!("{name} is not there"),
            "check the cable, or name another port: `ls /dev/serial/by-id/`",
        ),
        DeviceNode::Error(reason) => Advice::new(format!("{name}: {reason}"), ""),
    };
    finding("serial port", CheckStatus::Missing, needed, advice)
}

fn uinput(uinput: &UinputFacts, wants: &Requirements) -> Finding {
    let advice = match (&uinput.node, uinput.is_loaded, uinput.can_be_loaded) {
        (DeviceNode::Usable, ..) => return ok("uinput", wants.uinput, "/dev/uinput may be opened"),
        (DeviceNode::Denied(denied), ..) => advice::uinput_denied(denied),
        (DeviceNode::Error(reason), ..) => Advice::new(format!("/dev/uinput: {reason}"), ""),
        (DeviceNode::Absent, true, _) => advice::uinput_node_missing(),
        (DeviceNode::Absent, false, Some(false)) => advice::uinput_not_in_kernel(),
        (DeviceNode::Absent, false, _) => advice::uinput_not_loaded(),
    };
    finding("uinput", CheckStatus::Missing, wants.uinput, advice)
}

/// Whether the output `desktop` would speak with the compositor rather than with an X server.
fn is_for_wayland(facts: &Facts) -> bool {
    facts.compositor != Compositor::Unset
}

fn display(facts: &Facts, wants: &Requirements) -> Finding {
    let needed = wants.desktop && !is_for_wayland(facts);
    let (state, advice) = match &facts.display {
        XDisplay::Reachable(name) => {
            return ok(
                "display",
                needed,
                format!("an X server listens at `{name}`"),
            );
        }
        XDisplay::Unreachable(name) => (CheckStatus::Missing, advice::no_display(Some(name))),
        XDisplay::Unset => (CheckStatus::Missing, advice::no_display(None)),
        XDisplay::Unknown(reason) => (
            CheckStatus::Unknown,
            Advice::new(reason, "try it: `ademan doctor --test desktop`"),
        ),
    };
    finding("display", state, needed, advice)
}

fn compositor(facts: &Facts, wants: &Requirements) -> Finding {
    let needed = wants.desktop && facts.compositor != Compositor::Unset;
    let (program, globals) = match &facts.compositor {
        Compositor::Unset => {
            return ok(
                "compositor",
                false,
                "none: WAYLAND_DISPLAY is not set, keys go to the display",
            );
        }
        Compositor::Unreachable { socket, reason } => {
            let advice = advice::no_compositor(socket, reason);
            return finding("compositor", CheckStatus::Missing, needed, advice);
        }
        Compositor::Reachable { program, globals } => (program, globals),
    };
    let has = |protocol: &str| globals.iter().any(|global| global == protocol);
    let name = program.as_deref().unwrap_or("the compositor");
    let (state, advice) = match (has(KEYBOARD_PROTOCOL), facts.has_wayland) {
        (false, _) => (
            CheckStatus::Missing,
            advice::no_virtual_keyboard(Some(name)),
        ),
        (true, false) => (
            CheckStatus::Missing,
            Advice::new(
                format!("{name} has the virtual keyboard, and this program was built without it"),
                "build it with `--features wayland`, or use the output `uinput`",
            ),
        ),
        (true, true) if has(POINTER_PROTOCOL) => (
            CheckStatus::Ok,
            Advice::new(format!("{name} has virtual keyboard and pointer"), ""),
        ),
        (true, true) => (CheckStatus::Ok, advice::no_virtual_pointer(Some(name))),
    };
    finding("compositor", state, needed, advice)
}

/// A run does without a control socket, but not beside another run at the same one.
fn sockets(runtime: &RuntimeDir) -> Finding {
    let (socket, run) = match runtime {
        RuntimeDir::Absent => {
            return finding(
                "sockets",
                CheckStatus::Missing,
                false,
                advice::no_runtime_dir(),
            );
        }
        RuntimeDir::Present { socket, run } => (socket, run),
    };
    if let Err(error) = control_socket::check_path(socket) {
        return finding("sockets", CheckStatus::Missing, true, of_control(&error));
    }
    let Some(run) = run else {
        let text = format!("{} is free", socket.display());
        return ok("sockets", true, text);
    };
    let mut advice = of_control(&ControlError::InUse {
        path: socket.clone(),
    });
    if let Some(process) = run.process {
        advice.reason += &format!(" (process {process})");
    }
    finding("sockets", CheckStatus::Missing, true, advice)
}

/// What happened comes before the colon or semicolon that what to do follows.
fn of_control(error: &ControlError) -> Advice {
    let text = error.to_string();
    match text.rsplit_once("; ").or(text.rsplit_once(": ")) {
        Some((reason, then)) => Advice::new(reason, then),
        None => Advice::new(text, ""),
    }
}

#[cfg(test)]
mod tests;
