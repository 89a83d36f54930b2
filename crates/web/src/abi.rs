//! The boundary to JavaScript: functions that take numbers. Texts pass through one buffer for each direction, which the page
//! reads and writes in the memory of the module.
//!
//! A call that takes a text takes its length in the input buffer, which [`page_input`] has prepared. A call that returns a text
//! returns its length in the output buffer, at [`page_output`]. No call panics: an input that is not UTF-8 is an empty text.

// The names of exports: nothing here touches a pointer, and the page writes to a vector that it was given.
#![allow(unsafe_code, reason = "a name that is not mangled is unsafe")]

use std::cell::RefCell;
use std::time::Duration;

use ademan_core::contact::TargetId;
use ademan_core::document::Document;
use ademan_core::hand::Side;
use ademan_lab::sim::Pointed;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::plan::PlanEdit;
use crate::rehearsal::Rehearsal;
use crate::session::{PageSession, preview, shipped};

/// The largest text that a page passes, in bytes.
const MAX_INPUT_BYTES: usize = 16 << 20;

#[derive(Default)]
struct Page {
    session: Option<PageSession>,
    rehearsal: Option<Rehearsal>,
    input: Vec<u8>,
    output: Vec<u8>,
}

#[derive(Deserialize)]
struct EditRequest {
    targets: Vec<TargetId>,
    edit: PlanEdit,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

impl Page {
    fn text(&self, length: usize) -> &str {
        let bytes = self.input.get(..length).unwrap_or_default();
        std::str::from_utf8(bytes).unwrap_or_default()
    }

    fn put(&mut self, text: impl Into<String>) -> usize {
        self.output = text.into().into_bytes();
        self.output.len()
    }
}

/// Calls a function with the session and the input; its result is the output. Without a session, the output is empty.
pub(crate) fn with_session(
    length: usize,
    call: impl FnOnce(&mut PageSession, &str) -> String,
) -> usize {
    PAGE.with_borrow_mut(|page| {
        let text = page.text(length).to_owned();
        match &mut page.session {
            Some(session) => {
                let output = call(session, &text);
                page.put(output)
            }
            None => page.put(""),
        }
    })
}

/// Calls a function without output with the session, if there is one.
pub(crate) fn tell_session(call: impl FnOnce(&mut PageSession)) {
    PAGE.with_borrow_mut(|page| {
        if let Some(session) = &mut page.session {
            call(session);
        }
    });
}

/// Returns an object, or `{"error":"…"}`.
pub(crate) fn reply(result: Result<impl Serialize, String>) -> String {
    let object = match result {
        Ok(object) => json!(object),
        Err(error) => json!({ "error": error }),
    };
    object.to_string()
}

/// Splits an input into its first line and the bytes after it.
fn first_line(text: &str) -> (&str, &[u8]) {
    let (line, rest) = text.split_once('\n').unwrap_or((text, ""));
    (line, rest.as_bytes())
}

/// Returns the bytes of the input, and empties it.
#[cfg(any(feature = "recordings", feature = "words"))]
pub(crate) fn take_input(length: usize) -> Vec<u8> {
    let mut bytes = PAGE.with_borrow_mut(|page| std::mem::take(&mut page.input));
    bytes.truncate(length);
    bytes
}

/// Returns the address of an input buffer of this length; null, and no buffer, for more than 16 MiB.
#[unsafe(no_mangle)]
pub extern "C" fn page_input(length: usize) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.input.clear();
        if length > MAX_INPUT_BYTES {
            return std::ptr::null_mut();
        }
        page.input.resize(length, 0);
        page.input.as_mut_ptr()
    })
}

/// Returns the address of the output.
#[unsafe(no_mangle)]
pub extern "C" fn page_output() -> *const u8 {
    PAGE.with_borrow(|page| page.output.as_ptr())
}

/// Lists the layouts that come with the page, as a JSON list of names.
#[unsafe(no_mangle)]
pub extern "C" fn page_shipped() -> usize {
    PAGE.with_borrow_mut(|page| page.put(shipped()))
}

/// Returns the text of a file that comes with the page; an empty text if there is none with that name.
#[unsafe(no_mangle)]
pub extern "C" fn page_shipped_text(length: usize) -> usize {
    PAGE.with_borrow_mut(|page| {
        let document = Document::shipped(page.text(length));
        page.put(document.map(|it| it.text).unwrap_or_default())
    })
}

/// Returns what the gallery shows of a layout that comes with the page: `{"title":"…","description":"…","plan":[…]}`.
#[unsafe(no_mangle)]
pub extern "C" fn page_preview(length: usize) -> usize {
    PAGE.with_borrow_mut(|page| {
        let preview = preview(page.text(length));
        page.put(preview.unwrap_or_default())
    })
}

/// Uses the layout of a text. Returns lines.
#[unsafe(no_mangle)]
pub extern "C" fn page_set_layout(length: usize) -> usize {
    PAGE.with_borrow_mut(|page| {
        let text = page.text(length).to_owned();
        if let Some(session) = &mut page.session {
            let lines = session.set_layout(&text);
            return page.put(lines);
        }
        // A link may carry a layout with faults: the session begins with one that has none.
        let mut session = PageSession::new(&text);
        if session.is_err() {
            let valid = Document::shipped("qwerty-flat").map(|it| it.text);
            session = valid.and_then(|valid| PageSession::new(&valid));
        }
        match session {
            Ok(mut session) => {
                let mut lines = session.layout_lines();
                lines.push_str(&session.set_layout(&text));
                page.session = Some(session);
                page.put(lines)
            }
            Err(error) => {
                page.put(json!({"kind": "notice", "text": error.to_string()}).to_string())
            }
        }
    })
}

