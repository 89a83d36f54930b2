//! `ademan text`: language models are built and used.

use std::io::Write;
use std::process::Stdio;

use super::{Ended, ademan, file, run, text};

/// Runs `ademan text decode` with the positions of taps.
fn decode(model: &str, taps: &str) -> Ended {
    let mut command = ademan(["text", "decode", model, "--layout", "qwerty-flat"]);
    let command = command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    // A program that refuses its arguments does not read.
    let _ = stdin.write_all(taps.as_bytes());
    drop(stdin);
    child.wait_with_output().expect("the program ends").into()
}

#[test]
fn a_model_is_built_alike_twice_and_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = file(&folder, "words.txt", "hello\t5\nworld\nzebra\t0.1\n");
    let sentences = file(&folder, "text.txt", "Hello world.\nHello world.\n");
    let model = folder.path().join("my.adm");
    let arguments = [
        "text",
        "build",
        "--words",
        &words,
        "--text",
        &sentences,
        "-o",
        text(&model),
    ];
    let first = run(arguments).done();
    first.printed("3 words, 2 pairs of words");
    let bytes = std::fs::read(&model).expect("a model");
    run(arguments).done();
    assert!(std::fs::read(&model).expect("a model") == bytes);
    let used = decode(text(&model), "").done();
    assert_eq!(used.out, "");
}

#[cfg(unix)]
#[test]
fn a_model_stays_if_there_is_no_room_for_another_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let letters = || 'a'..='z';
    let pairs = letters().flat_map(|first| letters().map(move |second| (first, second)));
    let many = pairs.flat_map(|(first, second)| {
        letters().map(move |third| format!("{first}{second}{third}\n"))
    });
    let words = file(&folder, "words.txt", "hello\n");
    let many = file(&folder, "many.txt", many.collect::<String>());
    let model = folder.path().join("my.adm");
    let build =
        |list: &str| ["text", "build", "--words", list, "-o", text(&model)].map(str::to_owned);
    run(build(&words)).done();
    let bytes = std::fs::read(&model).expect("a model");
    let arguments = build(&many);
    let ended =
        crate::lab::run_with_small_files(&arguments.each_ref().map(String::as_str)).exited(2);
    ended.reported("cannot write");
    assert!(std::fs::read(&model).expect("the old model") == bytes);
    let left = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 3, "the two lists and the model");
}

#[test]
fn files_that_are_no_model_and_lines_that_are_no_taps_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let foreign = file(&folder, "foreign.adm", "words");
    let ended = decode(&foreign, "").exited(2);
    ended.reported("not a language model");
    let unknown = decode("fr", "").exited(2);
    unknown.reported("cannot read fr: there is no such file; the languages are `en` and `es`");
    let absent = decode("absent.adm", "");
    absent.reported("cannot read absent.adm");
    let bad_tap = decode("en", "1 2\n1 2 3\n").exited(2);
    bad_tap.reported("line 2 is not a tap");
}

#[test]
fn taps_on_the_keys_of_a_layout_give_candidates() {
    // Three taps near one place, far from the edges: whatever the keys are, something is read, and what was typed is in it.
    let ended = decode("en", "0 0\n1 1\n-1 0\n\n0 0\n").done();
    let texts: Vec<&str> = ended.out.split("\n\n").collect();
    assert_eq!(
        texts.iter().filter(|text| !text.trim().is_empty()).count(),
        2,
        "{}",
        ended.out
    );
    let first = texts[0].lines().next().expect("a candidate");
    let (score, _) = first.split_once('\t').expect("a score");
    assert!(score.parse::<f32>().expect("a number") < 0.0);
}

#[test]
fn a_model_does_not_replace_the_words_that_it_is_built_from() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = file(&folder, "w.txt", "hello\t5\n");
    let ended = run(["text", "build", "--words", &words, "-o", &words]).exited(2);
    ended.reported("name another file");
    assert_eq!(std::fs::read_to_string(&words).unwrap(), "hello\t5\n");
}

#[test]
fn lines_of_a_list_that_are_no_words_are_counted_and_a_list_without_words_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("my.adm");
    let build = |list: &str| run(["text", "build", "--words", list, "-o", text(&model)]);
    let foreign = file(&folder, "foreign.txt", " word=de,f=225\n word=la,f=216\n");
    let refused = build(&foreign).exited(2);
    refused.reported("foreign.txt is not a list of words");
    assert!(!model.exists());
    let mixed = file(&folder, "mixed.txt", "hello 5\ne-mail 3\n\nworld\n");
    let built = build(&mixed).done();
    built.printed("2 words");
    built.reported("left out 1 of 3 lines");
}

#[test]
fn a_model_in_the_arpa_format_is_mixed_in_and_its_wrong_lines_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = file(&folder, "words.txt", "hello\t5\nworld\nzebra\t0.1\n");
    let other = "\\data\\\nngram 1=2\nngram 2=1\n\n\\1-grams:\n-0.3 hello -0.1\n-0.3 zebra\n\n\\2-grams:\n-0.2 hello zebra\n\n\\end\\\n";
    let arpa = file(&folder, "other.arpa", other);
    let model = folder.path().join("my.adm");
    let build = |list: &str, mixed: &str| {
        run([
            "text",
            "build",
            "--words",
            list,
            "--arpa",
            mixed,
            "-o",
            text(&model),
        ])
    };
    let built = build(&words, &arpa).done();
    built.printed("3 words, 1 pairs of words");

    let broken = other.replace("-0.2 hello", "much hello");
    let broken = build(&words, &file(&folder, "broken.arpa", &broken)).exited(2);
    let number = "broken.arpa: line 10: it does not start with a logarithm";
    broken.reported(number);
    let heavy = build(&file(&folder, "heavy.txt", "hello 5\nworld 1,000\n"), &arpa).exited(2);
    heavy.reported("heavy.txt: line 2: its weight is not a number");
    let replaced = run([
        "text", "build", "--words", &words, "--arpa", &arpa, "-o", &arpa,
    ]);
    replaced.reported("name another file");
}
