//! The palette of commands: every command of the editor that can be used, found by a part of its name.

use eframe::egui::{self, Align2, EventFilter, Key};

use super::super::actions::{Action, Offer};
use super::shortcuts::{ARROWS, FINE_STEP_MM, is_asked};
use super::{EditorPanel, bar, plan};
use crate::editor::{ControlKind, Edit, Part};
use crate::texts::text;

/// Width of the palette, in points.
const WIDTH: f32 = 420.0;

/// Distance of the palette from the upper edge of the window, in points.
const TOP: f32 = 90.0;

/// The keys that do not move the focus from the field of the palette.
const FIELD_KEYS: EventFilter = EventFilter {
    tab: true,
    horizontal_arrows: true,
    vertical_arrows: true,
    escape: false,
};

/// The palette between two frames.
#[derive(Default)]
pub(super) struct Palette {
    is_open: bool,
    query: String,
    /// Index of the chosen command among those that are found.
    chosen: usize,
    /// The actions of the window that can be performed, besides the commands of the editor.
    pub offered: Vec<Offer>,
    /// The action that was chosen, until the window performs it.
    action: Option<Action>,
}

/// The action of a command.
type Run = Box<dyn Fn(&mut EditorPanel, &egui::Context)>;

/// A command of the editor.
struct Command {
    name: String,
    /// Keys that do the same; may be empty.
    shortcut: String,
    run: Run,
}

impl Palette {
    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Opens the palette, or closes it.
    pub(super) fn toggle(&mut self) {
        *self = Self {
            is_open: !self.is_open,
            ..Self::default()
        };
    }
}

fn command(
    name: &'static str,
    shortcut: &'static str,
    run: impl Fn(&mut EditorPanel, &egui::Context) + 'static,
) -> Command {
    Command {
        name: text(name).to_owned(),
        shortcut: shortcut.to_owned(),
        run: Box::new(run),
    }
}

/// Returns the commands that can be used now.
fn commands(shown: &EditorPanel) -> Vec<Command> {
    let mut commands = vec![
        command("editor-open", "Ctrl-O", |panel, _| panel.ask_for_layout()),
        command("editor-export", "", |panel, _| panel.export_svg()),
        command("editor-export-png", "", |panel, _| panel.export_png()),
        command("editor-export-pdf", "", |panel, _| panel.export_pdf()),
        command("editor-copy-link", "", EditorPanel::copy_link),
        command("editor-save", "Ctrl-S", |panel, _| _ = panel.save()),
        command("editor-save-as", "", |panel, _| panel.ask_for_path()),
        paste_command(),
        command("editor-select-all", "Ctrl-A", |panel, _| panel.select_all()),
        command("editor-fit", "", |panel, _| panel.show_all()),
        command("editor-snap", "", |panel, _| panel.snaps = !panel.snaps),
        command("editor-rulers", "", |panel, _| {
            panel.has_rulers = !panel.has_rulers;
        }),
    ];
    if shown.editor.can_undo() {
        commands.push(command("editor-undo", "Ctrl-Z", |panel, _| panel.undo()));
    }
    if shown.editor.can_redo() {
        commands.push(command("editor-redo", "Ctrl-Y", |panel, _| panel.redo()));
    }
    if shown.trial.is_some() {
        commands.push(command("editor-try", "", |panel, _| {
            if let Some(trial) = &mut panel.trial {
                trial.set_on(!trial.is_on());
            }
        }));
    }
    commands.extend(views(shown));
    commands.extend(grids());
    if !shown.editor.selection().is_empty() {
        commands.extend(selection_commands());
    }
    if !shown.is_nothing_selected() {
        commands.extend(nudges(shown.grid_mm));
    }
    if shown.bindable().is_some() {
        commands.push(command("editor-press-key", "", |panel, _| {
            panel.begin_capture();
        }));
    }
    commands.extend(item_commands(shown));
    for &kind in ControlKind::ALL {
        let mut add = command("editor-add", "", move |panel, _| panel.add_control(kind));
        add.name = format!("{}: {}", add.name, bar::kind_words(kind));
        commands.push(add);
    }
    for (name, new) in bar::NEW_PARTS {
        let mut add = command(name, "", move |panel, _| panel.add(new.clone()));
        add.name = format!("{}: {}", text("editor-add"), add.name);
        commands.push(add);
    }
    for (action, name, keys) in &shown.palette.offered {
        let action = *action;
        commands.push(Command {
            name: (*name).to_owned(),
            shortcut: keys.clone(),
            run: Box::new(move |panel, _| panel.palette.action = Some(action)),
        });
    }
    commands
}

