//! The text decoder of the active layout.

use super::{CommandError, Pipeline, PressFilter, TextState};

impl Pipeline {
    /// Returns what displays show of the text decoder of the active layout, if it has one.
    pub fn text_state(&self) -> Option<&TextState> {
        self.layout().filter().and_then(PressFilter::text_state)
    }

    /// Returns the text decoder of the active layout.
    pub(super) fn text_filter(&mut self) -> Result<&mut (dyn PressFilter + 'static), CommandError> {
        let layout = &mut self.profiles[self.active_profile].layout;
        layout.filter_mut().ok_or(CommandError::NoTextDecoder)
    }

    /// Makes filters forget the presses that they hold.
    pub(super) fn reset_filters(&mut self) {
        self.filters.reset();
        if let Some(filter) = self.active_layout().filter_mut() {
            filter.reset();
        }
    }
}
