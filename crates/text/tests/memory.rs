//! A tap allocates nothing after the start.
#![allow(
    unsafe_code,
    reason = "a global allocator can only be written as unsafe code"
)]

mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use ademan_text::correction::Restored;
use ademan_text::{Corrector, Decoder, Mode, Model, Options, Prior, Tap, TouchModel};
use support::simulated::{Person, TIERS, keyboard};
use support::swipes::Swiper;

/// Creates a decoder of English for a person who is not known.
fn decoder() -> Decoder<'static> {
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let touch = TouchModel::new(Prior::default());
    Decoder::new(model, keyboard(), touch, Options::default())
}

/// The system allocator with a counter for each thread.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: Every call goes to the system allocator with the same arguments.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: The caller upholds the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: The caller upholds the contract of `realloc`.
        unsafe { System.realloc(block, layout, size) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: The caller upholds the contract of `dealloc`.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn taps_corrections_and_commits_do_not_allocate() {
    let mut corrector = Corrector::new(decoder(), Mode::Auto, Restored::default());
    // The worst tier, so that the beam is full and errors are many.
    let mut person = Person::new(TIERS[4], 1);
    let text = "the quick brown fox jumps over the lazy dog, and it is not what you think. ";
    let taps = person.types(&text.repeat(20)).taps;

    let before = ALLOCATIONS.get();
    let mut edits = 0;
    for (index, &tap) in taps.iter().enumerate() {
        edits += corrector.press(tap).len();
        edits += corrector.candidates().len();
        if index % 50 == 0 {
            edits += corrector.backspace().len();
        }
    }
    let allocated = ALLOCATIONS.get() - before;

    assert!(edits > taps.len());
    assert!(corrector.restored().words().len() > 0, "a word is learned");
    assert_eq!(allocated, 0);
}

#[test]
fn learning_and_forgetting_words_do_not_allocate() {
    let mut random = fastrand::Rng::with_seed(3);
    let words: Vec<String> = (0..300)
        .map(|_| (0..9).map(|_| random.lowercase()).collect())
        .collect();
    let mut restored = Restored::default();
    words[..100].iter().for_each(|word| restored.add(word));
    let mut corrector = Corrector::new(decoder(), Mode::Auto, restored);
    let keyboard = keyboard();
    let taps: Vec<Tap> = words[100..]
        .iter()
        .flat_map(|word| format!("{word} ").repeat(3).chars().collect::<Vec<_>>())
        .map(|typed| {
            let key = keyboard.keys()[keyboard.index(typed).expect("a key")];
            Tap {
                position: key.center,
                typed: Some(typed),
            }
        })
        .collect();

    let before = ALLOCATIONS.get();
    for &tap in &taps {
        corrector.press(tap);
    }
    let learned = corrector.restored().words().len();
    corrector.forget();
    let allocated = ALLOCATIONS.get() - before;

    assert!(learned > 200, "{learned}");
    assert_eq!(corrector.restored().words().len(), 0);
    assert_eq!(allocated, 0);
}

#[test]
fn decoding_does_not_allocate_at_all() {
    let mut decoder = decoder();
    let mut person = Person::new(TIERS[3], 2);
    let text = "the quick brown fox jumps over the lazy dog and it is not what you think ";
    // More than fits between two commits, and than the block of characters holds.
    let taps = person.types(&text.repeat(20)).taps;

    let before = ALLOCATIONS.get();
    let mut length = 0;
    for &tap in &taps {
        decoder.tap(tap);
        length += decoder.best().len();
    }
    decoder.untap();
    decoder.commit();
    let allocated = ALLOCATIONS.get() - before;

    assert!(length > taps.len());
    assert_eq!(
        allocated,
        0,
        "{allocated} allocations for {} taps",
        taps.len()
    );
}

#[test]
fn swipes_do_not_allocate() {
    let decoder = decoder().with_swipes();
    let mut corrector = Corrector::new(decoder, Mode::Auto, Restored::default());
    let mut person = Swiper::new(8.0, 3);
    let words = [
        "quick",
        "brown",
        "over",
        "internationalization",
        "the",
        "thinking",
    ];
    let paths: Vec<_> = words
        .iter()
        .filter_map(|word| person.swipes(word))
        .collect();
    assert_eq!(paths.len(), words.len());

    let before = ALLOCATIONS.get();
    let mut edits = 0;
    for path in &paths {
        let [x, y] = path.points()[0];
        edits += corrector.press(Tap::at(x, y)).len();
        edits += corrector.swipe(path.points()).len();
        edits += corrector.candidates().len();
        edits += corrector.accept(1).len();
    }
    edits += corrector.backspace().len();
    let allocated = ALLOCATIONS.get() - before;

    assert!(edits > 5 * words.len());
    assert_eq!(allocated, 0);
}
