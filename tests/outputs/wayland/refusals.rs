//! Messages of `ademan run` and `ademan doctor` for displays that cannot be used.

use std::process::Command;

use super::compositor::Compositor;

/// Returns the exit code, the standard output and the standard error.
fn run_to_end(mut command: Command) -> (Option<i32>, String, String) {
    let output = command.output().expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (
        output.status.code(),
        text(output.stdout),
        text(output.stderr),
    )
}

const DOCTOR: [&str; 5] = ["doctor", "--output", "desktop", "--test", "desktop"];

#[test]
fn a_compositor_without_virtual_keyboards_is_an_error_and_the_doctor_reports_it() {
    let Some(compositor) = Compositor::weston() else {
        return;
    };
    let run = compositor.ademan(["run", "--output", "desktop", "--source", "typist:hi"]);
    let (code, _, text) = run_to_end(run);
    let why = "does not support zwp_virtual_keyboard_manager_v1, so programs cannot press keys";
    let expected = format!(
        "error: cannot open the output `desktop`: the compositor {why}; use the output `uinput`, or `ime:uinput` instead of `ime`\n"
    );
    assert!(text.ends_with(&expected), "{text}");
    assert_eq!(code, Some(2));
    let (doctor_code, doctor_text, _) = run_to_end(compositor.ademan(DOCTOR));
    let doctor_expected = format!("missing      compositor   needed  weston {why}\n");
    assert!(doctor_text.contains(&doctor_expected), "{doctor_text}");
    assert!(
        doctor_text.contains("use the output `uinput`"),
        "{doctor_text}"
    );
    assert!(
        doctor_text.contains("fails        desktop      tested"),
        "{doctor_text}"
    );
    assert_eq!(doctor_code, Some(1));
}

#[test]
fn the_doctor_finds_and_tests_a_compositor_with_virtual_devices() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let (code, text, _) = run_to_end(compositor.ademan(DOCTOR));
    let found = "ok           compositor   needed  sway supports virtual keyboards and pointers\n";
    assert!(text.contains(found), "{text}");
    let tried = "works        desktop      tested  connected";
    assert!(text.contains(tried), "{text}");
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn there_is_no_fallback_to_an_x_server_if_the_compositor_does_not_answer() {
    let Some(server) = crate::support::x11::XServer::start() else {
        return;
    };
    let mut run =
        crate::support::binary::ademan(["run", "--output", "desktop", "--source", "typist:hi"]);
    run.env("DISPLAY", server.display())
        .env("WAYLAND_DISPLAY", "/nowhere/wayland-0")
        .env_remove("XDG_RUNTIME_DIR");
    let (code, _, text) = run_to_end(run);
    let expected = "error: cannot open the output `desktop`: no compositor answers at \
                    /nowhere/wayland-0: No such file or directory (os error 2); start this from a \
                    graphical session, or use the output `uinput`\n";
    assert!(text.ends_with(expected), "{text}");
    assert_eq!(code, Some(2));
}
