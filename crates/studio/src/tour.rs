//! The tour of the first start.

/// A step: keys of its heading and of its words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TourStep {
    /// Key of the heading.
    pub heading: &'static str,
    /// Key of the words.
    pub words: &'static str,
}

/// The steps, in order.
pub const STEPS: [TourStep; 5] = [
    TourStep {
        heading: "tour-view",
        words: "tour-view-words",
    },
    TourStep {
        heading: "tour-pause",
        words: "tour-pause-words",
    },
    TourStep {
        heading: "tour-sensors",
        words: "tour-sensors-words",
    },
    TourStep {
        heading: "tour-layout",
        words: "tour-layout-words",
    },
    TourStep {
        heading: "tour-output",
        words: "tour-output-words",
    },
];

/// The tour: closed, or at one of the [`STEPS`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tour {
    index: Option<usize>,
}

impl Tour {
    /// Starts at the first step.
    pub fn open(&mut self) {
        self.index = Some(0);
    }

    /// Ends the tour.
    pub fn close(&mut self) {
        self.index = None;
    }

    /// Goes to the next step. The last one ends the tour.
    pub fn advance(&mut self) {
        let next = self.index.map(|index| index + 1);
        self.index = next.filter(|&index| index < STEPS.len());
    }

    /// Goes to the step before. The first one stays.
    pub fn go_back(&mut self) {
        self.index = self.index.map(|index| index.saturating_sub(1));
    }

    /// Returns the index of the present step, or `None` while the tour is closed.
    pub fn index(self) -> Option<usize> {
        self.index
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texts::{self, Language, text};

    #[test]
    fn the_steps_name_the_tabs_of_the_window() {
        for language in Language::ALL {
            texts::set_language(language);
            for (step, tab) in [
                ("tour-sensors-words", "workspace-calibration"),
                ("tour-layout-words", "workspace-layout"),
            ] {
                let (words, tab) = (text(step), text(tab));
                assert!(words.contains(tab), "{tab:?} is missing: {words}");
            }
        }
        texts::set_language(Language::English);
    }

    #[test]
    fn the_tour_has_five_steps_and_ends_after_the_last() {
        let mut tour = Tour::default();
        tour.open();
        tour.go_back();
        let mut seen = Vec::new();
        while let Some(index) = tour.index() {
            seen.push(index);
            tour.advance();
        }
        assert_eq!(seen, [0, 1, 2, 3, 4]);
    }
}
