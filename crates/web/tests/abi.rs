//! The boundary to JavaScript.

use ademan_web::{abi, abi_score};

#[test]
fn an_input_beyond_its_limit_has_no_buffer_that_the_page_could_write_behind() {
    assert!(!abi::page_input(16 << 20).is_null());
    assert!(abi::page_input((16 << 20) + 1).is_null());
    assert!(!abi_score::score_input(2 << 20).is_null());
    assert!(abi_score::score_input((2 << 20) + 1).is_null());
}
