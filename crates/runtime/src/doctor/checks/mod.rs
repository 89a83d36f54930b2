//! Checks of the facts about a machine.

use super::facts::{
    Compositor, DeviceNode, Facts, RuntimeDir, UinputFacts, WatchdogScope, XDisplay,
};
use super::probe::{ABSENT, LISTS_PORTS};
use super::{CheckStatus, Finding, Requirements};
use crate::advice::{self, Advice, KEYBOARD_PROTOCOL, POINTER_PROTOCOL};
use crate::session::control_socket::{self, ControlError};
use ademan_core::message::{escape, escape_path};

/// Performs all checks, in the order of the data flow from the glove to the screen.
pub fn check(facts: &Facts, requirements: &Requirements) -> Vec<Finding> {
    let mut findings = vec![check_user(facts)];
    findings.extend(check_ports(facts, requirements));
    findings.push(check_uinput(&facts.uinput, requirements));
    findings.push(check_display(facts, requirements));
    findings.push(check_compositor(facts, requirements));
    findings.push(check_priority(facts));
    findings.push(check_watchdog(facts.watchdog_scope));
    findings.push(check_sockets(&facts.runtime));
    findings.retain(|finding| !ABSENT.contains(&finding.check));
    findings
}

fn ok(check: &'static str, needed: bool, text: impl Into<String>) -> Finding {
    finding(check, CheckStatus::Ok, needed, Advice::new(text, ""))
}

fn finding(check: &'static str, status: CheckStatus, needed: bool, advice: Advice) -> Finding {
    Finding {
        check,
        status,
        needed,
        text: advice.reason,
        commands: advice.commands,
        next_step: advice.next_step,
    }
}

fn check_user(facts: &Facts) -> Finding {
    let user = &facts.user;
    if user.is_root {
        let advice = Advice::new(
            "root has all permissions, so these checks do not apply to you as a normal user",
            "run this as the user who will run `ademan run`, which refuses root",
        );
        return finding("user", CheckStatus::Unknown, false, advice);
    }
    let groups = user.groups.join(" ");
    ok(
        "user",
        false,
        format!("{}, groups: {}", escape(&user.name), escape(&groups)),
    )
}

fn check_ports(facts: &Facts, requirements: &Requirements) -> Vec<Finding> {
    if facts.ports.is_empty() && LISTS_PORTS {
        let advice = Advice::new(
            "no USB serial adapter found",
            "connect the glove; `ademan demo` needs none",
        );
        return vec![finding("serial port", CheckStatus::Missing, false, advice)];
    }
    let check = |(name, node): &(String, DeviceNode)| {
        check_port(name, node, requirements.ports.contains(name))
    };
    facts.ports.iter().map(check).collect()
}

fn check_port(name: &str, node: &DeviceNode, needed: bool) -> Finding {
    let shown = escape(name);
    let advice = match node {
        DeviceNode::Usable => {
            return ok("serial port", needed, format!("{shown} can be opened"));
        }
        DeviceNode::Denied(denied) => advice::serial_port_denied(name, denied),
        DeviceNode::Absent => Advice::new(
            format!("{shown} does not exist"),
            "check the cable, or name another port: `ls /dev/serial/by-id/`",
        ),
        DeviceNode::Error(reason) => Advice::new(format!("{shown}: {reason}"), ""),
    };
    finding("serial port", CheckStatus::Missing, needed, advice)
}

fn check_uinput(uinput: &UinputFacts, requirements: &Requirements) -> Finding {
    let needed = requirements.uinput;
    let advice = match (&uinput.node, uinput.is_loaded, uinput.can_be_loaded) {
        (DeviceNode::Usable, ..) => return ok("uinput", needed, "/dev/uinput can be opened"),
        (DeviceNode::Denied(denied), ..) => advice::uinput_denied(denied),
        (DeviceNode::Error(reason), ..) => Advice::new(format!("/dev/uinput: {reason}"), ""),
        (DeviceNode::Absent, true, _) => advice::uinput_node_missing(),
        (DeviceNode::Absent, false, Some(false)) => advice::uinput_not_in_kernel(),
        (DeviceNode::Absent, false, _) => advice::uinput_not_loaded(),
    };
    finding("uinput", CheckStatus::Missing, needed, advice)
}

/// Returns `true` if the output `desktop` uses the compositor instead of the X server.
fn uses_compositor(facts: &Facts) -> bool {
    facts.compositor != Compositor::Unset
}

