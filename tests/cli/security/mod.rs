//! Requirements of SECURITY.md that the program itself has to meet.

mod replays;
mod sockets;
