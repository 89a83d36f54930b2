//! The boundary to JavaScript.

use ademan_web::{abi, abi_score};

#[test]
fn an_input_beyond_its_limit_has_no_buffer() {
    assert!(!abi::page_input(16 << 20).is_null());
    assert!(abi::page_input((16 << 20) + 1).is_null());
    assert!(!abi_score::score_input(2 << 20).is_null());
    assert!(abi_score::score_input((2 << 20) + 1).is_null());
}

#[test]
fn a_time_that_is_no_number_moves_nothing_on() {
    // An empty text has faults; the session begins with a layout that has none. A pointer moves its hand.
    assert!(abi::page_set_layout(0) > 0);
    abi::page_point(false, 0.0, 0.0, -0.3, 0.0, 1.0, 0.0, 0.0, false);
    let moved = abi::page_advance(100.0);
    let still = abi::page_advance(0.0);
    assert!(0 < still && still < moved, "{still} {moved}");
    for elapsed_ms in [f64::NAN, f64::NEG_INFINITY, -1.0] {
        assert_eq!(abi::page_advance(elapsed_ms), still, "{elapsed_ms}");
    }
}
