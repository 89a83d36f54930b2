//! Notices of a session in the language of the window. A notice that is not in the table is shown in English, as on a terminal.

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
    let (left, right) = ("notice-left-too-fast", "notice-right-too-fast");
    notices.push((Notice::HandLost(Side::Left, HandLoss::TooFast), left));
    notices.push((Notice::HandLost(Side::Right, HandLoss::TooFast), right));
    let notices = notices.into_iter();
    notices
        .map(|(notice, key)| (notice.to_string(), key))
        .collect()
});

/// Returns a notice of a view in the language of the window.
pub fn translate(message: &str) -> &str {
    let known = NOTICES.iter().find(|(notice, _)| notice == message);
    known.map_or(message, |(_, key)| text(key))
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
            assert_ne!(translation, notice);
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
}
