//! Where there is no way in: what a run and the doctor say.

use std::process::Command;

use super::compositor::Compositor;

/// Exit code, standard output and standard error.
fn ended(mut command: Command) -> (Option<i32>, String, String) {
    let ended = command.output().expect("it starts");
    let text = |bytes| String::from_utf8(bytes).expect("it writes UTF-8");
    (ended.status.code(), text(ended.stdout), text(ended.stderr))
}

const DOCTOR: [&str; 5] = ["doctor", "--output", "desktop", "--test", "desktop"];

#[test]
fn a_compositor_that_lets_no_program_press_keys_is_refused_and_the_doctor_knows() {
    let Some(compositor) = Compositor::weston() else {
        return;
    };
    let run = compositor.ademan(["run", "--output", "desktop", "--source", "typist:hi"]);
    let (code, _, told) = ended(run);
    let why = "does not support zwp_virtual_keyboard_manager_v1, so programs cannot press keys";
    let expected = format!(
        "error: cannot open the output `desktop`: the compositor {why}; use the output `uinput`\n"
    );
    assert!(told.ends_with(&expected), "{told}");
    assert_eq!(code, Some(2));
    let (code, told, _) = ended(compositor.ademan(DOCTOR));
    let expected = format!("missing      compositor   needed  weston {why}\n");
    assert!(told.contains(&expected), "{told}");
    assert!(told.contains("use the output `uinput`"), "{told}");
    assert!(told.contains("fails        desktop      tested"), "{told}");
    assert_eq!(code, Some(1));
}

#[test]
fn a_compositor_with_everything_is_found_and_the_doctor_tries_it() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let (code, told, _) = ended(compositor.ademan(DOCTOR));
    let found = "ok           compositor   needed  sway has virtual keyboard and pointer\n";
    assert!(told.contains(found), "{told}");
    let tried = "works        desktop      tested  connected";
    assert!(told.contains(tried), "{told}");
    assert_eq!(code, Some(0), "{told}");
}

#[test]
fn an_x_server_beside_a_compositor_that_does_not_answer_is_not_taken_for_it() {
    let Some(server) = crate::support::x11::XServer::start() else {
        return;
    };
    let mut run =
        crate::support::binary::ademan(["run", "--output", "desktop", "--source", "typist:hi"]);
    run.env("DISPLAY", server.display())
        .env("WAYLAND_DISPLAY", "/nowhere/wayland-0")
        .env_remove("XDG_RUNTIME_DIR");
    let (code, _, told) = ended(run);
    let expected = "error: cannot open the output `desktop`: no compositor answers at \
                    /nowhere/wayland-0: No such file or directory (os error 2); start this from a \
                    graphical session, or use the output `uinput`\n";
    assert!(told.ends_with(expected), "{told}");
    assert_eq!(code, Some(2));
}
