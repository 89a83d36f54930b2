//! The layout editor: a board to scale, the form of the selection, and the problems of the text.

mod bar;
mod binding;
mod board_items;
mod canvas;
mod drafts;
mod drag_check;
mod field_row;
mod form;
mod free_view;
mod heat;
mod icons;
mod key_press;
mod lists;
mod mixed;
mod new_parts;
mod open;
mod outside;
mod palette;
mod plan;
mod plan_drag;
mod pointer;
mod problems;
mod repeat;
mod rulers;
mod several;
mod shortcuts;
mod steps;
mod trial;
#[cfg(test)]
mod arrange_tests;
#[cfg(test)]
mod menu_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod unfinished_tests;

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use eframe::egui;
use parry3d::math::Vec2;

use super::{PanelContext, PanelState, PictureFormats, actions};
use crate::canvas::Bounds;
use crate::canvas::board::BoardItems;
use crate::canvas::gesture::{Gesture, Preview};
use crate::canvas::selection::Selection;
use crate::canvas::viewport::{AreaViewport, Viewport};
use crate::editor::{ControlKind, Edit, EditError, EditorTrial, LayoutEditor, Part, ReachCheck};
use crate::recent::RecentFiles;
use crate::texts::text;
use ademan_core::document::DocumentError;
use ademan_core::layout::{Fit, Layout};

pub(super) use self::bar::{show_boards, show_message};
use self::binding::BindingState;
pub(super) use self::binding::capture as capture_key;
use self::drag_check::DragCheck;
use self::form::FormState;
pub(super) use self::heat::{BoardHeat, show as show_heat};
use self::open::OpenQuestion;
pub(super) use self::open::dropped_file;
use self::outside::{SaveAs, SaveQuestion};
pub(super) use self::outside::{guard_close, keep_unfinished};
use self::palette::Palette;
use self::plan::PlanPanel;
use self::repeat::Repeat;
use self::shortcuts::Nudge;
pub(super) use self::shortcuts::is_asked;
pub(super) use self::trial::advance_trial;

/// The editor between two frames.
pub struct EditorPanel {
    /// The text and its edits.
    pub editor: LayoutEditor,
    /// Index of the board on the canvas.
    board: usize,
    /// Size of the canvas in the last frame, in points.
    canvas_size: Option<Vec2>,
    /// The part of the board that is shown.
    viewport: AreaViewport,
    /// The part of the board that the lab shows; `None` until it was moved or zoomed there, which shows the whole board.
    lab_viewport: Option<Viewport>,
    items: BoardItems,
    /// The layout for the design hand, where the items are, if the hands of the session are others.
    design: Option<Layout>,
    /// The parts of the items; `None` while the brackets of the text are not balanced.
    parts: Vec<Option<Part>>,
    /// The items with an error.
    faulty: Vec<usize>,
    /// Revision and board of `items`.
    shown: Option<(u64, usize)>,
    selected: Selection,
    gesture: Option<Gesture>,
    preview: Preview,
    drag_check: DragCheck,
    /// All boards, in place of one.
    plan: PlanPanel,
    /// Radius that a drag of the bend would give, in millimetres.
    dragged_radius: Option<f32>,
    /// Edges and centers of other items and the grid attract.
    snaps: bool,
    grid_mm: f32,
    /// Rulers are shown along the canvas and the plan.
    has_rulers: bool,
    /// Numbers of the next repetitions.
    repeat: Repeat,
    palette: Palette,
    binding: BindingState,
    form: FormState,
    /// The last taps of an arrow key.
    nudge: Option<Nudge>,
    /// A save of a layout that no session can use waits for an answer.
    save_question: Option<SaveQuestion>,
    /// Another layout is chosen.
    open_question: Option<OpenQuestion>,
    /// Folder with unsaved work.
    work: Option<PathBuf>,
    /// Name that is written to save a copy.
    save_as: Option<SaveAs>,
    /// The text in the running session; `None` before the first frame.
    trial: Option<EditorTrial>,
    /// The trial of the layout that was open before, until the next frame.
    left_trial: Option<EditorTrial>,
    reach: Option<ReachCheck>,
    /// Time of the next look at the file, in seconds.
    next_poll: f64,
    /// Time of the next look at what is typed, in seconds.
    next_keep: f64,
    /// The edits of what was typed or dragged when it was kept last, with the revision of the text.
    kept: (u64, Vec<Edit>),
    /// Makes pictures of pixels, as the session of the window has it.
    pictures: Option<PictureFormats>,
    /// Result of the last operation, or the reason why it failed.
    message: Option<Result<&'static str, String>>,
    /// A text was typed into a field in the last frame.
    is_typing: bool,
    /// A window over the editor is open, which Escape closes.
    pub(super) is_covered: bool,
    /// A position in the text that is shown.
    shown_line: Option<usize>,
    /// The window asks before it closes.
    is_close_asked: bool,
    /// The answer was to discard the changes.
    may_close: bool,
}

