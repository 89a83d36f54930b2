//! Menus and the palette of the editor in a window without a display, and what is added where it is not seen.

use super::tests::Window;
use super::*;

#[test]
fn a_layout_that_another_studio_edits_is_opened_with_a_message() {
    let window = Window::open();
    let work = window.path.with_file_name("work");
    let open = || {
        let name = window.path.to_str().expect("a readable path");
        EditorPanel::open(name, Fit::default(), Some(&work)).expect("a layout")
    };
    let first = open();
    assert_eq!(first.message, None);
    let second = open();
    assert_eq!(second.message, Some(Ok(text("editor-open-elsewhere"))));
}
