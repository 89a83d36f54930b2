//! Studio in a window, and what it takes of the machine.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat};

use super::support::binary::ademan;
use super::support::process::Process;
use super::support::x11::{XServer, wait_for};

/// Width, height and depth of the screen, which the window fills.
pub const SCREEN: &str = "1280x800x24";

/// The part of the 3D view in which the first frame is awaited: left edge, top, width, height.
const MIDDLE: (i16, i16, u16, u16) = (300, 200, 200, 150);

/// Fewest colors of a part of a picture with keys or a hand; before it, the window has one.
const MIN_COLORS: usize = 3;

/// Clock ticks per second of the times in `/proc` (`USER_HZ`).
const TICKS_PER_SECOND: f64 = 100.0;

/// A running Studio.
pub struct Window {
    process: Process,
    /// The counts of frames, and the settings of the window.
    folder: TempDir,
    /// Time from the start of the program to the first frame.
    pub opening: Duration,
}

/// The frames of a window, and its share of the machine.
pub struct Usage {
    pub frames_per_s: f64,
    /// Processor time per time.
    pub processor: f64,
    pub memory_mb: f64,
    pub peak_mb: f64,
}

impl Window {
    /// Opens a window with these arguments, and waits until it shows keys or a hand.
    pub fn open<'a>(server: &XServer, arguments: impl IntoIterator<Item = &'a str>) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        write_settings(folder.path());
        let mut command = ademan(["studio", "--allow-root"].into_iter().chain(arguments));
        command
            .env("DISPLAY", server.display())
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("XDG_RUNTIME_DIR")
            .env("XDG_CONFIG_HOME", folder.path())
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .env("GALLIUM_HUD", "fps")
            .env("GALLIUM_HUD_VISIBLE", "false")
            .env("GALLIUM_HUD_DUMP_DIR", folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let begun = Instant::now();
        let process = Process::start(&mut command).expect("the program starts");
        let (client, screen) = x11rb::connect(Some(server.display())).expect("the server answers");
        let root = client.setup().roots[screen].root;
        let is_drawn = wait_for(|| {
            let (x, y, width, height) = MIDDLE;
            let image = client.get_image(ImageFormat::Z_PIXMAP, root, x, y, width, height, !0);
            let image = image.expect("a request").reply().expect("an image");
            let mut colors: Vec<_> = image.data.chunks_exact(4).collect();
            colors.sort_unstable();
            colors.dedup();
            colors.len() >= MIN_COLORS
        });
        assert!(is_drawn, "the window opens");
        Self {
            process,
            folder,
            opening: begun.elapsed(),
        }
    }

    /// Observes the window for a time.
    pub fn observe(&self, time: Duration) -> Usage {
        let frames = self.frame_rates().len();
        let (start, ticks) = (Instant::now(), self.ticks());
        thread::sleep(time);
        let ticks = self.ticks() - ticks;
        let seconds = start.elapsed().as_secs_f64();
        let rates = self.frame_rates().split_off(frames);
        Usage {
            frames_per_s: rates.iter().sum::<f64>() / rates.len() as f64,
            processor: ticks / TICKS_PER_SECOND / seconds,
            memory_mb: self.status_mb("VmRSS:"),
            peak_mb: self.status_mb("VmHWM:"),
        }
    }

    /// Returns the frames per second of each half second so far.
    fn frame_rates(&self) -> Vec<f64> {
        let rates = fs::read_to_string(self.folder.path().join("fps")).unwrap_or_default();
        let rates = rates.lines().filter_map(|line| line.parse().ok());
        rates.collect()
    }

    /// Returns the processor time of all threads so far.
    fn ticks(&self) -> f64 {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.process.0.id()));
        let stat = stat.expect("the program is running");
        // The name of the program, in brackets, may contain spaces.
        let (_, fields) = stat.rsplit_once(')').expect("a name");
        let fields: Vec<&str> = fields.split_whitespace().collect();
        let tick = |index: usize| fields[index].parse::<f64>().expect("a number");
        tick(11) + tick(12)
    }

    fn status_mb(&self, field: &str) -> f64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.process.0.id()));
        let status = status.expect("the program is running");
        let line = status.lines().find_map(|line| line.strip_prefix(field));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
        kilobytes.expect("a size") / 1e3
    }
}

/// Writes settings with which the window opens without the tour.
fn write_settings(config: &Path) {
    let folder = config.join("ademan");
    fs::create_dir(&folder).expect("space on the disk");
    fs::write(folder.join("studio.ron"), "(has_seen_tour: true)").expect("space on the disk");
}
