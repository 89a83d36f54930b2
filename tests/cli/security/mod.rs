//! Requirements of SECURITY.md that the program itself has to meet.

mod files;
mod recordings;
mod replays;
mod sockets;
mod strangers;
