//! Nice values of Linux, which each thread has for itself.

use std::thread;

use rustix::process::{Resource, getpriority_process, getrlimit, setpriority_process};

/// The nice value of the highest priority.
const HIGHEST_PRIORITY: i32 = -20;

/// The nice value that the limit 0 stands for: a limit is the difference from it.
const LIMIT_BASE: i32 = 20;

/// Gives the calling thread the highest priority that this process may have. Threads and processes that it starts inherit
/// the priority.
pub fn raise_thread_priority() {
    for nice in [HIGHEST_PRIORITY, permitted_nice()] {
        if nice >= current_nice() || setpriority_process(None, nice).is_ok() {
            return;
        }
    }
}

/// Returns the nice value of a thread after [`raise_thread_priority`]: -20 is the highest priority, 0 the normal one.
pub fn granted_nice() -> i32 {
    let raised = thread::Builder::new().spawn(|| {
        raise_thread_priority();
        current_nice()
    });
    let raised = raised.ok().and_then(|thread| thread.join().ok());
    raised.unwrap_or_else(current_nice)
}

/// Returns the nice value of the calling thread.
fn current_nice() -> i32 {
    getpriority_process(None).unwrap_or(0)
}

/// Returns the lowest nice value that the limit permits without a capability.
fn permitted_nice() -> i32 {
    match getrlimit(Resource::Nice).current {
        Some(limit) => LIMIT_BASE.saturating_sub(i32::try_from(limit).unwrap_or(i32::MAX)),
        None => HIGHEST_PRIORITY,
    }
    .max(HIGHEST_PRIORITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_gets_the_priority_that_is_reported_and_no_other_thread_does() {
        let before = current_nice();
        let (raised, granted) = thread::scope(|scope| {
            let raised = scope.spawn(|| {
                raise_thread_priority();
                current_nice()
            });
            (raised.join().unwrap(), granted_nice())
        });
        println!("nice {before}, granted {granted}");
        assert_eq!(raised, granted);
        assert!(granted <= before);
        assert_eq!(current_nice(), before);
    }
}
