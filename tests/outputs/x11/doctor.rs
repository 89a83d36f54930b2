//! The doctor, where there is a display.

use ademan::output::uinput;

use crate::support::binary::ademan;
use crate::support::x11::XServer;

#[test]
fn a_display_that_is_there_is_found_and_left_as_it_was() {
    let Some(server) = XServer::start() else {
        return;
    };
    let before = server.pointer();
    let doctor = |display: &str| {
        let mut command = ademan(["doctor", "--output", "desktop", "--test", "desktop"]);
        command
            .env("DISPLAY", display)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("XDG_RUNTIME_DIR");
        let ended = command.output().expect("it starts");
        let out = String::from_utf8(ended.stdout).expect("it writes UTF-8");
        (ended.status.code(), out)
    };
    let (code, out) = doctor(server.display());
    let found = format!(
        "ok           display      needed  an X server listens at `{}`\n",
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
    assert_eq!(server.pressed_keys(), [0; 0]);

    let (code, out) = doctor(":65000");
    let silent = "missing      display      needed  no X server answers at `:65000`\n";
    assert!(out.contains(silent), "{out}");
    assert!(out.contains("fails        desktop      tested"), "{out}");
    assert_eq!(code, Some(1), "{out}");
}

#[test]
fn a_keyboard_of_the_kernel_is_tried_where_there_is_one() {
    let node = std::fs::OpenOptions::new().write(true).open("/dev/uinput");
    if let Err(error) = node {
        println!("SKIPPED: /dev/uinput cannot be written here: {error}");
        return;
    }
    let told = uinput::BACKEND.check.expect("it has a check")().expect("the kernel takes it");
    assert!(told.contains("its node appeared"), "{told}");
}
