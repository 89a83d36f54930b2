//! The page of `web/` from `ademan serve` in a headless Chromium, and layouts in links.

mod access;
mod completion;
mod files;
mod hand_picture;
mod headset;
#[cfg(feature = "tls")]
mod lan;
mod links;
mod page;
mod page_links;
mod score;
mod slow_clients;
mod update;
mod webcam;
mod words;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use tempfile::TempDir;

use crate::ademan;
use crate::browser::Browser;
use crate::support::process::Process;

/// Returns the folder of the page; `None` if it is not built.
fn folder() -> Option<PathBuf> {
    // The folder for temporary files is in the folder of the build.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../web");
    if folder.join("index.html").is_file() {
        return Some(folder);
    }
    println!("SKIPPED: the page is not built; web/build makes it");
    None
}

/// Returns a copy of the page, in which files may be changed.
fn copy_of(page: &Path) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for entry in fs::read_dir(page).expect("the page").flatten() {
        if entry.path().is_file() {
            fs::copy(entry.path(), folder.path().join(entry.file_name())).expect("a copy");
        }
    }
    folder
}

/// Serves the page. Returns the server, and the address of the page.
fn serve(folder: &Path) -> (Process, String) {
    serve_at(folder, "0")
}

/// Serves the page at a port; at any free one for 0.
fn serve_at(folder: &Path, port: &str) -> (Process, String) {
    let folder = crate::text(folder);
    let mut command = ademan(["serve", "--port", port, "--dir", folder]);
    command.stderr(Stdio::piped());
    let mut process = Process::start(&mut command).expect("the program starts");
    let stderr = BufReader::new(process.0.stderr.take().expect("it is piped"));
    let mut lines = stderr.lines().map_while(Result::ok);
    let address = lines.find_map(|line| {
        let (_, rest) = line.split_once("the page is at ")?;
        Some(rest.split(';').next()?.to_owned())
    });
    (process, address.expect("a message with the address"))
}

/// Starts a browser and a server of the page. Returns them with the address of the page; `None` if the machine has no browser or
/// the page is not built.
fn browser_and_server() -> Option<(Browser, Process, String)> {
    let folder = folder()?;
    let browser = Browser::start()?;
    let (server, address) = serve(&folder);
    Some((browser, server, address))
}

#[cfg(not(feature = "tls"))]
#[test]
fn without_tls_the_page_for_a_headset_is_refused_with_the_remedy() {
    let ended = crate::run(["serve", "--lan", "127.0.0.1"]).exited(2);
    ended.reported("--features tls");
    let source = "headset:127.0.0.1:8443?page=target/web";
    let headset = crate::run(["run", "--source", source, "--output", "none"]);
    headset.reported("--features tls");
}
