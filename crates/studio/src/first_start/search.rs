//! The search for sources: what the serial ports send, and cameras.

use std::thread;

use crossbeam_channel::{Receiver, unbounded};

use ademan_runtime::capture::SourceUri;
use ademan_runtime::capture::cameras::{Camera, cameras};
use ademan_runtime::capture::recognition::{Recognition, port_names, recognize};

/// A serial port, and what was heard there. `None` while it is listened to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Its path or name.
    pub name: String,
    /// The source that it looks like, or the reason why it cannot be listened to.
    pub heard: Option<Result<Recognition, String>>,
}

/// The ports and cameras of this machine. Each port is listened to for a few seconds, on a thread of its own.
pub struct Search {
    ports: Vec<Port>,
    cameras: Vec<Camera>,
    heard: Receiver<(usize, Result<Recognition, String>)>,
}

impl Search {
    /// Starts to listen to all serial ports of this machine.
    pub fn of_this_machine() -> Self {
        Self::new(port_names(), cameras())
    }

    /// Starts to listen to these serial ports. `cameras` are connected.
    pub fn new(ports: Vec<String>, cameras: Vec<Camera>) -> Self {
        let (sender, heard) = unbounded();
        let start = |(index, name): (usize, String)| {
            let (sender, port) = (sender.clone(), name.clone());
            let thread = thread::Builder::new().name("listen".into());
            let listened = thread.spawn(move || {
                // Nobody waits for it once the window is closed.
                let _ = sender.send((index, recognize(&port)));
            });
            let refusal = listened.err().map(|error| Err(error.to_string()));
            Port {
                name,
                heard: refusal,
            }
        };
        Self {
            ports: ports.into_iter().enumerate().map(start).collect(),
            cameras,
            heard,
        }
    }

    /// Receives what was heard since the last call. Does not wait.
    pub fn update(&mut self) {
        for (index, heard) in self.heard.try_iter() {
            self.ports[index].heard = Some(heard);
        }
    }

    /// Returns the ports.
    pub fn ports(&self) -> &[Port] {
        &self.ports
    }

    /// Returns the cameras.
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// Returns `true` if a port is still listened to.
    pub fn is_listening(&self) -> bool {
        self.ports.iter().any(|port| port.heard.is_none())
    }

    /// Returns the sources that were recognized, in the order of the ports.
    pub fn sources(&self) -> impl Iterator<Item = &SourceUri> {
        let heard = self.ports.iter().filter_map(|port| port.heard.as_ref());
        heard.flat_map(|heard| match heard {
            Ok(Recognition::Sources(sources)) => sources.as_slice(),
            _ => &[],
        })
    }
}
