//! Files of strangers: setups and layouts of other people, files in folders that others can write to, and names that exist.

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, chown, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;
use std::time::Duration;

use tempfile::TempDir;

use crate::support::binary::{NO_FOLDER, copy_binary};
use crate::support::run::{MOVE_TIME, Run, TIMEOUT, shipped};
use crate::{Ended, ademan, run_to_end, text};

pub(super) const NOBODY: u32 = 65_534;

/// A working folder, and the folders of a person.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: &str) {
        fs::create_dir_all(self.at(name).parent().expect("a folder")).expect("space");
        fs::write(self.at(name), content).expect("space");
    }

    fn run(&self, arguments: &[&str]) -> Ended {
        let mut command = ademan(arguments);
        command
            .env("XDG_STATE_HOME", self.at("state"))
            .env("XDG_CONFIG_HOME", self.at("config"))
            .current_dir(self.0.path());
        run_to_end(&mut command)
    }

    /// Runs the program, which refuses for this reason.
    fn refused(&self, arguments: &[&str], reason: &str) {
        let ended = self.run(arguments);
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.err);
        assert!(ended.err.contains(reason), "{arguments:?}: {}", ended.err);
    }
}

/// A layout with one key, which reports its depth under another name.
fn one_key(code: &str, name: &str) -> String {
    format!(
        "Layout(name: \"one\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45), \
         reports_depth: true, keys: [(code: \"{code}\", name: {name:?}, at_mm: (0, 0))])])"
    )
}

fn set_mode(path: &Path, mode: u32) {
    fs::set_permissions(path, Permissions::from_mode(mode)).expect("an own file");
}

/// Gives a file to another user or group. Returns `false` if only root can do that.
pub(super) fn give_away(path: &Path, owner: Option<u32>, group: Option<u32>) -> bool {
    let is_given = chown(path, owner, group).is_ok();
    if !is_given {
        println!("SKIPPED: only root can give a file to another user");
    }
    is_given
}

#[test]
fn a_setup_names_no_file_that_exists_for_its_transcript() {
    let place = Place::new();
    place.write(".bashrc", "mine");
    place.write("work/setup.ron", "");
    let absolute = text(&place.at(".bashrc")).to_owned();
    for name in [
        "../.bashrc",
        "../../.bashrc",
        ".bashrc",
        &absolute,
        "a b",
        "a;b",
    ] {
        let setup = format!("Setup(source: \"typist:hi\", output: \"none,transcript:{name}\")");
        place.write("work/setup.ron", &setup);
        place.refused(&["run", "work/setup.ron"], "names a transcript by letters");
    }
    assert_eq!(
        fs::read_to_string(place.at(".bashrc")).expect("it exists"),
        "mine"
    );
    assert!(!place.at("state").exists());
}

#[test]
fn a_transcript_of_a_setup_is_a_new_private_file_in_a_folder_of_its_own() {
    let place = Place::new();
    let setup = "Setup(source: \"typist:hi\", output: \"transcript:today.txt\")";
    place.write("setup.ron", setup);
    place.write("today.txt", "mine");
    let folder = place.at("state/ademan/transcripts");
    for name in ["today.txt", "today.2.txt"] {
        let ended = place.run(&["run", "setup.ron"]).done();
        let path = folder.join(name);
        ended.reported(text(&path));
        let events = fs::read_to_string(&path).expect("a transcript");
        assert!(events.contains("down H"), "{events}");
        let mode = |file: &Path| fs::metadata(file).expect("it exists").permissions().mode();
        assert_eq!((mode(&path) & 0o777, mode(&folder) & 0o777), (0o600, 0o700));
    }
    assert_eq!(
        fs::read_to_string(place.at("today.txt")).expect("it exists"),
        "mine"
    );
}

#[test]
fn names_in_a_transcript_start_no_program_in_a_shell() {
    let names = [
        ";touch PWNED;",
        "$(touch PWNED)",
        "`touch PWNED`",
        "|touch PWNED",
        "';touch PWNED;'",
        "&touch PWNED&",
        ">PWNED",
    ];
    for (index, name) in names.into_iter().enumerate() {
        let place = Place::new();
        place.write("one.ron", &one_key("H", name));
        let output = format!("transcript:{index}");
        let run = [
            "run", "--source", "typist:h", "--layout", "one.ron", "--output", &output,
        ];
        place.run(&run).done();
        let events = fs::read_to_string(place.at(&index.to_string())).expect("a transcript");
        assert!(
            events.contains("depth") && events.contains("PWNED"),
            "{events}"
        );
        let shell = Command::new("sh")
            .arg(index.to_string())
            .current_dir(place.0.path())
            .output();
        assert!(shell.is_ok(), "a shell");
        assert!(!place.at("PWNED").exists(), "{events}");
    }
}

