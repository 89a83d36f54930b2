//! The program opens no network socket.

use std::collections::BTreeSet;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

use crate::support::binary::ademan;
use crate::support::process::Process;

/// A 6-DoF mouse with one axis.
const LEVER: &str = "Layout(name: \"lever\", boards: [(pose: (anchor: elbow, forward_mm: 320), \
     levers: [(name: \"Lift\", at_mm: (0, 0), length_mm: 70, springs_back: true, output: Axis(\"MoveZ\"))])])";

/// Returns the inodes of the open sockets of a process.
fn sockets_of(process: u32) -> BTreeSet<String> {
    let open = fs::read_dir(format!("/proc/{process}/fd")).expect("it runs");
    let link = |entry: fs::DirEntry| fs::read_link(entry.path()).ok();
    open.flatten()
        .filter_map(link)
        .filter_map(|target| {
            let target = target.to_string_lossy().into_owned();
            let inode = target.strip_prefix("socket:[")?.strip_suffix(']')?;
            Some(inode.to_owned())
        })
        .collect()
}

/// Returns all sockets of a kind: inode and local address.
fn kernel_sockets(kind: &str) -> Vec<(String, String)> {
    let table = fs::read_to_string(format!("/proc/net/{kind}")).unwrap_or_default();
    let rows = table.lines().skip(1);
    rows.filter_map(|row| {
        let words: Vec<&str> = row.split_whitespace().collect();
        Some(((*words.get(9)?).to_owned(), (*words.get(1)?).to_owned()))
    })
    .collect()
}

#[test]
fn a_session_with_all_features_opens_no_network_socket() {
    let folder = tempfile::tempdir().expect("a folder");
    let control = folder.path().join("control");
    let spacenav = format!("spacenav:{}", folder.path().join("spnav").display());
    let layout = folder.path().join("lever.ron");
    fs::write(&layout, LEVER).expect("room on the disk");
    let mut command = ademan(["run", "--source", "script:wait 60000"]);
    command
        .arg("--layout")
        .arg(&layout)
        .args(["--output", &format!("{spacenav},transcript")])
        .arg("--control")
        .arg(&control)
        .env_remove("XDG_RUNTIME_DIR")
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let mut program = Process::start(&mut command).expect("it starts");
    let mut stderr = BufReader::new(program.0.stderr.take().expect("it is piped"));
    let start = std::time::Instant::now();
    while !(control.exists() && folder.path().join("spnav").exists()) {
        assert!(start.elapsed().as_secs() < 30, "no sockets appear");
        if program.0.try_wait().expect("a child").is_some() {
            let mut line = String::new();
            let _ = stderr.read_line(&mut line);
            panic!("the program ended: {line}");
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let sockets = sockets_of(program.0.id());
    assert!(!sockets.is_empty(), "the control socket is one of them");
    for kind in ["tcp", "tcp6", "udp", "udp6", "raw", "raw6"] {
        let of_run: Vec<_> = kernel_sockets(kind)
            .into_iter()
            .filter(|(inode, _)| sockets.contains(inode))
            .collect();
        assert!(of_run.is_empty(), "{kind}: {of_run:?}");
    }
}

#[test]
fn the_test_detects_network_sockets() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a free port");
    let sockets = sockets_of(std::process::id());
    let found = kernel_sockets("tcp")
        .into_iter()
        .any(|(inode, _)| sockets.contains(&inode));
    assert!(found, "{listener:?}");
}
