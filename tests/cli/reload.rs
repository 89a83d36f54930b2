//! Saving the layout file while the real binary runs.

use std::thread;
use std::time::Duration;

use crate::support::run::{MOVE_TIME, Run, shipped};

#[test]
fn saving_the_layout_releases_keys_and_activates_it() {
    let run = Run::with_held_key(&[]);
    let saved = run.save(&shipped("dvorak-flat"));
    assert_eq!(run.next_event(), "up H");
    println!("from the save to the release: {:?}", saved.elapsed());
    assert_eq!(run.next_message(), "my.ron: active from now on");

    thread::sleep(MOVE_TIME);
    assert!(run.events.is_empty(), "the finger has not left the key");
    run.lift();
    thread::sleep(MOVE_TIME);
    run.press();
    assert_eq!(run.next_event(), "down D");
}

#[test]
fn an_invalid_file_is_reported_with_its_position_and_keys_stay_pressed() {
    let run = Run::with_held_key(&[]);
    run.save("Layout(\n    nmae: \"My board\",\n)\n");
    assert_eq!(
        run.next_message(),
        "my.ron:2:5: unknown field `nmae`, did you mean `name`?"
    );
    assert_eq!(run.next_message(), " 2 |     nmae: \"My board\",");
    assert_eq!(run.next_message(), "   |     ^^^^");
    assert_eq!(run.next_message(), "the active layout stays");
    std::fs::remove_file(run.path()).expect("the file exists");
    assert_eq!(run.next_message(), "my.ron: there is no such file");
    assert_eq!(run.next_message(), "the active layout stays");
    assert!(run.events.is_empty(), "the key stays pressed");
    run.lift();
    assert_eq!(run.next_event(), "up H");

    run.save(&shipped("dvorak-flat"));
    assert_eq!(run.next_message(), "my.ron: active from now on");
    thread::sleep(MOVE_TIME);
    run.press();
    assert_eq!(run.next_event(), "down D");
}

#[test]
fn a_file_that_is_fixed_by_its_old_content_is_reported_and_keys_stay_pressed() {
    let run = Run::with_held_key(&[]);
    let before = std::fs::read_to_string(run.path()).expect("the file exists");
    run.save("no layout");
    run.wait_for_message("the active layout stays");
    run.save(&before);
    assert_eq!(
        run.next_message(),
        "my.ron: valid again, as the active layout is"
    );
    assert!(run.events.is_empty(), "the key stays pressed");
}

#[test]
fn after_a_hundred_saves_in_a_second_the_last_is_active_and_no_key_is_stuck() {
    let run = Run::with_held_key(&[]);
    let (qwerty, dvorak) = (shipped("qwerty-flat"), shipped("dvorak-flat"));
    for save in 0..100 {
        run.save(&format!("// {save}\n{}", [&qwerty, &dvorak][save % 2]));
        thread::sleep(Duration::from_millis(8));
    }
    assert_eq!(run.next_event(), "up H");
    // More than one layout is activated if the machine suspends the test between two saves.
    while run.messages.recv_timeout(Duration::from_secs(2)).is_ok() {}
    run.lift();
    thread::sleep(MOVE_TIME);
    run.press();
    assert_eq!(run.next_event(), "down D");
    run.lift();
    assert_eq!(run.next_event(), "up D");
}

#[test]
fn a_recorded_run_keeps_its_layout_and_reports_it() {
    let run = Run::with_held_key(&["--record", "hand.mcap"]);
    run.save(&shipped("dvorak-flat"));
    assert_eq!(
        run.next_message(),
        "my.ron: not used, as a recording holds one version of a layout; start again to use it"
    );
    assert!(run.events.is_empty(), "the key stays pressed");
    run.lift();
    assert_eq!(run.next_event(), "up H");
}

#[test]
fn a_scale_key_enlarges_the_boards() {
    let run = Run::with_held_key(&[]);
    let row = r#"(at_mm: (-90.25, 0), keys: "A S D F G H J K L Semicolon Quote Backslash"),"#;
    let without_h =
        r#"(at_mm: (-90.25, 0), keys: "A S D F G"), (at_mm: (23.75, 0), keys: "J K L"),"#;
    let grow = "(action: Command(\"scale 1.5\"), name: \"grow\", at_mm: (4.75, 0)),\n                (code: \"ShiftLeft\"";
    let text = shipped("qwerty-flat");
    let changed = text
        .replace(row, without_h)
        .replace("(code: \"ShiftLeft\"", grow);
    assert_ne!(changed, text);
    run.save(&changed);
    assert_eq!(run.next_event(), "up H");
    run.wait_for_message("my.ron: active from now on");
    run.lift();
    thread::sleep(MOVE_TIME);
    run.press();
    assert_eq!(run.next_event(), "scale 1.500");
    run.wait_for_message("scaled by 1.5");
}
