//! Tests of the checks.

use super::*;
use crate::advice::AccessDenied;
use crate::doctor::facts::{RunningInstance, User};

fn all_requirements() -> Requirements {
    Requirements {
        ports: vec!["/dev/ttyUSB0".into()],
        desktop: true,
        uinput: true,
    }
}

/// An X11 session with a connected glove and all permissions.
fn complete() -> Facts {
    Facts {
        user: User {
            name: "ana".into(),
            is_root: false,
            groups: ["ana", "dialout", "uinput"].map(str::to_owned).to_vec(),
        },
        ports: vec![("/dev/ttyUSB0".into(), DeviceNode::Usable)],
        uinput: UinputFacts {
            node: DeviceNode::Usable,
            is_loaded: true,
            can_be_loaded: Some(true),
        },
        display: XDisplay::Reachable(":0".into()),
        compositor: Compositor::Unset,
        has_wayland: false,
        granted_nice: -11,
        watchdog_scope: WatchdogScope::Available,
        runtime: RuntimeDir::Present {
            socket: "/run/user/1000/ademan/control.sock".into(),
            run: None,
        },
    }
}

/// A machine without any setup.
fn bare() -> Facts {
    Facts {
        user: User {
            name: "ana".into(),
            is_root: false,
            groups: vec!["ana".into()],
        },
        ports: Vec::new(),
        uinput: UinputFacts {
            node: DeviceNode::Absent,
            is_loaded: false,
            can_be_loaded: None,
        },
        display: XDisplay::Unset,
        compositor: Compositor::Unset,
        has_wayland: false,
        granted_nice: 0,
        watchdog_scope: WatchdogScope::Unavailable,
        runtime: RuntimeDir::Absent,
    }
}

/// Returns one line per check: subject, status, and the first command or step.
fn lines(facts: &Facts, requirements: &Requirements) -> Vec<String> {
    let line = |finding: Finding| {
        let needed = if finding.needed { "needed, " } else { "" };
        let step = finding.commands.first().unwrap_or(&finding.next_step);
        let line = format!(
            "{}: {needed}{}: {}",
            finding.check,
            finding.status.name(),
            step
        );
        line.trim_end_matches([':', ' ']).to_owned()
    };
    check(facts, requirements).into_iter().map(line).collect()
}

fn is_satisfied(facts: &Facts, requirements: &Requirements) -> bool {
    check(facts, requirements).iter().all(Finding::is_satisfied)
}

#[test]
fn a_complete_machine_needs_no_step() {
    let expected = [
        "user: ok",
        "serial port: needed, ok",
        "uinput: needed, ok",
        "display: needed, ok",
        "compositor: ok",
        "priority: ok",
        "watchdog: ok",
        "sockets: needed, ok",
    ];
    assert_eq!(lines(&complete(), &all_requirements()), expected);
    assert!(is_satisfied(&complete(), &all_requirements()));
}

#[test]
fn a_bare_machine_gets_a_step_for_each_check() {
    let mut facts = bare();
    facts.ports = vec![("/dev/ttyUSB0".into(), DeviceNode::Absent)];
    let session = "start this from a graphical session, or use the output `uinput`";
    let expected = [
        "user: ok".into(),
        "serial port: needed, missing: check the cable, or name another port: `ls /dev/serial/by-id/`"
            .into(),
        "uinput: needed, missing: sudo modprobe uinput".into(),
        format!("display: needed, missing: {session}"),
        "compositor: missing".into(),
        "priority: missing: echo \"$USER - nice -20\" | sudo tee /etc/security/limits.d/60-ademan.conf"
            .into(),
        format!("watchdog: missing: {RELEASE}"),
        "sockets: missing: name a path with --control PATH".into(),
    ];
    assert_eq!(lines(&facts, &all_requirements()), expected);
    assert!(!is_satisfied(&facts, &all_requirements()));
}

#[test]
fn only_the_requirements_of_the_setup_must_be_met() {
    assert!(is_satisfied(&bare(), &Requirements::default()));
    let lines = lines(&bare(), &Requirements::default());
    assert_eq!(
        lines[1],
        "serial port: missing: connect the glove; `ademan demo` needs none"
    );
}

#[test]
fn denied_access_leads_to_a_group_a_rule_or_a_login() {
    let of_port = |denied: AccessDenied| {
        let mut facts = complete();
        facts.ports[0].1 = DeviceNode::Denied(denied);
        check(&facts, &all_requirements()).remove(1)
    };
    let dialout = of_port(AccessDenied::NotInGroup("dialout".into()));
    assert_eq!(dialout.status, CheckStatus::Missing);
    let join = "sudo usermod --append --groups dialout $USER";
    assert_eq!(
        (dialout.commands, dialout.next_step.as_str()),
        (vec![join.to_owned()], "log in again")
    );
    let older = of_port(AccessDenied::LoginRequired("dialout".into()));
    assert_eq!(
        (older.commands, older.next_step.as_str()),
        (vec![], "log in again")
    );

    let mut facts = complete();
    facts.uinput.node = DeviceNode::Denied(AccessDenied::OwnerOnly);
    let uinput = check(&facts, &all_requirements()).remove(2);
    let expected = [
        "sudo groupadd --system --force uinput",
        "sudo usermod --append --groups uinput $USER",
        "ademan system-files udev | sudo tee /etc/udev/rules.d/60-ademan.rules",
        "sudo udevadm control --reload && sudo udevadm trigger",
    ];
    assert_eq!(uinput.commands, expected);
}

