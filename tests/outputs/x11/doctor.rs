//! `ademan doctor` with a display.

use ademan::output::uinput;

use crate::support::binary::ademan;
use crate::support::key_log::KeyLog;
use crate::support::x11::XServer;

#[test]
fn the_doctor_finds_a_display_and_leaves_it_unchanged() {
    let Some(server) = XServer::start() else {
        return;
    };
    let log = KeyLog::start(&server);
    let before = server.pointer();
    let doctor = |display: &str| {
        let mut command = ademan(["doctor", "--output", "desktop", "--test", "desktop"]);
        command
            .env("DISPLAY", display)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("XDG_RUNTIME_DIR");
        let output = command.output().expect("the program starts");
        let out = String::from_utf8(output.stdout).expect("UTF-8");
        (output.status.code(), out)
    };
    let (code, out) = doctor(server.display());
    let found = format!(
        "ok           display      needed  an X server accepts connections at `{}`\n",
        server.display()
    );
    assert!(out.contains(&found), "{out}");
    assert!(
        out.contains("works        desktop      tested  connected"),
        "{out}"
    );
    assert_eq!(code, Some(0), "{out}");
    let after = server.pointer();
    assert_eq!(after, before);
    assert_eq!(log.events(), []);

    let (missing_code, missing_out) = doctor(":65000");
    let missing = "missing      display      needed  no X server answers at `:65000`\n";
    assert!(missing_out.contains(missing), "{missing_out}");
    assert!(
        missing_out.contains("fails        desktop      tested"),
        "{missing_out}"
    );
    assert_eq!(missing_code, Some(1), "{missing_out}");
}

#[test]
fn the_uinput_check_finds_the_node_of_its_keyboard() {
    let node = std::fs::OpenOptions::new().write(true).open("/dev/uinput");
    if let Err(error) = node {
        println!("SKIPPED: cannot write to /dev/uinput: {error}");
        return;
    }
    let check = uinput::BACKEND.check.expect("a check");
    let result = check().expect("the kernel creates a keyboard");
    assert!(result.contains("its node appeared"), "{result}");
}
