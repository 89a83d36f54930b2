//! Other layouts in the editor: a file, or a new layout from one that comes with the program; pictures of the layout, and a link to it.

use std::path::{Path, PathBuf};

use eframe::egui::{self, Key};

use super::super::{ConvertSvg, PictureFormats, layouts};
use super::EditorPanel;
use super::shortcuts::is_asked;
use crate::editor::LayoutEditor;
use crate::recent::RecentFiles;
use crate::texts::text;
use ademan_core::document::{Document, FileKind, shipped_layouts};
use ademan_core::layout::Wearer;
use ademan_core::message::escape_path;
use ademan_runtime::files::{self, FileError, OpenDocument};
use ademan_runtime::layout_link::{LOCAL_PAGE, share_layout};

/// Width of the question, in points.
const WIDTH: f32 = 420.0;

/// A layout that is chosen.
#[derive(Default)]
pub(super) struct OpenQuestion {
    query: String,
    /// The field has had the focus, which it gets at first and after Enter.
    is_begun: bool,
    /// There was no layout for these words, or it could not be opened.
    has_failed: bool,
}

impl EditorPanel {
    /// Asks for a layout to open.
    pub(super) fn ask_for_layout(&mut self) {
        self.open_question = Some(OpenQuestion::default());
    }

    /// Returns `false` if another layout in place of this one would lose work; the reason is the message.
    fn can_be_left(&mut self) -> bool {
        if !self.commit_drafts() {
            return false;
        }
        let would_lose = self.would_lose_work();
        if would_lose {
            self.message = Some(Err(text("editor-open-unkept").to_owned()));
        }
        !would_lose
    }

    /// Opens a layout in place of this one, whose unsaved work is kept and offered when it is opened again. Returns `false` if it cannot be
    /// opened; the reason is the message.
    fn open_other(&mut self, name: &str) -> bool {
        if !self.can_be_left() {
            return false;
        }
        match LayoutEditor::open(name, self.editor.fit()) {
            Ok(editor) => {
                self.replace_editor(editor);
                true
            }
            Err(error) => {
                self.message = Some(Err(error.to_string()));
                false
            }
        }
    }

    /// Opens a new layout without controls in the same way.
    fn open_empty(&mut self) {
        if self.can_be_left() {
            self.replace_editor(LayoutEditor::empty(self.editor.fit()));
        }
    }

    fn replace_editor(&mut self, editor: LayoutEditor) {
        let mut trial = self.trial.take().or_else(|| self.left_trial.take());
        if let Some(trial) = &mut trial {
            trial.leave(&self.editor);
        }
        // Ends the recovery of this layout, whose lock may be the lock of the new one.
        self.editor = LayoutEditor::empty(editor.fit());
        let opened = Self::of(editor, self.work.as_deref());
        *self = opened.with_choices_of(self);
        self.left_trial = trial;
    }

    /// Writes a picture of lines beside the file of the layout.
    pub(super) fn export_svg(&mut self) {
        self.export("svg", &|svg| Ok(svg.into_bytes()));
    }

    /// Writes a picture of pixels beside the file of the layout.
    pub(super) fn export_png(&mut self) {
        self.export_converted("png", |formats| formats.png);
    }

    /// Writes a page to print beside the file of the layout.
    pub(super) fn export_pdf(&mut self) {
        self.export_converted("pdf", |formats| formats.pdf);
    }

    /// Copies the link that `ademan layout share` prints, with the layout as it is in the editor.
    pub(super) fn copy_link(&mut self, context: &egui::Context) {
        if !self.commit_drafts() {
            return;
        }
        let document = Document::new(self.editor.name(), self.editor.text());
        let link = share_layout(LOCAL_PAGE, document);
        self.message = Some(match link {
            Ok(link) => {
                context.copy_text(link);
                Ok(text("editor-link-copied"))
            }
            Err(error) => Err(error.to_string()),
        });
    }

