//! `ademan doctor`, `ademan setup`, and root, who is refused.

use std::fs;
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::{Ended, ademan, run};

/// A file of the package.
fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn checks(ended: &Ended) -> Vec<Value> {
    let read: Value = serde_json::from_str(&ended.out).expect("it is JSON");
    assert_eq!(read["ok"], ended.code == Some(0));
    read["checks"].as_array().expect("a list").clone()
}

fn check<'a>(checks: &'a [Value], name: &str) -> &'a Value {
    let found = checks.iter().find(|check| check["check"] == name);
    found.expect("it is checked")
}

#[test]
fn a_setup_that_needs_what_is_not_there_is_told_so_line_by_line() {
    let ended = run(["doctor", "--source", "serial:/dev/no-such-glove"]);
    assert_eq!(ended.code, Some(1), "{}", ended.err);
    let missing = "missing      serial port  needed  /dev/no-such-glove is not there\n";
    assert!(ended.out.contains(missing), "{}", ended.out);
    let remedy = "\n# serial port, which is needed\n# check the cable";
    assert!(ended.out.contains(remedy), "{}", ended.out);
    run(["doctor", "--source", "typist:hi"]).done();
}

#[test]
fn a_display_and_a_run_that_are_there_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    let doctor = |arguments: &[&str]| -> Ended {
        let mut command = ademan(["doctor", "--json"]);
        command
            .args(arguments)
            .env("XDG_RUNTIME_DIR", folder.path());
        command.output().expect("it starts").into()
    };
    let ended = doctor(&[]);
    let free = checks(&ended);
    assert_eq!(ended.code, Some(0), "{}", ended.out);
    assert_eq!(check(&free, "sockets")["state"], "ok");
    let ended = doctor(&["--output", "desktop"]);
    let display = &checks(&ended);
    let display = check(display, "display");
    assert_eq!(
        (&display["state"], &display["text"]),
        (&"missing".into(), &"DISPLAY is not set".into())
    );

    fs::create_dir(folder.path().join("ademan")).unwrap();
    let _run = UnixListener::bind(folder.path().join("ademan/control.sock")).unwrap();
    let ended = doctor(&[]);
    let taken = checks(&ended);
    assert_eq!(ended.code, Some(1));
    let text = check(&taken, "sockets")["text"].to_string();
    let process = format!("(process {})", std::process::id());
    assert!(text.contains(&process), "{text}");
}

/// What the doctor says of a port to a user who is a member of these groups and of no other, and his exit code.
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
        ended => Some(ended.expect("it starts").into()),
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_port_of_others_is_told_with_who_may_open_it_and_members_of_that_group_may() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};
    let folder = tempfile::tempdir().unwrap();
    if folder.path().metadata().unwrap().uid() != 0 {
        println!("SKIPPED: only root can make a port of others");
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
    // Where it is built not everybody may look.
    let program = folder.path().join("ademan");
    fs::copy(env!("CARGO_BIN_EXE_ademan"), &program).unwrap();
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
    let owner = format!("needed  this user may not open {port}, which is for its owner only\n");
    assert!(ended.out.contains(&owner), "{}{}", ended.out, ended.err);
    assert_eq!(ended.code, Some(1), "{}", ended.out);

    belongs_to(dialout, 0o660);
    let ended = as_nobody(&program, "--clear-groups", &source).unwrap();
    let group =
        format!("needed  this user may not open {port}, which is for the group `dialout`\n");
    assert!(ended.out.contains(&group), "{}{}", ended.out, ended.err);
    let join = "\nsudo usermod --append --groups dialout $USER\n# log in again\n";
    assert!(ended.out.contains(join), "{}", ended.out);
    assert_eq!(ended.code, Some(1), "{}", ended.out);

    let member = as_nobody(&program, &format!("--groups={dialout}"), &source).unwrap();
    assert_eq!(member.code, Some(0), "{}{}", member.out, member.err);
}

