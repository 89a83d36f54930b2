//! `ademan doctor`, `ademan setup`, and the refusal of root.

#[cfg(target_os = "linux")]
use std::net::TcpListener;
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{fs, io};

use serde_json::Value;

use crate::support::binary::copy_binary;
use crate::{Ended, ademan, run, run_to_end};

/// Returns the path of a file of the package.
fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Returns the checks of a report in JSON.
pub(super) fn checks(ended: &Ended) -> Vec<Value> {
    let read: Value = serde_json::from_str(&ended.out).expect("the output is JSON");
    assert_eq!(read["ok"], ended.code == Some(0));
    read["checks"]
        .as_array()
        .expect("the checks are a list")
        .clone()
}

pub(super) fn check<'a>(checks: &'a [Value], name: &str) -> &'a Value {
    let found = checks.iter().find(|check| check["check"] == name);
    found.expect("the check exists")
}

#[test]
fn missing_requirements_are_listed_with_their_remedy() {
    let ended = run(["doctor", "--source", "serial:/dev/no-such-glove"]).exited(1);
    ended.printed("missing      serial port  needed  /dev/no-such-glove does not exist\n");
    let mut checks = ended.out.lines().map(|line| line.split_whitespace().nth(1));
    assert!(checks.all(|check| check != Some("source")), "{}", ended.out);
    ended.printed("\n# serial port, which is needed\n# check the cable");
    run(["doctor", "--source", "typist:hi"]).done();
}

#[test]
fn an_output_that_cannot_send_what_the_layout_requires_is_a_finding() {
    let ended = run(["doctor", "--output", "spacenav", "--json"]).exited(1);
    let checks = checks(&ended);
    let outputs = check(&checks, "outputs");
    assert_eq!(outputs["status"], "missing");
    let text = outputs["text"].as_str().expect("a text");
    assert!(text.contains("`spacenav` does not support"), "{text}");
    assert!(checks.len() > 1, "the other checks are reported too");
    run(["doctor", "--output", "spacenavy"]).exited(2);
}

#[test]
fn a_display_and_a_running_session_are_detected() {
    let folder = tempfile::tempdir().unwrap();
    let doctor = |arguments: &[&str]| {
        let mut command = ademan(["doctor", "--json"]);
        command.args(arguments);
        run_to_end(command.env("XDG_RUNTIME_DIR", folder.path()))
    };
    let free = checks(&doctor(&[]).done());
    assert_eq!(check(&free, "sockets")["status"], "ok");
    let desktop = doctor(&["--output", "desktop"]);
    let display = &checks(&desktop);
    let display = check(display, "display");
    assert_eq!(
        (&display["status"], &display["text"]),
        (&"missing".into(), &"DISPLAY is not set".into())
    );

    fs::create_dir(folder.path().join("ademan")).unwrap();
    let _run = UnixListener::bind(folder.path().join("ademan/control.sock")).unwrap();
    let taken = checks(&doctor(&[]).exited(1));
    let text = check(&taken, "sockets")["text"].to_string();
    let process = format!("(process {})", std::process::id());
    assert!(text.contains(&process), "{text}");
}

