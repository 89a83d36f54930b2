//! Profiles that follow the application with the focus, with two terminals on sway.

use std::io::ErrorKind;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use super::compositor::Compositor;
use crate::prepared_run::{FOCUS_SETUP, PROFILE_STAYS, PreparedRun, end_where_the_profile_stays};
use crate::support::process::Process;
use crate::support::program::Program;
use crate::support::x11::wait_for;
use crate::views::{Views, request};

/// Opens a terminal with this `app_id`, which has the focus. Returns `None` with a message if foot is not installed.
fn open(compositor: &Compositor, id: &str) -> Option<Process> {
    if let Err(error) = Command::new("foot").arg("--version").output()
        && error.kind() == ErrorKind::NotFound
    {
        println!("SKIPPED: foot is not installed");
        return None;
    }
    let mut command = compositor.client("foot");
    command
        .args(["-a", id, "sleep", "1000"])
        .stderr(Stdio::null());
    let process = Process::start(&mut command).expect("it starts");
    let is_open = || {
        compositor
            .query("get_tree")
            .contains(&format!("\"app_id\": \"{id}\""))
    };
    assert!(wait_for(is_open), "{id} is open");
    focus(compositor, id);
    Some(process)
}

fn focus(compositor: &Compositor, id: &str) {
    let reply = compositor.execute(&format!("[app_id=\"{id}\"] focus"));
    assert!(reply.contains("\"success\": true"), "{reply}");
}

#[test]
fn held_keys_are_released_before_the_profile_of_another_application_and_a_choice_stays() {
    let Some(mut compositor) = Compositor::sway() else {
        return;
    };
    let Some(_plain) = open(&compositor, "plain") else {
        return;
    };
    let run = PreparedRun::new(FOCUS_SETUP);
    let control = &run.control;
    let mut command = compositor.ademan(run.arguments("none"));
    command.env("SWAYSOCK", compositor.ipc_socket());
    let mut program = Program::from_command(command);
    program.wait_for_line("armed", 1);
    let views = Views::start(control);
    let is_held = run.wait_for_press(&views);
    assert!(is_held, "{:?}", program.stderr_lines());

    let Some(_coder) = open(&compositor, "coder") else {
        return;
    };
    views.wait_for_profile("code");
    let mut held = views.all().into_iter().filter(|(_, keys)| !keys.is_empty());
    assert!(
        held.all(|(profile, _)| profile == "main"),
        "{:?}",
        views.all()
    );
    let state = request(control, r#"{"command":"state"}"#);
    assert_eq!(
        (&state["profile"], &state["application"]),
        (&"code".into(), &"coder".into())
    );

    request(control, r#"{"command":"profile","name":"sofa"}"#);
    views.wait_for_profile("sofa");
    let Some(_second) = open(&compositor, "coder") else {
        return;
    };
    // Time for a change that must not come.
    thread::sleep(Duration::from_millis(300));
    focus(&compositor, "plain");
    views.wait_for_profile("main");
    assert_eq!(views.profiles(), ["main", "code", "sofa", "main"]);

    compositor.kill();
    program.wait_for_line(PROFILE_STAYS, 1);
    focus_is_unknown(control, "main");
    end_where_the_profile_stays(&mut program);
    println!(
        "{:?}\n{}",
        views.profiles(),
        program.stderr_lines().join("\n")
    );
}

fn focus_is_unknown(control: &std::path::Path, profile: &str) {
    let state = request(control, r#"{"command":"state"}"#);
    assert_eq!(state["profile"], profile);
    assert_eq!(state.get("application"), None);
}
