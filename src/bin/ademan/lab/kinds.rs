//! Kinds of layouts: layouts that type the phrases, and layouts that are scored by tasks.

use ademan::document::Document;
use ademan::measures::NotComparable;
use ademan::message::escape;
use ademan::trials::Station;

use super::conditions::Prepared;
use super::not_comparable;
use crate::failure::Failure;

/// Refuses layouts of both kinds, which cannot be compared, and a layout that types nothing of a text of the user, before anybody uses
/// them.
pub fn check(prepared: &Prepared, layouts: &[Document]) -> Result<(), Failure> {
    let (mut typing, mut other) = (None, None);
    for layout in layouts {
        match types(prepared, layout) {
            Some(true) => typing = typing.or(Some(layout)),
            Some(false) => other = other.or(Some(layout)),
            None => {}
        }
    }
    let Some(other) = other else { return Ok(()) };
    if let Some(typing) = typing {
        return Err(not_comparable(&NotComparable::Kinds {
            typing: typing.file.clone(),
            other: other.file.clone(),
        }));
    }
    if prepared.has_own_text() {
        return Err(Failure::wrong_use(format!(
            "{} types no letter and no digit of {}; choose another text, or leave out --text to score the layout by tasks",
            escape(&other.file),
            escape(&prepared.corpus.name)
        )));
    }
    Ok(())
}

/// Returns `true` if the first person types on a layout, `false` if no key of it types a letter or a digit of the phrases, and `None`
/// if it depends on the people.
fn types(prepared: &Prepared, layout: &Document) -> Option<bool> {
    let person = prepared.participants.first()?;
    // The score reports an error.
    let mut station = Station::new(layout, person, prepared.source).ok()?;
    if let Some(decoder) = &prepared.decoder
        && !decoder.with(|decoding| station.set_decoder(decoding.decoder))
    {
        return None;
    }
    let phrases = prepared.corpus.phrases.iter();
    let strokes = station.strokes_for(phrases.map(String::as_str));
    if strokes.can_type() {
        Some(true)
    } else if strokes.unreached.is_empty() {
        Some(false)
    } else {
        None
    }
}
