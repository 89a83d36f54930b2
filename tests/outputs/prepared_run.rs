//! A run of a setup, prepared with its files and a glove whose wearer keeps the hand clear of all keys.

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::program::Program;
#[cfg(any(feature = "tray", feature = "wayland"))]
use crate::{
    support::x11::{wait_at_most, wait_for},
    views::Views,
};

/// A setup with a rule for an application. Its name is in another case on the X server.
pub const FOCUS_SETUP: &str = "Setup(
    stall_timeout_ms: 5000,
    profiles: [(name: \"code\", layout: \"numpad\"), (name: \"sofa\", layout: \"arrows\")],
    profiles_by_application: [(application: \"coder\", profile: \"code\")],
)";

/// The message after which the profile does not follow the focus.
pub const PROFILE_STAYS: &str =
    "the active profile stays, as `profiles_by_application` has no effect: ";

/// Ends a program in order, and checks that it has said once why the profile stays.
pub fn end_where_the_profile_stays(program: &mut Program) {
    program.signal(&["TERM"]);
    assert_eq!(program.wait_for_exit().code(), Some(0));
    let said = program.count_lines(PROFILE_STAYS);
    assert_eq!(said, 1, "{:#?}", program.stderr_lines());
}

pub struct PreparedRun {
    pub glove: Glove,
    pub press: Press,
    /// The path of the control socket.
    pub control: PathBuf,
    setup: PathBuf,
    port: PathBuf,
    _folder: TempDir,
}

impl PreparedRun {
    pub fn new(setup_text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let [setup, port, control] =
            ["setup.ron", "glove", "control"].map(|it| folder.path().join(it));
        fs::write(&setup, setup_text).expect("a new file");
        let press = Press::for_text("H");
        Self {
            glove: Glove::plug_in(&port, press.clear()),
            press,
            control,
            setup,
            port,
            _folder: folder,
        }
    }

    /// Returns the arguments of `ademan` that start the run with an output.
    pub fn arguments(&self, output: &str) -> [String; 8] {
        let path = |path: &PathBuf| path.to_str().expect("UTF-8").to_owned();
        [
            "run".to_owned(),
            path(&self.setup),
            "--output".to_owned(),
            output.to_owned(),
            "--source".to_owned(),
            format!("serial:{}", path(&self.port)),
            "--control".to_owned(),
            path(&self.control),
        ]
    }

    /// Moves the hand until a view has a pressed key. A press that a busy machine loses is repeated.
    #[cfg(any(feature = "tray", feature = "wayland"))]
    pub fn wait_for_press(&self, views: &Views) -> bool {
        wait_for(|| {
            self.glove.play(&self.press.approach);
            wait_at_most(std::time::Duration::from_secs(5), || {
                views.has_pressed_key()
            })
        })
    }
}
