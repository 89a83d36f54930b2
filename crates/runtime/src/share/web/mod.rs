//! WebSockets, and the pages of the viewer.

mod folder;
mod frame_limit;
mod head;
mod pages;
mod request;
mod socket;

pub use folder::{PageFolder, PageFolderError};
pub(super) use head::{Answer, Head, Pages};
#[cfg(feature = "tls")]
pub(crate) use request::{forbid, no_such_page, parse_request, upgrade};
pub(super) use socket::SocketReader;
