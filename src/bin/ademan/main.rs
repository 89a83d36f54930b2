//! The `ademan` command.

fn main() {}
