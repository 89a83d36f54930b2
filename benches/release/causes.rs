//! The causes and the table of release times.

use std::time::Duration;

use rustix::process::Signal;

use crate::busy;
use crate::panic;
use crate::scenario::Scenario;
use crate::support::press::Press;
use crate::target::InputTarget;

/// The cause of a release.
#[derive(Clone, Copy)]
pub enum Cause {
    Silence,
    Unplugged,
    Sent(Signal),
    Pause,
    SentToWatchdog(Signal),
}

/// Name, cause, whether the control socket is under load, and the goal in ms.
#[rustfmt::skip]
const ROWS: &[(&str, Cause, bool, u32)] = &[
    ("the glove stops sending (stall time-out 200 ms)", Cause::Silence, false, 250),
    ("the cable is pulled", Cause::Unplugged, false, 50),
    ("SIGINT", Cause::Sent(Signal::INT), false, 50),
    ("SIGTERM", Cause::Sent(Signal::TERM), false, 50),
    ("SIGHUP", Cause::Sent(Signal::HUP), false, 50),
    ("SIGTSTP (Ctrl-Z)", Cause::Sent(Signal::TSTP), false, 50),
    ("SIGKILL", Cause::Sent(Signal::KILL), false, 100),
    ("SIGABRT (abort, out of memory)", Cause::Sent(Signal::ABORT), false, 100),
    ("SIGSTOP", Cause::Sent(Signal::STOP), false, 300),
    ("the watchdog is killed", Cause::SentToWatchdog(Signal::KILL), false, 100),
    ("the watchdog is stopped", Cause::SentToWatchdog(Signal::STOP), false, 400),
    ("emergency stop: SIGUSR1", Cause::Sent(Signal::USR1), false, 20),
    ("emergency stop: control socket", Cause::Pause, false, 20),
    ("emergency stop: SIGUSR1, under load", Cause::Sent(Signal::USR1), true, 20),
    ("emergency stop: control socket, under load", Cause::Pause, true, 20),
];

/// The goal after a panic, in ms.
const AFTER_A_PANIC: u32 = 50;

pub fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    panic::run_child(&arguments);
    let is_test = !arguments.iter().any(|argument| argument == "--bench");
    let times = arguments.iter().find_map(|argument| argument.parse().ok());
    let times = times.unwrap_or(if is_test { 1 } else { 200 });
    let targets = ["wayland", "uinput"];
    let named = arguments
        .iter()
        .find(|name| targets.contains(&name.as_str()));
    let name = named.map_or("x11", String::as_str);
    if arguments.iter().any(|argument| argument == "busy") {
        return busy::main(name, times);
    }
    let Some(target) = InputTarget::open(name) else {
        return;
    };
    let press = Press::for_text("h");
    print_title(name, times);
    for &(row_name, cause, is_loaded, goal) in ROWS {
        print_row(row_name, times, goal, || {
            Scenario::start(&target, &press, is_loaded).measure(&target, cause)
        });
    }
    for thread in panic::THREADS {
        print_row(
            &format!("a panic of a {thread}"),
            times,
            AFTER_A_PANIC,
            || panic::measure(&target, thread),
        );
    }
}

/// Prints the heads of the columns.
pub fn print_title(target: &str, times: usize) {
    let title = format!("release times on {target} in ms, {times} times each");
    println!("{title:50} {:>10} {:>10} {:>6}", "median", "worst", "goal");
}

/// Measures a number of times and prints the result beside the goal in ms.
pub fn print_row(name: &str, times: usize, goal: u32, measure: impl FnMut() -> Duration) {
    let mut release_times: Vec<_> = std::iter::repeat_with(measure).take(times).collect();
    release_times.sort_unstable();
    let millis = |time: Duration| time.as_secs_f64() * 1e3;
    let (median, worst) = (
        millis(release_times[times / 2]),
        millis(release_times[times - 1]),
    );
    println!("{name:50} {median:10.2} {worst:10.2} {goal:6}");
}
