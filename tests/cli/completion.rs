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

/// A name that ends a command and starts others.
const COMMANDS: &str = "zz;touch PWNED;$(touch PWNED) it's & \"`touch PWNED`.ron";

/// A name that a terminal acts on, and whose second line is a name.
const INVISIBLE: &str = "zx\u{202e}\u{9b}2J\nzx;touch PWNED.ron";

/// A folder with the program, files and completion scripts.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in [
        COMMANDS,
        INVISIBLE,
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
        // The shell calls it like this: words are split at colons, too.
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

/// Asserts that the last word of a completed line is the name of the file, and that the line has run no other command.
fn check_word(folder: &Path, line: &str, word: &str, prefix: &str) {
    let created = folder.join("PWNED").exists();
    assert!(!created, "`{line}` runs a command of the name");
    assert_eq!(
        word.trim_end_matches('\n'),
        format!("{prefix}{COMMANDS}"),
        "{line}"
    );
}

#[test]
fn bash_quotes_the_names_that_it_inserts() {
    let folder = folder();
    // The line, the part that Bash keeps, the quote that it closes, and what precedes the name in the word.
    for (line, kept, quote, prefix) in [
        ("ademan run zz", "ademan run ", "", ""),
        (r"ademan run zz\;to", "ademan run ", "", ""),
        ("ademan run 'zz;to", "ademan run '", "'", ""),
        ("ademan run \"zz;to", "ademan run \"", "\"", ""),
        (
            "ademan run --source file:zz",
            "ademan run --source file:",
            "",
            "file:",
        ),
        (
            "ademan run --layout=zz",
            "ademan run --layout=",
            "",
            "--layout=",
        ),
    ] {
        let script = format!(
            "source ./_bash; COMP_LINE={}; COMP_POINT=${{#COMP_LINE}}; _ademan ademan; \
             eval \"set -- \"{}\"${{COMPREPLY[0]}}\"{}; printf '%s\\n' \"${{@: -1}}\"",
            quoted(line),
            quoted(kept),
            quoted(quote)
        );
        let Some(word) = shell(folder.path(), "bash", &["--norc", "-c"], &script) else {
            return;
        };
        check_word(folder.path(), line, &word, prefix);
    }
}

/// Returns a text in single quotes.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}

#[test]
fn fish_quotes_the_names_that_it_inserts() {
    let folder = folder();
    for (line, prefix) in [
        ("ademan run zz", ""),
        (r"ademan run zz\;to", ""),
        ("ademan run --source file:zz", "file:"),
    ] {
        let script = format!(
            "source ./_fish; eval set word (complete --escape -C {}); printf '%s\\n' $word",
            quoted(line).replace(r"\", r"\\")
        );
        let Some(word) = shell(folder.path(), "fish", &["--no-config", "-c"], &script) else {
            return;
        };
        check_word(folder.path(), line, &word, prefix);
    }
}

#[test]
fn no_shell_offers_a_name_that_a_terminal_acts_on() {
    let folder = folder();
    let bash = "source ./_bash; COMP_LINE='ademan run zx'; COMP_POINT=13; _ademan ademan; \
                printf '%s' \"${COMPREPLY[@]}\"";
    for (program, arguments, script) in [
        ("bash", ["--norc", "-c"], bash),
        (
            "fish",
            ["--no-config", "-c"],
            "source ./_fish; complete -C 'ademan run zx'",
        ),
    ] {
        let Some(offered) = shell(folder.path(), program, &arguments, script) else {
            continue;
        };
        assert_eq!(offered, "", "{program}");
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
            .map(|offer| offer.split('\t').next().unwrap_or_default());
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
fn zsh_quotes_the_names_that_it_inserts() {
    let folder = folder();
    for (line, prefix) in [
        ("ademan run zz", ""),
        (r"ademan run zz\;to", ""),
        ("ademan run --source file:zz", "file:"),
    ] {
        let script = format!("LINE={}\n{ZSH}", quoted(line));
        let Some(completed) = shell(folder.path(), "zsh", &["-f", "-c"], &script) else {
            return;
        };
        let last_word = format!("set -- {completed}\nprint -r -- $@[-1]");
        let word = shell(folder.path(), "zsh", &["-f", "-c"], &last_word);
        check_word(folder.path(), line, &word.expect("it is installed"), prefix);
    }
}

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
        let completed = if output.trim().ends_with(':') {
            output.trim().rsplit(' ').next().unwrap_or_default()
        } else {
            completed
        };
        check("zsh", line, &[completed.to_owned()], offered, &[]);
    }
}
