//! The text decoders of the layouts.

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

    /// Iterates over the text decoders of the other layouts.
    pub fn other_text_filters(&self) -> impl Iterator<Item = &dyn PressFilter> {
        let layouts = self.profiles.iter().enumerate();
        let others = layouts.filter(|(profile, _)| *profile != self.active_profile);
        others.filter_map(|(_, profile)| profile.layout.filter())
    }

    /// Forgets the knowledge of the text decoders of all layouts about the person. Fails if the active one has none.
    pub(super) fn forget_learned(&mut self) -> Result<(), CommandError> {
        self.text_filter()?;
        for profile in &mut self.profiles {
            if let Some(filter) = profile.layout.filter_mut() {
                filter.forget();
            }
        }
        Ok(())
    }

    /// Makes filters forget the presses that they hold.
    pub(super) fn reset_filters(&mut self) {
        self.filters.reset();
        if let Some(filter) = self.active_layout().filter_mut() {
            filter.reset();
        }
    }
}
