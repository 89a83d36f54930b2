//! The link for a headset: shown until one is connected, and the consent to its keys.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use ademan::capture::{CaptureError, Headset, HeadsetList, Source, SourceEvent, SourceStats};
use ademan::studio::headset::{HeadsetLink, QrModules};
use ademan::studio::texts::{Language, text};

use crate::picture;
use crate::played_hand::PlayedHand;
use crate::window::{Opening, StudioWindow};

const LINK: &str = "https://192.168.1.7:8443/#token=0123456789abcdef0123456789abcdef";

/// The simulated hand as the hand of a headset.
struct HeadsetHand {
    hand: PlayedHand,
    headsets: HeadsetList,
}

impl Source for HeadsetHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        self.hand.next()
    }

    fn headsets(&self) -> Option<HeadsetList> {
        Some(self.headsets.clone())
    }

    fn name(&self) -> &str {
        "headset:192.168.1.7:8443"
    }

    fn packet_period(&self) -> Option<Duration> {
        self.hand.packet_period()
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        self.hand.stats()
    }
}

/// Returns modules that are no QR code of anything, as many as a link has.
fn code() -> QrModules {
    const WIDTH: usize = 41;
    QrModules::new(WIDTH, (0..WIDTH * WIDTH).map(|it| it % 3 == 0).collect())
}

/// Opens Studio with a source that waits for headsets. The hand moves as far as the limit says.
fn open(limit: &Arc<AtomicUsize>) -> (StudioWindow, HeadsetList) {
    let opening = Opening::default();
    let setup = opening.setup.clone().load_files().expect("the files");
    let headsets = HeadsetList::default();
    let source = HeadsetHand {
        hand: PlayedHand::new(&setup, Arc::clone(limit)).expect("a hand for the layout"),
        headsets: headsets.clone(),
    };
    let link = HeadsetLink {
        url: LINK.to_owned(),
        code: Some(code()),
    };
    let mut window = opening.open_with(Box::new(source), |app| app.with_headset(Some(link)));
    window.draw_until("the state of the headset", |window| {
        window.has(text("headset-none"))
    });
    (window, headsets)
}

fn quest() -> Headset {
    Headset::new("Quest 3", [192, 168, 1, 9].into())
}

#[test]
fn the_link_is_shown_until_a_headset_is_connected_and_when_a_person_asks_for_it() {
    let (mut window, headsets) = open(&Arc::default());
    assert!(window.has(LINK) && window.has(text("headset-code")));
    picture::draw(&mut window, "headset");
    let connected = headsets.add(quest());
    window.draw_until("the name of the headset", |window| {
        window.has_words("Quest 3") && window.has_words("192.168.1.9")
    });
    let is_shown = |window: &StudioWindow| window.has(LINK) || window.has(text("headset-code"));
    assert!(!is_shown(&window));
    picture::draw(&mut window, "headset-connected");
    window.click(text("headset-show"));
    assert!(is_shown(&window));
    window.click(text("headset-hide"));
    assert!(!is_shown(&window));
    drop(connected);
    window.draw_until("no headset", |window| window.has(text("headset-none")));
    assert!(!is_shown(&window), "its page connects again by itself");

    // The window is closed and opened again.
    window.press_key(egui::Key::Escape);
    window.draw(5);
    assert!(!window.has(text("headset-allow")));
    window.click(text("headset-none"));
    window.draw(5);
    assert!(window.has(text("headset-allow")));
}

#[test]
fn the_person_at_the_computer_forbids_and_allows_keys() {
    let limit = Arc::default();
    let (mut window, _headsets) = open(&limit);
    let suppressed = |window: &StudioWindow| window.model().stats.suppressed.keys_by_role;
    let play_until = |window: &mut StudioWindow, is_done: &dyn Fn(&StudioWindow) -> bool| {
        for _ in 0..60 {
            let until = limit.fetch_add(10, Ordering::Relaxed) + 10;
            window.wait_for_readings(until);
            if is_done(window) {
                return true;
            }
        }
        false
    };
    window.click(text("headset-forbid"));
    assert!(play_until(&mut window, &|window| suppressed(window) > 0));
    let presses = |window: &StudioWindow| {
        let mut events = window.model().history.events();
        events.any(|event| event.is_press)
    };
    assert!(
        !presses(&window),
        "a source that only points presses nothing"
    );
    window.click(text("headset-allow"));
    assert!(play_until(&mut window, &presses));
}

#[test]
fn the_window_of_the_headset_is_in_the_language_of_the_person() {
    let (mut window, _headsets) = open(&Arc::default());
    window.harness.state_mut().settings().language = Some(Language::Spanish);
    window.draw(3);
    assert!(window.has("Ning\u{fa}n visor conectado"));
    picture::draw(&mut window, "headset-spanish");
    window.harness.state_mut().settings().language = Some(Language::English);
    window.draw(3);
}