/// Returns the commands that choose the distance of the grid.
fn grids() -> impl Iterator<Item = Command> {
    bar::GRIDS_MM.into_iter().map(|grid_mm| {
        let mut choose = command("editor-grid", "", move |panel, _| panel.grid_mm = grid_mm);
        choose.name = format!("{}: {grid_mm} mm", choose.name);
        choose
    })
}

/// Returns the commands that move what is selected, as the arrow keys do.
fn nudges(grid_mm: f32) -> Vec<Command> {
    let mut commands = Vec::new();
    for (_, sign, direction, words) in ARROWS {
        let steps = [
            (grid_mm, sign.to_owned()),
            (FINE_STEP_MM, format!("Shift-{sign}")),
        ];
        for (step_mm, keys) in steps {
            let mut nudge = command(words, "", move |panel, context| {
                let now = context.input(|input| input.time);
                panel.nudge(direction * step_mm, now);
            });
            nudge.name = format!("{}: {step_mm} mm", nudge.name);
            nudge.shortcut = keys;
            commands.push(nudge);
        }
    }
    commands
}

impl EditorPanel {
    /// Returns `true` while the palette takes what is typed.
    pub(in super::super) fn has_palette(&self) -> bool {
        self.palette.is_open()
    }

    /// Returns the action of the window that was chosen in the palette.
    pub(in super::super) fn take_action(&mut self) -> Option<Action> {
        self.palette.action.take()
    }
}

/// Returns the commands that show a board, or all boards from a side.
fn views(shown: &EditorPanel) -> Vec<Command> {
    let mut commands = vec![command("editor-plan", "", |panel, _| panel.open_plan())];
    for (name, view) in plan::VIEWS {
        commands.push(command(name, "", move |panel, _| panel.view_plan(view)));
    }
    for board in 0..shown.editor.count("boards") {
        let mut show = command("editor-board", "", move |panel, _| panel.leave_plan(board));
        show.name = shown.board_name(board);
        commands.push(show);
    }
    commands
}

/// Returns the commands of the controls that are selected on a board.
fn item_commands(shown: &EditorPanel) -> Vec<Command> {
    let mut commands = Vec::new();
    let count = shown.selected.len();
    if count >= 1 {
        commands.push(command("editor-snap-to-grid", "", |panel, _| {
            let (parts, grid_mm) = (panel.selected_parts(), f64::from(panel.grid_mm));
            panel.apply(&Edit::Snap { parts, grid_mm });
        }));
        commands.push(command("editor-repeat", "", |panel, _| {
            panel.repeat.is_asked = true;
        }));
        commands
            .extend(bar::MIRRORS.map(|(name, axis)| {
                edit_selected(name, move |parts| Edit::Mirror { parts, axis })
            }));
    }
    if count >= 2 {
        commands.extend(
            bar::ALIGNMENTS
                .map(|(name, edge)| edit_selected(name, move |parts| Edit::Align { parts, edge })),
        );
    }
    if count >= 3 {
        commands.extend(bar::DISTRIBUTIONS.map(|(name, axis)| {
            edit_selected(name, move |parts| Edit::Distribute { parts, axis })
        }));
    }
    if shown.editor.selected_keys().len() >= 2 {
        commands.push(command("editor-add-chord", "", |panel, _| {
            panel.add_chord()
        }));
    }
    commands
}

