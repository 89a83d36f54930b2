//! The table of panels: where each is, when it is shown, and what draws it.

use eframe::egui::{self, Ui};

use super::{PanelContext, PanelState, Workspace};
use super::{calibration, editor, lab, look, recording, scope, sensors, space, status, toolbar};

/// A panel.
struct Panel {
    /// Key of its name, under which its size is remembered, too.
    key: &'static str,
    place: Place,
    is_shown: fn(&PanelState, &PanelContext) -> bool,
    /// Draws the content. The last value is whether the panel has the focus.
    show: fn(&mut Ui, &mut PanelState, &mut PanelContext, bool),
}

/// A place in the window, in what the panels before have left.
#[derive(Clone, Copy)]
enum Place {
    /// At the top, as high as the content.
    Top,
    /// At the bottom, as high as the content.
    Bottom,
    /// At the left, with a width that the person chooses: the smallest and the first one in points.
    Left([f32; 2]),
    /// At the right, with such a width.
    Right([f32; 2]),
    /// At the bottom, with such a height.
    Below([f32; 2]),
    /// Everything that is left.
    Middle,
    /// Everything that is left, with a margin.
    Page,
}

/// The panels in the order in which they take their place and F6 reaches them.
const PANELS: [Panel; 16] = [
    Panel {
        key: "panel-toolbar",
        place: Place::Top,
        is_shown: |_, _| true,
        show: |ui, state, context, _| toolbar::show(ui, state, context),
    },
    Panel {
        key: "panel-status",
        place: Place::Bottom,
        is_shown: |_, _| true,
        show: |ui, state, context, _| status::show(ui, state, context),
    },
    Panel {
        key: "panel-recording",
        place: Place::Bottom,
        is_shown: |_, context| context.player.is_some(),
        show: recording::show,
    },
    Panel {
        key: "panel-watched",
        place: Place::Top,
        is_shown: |state, context| state.workspace == Workspace::Hand && context.watched.is_some(),
        show: |ui, state, context, _| lab::show_watched(ui, state, context),
    },
    Panel {
        key: SENSORS,
        place: Place::Right([320.0, 400.0]),
        is_shown: |state, context| {
            let is_wanted = state.workspace == Workspace::Hand && state.shows(SENSORS);
            is_wanted && context.watched.is_none()
        },
        show: |ui, _, context, _| sensors::show(ui, context),
    },
    Panel {
        key: SCOPE,
        place: Place::Below([90.0, 230.0]),
        is_shown: |state, _| state.workspace == Workspace::Hand && state.shows(SCOPE),
        show: |ui, state, context, _| scope::show(ui, &mut state.scope, context),
    },
    Panel {
        key: "panel-space",
        place: Place::Middle,
        is_shown: |state, _| state.workspace == Workspace::Hand,
        show: space::show,
    },
    Panel {
        key: "panel-calibration",
        place: Place::Page,
        is_shown: |state, _| state.workspace == Workspace::Calibration,
        show: |ui, _, context, _| calibration::show(ui, context),
    },
    Panel {
        key: "panel-editor-error",
        place: Place::Page,
        is_shown: |state, _| state.shows_layout() && !state.has_layout(),
        show: |ui, state, _, _| editor::show_error(ui, state),
    },
    Panel {
        key: "panel-editor-bar",
        place: Place::Top,
        is_shown: is_editing,
        show: |ui, state, _, _| editor::show_bar(ui, state),
    },
    Panel {
        key: "panel-editor-problems",
        place: Place::Below([48.0, 96.0]),
        is_shown: is_editing,
        show: |ui, state, _, _| editor::show_problems(ui, state),
    },
    Panel {
        key: "panel-editor-form",
        place: Place::Right([240.0, 320.0]),
        is_shown: is_editing,
        show: |ui, state, _, _| editor::show_form(ui, state),
    },
    Panel {
        key: "panel-editor-canvas",
        place: Place::Middle,
        is_shown: is_editing,
        show: |ui, state, context, _| editor::show_canvas(ui, state, context),
    },
    Panel {
        key: "lab-controls",
        place: Place::Left([230.0, 270.0]),
        is_shown: is_testing,
        show: |ui, state, _, _| lab::show_controls(ui, state),
    },
    Panel {
        key: "lab-results",
        place: Place::Right([280.0, 340.0]),
        is_shown: is_testing,
        show: |ui, state, _, _| lab::show_results(ui, state),
    },
    Panel {
        key: "lab-board",
        place: Place::Middle,
        is_shown: is_testing,
        show: |ui, state, context, _| lab::show_board(ui, state, context),
    },
];

