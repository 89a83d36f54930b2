//! `ademan lab plan`, `run` and `merge`: a run in parts gives what a run in one piece gives, whatever is interrupted.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use super::{ademan, run, run_to_end, text};

const CONDITIONS: [&str; 10] = [
    "--people", "7", "--count", "2", "--tier", "T1", "--seed", "3", "--source", "glove",
];

/// A folder with a plan of these layouts in four shards.
fn plan(folder: &Path, layouts: &[&str]) -> PathBuf {
    let sweep = folder.join("sweep");
    let place = ["--to", text(&sweep), "--shards", "4"];
    let start = ["lab", "plan"];
    let arguments = start.iter().chain(layouts).chain(&CONDITIONS);
    let ended = run(arguments.chain(&place)).done();
    ended.printed("4 shards of 7 people");
    sweep
}

fn shard(folder: &Path, number: usize) -> PathBuf {
    folder.join(format!("shard-{number:05}.json"))
}

/// The result of the same run in one piece.
fn in_one_piece(folder: &Path, command: &str, layouts: &[&str]) -> (String, String) {
    let path = folder.join("whole.json");
    let output = ["--json", text(&path)];
    let start = ["lab", command];
    let arguments = start.iter().chain(layouts).chain(&CONDITIONS);
    let ended = run(arguments.chain(&output)).done();
    (fs::read_to_string(path).expect("a result"), ended.out)
}

fn merged(sweep: &Path) -> (String, String) {
    let path = sweep.with_file_name("merged.json");
    let ended = run(["lab", "merge", text(sweep), "--json", text(&path)]).done();
    (fs::read_to_string(path).expect("a result"), ended.out)
}

#[test]
fn shards_in_any_order_give_the_result_of_one_run_byte_by_byte() {
    let folder = tempfile::tempdir().expect("a folder");
    let layouts = ["qwerty-flat", "qwerty-arc"];
    let sweep = plan(folder.path(), &layouts);
    // The same plan again is no error, and another one in its place is.
    plan(folder.path(), &layouts);
    let other = ["lab", "plan", "numpad", "--to", text(&sweep)];
    let ended = run(other).exited(2);
    ended.reported("is another plan");

    for number in ["3", "0"] {
        run(["lab", "run", text(&sweep), number, "--jobs", "2"]).done();
    }
    let mode = fs::metadata(shard(&sweep, 3))
        .expect("scores")
        .permissions();
    assert_eq!(mode.mode() & 0o777, 0o600);
    let early = run(["lab", "merge", text(&sweep)]).exited(1);
    early.reported("2 of 4 shards have no scores yet: 1 2;");

    let partial = folder.path().join("partial.json");
    let arguments = [
        "lab",
        "merge",
        text(&sweep),
        "--partial",
        "--json",
        text(&partial),
    ];
    let partial_end = run(arguments).done();
    partial_end.printed("PARTIAL: 3 of 7 people; 2 of 4 shards are missing");
    run(["lab", "verify", text(&partial)]).done();

    let before = fs::read(shard(&sweep, 0)).expect("scores");
    let resumed = run(["lab", "run", text(&sweep)]).done();
    resumed.reported("shard-00000.json: done before");
    assert_eq!(fs::read(shard(&sweep, 0)).expect("scores"), before);
    let whole = in_one_piece(folder.path(), "compare", &layouts);
    assert_eq!(merged(&sweep), whole);
    assert_eq!(merged(&sweep), whole, "merged twice");
}

#[test]
fn layouts_of_both_kinds_are_not_planned_and_merged_scores_of_them_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let mixed = folder.path().join("mixed");
    let refused = run(["lab", "plan", "qwerty-flat", "arrows", "--to", text(&mixed)]).exited(2);
    refused.reported("scored by tasks");

    // A plan of both, as no command makes it.
    let sweep = plan(folder.path(), &["qwerty-flat"]);
    let others = folder.path().join("others");
    fs::create_dir(&others).expect("a folder");
    let other = plan(&others, &["arrows"]);
    let read = |path: &Path| {
        let written = fs::read_to_string(path.join("plan.json")).expect("a plan");
        serde_json::from_str::<serde_json::Value>(&written).expect("JSON")
    };
    let (mut both, second) = (read(&sweep), read(&other));
    let runs = both["runs"].as_array_mut().expect("runs");
    runs.push(second["runs"][0].clone());
    fs::write(sweep.join("plan.json"), both.to_string()).expect("a plan");
    run(["lab", "run", text(&sweep)]).done();
    let json = folder.path().join("both.json");
    let merged = run(["lab", "merge", text(&sweep), "--json", text(&json)]).exited(2);
    merged.reported("cannot compare");
    merged.printed("tasks done, %");
    assert!(json.exists());
}

#[test]
fn killed_shards_are_run_again_and_the_result_is_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let sweep = plan(folder.path(), &["qwerty-flat"]);
    let start = |number: usize| {
        let mut command = ademan(["lab", "run", text(&sweep), &number.to_string()]);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().expect("the program starts")
    };
    // At any moment of their work.
    for (number, wait) in [(0, 5), (1, 40), (2, 120)] {
        let mut shard = start(number);
        thread::sleep(Duration::from_millis(wait));
        shard.kill().expect("it is our own");
        shard.wait().expect("it has ended");
    }
    // As after a kill in the middle of a write on a file system that keeps no order.
    fs::write(shard(&sweep, 1), "{\"format\":\"ademan-lab-sh").expect("a cut file");
    let ended = run(["lab", "merge", text(&sweep)]).exited(2);
    ended.reported("it cannot be read");
    let mut all: Vec<_> = (0..4).map(start).collect();
    for shard in &mut all {
        assert!(shard.wait().expect("it ends").success());
    }
    assert_eq!(
        merged(&sweep),
        in_one_piece(folder.path(), "score", &["qwerty-flat"])
    );
}

