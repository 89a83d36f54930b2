//! WebSockets, and the pages of the viewer.

mod folder;
mod frame_limit;
mod head;
mod pages;
mod socket;

pub use folder::{PageFolder, PageFolderError};
pub(super) use head::{Answer, Head, Pages};
pub(super) use socket::SocketReader;
