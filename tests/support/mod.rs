//! What several test programs share.

// Each of them uses a part of it.
#![allow(dead_code)]

pub mod binary;
pub mod process;
pub mod proof;
pub mod run;
pub mod x11;