#[test]
fn a_missing_module_and_a_missing_node_have_different_advice() {
    let of_uinput = |is_loaded, can_be_loaded| {
        let mut facts = bare();
        facts.uinput.is_loaded = is_loaded;
        facts.uinput.can_be_loaded = can_be_loaded;
        lines(&facts, &all_requirements())[2].clone()
    };
    let hidden = "uinput: needed, missing: start the container with `--device /dev/uinput`";
    assert_eq!(of_uinput(true, Some(true)), hidden);
    let modprobe = "uinput: needed, missing: sudo modprobe uinput";
    assert_eq!(of_uinput(false, Some(true)), modprobe);
    assert!(of_uinput(false, Some(false)).contains("use a kernel that has it"));
}

#[test]
fn a_compositor_needs_the_protocols_and_this_program_wayland_support() {
    let of_compositor = |globals: &[&str], speaks_wayland| {
        let facts = Facts {
            compositor: Compositor::Reachable {
                program: Some("sway".into()),
                globals: globals.iter().map(|name| (*name).to_owned()).collect(),
            },
            has_wayland: speaks_wayland,
            ..complete()
        };
        lines(&facts, &all_requirements())[4].clone()
    };
    let both = [KEYBOARD_PROTOCOL, POINTER_PROTOCOL];
    assert_eq!(of_compositor(&both, true), "compositor: needed, ok");
    assert_eq!(
        of_compositor(&both[..1], true),
        "compositor: needed, ok: use the output `uinput` for the pointer"
    );
    assert_eq!(
        of_compositor(&both, false),
        "compositor: needed, missing: build it with `--features wayland`, or use the output `uinput`"
    );
    assert_eq!(
        of_compositor(&["wl_seat"], true),
        "compositor: needed, missing: use the output `uinput`, or `ime:uinput` instead of `ime`"
    );
}

#[test]
fn a_display_is_not_needed_with_a_compositor() {
    let mut facts = complete();
    facts.display = XDisplay::Unset;
    assert!(!is_satisfied(&facts, &all_requirements()));
    facts.has_wayland = true;
    facts.compositor = Compositor::Reachable {
        program: None,
        globals: vec![KEYBOARD_PROTOCOL.into()],
    };
    assert!(is_satisfied(&facts, &all_requirements()));
    facts.compositor = Compositor::Unreachable {
        socket: "/run/user/1000/wayland-0".into(),
        reason: "connection refused".into(),
    };
    assert!(!is_satisfied(&facts, &all_requirements()));
}

#[test]
fn an_x_server_that_refuses_the_connection_is_no_display() {
    let mut facts = complete();
    facts.display = XDisplay::Refused("No protocol specified\n".into());
    let findings = check(&facts, &all_requirements());
    let display = &findings[3];
    assert_eq!(
        display.text,
        "the X server refuses the connection: No protocol specified"
    );
    assert!(display.next_step.contains("XAUTHORITY"), "{display:?}");
    assert!(!is_satisfied(&facts, &all_requirements()));
}

#[test]
fn an_unknown_status_does_not_satisfy() {
    let mut facts = complete();
    facts.display = XDisplay::Unknown("`far:0` is on the network".into());
    let display = "display: needed, unknown: test it: `ademan doctor --test desktop`";
    assert_eq!(lines(&facts, &all_requirements())[3], display);
    assert!(!is_satisfied(&facts, &all_requirements()));
}

/// The next step for a watchdog without a scope.
const RELEASE: &str =
    "if that group is killed as a whole, `ademan release-keys` or the next run releases the keys";

#[test]
fn a_watchdog_that_shares_the_group_of_the_program_is_reported_and_needs_no_step() {
    let of_scope = |watchdog_scope| {
        let facts = Facts {
            watchdog_scope,
            ..complete()
        };
        assert!(is_satisfied(&facts, &all_requirements()));
        lines(&facts, &all_requirements())[6].clone()
    };
    assert_eq!(of_scope(WatchdogScope::Separate), "watchdog: ok");
    let shared = format!("watchdog: missing: {RELEASE}");
    assert_eq!(of_scope(WatchdogScope::Shared), shared);
}

fn sockets_finding(facts: &Facts) -> Finding {
    let findings = check(facts, &Requirements::default()).into_iter();
    let mut sockets = findings.filter(|finding| finding.check == "sockets");
    sockets.next().expect("the sockets are checked")
}

#[test]
fn a_second_session_and_a_long_path_are_reported() {
    let mut facts = complete();
    let socket = std::path::PathBuf::from("/run/user/1000/ademan/control.sock");
    facts.runtime = RuntimeDir::Present {
        socket: socket.clone(),
        run: Some(RunningInstance { process: Some(42) }),
    };
    let taken = sockets_finding(&facts);
    assert_eq!(
        taken.text,
        "another session listens on /run/user/1000/ademan/control.sock (process 42)"
    );
    assert!(
        taken.next_step.contains("ademan ctl stop"),
        "{}",
        taken.next_step
    );
    assert!(!taken.is_satisfied());

    facts.runtime = RuntimeDir::Present {
        socket: std::path::Path::new(&"/x".repeat(60)).join(socket.strip_prefix("/").unwrap()),
        run: None,
    };
    let long = sockets_finding(&facts);
    assert!(long.text.contains("at most 107"), "{}", long.text);
    assert!(long.next_step.contains("--control"), "{}", long.next_step);
}

#[test]
fn as_root_the_checks_say_nothing_about_the_user() {
    let mut facts = complete();
    facts.user.is_root = true;
    let root = &lines(&facts, &all_requirements())[0];
    assert!(
        root.starts_with("user: unknown: run this as the user"),
        "{root}"
    );
    assert!(is_satisfied(&facts, &all_requirements()));
}
