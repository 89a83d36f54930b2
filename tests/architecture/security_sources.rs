//! What can be read off the sources and the files that are shipped.

use crate::security::{files, read, root};

/// The code of the engine, without its tests and comments.
fn engine() -> Vec<(String, String)> {
    let of_engine = |name: &String| !name.starts_with("bin/");
    files(&root().join("src"), ".rs")
        .into_iter()
        .map(|(path, text)| {
            let name = path.strip_prefix(root().join("src")).expect("below src");
            let code = text.split("#[cfg(test)]").next().expect("a first part");
            let lines = code
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"));
            (
                name.display().to_string(),
                lines.collect::<Vec<_>>().join("\n"),
            )
        })
        .filter(|(name, _)| of_engine(name) && !name.ends_with("tests.rs"))
        .collect()
}

/// The files whose code has this in it.
fn with(what: &str) -> Vec<String> {
    let found = engine().into_iter().filter(|(_, code)| code.contains(what));
    let mut names: Vec<_> = found.map(|(name, _)| name).collect();
    names.sort();
    names
}

#[test]
fn nothing_but_the_guardian_is_ever_started() {
    assert_eq!(with("Command::new("), ["output/guardian/guard.rs"]);
    for word in ["libloading", "dlopen", ".exec("] {
        assert_eq!(with(word), [""; 0], "{word}");
    }
}

#[test]
fn no_file_that_people_write_reads_the_environment() {
    // Where sockets, displays and sessions are is said by the environment; what is in files is taken as it stands.
    let may = ["doctor/", "output/", "control/", "control.rs"];
    for (name, code) in engine() {
        let asks = code.contains("env::var");
        assert!(
            !asks || may.iter().any(|place| name.starts_with(place)),
            "{name}"
        );
    }
    assert!(!with("env::var").is_empty(), "it is found where it is");
}

#[test]
fn there_is_no_unsafe_code_in_the_program() {
    assert!(read("Cargo.toml").contains("unsafe_code = \"deny\""));
    for (path, text) in files(&root().join("src"), ".rs") {
        let lines: Vec<_> = text.lines().map(str::trim_start).collect();
        let is_code = |line: &&&str| !line.starts_with("//");
        let found: Vec<_> = lines
            .iter()
            .filter(is_code)
            .filter(|line| line.contains("unsafe "))
            .collect();
        assert!(found.is_empty(), "{}: {found:?}", path.display());
    }
}

#[test]
fn the_rules_give_uinput_to_a_group_of_its_own_or_to_the_seat_and_never_to_input() {
    for (file, right) in [
        ("packaging/60-ademan.rules", "GROUP=\"uinput\""),
        ("packaging/60-ademan-uaccess.rules", "TAG+=\"uaccess\""),
    ] {
        let text = read(file);
        let rules: Vec<_> = text.lines().filter(|line| !line.starts_with('#')).collect();
        let of_uinput: Vec<_> = rules
            .iter()
            .filter(|rule| rule.contains("KERNEL==\"uinput\""))
            .collect();
        assert_eq!(of_uinput.len(), 1, "{file}");
        assert!(of_uinput[0].contains(right), "{file}: {of_uinput:?}");
        for rule in rules {
            assert!(!rule.contains("GROUP=\"input\""), "{file}: {rule}");
            let is_open = rule.contains("MODE=\"0666\"") || rule.contains("MODE=\"666\"");
            assert!(!is_open, "{file}: {rule}");
        }
    }
}

#[test]
fn what_is_built_is_what_the_lock_file_says() {
    let lock = read("Cargo.lock");
    let packages: Vec<_> = lock.split("[[package]]").skip(1).collect();
    assert!(packages.len() > 50);
    for package in packages {
        let is_own = package.contains("name = \"ademan\"");
        assert!(is_own || package.contains("checksum = "), "{package}");
    }
    let rules = read("deny.toml");
    for rule in ["unknown-registry = \"deny\"", "unknown-git = \"deny\""] {
        assert!(rules.contains(rule), "{rule}");
    }
    assert!(read(".ci/run").contains("cargo deny check"));
}
