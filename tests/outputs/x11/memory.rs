//! The out-of-memory killer ends the program while a key is pressed.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use ademan::files::Load;
use ademan::layout::Layout;

use super::ends::held_keys;
use super::{hold, wait_for_release};
use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::program::Program;
use crate::support::x11::XServer;

/// A control group with a memory limit.
struct ControlGroup(PathBuf);

impl ControlGroup {
    /// Creates a control group. Returns `None` with a message if that is not possible.
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
        println!("SKIPPED: cannot create a control group with a limit");
        None
    }

    fn add(&self, process: u32) {
        fs::write(self.0.join("cgroup.procs"), process.to_string())
            .expect("the group accepts a process");
    }
}

impl Drop for ControlGroup {
    fn drop(&mut self) {
        let _ = fs::remove_dir(&self.0);
    }
}

#[test]
fn all_keys_are_released_after_the_out_of_memory_killer() {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(group) = ControlGroup::with_limit(64 << 10) else {
        return;
    };
    let press = Press::for_text("H");
    let (folder, glove, source) = Glove::in_new_folder(press.clear());
    let file = folder.path().join("my.ron");
    let text = Layout::load("qwerty-flat").expect("a shipped layout").text;
    fs::write(&file, &text).expect("space on the disk");
    let layout = file.to_str().expect("a plain path");
    let arguments = [
        "run", "--output", "desktop", "--source", &source, "--layout", layout,
    ];
    let mut program = Program::start(&server, arguments);
    program.wait_for_line("armed", 1);
    hold(&server, &program, &glove, &press, &held_keys());

    group.add(program.id());
    // Reading this file exceeds the limit.
    fs::write(&file, format!("/*{}*/{text}", "-".repeat(900_000))).expect("space on the disk");
    assert_eq!(program.wait_for_exit().code(), None, "killed by a signal");
    wait_for_release(&server, Instant::now(), "out of memory");
    program.wait_for_line("released its keys (2)", 1);
}
