//! The text decoders of the layouts.

use super::{CommandError, Pipeline, PressFilter, TextState};
use crate::command::CommandOrigin;
use crate::hand::Side;

impl Pipeline {
    /// Returns the state of the text decoder of the active layout for displays, or `None` without a decoder.
    pub fn text_state(&self) -> Option<&TextState> {
        self.layout().filter().and_then(PressFilter::text_state)
    }

    /// Returns the text decoder of the active layout.
    pub(super) fn text_filter(&mut self) -> Result<&mut (dyn PressFilter + 'static), CommandError> {
        let layout = &mut self.profiles[self.active_profile].layout;
        layout.filter_mut().ok_or(CommandError::NoTextDecoder)
    }

    /// Replaces the word that is being typed by a candidate. Fails if displays show no candidate with this number, unless a layout asks:
    /// its key may be pressed in the step in which the word changes.
    pub(super) fn choose(&mut self, number: u8, origin: CommandOrigin) -> Result<(), CommandError> {
        let filter = self.text_filter()?;
        let shown = filter
            .text_state()
            .map_or(0, |state| state.candidates.len());
        if origin != CommandOrigin::Layout && usize::from(number) > shown {
            return Err(CommandError::NoCandidate(number));
        }
        filter.choose(number);
        Ok(())
    }

    /// Iterates over the text decoders of the other layouts.
    pub fn other_text_filters(&self) -> impl Iterator<Item = &dyn PressFilter> {
        let layouts = self.profiles.iter().enumerate();
        let others = layouts.filter(|(profile, _)| *profile != self.active_profile);
        others.filter_map(|(_, profile)| profile.layout.filter())
    }

    /// Forgets what the text decoders of all layouts have learned about the person. Fails if the active layout has no decoder.
    pub(super) fn forget_learned(&mut self) -> Result<(), CommandError> {
        self.text_filter()?;
        for profile in &mut self.profiles {
            if let Some(filter) = profile.layout.filter_mut() {
                filter.forget();
            }
        }
        Ok(())
    }

    /// Makes filters forget the presses that they hold, because a hand is lost.
    pub(super) fn lose_hand_in_filters(&mut self, side: Side) {
        self.filters.lose_hand(side);
        if let Some(filter) = self.active_layout().filter_mut() {
            filter.lose_hand(side);
        }
    }

    /// Makes filters forget the presses that they hold.
    pub(super) fn reset_filters(&mut self) {
        self.filters.reset();
        if let Some(filter) = self.active_layout().filter_mut() {
            filter.reset();
        }
    }
}
