//! What is measured, and the table.

use std::time::Duration;

use rustix::process::Signal;

use crate::breaking;
use crate::place::Place;
use crate::scene::Scene;
use crate::support::press::Press;

/// What goes wrong.
#[derive(Clone, Copy)]
pub enum Cause {
    Silence,
    Unplugged,
    Sent(Signal),
    Pause,
    GuardianKilled,
}

/// A name, a cause, whether the program is under load, and the goal in ms.
#[rustfmt::skip]
const ROWS: &[(&str, Cause, bool, u32)] = &[
    ("the glove falls silent (stall limit 200 ms)", Cause::Silence, false, 250),
    ("the cable is pulled", Cause::Unplugged, false, 50),
    ("SIGINT", Cause::Sent(Signal::INT), false, 50),
    ("SIGTERM", Cause::Sent(Signal::TERM), false, 50),
    ("SIGHUP", Cause::Sent(Signal::HUP), false, 50),
    ("SIGTSTP (Ctrl-Z)", Cause::Sent(Signal::TSTP), false, 50),
    ("SIGKILL", Cause::Sent(Signal::KILL), false, 100),
    ("SIGABRT (abort, out of memory)", Cause::Sent(Signal::ABORT), false, 100),
    ("SIGSTOP", Cause::Sent(Signal::STOP), false, 300),
    ("the guardian is killed", Cause::GuardianKilled, false, 100),
    ("emergency stop: SIGUSR1", Cause::Sent(Signal::USR1), false, 20),
    ("emergency stop: control socket", Cause::Pause, false, 20),
    ("emergency stop: SIGUSR1, under load", Cause::Sent(Signal::USR1), true, 20),
    ("emergency stop: control socket, under load", Cause::Pause, true, 20),
];

/// The goal after a panic, in ms.
const AFTER_A_PANIC: u32 = 50;

pub fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    breaking::run_if_asked(&arguments);
    let is_test = !arguments.iter().any(|argument| argument == "--bench");
    let times = arguments.iter().find_map(|argument| argument.parse().ok());
    let times = times.unwrap_or(if is_test { 1 } else { 200 });
    let places = ["wayland", "uinput"];
    let named = arguments
        .iter()
        .find(|name| places.contains(&name.as_str()));
    let name = named.map_or("x11", String::as_str);
    let Some(place) = Place::open(name) else {
        return;
    };
    let press = Press::for_text("h");
    let title = format!("nothing is down on {name} after, in ms, {times} times");
    println!("{title:50} {:>10} {:>10} {:>6}", "median", "worst", "goal");
    for &(name, cause, is_loaded, goal) in ROWS {
        row(name, times, goal, || {
            Scene::hold(&place, &press, is_loaded).release_after(&place, cause)
        });
    }
    for thread in breaking::THREADS {
        row(
            &format!("a panic of a {thread}"),
            times,
            AFTER_A_PANIC,
            || breaking::release_after(&place, thread),
        );
    }
}

fn row(name: &str, times: usize, goal: u32, measure: impl FnMut() -> Duration) {
    let mut took: Vec<_> = std::iter::repeat_with(measure).take(times).collect();
    took.sort_unstable();
    let millis = |time: Duration| time.as_secs_f64() * 1e3;
    let (median, worst) = (millis(took[times / 2]), millis(took[times - 1]));
    println!("{name:50} {median:10.2} {worst:10.2} {goal:6}");
}
