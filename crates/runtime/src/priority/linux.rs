//! Nice values and time slices of Linux, which each thread has for itself.

use std::{io, ptr, thread};

use rustix::process::{Resource, getpriority_process, getrlimit, setpriority_process};

/// The nice value of the highest priority.
const HIGHEST_PRIORITY: i32 = -20;

/// The nice value that the limit 0 stands for: a limit is the difference from it.
const LIMIT_BASE: i32 = 20;

/// The shortest time slice of Linux, in nanoseconds. The usual ones are 0.7 to 4 ms.
const SHORTEST_SLICE: u64 = 100_000;

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

/// Makes the calling thread give way within 0.1 ms to another that wakes up on its processor. Its share of the processor
/// stays the same. Linux ignores it before version 6.12 (`sched_runtime` in `man 2 sched_setattr`).
#[expect(unsafe_code, reason = "no library has a safe form of this call")]
pub fn shorten_time_slice() {
    let attributes = libc::sched_attr {
        size: size_of::<libc::sched_attr>() as u32,
        sched_policy: 0,
        sched_flags: libc::SCHED_FLAG_KEEP_POLICY as u64,
        sched_nice: current_nice(),
        sched_priority: 0,
        sched_runtime: SHORTEST_SLICE,
        sched_deadline: 0,
        sched_period: 0,
    };
    let (this_thread, flags) = (0, 0);
    // SAFETY: the kernel reads as many bytes of the attributes as they state, and keeps no pointer.
    let result = unsafe {
        libc::syscall(
            libc::SYS_sched_setattr,
            this_thread,
            ptr::from_ref(&attributes),
            flags,
        )
    };
    if result != 0 {
        tracing::debug!(error = %io::Error::last_os_error(), "the time slice stays as it is");
    }
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
