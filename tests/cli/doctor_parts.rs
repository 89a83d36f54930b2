//! Outputs, sources and shares that this machine or this build lacks, in the report of `ademan doctor`.

use crate::doctor::{check, checks};
use crate::run;
#[cfg(target_os = "linux")]
use crate::{ademan, run_to_end};

#[test]
fn an_output_that_this_machine_or_this_build_lacks_is_a_finding() {
    let doctor = |layout: &str, output: &str| {
        let ended = run(["doctor", "--layout", layout, "--output", output, "--json"]).exited(1);
        let found = checks(&ended);
        let outputs = check(&found, "outputs");
        assert_eq!(outputs["status"], "missing", "{outputs}");
        outputs["text"].as_str().expect("a text").to_owned()
    };
    let device = doctor("piano", "midi:/dev/snd/no-such-device");
    assert!(
        device.contains("cannot open /dev/snd/no-such-device"),
        "{device}"
    );
    let folder = tempfile::tempdir().unwrap();
    let no_device = doctor("piano", &format!("midi:{}", folder.path().display()));
    assert!(
        no_device.contains("neither a device nor a pipe"),
        "{no_device}"
    );
    if cfg!(target_os = "linux") {
        for (path, reason) in [
            (folder.path().join("none/spnav"), "there is no such folder"),
            (folder.path().to_owned(), "the file there is not a socket"),
            (folder.path().join("x".repeat(120)), "a socket path at most"),
        ] {
            let text = doctor("arm-6dof", &format!("spacenav:{}", path.display()));
            assert!(text.contains(reason), "{text}");
        }
    }
    if cfg!(not(feature = "midi")) {
        let port = doctor("piano", "midi");
        assert!(port.contains("built without MIDI ports"), "{port}");
    }
    if cfg!(not(feature = "ime")) {
        let text = doctor("qwerty-flat", "ime");
        assert!(text.contains("this build has no input method"), "{text}");
    } else if cfg!(target_os = "linux") {
        let text = doctor("qwerty-flat", "ime:none");
        assert!(text.contains("its keys go through"), "{text}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_default_socket_that_another_program_has_is_a_finding() {
    let folder = tempfile::tempdir().unwrap();
    let outputs = || {
        let arguments = ["--layout", "arm-6dof", "--output", "spacenav", "--json"];
        let mut command = ademan(["doctor"]);
        command
            .args(arguments)
            .env("XDG_RUNTIME_DIR", folder.path());
        check(&checks(&run_to_end(&mut command)), "outputs").clone()
    };
    assert_eq!(outputs()["status"], "ok");
    let sockets = folder.path().join("ademan");
    std::fs::create_dir(&sockets).unwrap();
    let _server = std::os::unix::net::UnixListener::bind(sockets.join("spnav.sock")).unwrap();
    let taken = outputs();
    assert_eq!(taken["status"], "missing");
    let text = taken["text"].as_str().expect("a text");
    assert!(text.contains("another program listens there"), "{text}");
}

#[test]
fn a_source_that_this_build_lacks_is_a_finding() {
    let sources = [
        (
            cfg!(feature = "zenoh"),
            "zenoh:lab/right",
            "built without zenoh",
        ),
        (
            cfg!(feature = "tls"),
            "headset:127.0.0.1:8443",
            "built without TLS",
        ),
    ];
    for &(_, source, reason) in sources.iter().filter(|(is_built, ..)| !is_built) {
        let ended = run(["doctor", "--source", source, "--json"]).exited(1);
        let found = checks(&ended);
        let found_source = check(&found, "source");
        assert_eq!(found_source["status"], "missing", "{found_source}");
        let text = found_source["text"].as_str().expect("a text");
        assert!(text.contains(reason), "{text}");
    }
}

#[test]
fn a_port_at_which_a_setup_cannot_share_is_a_finding() {
    let folder = tempfile::tempdir().unwrap();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let taken_port = taken.local_addr().unwrap().port();
    for (port, status) in [(taken_port, "missing"), (0, "ok")] {
        let text = format!("(source: \"typist:hi\", share: [\"json:127.0.0.1:{port}\"])");
        let setup = crate::file(&folder, &format!("{port}.ron"), text);
        let ended = run(["doctor", "--json", &setup]);
        let checks = checks(&ended);
        let finding = check(&checks, "share");
        assert_eq!(finding["status"], status, "{finding}");
        assert_eq!(ended.code, Some(i32::from(port != 0)), "{finding}");
    }
}
