//! Completion in real shells: bash, zsh and fish.

use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use super::{run, text};

/// Lines to complete, with candidates that must be offered, and some that must not.
const CASES: [(&str, &[&str], &[&str]); 10] = [
    (
        "ademan run --layout qwerty-a",
        &["qwerty-arc"],
        &["qwerty-flat", "note.txt"],
    ),
    (
        "ademan run --layout my-l",
        &["my-layout.ron"],
        &["my-layout.txt"],
    ),
    ("ademan layout show sw", &["switches"], &["sw.txt"]),
    ("ademan run --glove unam-hc11-l", &["unam-hc11-left"], &[]),
    ("ademan run --source ty", &["typist:"], &["tcp:"]),
    ("ademan run --source file:my-b", &["my-bytes.bin"], &[]),
    (
        "ademan run --output desktop,tr",
        &["desktop,transcript"],
        &[],
    ),
    ("ademan replay my-r", &["my-recording.mcap"], &[]),
    ("ademan lay", &["layout", "layouts"], &["run"]),
    ("ademan ctl nex", &["next-profile"], &[]),
];

/// A folder with the program, files and completion scripts.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in [
        "my-layout.ron",
        "my-layout.txt",
        "my-bytes.bin",
        "my-recording.mcap",
        "note.txt",
        "sw.txt",
    ] {
        std::fs::write(folder.path().join(file), "").unwrap();
    }
    std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_ademan"), folder.path().join("ademan")).unwrap();
    for shell in ["bash", "zsh", "fish"] {
        let script = run(["completions", shell]).done().out;
        std::fs::write(folder.path().join(format!("_{shell}")), script).unwrap();
    }
    folder
}

/// Runs a script of a shell in the folder. `None` if the shell is not installed.
fn shell(folder: &Path, program: &str, arguments: &[&str], script: &str) -> Option<String> {
    let path = std::env::var("PATH").unwrap_or_default();
    // A shell that waits for what does not come fails the test.
    let output = Command::new("timeout")
        .args(["60", program])
        .args(arguments)
        .arg(script)
        .current_dir(folder)
        .env("PATH", format!("{}:{path}", text(folder)))
        .env("HOME", folder)
        .env("XDG_CONFIG_HOME", folder)
        .env("TERM", "dumb")
        .stdin(Stdio::null())
        .output();
    let output = output.expect("coreutils are installed");
    if output.status.code() == Some(127) {
        println!("SKIPPED: {program} is not installed");
        return None;
    }
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{program}: {errors}");
    Some(String::from_utf8_lossy(&output.stdout).into_owned() + &errors)
}

fn check(program: &str, line: &str, found: &[String], offered: &[&str], not_offered: &[&str]) {
    for candidate in offered {
        let is_offered = found
            .iter()
            .any(|it| it == candidate || it.ends_with(&format!(":{candidate}")));
        assert!(
            is_offered,
            "{program} does not complete `{line}` with {candidate}: {found:?}"
        );
    }
    for candidate in not_offered {
        assert!(
            !found.iter().any(|it| it == candidate),
            "{program}: `{line}`: {found:?}"
        );
    }
}

#[test]
fn bash_completes_names_files_and_sources() {
    let folder = folder();
    for (line, offered, not_offered) in CASES {
        // As the shell calls it: words are split at colons, too.
        let script = format!(
            "source ./_bash; line='{line}'; COMP_LINE=$line; COMP_POINT=${{#line}}; \
             _ademan ademan; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        );
        let Some(output) = shell(folder.path(), "bash", &["--norc", "-c"], &script) else {
            return;
        };
        let found: Vec<String> = output.lines().map(str::to_owned).collect();
        check("bash", line, &found, offered, not_offered);
    }
}

#[test]
fn fish_completes_names_files_and_sources() {
    let folder = folder();
    for (line, offered, not_offered) in CASES {
        let script = format!("source ./_fish; complete -C '{line}'");
        let Some(output) = shell(folder.path(), "fish", &["--no-config", "-c"], &script) else {
            return;
        };
        let words = output
            .lines()
            .map(|line| line.split('\t').next().unwrap_or_default());
        let found: Vec<String> = words.map(str::to_owned).collect();
        check("fish", line, &found, offered, not_offered);
    }
}

/// Types a line and Tab into an interactive zsh on a terminal of its own, and prints the line as zsh completed it.
const ZSH: &str = r#"
zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell "PS1= RPS1= ; unsetopt zle_bracketed_paste; autoload -U compinit && compinit -u -D; source ./_zsh"
zpty -w shell "done-line() { print -r -- \"<\$BUFFER>\"; zle kill-buffer; }; zle -N done-line; bindkey '^X' done-line; print rea''dy"
output=""
until [[ $output == *ready* ]] { zpty -r shell part; output+=$part }
zpty -w -n shell "$LINE"$'\t\x18'
output=""
until [[ $output == *'<ademan '*'>'* ]] { zpty -r shell part; output+=$part }
zpty -d shell
[[ $output =~ '<(ademan [^>]*)>' ]] && print -r -- $match[1]
"#;

#[test]
fn zsh_completes_names_files_and_sources() {
    let folder = folder();
    // A single candidate is inserted, which is visible in the line.
    for (line, offered, _) in CASES.iter().filter(|(_, offered, _)| offered.len() == 1) {
        let script = format!("LINE='{line}'\n{ZSH}");
        let Some(output) = shell(folder.path(), "zsh", &["-f", "-c"], &script) else {
            return;
        };
        let completed = output.trim().rsplit([' ', ':']).next().unwrap_or_default();
        let completed = match output.trim().ends_with(':') {
            true => output.trim().rsplit(' ').next().unwrap_or_default(),
            false => completed,
        };
        check("zsh", line, &[completed.to_owned()], offered, &[]);
    }
}
