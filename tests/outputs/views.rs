//! The views of a run, from its control socket.

use std::path::Path;
use std::sync::{Arc, Mutex};
use std::thread;

use ademan::session::control_socket::Client;
use serde_json::Value;

use crate::support::x11::wait_for;

/// The active profile of a view, and the pressed keys in it.
type ProfileAndKeys = (String, Vec<String>);

/// All views since the start, from a thread of their own.
pub struct Views {
    views: Arc<Mutex<Vec<ProfileAndKeys>>>,
}

impl Views {
    /// Connects to the run whose control socket is at `path`.
    pub fn start(path: &Path) -> Self {
        let mut client = Client::connect(path).expect("the run listens");
        let views = Arc::new(Mutex::new(Vec::new()));
        let received = Arc::clone(&views);
        let response = client.request(r#"{"command":"watch"}"#);
        assert_eq!(response.expect("a response"), r#"{"ok":true}"#);
        thread::spawn(move || {
            while let Ok(Some(line)) = client.next_notification() {
                let line: Value = serde_json::from_str(&line).expect("JSON");
                if line["event"] == "view" {
                    let profile = line["profile"].as_str().expect("a name").to_owned();
                    let keys = line["keys"].as_array().into_iter().flatten();
                    let keys = keys.filter_map(Value::as_str).map(str::to_owned);
                    let view = (profile, keys.collect());
                    received.lock().expect("no panic").push(view);
                }
            }
        });
        Self { views }
    }

    /// Returns the views so far.
    pub fn all(&self) -> Vec<ProfileAndKeys> {
        self.views.lock().expect("no panic").clone()
    }

    /// Returns the profiles so far, each as often as it became active.
    pub fn profiles(&self) -> Vec<String> {
        let mut profiles: Vec<_> = self.all().into_iter().map(|(profile, _)| profile).collect();
        profiles.dedup();
        profiles
    }

    /// Waits until this profile is active.
    pub fn wait_for_profile(&self, name: &str) {
        let is_active = || self.profiles().last().is_some_and(|last| last == name);
        assert!(wait_for(is_active), "{name}: {:?}", self.profiles());
    }

    /// Returns `true` if the latest view has a pressed key.
    pub fn has_pressed_key(&self) -> bool {
        self.all().last().is_some_and(|(_, keys)| !keys.is_empty())
    }
}

/// Returns the response of the run to a request.
pub fn request(path: &Path, request: &str) -> Value {
    let response = Client::connect(path)
        .expect("the run listens")
        .request(request);
    serde_json::from_str(&response.expect("a response")).expect("JSON")
}
