//! A LucidGloves build as the source of the program.

use ademan::capture::protocol::lucidgloves::Fields;
use ademan::hand::Finger;

use crate::support::lucidgloves::{RATE_HZ, chords, curls};
use crate::text_line::{assert_typed_and_replayed, pressed_keys};
use crate::{file, run};

const KEYS: [&str; 5] = ["H", "E", "L", "L", "O"];

#[test]
fn lines_of_a_glove_are_typed_traced_recorded_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let lines: String = chords().iter().map(Fields::encode).collect();
    let path = file(&folder, "glove.txt", lines);
    let source = format!("file:{path}?protocol=lucidgloves&rate_hz={RATE_HZ}");
    let source = ["--source", &source, "--layout", "chords-bend"];
    assert_typed_and_replayed(&source, &KEYS);
    for (stage, part) in [
        ("readings", r#""full_scale":4095,"channels":[0,0,0"#),
        ("angles", r#""elbow-flexion":0.6"#),
        ("pose", r#""index-finger-tip":"#),
    ] {
        let traced = run([&["trace", stage], &source[..]].concat()).done();
        let first = traced.out.lines().next().unwrap_or_default();
        assert!(first.contains(part), "{first}");
    }
}

#[test]
fn the_simulated_hand_types_chords_and_characters_that_it_cannot_type_are_listed() {
    for source in ["typist:hello", "typist:hello?protocol=lucidgloves"] {
        let typed = run(["run", "--source", source, "--layout", "chords-bend"]).done();
        assert_eq!(pressed_keys(&typed.out), KEYS, "{source}: {}", typed.err);
    }
    let refused = run(["run", "--source", "typist:1é ñ", "--layout", "chords-bend"]);
    assert_ne!(refused.code, Some(0));
    refused.reported("cannot type 'é': a US keymap has no key for it; nor 'ñ'");
}

#[test]
fn a_finger_that_is_bent_at_the_start_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut bent = [0.1; Finger::COUNT];
    bent[Finger::Index.index()] = 0.6;
    let lines = curls(bent).encode().repeat(100);
    let path = file(&folder, "glove.txt", lines);
    let source = format!("file:{path}?protocol=lucidgloves&rate_hz={RATE_HZ}");
    let ended = run(["run", "--source", &source, "--layout", "chords-bend"]).done();
    ended.reported("straighten index");
    assert_eq!(pressed_keys(&ended.out), [""; 0], "{}", ended.out);
}