/// Makes a simulated person type a text. Returns a JSON list of faults.
#[unsafe(no_mangle)]
pub extern "C" fn page_type(length: usize) -> usize {
    with_session(length, |session, text| {
        json!(session.type_text(text)).to_string()
    })
}

/// Makes a simulated person play a script. Returns a JSON list of faults.
#[unsafe(no_mangle)]
pub extern "C" fn page_play(length: usize) -> usize {
    with_session(length, |session, text| {
        json!(session.play(text)).to_string()
    })
}

/// Uses a person file for the simulated person. Returns a JSON list of faults.
#[unsafe(no_mangle)]
pub extern "C" fn page_set_person(length: usize) -> usize {
    with_session(length, |session, text| {
        json!(session.set_person(text)).to_string()
    })
}

/// Points with the index finger at a front: a point and the normal in the world, in metres, and the travel.
#[unsafe(no_mangle)]
#[allow(
    clippy::too_many_arguments,
    reason = "numbers are all that the boundary passes"
)]
pub extern "C" fn page_point(
    is_left: bool,
    x: f32,
    y: f32,
    z: f32,
    normal_x: f32,
    normal_y: f32,
    normal_z: f32,
    travel: f32,
    is_down: bool,
) {
    let pointed = Pointed {
        point: Vec3::new(x, y, z),
        normal: Vec3::new(normal_x, normal_y, normal_z).normalize_or(Vec3::Y),
        travel,
        is_down,
    };
    let side = if is_left { Side::Left } else { Side::Right };
    if pointed.point.is_finite() && travel.is_finite() {
        tell_session(|session| session.point(side, pointed));
    }
}

/// Receives the name of a protocol, a line end, and bytes of it. Returns `{"readings":12}` or `{"error":"…"}`.
#[unsafe(no_mangle)]
pub extern "C" fn page_push(length: usize) -> usize {
    with_session(length, |session, text| {
        let (protocol, bytes) = first_line(text);
        let pushed = session.push(protocol, bytes);
        reply(pushed.map(|readings| json!({ "readings": readings })))
    })
}

/// Plays a file: the name of a protocol, a line end, and its bytes. Returns `{"readings":12}`, with the error in what was left out, or
/// `{"error":"…"}`.
#[unsafe(no_mangle)]
pub extern "C" fn page_play_file(length: usize) -> usize {
    with_session(length, |session, text| {
        let (protocol, bytes) = first_line(text);
        let played = session.play_file(protocol, bytes);
        reply(played.map(|(readings, refused)| json!({ "readings": readings, "refused": refused })))
    })
}

/// Receives a protocol with its options, such as `hand-landmarks?mirrored=yes`, a line end, and what a sensor measures now. Returns
/// `{"readings":2}`, with the error in a refused line, or `{"error":"…"}`.
#[unsafe(no_mangle)]
pub extern "C" fn page_push_live(length: usize) -> usize {
    with_session(length, |session, text| {
        let (format, bytes) = first_line(text);
        reply(session.push_live(format, bytes))
    })
}

/// Puts the boards under the hands that are held open and still next.
#[unsafe(no_mangle)]
pub extern "C" fn page_place_under_hands() {
    tell_session(PageSession::place_under_hands);
}

/// Receives `{"targets":[3],"edit":{"move":{"by_mm":[1,0]}}}`. Returns `{"text":"…"}` or `{"error":"…"}`.
#[unsafe(no_mangle)]
pub extern "C" fn page_edit(length: usize) -> usize {
    with_session(length, |session, text| {
        let request = serde_json::from_str::<EditRequest>(text).map_err(|error| error.to_string());
        let edited = request.and_then(|request| session.edit(&request.targets, request.edit));
        reply(edited.map(|new_text| json!({ "text": new_text })))
    })
}

/// Releases everything; the hands rest.
#[unsafe(no_mangle)]
pub extern "C" fn page_release() {
    tell_session(PageSession::release);
}

/// Empties the text field.
#[unsafe(no_mangle)]
pub extern "C" fn page_clear_text() {
    tell_session(PageSession::clear_text);
}

/// Prepares steps whose time the page measures with [`page_rehearse`].
#[unsafe(no_mangle)]
pub extern "C" fn page_prepare_rehearsal() {
    PAGE.with_borrow_mut(|page| {
        page.rehearsal = page.session.as_ref().map(PageSession::rehearsal);
    });
}

/// Makes the steps that are prepared. Returns their number.
#[unsafe(no_mangle)]
pub extern "C" fn page_rehearse() -> usize {
    PAGE.with_borrow_mut(|page| page.rehearsal.as_mut().map_or(0, Rehearsal::run))
}

/// Moves the hands on by a time in milliseconds; a number that is no time is none. Returns lines.
#[unsafe(no_mangle)]
pub extern "C" fn page_advance(elapsed_ms: f64) -> usize {
    let elapsed = Duration::try_from_secs_f64(elapsed_ms.clamp(0.0, 1e3) / 1e3).unwrap_or_default();
    with_session(0, |session, _| session.advance(elapsed))
}
