use super::*;
use ademan_core::device::{Capability, EventKind, KeyCode};
use ademan_core::time::Timestamp;

pub(super) fn key(name: &str) -> KeyCode {
    name.parse().unwrap()
}

pub(super) fn event(micros: u64, kind: EventKind) -> OutputEvent {
    OutputEvent {
        time: Timestamp(micros),
        kind,
    }
}

pub(super) fn down(micros: u64, name: &str) -> OutputEvent {
    event(micros, EventKind::KeyDown(key(name)))
}

pub(super) fn up(micros: u64, name: &str) -> OutputEvent {
    event(micros, EventKind::KeyUp(key(name)))
}

/// Waits until another thread has made a condition true. Fails if it does not.
pub(crate) fn wait_until(what: &str, mut condition: impl FnMut() -> bool) {
    let start = std::time::Instant::now();
    while !condition() {
        assert!(start.elapsed().as_secs() < 60, "awaited in vain: {what}");
        std::thread::yield_now();
    }
}

fn open_error(names: &str) -> String {
    let opened = open(names, &Capabilities::default());
    opened.err().unwrap().to_string()
}

#[test]
fn an_unknown_output_is_reported_with_the_nearest_name_and_all_names() {
    assert_eq!(
        open_error("desktp"),
        "unknown output `desktp`, did you mean `desktop`?; available: transcript, \
         transcript:PATH, desktop, uinput, spacenav, spacenav:PATH, osc:HOST:PORT, midi, midi:DEVICE, ime, ime:OUTPUT, none"
    );
}

#[test]
fn an_argument_of_an_output_without_arguments_is_rejected() {
    let error = open_error("uinput:/dev/uinput");
    let expected = "the output `uinput:/dev/uinput` takes no argument; available: transcript, ";
    assert!(error.starts_with(expected), "{error}");
}

#[test]
fn a_transcript_is_written_to_a_new_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.txt");
    let name = format!("transcript:{}", path.display());
    let mut sink = open(&name, &Capabilities::default()).unwrap();
    sink.send(&[down(1_000, "A")]).unwrap();
    sink.close().unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text, "       1.000 down A\n       1.000 up   A\n");

    let error = open_error(&format!("transcript:{}/x", path.display()));
    assert!(
        error.contains("cannot open the output `transcript:"),
        "{error}"
    );
}

#[cfg(unix)]
#[test]
fn a_transcript_is_readable_by_its_owner_only() {
    use std::os::unix::fs::PermissionsExt;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.txt");
    let name = format!("transcript:{}", path.display());
    open(&name, &Capabilities::default()).unwrap();
    let mode = std::fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
}

#[test]
fn the_output_none_discards_events() {
    let mut sink = open("none", &Capabilities::default()).unwrap();
    sink.send(&[down(1, "A")]).unwrap();
    sink.close().unwrap();
    assert_eq!(sink.dropped_presses(), 0);
}

#[test]
fn two_transcripts_receive_the_same_events() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (a, b) = (path("a"), path("b"));
    let names = format!("transcript:{a}, transcript:{b}");
    let mut sink = open(&names, &Capabilities::default()).unwrap();
    sink.send(&[down(1_000, "A"), up(1_000, "A")]).unwrap();
    sink.close().unwrap();
    let text = |file| std::fs::read_to_string(file).unwrap();
    assert_eq!(text(&a), "       1.000 down A\n       1.000 up   A\n");
    assert_eq!(text(&a), text(&b));
    assert!(open_error("none,desktp").starts_with("unknown output `desktp`"));
}

#[test]
fn nothing_is_opened_if_a_required_capability_is_unsupported() {
    let gamepad = ["A", "PadSouth"].map(|name| Capability::Key(key(name)));
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log");
    let names = format!("transcript:{},desktop", log.display());
    let opened = open(&names, &Capabilities::from_iter(gamepad));
    let error = opened.err().unwrap().to_string();
    let reason = "the layout requires `PadSouth`, which `desktop` does not support; \
                  add the output `uinput`";
    assert!(error.contains(reason), "{error}");
    assert!(!log.exists());
}

#[test]
fn a_layout_that_requires_more_than_the_open_uinput_devices_have_is_rejected() {
    let keys = |names: &[&str]| -> Capabilities {
        let keys = names.iter().map(|name| Capability::Key(key(name)));
        keys.collect()
    };
    let opened = keys(&["A", "B"]);
    let change = |names, required: &[&str]| check_layout_change(names, &opened, &keys(required));
    assert_eq!(change("uinput", &["B"]), Ok(()));
    assert_eq!(
        change("uinput", &["B", "Z"]).unwrap_err(),
        "the output `uinput` was opened without `Z`; restart to use it"
    );
    assert_eq!(change("desktop,uinput", &["Z"]), Ok(()));
    let error = change("desktop", &["PadSouth"]).unwrap_err();
    assert!(error.contains("`desktop` does not support"), "{error}");
    assert_eq!(change("desktop,none", &["PadSouth"]), Ok(()));
}

#[test]
fn a_layout_that_requires_more_than_the_keys_of_the_input_method_can_be_is_rejected() {
    let code = |name| Capability::Key(key(name));
    let opened = Capabilities::from_iter([code("A")]);
    let change = |names, required: &[Capability]| {
        check_layout_change(names, &opened, &required.iter().copied().collect())
    };
    assert_eq!(change("ime:uinput", &[code("A"), Capability::Text]), Ok(()));
    assert_eq!(
        change("ime:uinput", &[code("Z")]).unwrap_err(),
        "the output `ime:uinput` was opened without `Z`; restart to use it"
    );
    assert_eq!(change("ime", &[code("Z"), Capability::Text]), Ok(()));
    let error = change("ime", &[code("PadSouth")]).unwrap_err();
    assert!(error.contains("`ime` does not support"), "{error}");
}

#[cfg(all(target_os = "linux", feature = "ime"))]
#[test]
fn an_input_method_whose_keys_cannot_be_opened_leaves_the_desktop_as_it_is() {
    let required = Capabilities::from_iter([Capability::Key(key("A"))]);
    if open("uinput", &required).is_ok() {
        println!("SKIPPED: the output `uinput` can be opened");
        return;
    }
    let error = open("ime:uinput", &required).err().unwrap().to_string();
    let reason = "cannot open the output `uinput`: ";
    assert!(error.starts_with(reason), "before the bus: {error}");
}

#[test]
fn a_transcript_on_the_standard_output_is_found_in_a_list() {
    assert!(uses_stdout("desktop, transcript"));
    assert!(!uses_stdout("desktop,transcript:path"));
}