/// Returns the commands of a selection, which a right click offers.
fn selection_commands() -> [Command; 5] {
    [
        command("editor-copy", "Ctrl-C", EditorPanel::copy),
        command("editor-cut", "Ctrl-X", EditorPanel::cut),
        command("editor-duplicate", "Ctrl-D", |panel, _| panel.duplicate()),
        command("editor-delete", "Delete", |panel, _| panel.delete()),
        command("editor-zoom-selection", "F", |panel, _| {
            panel.zoom_to_selection();
        }),
    ]
}

/// Returns the command that asks the desktop for the clipboard.
fn paste_command() -> Command {
    command("editor-paste", "Ctrl-V", |_, context| {
        context.send_viewport_cmd(egui::ViewportCommand::RequestPaste);
    })
}

/// Shows the menu of the selection at a right click, with the command that pastes.
pub(super) fn show_menu(response: &egui::Response, panel: &mut EditorPanel) {
    response.context_menu(|ui| {
        let has_selection = !panel.editor.selection().is_empty();
        let [copy, cut, others @ ..] = selection_commands().map(|entry| (entry, has_selection));
        let entries = [copy, cut, (paste_command(), true)];
        for (command, is_enabled) in entries.into_iter().chain(others) {
            let entry = egui::Button::new(command.name).shortcut_text(command.shortcut);
            if ui.add_enabled(is_enabled, entry).clicked() {
                (command.run)(panel, ui.ctx());
            }
        }
    });
}

/// Returns a command that edits the controls that are selected.
fn edit_selected(name: &'static str, edit: impl Fn(Vec<Part>) -> Edit + 'static) -> Command {
    command(name, "", move |panel, _| {
        let parts = panel.selected_parts();
        panel.apply(&edit(parts));
    })
}

/// Returns `true` if a name has all words of a query, in any order and case.
fn is_found(name: &str, query: &str) -> bool {
    let name = name.to_lowercase();
    let query = query.to_lowercase();
    query.split_whitespace().all(|word| name.contains(word))
}

/// Draws the palette while it is open, and runs the chosen command.
pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    if !panel.palette.is_open {
        return;
    }
    if is_asked(ui) {
        // The field would keep the focus, and run commands below the question.
        panel.palette = Palette::default();
        ui.memory_mut(egui::Memory::stop_text_input);
        return;
    }
    let commands = commands(panel);
    // Several presses may come with one frame, and so may words and Enter.
    let [escapes, down, up, entered] = ui.input_mut(|input| {
        let mut count = |key| input.count_and_consume_key(egui::Modifiers::NONE, key);
        [Key::Escape, Key::ArrowDown, Key::ArrowUp, Key::Enter].map(&mut count)
    });
    let palette = &mut panel.palette;
    let mut run = None;
    egui::Window::new(text("editor-palette"))
        .anchor(Align2::CENTER_TOP, [0.0, TOP])
        .collapsible(false)
        .resizable(false)
        .show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            let field = egui::TextEdit::singleline(&mut palette.query)
                .hint_text(text("editor-palette-hint"))
                .event_filter(FIELD_KEYS)
                .desired_width(f32::INFINITY);
            let field = ui.add(field);
            let name = text("editor-palette-hint");
            field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, name));
            // A request for what it has would end the composition of a letter, and let arrow keys move the focus.
            if !field.has_focus() {
                field.request_focus();
            }
            if field.changed() {
                palette.chosen = 0;
            }
            let found = commands.iter();
            let found = found.filter(|command| is_found(&command.name, &palette.query));
            let found: Vec<&Command> = found.collect();
            let last = found.len().saturating_sub(1);
            palette.chosen = (palette.chosen + down).saturating_sub(up).min(last);
            if entered > 0 {
                run = found.get(palette.chosen).copied();
            }
            let area = egui::ScrollArea::vertical().max_height(320.0);
            area.show(ui, |ui| {
                if found.is_empty() {
                    ui.weak(text("editor-palette-none"));
                }
                for (index, command) in found.iter().enumerate() {
                    if show_row(ui, command, index == palette.chosen) {
                        run = Some(*command);
                    }
                }
            });
        });
    if escapes > 0 {
        panel.palette = Palette::default();
        return;
    }
    if let Some(command) = run {
        panel.palette = Palette::default();
        // The field would have the focus in the next frame, too, and keep what is pasted then from the canvas.
        ui.memory_mut(egui::Memory::stop_text_input);
        (command.run)(panel, ui.ctx());
    }
}

