//! The boundary to JavaScript of the text decoder, as [`abi`](crate::abi) for the page.

#![allow(unsafe_code, reason = "a name that is not mangled is unsafe")]

use ademan_text::filter::Language;

use crate::abi::{take_input, tell_session, with_session};

/// Uses a text decoder with the bytes of a language model, which are kept. Returns an empty text, or the error.
#[unsafe(no_mangle)]
pub extern "C" fn page_use_language(length: usize) -> usize {
    let bytes = take_input(length);
    with_session(0, |session, _| {
        let language = match Language::from_bytes("of the page", bytes) {
            Ok(language) => language,
            Err(error) => return error,
        };
        session.use_decoder(Box::new(move |layout, mode| {
            language.filter(layout, mode, false, true)
        }));
        String::new()
    })
}

/// Changes what the decoder changes: `literal`, `suggest` or `auto`. Another text changes nothing.
#[unsafe(no_mangle)]
pub extern "C" fn page_set_text_mode(length: usize) {
    with_session(length, |session, text| {
        if let Ok(mode) = text.parse() {
            session.set_text_mode(mode);
        }
        String::new()
    });
}

/// Replaces the word that is being typed by a candidate, counted from 1.
#[unsafe(no_mangle)]
pub extern "C" fn page_choose(number: u8) {
    tell_session(|session| session.choose(number));
}