impl EditorPanel {
    /// Opens a layout for the hands of a setup, and looks for unsaved work of an earlier run in a folder.
    pub fn open(name: &str, fit: Fit, work: Option<&Path>) -> Result<Self, DocumentError> {
        Ok(Self::of(LayoutEditor::open(name, fit)?, work))
    }

    /// Opens the text of a layout of a recording, whose name is no path on this machine.
    pub fn of_recording(layout: &Layout, work: Option<&Path>) -> Self {
        let editor = LayoutEditor::from_text(&layout.file, &layout.text, layout.fit);
        Self::of(editor, work)
    }

    fn of(mut editor: LayoutEditor, work: Option<&Path>) -> Self {
        let recovery = work.map(|folder| editor.start_recovery(folder));
        let mut panel = Self::new(editor);
        panel.work = work.map(Path::to_owned);
        if let Some(Err(error)) = recovery {
            panel.message = Some(Err(error.to_string()));
        } else if panel.editor.is_open_elsewhere() {
            panel.message = Some(Ok(text("editor-open-elsewhere")));
        }
        panel
    }

    /// Keeps what was chosen for another layout: snapping, rulers, and the view of all boards.
    #[must_use]
    pub(super) fn with_choices_of(mut self, other: &Self) -> Self {
        self.snaps = other.snaps;
        self.grid_mm = other.grid_mm;
        self.has_rulers = other.has_rulers;
        (self.plan.view, self.plan.free) = (other.plan.view, other.plan.free);
        self
    }

    fn new(editor: LayoutEditor) -> Self {
        Self {
            plan: PlanPanel::new(editor.count("boards"), editor.count("spaces")),
            editor,
            board: 0,
            canvas_size: None,
            viewport: AreaViewport::default(),
            lab_viewport: None,
            items: BoardItems::default(),
            design: None,
            parts: Vec::new(),
            faulty: Vec::new(),
            shown: None,
            selected: Selection::default(),
            gesture: None,
            preview: Preview::default(),
            drag_check: DragCheck::default(),
            dragged_radius: None,
            snaps: true,
            grid_mm: 1.0,
            has_rulers: true,
            repeat: Repeat::default(),
            palette: Palette::default(),
            binding: BindingState::default(),
            form: FormState::default(),
            nudge: None,
            save_question: None,
            open_question: None,
            work: None,
            save_as: None,
            trial: None,
            left_trial: None,
            reach: None,
            next_poll: 0.0,
            next_keep: 0.0,
            kept: (0, Vec::new()),
            pictures: None,
            message: None,
            is_typing: false,
            is_covered: false,
            shown_line: None,
            is_close_asked: false,
            may_close: false,
        }
    }

    /// Returns the name of the layout, with a mark if there is unsaved work.
    fn marked_name(&self) -> String {
        let mark = if self.is_unsaved() { "* " } else { "" };
        format!("{mark}{}", self.editor.name())
    }

    /// Returns the title of the window: the name and the mark.
    pub(super) fn title(&self) -> String {
        format!("{} – {}", self.marked_name(), text("window-title"))
    }

    fn apply(&mut self, edit: &Edit) {
        self.commit_drafts();
        let applied = self.editor.apply(edit);
        self.report(applied);
    }