/// Shows a command. Returns `true` if it was clicked.
fn show_row(ui: &mut egui::Ui, command: &Command, is_chosen: bool) -> bool {
    let row = ui.horizontal(|ui| {
        let row = ui.selectable_label(is_chosen, &command.name);
        if is_chosen {
            row.scroll_to_me(None);
        }
        ui.weak(&command.shortcut);
        row.clicked()
    });
    row.inner
}

#[cfg(test)]
mod tests {
    use ademan_core::layout::Fit;
    use eframe::egui::{Event, Modifiers};

    use super::super::tests::{TWO_KEYS, Window};
    use super::*;
    use crate::editor::LayoutEditor;

    fn pressed(key: Key) -> Event {
        Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        }
    }

    #[test]
    fn arrow_keys_choose_a_command_and_move_no_controls() {
        let mut window = Window::open();
        window.press(Modifiers::COMMAND, Key::A);
        window.press(Modifiers::COMMAND, Key::K);
        for _ in 0..3 {
            let events = [Key::ArrowDown, Key::ArrowDown].map(pressed);
            window.harness.input_mut().events.extend(events);
            window.harness.run_steps(1);
        }
        assert_eq!(window.panel().palette.chosen, 6);
        assert_eq!(window.text(), TWO_KEYS);
    }

    #[test]
    fn words_and_enter_of_one_frame_run_the_command_of_these_words() {
        let mut window = Window::open();
        window.press(Modifiers::COMMAND, Key::K);
        let words = Event::Text(text("editor-select-all").to_owned());
        window
            .harness
            .input_mut()
            .events
            .extend([words, pressed(Key::Enter)]);
        window.harness.run_steps(2);
        assert!(!window.panel().palette.is_open());
        assert_eq!(window.panel().selected.len(), 2);
    }

    #[test]
    fn a_question_closes_the_palette_and_no_command_is_run_below_it() {
        let mut window = Window::open();
        window.panel().add_control(ControlKind::Key);
        window.press(Modifiers::COMMAND, Key::K);
        window.close();
        assert!(window.panel().is_close_asked);
        assert!(!window.panel().palette.is_open());
        window.write(text("editor-snap"));
        window.press(Modifiers::NONE, Key::Enter);
        assert!(window.panel().snaps);
    }

    #[test]
    fn a_command_is_found_by_parts_of_its_name() {
        assert!(is_found("Align left edges", "edg LEFT"));
        assert!(!is_found("Align left edges", "right"));
    }

    #[test]
    fn only_edits_that_can_be_undone_or_made_again_are_offered() {
        let editor = LayoutEditor::empty(Fit::default());
        let mut panel = EditorPanel::new(editor);
        let offered = |shown: &EditorPanel| {
            let names: Vec<String> = commands(shown).into_iter().map(|it| it.name).collect();
            ["editor-undo", "editor-redo"].map(|key| names.iter().any(|name| name == text(key)))
        };
        assert_eq!(offered(&panel), [false, false]);
        panel.add_control(ControlKind::Key);
        assert_eq!(offered(&panel), [true, false]);
        panel.undo();
        assert_eq!(offered(&panel), [false, true]);
    }

    #[test]
    fn every_command_has_its_own_name() {
        let text = "Layout(name: \"a\", boards: [(
            pose: (anchor: elbow, forward_mm: 320), rows: [(at_mm: (0, 0), keys: \"A B C\")],
        )])";
        let editor = LayoutEditor::from_text("a.ron", text, Fit::default());
        let mut panel = EditorPanel::new(editor);
        panel.update_items();
        panel.select_all();
        let commands = commands(&panel).into_iter();
        let names: Vec<String> = commands.map(|it| it.name).collect();
        let unique: std::collections::BTreeSet<&String> = names.iter().collect();
        assert_eq!(unique.len(), names.len(), "{names:?}");
    }
}
