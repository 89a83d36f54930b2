//! The window of Studio on an X server that draws without a graphics card.

use std::collections::HashSet;
use std::process::Command;

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat};

use crate::support::binary::ademan;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_for};

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

#[test]
fn the_window_shows_a_typing_hand_and_ends_in_an_orderly_way() {
    let Some(server) = XServer::start() else {
        return;
    };
    let mut program = Program::from_command(studio(&server, &[]));
    let is_drawn = wait_for(|| {
        let colors = colors(server.display());
        colors.len() > MIN_COLORS && colors.contains(&LIT)
    });
    let messages = program.stderr_lines();
    assert!(
        is_drawn,
        "{} colors: {messages:?}",
        colors(server.display()).len()
    );
    program.signal(&["TERM"]);
    assert!(program.wait_for_exit().success());
}

#[test]
fn without_a_display_the_reason_is_printed() {
    let mut command = ademan(["studio"]);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    let output = command.output().expect("the program starts");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("cannot open a window"), "{message}");
}
