//! Helpers that several test programs and benches share.

// Each of them uses a part of it.
#![allow(dead_code)]

pub mod binary;
pub mod body;
pub mod checked;
pub mod free_address;
pub mod full_pipe;
#[cfg(unix)]
pub mod glove;
pub mod hand;
#[cfg(target_os = "linux")]
pub mod home_made_glove;
pub mod key_log;
pub mod lucidgloves;
pub mod oracle;
#[cfg(target_os = "linux")]
pub mod output_pipe;
pub mod peers;
pub mod press;
pub mod process;
pub mod program;
pub mod python;
pub mod recording;
pub mod run;
pub mod source;
pub mod wearer;
pub mod x11;
