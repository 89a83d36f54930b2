//! Help and manual pages: every subcommand has an example.

use std::fs;

use super::{run, text};

/// Returns the manual pages with their names.
fn pages() -> Vec<(String, String)> {
    let folder = tempfile::tempdir().unwrap();
    run(["man", text(folder.path())]).done();
    let pages = fs::read_dir(folder.path()).unwrap().flatten();
    let pages = pages.map(|page| {
        let name = page.file_name().into_string().unwrap();
        (name, fs::read_to_string(page.path()).unwrap())
    });
    pages.collect()
}

#[test]
fn every_manual_page_has_an_example_of_its_command() {
    let pages = pages();
    assert!(pages.len() > 35, "{}", pages.len());
    for (name, page) in pages {
        let (_, examples) = page
            .split_once(".SH EXAMPLES\n")
            .unwrap_or_else(|| panic!("{name} has no examples: {page}"));
        let command = name.trim_end_matches(".1").replacen('-', " ", 1);
        let command = if command.starts_with("ademan ctl-") {
            command.replacen("ctl-", "ctl ", 1)
        } else {
            command
        };
        let words: Vec<&str> = command.split(' ').collect();
        let examples = examples.replace(r"\-", "-");
        let has_example = examples.lines().any(|line| {
            let line = line.trim_start();
            line.starts_with(&words.join(" ")) || line.starts_with(&command.replace('-', " "))
        });
        assert!(has_example || words.len() == 1, "{name}: {examples}");
        assert!(!page.contains(".SH EXTRA"), "{name}");
    }
}

#[test]
fn each_request_of_ctl_has_an_example() {
    for request in ["state", "nudge", "tilt", "scale", "profile", "subscribe"] {
        let help = run(["ctl", request, "--help"]).done().out;
        let expected = format!("Example: ademan ctl {request}");
        assert!(help.contains(&expected), "{help}");
    }
    let nudge = run(["ctl", "nudge", "--help"]).done().out;
    assert!(nudge.contains("ademan ctl nudge 0 0 -5"), "{nudge}");
}

#[test]
fn a_source_without_an_address_has_one_colon() {
    let help = run(["run", "--help"]).done().out;
    for (source, summary) in [
        ("openxr", "hands that an OpenXR runtime"),
        ("stdin", "bytes of a stream"),
    ] {
        assert!(!help.contains(&format!("{source}::")), "{help}");
        let mut lines = help.lines();
        let start = format!("- {source}: ");
        assert!(
            lines.any(|line| line.contains(&start) && line.contains(summary)),
            "{help}"
        );
    }
}
