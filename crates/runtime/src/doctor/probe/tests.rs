//! Tests of the inspection of a Linux machine.

use std::fs::{Permissions, create_dir_all, set_permissions, write};
use std::io::{Read, Write};
use std::os::unix::fs::{PermissionsExt, chown};
use std::os::unix::net::{UnixListener, UnixStream};
use std::thread;

use rustix::process::{Gid, Uid};
use rustix::thread::{set_thread_groups, set_thread_res_gid, set_thread_res_uid};

use super::linux::*;
use crate::advice::AccessDenied;
use crate::doctor::Requirements;
use crate::doctor::facts::*;
use std::path::PathBuf;

/// User id and group id of a normal user.
const BEA: u32 = 65_101;
const PASSWD: &str = "root:x:0:0::/root:/bin/sh\nbea:x:65101:65101::/:/bin/sh\n";
const GROUPS: &str =
    "root:x:0:\nbea:x:65101:\ndialout:x:65020:ana\nuinput:x:65021:ana,bea\nbroken\n";
const DIALOUT: u32 = 65_020;
const UINPUT: u32 = 65_021;

/// A root directory with plain files instead of device nodes.
struct Root(tempfile::TempDir);

impl Root {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        set_permissions(folder.path(), Permissions::from_mode(0o755)).unwrap();
        let root = Self(folder);
        root.file("etc/passwd", PASSWD);
        root.file("etc/group", GROUPS);
        root
    }

    fn file(&self, path: &str, text: &str) -> PathBuf {
        let path = self.0.path().join(path);
        create_dir_all(path.parent().unwrap()).unwrap();
        write(&path, text).unwrap();
        path
    }

    fn device(&self, path: &str, group: u32, mode: u32) {
        let path = self.file(path, "");
        set_permissions(&path, Permissions::from_mode(mode)).unwrap();
        if is_running_as_root() {
            chown(&path, Some(0), Some(group)).unwrap();
        }
    }

    fn facts(&self, requirements: &Requirements) -> Facts {
        gather_facts(self.0.path(), &Environment::default(), requirements)
    }

    /// Gathers the facts as a user with these groups; `None` unless this process runs as root.
    fn as_bea(&self, groups: &[u32], requirements: &Requirements) -> Option<Facts> {
        if !is_running_as_root() {
            println!("SKIPPED: only root can be another user");
            return None;
        }
        let groups: Vec<_> = groups.iter().map(|group| Gid::from_raw(*group)).collect();
        let gather = || {
            // Credentials set this way apply to this thread only.
            let (user, group) = (Uid::from_raw(BEA), Gid::from_raw(BEA));
            set_thread_groups(&groups).unwrap();
            set_thread_res_gid(group, group, group).unwrap();
            set_thread_res_uid(user, user, user).unwrap();
            self.facts(requirements)
        };
        Some(thread::scope(|scope| scope.spawn(gather).join().unwrap()))
    }
}

fn port(name: &str) -> Requirements {
    Requirements {
        ports: vec![name.into()],
        ..Requirements::default()
    }
}

#[test]
fn an_empty_machine_has_no_devices() {
    let root = Root::new();
    let facts = root.facts(&port("/dev/ttyUSB0"));
    assert_eq!(facts.ports, [("/dev/ttyUSB0".into(), DeviceNode::Absent)]);
    let uinput = UinputFacts {
        node: DeviceNode::Absent,
        is_loaded: false,
        can_be_loaded: None,
    };
    assert_eq!(facts.uinput, uinput);
    assert_eq!(facts.display, XDisplay::Unset);
    assert_eq!(facts.compositor, Compositor::Unset);
    assert_eq!(facts.runtime, RuntimeDir::Absent);
    assert_eq!(root.facts(&Requirements::default()).ports, []);
}

#[test]
fn usb_adapters_are_found_and_links_to_them_are_not_listed_twice() {
    let root = Root::new();
    for name in ["ttyUSB1", "ttyACM0", "ttyS0", "null"] {
        root.device(&format!("dev/{name}"), 0, 0o666);
    }
    create_dir_all(root.0.path().join("dev/serial/by-id")).unwrap();
    let link = root.0.path().join("dev/serial/by-id/glove");
    std::os::unix::fs::symlink("../../ttyUSB1", link).unwrap();
    let names = |requirements: &Requirements| {
        let ports = root.facts(requirements).ports;
        let usable = |(name, node)| (node == DeviceNode::Usable).then_some(name);
        ports.into_iter().filter_map(usable).collect::<Vec<_>>()
    };
    assert_eq!(
        names(&Requirements::default()),
        ["/dev/ttyACM0", "/dev/ttyUSB1"]
    );
    let absolute = "/dev/serial/by-id/glove";
    assert_eq!(names(&port(absolute)), [absolute, "/dev/ttyACM0"]);
}

