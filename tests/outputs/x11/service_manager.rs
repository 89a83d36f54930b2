//! A service manager that is asked for a scope of the watchdog.

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

use super::ends::held_keys;
use super::hold;
use crate::support::binary::ademan;
use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_for};

/// Creates a runtime folder with the socket file of a user manager, and in its folder `bin` a `busctl` that logs its
/// arguments and its parent, and does not end.
fn manager_that_does_not_reply(runtime: &Path) {
    for folder in ["systemd", "bin"] {
        fs::create_dir(runtime.join(folder)).expect("a new folder");
    }
    fs::write(runtime.join("systemd/private"), "").expect("space on the disk");
    let busctl = runtime.join("bin/busctl");
    let log = runtime.join("calls");
    let script = format!(
        "#!/bin/sh\necho \"$PPID $*\" >>{}\nexec sleep 20\n",
        log.display()
    );
    fs::write(&busctl, script).expect("space on the disk");
    fs::set_permissions(&busctl, Permissions::from_mode(0o755)).expect("an own file");
}

#[test]
fn a_service_manager_that_does_not_reply_delays_neither_a_press_nor_a_release() {
    let Some(server) = XServer::start() else {
        return;
    };
    let press = Press::for_text("H");
    let (folder, glove, source) = Glove::in_new_folder(press.clear());
    manager_that_does_not_reply(folder.path());
    let path = std::env::var("PATH").unwrap_or_default();
    let mut command = ademan(["run", "--output", "desktop", "--source", &source]);
    command
        .env("DISPLAY", server.display())
        .env_remove("WAYLAND_DISPLAY")
        .env("XDG_RUNTIME_DIR", folder.path())
        .env("PATH", format!("{}/bin:{path}", folder.path().display()));
    let mut program = Program::from_command(command);
    program.wait_for_line("armed", 1);
    hold(&server, &program, &glove, &press, &held_keys());
    let [watchdog] = program.children()[..] else {
        panic!("one child: {:?}", program.children());
    };
    let calls = || fs::read_to_string(folder.path().join("calls")).unwrap_or_default();
    assert!(wait_for(|| !calls().is_empty()), "no call");
    let call = calls();
    assert!(call.starts_with(&format!("{watchdog} --user ")), "{call}");
    let scope = format!(
        "StartTransientUnit ssa(sv)a(sa(sv)) ademan-watchdog-{watchdog}.scope fail 5 PIDs au 1 {watchdog} "
    );
    assert!(call.contains(&scope), "{call}");
    program.signal(&["KILL"]);
    assert!(server.wait_for_keys(&[]), "{:?}", server.pressed_keys());
    assert_eq!(program.wait_for_exit().code(), None);
}
