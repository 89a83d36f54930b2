//! The stand-in of a program without TLS: no server for a headset.

use std::convert::Infallible;
use std::net::SocketAddr;

use crossbeam_channel::Receiver;

use super::HeadsetPages;
use crate::capture::HeadsetList;
use crate::capture::transport::websocket::{ClientEvent, Clients, MessageServer};
use crate::network::NetworkError;

/// Never created.
pub(super) struct Server(Infallible);

impl Server {
    /// Returns the reason.
    pub fn start(_: SocketAddr, _: &HeadsetPages, _: HeadsetList) -> Result<Self, String> {
        Err(NetworkError::NoTls.to_string())
    }
}

impl MessageServer for Server {
    fn events(&self) -> &Receiver<ClientEvent> {
        match self.0 {}
    }

    fn clients(&self) -> &Clients {
        match self.0 {}
    }

    fn name(&self) -> String {
        match self.0 {}
    }
}
