//! The priority of the threads that press and release keys.

use serde_json::Value;

use super::ends::Typing;
use crate::support::binary::ademan;
use crate::support::process::read_of_threads;

/// Returns the names and nice values of the threads of a process.
fn threads(process: u32) -> Vec<(String, i32)> {
    let threads = read_of_threads(process, "stat").expect("the program runs");
    let thread = |stat: &String| {
        // The name is in parentheses; nice is the 19th field, the 17th after it.
        let (start, rest) = stat.rsplit_once(") ")?;
        let (_, name) = start.split_once('(')?;
        let nice = rest.split(' ').nth(16)?.parse().ok()?;
        Some((name.to_owned(), nice))
    };
    threads.iter().filter_map(thread).collect()
}

/// Returns the nice value that the doctor reports, 0 for none.
fn reported_nice() -> i32 {
    let output = ademan(["doctor", "--json"]).output().expect("it starts");
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let checks = report["checks"].as_array().expect("a list");
    let mut checks = checks.iter();
    let check = checks.find(|check| check["check"] == "priority");
    let text = check.expect("the check exists")["text"].to_string();
    let mut words = text.trim_matches('"').rsplit(' ');
    words.next().and_then(|nice| nice.parse().ok()).unwrap_or(0)
}

#[test]
fn the_loop_the_output_and_the_watchdog_have_the_priority_that_the_doctor_reports() {
    let Some(typing) = Typing::start() else {
        return;
    };
    let nice = reported_nice();
    if nice == 0 {
        println!("SKIPPED: this user may not have a higher priority");
        return;
    }
    let program = threads(typing.program.id());
    println!("{program:?}");
    // The kernel keeps 15 bytes of a name.
    for name in ["session", "desktop output", "signals", "ademan"] {
        let thread = (name.to_owned(), nice);
        assert!(program.contains(&thread), "{thread:?}: {program:?}");
    }
    let others = program.iter().filter(|(name, _)| name == "notices");
    assert!(others.clone().count() > 0 && others.clone().all(|(_, other)| *other > nice));
    let watchdog = typing.program.children();
    let watchdog = threads(watchdog[0]);
    assert!(
        watchdog.contains(&("key-watchdog".to_owned(), nice)),
        "{watchdog:?}"
    );
}
