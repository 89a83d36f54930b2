//! Values that are typed into the form. Each becomes an edit when its field is left, and before the layout is saved or closed.

use std::mem;

use eframe::egui;

use super::EditorPanel;
use crate::canvas::ItemShape;
use crate::canvas::gesture::Preview;
use crate::editor::{Edit, Part};

/// The content of a field that is typed.
struct FieldDraft {
    id: egui::Id,
    content: String,
    /// The edit that the content leads to; `None` if it is the present value.
    edit: Option<Edit>,
    /// A text stays in its field if its edit is refused. A number does not.
    is_text: bool,
    /// Reason why the edit was refused.
    refusal: Option<String>,
}

/// Position, size and angle that are typed or dragged.
pub(super) struct GeometryDraft {
    /// Index of the item.
    pub index: usize,
    /// The item as it would be.
    pub shape: ItemShape,
    /// The edits that lead to it.
    pub edits: Vec<Edit>,
}

/// Everything that is typed into the form and is not in the text of the layout yet.
#[derive(Default)]
pub(super) struct Drafts {
    /// The parts that the form shows.
    parts: Vec<Part>,
    fields: Vec<FieldDraft>,
    pub geometry: Option<GeometryDraft>,
}

impl Drafts {
    /// Returns `true` if a field is typed into, or has a text that was refused.
    pub fn is_typing(&self) -> bool {
        self.geometry.is_some() || !self.fields.is_empty()
    }

    /// Returns `true` if something differs from the layout.
    pub fn has_changes(&self) -> bool {
        let geometry = self.geometry.as_ref();
        geometry.is_some_and(|draft| !draft.edits.is_empty())
            || self.fields.iter().any(|draft| draft.edit.is_some())
    }

    /// Returns the edits of everything that differs from the layout.
    pub fn edits(&self) -> Vec<Edit> {
        let geometry = self.geometry.iter().flat_map(|draft| &draft.edits);
        let fields = self.fields.iter().filter_map(|draft| draft.edit.as_ref());
        geometry.chain(fields).cloned().collect()
    }

    fn field(&self, id: egui::Id) -> Option<&FieldDraft> {
        self.fields.iter().find(|draft| draft.id == id)
    }

    /// Returns the content of a field that is typed.
    pub fn content(&self, id: egui::Id) -> Option<&str> {
        self.field(id).map(|draft| draft.content.as_str())
    }

    /// Returns the reason why the text of a field was refused.
    pub fn refusal(&self, id: egui::Id) -> Option<&str> {
        self.field(id)?.refusal.as_deref()
    }

    /// Sets the text of a field, with the edit that it leads to.
    pub fn set_text(&mut self, id: egui::Id, content: String, edit: Option<Edit>) {
        self.set(FieldDraft {
            id,
            content,
            edit,
            is_text: true,
            refusal: None,
        });
    }

    /// Sets the number of a field, with the edit that it leads to.
    pub fn set_number(&mut self, id: egui::Id, number: f64, edit: Option<Edit>) {
        self.set(FieldDraft {
            id,
            content: number.to_string(),
            edit,
            is_text: false,
            refusal: None,
        });
    }

    fn set(&mut self, mut draft: FieldDraft) {
        match self.fields.iter_mut().find(|it| it.id == draft.id) {
            Some(before) => {
                if before.content == draft.content {
                    draft.refusal = before.refusal.take();
                }
                *before = draft;
            }
            None => self.fields.push(draft),
        }
    }

    /// Forgets that a text was refused: the next commit tries it again.
    pub fn retry(&mut self, id: egui::Id) {
        if let Some(draft) = self.fields.iter_mut().find(|draft| draft.id == id) {
            draft.refusal = None;
        }
    }
}

impl EditorPanel {
    /// Makes the edits of everything that is typed. Returns `false` if one is refused; the reason is the message, and a refused
    /// text stays in its field. A text that was refused before is left as it is.
    pub(super) fn commit_drafts(&mut self) -> bool {
        let mut results = Vec::new();
        if let Some(draft) = self.form.drafts.geometry.take() {
            self.preview = Preview::default();
            for edit in &draft.edits {
                results.push(self.editor.apply(edit));
            }
        }
        for mut draft in mem::take(&mut self.form.drafts.fields) {
            let Some(edit) = &draft.edit else {
                continue;
            };
            if draft.refusal.is_none() {
                let result = self.editor.apply(edit);
                draft.refusal = result.as_ref().err().map(ToString::to_string);
                results.push(result);
            }
            if draft.is_text && draft.refusal.is_some() {
                self.form.drafts.fields.push(draft);
            }
        }
        if results.is_empty() {
            return true;
        }
        let result: Result<(), _> = results.into_iter().collect();
        let is_done = result.is_ok();
        self.report(result);
        is_done
    }

    /// Discards everything that is typed: the fields show the values of the layout.
    pub(super) fn discard_drafts(&mut self) {
        self.form.drafts.fields.clear();
        if self.form.drafts.geometry.take().is_some() {
            self.preview = Preview::default();
        }
    }

    /// Commits what was typed for parts that the form does not show any more.
    pub(super) fn follow_selection(&mut self) {
        let parts = self.editor.selection().to_vec();
        if parts == self.form.drafts.parts {
            return;
        }
        // An edit of the parts before selects them.
        if self.form.drafts.has_changes() {
            self.commit_drafts();
            self.editor.select(parts.iter().copied());
            self.update_items();
        }
        self.form.drafts = Drafts {
            parts,
            ..Drafts::default()
        };
    }
}
