//! WebSockets, and the pages of the viewer.

mod frame_limit;
mod head;
mod pages;
mod socket;

pub(super) use head::{Answer, Head};
pub(super) use socket::SocketReader;