/// Writes a setup with a profile for an application.
#[cfg(target_os = "linux")]
fn setup_with_rule(folder: &Path) -> PathBuf {
    let setup = folder.join("setup.ron");
    let text = "Setup(\n    profiles: [(name: \"sofa\", layout: \"arrows\")],\n    \
                profiles_by_application: [(application: \"coder\", profile: \"sofa\")],\n)\n";
    fs::write(&setup, text).unwrap();
    setup
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_display_no_output_is_advised_to_follow_the_focus() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = ademan(["doctor", "--json"]);
    command.arg(setup_with_rule(folder.path()));
    for variable in ["DISPLAY", "WAYLAND_DISPLAY"] {
        command.env_remove(variable);
    }
    let ended = run_to_end(&mut command);
    let found = checks(&ended);
    let reason = check(&found, "focus")["text"].as_str().expect("a text");
    assert!(reason.starts_with("DISPLAY is not set"), "{reason}");
    assert!(
        reason.contains("`ademan ctl profile`") && !reason.contains("uinput"),
        "{reason}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_desktop_that_hangs_is_a_finding_and_does_not_hang_the_doctor() {
    let stopped = TcpListener::bind(("127.0.0.1", 0)).expect("a free port");
    let port = stopped.local_addr().expect("it is bound").port();
    let folder = tempfile::tempdir().unwrap();
    let setup = setup_with_rule(folder.path());
    let mut command = ademan(["doctor", "--json"]);
    // The display 0 of a machine has the port 6000.
    let display = format!("127.0.0.1:{}", port.checked_sub(6000).expect("a high port"));
    command.arg(&setup).env("DISPLAY", display);
    let ended = run_to_end(&mut command).exited(1);
    let found = checks(&ended);
    let focus = check(&found, "focus");
    assert_eq!(focus["status"], "missing");
    let reason = focus["text"].as_str().expect("a text");
    assert!(
        reason.starts_with("the desktop does not answer"),
        "{reason}"
    );
    drop(stopped);
}

/// Runs the doctor for a port as the user `nobody`, with these groups only.
#[cfg(target_os = "linux")]
fn as_nobody(program: &Path, groups: &str, source: &str) -> Option<Ended> {
    let mut command = Command::new("setpriv");
    command
        .args(["--reuid=65534", "--regid=65534", groups])
        .arg(program)
        .args(["doctor", "--source", source, "--output", "none"])
        .env_remove("XDG_RUNTIME_DIR");
    match command.output() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            println!("SKIPPED: setpriv is not installed");
            None
        }
        ended => Some(ended.expect("the program starts").into()),
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_denied_port_is_explained_and_members_of_its_group_may_open_it() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};
    let folder = tempfile::tempdir().unwrap();
    if folder.path().metadata().unwrap().uid() != 0 {
        println!("SKIPPED: only root can create a port that belongs to others");
        return;
    }
    let groups = fs::read_to_string("/etc/group").unwrap();
    let dialout = groups
        .lines()
        .find_map(|line| line.strip_prefix("dialout:x:"));
    let Some(dialout) = dialout.and_then(|rest| rest.split(':').next()) else {
        println!("SKIPPED: there is no group `dialout` here");
        return;
    };
    // Other users may have no access to the build directory.
    let program = folder.path().join("ademan");
    copy_binary(&program);
    fs::set_permissions(folder.path(), PermissionsExt::from_mode(0o755)).unwrap();
    let wire = ademan::capture::open_loopback(ademan::capture::Hc11Format::default()).unwrap();
    let source = wire.uri.to_string();
    let port = source
        .trim_start_matches("serial:")
        .split('?')
        .next()
        .unwrap();
    let belongs_to = |group: &str, mode| {
        chown(port, Some(0), Some(group.parse().unwrap())).unwrap();
        fs::set_permissions(port, PermissionsExt::from_mode(mode)).unwrap();
    };

    belongs_to("0", 0o600);
    let Some(ended) = as_nobody(&program, "--clear-groups", &source) else {
        return;
    };
    let owner = format!("needed  no permission to open {port}, which only its owner may open\n");
    ended.printed(&owner);
    ended.exited(1);

    belongs_to(dialout, 0o660);
    let denied = as_nobody(&program, "--clear-groups", &source).unwrap();
    let group =
        format!("needed  no permission to open {port}, which belongs to the group `dialout`\n");
    denied.printed(&group);
    denied.printed("\nsudo usermod --append --groups dialout $USER\n# log in again\n");
    denied.exited(1);

    as_nobody(&program, &format!("--groups={dialout}"), &source)
        .unwrap()
        .done();
}

#[test]
fn the_test_of_an_unavailable_output_fails_with_the_reason() {
    let ended = run(["doctor", "--test", "desktop"]).exited(1);
    let reason =
        "fails        desktop      tested  cannot open the output `desktop`: DISPLAY is not set";
    ended.printed(reason);
    assert_eq!(run(["doctor", "--test", "transcript"]).code, Some(2));
}

#[test]
fn an_invalid_setup_is_refused() {
    assert_eq!(run(["doctor", "no-such-setup.ron"]).code, Some(2));
    let ended = run(["doctor", "--output", "desktp"]).exited(2);
    ended.reported("did you mean `desktop`?");
}