    fn export_converted(
        &mut self,
        extension: &str,
        format: impl FnOnce(PictureFormats) -> ConvertSvg,
    ) {
        let convert = self.pictures.map(format);
        self.export(extension, &|svg| match convert {
            Some(convert) => convert(&svg),
            None => Err(text("editor-export-svg-only").to_owned()),
        });
    }

    /// Writes what becomes of the drawing of the layout, unless its text cannot be read.
    fn export(&mut self, extension: &str, convert: &dyn Fn(String) -> Result<Vec<u8>, String>) {
        if !self.commit_drafts() {
            return;
        }
        let layout = self.editor.layout().filter(|_| self.editor.is_read());
        let Some(layout) = layout else {
            let problem = self.editor.problems().first();
            self.message = problem.map(|it| Err(it.message.clone()));
            return;
        };
        let beside = self.editor.path().map(Path::to_owned);
        let done = match beside {
            Some(_) => text("editor-exported"),
            None => text("editor-exported-here"),
        };
        let path = beside.unwrap_or_else(|| PathBuf::from(self.last_name()));
        let path = path.with_extension(extension);
        let svg = layout.to_svg(&Wearer::default());
        let picture = svg.map_err(|error| error.to_string()).and_then(convert);
        let written = picture.and_then(|picture| write_new(&path, &picture));
        self.message = Some(match written {
            Ok(()) => Ok(done),
            Err(reason) => Err(format!("{}: {reason}", escape_path(&path))),
        });
    }
}

/// Returns the layout that is meant by words for which there is no layout: the only one in the lists of the question that has them in its
/// path or name. Other words are a name.
fn meant(words: &str, recent: &RecentFiles) -> String {
    let part = words.to_lowercase();
    let mut listed = recent
        .with_part(&part)
        .map(str::to_owned)
        .chain(shipped_with_part(&part).map(str::to_owned));
    match (listed.next(), listed.next()) {
        (Some(only), None) if Document::open_kind(FileKind::Layout, words).is_err() => only,
        _ => words.into(),
    }
}

/// Returns the shipped layouts that have a part, in small letters, in their names.
fn shipped_with_part(part: &str) -> impl Iterator<Item = &'static str> {
    shipped_layouts().filter(move |name| name.contains(part))
}

fn write_new(path: &Path, content: &[u8]) -> Result<(), String> {
    files::write_new(path, content).map_err(|error| match error {
        FileError::Exists => text("editor-export-exists").to_owned(),
        error => error.to_string(),
    })
}

/// Returns the path of a file that is dropped on the window, unless a question waits for an answer.
pub(in super::super) fn dropped_file(ui: &egui::Ui) -> Option<String> {
    let path = ui.input(|input| {
        let file = input.raw.dropped_files.last();
        file.map(|file| file.path().to_owned())
    });
    let path = path.filter(|_| !is_asked(ui))?;
    Some(path.to_string_lossy().into_owned())
}

/// Opens a file that is dropped on the window. With unsaved work it asks.
fn open_dropped(ui: &egui::Ui, panel: &mut EditorPanel) {
    let Some(query) = dropped_file(ui) else {
        return;
    };
    if panel.is_unsaved() {
        panel.open_question = Some(OpenQuestion {
            query,
            ..OpenQuestion::default()
        });
    } else {
        panel.open_other(&query);
    }
}

