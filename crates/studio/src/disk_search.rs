//! Searches of the disk that do not stop the window.

use std::thread;

use crossbeam_channel::{Receiver, bounded};

/// A search on a thread of its own, as a disk or a share may not answer.
pub struct DiskSearch<T> {
    found: T,
    result: Receiver<T>,
}

impl<T: Default + Send + 'static> DiskSearch<T> {
    /// Starts the thread `name`, which calls `find`, and `notify` at the end.
    pub fn start(
        name: &str,
        find: impl FnOnce() -> T + Send + 'static,
        notify: impl FnOnce() + Send + 'static,
    ) -> Self {
        let (sender, result) = bounded(1);
        let search = move || {
            // The window may be closed.
            let _ = sender.send(find());
            notify();
        };
        // Without a thread nothing is offered; a file can be named.
        let _ = thread::Builder::new().name(name.into()).spawn(search);
        Self {
            found: T::default(),
            result,
        }
    }

    /// Receives what was found since the last call. Does not wait.
    pub fn update(&mut self) {
        if let Ok(found) = self.result.try_recv() {
            self.found = found;
        }
    }

    /// Returns what was found; the default until then.
    pub fn found(&self) -> &T {
        &self.found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_that_does_not_answer_stops_no_caller() {
        let (answer, disk) = bounded::<&str>(0);
        let (notify, notified) = bounded(1);
        let find = move || disk.recv().map(|found| vec![found]).unwrap_or_default();
        let mut search = DiskSearch::start("search", find, move || {
            let _ = notify.send(thread::current().name().map(str::to_owned));
        });
        search.update();
        assert_eq!(search.found().as_slice(), [""; 0]);
        answer.send("here").expect("the thread waits for it");
        let thread = notified.recv_timeout(std::time::Duration::from_secs(60));
        let thread = thread.expect("the end of the search");
        assert_eq!(thread.as_deref(), Some("search"));
        search.update();
        assert_eq!(search.found().as_slice(), ["here"]);
        search.update();
        assert_eq!(search.found().as_slice(), ["here"], "it is kept");
    }
}