#[test]
fn foreign_shards_and_plans_of_other_versions_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let sweep = plan(folder.path(), &["numpad"]);
    let other = folder.path().join("other");
    fs::create_dir(&other).expect("a folder");
    let other = plan(&other, &["qwerty-flat"]);
    run(["lab", "run", text(&other), "1"]).done();
    fs::copy(shard(&other, 1), shard(&sweep, 1)).expect("a copy");
    for command in [
        &["lab", "merge", text(&sweep), "--partial"][..],
        &["lab", "run", text(&sweep), "1"],
    ] {
        let ended = run(command).exited(2);
        ended.reported("it belongs to another plan");
    }
    fs::rename(shard(&other, 1), shard(&other, 2)).expect("a new name");
    let ended = run(["lab", "merge", text(&other), "--partial"]);
    ended.reported("it does not hold the people of shard 2");
    let out_of_range = run(["lab", "run", text(&other), "4"]);
    out_of_range.reported("the plan has shards 0 to 3");

    let path = sweep.join("plan.json");
    let whole = fs::read_to_string(&path).expect("a plan");
    for (from, to, words) in [
        (
            "\"format_version\": 2",
            "\"format_version\": 1",
            "version 1 of the format",
        ),
        (
            "\"program_version\": \"",
            "\"program_version\": \"9.",
            "of the program wrote it",
        ),
        (
            "\"shards\": 4",
            "\"shards\": 0",
            "an impossible number of shards",
        ),
        (
            "\"people\": ",
            "\"people\": 9000000000000000",
            "more people or phrases than a run may have",
        ),
        ("ademan-lab-plan", "ademan-lab-result", "its format is not"),
        ("the kettle", "the teapot", "do not have the hash"),
        ("{", "", "cannot be read"),
    ] {
        fs::write(&path, whole.replacen(from, to, 1)).expect("a changed plan");
        let changed = run(["lab", "run", text(&sweep), "0"]).exited(2);
        assert!(changed.err.contains(words), "{words}: {}", changed.err);
    }
}

#[test]
fn a_shard_that_cannot_be_written_says_so_and_the_others_stay() {
    let folder = tempfile::tempdir().expect("a folder");
    let sweep = plan(folder.path(), &["numpad"]);
    run(["lab", "run", text(&sweep), "0"]).done();
    let before = fs::read(shard(&sweep, 0)).expect("scores");
    // The limit of the size of files stands for a full disk: both fail in the middle of a write.
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" lab run \"$1\" 1";
    let mut shell = Command::new("bash");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_ademan"), text(&sweep)]);
    let ended = run_to_end(&mut shell).exited(1);
    ended.reported("run this one again: ademan lab run");
    assert!(!shard(&sweep, 1).exists());
    assert_eq!(fs::read(shard(&sweep, 0)).expect("scores"), before);
    let left = fs::read_dir(&sweep).expect("the folder").count();
    assert_eq!(left, 2, "the plan and a shard");
}

#[test]
fn gnu_parallel_runs_what_is_missing_after_half_of_the_shards_were_killed() {
    let is_here = Command::new("parallel").arg("--version").output();
    if !is_here.is_ok_and(|it| String::from_utf8_lossy(&it.stdout).contains("GNU parallel")) {
        println!("SKIPPED: GNU parallel is not installed");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let sweep = plan(folder.path(), &["qwerty-flat"]);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/lab/parallel");
    // A program that kills itself for two of the four shards.
    let killer = super::file(
        &folder,
        "killer",
        format!(
            "#!/bin/bash\ncase $4 in 1|2) kill -KILL $$;; esac\nexec {} \"$@\"\n",
            env!("CARGO_BIN_EXE_ademan")
        ),
    );
    fs::set_permissions(&killer, fs::Permissions::from_mode(0o755)).expect("it is ours");
    let with = |program: &str| {
        let mut command = Command::new(&script);
        command
            .arg(&sweep)
            .env("ADEMAN", program)
            .env("HOME", folder.path());
        command.output().expect("the script starts")
    };
    let ended = with(&killer);
    assert!(!ended.status.success());
    assert!(shard(&sweep, 0).exists() && shard(&sweep, 3).exists());
    assert!(!shard(&sweep, 1).exists() && !shard(&sweep, 2).exists());
    let resumed = with(env!("CARGO_BIN_EXE_ademan"));
    // The program says on standard error that a shard was done before.
    let said = [resumed.stdout, resumed.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    assert!(resumed.status.success(), "{said}");
    assert!(said.contains("shard-00001.json: "), "{said}");
    assert!(
        !said.contains("shard-00000"),
        "only what is missing: {said}"
    );
    assert_eq!(
        merged(&sweep),
        in_one_piece(folder.path(), "score", &["qwerty-flat"])
    );
}
