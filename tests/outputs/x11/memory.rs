//! The system kills it for want of memory while a key is held.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use ademan::layout::Layout;

use super::ends::held_keys;
use super::{hold, wait_for_release};
use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::program::Program;
use crate::support::x11::XServer;

/// A group of processes that may have no more memory than a limit.
struct Group(PathBuf);

impl Group {
    /// Makes one; `None`, and says why, where that cannot be.
    fn with_limit(bytes: u64) -> Option<Self> {
        let name = format!("ademan-test-{}", std::process::id());
        for (root, limit) in [
            ("/sys/fs/cgroup/memory", "memory.limit_in_bytes"),
            ("/sys/fs/cgroup", "memory.max"),
        ] {
            let folder = Path::new(root).join(&name);
            if fs::create_dir(&folder).is_err() {
                continue;
            }
            let group = Self(folder);
            if fs::write(group.0.join(limit), bytes.to_string()).is_ok() {
                return Some(group);
            }
        }
        println!("SKIPPED: no group of processes can be given a limit here");
        None
    }

    fn take(&self, process: u32) {
        fs::write(self.0.join("cgroup.procs"), process.to_string()).expect("it takes a process");
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        let _ = fs::remove_dir(&self.0);
    }
}

#[test]
fn nothing_is_down_after_it_was_killed_for_want_of_memory() {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(group) = Group::with_limit(64 << 10) else {
        return;
    };
    let press = Press::for_text("H");
    let folder = tempfile::tempdir().expect("a folder");
    let (port, file) = (folder.path().join("glove"), folder.path().join("my.ron"));
    let text = Layout::load("qwerty-flat").expect("it is shipped").text;
    fs::write(&file, &text).expect("room");
    let glove = Glove::plug_in(&port, press.clear());
    let source = format!("serial:{}", port.display());
    let layout = file.to_str().expect("a plain path");
    let arguments = [
        "run", "--output", "desktop", "--source", &source, "--layout", layout,
    ];
    let mut program = Program::start(&server, arguments);
    program.wait_for_line("armed", 1);
    hold(&server, &glove, &press, &held_keys());

    group.take(program.id());
    // A file that takes memory to be read.
    fs::write(&file, format!("/*{}*/{text}", "-".repeat(900_000))).expect("room");
    assert_eq!(program.wait_for_exit().code(), None, "it was killed");
    wait_for_release(&server, Instant::now(), "out of memory");
    program.wait_for_line("released its keys (2)", 1);
}