    fn report(&mut self, result: Result<(), EditError>) {
        self.message = result.err().map(|error| Err(error.to_string()));
    }

    /// Reads the items of the board again after a change of the text.
    fn update_items(&mut self) {
        if self.editor.is_editable() {
            let boards = self.editor.count("boards");
            self.board = self.board.min(boards.saturating_sub(1));
        }
        let shown = (self.editor.revision(), self.board);
        if self.shown == Some(shown) {
            return;
        }
        self.shown = Some(shown);
        self.gesture = None;
        self.dragged_radius = None;
        self.preview = Preview::default();
        if !self.editor.is_editable() {
            // The shown items stay, and cannot be edited until the brackets are corrected.
            self.parts = vec![None; self.items.items.len()];
            self.faulty.clear();
            return;
        }
        self.design = self.editor.design_layout();
        match board_items::placed(&self.editor, self.design.as_ref(), self.board) {
            Some(items) => self.items = items,
            None => self.items.clear(),
        }
        self.parts = board_items::add_unplaced(&self.editor, self.board, &mut self.items);
        self.faulty = board_items::faulty(&self.editor, &self.parts);
        self.select_parts_of_editor();
    }

    /// Undoes the last edit, and forgets the message about it.
    fn undo(&mut self) {
        self.commit_drafts();
        if self.editor.undo() {
            self.show_selection();
        }
        self.message = None;
    }

    /// Makes the last undone edit again.
    fn redo(&mut self) {
        self.commit_drafts();
        if self.editor.redo() {
            self.show_selection();
        }
        self.message = None;
    }

    /// Shows the board of what the editor has selected: keys act on it, and an edit that is undone may be one of another board. On the
    /// plan, the boards themselves are selected.
    fn show_selection(&mut self) {
        if self.plan.is_open {
            self.select_boards();
            return;
        }
        let selection = self.editor.selection().to_vec();
        let mut boards = selection.iter().filter_map(|part| part.board());
        let is_shown = boards.clone().any(|board| board == self.board);
        if let Some(board) = boards.next().filter(|_| !is_shown) {
            self.show_board(board);
            self.editor.select(selection);
            self.select_parts_of_editor();
        }
    }

    /// Selects everything on the board or the plan.
    fn select_all(&mut self) {
        if self.plan.is_open {
            self.select_all_in_plan();
            return;
        }
        let count = self.items.items.len();
        self.selected.set(0..count);
        self.select_items_in_editor();
    }

    /// Shows the whole board, or all of the plan.
    fn show_all(&mut self) {
        if self.plan.is_open {
            self.show_all_in_plan();
        } else {
            self.viewport = AreaViewport::default();
        }
    }

    /// Shows the selected items as large as they fit, or the whole board without any.
    fn zoom_to_selection(&mut self) {
        if self.plan.is_open {
            self.zoom_to_selection_in_plan();
            return;
        }
        let shapes = self.selected.shapes(&self.items.items);
        let bounds = Bounds::around(shapes.iter().map(|(_, shape)| shape));
        self.viewport = match (bounds, self.canvas_size) {
            (Some(bounds), Some(size)) => AreaViewport::fixed(Viewport::fit(bounds, size)),
            _ => AreaViewport::default(),
        };
    }

    /// Selects on the canvas what the editor has selected, as after an edit.
    fn select_parts_of_editor(&mut self) {
        let selection = self.editor.selection();
        let selection: HashSet<Part> = selection.iter().copied().collect();
        let is_selected = |part: &Option<Part>| {
            part.is_some_and(|part| {
                selection.contains(&part) || group(part).is_some_and(|it| selection.contains(&it))
            })
        };
        let indices = self.parts.iter().enumerate();
        let indices = indices.filter(|(_, part)| is_selected(part));
        self.selected.set(indices.map(|(index, _)| index));
    }

    /// Tells the editor what is selected on the canvas.
    fn select_items_in_editor(&mut self) {
        let parts = self.selected_parts();
        self.editor.select(parts);
    }

    fn selected_parts(&self) -> Vec<Part> {
        let parts = self.selected.iter();
        parts.filter_map(|index| *self.parts.get(index)?).collect()
    }

