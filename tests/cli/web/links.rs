//! Layouts in links, and the server of the page.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;

use super::serve;
use crate::{ademan, run, run_to_end, text};

/// Runs the program with a home folder of its own.
fn run_in(home: &std::path::Path, arguments: &[&str]) -> crate::Ended {
    let mut command = ademan(arguments);
    run_to_end(command.env("HOME", home).env("XDG_STATE_HOME", home))
}

#[test]
fn a_shared_layout_is_checked_shown_and_played_but_types_only_if_it_is_trusted() {
    let home = tempfile::tempdir().expect("a folder");
    let link = run([
        "layout",
        "share",
        "qwerty-arc",
        "--page",
        "https://example.org/a/#b",
    ]);
    let link = link.out.trim();
    assert!(link.starts_with("https://example.org/a/#layout="), "{link}");
    assert!(link.len() < 3000, "{}", link.len());
    let shown = run_in(home.path(), &["layout", "show", link]);
    assert!(shown.out.contains('Q'), "{}", shown.err);
    let checked = run_in(home.path(), &["layout", "check", link]);
    checked.printed("valid");
    let typed = [
        "run",
        "--control",
        "off",
        "--source",
        "typist:hola",
        "--layout",
        link,
    ];
    let refused = run_in(home.path(), &typed).exited(2);
    refused.reported("add --trust");
    assert_eq!(refused.out, "");
    let trusted = run_in(home.path(), &[&typed[..], &["--trust"]].concat());
    trusted.printed("down H");
    let demo = ["demo", "--fast", "--text", "a", "--layout", link];
    run_in(home.path(), &demo).done();
    let typing = run_in(home.path(), &[&demo[..], &["--output", "desktop"]].concat());
    typing.reported("add --trust");
}

#[test]
fn a_layout_of_a_link_that_was_changed_stays_when_the_link_is_used_again() {
    let home = tempfile::tempdir().expect("a folder");
    let link = run(["layout", "share", "qwerty-arc"]).out;
    let show = ["layout", "show", link.trim()];
    run_in(home.path(), &show);
    let folder = home.path().join("ademan/links");
    let files = || -> Vec<_> {
        let entries = fs::read_dir(&folder).expect("the folder of links");
        entries.flatten().map(|entry| entry.path()).collect()
    };
    let first = files();
    assert_eq!(first.len(), 1, "{first:?}");
    let original = fs::read_to_string(&first[0]).expect("a layout");
    let changed = format!("// mine\n{original}");
    fs::write(&first[0], &changed).expect("a change");
    for _ in 0..2 {
        run_in(home.path(), &show).done();
    }
    assert_eq!(fs::read_to_string(&first[0]).expect("a layout"), changed);
    let all = files();
    assert_eq!(all.len(), 2, "one more, however often: {all:?}");
    let other = all.iter().find(|path| **path != first[0]);
    let other = fs::read_to_string(other.expect("another one")).expect("a layout");
    assert_eq!(other, original);
}

#[test]
fn a_recording_is_traced_on_the_layout_of_a_link_that_is_trusted() {
    let home = tempfile::tempdir().expect("a folder");
    let shared = run(["layout", "share", "qwerty-arc"]).out;
    let link = shared.trim();
    let path = home.path().join("hand.mcap");
    run(["record", text(&path), "--source", "typist:hi"]).done();
    let source = format!("recording:{}", text(&path));
    let trace = |layout: &[&str]| {
        let arguments = ["trace", "touches", "--source", &source, "--layout"];
        run_in(home.path(), &[&arguments[..], layout].concat())
    };
    let refused = trace(&[link]).exited(2);
    refused.reported("add --trust");
    let traced = trace(&[link, "--trust"]).done();
    assert_ne!(traced.out, "");
    assert!(traced.out == trace(&["qwerty-arc"]).done().out);
}

#[test]
fn a_link_in_a_setup_or_with_a_damaged_layout_is_refused() {
    let home = tempfile::tempdir().expect("a folder");
    let link = run(["layout", "share", "qwerty-arc"]).out;
    let link = link.trim();
    let setup = home.path().join("setup.ron");
    fs::write(
        &setup,
        format!("Setup(layout: \"{link}\", source: \"typist:a\")"),
    )
    .expect("a file");
    let used = run_in(home.path(), &["run", text(&setup)]);
    assert_ne!(used.code, Some(0));
    assert_eq!(used.out, "");
    let cut = run_in(home.path(), &["layout", "show", &link[..link.len() - 40]]);
    cut.reported("damaged");
}

#[test]
fn a_folder_without_a_page_is_no_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let ended = run(["serve", "--port", "0", "--dir", text(folder.path())]);
    assert_ne!(ended.code, Some(0));
    ended.reported("run web/build");
}

/// Sends a request, and returns the answer.
fn request(address: &str, request: &str) -> String {
    let host = address.trim_start_matches("http://").trim_end_matches('/');
    let mut stream = TcpStream::connect(host).expect("it listens");
    write!(stream, "{}", request.replace("HOST", host)).expect("it reads");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("it answers");
    answer
}

#[test]
fn the_server_answers_with_the_files_of_the_folder_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("index.html"), "<p>page").expect("a file");
    fs::write(folder.path().join("secret.txt"), "secret").expect("a file");
    let (_server, address) = serve(folder.path());
    let page = request(&address, "GET / HTTP/1.1\r\nHost: HOST\r\n\r\n");
    assert!(
        page.starts_with("HTTP/1.1 200 OK\r\n") && page.ends_with("<p>page"),
        "{page}"
    );
    let policy = page
        .lines()
        .find(|line| line.starts_with("Content-Security-Policy"));
    assert!(!policy.expect("a policy").contains(" 'unsafe-"), "{page}");
    for path in [
        "/secret.txt",
        "/../secret.txt",
        "/%2e%2e/secret.txt",
        "//etc/passwd",
        "/ws",
    ] {
        let refused = request(
            &address,
            &format!("GET {path} HTTP/1.1\r\nHost: HOST\r\n\r\n"),
        );
        assert!(refused.starts_with("HTTP/1.1 40"), "{path}: {refused}");
    }
    let foreign = request(&address, "GET / HTTP/1.1\r\nHost: example.org\r\n\r\n");
    assert!(foreign.starts_with("HTTP/1.1 403"), "{foreign}");
}
