//! Release times while other programs use all processors.
//!
//! The key is held before the others start. The receiver and the observer have the highest priority, so that
//! only the delays of the program and its watchdog are measured.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use ademan::priority::granted_nice;
use rustix::process::{Signal, setpriority_process};
use rustix::thread::{CapabilitySet, remove_capability_from_bounding_set};

use crate::causes::{Cause, print_row, print_title};
use crate::scenario::Scenario;
use crate::support::press::Press;
use crate::target::InputTarget;

/// The nice value of the highest priority.
const HIGHEST_PRIORITY: i32 = -20;

/// Time in which all spinners are running.
const START_TIME: Duration = Duration::from_millis(100);

/// Number and nice value of the spinners.
const LOADS: [(usize, i32); 2] = [(4, HIGHEST_PRIORITY), (40, 0)];

/// Name, cause and goal in ms.
const ROWS: [(&str, Cause, u32); 2] = [
    ("SIGKILL", Cause::Sent(Signal::KILL), 100),
    ("SIGUSR1", Cause::Sent(Signal::USR1), 20),
];

/// Prints the release times with the priority that the program gets, and with the normal one.
pub fn main(name: &str, times: usize) {
    if setpriority_process(None, HIGHEST_PRIORITY).is_err() {
        println!("SKIPPED: spinners of the highest priority need the capability CAP_SYS_NICE");
        return;
    }
    // The receiver inherits the priority.
    let Some(target) = InputTarget::open(name) else {
        return;
    };
    print_title(name, times);
    measure_all(&target, times, &format!("nice {}", granted_nice()));
    // Programs that are started from now on have the normal priority.
    remove_capability_from_bounding_set(CapabilitySet::SYS_NICE).expect("the capability exists");
    measure_all(&target, times, "nice 0");
}

fn measure_all(target: &InputTarget, times: usize, priority: &str) {
    for (count, nice) in LOADS {
        for (name, cause, goal) in ROWS {
            let title = format!("{name}, {priority}, {count} spinners at nice {nice}");
            print_row(&title, times, goal, || measure(target, cause, count, nice));
        }
    }
}

fn measure(target: &InputTarget, cause: Cause, count: usize, nice: i32) -> Duration {
    let set_nice = |priority| setpriority_process(None, priority).expect("it is permitted");
    // The program inherits the priority of this thread.
    set_nice(0);
    let scenario = Scenario::start(target, &Press::for_text("h"), false);
    set_nice(HIGHEST_PRIORITY);
    let _spinners = Spinners::start(count, nice);
    thread::sleep(START_TIME);
    scenario.measure(target, cause)
}

/// Threads that use a processor until this is dropped.
struct Spinners {
    is_stopped: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Spinners {
    fn start(count: usize, nice: i32) -> Self {
        let is_stopped = Arc::new(AtomicBool::new(false));
        let spin = |_| {
            let is_stopped = Arc::clone(&is_stopped);
            thread::spawn(move || {
                setpriority_process(None, nice).expect("it is permitted");
                while !is_stopped.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            })
        };
        Self {
            threads: (0..count).map(spin).collect(),
            is_stopped,
        }
    }
}

impl Drop for Spinners {
    fn drop(&mut self) {
        self.is_stopped.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}