/// The panel with the channels of the glove, which can be hidden.
pub(super) const SENSORS: &str = "panel-sensors";

/// The panel with plots over time, which can be hidden.
pub(super) const SCOPE: &str = "panel-scope";

fn is_editing(state: &PanelState, _: &PanelContext) -> bool {
    state.workspace == Workspace::Layout && state.has_layout()
}

fn is_testing(state: &PanelState, _: &PanelContext) -> bool {
    state.workspace == Workspace::Lab && state.has_layout()
}

/// Draws the panels that are shown.
pub(super) fn show(ui: &mut Ui, state: &mut PanelState, context: &mut PanelContext) {
    state.panel_ids.clear();
    // What a panel does may change what the next frame shows, but not this one.
    let shown = PANELS.map(|panel| (panel.is_shown)(state, context).then_some(panel));
    for panel in shown.into_iter().flatten() {
        panel.show(ui, state, context);
    }
}

/// Returns the greatest height of a panel below another one in a room of this height, in whole points. The one above has half of it.
fn highest_below(room: f32, [min, _]: [f32; 2]) -> f32 {
    (room / 2.0).floor().max(min)
}

impl Panel {
    fn show(&self, ui: &mut Ui, state: &mut PanelState, context: &mut PanelContext) {
        let kept = state.settings.panel_sizes.get(self.key).copied();
        let sized = |panel: egui::Panel, [min, first]: [f32; 2]| {
            panel.default_size(kept.unwrap_or(first)).min_size(min)
        };
        let content = |inner: &mut Ui| {
            let has_focus = look::mark_panel(inner, state, self.key);
            (self.show)(inner, state, context, has_focus);
        };
        let (panel, is_wide) = match self.place {
            Place::Top => (egui::Panel::top(self.key), None),
            Place::Bottom => (egui::Panel::bottom(self.key), None),
            Place::Left(sizes) => (sized(egui::Panel::left(self.key), sizes), Some(false)),
            Place::Right(sizes) => (sized(egui::Panel::right(self.key), sizes), Some(false)),
            Place::Below(sizes) => {
                let most = highest_below(ui.available_height(), sizes);
                // In a low window it has another size: the one that is kept comes back with the room.
                let is_low = kept.unwrap_or(sizes[1]) > most;
                let panel = egui::Panel::bottom((self.key, is_low)).resizable(true);
                let is_wide = (!is_low).then_some(true);
                (sized(panel, sizes).max_size(most), is_wide)
            }
            Place::Middle => {
                // Not every content paints all of it.
                let frame = egui::Frame::NONE.fill(ui.visuals().panel_fill);
                egui::CentralPanel::default().frame(frame).show(ui, content);
                return;
            }
            Place::Page => {
                egui::CentralPanel::default().show(ui, content);
                return;
            }
        };
        let drawn = panel.show(ui, content).response.rect.size();
        if let Some(is_wide) = is_wide {
            let size = if is_wide { drawn.y } else { drawn.x };
            state.settings.panel_sizes.insert(self.key.to_owned(), size);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::actions::Action;
    use super::*;

    #[test]
    fn every_panel_has_a_name_and_a_place_of_its_own() {
        for (index, panel) in PANELS.iter().enumerate() {
            assert!(!crate::texts::text(panel.key).is_empty());
            let mut others = PANELS[index + 1..].iter();
            assert!(others.all(|other| other.key != panel.key), "{}", panel.key);
        }
    }

    #[test]
    fn a_panel_below_leaves_half_of_a_low_window() {
        assert_eq!(highest_below(640.0, [90.0, 230.0]), 320.0);
        assert_eq!(highest_below(300.0, [90.0, 230.0]), 150.0);
        assert_eq!(highest_below(100.0, [90.0, 230.0]), 90.0);
    }

    #[test]
    fn a_panel_that_can_be_hidden_has_a_key() {
        for key in [SENSORS, SCOPE] {
            assert!(PANELS.iter().any(|panel| panel.key == key));
            assert_eq!(Action::Show(key).spec().name, key);
        }
    }
}
