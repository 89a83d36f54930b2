//! The window that has the focus, from reports of which one kind may be late.

use super::injector::WindowId;

/// The window that has the focus, as far as the display has reported it.
#[derive(Debug, Default)]
pub struct FollowedFocus {
    window: Option<WindowId>,
    /// `true` if it was set after the question whose answer comes next.
    is_newer_than_answer: bool,
}

impl FollowedFocus {
    /// Sets the window that has the focus now, if it is known. Returns `true` if another one had it before.
    pub fn set(&mut self, window: Option<WindowId>) -> bool {
        self.is_newer_than_answer |= window.is_some();
        self.replace(window)
    }

    /// Sets the window of an answer, unless the display has reported one since the question. The next question follows the
    /// answer. Returns `true` if another window had the focus before.
    pub fn update_from_answer(&mut self, answer: Option<WindowId>) -> bool {
        let is_late = answer.is_some() && std::mem::take(&mut self.is_newer_than_answer);
        !is_late && self.replace(answer)
    }

    fn replace(&mut self, window: Option<WindowId>) -> bool {
        let before = self.window;
        self.window = window.or(before);
        before.is_some() && self.window != before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_window_is_not_another_one_and_an_unknown_one_changes_nothing() {
        let mut focus = FollowedFocus::default();
        assert!(!focus.set(None) && !focus.set(Some(1)));
        assert!(!focus.set(Some(1)) && !focus.set(None));
        assert!(focus.set(Some(2)) && focus.set(Some(1)));
    }

    #[test]
    fn an_answer_to_a_question_of_before_the_last_report_is_ignored() {
        let mut focus = FollowedFocus::default();
        assert!(!focus.update_from_answer(Some(1)));
        assert!(focus.update_from_answer(Some(2)));
        assert!(focus.set(Some(3)));
        assert!(!focus.update_from_answer(None), "no answer yet");
        assert!(
            !focus.update_from_answer(Some(2)),
            "asked before the report"
        );
        assert!(!focus.update_from_answer(Some(3)));
        assert!(focus.update_from_answer(Some(1)));
    }
}
