//! The tour of the first start.

use eframe::egui::Rect;

/// A step: keys of its heading, of its words, and of what it explains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TourStep {
    /// Key of the heading.
    pub heading: &'static str,
    /// Key of the words.
    pub words: &'static str,
    /// Key of the panel or button.
    pub place: &'static str,
}

/// The steps, in order.
pub const STEPS: [TourStep; 5] = [
    TourStep {
        heading: "tour-view",
        words: "tour-view-words",
        place: "panel-space",
    },
    TourStep {
        heading: "tour-pause",
        words: "tour-pause-words",
        place: "button-pause",
    },
    TourStep {
        heading: "tour-sensors",
        words: "tour-sensors-words",
        place: "panel-sensors",
    },
    TourStep {
        heading: "tour-layout",
        words: "tour-layout-words",
        place: "workspace-layout",
    },
    TourStep {
        heading: "tour-output",
        words: "tour-output-words",
        place: "panel-status",
    },
];

/// The tour: closed, or at one of the [`STEPS`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tour {
    index: Option<usize>,
    /// Area of what the step explains, in the frame that is being drawn.
    area: Option<Rect>,
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

    /// Notes where a panel or button is drawn.
    pub fn see(&mut self, key: &str, area: Rect) {
        if self.index.is_some_and(|index| STEPS[index].place == key) {
            self.area = Some(area);
        }
    }

    /// Returns the area of what the step explains if it has been drawn since the last call.
    pub fn take_area(&mut self) -> Option<Rect> {
        self.area.take()
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
    fn an_area_counts_for_its_step_and_for_one_picture() {
        let area = Rect::from_min_max([1.0, 2.0].into(), [3.0, 4.0].into());
        let mut tour = Tour::default();
        tour.see("panel-space", area);
        assert_eq!(tour.take_area(), None);
        tour.open();
        tour.see("panel-sensors", area);
        assert_eq!(tour.take_area(), None);
        tour.see("panel-space", area);
        assert_eq!(tour.take_area(), Some(area));
        assert_eq!(tour.take_area(), None);
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
