use super::*;
use crate::advice::AccessDenied;
use crate::doctor::facts::{RunningInstance, User};

fn wants_all() -> Requirements {
    Requirements {
        ports: vec!["/dev/ttyUSB0".into()],
        desktop: true,
        uinput: true,
    }
}

/// A session on X11 with a glove in it.
fn everything() -> Facts {
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
        runtime: RuntimeDir::Present {
            socket: "/run/user/1000/ademan/control.sock".into(),
            run: None,
        },
    }
}

/// A machine that nobody has set up.
fn nothing() -> Facts {
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
        runtime: RuntimeDir::Absent,
    }
}

/// One line for each check: what it is, how it is, whether that suffices, and the first remedy.
fn told(facts: &Facts, wants: &Requirements) -> Vec<String> {
    let line = |finding: Finding| {
        let needed = if finding.needed { "needed, " } else { "" };
        let remedy = finding.fix.first().unwrap_or(&finding.then);
        let line = format!(
            "{}: {needed}{}: {}",
            finding.check,
            finding.state.name(),
            remedy
        );
        line.trim_end_matches([':', ' ']).to_owned()
    };
    check(facts, wants).into_iter().map(line).collect()
}

fn suffices(facts: &Facts, wants: &Requirements) -> bool {
    check(facts, wants).iter().all(Finding::is_satisfied)
}

#[test]
fn a_machine_with_everything_is_told_to_do_nothing() {
    let expected = [
        "user: ok",
        "serial port: needed, ok",
        "uinput: needed, ok",
        "display: needed, ok",
        "compositor: ok",
        "sockets: needed, ok",
    ];
    assert_eq!(told(&everything(), &wants_all()), expected);
    assert!(suffices(&everything(), &wants_all()));
}

#[test]
fn a_machine_with_nothing_is_told_what_each_thing_takes() {
    let mut facts = nothing();
    facts.ports = vec![("/dev/ttyUSB0".into(), DeviceNode::Absent)];
    let session = "start this from a graphical session, or use the output `uinput`";
    let expected = [
        "user: ok".into(),
        "serial port: needed, missing: check the cable, or name another port: `ls /dev/serial/by-id/`"
            .into(),
        "uinput: needed, missing: sudo modprobe uinput".into(),
        format!("display: needed, missing: {session}"),
        "compositor: ok".into(),
        "sockets: missing: --control PATH makes one".into(),
    ];
    assert_eq!(told(&facts, &wants_all()), expected);
    assert!(!suffices(&facts, &wants_all()));
}

#[test]
fn what_a_setup_does_not_name_may_be_missing() {
    assert!(suffices(&nothing(), &Requirements::default()));
    let transcript = told(&nothing(), &Requirements::default());
    assert_eq!(
        transcript[1],
        "serial port: missing: plug the glove in; `ademan demo` needs none"
    );
}

#[test]
fn who_has_no_permission_is_told_the_group_the_rule_or_to_log_in_again() {
    let of_port = |denied: AccessDenied| {
        let mut facts = everything();
        facts.ports[0].1 = DeviceNode::Denied(denied);
        check(&facts, &wants_all()).remove(1)
    };
    let dialout = of_port(AccessDenied::NotInGroup("dialout".into()));
    assert_eq!(dialout.state, CheckStatus::Missing);
    let join = "sudo usermod --append --groups dialout $USER";
    assert_eq!(
        (dialout.fix, dialout.then.as_str()),
        (vec![join.to_owned()], "log in again")
    );
    let older = of_port(AccessDenied::LoginRequired("dialout".into()));
    assert_eq!((older.fix, older.then.as_str()), (vec![], "log in again"));

    let mut facts = everything();
    facts.uinput.node = DeviceNode::Denied(AccessDenied::OwnerOnly);
    let uinput = check(&facts, &wants_all()).remove(2);
    let expected = [
        "sudo groupadd --system --force uinput",
        "sudo usermod --append --groups uinput $USER",
        "ademan setup --print udev | sudo tee /etc/udev/rules.d/60-ademan.rules",
        "sudo udevadm control --reload && sudo udevadm trigger",
    ];
    assert_eq!(uinput.fix, expected);
}

