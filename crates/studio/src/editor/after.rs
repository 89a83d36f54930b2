//! The text that an edit would give, while the edit is not made: during a drag.

use super::{EditError, LayoutEditor};
use ademan_core::editing::{self, Edit};

impl LayoutEditor {
    /// Returns the text after an edit in an editor of its own, without a file, which tells its problems.
    pub fn after(&self, edit: &Edit) -> Result<Self, EditError> {
        let edited = editing::edit(&self.text, edit)?;
        Ok(Self::from_text(self.name(), &edited.text, self.fit))
    }
}
