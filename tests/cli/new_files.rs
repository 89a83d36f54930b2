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