/// Asks which layout is opened: a file, one that was opened before, or one that comes with the program.
pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel, recent: &mut RecentFiles) {
    open_dropped(ui, panel);
    let Some(mut question) = panel.open_question.take() else {
        return;
    };
    let unsaved = match (panel.is_unsaved(), panel.would_lose_work()) {
        (false, _) => None,
        (true, false) => Some(text("editor-open-unsaved")),
        (true, true) => Some(text("editor-open-unkept")),
    };
    let failure = match &panel.message {
        Some(Err(reason)) if question.has_failed && unsaved != Some(reason.as_str()) => {
            Some(reason)
        }
        _ => None,
    };
    let (mut chosen, mut chosen_recent, mut is_empty) = (None, None, false);
    let mut is_closed = ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape));
    let modal = egui::Modal::new(egui::Id::unique("open-question"));
    modal.show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.strong(text("editor-open-title"));
        if let Some(words) = unsaved {
            ui.colored_label(ui.visuals().warn_fg_color, words);
        }
        if let Some(reason) = failure {
            ui.colored_label(ui.visuals().error_fg_color, reason.as_str());
        }
        let label = ui.label(text("editor-open-name"));
        let field = egui::TextEdit::singleline(&mut question.query).desired_width(f32::INFINITY);
        let field = ui.add(field).labelled_by(label.id);
        // A frame that only measures the question drops the focus again.
        if !question.is_begun && !ui.is_sizing_pass() {
            question.is_begun = field.has_focus();
            field.request_focus();
        }
        if field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
            chosen = Some(meant(question.query.trim(), recent));
            question.is_begun = false;
        }
        // The field stays where it is while a part of a name leaves fewer rows.
        let area = egui::ScrollArea::vertical()
            .max_height(260.0)
            .auto_shrink(false);
        area.show(ui, |ui| {
            let query = question.query.trim().to_lowercase();
            is_empty = query.is_empty()
                && ui
                    .selectable_label(false, text("editor-open-empty"))
                    .clicked();
            chosen_recent = layouts::show_recent(ui, recent, &query);
            ui.strong(text("layouts-shipped"));
            for name in shipped_with_part(&query) {
                if ui.selectable_label(false, name).clicked() {
                    chosen = Some(name.to_owned());
                }
            }
        });
        is_closed |= ui.button(text("editor-cancel")).clicked();
    });
    if let Some(file) = chosen_recent {
        match layouts::drop_missing(recent, &file) {
            None => _ = panel.open_other(&file),
            Some(message) => panel.message = Some(Err(message)),
        }
        return;
    }
    match chosen.filter(|name| !name.is_empty()) {
        Some(name) => {
            if !panel.open_other(&name) {
                // The words stay, to be corrected.
                question.has_failed = true;
                panel.open_question = Some(question);
            }
        }
        None if is_empty => panel.open_empty(),
        None if is_closed => {}
        None => panel.open_question = Some(question),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use eframe::egui::Modifiers;

    use super::super::tests::{TWO_KEYS, Window};
    use super::*;
    use crate::editor::{Edit, NewPart, Part};
    use ademan_core::layout::{Fit, Layout};
    use tempfile::TempDir;

    /// Returns a folder, and the path of a layout with a text in it.
    fn file(content: &str) -> (TempDir, String) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("mine.ron");
        fs::write(&path, content).expect("a file");
        let path = path.to_str().expect("a readable path").to_owned();
        (folder, path)
    }

    #[test]
    fn words_without_a_layout_stay_to_be_corrected() {
        let mut window = Window::open();
        window.press(Modifiers::COMMAND, Key::O);
        window.write("nunpad");
        window.press(Modifiers::NONE, Key::Enter);
        window.harness.run_steps(2);
        let question = window.panel().open_question.as_ref();
        assert!(question.is_some_and(|asked| asked.query == "nunpad"));
        window.press(Modifiers::COMMAND, Key::A);
        window.write("numpad");
        window.press(Modifiers::NONE, Key::Enter);
        assert!(window.panel().open_question.is_none());
        assert!(window.panel().editor.name().contains("numpad"));
    }

    #[test]
    fn an_empty_layout_that_replaces_another_one_is_not_open_elsewhere() {
        let folder = tempfile::tempdir().expect("a folder");
        let work = folder.path().join("editor");
        let empty = LayoutEditor::empty(Fit::default());
        let mut panel = EditorPanel::of(empty, Some(&work));
        assert_eq!(panel.message, None);
        panel.open_empty();
        assert_eq!(panel.message, None);
    }

    #[test]
    fn a_part_of_one_name_is_the_layout_and_other_words_are_a_name() {
        let (_folder, path) = file(TWO_KEYS);
        let mut recent = RecentFiles::default();
        recent.push(Path::new(&path));
        recent.push(Path::new("own-azerty-flat.ron"));
        for (words, expected) in [
            ("numpa", "numpad"),
            ("NumPa", "numpad"),
            ("qwerty-flat", "qwerty-flat"),
            ("qwerty", "qwerty"),
            ("azerty-fl", "azerty-fl"),
            ("mine.ro", path.as_str()),
            ("no-such-layout", "no-such-layout"),
            ("", ""),
            (path.as_str(), path.as_str()),
        ] {
            assert_eq!(meant(words, &recent), expected);
        }
    }

    #[test]
    fn the_picture_of_a_layout_without_a_file_is_in_the_working_folder() {
        let name = "picture-without-file.ron";
        let picture = Path::new(name).with_extension("svg");
        // A run that was killed has left it.
        let _ = fs::remove_file(&picture);
        let editor = LayoutEditor::from_text(name, TWO_KEYS, Fit::default());
        let mut panel = EditorPanel::of(editor, None);
        panel.export_svg();
        assert_eq!(panel.message, Some(Ok(text("editor-exported-here"))));
        fs::remove_file(picture).expect("the picture");
    }

    #[test]
    fn a_text_that_cannot_be_read_is_not_exported_as_it_was_before() {
        let (_folder, path) = file(TWO_KEYS);
        let mut panel = EditorPanel::open(&path, Fit::default(), None).expect("a layout");
        panel.apply(&Edit::SetField {
            parts: vec![Part::Board(0)],
            field: "travel_mm".to_owned(),
            value: Some("4000".to_owned()),
        });
        assert!(!panel.editor.is_read());
        panel.export_svg();
        assert!(matches!(panel.message, Some(Err(_))));
        assert!(!Path::new(&path).with_extension("svg").exists());
    }

    #[test]
    fn a_layout_whose_changes_are_not_kept_is_not_left() {
        let (_folder, path) = file(TWO_KEYS);
        let mut panel = EditorPanel::open(&path, Fit::default(), None).expect("a layout");
        panel.apply(&Edit::Add(NewPart::Layer));
        let edited = panel.editor.text().to_owned();
        panel.open_empty();
        panel.open_other(&path);
        assert_eq!(panel.editor.text(), edited);
        assert!(matches!(panel.message, Some(Err(_))));
        panel.undo();
        panel.open_empty();
        assert_eq!(panel.editor.count("boards"), 0);
    }

    #[test]
    fn a_layout_that_is_opened_again_offers_its_unsaved_work() {
        let (folder, path) = file(TWO_KEYS);
        let work = folder.path().join("editor");
        let opened = EditorPanel::open(&path, Fit::default(), Some(&work));
        let mut panel = opened.expect("a layout");
        panel.apply(&Edit::Add(NewPart::Layer));
        let edited = panel.editor.text().to_owned();
        panel.open_other(&path);
        assert_eq!(panel.message, None);
        assert_eq!(panel.editor.text(), TWO_KEYS);
        let found = panel.editor.found_work().map(|found| &found.text);
        assert_eq!(found, Some(&edited));
    }

    #[test]
    fn the_layout_of_a_recording_is_its_text_and_not_the_file_of_its_name() {
        let (folder, path) = file("Layout(name: \"Of this machine\")");
        let recorded = Layout::parse(TWO_KEYS, &path).expect("a layout");
        let work = folder.path().join("editor");
        let panel = EditorPanel::of_recording(&recorded, Some(&work));
        assert_eq!(panel.message, None);
        assert_eq!(panel.editor.text(), TWO_KEYS);
        assert_eq!(panel.editor.path(), None);
        assert!(!panel.editor.is_modified());
    }

    #[test]
    fn a_copy_of_a_layout_that_was_recorded_on_another_system_is_saved_in_the_working_folder() {
        for name in ["mine.ron", "/home/a/mine.ron", "C:\\layouts\\mine.ron"] {
            let recorded = Layout::parse(TWO_KEYS, name).expect("a layout");
            let mut panel = EditorPanel::of_recording(&recorded, None);
            panel.ask_for_path();
            let path = panel.save_as.map(|asked| asked.path);
            assert_eq!(path.as_deref(), Some("my-mine.ron"), "{name}");
        }
    }
}