#[test]
fn denied_access_is_explained_by_the_mode_and_the_groups() {
    let root = Root::new();
    root.device("dev/ttyUSB0", DIALOUT, 0o660);
    root.device("dev/ttyUSB1", 0, 0o600);
    root.device("dev/ttyUSB2", 0, 0o660);
    root.device("dev/ttyUSB3", DIALOUT, 0o640);
    root.device("dev/uinput", UINPUT, 0o660);
    let Some(facts) = root.as_bea(&[], &Requirements::default()) else {
        return;
    };
    let nodes: Vec<_> = facts.ports.into_iter().map(|(_, node)| node).collect();
    let expected = [
        DeviceNode::Denied(AccessDenied::NotInGroup("dialout".into())),
        DeviceNode::Denied(AccessDenied::OwnerOnly),
        DeviceNode::Denied(AccessDenied::OwnerOnly),
        DeviceNode::Denied(AccessDenied::OwnerOnly),
    ];
    assert_eq!(nodes, expected);
    let later = DeviceNode::Denied(AccessDenied::LoginRequired("uinput".into()));
    assert_eq!(facts.uinput.node, later);
    assert_eq!(
        (facts.user.name.as_str(), facts.user.is_root),
        ("bea", false)
    );
    assert_eq!(facts.user.groups, ["bea"]);
}

#[test]
fn members_of_the_groups_may_open_the_devices() {
    let root = Root::new();
    root.device("dev/ttyUSB0", DIALOUT, 0o660);
    root.device("dev/uinput", UINPUT, 0o660);
    let Some(facts) = root.as_bea(&[DIALOUT, UINPUT], &Requirements::default()) else {
        return;
    };
    assert_eq!(facts.ports, [("/dev/ttyUSB0".into(), DeviceNode::Usable)]);
    assert_eq!(facts.uinput.node, DeviceNode::Usable);
    assert_eq!(facts.user.groups, ["dialout", "uinput", "bea"]);
}

#[test]
fn a_module_is_loaded_loadable_or_missing() {
    let root = Root::new();
    let uinput = || root.facts(&Requirements::default()).uinput;
    root.file("proc/sys/kernel/osrelease", "6.1.0-test\n");
    assert_eq!(uinput().can_be_loaded, None);
    let list = "lib/modules/6.1.0-test/modules.dep";
    root.file(list, "kernel/drivers/hid/uhid.ko:\n");
    assert_eq!(uinput().can_be_loaded, Some(false));
    root.file(
        list,
        "kernel/drivers/input/misc/uinput.ko.xz: kernel/a.ko\n",
    );
    assert_eq!(uinput().can_be_loaded, Some(true));
    assert!(!uinput().is_loaded);
    root.file("sys/class/misc/uinput/dev", "10:223\n");
    assert!(uinput().is_loaded);
}

