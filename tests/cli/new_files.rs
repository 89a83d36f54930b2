//! Names of files that the program creates as copies.

use std::path::Path;

use super::{run, text};

#[test]
fn the_extension_is_added_to_a_new_name_with_a_dot() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board-v1.2");
    for kind in ["layout", "glove", "person", "setup"] {
        let path = format!("{}-{kind}", text(&path));
        let written = run([kind, "new", &path]).done().out;
        assert!(written.contains(&format!("{path}.ron")), "{written}");
        assert!(!Path::new(&path).exists());
        let content = std::fs::read_to_string(format!("{path}.ron")).unwrap();
        let name = format!("name: \"board-v1.2-{kind}\"");
        assert!(kind == "setup" || content.contains(&name), "{content}");
    }
    let whole = format!("{}.ron", text(&path));
    assert!(run(["layout", "new", &whole]).done().out.contains(&whole));
    assert!(Path::new(&whole).exists());
    run(["layout", "check", &whole]).done();
}

#[cfg(unix)]
#[test]
fn a_new_file_is_valid_under_any_name() {
    let folder = tempfile::tempdir().unwrap();
    let names = [
        "cafe\u{301}",
        "a\u{200b}b",
        "five \"5\"",
        "a\\b",
        "tab\tline\n",
    ];
    for name in names {
        for (kind, test) in [("layout", "check"), ("person", "show")] {
            let path = folder.path().join(format!("{name}-{kind}.ron"));
            run([kind, "new", text(&path)]).done();
            run([kind, test, text(&path)]).done();
        }
    }
    let accented = folder.path().join("cafe\u{301}-layout.ron");
    let content = std::fs::read_to_string(accented).unwrap();
    assert!(
        content.contains("name: \"cafe\u{301}-layout\""),
        "{content}"
    );
}

#[test]
fn a_new_glove_is_tried_with_the_protocol_of_the_one_that_it_copies() {
    let folder = tempfile::tempdir().unwrap();
    for (glove, source) in [
        ("unam-hc11", "--source serial:/dev/ttyUSB0 --glove "),
        (
            "lucidgloves",
            "--source 'serial:/dev/ttyUSB0?protocol=lucidgloves' --glove ",
        ),
    ] {
        let path = folder.path().join(glove);
        let written = run(["glove", "new", text(&path), "--from", glove]).done();
        written.printed(source);
    }
}

#[test]
fn a_new_script_is_played_on_the_layout_that_it_is_for_whatever_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let layout = format!("{}.ron", text(&folder.path().join("PROFILE")));
    run(["layout", "new", &layout, "--from", "media"]).done();
    let script = folder.path().join("tour");
    let written = run(["script", "new", text(&script), "--from", &layout]).done();
    written.printed(&format!("ademan demo --layout {layout} --script "));
}