fn check_display(facts: &Facts, requirements: &Requirements) -> Finding {
    let needed = requirements.desktop && !uses_compositor(facts);
    let (status, advice) = match &facts.display {
        XDisplay::Reachable(name) => {
            let text = format!("an X server accepts connections at `{}`", escape(name));
            return ok("display", needed, text);
        }
        XDisplay::Unreachable(name) => (CheckStatus::Missing, advice::no_display(Some(name))),
        XDisplay::Refused(reason) => (CheckStatus::Missing, advice::refused_display(reason)),
        XDisplay::Unset => (CheckStatus::Missing, advice::no_display(None)),
        XDisplay::Unknown(reason) => {
            let advice = Advice::new(reason, "test it: `ademan doctor --test desktop`");
            (CheckStatus::Unknown, advice)
        }
    };
    finding("display", status, needed, advice)
}

fn is_without_display(display: &XDisplay) -> bool {
    matches!(
        display,
        XDisplay::Unset | XDisplay::Unreachable(_) | XDisplay::Refused(_)
    )
}

fn check_compositor(facts: &Facts, requirements: &Requirements) -> Finding {
    let needed = requirements.desktop && uses_compositor(facts);
    let (program, globals) = match &facts.compositor {
        // The check of the display has the remedy.
        Compositor::Unset if is_without_display(&facts.display) => {
            let advice = Advice::new("WAYLAND_DISPLAY is not set", "");
            return finding("compositor", CheckStatus::Missing, false, advice);
        }
        Compositor::Unset => {
            let text = "none: WAYLAND_DISPLAY is not set, keys go to the X server";
            return ok("compositor", false, text);
        }
        Compositor::Unreachable { socket, reason } => {
            let advice = advice::no_compositor(socket, reason);
            return finding("compositor", CheckStatus::Missing, needed, advice);
        }
        Compositor::Reachable { program, globals } => (program, globals),
    };
    let supports = |protocol: &str| globals.iter().any(|global| global == protocol);
    let name = &*escape(program.as_deref().unwrap_or("the compositor"));
    let (status, advice) = match (supports(KEYBOARD_PROTOCOL), facts.has_wayland) {
        (false, _) => (
            CheckStatus::Missing,
            advice::no_virtual_keyboard(Some(name)),
        ),
        (true, false) => {
            let advice = Advice::new(
                format!(
                    "{name} supports virtual keyboards, but this program was built without Wayland support"
                ),
                "build it with `--features wayland`, or use the output `uinput`",
            );
            (CheckStatus::Missing, advice)
        }
        (true, true) if supports(POINTER_PROTOCOL) => {
            let text = format!("{name} supports virtual keyboards and pointers");
            (CheckStatus::Ok, Advice::new(text, ""))
        }
        (true, true) => (CheckStatus::Ok, advice::no_virtual_pointer(Some(name))),
    };
    finding("compositor", status, needed, advice)
}

/// Checks the priority of the threads that press and release keys. They work without one.
fn check_priority(facts: &Facts) -> Finding {
    let nice = facts.granted_nice;
    if nice < 0 {
        let text = format!("the threads that press and release keys get nice {nice}");
        return ok("priority", false, text);
    }
    let advice = advice::no_priority(nice);
    finding("priority", CheckStatus::Missing, false, advice)
}

/// Checks the control group of the watchdog. It works in any group that is not killed as a whole.
fn check_watchdog(scope: WatchdogScope) -> Finding {
    let text = match scope {
        WatchdogScope::Separate => {
            "the watchdog of the running session has a systemd scope of its own"
        }
        WatchdogScope::Available => {
            "a watchdog gets a scope of its own from the user manager of systemd"
        }
        WatchdogScope::Shared | WatchdogScope::Unavailable => {
            let advice = advice::watchdog_without_scope(scope == WatchdogScope::Shared);
            return finding("watchdog", CheckStatus::Missing, false, advice);
        }
    };
    ok("watchdog", false, text)
}

/// Checks the control socket. A session works without one, but not with the one of another session.
fn check_sockets(runtime: &RuntimeDir) -> Finding {
    let (socket, run) = match runtime {
        RuntimeDir::Absent => {
            let advice = advice::no_runtime_dir();
            return finding("sockets", CheckStatus::Missing, false, advice);
        }
        RuntimeDir::Present { socket, run } => (socket, run),
    };
    if let Err(error) = control_socket::check_path(socket) {
        let advice = advice_of(&error);
        return finding("sockets", CheckStatus::Missing, true, advice);
    }
    let Some(run) = run else {
        let text = format!("{} is free", escape_path(socket));
        return ok("sockets", true, text);
    };
    let mut advice = advice_of(&ControlError::InUse {
        path: socket.clone(),
    });
    if let Some(process) = run.process {
        advice.reason += &format!(" (process {process})");
    }
    finding("sockets", CheckStatus::Missing, true, advice)
}

/// Splits the text of an error at the semicolon before the advice.
fn advice_of(error: &ControlError) -> Advice {
    let text = error.to_string();
    match text.rsplit_once("; ") {
        Some((reason, next_step)) => Advice::new(reason, next_step),
        None => Advice::new(text, ""),
    }
}

#[cfg(test)]
mod tests;
