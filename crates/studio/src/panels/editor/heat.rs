//! The board of the editor with a color over each control, for the lab: it can be moved and zoomed, not edited.

use eframe::egui::{self, PointerButton, Sense};
use parry3d::math::Vec2;

use super::super::{PanelContext, look};
use super::EditorPanel;
use super::canvas::{self, Over};
use crate::canvas::viewport::Viewport;
use crate::canvas::{Bounds, item_at};
use crate::texts::text;
use ademan_core::layout::Heat;

/// The colors over a board.
pub struct BoardHeat<'a> {
    /// The colors of the controls of the layout.
    pub heats: &'a [Heat],
    /// The words at the lower edge.
    pub hint: &'a str,
}

/// Draws the board of the editor with colors, and the figures of the control below the pointer.
pub fn show(ui: &mut egui::Ui, panel: &mut EditorPanel, context: &PanelContext, heat: BoardHeat) {
    panel.update_items();
    let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    look::name_image(&response, text("lab-board"));
    let size = Vec2::new(area.width(), area.height());
    if size.min_element() < 1.0 {
        return;
    }
    let bounds = Bounds::around(panel.items.items.iter().map(|item| &item.shape));
    let whole = bounds.map_or_else(Viewport::default, |bounds| Viewport::fit(bounds, size));
    let before = panel.lab_viewport.unwrap_or(whole);
    let mut viewport = before;
    let to_local = |at: egui::Pos2| Vec2::new(at.x - area.min.x, at.y - area.min.y);
    let pans = canvas::pans(&response) || response.dragged_by(PointerButton::Primary);
    canvas::move_view(ui, &response, &mut viewport, pans, to_local, size);
    if viewport != before {
        panel.lab_viewport = Some(viewport);
    }
    let of_item = |index: usize| {
        let target = panel.items.targets.get(index)?;
        heat.heats.iter().find(|heat| heat.target == *target)
    };
    let parts = (0..panel.items.items.len()).map(|index| of_item(index).map_or(0.0, |it| it.part));
    let over = Over {
        heats: &parts.collect::<Vec<_>>(),
        hint: heat.hint,
    };
    canvas::paint(ui, panel, context, (area, &viewport), &over);
    if let Some(at) = response.hover_pos() {
        let point = viewport.to_board(to_local(at), size);
        let index = item_at(&panel.items.items, point);
        if let Some(item_heat) = index.and_then(of_item) {
            response.on_hover_text_at_pointer(&item_heat.words);
        }
    }
}
