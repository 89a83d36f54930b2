//! The link that a headset opens, which is shown until a headset is connected.

use ademan_runtime::capture::HeadsetStatus;

/// A link and its QR code. The link is a password, so this has no `Debug`: no message may contain it.
pub struct HeadsetLink {
    /// The address of the page with the token.
    pub url: String,
    /// The QR code; `None` if the link is too long for one.
    pub code: Option<QrModules>,
}

/// The modules of a QR code: a square of dark and light ones.
pub struct QrModules {
    width: usize,
    /// Row by row from the top.
    is_dark: Vec<bool>,
}

/// Dark modules beside each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DarkRun {
    /// Index of the row from the top.
    pub row: usize,
    /// Index of the first column.
    pub start: usize,
    /// Index after the last column.
    pub end: usize,
}

impl QrModules {
    /// Creates a code from `width` rows with `width` modules each.
    ///
    /// # Panics
    ///
    /// If the number of modules is another one.
    pub fn new(width: usize, is_dark: Vec<bool>) -> Self {
        assert_eq!(is_dark.len(), width * width, "a code is a square");
        Self { width, is_dark }
    }

    /// Returns the number of modules of a side.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the dark modules, as few rectangles.
    pub fn dark_runs(&self) -> impl Iterator<Item = DarkRun> {
        let rows = self.is_dark.chunks(self.width.max(1)).enumerate();
        rows.flat_map(|(row, modules)| {
            let mut start = 0;
            let runs = modules.chunk_by(|a, b| a == b).map(move |run| {
                let first = start;
                start += run.len();
                let dark = DarkRun {
                    row,
                    start: first,
                    end: start,
                };
                (run[0], dark)
            });
            runs.filter_map(|(is_dark, run)| is_dark.then_some(run))
        })
    }
}

/// The window with the link of a session whose source waits for headsets.
pub struct HeadsetWindow {
    /// The link.
    pub link: HeadsetLink,
    /// The window is open.
    pub is_open: bool,
    /// The link is shown in it.
    pub shows_link: bool,
    is_connected: bool,
}

impl HeadsetWindow {
    /// Shows a link.
    pub fn new(link: HeadsetLink) -> Self {
        Self {
            link,
            is_open: true,
            shows_link: true,
            is_connected: false,
        }
    }

    /// Hides the link when a headset has connected. It stays hidden when that leaves, as its page connects again by itself.
    pub fn update(&mut self, status: &HeadsetStatus) {
        let was_connected = self.is_connected;
        self.is_connected = status.connected.is_some();
        if self.is_connected && !was_connected {
            self.shows_link = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use ademan_runtime::capture::Headset;

    use super::*;

    #[test]
    fn dark_modules_beside_each_other_are_one_rectangle() {
        let rows = ["##.", "...", "#.#"].concat();
        let code = QrModules::new(3, rows.chars().map(|it| it == '#').collect());
        let runs = code.dark_runs().map(|run| (run.row, run.start, run.end));
        let runs: Vec<_> = runs.collect();
        assert_eq!(runs, [(0, 0, 2), (2, 0, 1), (2, 2, 3)]);
    }

    #[test]
    fn the_link_is_shown_until_a_headset_connects_and_when_a_person_asks_for_it() {
        let mut window = HeadsetWindow::new(HeadsetLink {
            url: "https://127.0.0.1:8443/".to_owned(),
            code: None,
        });
        let none = HeadsetStatus::default();
        let connected = HeadsetStatus {
            connected: Some(Headset::new("Quest 3", [127, 0, 0, 1].into())),
        };
        window.update(&none);
        assert!(window.shows_link);
        window.update(&connected);
        assert!(!window.shows_link);
        window.shows_link = true;
        window.update(&connected);
        assert!(window.shows_link, "the person wants to see it");
        window.update(&none);
        window.update(&connected);
        assert!(!window.shows_link);
        window.update(&none);
        assert!(!window.shows_link, "the page connects again by itself");
    }
}
