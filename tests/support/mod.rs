//! What several test programs share.

pub mod x11;
