//! Faults around a session: clients, disks, files, serial lines.

mod blocked_streams;
mod clients;
mod disks;
mod files;
mod forged_messages;
mod line;
mod lines;
mod message_floods;
mod names;
