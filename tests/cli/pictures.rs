//! `ademan layout show` with pictures: files and standard output.

use std::fs;

#[cfg(feature = "pictures")]
use super::ademan;
use super::{run, text};

#[test]
fn two_files_of_one_name_are_refused_before_one_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("z.out");
    let same = folder
        .path()
        .join("../")
        .join(folder.path().file_name().unwrap());
    for other in [&path, &same.join("z.out")] {
        let both = ["--svg", text(&path), "--json", text(other), "--overwrite"];
        let refused = run([&["layout", "show", "game"], &both[..]].concat()).exited(2);
        refused.reported("is named for two files");
        assert!(!path.exists());
    }
}

#[test]
fn a_picture_goes_to_a_file_or_to_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let svg = folder.path().join("game.svg");
    let html = folder.path().join("game.html");
    let both = [
        "layout",
        "show",
        "game",
        "--svg",
        text(&svg),
        "--html",
        text(&html),
    ];
    let ended = run(both).done();
    assert!(ended.out.is_empty(), "{}", ended.out);
    assert!(
        ended.err.contains("wrote") && ended.err.contains("game.html"),
        "{}",
        ended.err
    );
    let piped = run(["layout", "show", "game", "--svg", "-"]).done();
    assert_eq!(piped.out, fs::read_to_string(&svg).unwrap());
    assert_eq!(piped.err, "");
    assert!(
        fs::read_to_string(&html)
            .unwrap()
            .starts_with("<!DOCTYPE html>")
    );
}

#[test]
fn a_file_is_overwritten_on_request_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.svg");
    fs::write(&path, "mine").unwrap();
    let refused = run(["layout", "show", "arrows", "--svg", text(&path)]).exited(2);
    refused.reported("add --overwrite");
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    run([
        "layout",
        "show",
        "arrows",
        "--svg",
        text(&path),
        "--overwrite",
    ])
    .done();
    assert!(fs::read_to_string(&path).unwrap().starts_with("<svg"));
    let target = text(folder.path());
    let folder_refused = run(["layout", "show", "arrows", "--html", target, "--overwrite"]);
    folder_refused.reported("it is a folder");
}

#[test]
fn a_picture_replaces_no_file_that_it_is_drawn_from() {
    let folder = tempfile::tempdir().unwrap();
    let original = fs::read_to_string("layouts/keyboards/arrows.ron").unwrap();
    let layout = super::file(&folder, "mine.ron", &original);
    let person = super::file(&folder, "me.ron", "Person(side: \"left\")");
    let setup = super::file(&folder, "setup.ron", "Setup(person: \"me.ron\")");
    for path in [&layout, &setup, &person] {
        let show = ["layout", "show", &layout, "--setup", &setup];
        let refused = run([&show[..], &["--svg", path, "--overwrite"]].concat()).exited(2);
        refused.reported("is read by this command");
    }
    assert_eq!(fs::read_to_string(&layout).unwrap(), original);
}

#[cfg(unix)]
#[test]
fn no_part_of_a_picture_is_left_on_a_full_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board.svg");
    let show = ["layout", "show", "qwerty-flat", "--svg", text(&path)];
    let full = super::lab::run_with_small_files(&show).exited(2);
    full.reported("board.svg: File too large");
    assert!(!path.exists(), "a part of the picture is left");
}

#[test]
fn a_setup_chooses_the_hand_that_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let setup = super::file(
        &folder,
        "short.ron",
        "Setup(arm: Measured(hand_length_mm: 150, forearm_length_mm: 200))",
    );
    let default = run(["layout", "show", "qwerty-flat", "--svg", "-"])
        .done()
        .out;
    let short = run([
        "layout",
        "show",
        "qwerty-flat",
        "--svg",
        "-",
        "--setup",
        &setup,
    ])
    .done()
    .out;
    assert_ne!(default, short);
    let hand = ["layout", "show", "qwerty-flat", "--svg", "-", "--hand"];
    let same = run([&hand[..], &["150,200"]].concat()).done().out;
    assert!(short == same, "the same hand, by its lengths");
}

#[cfg(not(feature = "pictures"))]
#[test]
fn without_the_feature_png_and_pdf_are_refused_with_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    for option in ["--png", "--pdf"] {
        let path = folder.path().join("board");
        let refused = run(["layout", "show", "arrows", option, text(&path)]);
        assert_ne!(refused.code, Some(0));
        let error = refused.err;
        assert!(error.contains("--features pictures"), "{option}: {error}");
        assert!(!path.exists());
    }
    println!("SKIPPED: PNG and PDF of all layouts; run with --features pictures");
}

#[cfg(feature = "pictures")]
#[test]
fn every_shipped_layout_has_a_png_that_is_not_blank() {
    for (name, _) in ademan::layout::Layout::shipped().unwrap() {
        let picture = ademan(["layout", "show", name, "--png", "-"])
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&picture.stderr);
        assert!(picture.status.success(), "{name}: {error}");
        let pixmap = resvg::tiny_skia::Pixmap::decode_png(&picture.stdout).unwrap();
        let pixels = pixmap.pixels();
        let inked = pixels.iter().filter(|pixel| **pixel != pixels[0]).count();
        assert!(
            inked * 100 > pixels.len(),
            "{name}: {inked} of {}",
            pixels.len()
        );
        assert!(pixels.iter().all(|pixel| pixel.alpha() == 255), "{name}");
    }
}

