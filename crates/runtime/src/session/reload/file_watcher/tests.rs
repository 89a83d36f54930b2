//! Tests with real files and real events.

use std::fs::{self, create_dir, remove_file, rename, write};
use std::os::unix::fs::symlink;
use std::path::Path;
use std::time::Duration;

use tempfile::TempDir;

use super::FileWatcher;
use super::watch_set::WatchSet;

/// Longest wait for an event on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Time after which an event is considered absent.
const SILENCE: Duration = Duration::from_millis(200);

/// A path and a change.
type Case = (&'static str, fn(&Path));

/// Creates `a.ron`, the links `link.ron` -> `far/b.ron` and `set.ron` -> `..data/c.ron`, and `..data` -> `one`.
fn directory() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    for name in ["far", "one", "two"] {
        create_dir(at(name)).unwrap();
    }
    for name in ["a.ron", "far/b.ron", "one/c.ron", "two/c.ron"] {
        write(at(name), name).unwrap();
    }
    symlink("far/b.ron", at("link.ron")).unwrap();
    symlink("..data/c.ron", at("set.ron")).unwrap();
    symlink("one", at("..data")).unwrap();
    directory
}

fn watcher(path: &Path) -> FileWatcher {
    FileWatcher::new(path.to_str().unwrap()).unwrap()
}

/// Returns `true` if a change is reported within `timeout`.
fn is_reported(name: &str, change: fn(&Path), timeout: Duration) -> bool {
    let directory = directory();
    let watcher = watcher(&directory.path().join(name));
    change(directory.path());
    watcher.changes().recv_timeout(timeout).is_ok()
}

#[test]
fn every_kind_of_change_is_reported() {
    let cases: [Case; 11] = [
        ("a.ron", |at| write(at.join("a.ron"), "new").unwrap()),
        ("a.ron", |at| remove_file(at.join("a.ron")).unwrap()),
        ("a.ron", |at| {
            rename(at.join("a.ron"), at.join("b")).unwrap();
        }),
        ("a.ron", |at| {
            rename(at.join("far/b.ron"), at.join("a.ron")).unwrap();
        }),
        ("none.ron", |at| write(at.join("none.ron"), "new").unwrap()),
        ("no/none.ron", |at| create_dir(at.join("no")).unwrap()),
        ("link.ron", |at| write(at.join("far/b.ron"), "new").unwrap()),
        ("link.ron", |at| {
            rename(at.join("a.ron"), at.join("far/b.ron")).unwrap();
        }),
        ("link.ron", |at| remove_file(at.join("link.ron")).unwrap()),
        ("set.ron", |at| {
            symlink("two", at.join("..new")).unwrap();
            rename(at.join("..new"), at.join("..data")).unwrap();
        }),
        ("far/b.ron", |at| {
            rename(at.join("far"), at.join("away")).unwrap();
        }),
    ];
    for (index, (name, change)) in cases.into_iter().enumerate() {
        assert!(is_reported(name, change, TIMEOUT), "{index}: {name}");
    }
}

#[test]
fn a_write_through_another_hard_link_is_reported() {
    let directory = directory();
    let path = directory.path().join("a.ron");
    let other = directory.path().join("far/a");
    fs::hard_link(&path, &other).unwrap();
    let watcher = watcher(&path);
    write(other, "new").unwrap();
    assert!(watcher.changes().recv_timeout(TIMEOUT).is_ok());
}

#[test]
fn reads_and_changes_of_other_files_are_not_reported() {
    let cases: [Case; 4] = [
        ("a.ron", |at| drop(fs::read(at.join("a.ron")).unwrap())),
        ("a.ron", |at| write(at.join("a.ron.swp"), "new").unwrap()),
        ("set.ron", |at| write(at.join("two/c.ron"), "new").unwrap()),
        ("far/b.ron", |at| write(at.join("a.ron"), "new").unwrap()),
    ];
    for (name, change) in cases {
        assert!(!is_reported(name, change, SILENCE), "{name}");
    }
}

#[test]
fn a_new_watcher_reports_only_later_changes() {
    let directory = directory();
    let path = directory.path().join("a.ron");
    for round in 0..3 {
        write(&path, format!("before {round}")).unwrap();
        let watcher = watcher(&path);
        assert!(watcher.changes().recv_timeout(SILENCE).is_err(), "{round}");
        write(&path, format!("after {round}")).unwrap();
        assert!(watcher.changes().recv_timeout(TIMEOUT).is_ok(), "{round}");
    }
}

#[test]
fn a_link_to_itself_is_resolved_to_an_end() {
    let directory = directory();
    let path = directory.path().join("loop.ron");
    symlink("loop.ron", &path).unwrap();
    assert_eq!(WatchSet::resolve(&path).file, None);
    watcher(&path);
}
