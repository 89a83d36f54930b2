//! Wire formats: one decoder per file.

pub mod hc11;
mod restart_text;