/// Runs a program of poppler on a page and returns what it prints.
#[cfg(feature = "pictures")]
fn read_by(program: &str, arguments: &[&str]) -> String {
    let read = std::process::Command::new(program).args(arguments).output();
    let read = read.expect("the program starts");
    let complaints = String::from_utf8_lossy(&read.stderr);
    assert!(
        read.status.success() && complaints.is_empty(),
        "{program}: {complaints}"
    );
    String::from_utf8(read.stdout).unwrap()
}

/// Returns `true` if there is a program that reads pages. Prints SKIPPED without one.
#[cfg(feature = "pictures")]
fn has_reader_of_pages() -> bool {
    let reader = std::process::Command::new("pdftotext").arg("-v").output();
    if reader.is_err() {
        println!("SKIPPED: pdftotext is not installed; Debian's poppler-utils has it");
    }
    reader.is_ok()
}

#[cfg(feature = "pictures")]
#[test]
fn another_program_reads_the_words_and_the_size_of_every_page() {
    if !has_reader_of_pages() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (name, _) in ademan::layout::Layout::shipped().unwrap() {
        let path = folder.path().join(name.replace('/', "-") + ".pdf");
        run(["layout", "show", name, "--pdf", text(&path)]).done();
        let svg = run(["layout", "show", name, "--svg", "-"]).done().out;
        let svg = roxmltree::Document::parse(&svg).unwrap();
        let mm = |side| {
            let length = svg.root_element().attribute(side).unwrap();
            length.trim_end_matches("mm").parse::<f64>().unwrap()
        };
        let facts = read_by("pdfinfo", &[text(&path)]);
        let fact = |title: &str| {
            let line = facts.lines().find(|line| line.starts_with(title));
            line.unwrap().split_once(':').unwrap().1.trim().to_owned()
        };
        assert_eq!(fact("Pages"), "1");
        let size = fact("Page size");
        let mut points = size.split(' ').filter_map(|word| word.parse::<f64>().ok());
        for side in ["width", "height"] {
            let page_mm = points.next().unwrap() / 72.0 * 25.4;
            assert!((page_mm - mm(side)).abs() < 0.01, "{name}: {size}");
        }
        // All words of the drawing, in any order.
        let page = read_by("pdftotext", &["-layout", text(&path), "-"]);
        let drawn = svg.descendants().filter(|it| it.has_tag_name("text"));
        let words = drawn
            .filter_map(|it| it.text())
            .flat_map(str::split_whitespace);
        for word in words {
            assert!(page.contains(word), "{name}: no {word:?} in:\n{page}");
        }
    }
}

#[cfg(feature = "pictures")]
#[test]
fn keys_of_a_page_have_their_real_pitch() {
    if !has_reader_of_pages() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board.pdf");
    run(["layout", "show", "qwerty-flat", "--pdf", text(&path)]).done();
    let words = read_by("pdftotext", &["-bbox", text(&path), "-"]);
    let middle_mm = |key: &str| {
        let word = words
            .lines()
            .find(|line| line.contains(&format!(">{key}</word>")));
        let word = word.unwrap_or_else(|| panic!("no {key} in {words}"));
        let number = |name: &str| {
            let (_, rest) = word.split_once(&format!("{name}=\"")).unwrap();
            rest.split_once('"').unwrap().0.parse::<f64>().unwrap()
        };
        (number("xMin") + number("xMax")) / 2.0 / 72.0 * 25.4
    };
    let pitch_mm = middle_mm("S") - middle_mm("A");
    assert!((pitch_mm - 19.0).abs() < 0.3, "{pitch_mm} mm");
}

#[test]
fn a_layout_is_written_as_json_with_its_measures() {
    let shown = run(["layout", "show", "qwerty-flat", "--json", "-"]).done();
    let layout: serde_json::Value = serde_json::from_str(&shown.out).unwrap();
    let board = &layout["boards"][0];
    assert_eq!(board["anchor"], "elbow");
    let targets = board["targets"].as_array().unwrap();
    let target = |name: &str| {
        targets
            .iter()
            .find(|target| target["name"] == name)
            .unwrap()
    };
    // As the file states them: a pitch of 19 mm, F in the fourth place from −90.25 mm, keys of 17 mm.
    let mm = |value: &serde_json::Value| {
        let lengths = value.as_array().unwrap().iter();
        let lengths = lengths.map(|metres| (metres.as_f64().unwrap() * 1e5).round() / 100.0);
        lengths.collect::<Vec<_>>()
    };
    assert_eq!(mm(&target("F")["center_m"]), [-33.25, 0.0]);
    assert_eq!(mm(&target("F")["size_m"]), [17.0, 17.0]);
    assert_eq!(target("F")["key"], "F");
    assert_eq!(target("F")["radius_m"], serde_json::Value::Null);
    assert_eq!(mm(&target("Space")["size_m"]), [112.0, 17.0]);
}
