//! Security requirements that the packaged files and the lists of dependencies show.

use std::fs;

fn read(path: &str) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[test]
fn the_udev_rules_give_uinput_to_its_own_group_or_the_seat_and_never_to_input() {
    for (file, grant) in [
        ("packaging/60-ademan.rules", "GROUP=\"uinput\""),
        ("packaging/60-ademan-uaccess.rules", "TAG+=\"uaccess\""),
    ] {
        let text = read(file);
        let mut rules: Vec<_> = text.lines().collect();
        rules.retain(|line| !line.starts_with('#'));
        for open in ["GROUP=\"input\"", "MODE=\"0666\"", "MODE=\"666\""] {
            assert!(!rules.concat().contains(open), "{file}: {open}");
        }
        rules.retain(|rule| rule.contains("KERNEL==\"uinput\""));
        assert_eq!(rules.len(), 1, "{file}");
        assert!(rules[0].contains(grant), "{file}: {rules:?}");
    }
}

#[test]
fn all_dependencies_come_from_the_registry_with_a_checksum() {
    for lock in ["Cargo.lock", "benches/peers/Cargo.lock"] {
        let text = read(lock);
        let packages: Vec<_> = text.split("[[package]]\nname = ").skip(1).collect();
        assert!(packages.len() > 50, "{lock}");
        for package in packages {
            let is_known = package.starts_with("\"ademan") || package.contains("checksum = ");
            assert!(is_known, "{lock}: {package}");
        }
    }
    assert!(read("deny.toml").contains("unknown-registry = \"deny\"\nunknown-git = \"deny\""));
    assert!(read(".ci/run").contains("cargo deny check"));
}
