//! The pointer and the targets in space, as written → checked.

use super::Checked;
use crate::contact::TargetId;
use crate::document::DocumentError;
use crate::layout::controls::pointer::POINTER;
use crate::layout::model::MAX_TARGETS;
use crate::layout::schema;
use crate::layout::text::Spanned;

impl<'a> Checked<'a> {
    /// Their targets come after all others.
    pub(super) fn add_pointer_and_spaces(
        &mut self,
        written: &schema::Layout<'a>,
    ) -> Result<(), DocumentError> {
        let mut next = self.scene.len() + self.triggers.len();
        if let Some(pointer) = &written.pointer {
            self.refuse_target(POINTER, Spanned(self.pointer_word()), next)?;
            self.pointer = Some(self.pointer(pointer, TargetId(next as u32))?);
            next += 1;
        }
        for space in &written.spaces {
            let scenery = self.space(space, TargetId(next as u32))?;
            if scenery.names.is_empty() {
                let message = format!("space {} has no targets", self.spaces.len() + 1);
                return Err(self.document.error_at(self.name.0, message));
            }
            next += scenery.names.len();
            self.spaces.push(scenery);
        }
        Ok(())
    }

    /// Refuses a target that is not on a board where its name is taken or there are too many.
    pub(in crate::layout) fn refuse_target(
        &mut self,
        name: &'a str,
        word: Spanned<'a>,
        place: usize,
    ) -> Result<(), DocumentError> {
        if place >= MAX_TARGETS {
            let message = format!("a layout has at most {MAX_TARGETS} keys and other controls");
            return Err(self.document.error_at(word.0, message));
        }
        self.refuse_second(name, word)?;
        self.names.insert(name, ("target", word.0));
        Ok(())
    }

    /// Where the pointer stands in the file.
    pub(in crate::layout) fn pointer_word(&self) -> &'a str {
        let text = &self.document.text;
        let is_field = |at: &usize| {
            text[..*at]
                .trim_end_matches([' ', '\t'])
                .ends_with(['\n', '(', ','])
        };
        let mut found = text.match_indices("pointer:").map(|(at, _)| at);
        let field = found.find(is_field);
        field.map_or(self.name.0, |at| &text[at..at + POINTER.len()])
    }
}
