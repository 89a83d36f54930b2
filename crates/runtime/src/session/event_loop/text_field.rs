//! The text field that an output types into: its kind, which the text decoder follows, and the candidate that is chosen in it.

use super::SessionLoop;
use crate::output::{FieldKind, TextField};
use crate::session::SessionError;
use ademan_core::command::{Command, CommandOrigin, TextMode};

/// The field of the last turn of the loop, and the modes of the text decoders before it.
pub(super) struct FollowedField {
    field: TextField,
    /// The mode of the decoder of each profile before a field that takes exactly what is typed.
    modes: Vec<Option<TextMode>>,
}

impl FollowedField {
    pub(super) fn new(profiles: usize) -> Self {
        Self {
            field: TextField::default(),
            modes: vec![None; profiles],
        }
    }

    /// Returns the mode to set for the decoder of a profile, whose mode is `mode`; `None` if nothing has to be set.
    fn follow(&mut self, field: TextField, profile: usize, mode: TextMode) -> Option<TextMode> {
        let is_left = field.generation != self.field.generation;
        self.field = field;
        let before = self.modes.get_mut(profile)?;
        if field.kind == FieldKind::Literal {
            let is_set = mode == TextMode::Literal;
            return (!is_set).then(|| {
                *before = Some(mode);
                TextMode::Literal
            });
        }
        match before.take() {
            Some(before) if mode == TextMode::Literal => Some(before),
            // Text that was typed elsewhere is not part of this text.
            _ => is_left.then_some(mode),
        }
    }
}

impl SessionLoop<'_> {
    /// Makes the text decoder follow the field that has the focus: a recording contains this as commands.
    pub(super) fn follow_text_field(&mut self) -> Result<(), SessionError> {
        let Some(mode) = self.pipeline.text_state().map(|state| state.mode) else {
            return Ok(());
        };
        // Only if there is a decoder: to answer, an output watches other keyboards.
        let field = self.sink.0.text_field();
        let profile = self.pipeline.active_profile();
        if let Some(mode) = self.text_field.follow(field, profile, mode) {
            let _ = self.execute_in_pipeline(Command::Text { mode }, CommandOrigin::Client)?;
        }
        if let Some(number) = self.sink.0.take_choice() {
            let command = Command::Candidate { number };
            let _ = self.execute_in_pipeline(command, CommandOrigin::Client)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use TextMode::{Auto, Literal, Suggest};

    fn field(generation: u32, kind: FieldKind) -> TextField {
        TextField { generation, kind }
    }

    #[test]
    fn a_field_for_a_password_is_literal_and_the_next_one_is_as_before() {
        let mut followed = FollowedField::new(2);
        let password = field(2, FieldKind::Literal);
        assert_eq!(followed.follow(TextField::default(), 0, Auto), None);
        // Another field: the decoder forgets the word.
        assert_eq!(
            followed.follow(field(1, FieldKind::Text), 0, Auto),
            Some(Auto)
        );
        assert_eq!(followed.follow(password, 0, Auto), Some(Literal));
        assert_eq!(followed.follow(password, 0, Literal), None);
        // Another layout is not an exception.
        assert_eq!(followed.follow(password, 1, Suggest), Some(Literal));
        let text = field(3, FieldKind::Text);
        assert_eq!(followed.follow(text, 1, Literal), Some(Suggest));
        assert_eq!(followed.follow(text, 0, Literal), Some(Auto));
        assert_eq!(followed.follow(text, 0, Auto), None);
    }

    #[test]
    fn a_decoder_that_was_literal_before_stays_so() {
        let mut followed = FollowedField::new(1);
        assert_eq!(
            followed.follow(field(1, FieldKind::Literal), 0, Literal),
            None
        );
        assert_eq!(
            followed.follow(field(2, FieldKind::Unknown), 0, Literal),
            Some(Literal)
        );
        assert_eq!(
            followed.follow(field(2, FieldKind::Unknown), 0, Literal),
            None
        );
    }
}