#[test]
fn the_printed_files_are_those_of_the_package() {
    let files = [
        ("udev", "60-ademan.rules"),
        ("udev-uaccess", "60-ademan-uaccess.rules"),
        ("modules", "modules-load.conf"),
        ("unit", "ademan.service"),
        ("desktop", "ademan.desktop"),
    ];
    let all = run(["system-files"]).done().out;
    for (name, file) in files {
        let text = fs::read_to_string(root("packaging").join(file)).unwrap();
        let program = env!("CARGO_BIN_EXE_ademan");
        // The unit and the launcher name the program that prints them.
        let text = match name {
            "unit" => text
                .replace("/usr/bin/ademan", program)
                .replace("ExecPaths=/usr ", &format!("ExecPaths=/usr {program} ")),
            "desktop" => text
                .replace("\nExec=ademan ", &format!("\nExec={program} "))
                .replace("\nTryExec=ademan\n", &format!("\nTryExec={program}\n")),
            _ => text,
        };
        assert_eq!(run(["system-files", name]).done().out, text);
        assert!(all.contains(&text), "{name}");
    }
}

/// Returns the conditions of the rules for serial ports.
fn port_conditions(file: &str) -> Vec<String> {
    let rules = fs::read_to_string(root("packaging").join(file)).unwrap();
    let ports = rules
        .lines()
        .filter(|line| line.starts_with("SUBSYSTEMS==\"usb\""));
    let conditions = |line: &str| {
        let parts = line.split(", ").filter(|part| part.starts_with("ATTRS"));
        parts.collect::<Vec<_>>().join(", ")
    };
    ports.map(conditions).collect()
}

#[test]
fn both_kinds_of_rules_have_the_adapters_and_the_boards_of_the_firmware() {
    let ports = port_conditions("60-ademan.rules");
    assert_eq!(ports, port_conditions("60-ademan-uaccess.rules"));
    // An Arduino Uno, an ESP32 with USB of its own, and the adapters of a Nano and of other ESP32 boards.
    for vendor in ["2341", "303a", "0403", "1a86", "10c4"] {
        let is_named = ports.iter().any(|port| port.contains(vendor));
        assert!(is_named, "{vendor}: {ports:?}");
    }
}

/// Returns the files of the Debian package, as its list names them.
fn package_sources() -> Vec<String> {
    let manifest = fs::read_to_string(root("Cargo.toml")).unwrap();
    let (_, section) = manifest
        .split_once("[package.metadata.deb]")
        .expect("the manifest describes the package");
    let (_, assets) = section
        .split_once("assets = [")
        .expect("the package has assets");
    let (assets, _) = assets.split_once("\n]").expect("the list is closed");
    let source = |line: &str| {
        line.trim()
            .strip_prefix("[\"")?
            .split('"')
            .next()
            .map(str::to_owned)
    };
    assets.lines().filter_map(source).collect()
}

#[test]
fn every_file_of_the_package_exists() {
    let sources = package_sources();
    assert!(sources.len() >= 8, "{sources:?}");
    for source in sources {
        let is_built = source.starts_with("target/");
        let exists = match source.split_once("*") {
            Some((folder, suffix)) => fs::read_dir(root(folder)).is_ok_and(|mut files| {
                let name = |file: io::Result<fs::DirEntry>| file.unwrap().file_name();
                files.any(|file| name(file).to_string_lossy().ends_with(suffix))
            }),
            None => root(&source).is_file(),
        };
        assert!(is_built || exists, "{source}");
    }
}

#[test]
fn the_package_has_the_guides_and_the_notices_of_the_language_models() {
    let sources = package_sources();
    let models = "crates/text/languages";
    let files = fs::read_dir(root(models)).unwrap();
    let names = files.map(|file| file.unwrap().file_name().to_string_lossy().into_owned());
    let notices = names.filter(|name| name.starts_with("NOTICE"));
    let notices: Vec<String> = notices.map(|name| format!("{models}/{name}")).collect();
    assert!(!notices.is_empty());
    let guides = ["README.md", "SECURITY.md", "docs/*.md", "layouts/README.md"];
    for wanted in notices.into_iter().chain(guides.map(str::to_owned)) {
        assert!(sources.contains(&wanted), "{wanted} is not in {sources:?}");
    }
}

#[test]
fn the_unit_the_launcher_and_the_rules_pass_their_validators() {
    let unit = root("packaging/ademan.service");
    let launcher = root("packaging/ademan.desktop");
    let rules = ["60-ademan.rules", "60-ademan-uaccess.rules"];
    check_with(Command::new("desktop-file-validate").arg(launcher));
    for file in rules {
        let path = root("packaging").join(file);
        let knows = Command::new("udevadm").args(["verify", "--help"]).output();
        match knows {
            Ok(help) if help.status.success() => {
                check_with(Command::new("udevadm").arg("verify").arg(path));
            }
            _ => println!("SKIPPED: udevadm is not installed or has no `verify`"),
        }
    }
    // The threshold is ten times the exposure, which ranges from 0 to 10.
    let security = ["security", "--offline=true", "--threshold=25"];
    check_with(Command::new("systemd-analyze").args(security).arg(unit));
}

