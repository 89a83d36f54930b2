//! Mesa on Linux, which draws wherever the driver of a graphics card cannot.

use std::env;
use std::os::unix::process::CommandExt;
use std::process::Command;

/// Number of threads that fill pictures beside the one that draws, see <https://docs.mesa3d.org/envvars.html>.
const VARIABLE: &str = "LP_NUM_THREADS";

/// Starts this program again, with the variable that makes Mesa draw in the thread of the window, unless it is set.
///
/// By default Mesa has a thread for each processor. The kernel thread that passes on the bytes of a serial line then waits up
/// to a time slice (3 ms) for one of them, and a press is late by as much. A process cannot set a variable of its own safely.
pub fn draw_in_one_thread() {
    if env::var_os(VARIABLE).is_some() {
        return;
    }
    let mut arguments = env::args_os();
    let (Ok(program), Some(name)) = (env::current_exe(), arguments.next()) else {
        return;
    };
    // Returns only if it fails; then the window draws with more threads.
    let error = Command::new(program)
        .arg0(name)
        .args(arguments)
        .env(VARIABLE, "0")
        .exec();
    tracing::debug!(%error, "cannot start the program with {VARIABLE}");
}
