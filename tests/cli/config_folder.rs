//! Files by name: path, configuration folder, shipped; and the setup that is found by itself.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use super::{Ended, ademan, run_to_end, text};

/// A person's configuration folder and a working folder.
struct Home(TempDir);

impl Home {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("config/ademan/layouts")).unwrap();
        fs::create_dir_all(folder.path().join("config/ademan/gloves")).unwrap();
        fs::create_dir_all(folder.path().join("work")).unwrap();
        Self(folder)
    }

    /// Writes a file below `config/ademan` or `work`.
    fn write(&self, path: &str, content: impl AsRef<[u8]>) {
        fs::write(self.0.path().join(path), content).unwrap();
    }

    /// Runs the program in the working folder.
    fn run(&self, line: &str) -> Ended {
        let mut command = ademan(line.split(' '));
        // Of Linux and macOS, then of Windows.
        command.env("XDG_CONFIG_HOME", self.0.path().join("config"));
        command.env("APPDATA", self.0.path().join("config"));
        command.current_dir(self.0.path().join("work"));
        run_to_end(&mut command)
    }

    fn config(&self, path: &str) -> String {
        text(&self.0.path().join("config/ademan").join(path)).to_owned()
    }
}

/// A layout with one key.
fn layout(name: &str, key: &str) -> String {
    let row = format!("rows: [(at_mm: (0, 0), keys: \"{key}\")]");
    let pose = "pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45)";
    format!("Layout(name: \"{name}\", boards: [({pose}, {row})])")
}

#[test]
fn a_path_precedes_the_configuration_folder_and_this_one_a_shipped_layout() {
    let home = Home::new();
    let is_drawn = |line: &str, label: &str| {
        let out = home.run(&format!("layout show {line}")).done().out;
        assert!(out.contains(label), "{out}");
    };
    is_drawn("media", "Seek");
    home.write(
        "config/ademan/layouts/media.ron",
        layout("configuration", "A"),
    );
    is_drawn("media", " A ");
    home.write("work/media.ron", layout("working folder", "B"));
    home.write("work/media", layout("path", "C"));
    is_drawn("media", " A ");
    is_drawn("media.ron", " B ");
    is_drawn("./media", " C ");
    is_drawn("./media.ron", " B ");
    // The name with its folder means the shipped file.
    is_drawn("panels/media", "Seek");
}

#[test]
fn a_file_that_hides_a_shipped_one_is_reported() {
    let home = Home::new();
    assert_eq!(home.run("layout check media").done().err, "");
    home.write("work/media.ron", layout("mine", "A"));
    let ended = home.run("layout check media").done();
    let expected =
        "`media` is the file that comes with the program; to use media.ron, write ./media.ron";
    ended.reported(expected);
    assert_eq!(home.run("layout check media.ron").done().err, "");
    let own = "config/ademan/layouts/media.ron";
    home.write(own, layout("mine", "A"));
    let hidden = home.run("layout check media").done();
    let hiding = format!(
        "using {}, which hides the `media` that comes with the program",
        home.config("layouts/media.ron")
    );
    hidden.reported(&hiding);
    home.write("work/other.ron", layout("other", "A"));
    assert_eq!(home.run("layout check other.ron").done().err, "");
}

#[test]
fn a_new_layout_is_found_by_its_name_and_one_that_is_missing_suggests_it() {
    let home = Home::new();
    home.run("layout new mine --from numpad").done();
    home.run("run --source typist:1 --layout mine.ron").done();
    fs::rename(
        home.0.path().join("work/mine.ron"),
        home.config("layouts/mine.ron"),
    )
    .unwrap();
    home.run("run --source typist:1 --layout mine").done();
    let error = home.run("layout check mien");
    error.reported("did you mean `mine`?");
    let list = home.run("layouts").done().out;
    assert!(list.lines().any(|line| line.starts_with("mine ")), "{list}");
    assert_eq!(list, home.run("layout list").done().out);
}

#[test]
fn a_glove_of_the_configuration_folder_is_found_by_its_name() {
    let home = Home::new();
    home.run("glove new mine --from unam-hc11").done();
    fs::rename(
        home.0.path().join("work/mine.ron"),
        home.config("gloves/mine.ron"),
    )
    .unwrap();
    home.run("run --source typist:a --glove mine").done();
    let list = home.run("gloves").done().out;
    assert!(list.lines().any(|line| line.starts_with("mine ")), "{list}");
}

