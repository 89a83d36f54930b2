//! Faults around a session: clients, disks, files, serial lines.

mod clients;
mod disks;
mod files;
mod line;
mod lines;
