//! The headsets that are connected to a source, for displays.

use std::fmt;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};

use ademan_core::message::escape;

/// Longest name of a headset, in characters before they are escaped.
const MAX_NAME: usize = 40;

/// The name of a headset that states none.
const UNNAMED: &str = "unnamed";

/// A headset that has shown a valid token.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Headset {
    /// The name that its page states: short, and without characters that act on a terminal.
    pub name: String,
    /// The address that it has connected from.
    pub address: IpAddr,
}

impl Headset {
    /// Creates a headset. `name` is shortened and escaped.
    pub fn new(name: &str, address: IpAddr) -> Self {
        let short: String = name.chars().take(MAX_NAME).collect();
        let shown = match short.trim() {
            "" => UNNAMED.to_owned(),
            own => escape(own).into_owned(),
        };
        Self {
            name: shown,
            address,
        }
    }
}

/// The state of a source that waits for headsets.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct HeadsetStatus {
    /// The headset that is connected; `None` if none is.
    pub connected: Option<Headset>,
}

impl fmt::Display for HeadsetStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.connected {
            // A name from the control socket of another session is escaped once more, which changes no other one.
            Some(Headset { name, address }) => write!(f, "headset {} at {address}", escape(name)),
            None => write!(f, "no headset connected"),
        }
    }
}

/// A function that receives the present state, and then each change. It must not block.
type Observer = Box<dyn Fn(HeadsetStatus) + Send>;

/// The headsets that are connected to a source. Clones belong to the same source. Locked for a moment only, and never by the
/// thread that reads the source.
#[derive(Clone, Default)]
pub struct HeadsetList(Arc<Mutex<Connections>>);

#[derive(Default)]
struct Connections {
    /// The id of the latest headset.
    latest: u64,
    /// The oldest first.
    connected: Vec<(u64, Headset)>,
    observer: Option<Observer>,
}

impl HeadsetList {
    /// Adds a headset, until the guard is dropped.
    #[must_use]
    pub fn add(&self, headset: Headset) -> ConnectedHeadset {
        let mut connections = self.lock();
        connections.latest += 1;
        let id = connections.latest;
        connections.connected.push((id, headset));
        connections.report();
        let list = self.clone();
        ConnectedHeadset { list, id }
    }

    /// Calls `observer` now and at each change, in place of an earlier one.
    pub fn observe(&self, observer: impl Fn(HeadsetStatus) + Send + 'static) {
        let mut connections = self.lock();
        connections.observer = Some(Box::new(observer));
        connections.report();
    }

    fn lock(&self) -> MutexGuard<'_, Connections> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Connections {
    /// Passes the state to the observer. Several headsets may be connected until the hands of one are read, which ends the
    /// connections of the others. The state shows the latest one, which a person has just started.
    fn report(&self) {
        let latest = self.connected.last();
        if let Some(observer) = &self.observer {
            observer(HeadsetStatus {
                connected: latest.map(|(_, headset)| headset.clone()),
            });
        }
    }
}

/// The presence of a headset in a list.
pub struct ConnectedHeadset {
    list: HeadsetList,
    id: u64,
}

impl Drop for ConnectedHeadset {
    fn drop(&mut self) {
        let mut connections = self.list.lock();
        connections.connected.retain(|(id, _)| *id != self.id);
        connections.report();
    }
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use crossbeam_channel::unbounded;

    use super::*;

    fn headset(name: &str) -> Headset {
        Headset::new(name, Ipv4Addr::new(192, 168, 1, 9).into())
    }

    #[test]
    fn a_name_is_short_and_starts_no_line() {
        let name = |name: &str| headset(name).name;
        assert_eq!(name("Quest 3"), "Quest 3");
        assert_eq!(name("  "), UNNAMED);
        assert_eq!(name(&"a".repeat(1000)), "a".repeat(MAX_NAME));
        for foreign in ["a\nb", "\u{1b}[2J", "\u{202e}abc"] {
            let shown = name(foreign);
            assert!(!shown.contains(['\n', '\u{1b}', '\u{202e}']), "{shown:?}");
        }
    }

    #[test]
    fn an_observer_sees_the_latest_headset_that_is_connected() {
        let list = HeadsetList::default();
        let first = list.add(headset("Quest 3"));
        let (sender, states) = unbounded();
        list.observe(move |status| _ = sender.send(status.to_string()));
        let second = list.add(headset("Pico 4"));
        drop(second);
        drop(first);
        let states: Vec<String> = states.try_iter().collect();
        assert_eq!(
            states,
            [
                "headset Quest 3 at 192.168.1.9",
                "headset Pico 4 at 192.168.1.9",
                "headset Quest 3 at 192.168.1.9",
                "no headset connected"
            ]
        );
    }

    #[test]
    fn a_name_of_another_session_acts_on_no_terminal() {
        let foreign = r#"{"connected":{"name":"\u001b[2J","address":"10.0.0.2"}}"#;
        let status: HeadsetStatus = serde_json::from_str(foreign).expect("a state");
        assert_eq!(status.to_string(), r"headset \u{1b}[2J at 10.0.0.2");
    }
}