#[test]
fn a_display_is_reachable_if_a_server_accepts_connections() {
    let root = Root::new();
    let display = |name: &str| {
        let environment = Environment {
            display: Some(name.into()),
            ..Environment::default()
        };
        gather_facts(root.0.path(), &environment, &Requirements::default()).display
    };
    assert_eq!(display(":7.0"), XDisplay::Unreachable(":7.0".into()));
    create_dir_all(root.0.path().join("tmp/.X11-unix")).unwrap();
    let reason = b"No protocol specified\n";
    let words = reason.len().div_ceil(4) as u16;
    let refusal = |status: u8, length: u8| {
        let lengths = [11_u16, 0, words].map(u16::to_ne_bytes).concat();
        let mut reply = [&[status, length][..], lengths.as_slice(), reason.as_slice()].concat();
        reply.resize(8 + 4 * usize::from(words), 0);
        reply
    };
    // A server without a screen, a format and a name.
    let lengths = [11_u16, 0, 8].map(u16::to_ne_bytes).concat();
    let accepted = [&[1, 0][..], lengths.as_slice(), &[0; 32]].concat();
    let replies = [
        accepted.clone(),
        accepted,
        refusal(0, reason.len() as u8),
        refusal(2, 0),
        // A reply that ends with its head.
        vec![3, 0, 11, 0, 0, 0, 0, 0],
    ];
    let server = UnixListener::bind(root.0.path().join("tmp/.X11-unix/X7")).unwrap();
    thread::spawn(move || {
        for reply in replies {
            let (mut client, _) = server.accept().unwrap();
            client.read_exact(&mut [0; 12]).unwrap();
            client.write_all(&reply).unwrap();
        }
    });
    assert_eq!(display(":7.0"), XDisplay::Reachable(":7.0".into()));
    assert_eq!(display("unix:7"), XDisplay::Reachable("unix:7".into()));
    let refused = XDisplay::Refused("No protocol specified\n".into());
    assert_eq!(display(":7"), refused);
    assert_eq!(display(":7"), refused);
    assert_eq!(display(":7"), XDisplay::Unreachable(":7".into()));
    assert!(matches!(display("far:7"), XDisplay::Unknown(_)));
    assert_eq!(display(":0x7"), XDisplay::Unreachable(":0x7".into()));
}

#[test]
fn an_unreachable_compositor_and_a_running_session_are_found() {
    let root = Root::new();
    let environment = Environment {
        wayland_display: Some("wayland-0".into()),
        runtime_dir: Some(root.0.path().into()),
        ..Environment::default()
    };
    let facts = || gather_facts(root.0.path(), &environment, &Requirements::default());
    let socket = root.0.path().join("ademan/control.sock");
    let Compositor::Unreachable { reason, .. } = facts().compositor else {
        panic!("no compositor listens");
    };
    assert!(reason.contains("No such file"), "{reason}");
    let free = RuntimeDir::Present {
        socket: socket.clone(),
        run: None,
    };
    assert_eq!(facts().runtime, free);
    create_dir_all(socket.parent().unwrap()).unwrap();
    let _run = UnixListener::bind(&socket).unwrap();
    let process = Some(std::process::id() as i32);
    let taken = RuntimeDir::Present {
        socket,
        run: Some(RunningInstance { process }),
    };
    assert_eq!(facts().runtime, taken);
}

#[test]
fn a_session_that_accepts_no_connection_is_found_and_not_waited_for() {
    let root = Root::new();
    let environment = Environment {
        runtime_dir: Some(root.0.path().into()),
        ..Environment::default()
    };
    let socket = root.0.path().join("ademan/control.sock");
    create_dir_all(socket.parent().unwrap()).unwrap();
    let stopped = UnixListener::bind(&socket).unwrap();
    // One client may wait.
    rustix::net::listen(&stopped, 0).unwrap();
    let _waiting = UnixStream::connect(&socket).unwrap();
    let facts = gather_facts(root.0.path(), &environment, &Requirements::default());
    let taken = RuntimeDir::Present {
        socket,
        run: Some(RunningInstance { process: None }),
    };
    assert_eq!(facts.runtime, taken);
}

#[test]
fn an_x_server_and_a_compositor_that_accept_no_connection_are_not_waited_for() {
    let root = Root::new();
    let environment = Environment {
        display: Some(":7".into()),
        wayland_display: Some("wayland-0".into()),
        runtime_dir: Some(root.0.path().into()),
    };
    create_dir_all(root.0.path().join("tmp/.X11-unix")).unwrap();
    let sockets = ["tmp/.X11-unix/X7", "wayland-0"].map(|path| root.0.path().join(path));
    let stopped = sockets.each_ref().map(|path| {
        let server = UnixListener::bind(path).unwrap();
        // One client may wait.
        rustix::net::listen(&server, 0).unwrap();
        (server, UnixStream::connect(path).unwrap())
    });
    let facts = gather_facts(root.0.path(), &environment, &Requirements::default());
    assert_eq!(facts.display, XDisplay::Unreachable(":7".into()));
    let Compositor::Unreachable { reason, .. } = facts.compositor else {
        panic!("the compositor accepts nothing");
    };
    assert!(reason.contains("accepts no connection"), "{reason}");
    drop(stopped);
}
