//! The boundary to JavaScript of the module that scores layouts, as [`abi`](crate::abi) for the page.

// The names of exports: nothing here touches a pointer, and the page writes to a vector that it was given.
#![allow(unsafe_code, reason = "a name that is not mangled is unsafe")]

use std::cell::RefCell;

use serde_json::json;

use crate::score::Scoring;

/// The largest layout, in bytes.
const MAX_INPUT_BYTES: usize = 2 << 20;

#[derive(Default)]
struct Scorer {
    scoring: Option<Scoring>,
    input: Vec<u8>,
    output: Vec<u8>,
}

thread_local! {
    static SCORER: RefCell<Scorer> = RefCell::default();
}

impl Scorer {
    fn put(&mut self, text: String) -> usize {
        self.output = text.into_bytes();
        self.output.len()
    }
}

/// Returns the address of an input buffer of this length; null, and no buffer, for more than 2 MiB.
#[unsafe(no_mangle)]
pub extern "C" fn score_input(length: usize) -> *mut u8 {
    SCORER.with_borrow_mut(|scorer| {
        scorer.input.clear();
        if length > MAX_INPUT_BYTES {
            return std::ptr::null_mut();
        }
        scorer.input.resize(length, 0);
        scorer.input.as_mut_ptr()
    })
}

/// Returns the address of the output.
#[unsafe(no_mangle)]
pub extern "C" fn score_output() -> *const u8 {
    SCORER.with_borrow(|scorer| scorer.output.as_ptr())
}

/// Begins with people who are to type on the layout in the input. Returns an error, or an empty text.
#[unsafe(no_mangle)]
pub extern "C" fn score_begin(people: u32, length: usize) -> usize {
    SCORER.with_borrow_mut(|scorer| {
        let layout = scorer.input.get(..length).unwrap_or_default();
        let layout = std::str::from_utf8(layout).unwrap_or_default();
        let error = match Scoring::new(layout, people) {
            Ok(scoring) => {
                scorer.scoring = Some(scoring);
                String::new()
            }
            Err(error) => error.to_string(),
        };
        scorer.put(error)
    })
}

/// Simulates the next person. Returns the score of the people so far, `{"error":"…"}`, or `null` after the last one.
#[unsafe(no_mangle)]
pub extern "C" fn score_next() -> usize {
    SCORER.with_borrow_mut(|scorer| {
        let score = scorer.scoring.as_mut().map_or(Ok(None), Scoring::advance);
        let score = match score {
            Ok(score) => json!(score),
            Err(error) => json!({ "error": error.to_string() }),
        };
        scorer.put(score.to_string())
    })
}