/// Runs a validator, which must find no error; skipped if it is not installed.
fn check_with(tool: &mut Command) {
    let name = Path::new(tool.get_program()).display().to_string();
    match tool.output() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            println!("SKIPPED: {name} is not installed");
        }
        ended => {
            let ended = Ended::from(ended.expect("the program starts"));
            assert_eq!(ended.code, Some(0), "{name}: {}{}", ended.out, ended.err);
        }
    }
}

#[test]
fn root_is_refused_without_allow_root_but_may_use_other_commands() {
    let program = env!("CARGO_BIN_EXE_ademan");
    let run = |arguments: &[&str]| {
        let mut command = Command::new(program);
        run_to_end(command.args(arguments).env_remove("XDG_RUNTIME_DIR"))
    };
    let is_root = Command::new("id")
        .arg("-u")
        .output()
        .expect("the program starts");
    if is_root.stdout != b"0\n" {
        println!("SKIPPED: only root is refused");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let recording = folder.path().join("hi.mcap");
    let recording = recording.to_str().expect("UTF-8");
    run(&["record", recording, "--source", "typist:hi"]).done();
    let refused = [
        &["run", "--source", "typist:hi"][..],
        &["replay", recording, "--output", "desktop"],
        &["replay", recording, "--output", "transcript,uinput"],
        &["demo", "--text", "hi", "--output", "desktop"],
    ];
    for arguments in refused {
        let ended = run(arguments);
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.err);
        assert_eq!(ended.out, "");
        for part in ["refusing to run as root", "--allow-root"] {
            ended.reported(part);
        }
    }
    run(&["replay", recording]).done();
    run(&["run", "--source", "typist:hi", "--allow-root"]).done();
    run(&["trace", "events", "--source", "typist:hi"]).done();
}

#[cfg(target_os = "linux")]
#[test]
fn lines_break_between_words_on_a_terminal_and_nowhere_else() {
    use crate::view::{screen::Screen, set_terminal};

    let arguments = [
        "doctor",
        "--source",
        "serial:/dev/no-such-glove",
        "--output",
        "uinput",
    ];
    let piped = run(arguments).out;
    let longest = piped.lines().map(|line| line.chars().count()).max();
    assert!(longest > Some(80), "something has to break: {piped}");
    let mut command = ademan(arguments);
    set_terminal(&mut command);
    let mut screen = Screen::start(&command, 80, 60);
    screen.wait();
    let shown = screen.text();
    println!("{shown}");
    let rows = shown.lines().take_while(|line| !line.starts_with("# "));
    let words =
        |text: &str| -> Vec<String> { text.split_whitespace().map(str::to_owned).collect() };
    for word in rows.flat_map(words) {
        assert!(
            words(&piped).contains(&word),
            "{word:?} is a part of a word: {shown}"
        );
    }
    let below = format!("\n{}", " ".repeat(34));
    assert!(shown.contains(&below), "{shown}");
}

#[test]
fn a_source_or_output_that_a_run_would_refuse_is_a_finding() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().join("empty.mcap");
    fs::write(&empty, "").unwrap();
    let recording = format!("recording:{}", empty.display());
    for (option, value, reason) in [
        (
            "--source",
            "script:nofile.txt",
            "nofile.txt: there is no such file",
        ),
        (
            "--source",
            "script:tap Q; tap Nowhere",
            "unknown target `Nowhere`",
        ),
        ("--source", recording.as_str(), "the file is empty"),
        ("--source", "typist:ñ", "cannot type 'ñ'"),
        ("--output", "transcript:/nodir/x", "there is no such folder"),
    ] {
        let ended = run(["doctor", "--json", option, value]);
        assert_eq!(ended.code, Some(1), "{value}: {}{}", ended.out, ended.err);
        let checks = checks(&ended);
        let name = if option == "--source" {
            "source"
        } else {
            "outputs"
        };
        let finding = check(&checks, name);
        assert_eq!(finding["status"], "missing", "{value}");
        let text = finding["text"].as_str().expect("a text");
        assert!(text.contains(reason), "{value}: {text}");
    }
    run(["doctor", "--source", "script:tap Q"]).done();
}