#[test]
fn an_output_that_cannot_be_had_fails_its_trial_with_the_reason() {
    let ended = run(["doctor", "--test", "desktop"]);
    assert_eq!(ended.code, Some(1));
    let reason =
        "fails        desktop      tested  cannot open the output `desktop`: DISPLAY is not set";
    assert!(ended.out.contains(reason), "{}", ended.out);
    assert_eq!(run(["doctor", "--test", "transcript"]).code, Some(2));
}

#[test]
fn a_wrong_setup_is_no_matter_for_a_doctor() {
    assert_eq!(run(["doctor", "no-such-setup.ron"]).code, Some(2));
    let ended = run(["doctor", "--output", "desktp"]);
    assert_eq!(ended.code, Some(2));
    assert!(
        ended.err.contains("did you mean `desktop`?"),
        "{}",
        ended.err
    );
}

#[test]
fn the_files_that_a_package_brings_are_those_that_are_printed() {
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
        assert_eq!(run(["system-files", name]).done().out, text);
        assert!(all.contains(&text), "{name}");
    }
}

#[test]
fn every_file_of_the_package_is_there() {
    let manifest = fs::read_to_string(root("Cargo.toml")).unwrap();
    let (_, section) = manifest
        .split_once("[package.metadata.deb]")
        .expect("it says what the package is");
    let (_, assets) = section.split_once("assets = [").expect("and what is in it");
    let (assets, _) = assets.split_once("\n]").expect("the list ends");
    let sources: Vec<_> = assets
        .lines()
        .filter_map(|line| line.trim().strip_prefix("[\"")?.split('"').next())
        .collect();
    assert!(sources.len() >= 8, "{sources:?}");
    for source in sources {
        let is_built = source.starts_with("target/");
        assert!(is_built || root(source).is_file(), "{source}");
    }
}

#[test]
fn a_unit_and_a_launcher_are_what_their_own_tools_take() {
    let unit = root("packaging/ademan.service");
    let launcher = root("packaging/ademan.desktop");
    let rules = ["60-ademan.rules", "60-ademan-uaccess.rules"];
    is_taken_by(Command::new("desktop-file-validate").arg(launcher));
    for rules in rules {
        let path = root("packaging").join(rules);
        let knows = Command::new("udevadm").args(["verify", "--help"]).output();
        match knows {
            Ok(help) if help.status.success() => {
                is_taken_by(Command::new("udevadm").arg("verify").arg(path));
            }
            _ => println!("SKIPPED: this udevadm has no `verify`, or there is none"),
        }
    }
    // Exposure goes from 0 to 10; the threshold is ten times that.
    let security = ["security", "--offline=true", "--threshold=25"];
    is_taken_by(Command::new("systemd-analyze").args(security).arg(unit));
}

/// A tool that is there finds nothing wrong.
fn is_taken_by(tool: &mut Command) {
    let name = Path::new(tool.get_program()).display().to_string();
    match tool.output() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            println!("SKIPPED: {name} is not installed");
        }
        ended => {
            let ended = Ended::from(ended.expect("it starts"));
            assert_eq!(ended.code, Some(0), "{name}: {}{}", ended.out, ended.err);
        }
    }
}

#[test]
fn root_does_not_type_unless_he_insists_and_may_do_all_the_rest() {
    let program = env!("CARGO_BIN_EXE_ademan");
    let run = |arguments: &[&str]| -> Ended {
        let mut command = Command::new(program);
        command.args(arguments).env_remove("XDG_RUNTIME_DIR");
        command.output().expect("it starts").into()
    };
    let is_root = Command::new("id").arg("-u").output().expect("it starts");
    if is_root.stdout != b"0\n" {
        println!("SKIPPED: only root is refused");
        return;
    }
    let refused = run(&["run", "--source", "typist:hi"]);
    assert_eq!(refused.code, Some(2), "{}", refused.err);
    assert_eq!(refused.out, "");
    for part in ["root is not the one to type", "--allow-root"] {
        assert!(refused.err.contains(part), "{}", refused.err);
    }
    run(&["run", "--source", "typist:hi", "--allow-root"]).done();
    run(&["trace", "events", "--source", "typist:hi"]).done();
}
