//! [`Facts`] → [`Finding`]s: each check is a function of what was found.

use super::facts::{Compositor, Display, Facts, Node, Runtime, Uinput};
use super::{Finding, State, Wants};
use crate::access::{self, Advice, KEYBOARD_PROTOCOL, POINTER_PROTOCOL};
use crate::control::{self, ControlError};

/// All checks, in the order of the way from the glove to the screen.
pub fn examine(facts: &Facts, wants: &Wants) -> Vec<Finding> {
    let mut findings = vec![user(facts)];
    findings.extend(ports(facts, wants));
    findings.push(uinput(&facts.uinput, wants));
    findings.push(display(facts, wants));
    findings.push(compositor(facts, wants));
    findings.push(sockets(&facts.runtime));
    findings
}

fn ok(check: &'static str, needed: bool, text: impl Into<String>) -> Finding {
    finding(check, State::Ok, needed, Advice::plain(text, ""))
}

fn finding(check: &'static str, state: State, needed: bool, advice: Advice) -> Finding {
    Finding {
        check,
        state,
        needed,
        text: advice.reason,
        fix: advice.commands,
        then: advice.then,
    }
}

fn user(facts: &Facts) -> Finding {
    let user = &facts.user;
    if user.is_root {
        let advice = Advice::plain(
            "root may do everything, so what follows says nothing of you",
            "ask again as the user who will run it; `ademan run` refuses root",
        );
        return finding("user", State::CannotTell, false, advice);
    }
    let groups = user.groups.join(" ");
    ok("user", false, format!("{}, groups: {groups}", user.name))
}

fn ports(facts: &Facts, wants: &Wants) -> Vec<Finding> {
    if facts.ports.is_empty() {
        let advice = Advice::plain(
            "no USB serial adapter is there",
            "plug the glove in; `ademan demo` needs none",
        );
        return vec![finding("serial port", State::Missing, false, advice)];
    }
    let of_port = |(name, node): &(String, Node)| port(name, node, wants.ports.contains(name));
    facts.ports.iter().map(of_port).collect()
}

fn port(name: &str, node: &Node, needed: bool) -> Finding {
    let advice = match node {
        Node::Usable => return ok("serial port", needed, format!("{name} may be opened")),
        Node::Denied(denied) => access::port_denied(name, denied),
        Node::Absent => Advice::plain(
            format!("{name} is not there"),
            "check the cable, or name another port: `ls /dev/serial/by-id/`",
        ),
        Node::Odd(reason) => Advice::plain(format!("{name}: {reason}"), ""),
    };
    finding("serial port", State::Missing, needed, advice)
}

fn uinput(uinput: &Uinput, wants: &Wants) -> Finding {
    let advice = match (&uinput.node, uinput.is_loaded, uinput.can_be_loaded) {
        (Node::Usable, ..) => return ok("uinput", wants.uinput, "/dev/uinput may be opened"),
        (Node::Denied(denied), ..) => access::uinput_denied(denied),
        (Node::Odd(reason), ..) => Advice::plain(format!("/dev/uinput: {reason}"), ""),
        (Node::Absent, true, _) => access::uinput_hidden(),
        (Node::Absent, false, Some(false)) => access::uinput_not_in_kernel(),
        (Node::Absent, false, _) => access::uinput_absent(),
    };
    finding("uinput", State::Missing, wants.uinput, advice)
}

/// Whether the output `desktop` would speak with the compositor rather than with an X server.
fn is_for_wayland(facts: &Facts) -> bool {
    facts.compositor != Compositor::Unset
}

fn display(facts: &Facts, wants: &Wants) -> Finding {
    let needed = wants.desktop && !is_for_wayland(facts);
    let (state, advice) = match &facts.display {
        Display::Listens(name) => {
            return ok(
                "display",
                needed,
                format!("an X server listens at `{name}`"),
            );
        }
        Display::Silent(name) => (State::Missing, access::no_display(Some(name))),
        Display::Unset => (State::Missing, access::no_display(None)),
        Display::Unseen(reason) => (
            State::CannotTell,
            Advice::plain(reason, "try it: `ademan doctor --test desktop`"),
        ),
    };
    finding("display", state, needed, advice)
}

fn compositor(facts: &Facts, wants: &Wants) -> Finding {
    let needed = wants.desktop && facts.compositor != Compositor::Unset;
    let (program, globals) = match &facts.compositor {
        Compositor::Unset => {
            return ok(
                "compositor",
                false,
                "none: WAYLAND_DISPLAY is not set, keys go to the display",
            );
        }
        Compositor::Silent { socket, reason } => {
            let advice = access::no_compositor(socket, reason);
            return finding("compositor", State::Missing, needed, advice);
        }
        Compositor::Answers { program, globals } => (program, globals),
    };
    let has = |protocol: &str| globals.iter().any(|global| global == protocol);
    let name = program.as_deref().unwrap_or("the compositor");
    let (state, advice) = match (has(KEYBOARD_PROTOCOL), facts.speaks_wayland) {
        (false, _) => (State::Missing, access::no_virtual_keyboard(Some(name))),
        (true, false) => (
            State::Missing,
            Advice::plain(
                format!("{name} has the virtual keyboard, and this program was built without it"),
                "build it with `--features wayland`, or use the output `uinput`",
            ),
        ),
        (true, true) if has(POINTER_PROTOCOL) => (
            State::Ok,
            Advice::plain(format!("{name} has virtual keyboard and pointer"), ""),
        ),
        (true, true) => (State::Ok, access::no_virtual_pointer(Some(name))),
    };
    finding("compositor", state, needed, advice)
}

/// A run does without a control socket, but not beside another run at the same one.
fn sockets(runtime: &Runtime) -> Finding {
    let (socket, run) = match runtime {
        Runtime::Absent => {
            return finding(
                "sockets",
                State::Missing,
                false,
                access::no_runtime_folder(),
            );
        }
        Runtime::Present { socket, run } => (socket, run),
    };
    if let Err(error) = control::fits(socket) {
        return finding("sockets", State::Missing, true, of_control(&error));
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
    finding("sockets", State::Missing, true, advice)
}

/// What happened comes before the colon or semicolon that what to do follows.
fn of_control(error: &ControlError) -> Advice {
    let text = error.to_string();
    match text.rsplit_once("; ").or(text.rsplit_once(": ")) {
        Some((reason, then)) => Advice::plain(reason, then),
        None => Advice::plain(text, ""),
    }
}

#[cfg(test)]
mod tests;