    /// Shows a part: its board, and its item selected. A board itself is shown on the plan while that is open.
    fn show_part(&mut self, part: Part) {
        let is_on_plan = self.plan.is_open && matches!(part, Part::Board(_));
        if let Some(board) = part.board().filter(|_| !is_on_plan) {
            self.leave_plan(board);
        }
        self.editor.select([part]);
        self.update_items();
        self.select_parts_of_editor();
    }

    fn show_board(&mut self, board: usize) {
        if board != self.board {
            self.board = board;
            self.viewport = AreaViewport::default();
            self.lab_viewport = None;
            // The form shows nothing of a board that is not on the canvas.
            self.editor.select([]);
            self.message = None;
            self.update_items();
        }
    }

    /// Returns the edit that moves parts of the board or the plan; `None` without parts.
    fn movement(&self, parts: Vec<Part>, by: Vec2) -> Option<Edit> {
        if self.plan.is_open {
            return self.movement_in_plan(&parts, by);
        }
        let by_mm = [rounded(by.x), rounded(by.y), 0.0];
        (!parts.is_empty()).then_some(Edit::Move { parts, by_mm })
    }
}

/// Returns the row of a key, or the radio group of an option.
const fn group(part: Part) -> Option<Part> {
    match part {
        Part::RowKey { board, row, .. } => Some(Part::Row { board, row }),
        Part::RadioOption { board, radio, .. } => Some(Part::Control {
            board,
            kind: ControlKind::Radio,
            index: radio,
        }),
        _ => None,
    }
}

/// Rounds a distance of the canvas to hundredths, as files have them.
fn rounded(value: f32) -> f64 {
    (f64::from(value) * 100.0).round() / 100.0
}

/// Updates the editor for the frame, and handles keys.
pub(super) fn prepare(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    recent: &mut RecentFiles,
    context: &mut PanelContext,
) {
    panel.pictures = context.pictures;
    let reach = &mut panel.reach;
    let reach = reach.get_or_insert_with(|| ReachCheck::new(context.sensors.setup()));
    reach.advance(&panel.editor);
    if panel.palette.is_open() {
        panel.palette.offered = actions::offered(ui.ctx(), context);
    }
    handle_keys(ui, panel, recent);
}

/// Does what keys and commands ask for.
fn handle_keys(ui: &mut egui::Ui, panel: &mut EditorPanel, recent: &mut RecentFiles) {
    panel.update_items();
    shortcuts::handle(ui, panel);
    palette::show(ui, panel);
    open::show(ui, panel, recent);
    panel.update_items();
}

/// Draws the tools, and the questions that wait for an answer.
pub(super) fn show_bar(ui: &mut egui::Ui, state: &mut PanelState) {
    if let Some(Ok(panel)) = &mut state.editor {
        bar::show(ui, panel);
        outside::show(ui, panel);
    }
}

/// Draws the problems of the layout.
pub(super) fn show_problems(ui: &mut egui::Ui, state: &mut PanelState) {
    if let Some(Ok(panel)) = &mut state.editor {
        problems::show(ui, panel);
    }
}

/// Draws the fields of what is selected, and the lists of the layout.
pub(super) fn show_form(ui: &mut egui::Ui, state: &mut PanelState) {
    if let Some(Ok(panel)) = &mut state.editor {
        let area = egui::ScrollArea::vertical().auto_shrink(false);
        area.show(ui, |ui| {
            form::show(ui, panel);
            lists::show(ui, panel);
        });
    }
}

/// Draws one board, or the plan of all.
pub(super) fn show_canvas(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    let Some(Ok(panel)) = &mut state.editor else {
        return;
    };
    panel.update_items();
    if panel.plan.is_open {
        plan::show(ui, panel, context);
    } else {
        canvas::show(ui, panel, context);
    }
}

/// Shows the reason why there is no layout to edit.
pub(super) fn show_error(ui: &mut egui::Ui, state: &mut PanelState) {
    if let Some(Err(error)) = &state.editor {
        ui.label(text("editor-cannot-open"));
        ui.monospace(error.as_str());
    }
}