#[test]
fn a_layout_a_glove_and_a_person_of_one_name_are_three_files() {
    let home = Home::new();
    fs::create_dir_all(home.0.path().join("config/ademan/persons")).unwrap();
    // As docs/install.md proposes.
    home.run("layout new ../config/ademan/layouts/mine --from qwerty-arc")
        .done();
    home.run("glove new ../config/ademan/gloves/mine --from unam-hc11")
        .done();
    home.run("person new ../config/ademan/persons/mine").done();
    let all = "--layout mine --glove mine --person mine";
    home.run(&format!("run --source typist:a {all}")).done();
    let setup = "Setup(source: \"typist:a\", layout: \"mine\", glove: \"mine\", person: \"mine\")";
    home.write("work/setup.ron", setup);
    home.run("run setup.ron").done();
    for list in ["gloves", "person list", "layouts"] {
        let out = home.run(list).done().out;
        let own = out.lines().find(|line| line.starts_with("mine "));
        assert!(
            own.is_some_and(|own| !own.contains("invalid")),
            "{list}: {out}"
        );
    }
    home.run("schema glove mine").done();
    // A file of another kind is no meaning of the name.
    fs::remove_file(home.0.path().join("config/ademan/gloves/mine.ron")).unwrap();
    let missing = home.run("run --source typist:a --glove mine").exited(2);
    missing.reported("mine: there is no such file");
    assert!(!missing.err.contains("layouts/mine.ron"), "{}", missing.err);
}

#[test]
fn the_setup_of_the_configuration_folder_is_used_and_said_unless_another_is_named() {
    let home = Home::new();
    home.write(
        "config/ademan/setup.ron",
        "Setup(layout: \"mine\", source: \"typist:1\")",
    );
    home.write("config/ademan/layouts/mine.ron", layout("mine", "1"));
    let ended = home.run("run").done();
    ended.reported(&format!("using {}", home.config("setup.ron")));
    ended.printed("down 1");
    home.write(
        "work/other.ron",
        "Setup(source: \"typist:2\", layout: \"numpad\")",
    );
    let other = home.run("run other.ron").done();
    assert!(!other.err.contains("using"), "{}", other.err);
    other.printed("down Numpad2");
    home.write("config/ademan/setup.ron", "Setup(stall_timeout_ms: 5)");
    let invalid = home.run("run --source typist:1");
    let place = format!(
        "{}:1:25: `stall_timeout_ms` is 20 to 10000",
        home.config("setup.ron")
    );
    invalid.reported(&place);
}

#[cfg(unix)]
#[test]
fn a_setup_of_the_configuration_folder_that_cannot_be_read_is_not_ignored() {
    use std::os::unix::fs::symlink;

    let home = Home::new();
    let path = home.0.path().join("config/ademan/setup.ron");
    let refused = |reason: &str| {
        let ended = home.run("run --source typist:1").exited(2);
        assert_eq!(ended.out, "", "nothing is typed without its limits");
        let named = ended.err.contains(&home.config("setup.ron"));
        assert!(named && ended.err.contains(reason), "{}", ended.err);
    };
    symlink("/nowhere/setup.ron", &path).unwrap();
    refused("no such file");
    fs::remove_file(&path).unwrap();
    symlink("setup.ron", &path).unwrap();
    refused("they lead in a circle");
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    refused("this is a directory");
    fs::remove_dir(&path).unwrap();
    home.run("run --source typist:1").done();
}

#[test]
fn files_to_start_from_come_with_the_program_and_are_valid() {
    let home = Home::new();
    home.run("setup new my-setup").done();
    home.run("glove new my-glove --from unam-hc11-left").done();
    home.run("script new my-script --from media").done();
    home.run("layout new my-layout --from media").done();
    home.run("demo --layout my-layout.ron --script my-script.txt")
        .done();
    home.run("run my-setup.ron --source typist:a --output transcript")
        .done();
    let glove = fs::read_to_string(home.0.path().join("work/my-glove.ron")).unwrap();
    assert!(glove.contains("name: \"my-glove\""), "{glove}");
    for line in [
        "setup new my-setup",
        "glove new my-glove",
        "script new my-script --from media",
    ] {
        let ended = home.run(line);
        assert_eq!(ended.code, Some(2), "{line}");
        ended.reported("choose another name or remove it");
    }
    assert!(Path::new(&home.0.path().join("work/my-script.txt")).exists());
}

#[test]
fn an_export_of_a_recording_has_its_setup_and_not_the_one_of_the_configuration_folder() {
    let home = Home::new();
    home.run("record hand.mcap --source typist:hi").done();
    home.run("export before.bvh --source recording:hand.mcap")
        .done();
    home.write(
        "config/ademan/setup.ron",
        "Setup(glove: \"lucidgloves-left\", layout: \"chords-bend\")",
    );
    let ended = home
        .run("export after.bvh --source recording:hand.mcap")
        .done();
    ended.reported("using the setup in hand.mcap\n");
    let [before, after] = ["before.bvh", "after.bvh"].map(|name| {
        let path = home.0.path().join("work").join(name);
        fs::read_to_string(path).unwrap()
    });
    assert!(before == after, "other poses: {}", ended.err);
}