#[test]
fn no_command_writes_to_a_file_that_exists_or_through_a_link() {
    let place = Place::new();
    place
        .run(&["record", "own.mcap", "--source", "typist:hi"])
        .done();
    let typist = ["--source", "typist:hi"];
    let with = |arguments: &[&'static str]| [arguments, &typist].concat();
    let commands = [
        with(&["run", "--output", "transcript:FILE"]),
        with(&["run", "--output", "none", "--record", "FILE"]),
        with(&["run", "--output", "none", "--record-bvh", "FILE"]),
        vec!["replay", "own.mcap", "--output", "transcript:FILE"],
        vec!["demo", "--text", "hi", "--output", "transcript:FILE"],
        with(&["record", "FILE"]),
        with(&["export", "FILE"]),
        vec!["layout", "new", "FILE"],
        vec!["glove", "new", "FILE"],
        vec!["setup", "new", "FILE"],
        vec!["script", "new", "FILE", "--from", "media"],
        vec!["layout", "show", "media", "--svg", "FILE"],
        vec!["calibrate", "--from", "own.mcap", "--out", "FILE"],
    ];
    let at = |name: &str| fs::read(place.at(name)).expect("it exists");
    place.write("exists.ron", "mine");
    place.write("target", "mine");
    symlink("target", place.at("link.ron")).expect("a link");
    symlink("absent", place.at("dangling.ron")).expect("a link");
    let recording = at("own.mcap");
    for command in commands {
        for name in ["exists.ron", "link.ron", "dangling.ron", "own.mcap"] {
            let arguments: Vec<String> = command
                .iter()
                .map(|word| word.replace("FILE", name))
                .collect();
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            let ended = place.run(&arguments);
            // A name with another extension gets the right one, and is a new file then.
            let longer = [".ron", ".txt"].map(|extension| place.at(&format!("{name}{extension}")));
            let is_new = longer.into_iter().any(|path| fs::remove_file(path).is_ok());
            assert_eq!(
                ended.code == Some(0),
                is_new,
                "{arguments:?}: {}",
                ended.err
            );
            assert_eq!(at("exists.ron"), b"mine", "{arguments:?}");
            assert_eq!(at("target"), b"mine", "{arguments:?}");
            assert!(!place.at("absent").exists(), "{arguments:?}");
            assert!(at("own.mcap") == recording, "{arguments:?}");
        }
    }
}

#[test]
fn manual_pages_and_pictures_replace_files_but_are_not_written_through_links() {
    let place = Place::new();
    place.write("target", "mine");
    fs::create_dir(place.at("man")).expect("space");
    let page = place.at("man/ademan-demo.1");
    symlink("../target", &page).expect("a link");
    place.refused(&["man", "man"], "ademan-demo.1: this is a symbolic link");
    symlink("target", place.at("picture.svg")).expect("a link");
    let show = [
        "layout",
        "show",
        "media",
        "--overwrite",
        "--svg",
        "picture.svg",
    ];
    place.refused(&show, "this is a symbolic link");
    assert_eq!(fs::read(place.at("target")).expect("it exists"), b"mine");

    fs::remove_file(&page).expect("it exists");
    fs::hard_link(place.at("target"), &page).expect("a second name");
    place.run(&["man", "man"]).done();
    place.run(&["man", "man"]).done();
    assert_eq!(fs::read(place.at("target")).expect("it exists"), b"mine");
    let written = fs::read_to_string(&page).expect("a page");
    assert!(written.contains(".SH NAME"), "{written}");
}

#[test]
fn a_name_never_means_a_file_in_the_working_folder() {
    let place = Place::new();
    let planted = one_key("H", "planted");
    for name in [
        "qwerty-flat",
        "qwerty-flat.ron",
        "keyboards/qwerty-flat.ron",
        "unam-hc11",
        "unam-hc11.ron",
        "unam",
        "unam.ron",
        "mine.ron",
    ] {
        place.write(name, &planted);
    }
    let typist = |more: &[&'static str]| [&["run", "-q", "--source", "typist:i"], more].concat();
    for more in [
        &[][..],
        &["--layout", "qwerty-flat"],
        &["--layout", "keyboards/qwerty-flat"],
    ] {
        let ended = place.run(&typist(more)).done();
        assert!(ended.out.contains("down I"), "{more:?}: {}", ended.out);
    }
    let hint = "to use the file in this folder, write ./";
    let unused = "to use qwerty-flat, write ./qwerty-flat";
    let ended = place.run(&["layout", "check", "qwerty-flat"]).done();
    ended.reported(unused);
    place.refused(&["layout", "check", "mine"], &format!("{hint}mine.ron"));
    place.write("setup.ron", "Setup(layout: \"mine\", source: \"typist:h\")");
    place.refused(&["run", "setup"], &format!("{hint}setup.ron"));
    place.refused(&["run", "setup.ron"], &format!("{hint}mine.ron"));
    for path in [
        "./mine",
        "./mine.ron",
        "mine.ron",
        "./qwerty-flat",
        "qwerty-flat.ron",
    ] {
        let arguments = ["run", "--source", "typist:h", "--layout", path];
        let typed = place.run(&arguments).done();
        assert!(typed.out.contains("depth planted"), "{path}: {}", typed.out);
    }
}

/// Messages name a shipped file by a path, where another user may put a file.
#[test]
fn a_file_with_the_path_of_a_shipped_one_is_not_followed() {
    let place = Place::new();
    place.write(
        "layouts/keyboards/qwerty-flat.ron",
        &one_key("H", "planted"),
    );
    let ended = place.run(&["run", "--source", "script:wait 1500"]).done();
    assert!(!ended.err.contains("active from now on"), "{}", ended.err);
}

#[test]
fn files_in_a_setup_are_relative_to_it_and_never_to_the_working_folder() {
    let place = Place::new();
    place.write("mine.ron", &one_key("H", "working folder"));
    place.write("media.ron", &one_key("H", "working folder"));
    let run = |layout: &str| {
        let setup = format!("Setup(layout: \"{layout}\", source: \"typist:h\")");
        place.write("sub/setup.ron", &setup);
        place.run(&["run", "sub/setup.ron"])
    };
    for name in ["mine.ron", "./mine", "./mine.ron"] {
        let ended = run(name);
        assert_eq!(ended.code, Some(2), "{name}: {}", ended.err);
        assert!(
            ended.err.contains("there is no such file"),
            "{name}: {}",
            ended.err
        );
    }
    let ended = run("../mine.ron").done();
    ended.printed("depth working folder");
    place.write("sub/mine.ron", &one_key("H", "beside"));
    for name in ["mine.ron", "./mine", "./mine.ron"] {
        let beside = run(name).done();
        assert!(
            beside.out.contains("depth beside"),
            "{name}: {}",
            beside.out
        );
    }
}

/// The commands that read a layout, a glove, an arm, a setup and a script, with the file of each.
const READERS: [(&str, &[&str]); 6] = [
    (
        "layout.ron",
        &[
            "run",
            "-q",
            "--layout",
            "layout.ron",
            "--source",
            "typist:h",
        ],
    ),
    (
        "glove.ron",
        &["run", "-q", "--glove", "glove.ron", "--source", "typist:h"],
    ),
    ("arm.ron", &["run", "-q", "with-arm.ron"]),
    ("setup.ron", &["run", "-q", "setup.ron"]),
    (
        "config/ademan/setup.ron",
        &["run", "-q", "--source", "typist:h"],
    ),
    (
        "script.txt",
        &["demo", "--layout", "media", "--script", "script.txt"],
    ),
];

/// Writes the files of [`READERS`].
fn readers() -> Place {
    let place = Place::new();
    let glove = include_str!("../../../layouts/gloves/unam-hc11.ron");
    let arm = include_str!("../../../layouts/arms/unam.ron");
    place.write("layout.ron", &one_key("H", "mine"));
    place.write("glove.ron", glove);
    place.write("arm.ron", arm);
    place.write(
        "with-arm.ron",
        "Setup(arm: Model(\"arm.ron\"), source: \"typist:h\")",
    );
    place.write("setup.ron", "Setup(source: \"typist:h\")");
    place.write("config/ademan/setup.ron", "Setup(stall_timeout_ms: 300)");
    place.write("script.txt", "wait 10\n");
    place
}

#[test]
fn files_that_others_may_write_or_replace_are_refused() {
    let place = readers();
    for (file, arguments) in READERS {
        let path = place.at(file);
        let folder = path.parent().expect("a folder").to_owned();
        for (what, mode, reason) in [
            (&path, 0o666, "other users may write this file"),
            (&folder, 0o777, "other users may replace this file"),
        ] {
            let usual = fs::metadata(what).expect("it exists").permissions();
            set_mode(what, mode);
            place.refused(arguments, reason);
            fs::set_permissions(what, usual).expect("an own file");
        }
        // In a folder with the sticky bit only the owner of a file replaces it.
        set_mode(&folder, 0o1777);
        place.run(arguments).done();
        set_mode(&folder, 0o700);
        place.run(arguments).done();
    }
}

#[test]
fn a_link_leads_to_a_file_that_others_may_not_replace() {
    let place = Place::new();
    place.write("shared/layout.ron", &one_key("H", "mine"));
    set_mode(&place.at("shared"), 0o777);
    symlink("shared/layout.ron", place.at("link.ron")).expect("a link");
    place.refused(&["layout", "check", "link.ron"], "other users may replace");
    set_mode(&place.at("shared"), 0o755);
    place.run(&["layout", "check", "link.ron"]).done();
}

#[test]
fn files_of_other_users_and_of_foreign_groups_are_refused() {
    let place = readers();
    for (file, arguments) in READERS {
        let path = place.at(file);
        if !give_away(&path, Some(NOBODY), None) {
            return;
        }
        place.refused(arguments, "belongs to another user");
        give_away(&path, Some(0), Some(NOBODY));
        set_mode(&path, 0o664);
        place.refused(arguments, "other users may write this file");
        // The group with the number of the user is its own.
        give_away(&path, None, Some(0));
        place.run(arguments).done();
    }
}

/// Root owns the files of packages, and a user reads them.
#[test]
fn a_file_of_root_is_trusted_by_a_user() {
    let place = Place::new();
    place.write("layout.ron", &one_key("H", "mine"));
    set_mode(place.0.path(), 0o755);
    if !give_away(&place.at("layout.ron"), Some(0), None) {
        return;
    }
    let program = place.at("ademan");
    copy_binary(&program);
    set_mode(&program, 0o755);
    let mut check = Command::new("setpriv");
    check
        .args(["--reuid=65534", "--regid=65534", "--clear-groups"])
        .arg(&program)
        .args(["layout", "check", "layout.ron"])
        .env("XDG_CONFIG_HOME", NO_FOLDER)
        .current_dir(place.0.path());
    let Ok(ended) = check.output() else {
        println!("SKIPPED: setpriv is not installed");
        return;
    };
    Ended::from(ended).done();
}

/// Presses the key H. The finger must be seen over it first, which no message says.
fn press(run: &Run) {
    for _ in 0..60 {
        run.press();
        if let Ok(event) = run.events.recv_timeout(Duration::from_secs(1)) {
            assert!(event.ends_with("down H"), "{event}");
            return;
        }
        run.lift();
        thread::sleep(MOVE_TIME);
    }
    panic!("the key is never pressed");
}

#[test]
fn a_layout_that_another_user_edits_is_not_activated() {
    for quiet in [&[][..], &["-q"]] {
        let run = Run::with_setup(
            "role: Both, stall_timeout_ms: 10000, arm_immediately: true",
            quiet,
        );
        press(&run);
        let edited = run.folder.path().join("edited");
        fs::write(&edited, shipped("dvorak-flat")).expect("space");
        if !give_away(&edited, Some(NOBODY), None) {
            return;
        }
        // Editors save like this.
        fs::rename(&edited, run.path()).expect("an own folder");
        run.wait_for_message("my.ron: this file belongs to another user, use one of your own");
        assert_eq!(run.next_message(), "the active layout stays");
        // A later edit of the same file, and a file that everybody may write.
        fs::write(run.path(), shipped("qwerty-arc")).expect("root may write");
        run.wait_for_message("my.ron: this file belongs to another user, use one of your own");
        set_mode(&run.path(), 0o666);
        give_away(&run.path(), Some(0), Some(0));
        fs::write(run.path(), shipped("dvorak-flat")).expect("space");
        run.wait_for_message(
            "my.ron: other users may write this file; `chmod go-w my.ron` makes it yours alone",
        );
        assert!(run.events.is_empty(), "the key stays pressed");
        // Now it is an own file.
        set_mode(&run.path(), 0o644);
        fs::write(run.path(), format!("{}\n", shipped("dvorak-flat"))).expect("space");
        let released = run.events.recv_timeout(TIMEOUT).expect("an event");
        assert!(released.ends_with("up   H"), "{released}");
    }
}
