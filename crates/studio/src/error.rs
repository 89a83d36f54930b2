//! Reasons why there is no window, with a remedy for each.

/// Variables that name a desktop, the one that is tried first in front.
const DESKTOP_VARIABLES: [&str; 2] = ["WAYLAND_DISPLAY", "DISPLAY"];

/// Reason why there is no window.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StudioError {
    /// The session ended before the window was opened.
    #[error("the session ended before the window was opened")]
    Ended,
    /// No desktop opens a window.
    #[error(
        "cannot open a window: there is no desktop, as neither DISPLAY nor WAYLAND_DISPLAY is set; start it in a terminal of a desktop, or see the board in this terminal: ademan run --view board"
    )]
    NoDesktop,
    /// The desktop with this name does not answer.
    #[error(
        "cannot open a window: the desktop at {0} does not answer; start it in a terminal of a desktop that runs, or see the board in this terminal: ademan run --view board"
    )]
    DesktopSilent(String),
    /// The graphics driver has no OpenGL, with its own words.
    #[error(
        "cannot open a window: the graphics driver cannot draw with OpenGL 2.1 ({0}); draw without a graphics card: LIBGL_ALWAYS_SOFTWARE=1 ademan studio (Debian: apt install libgl1-mesa-dri libegl1), or see the board in this terminal: ademan run --view board"
    )]
    NoOpenGl(String),
}

impl StudioError {
    /// Names the desktop that did not answer, if a variable of the environment has its name.
    #[must_use]
    pub fn with_variables(self, get: impl Fn(&str) -> Option<String>) -> Self {
        if self != Self::NoDesktop {
            return self;
        }
        let named = DESKTOP_VARIABLES.iter().find_map(|name| {
            let value = get(name).filter(|value| !value.is_empty())?;
            Some(format!("{name}={value}"))
        });
        named.map_or(self, Self::DesktopSilent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_desktop_that_was_tried_is_named() {
        let set = |names: &'static [&str]| {
            move |name: &str| names.contains(&name).then(|| ":7".to_owned())
        };
        let error = StudioError::NoDesktop.with_variables(set(&["DISPLAY"]));
        assert_eq!(error, StudioError::DesktopSilent("DISPLAY=:7".into()));
        let both = StudioError::NoDesktop.with_variables(set(&["DISPLAY", "WAYLAND_DISPLAY"]));
        assert_eq!(
            both,
            StudioError::DesktopSilent("WAYLAND_DISPLAY=:7".into())
        );
        assert_eq!(
            StudioError::NoDesktop.with_variables(|_| Some(String::new())),
            StudioError::NoDesktop
        );
    }
}
