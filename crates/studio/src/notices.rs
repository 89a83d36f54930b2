//! Notices of a session in the language of the window. A notice that is not in the table is shown in English, as on a terminal.

use std::borrow::Cow;
use std::sync::LazyLock;

use super::texts::text;
use ademan_core::command::CommandOrigin;
use ademan_core::hand::{FingerSet, Side};
use ademan_core::pipeline::HandLoss;
use ademan_runtime::session::Notice;

/// The notices without values, as a view has them, and the keys of their words.
static NOTICES: LazyLock<Vec<(String, &'static str)>> = LazyLock::new(|| {
    use CommandOrigin::*;
    let armed = |has_effect| Notice::Armed { has_effect };
    let mut notices = vec![
        (Notice::Disarmed, "notice-disarmed"),
        (armed(true), "notice-armed"),
        (armed(false), "notice-armed-nowhere"),
        (Notice::Stalled, "notice-stalled"),
        (Notice::OutputStalled, "notice-output-stalled"),
        (Notice::Paused(Layout), "notice-paused-by-layout"),
        (Notice::Paused(RateLimit), "notice-paused-by-rate"),
        (Notice::HandFound(Side::Left), "notice-left-found"),
        (Notice::HandFound(Side::Right), "notice-right-found"),
        (
            Notice::UntrustedFingers(FingerSet::NONE),
            "notice-sensors-work",
        ),
        (Notice::WatchdogLost, "notice-watchdog-lost"),
    ];
    for origin in [Suspend, Client, Signal, PanicKeys, Watchdog] {
        notices.push((Notice::Paused(origin), "notice-paused"));
    }
    for loss in [HandLoss::NoReadings, HandLoss::NotSeen] {
        notices.push((Notice::HandLost(Side::Left, loss), "notice-left-lost"));
        notices.push((Notice::HandLost(Side::Right, loss), "notice-right-lost"));
    }
    for (loss, left, right) in [
        (
            HandLoss::TooFast,
            "notice-left-too-fast",
            "notice-right-too-fast",
        ),
        (HandLoss::Stuck, "notice-left-stuck", "notice-right-stuck"),
    ] {
        notices.push((Notice::HandLost(Side::Left, loss), left));
        notices.push((Notice::HandLost(Side::Right, loss), right));
    }
    let notices = notices.into_iter();
    notices
        .map(|(notice, key)| (notice.to_string(), key))
        .collect()
});

/// Commands of a terminal in notices, and the keys of the words on the buttons that do the same.
const BUTTONS: [(&str, &str); 2] = [
    ("`ademan ctl recenter`", "button-recenter"),
    ("`ademan ctl resume`", "button-resume"),
];

/// Returns a notice of a view in the language of the window. A command that a button sends has the name of the button: a session of the
/// window has no control socket, and the command would reach another one.
pub fn translate(message: &str) -> Cow<'_, str> {
    let known = NOTICES.iter().find(|(notice, _)| notice == message);
    if let Some((_, key)) = known {
        return text(key).into();
    }
    let mut words = Cow::Borrowed(message);
    for (command, key) in BUTTONS {
        if words.contains(command) {
            words = words.replace(command, &format!("`{}`", text(key))).into();
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texts::{Language, set_language};

    #[test]
    fn notices_without_values_are_shown_in_the_language_of_the_window() {
        set_language(Language::Spanish);
        let translations = NOTICES.iter().map(|(notice, _)| translate(notice));
        for (translation, (notice, _)) in translations.zip(&*NOTICES) {
            assert_ne!(translation, notice.as_str());
        }
        let notice = Notice::Stalled.to_string();
        assert_eq!(
            translate(&notice),
            "Sin lecturas útiles: se ha soltado todo"
        );
    }

    #[test]
    fn other_notices_are_not_changed() {
        let notice = Notice::Dropped(3).to_string();
        assert_eq!(translate(&notice), notice);
    }

    #[test]
    fn a_command_of_a_notice_is_the_button_that_sends_it() {
        set_language(Language::Spanish);
        let notice = "nothing is reached; `ademan ctl recenter` brings the boards below the hand";
        assert_eq!(
            translate(notice),
            "nothing is reached; `Recentrar` brings the boards below the hand"
        );
    }
}
