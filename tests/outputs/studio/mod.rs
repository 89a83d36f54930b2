//! The window of Studio on an X server that draws without a graphics card.

mod attached;
mod bad_input;
mod devices;
mod overlay;
mod safety;
#[cfg(target_os = "linux")]
mod screen_reader;
#[cfg(target_os = "linux")]
mod session_menu;
mod sound;

use std::collections::HashSet;
use std::fs;
use std::process::Command;

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat};

use crate::support::binary::ademan;
use crate::support::process::read_of_threads;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_for};
use crate::x11::repeat;

/// The color of a pressed key, blue first, as the server has it.
const LIT: [u8; 3] = [0x1c, 0xa0, 0xff];

/// The fewest colors of a window with keys and a hand.
const MIN_COLORS: usize = 200;

fn studio(server: &XServer, arguments: &[&str]) -> Command {
    let mut command = ademan(["studio"].iter().chain(arguments));
    command
        .env("DISPLAY", server.display())
        .env_remove("WAYLAND_DISPLAY")
        .env("LIBGL_ALWAYS_SOFTWARE", "1");
    command
}

/// Returns the colors on the screen, blue first.
fn colors(display: &str) -> HashSet<[u8; 3]> {
    let (client, screen) = x11rb::connect(Some(display)).expect("the server answers");
    let screen = &client.setup().roots[screen];
    let (width, height) = (screen.width_in_pixels, screen.height_in_pixels);
    let image = client
        .get_image(ImageFormat::Z_PIXMAP, screen.root, 0, 0, width, height, !0)
        .expect("a request")
        .reply()
        .expect("an image");
    let pixels = image.data.chunks_exact(4);
    pixels.map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

/// Starts an X server whose screen has room for the whole window. Returns `None` with a message if Xvfb is not installed.
fn start_screen() -> Option<XServer> {
    XServer::with_screen("1440x900x24")
}

/// Waits until the window shows a pressed key. Returns `false` after the time-out.
fn is_typing(server: &XServer) -> bool {
    wait_for(|| {
        let colors = colors(server.display());
        colors.len() > MIN_COLORS && colors.contains(&LIT)
    })
}

/// Waits until the window shows a hand. Returns `false` after the time-out.
fn is_drawn(server: &XServer) -> bool {
    wait_for(|| colors(server.display()).len() > MIN_COLORS)
}

/// Ends a window with a signal. On a busy machine it takes longer to close than the 3 s that an orderly end may take. Returns `true` if
/// it was orderly.
fn end(mut program: Program) -> bool {
    program.signal(&["TERM"]);
    let status = program.wait_for_exit();
    assert!(
        matches!(status.code(), Some(0 | 130)),
        "{status}: {:#?}",
        program.stderr_lines()
    );
    status.success()
}

#[test]
fn the_window_shows_a_typing_hand_and_ends_in_an_orderly_way() {
    repeat(|| {
        let Some(server) = start_screen() else {
            return true;
        };
        let program = Program::from_command(studio(&server, &["--layout", "qwerty-flat"]));
        let is_typing = is_typing(&server);
        let messages = program.stderr_lines();
        assert!(
            is_typing,
            "{} colors: {messages:?}",
            colors(server.display()).len()
        );
        end(program)
    });
}

#[test]
fn mesa_draws_in_the_thread_of_the_window_unless_the_environment_names_another_number() {
    for (variable, threads) in [(None, 0), (Some("2"), 2)] {
        let Some(server) = start_screen() else {
            return;
        };
        let mut command = studio(&server, &["--layout", "qwerty-flat"]);
        match variable {
            Some(number) => command.env("LP_NUM_THREADS", number),
            None => command.env_remove("LP_NUM_THREADS"),
        };
        let program = Program::from_command(command);
        assert!(is_drawn(&server), "{:?}", program.stderr_lines());
        assert_eq!(drawing_threads(program.id()), threads, "{variable:?}");
    }
}

#[test]
fn the_window_gives_way_to_other_threads_after_a_tenth_of_a_millisecond() {
    let Some(server) = start_screen() else {
        return;
    };
    let program = Program::from_command(studio(&server, &["--layout", "qwerty-flat"]));
    assert!(is_drawn(&server), "{:?}", program.stderr_lines());
    // Other threads may have the name of the program, too.
    let window = time_slice(program.id(), &format!("ademan ({},", program.id()));
    let session = time_slice(program.id(), "session (");
    if window.is_none() || linux_version() < [6, 12] {
        println!("SKIPPED: this kernel has no time slices of threads, or does not report them");
        return;
    }
    assert_eq!(window, Some(100_000));
    assert!(session > Some(100_000), "{session:?}");
}

/// Returns the first two numbers of the version of the kernel.
fn linux_version() -> [u32; 2] {
    let release = fs::read_to_string("/proc/sys/kernel/osrelease").expect("Linux");
    let mut numbers = release.split('.').map(|number| number.parse().unwrap_or(0));
    [(); 2].map(|()| numbers.next().unwrap_or(0))
}

/// Returns the time slice in nanoseconds of the thread whose report starts with this name, id and number of threads. `None`
/// if the kernel does not report it.
fn time_slice(process: u32, thread: &str) -> Option<u64> {
    let threads = read_of_threads(process, "sched").ok()?;
    let report = threads.iter().find(|report| report.starts_with(thread))?;
    let line = report.lines().find(|line| line.starts_with("se.slice"))?;
    let (_, slice) = line.split_once(':')?;
    slice.trim().parse().ok()
}

/// Returns the number of threads with which Mesa fills the pictures of a process.
fn drawing_threads(process: u32) -> usize {
    let names = read_of_threads(process, "comm").expect("Studio is running");
    let is_drawing = |name: &&String| name.starts_with("llvmpipe-");
    names.iter().filter(is_drawing).count()
}

#[test]
fn the_first_start_shows_its_pages_before_a_session_and_ends_with_a_signal() {
    let Some(server) = start_screen() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = studio(&server, &[]);
    // Without settings of an earlier start.
    command.env("XDG_CONFIG_HOME", folder.path());
    // Nor a session that could be shown.
    command.env("XDG_RUNTIME_DIR", folder.path());
    let mut program = Program::from_command(command);
    let is_shown = wait_for(|| colors(server.display()).len() > 16);
    assert!(is_shown, "{:?}", program.stderr_lines());
    // Sent to all programs of this name, it is not for a window without a session.
    program.signal(&["USR1"]);
    program.signal(&["TERM"]);
    let code = program.wait_for_exit().code();
    let messages = program.stderr_lines();
    assert!(matches!(code, Some(0 | 130)), "{code:?}: {messages:?}");
    assert!(
        !messages.iter().any(|line| line.contains("armed")),
        "{messages:?}"
    );
}
