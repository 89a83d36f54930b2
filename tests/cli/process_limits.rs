//! Limits of the operating system on processes and priorities.

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, chown};
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

use serde_json::Value;
use tempfile::TempDir;

use crate::support::binary::copy_binary;
use crate::support::run::shipped;
use crate::{Ended, ademan, run_to_end};

/// Number of users that this process has made up.
static USERS: AtomicU32 = AtomicU32::new(0);

/// A user without other processes, and a folder in which this user may write.
struct User {
    id: u32,
    folder: TempDir,
}

impl User {
    /// Returns `None` if this process cannot start others as another user, or the tools for it are missing.
    fn new() -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        // Other users may have no access to the build directory.
        let program = folder.path().join("ademan");
        copy_binary(&program);
        fs::set_permissions(folder.path(), Permissions::from_mode(0o777)).expect("an own folder");
        // The limit counts all processes of a user: one that no other test has.
        let id = 100_000 + 16 * std::process::id() + USERS.fetch_add(1, Ordering::Relaxed);
        let user = Self { id, folder };
        match user
            .command(&["prlimit", "--nproc=100", "setpriv"], ["--version"])
            .output()
        {
            Ok(output) if output.status.success() => Some(user),
            output => {
                println!("SKIPPED: no program as another user with a limit: {output:?}");
                None
            }
        }
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Writes the layout `qwerty-flat` to `own/my.ron`, which only this user may change.
    fn write_layout(&self) {
        let own = self.path().join("own");
        fs::create_dir(&own).expect("an own folder");
        fs::write(own.join("my.ron"), shipped("qwerty-flat")).expect("a file");
        for (path, mode) in [(own.join("my.ron"), 0o644), (own, 0o755)] {
            fs::set_permissions(&path, Permissions::from_mode(mode)).expect("an own path");
            chown(&path, Some(self.id), None).expect("this process starts others as this user");
        }
    }

    /// Returns the program as this user, started by `wrapper`, whose last command is `setpriv`.
    fn command<'a>(
        &self,
        wrapper: &[&str],
        arguments: impl IntoIterator<Item = &'a str>,
    ) -> Command {
        let mut command = ademan([""; 0]);
        let environment: Vec<_> = command
            .get_envs()
            .map(|(name, _)| name.to_owned())
            .collect();
        command = Command::new(wrapper[0]);
        command
            .args(&wrapper[1..])
            .arg("--clear-groups")
            .args([
                format!("--reuid={}", self.id),
                format!("--regid={}", self.id),
            ])
            .arg(self.path().join("ademan"))
            .args(arguments)
            .current_dir(self.path());
        for name in environment {
            command.env_remove(name);
        }
        command
    }

    /// Runs the program, which may have this many processes and threads.
    fn run_with(&self, processes: u32, arguments: &[&str]) -> Ended {
        let limit = format!("--nproc={processes}");
        let wrapper = ["prlimit", &limit, "setpriv"];
        run_to_end(&mut self.command(&wrapper, arguments.iter().copied()))
    }
}

#[test]
fn a_program_that_may_start_few_threads_ends_with_a_remedy_and_not_with_a_panic() {
    let Some(user) = User::new() else {
        return;
    };
    user.write_layout();
    let commands: [&[&str]; 5] = [
        &["run", "--source", "typist:hi", "--control", "c.sock"],
        // The file is watched.
        &["run", "--source", "typist:hi", "--layout", "own/my.ron"],
        &["run", "--source", "typist:hi", "--record", "run.mcap"],
        &["record", "hand.mcap", "--source", "typist:hi"],
        &["demo", "--text", "hi"],
    ];
    for command in commands {
        let needed = (2..40).find(|limit| {
            // A session that cannot start all its threads may have created its recording.
            for recording in ["run.mcap", "hand.mcap"] {
                let _ = fs::remove_file(user.path().join(recording));
            }
            let ended = user.run_with(*limit, command);
            let err = &ended.err;
            assert!(!err.contains("panicked"), "{command:?}, {limit}: {err}");
            if ended.code != Some(0) {
                assert!(err.contains("ulimit -u"), "{command:?}, {limit}: {err}");
            }
            ended.code == Some(0)
        });
        println!("{command:?} needs {needed:?} threads");
        assert!(needed.is_some_and(|needed| needed > 2), "{needed:?}");
    }
}

#[test]
fn the_lab_works_on_the_threads_that_the_system_permits() {
    let Some(user) = User::new() else {
        return;
    };
    let score = "lab score qwerty-flat --people 6 --count 1 --jobs 6";
    let arguments: Vec<&str> = score.split(' ').collect();
    let all = user.run_with(100, &arguments).done();
    // The program itself and its thread for signals, without and with one more.
    for limit in [2, 3] {
        let ended = user.run_with(limit, &arguments);
        assert_eq!(ended.code, Some(0), "{limit}: {}", ended.err);
        assert!(!ended.err.contains("panicked"), "{limit}: {}", ended.err);
        assert_eq!(ended.out, all.out, "{limit}");
    }
}

#[test]
fn the_doctor_reports_the_priority_that_the_system_permits() {
    let Some(user) = User::new() else {
        return;
    };
    let check = |wrapper: &[&str]| -> Option<Value> {
        let output = user.command(wrapper, ["doctor", "--json"]).output();
        let report: Value = serde_json::from_slice(&output.expect("it starts").stdout).ok()?;
        let checks = report["checks"].as_array().expect("a list").clone();
        let mut checks = checks.into_iter();
        checks.find(|check| check["check"] == "priority")
    };
    let denied = check(&["setpriv"]).expect("the check exists");
    assert_eq!(denied["status"], "missing", "{denied}");
    let command = denied["commands"][0].as_str().expect("a command");
    assert!(command.contains("limits.d"), "{command}");
    let capability = [
        "setpriv",
        "--inh-caps=+sys_nice",
        "--ambient-caps=+sys_nice",
    ];
    // The limit is the distance from 20.
    let wrappers: [(&[&str], &str); 2] = [
        (&capability, "nice -20"),
        (&["prlimit", "--nice=31:31", "setpriv"], "nice -11"),
    ];
    for (wrapper, nice) in wrappers {
        let Some(granted) = check(wrapper) else {
            println!("SKIPPED: this user may not grant a priority with {wrapper:?}");
            continue;
        };
        assert_eq!(granted["status"], "ok", "{granted}");
        let text = granted["text"].as_str().expect("a text");
        assert!(text.ends_with(nice), "{text}");
    }
}