#[test]
fn a_module_that_cannot_be_loaded_and_a_node_that_is_hidden_are_told_apart() {
    let of_uinput = |is_loaded, can_be_loaded| {
        let mut facts = nothing();
        facts.uinput.is_loaded = is_loaded;
        facts.uinput.can_be_loaded = can_be_loaded;
        told(&facts, &wants_all())[2].clone()
    };
    let hidden = "uinput: needed, missing: start the container with `--device /dev/uinput`";
    assert_eq!(of_uinput(true, Some(true)), hidden);
    let modprobe = "uinput: needed, missing: sudo modprobe uinput";
    assert_eq!(of_uinput(false, Some(true)), modprobe);
    assert!(of_uinput(false, Some(false)).contains("use a kernel that has it"));
}

#[test]
fn a_compositor_counts_by_what_it_offers_and_by_what_this_program_speaks() {
    let of_compositor = |globals: &[&str], speaks_wayland| {
        let facts = Facts {
            compositor: Compositor::Reachable {
                program: Some("sway".into()),
                globals: globals.iter().map(|name| (*name).to_owned()).collect(),
            },
            has_wayland: speaks_wayland,
            ..everything()
        };
        told(&facts, &wants_all())[4].clone()
    };
    let both = [KEYBOARD_PROTOCOL, POINTER_PROTOCOL];
    assert_eq!(of_compositor(&both, true), "compositor: needed, ok");
    assert_eq!(
        of_compositor(&both[..1], true),
        "compositor: needed, ok: let the output `uinput` move the pointer"
    );
    assert_eq!(
        of_compositor(&both, false),
        "compositor: needed, missing: build it with `--features wayland`, or use the output `uinput`"
    );
    assert_eq!(
        of_compositor(&["wl_seat"], true),
        "compositor: needed, missing: use the output `uinput`"
    );
}

#[test]
fn a_display_is_not_needed_where_a_compositor_is_spoken_with() {
    let mut facts = everything();
    facts.display = XDisplay::Unset;
    assert!(!suffices(&facts, &wants_all()));
    facts.has_wayland = true;
    facts.compositor = Compositor::Reachable {
        program: None,
        globals: vec![KEYBOARD_PROTOCOL.into()],
    };
    assert!(suffices(&facts, &wants_all()));
    facts.compositor = Compositor::Unreachable {
        socket: "/run/user/1000/wayland-0".into(),
        reason: "connection refused".into(),
    };
    assert!(!suffices(&facts, &wants_all()));
}

#[test]
fn what_only_a_trial_shows_is_not_taken_for_granted() {
    let mut facts = everything();
    facts.display = XDisplay::Unknown("`far:0` is on the network".into());
    let display = "display: needed, cannot tell: try it: `ademan doctor --test desktop`";
    assert_eq!(told(&facts, &wants_all())[3], display);
    assert!(!suffices(&facts, &wants_all()));
}

#[test]
fn a_second_run_and_a_path_that_is_too_long_are_known_beforehand() {
    let mut facts = everything();
    let socket = std::path::PathBuf::from("/run/user/1000/ademan/control.sock");
    facts.runtime = RuntimeDir::Present {
        socket: socket.clone(),
        run: Some(RunningInstance { process: Some(42) }),
    };
    let taken = check(&facts, &Requirements::default()).remove(5);
    assert_eq!(
        taken.text,
        "another run listens at /run/user/1000/ademan/control.sock (process 42)"
    );
    assert!(taken.then.contains("ademan ctl stop"), "{}", taken.then);
    assert!(!taken.is_satisfied());

    facts.runtime = RuntimeDir::Present {
        socket: std::path::Path::new(&"/x".repeat(60)).join(socket.strip_prefix("/").unwrap()),
        run: None,
    };
    let long = check(&facts, &Requirements::default()).remove(5);
    assert!(long.text.contains("107 at most"), "{}", long.text);
    assert!(long.then.contains("--control"), "{}", long.then);
}

#[test]
fn root_learns_that_nothing_of_this_is_about_the_user() {
    let mut facts = everything();
    facts.user.is_root = true;
    let root = &told(&facts, &wants_all())[0];
    assert!(root.starts_with("user: cannot tell: ask again"), "{root}");
    assert!(suffices(&facts, &wants_all()));
}
