//! What goes wrong around a run: clients, disks, files, serial lines.

mod clients;
mod disks;
mod files;
mod line;
mod lines;
