//! The boundary to JavaScript.

use ademan_web::{abi, abi_score};

#[test]
fn an_input_beyond_its_limit_has_no_buffer_that_the_page_could_write_behind() {
    assert!(!abi::page_input(16 << 20).is_null());
    assert!(abi::page_input((16 << 20) + 1).is_null());
    assert!(!abi_score::score_input(2 << 20).is_null());
    assert!(abi_score::score_input((2 << 20) + 1).is_null());
}

#[test]
fn a_time_that_is_no_number_moves_nothing_on() {
    for elapsed_ms in [f64::NAN, f64::NEG_INFINITY, -1.0] {
        assert_eq!(abi::page_advance(elapsed_ms), 0, "{elapsed_ms}");
    }
}
