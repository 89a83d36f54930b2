use super::*;
use crate::device::{Capability, EventKind, KeyCode};
use crate::time::Timestamp;

pub(super) fn key(name: &str) -> KeyCode {
    name.parse().unwrap()
}

pub(super) fn event(micros: u64, action: EventKind) -> OutputEvent {
    OutputEvent {
        time: Timestamp(micros),
        kind: action,
    }
}

pub(super) fn down(micros: u64, name: &str) -> OutputEvent {
    event(micros, EventKind::KeyDown(key(name)))
}

pub(super) fn up(micros: u64, name: &str) -> OutputEvent {
    event(micros, EventKind::KeyUp(key(name)))
}

fn error(name: &str) -> String {
    open(name, &Capabilities::default())
        .err()
        .unwrap()
        .to_string()
}

#[test]
fn an_unknown_output_names_the_nearest_one() {
    assert_eq!(
        error("desktp"),
        "unknown output `desktp`, did you mean `desktop`?; outputs are transcript, transcript:PATH, \
         desktop, uinput, spacenav, spacenav:PATH and none"
    );
}

#[test]
fn a_transcript_goes_to_a_new_file_or_says_why_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("typed.txt");
    let name = format!("transcript:{}", path.display());
    let mut sink = open(&name, &Capabilities::default()).unwrap();
    sink.send(&[down(1_000, "A")]).unwrap();
    sink.close().unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text, "       1.000 down A\n       1.000 up   A\n");

    let below = error(&format!("transcript:{}/x", path.display()));
    assert!(
        below.contains("cannot open the output `transcript:"),
        "{below}"
    );
}

#[cfg(unix)]
#[test]
fn only_its_owner_can_read_a_transcript() {
    use std::os::unix::fs::PermissionsExt;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("typed.txt");
    open(
        &format!("transcript:{}", path.display()),
        &Capabilities::default(),
    )
    .unwrap();
    let mode = std::fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
}

#[test]
fn nothing_comes_of_the_output_none() {
    let mut sink = open("none", &Capabilities::default()).unwrap();
    sink.send(&[down(1, "A")]).unwrap();
    sink.close().unwrap();
    assert_eq!(sink.dropped_presses(), 0);
}

#[test]
fn two_transcripts_hear_the_same_and_what_one_cannot_open_opens_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (a, b) = (path("a"), path("b"));
    let mut sink = open(
        &format!("transcript:{a}, transcript:{b}"),
        &Capabilities::default(),
    )
    .unwrap();
    sink.send(&[down(1_000, "A"), up(1_000, "A")]).unwrap();
    sink.close().unwrap();
    let text = |path| std::fs::read_to_string(path).unwrap();
    assert_eq!(text(&a), "       1.000 down A\n       1.000 up   A\n");
    assert_eq!(text(&a), text(&b));
    assert!(error("none,desktp").starts_with("unknown output `desktp`"));
}

#[test]
fn an_output_that_cannot_carry_what_is_needed_is_refused_before_it_is_opened() {
    let pad =
        Capabilities::from_iter([Capability::Key(key("A")), Capability::Key(key("PadSouth"))]);
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("record");
    let names = format!("transcript:{},desktop", record.display());
    let error = open(&names, &pad).err().unwrap().to_string();
    let reason =
        "`desktop` has no gamepad, and the layout needs `PadSouth`; add the output `uinput`";
    assert!(error.contains(reason), "{error}");
    assert!(!record.exists());
}

#[test]
fn devices_of_the_kernel_take_no_layout_that_needs_more_than_they_have() {
    let needs = |names: &[&str]| -> Capabilities {
        let codes = names.iter().map(|name| Capability::Key(key(name)));
        codes.collect()
    };
    let opened = needs(&["A", "B"]);
    assert_eq!(
        check_layout_change("uinput", &opened, &needs(&["B"])),
        Ok(())
    );
    assert_eq!(
        check_layout_change("uinput", &opened, &needs(&["B", "Z"])).unwrap_err(),
        "the output `uinput` was opened without `Z`; start again to use it"
    );
    assert_eq!(
        check_layout_change("desktop,uinput", &opened, &needs(&["Z"])),
        Ok(())
    );
    let refused = check_layout_change("desktop", &opened, &needs(&["PadSouth"])).unwrap_err();
    assert!(refused.starts_with("`desktop` has no gamepad"), "{refused}");
    let pad = needs(&["PadSouth"]);
    assert_eq!(check_layout_change("desktop,none", &opened, &pad), Ok(()));
}

#[test]
fn a_transcript_on_the_standard_output_is_found_among_others() {
    assert!(uses_stdout("desktop, transcript"));
    assert!(!uses_stdout("desktop,transcript:path"));
}
