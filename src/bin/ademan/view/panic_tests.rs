//! The terminal after a panic, as the shell finds it.

use std::env;
use std::process::Command;
use std::thread;
use std::time::Duration;

use clap::Parser;
use crossbeam_channel::bounded;

use super::{LiveView, Views};
use crate::{messages, panics, signals};

/// The environment variable that makes this test panic in a view, and that names the place of the panic.
const PLACE: &str = "ADEMAN_TEST_PANIC";

/// Longest wait for the message of the panic.
const FLUSH_TIMEOUT: Duration = Duration::from_secs(10);

const NAME: &str = "view::panic_tests::a_panic_gives_the_terminal_back";

#[derive(Parser)]
struct CommandLine {
    #[command(flatten)]
    messages: messages::LogArgs,
}

/// Panics again while its thread panics, which aborts the process.
struct PanicOnDrop;

impl Drop for PanicOnDrop {
    fn drop(&mut self) {
        panic!("intended again");
    }
}

fn panic_in_a_view(place: &str) {
    let (_views, receiver) = bounded(1);
    let (stop, stopped) = bounded(1);
    let line = CommandLine::parse_from(["ademan", "--quiet"]);
    messages::install(&line.messages).expect("no file is named");
    messages::start().expect("the thread starts");
    signals::on_stop(move || _ = stop.try_send(()));
    let outcome = panics::catch(|| {
        let _view = LiveView::open(Views::Remote(receiver.into()));
        match place {
            "main" => panic!("intended"),
            "thread" => {
                assert!(thread::spawn(|| panic!("intended")).join().is_err());
                let is_stopped = stopped.recv_timeout(Duration::from_secs(60));
                is_stopped.expect("the panic stops the program");
            }
            _ => {
                let _again = PanicOnDrop;
                panic!("intended");
            }
        }
        Ok(())
    });
    assert!(outcome.is_err(), "a panic is a failure");
    messages::flush_within(FLUSH_TIMEOUT);
}

/// Runs itself in a terminal of its own, between two commands that print the modes of that terminal.
#[test]
fn a_panic_gives_the_terminal_back() {
    if let Ok(place) = env::var(PLACE) {
        return panic_in_a_view(&place);
    }
    let program = env::current_exe().expect("its path");
    let command = format!(
        "stty -g; '{}' --exact {NAME} --nocapture; stty -g",
        program.display()
    );
    for place in ["main", "thread", "twice"] {
        let mut script = Command::new("script");
        script
            .args(["-qec", &command, "/dev/null"])
            .env(PLACE, place)
            .env("TERM", "xterm")
            .env("RUST_BACKTRACE", "0");
        let Ok(ended) = script.output() else {
            println!("SKIPPED: there is no `script`, of the package bsdutils");
            return;
        };
        let screen = String::from_utf8_lossy(&ended.stdout).into_owned();
        let (_, covered) = screen.split_once("\x1b[?1049h").expect("a view");
        let (_, after) = covered
            .rsplit_once("\x1b[?1049l")
            .unwrap_or_else(|| panic!("{place}: the previous screen is not restored: {screen}"));
        let cursor = covered.rfind("\x1b[?25h");
        assert!(cursor > covered.rfind("\x1b[?25l"), "{place}: no cursor");
        assert!(after.contains("intended"), "{place}: no message: {screen}");
        let (before, last) = (screen.lines().next(), screen.lines().last());
        assert!(before.is_some_and(|modes| modes.contains(':')), "{screen}");
        assert_eq!(before, last, "{place}: other modes");
    }
}
