use std::io;
use std::sync::{Arc, Mutex};

use super::*;
use crate::output::tests::{event, wait_until};
use ademan_core::contact::TargetId;
use ademan_core::device::EventKind;
use ademan_core::device::EventKind::{Depth, Select, Unselect, Value, Velocity};
use ademan_core::device::signals::{MidiKind, Signal};

type Written = Arc<Mutex<Vec<Vec<u8>>>>;

const C4: TargetId = TargetId(0);
const ANOTHER_C4: TargetId = TargetId(1);
const DRUM: TargetId = TargetId(2);
const FADER: TargetId = TargetId(3);
const PEDAL: TargetId = TargetId(4);

fn signals() -> Signals {
    let signal = |channel, midi| Signal {
        address: None,
        range: (0.0, 1.0),
        channel,
        midi: Some(midi),
    };
    Signals::new([
        (C4, signal(0, MidiKind::Note(60))),
        (ANOTHER_C4, signal(0, MidiKind::Note(60))),
        (DRUM, signal(9, MidiKind::Note(36))),
        (FADER, signal(1, MidiKind::Control(7))),
        (PEDAL, signal(0, MidiKind::Control(11))),
    ])
}

/// A sink and the messages that its thread writes.
fn sink() -> (Midi, Written) {
    let written = Written::default();
    let log = Arc::clone(&written);
    let writer = move |message: &[u8]| {
        log.lock().unwrap().push(message.to_vec());
        Ok(message.len())
    };
    let mut sink = Midi::start(Box::new(writer)).unwrap();
    sink.set_signals(&signals());
    (sink, written)
}

/// Returns the messages of events, then the messages of the end, without Active Sensing.
fn messages(events: &[EventKind]) -> Vec<Vec<u8>> {
    let (mut sink, written) = sink();
    for kind in events {
        sink.send(&[event(1, *kind)]).unwrap();
    }
    sink.close().unwrap();
    without_sensing(&written)
}

/// The end of all notes of the first channel.
const ALL_NOTES_OFF: [u8; 3] = [0xb0, 123, 0];

/// Waits until the thread of the port has ended all notes on its own, which takes two periods without a step.
fn wait_for_all_notes_off(written: &Written) {
    wait_until("the end of all notes", || {
        std::thread::sleep(std::time::Duration::from_millis(10));
        written.lock().unwrap().contains(&ALL_NOTES_OFF.to_vec())
    });
}

/// Removes and returns what was written, without Active Sensing.
fn without_sensing(written: &Written) -> Vec<Vec<u8>> {
    let mut messages = std::mem::take(&mut *written.lock().unwrap());
    messages.retain(|message| message != &[0xfe]);
    messages
}

#[test]
fn a_key_plays_its_note_with_velocity_pressure_and_end() {
    let played = messages(&[
        Depth(C4, 0.4),
        Velocity(C4, 0.5),
        Depth(C4, 0.8),
        Depth(C4, 0.8001),
        Velocity(C4, 0.0),
        Depth(C4, 0.1),
        Velocity(DRUM, 1.0),
        Velocity(DRUM, 0.0),
        Select(C4),
        Unselect(C4),
    ]);
    let expected: [[u8; 3]; 7] = [
        [0x90, 60, 64],
        [0xa0, 60, 102],
        [0x80, 60, 64],
        [0x99, 36, 127],
        [0x89, 36, 64],
        [0x90, 60, 64],
        [0x80, 60, 64],
    ];
    assert_eq!(played, expected);
}

#[test]
fn a_value_moves_its_controller_once_per_number_and_a_depth_returns_to_0_at_the_end() {
    let moved = messages(&[
        Value(FADER, 0.5),
        Value(FADER, 0.501),
        Value(FADER, 7.5),
        Value(FADER, f32::NAN),
        Depth(PEDAL, 0.5),
    ]);
    let expected: [[u8; 3]; 5] = [
        [0xb1, 7, 64],
        [0xb1, 7, 127],
        [0xb1, 7, 0],
        [0xb0, 11, 64],
        [0xb0, 11, 0],
    ];
    assert_eq!(moved, expected);
}

#[test]
fn notes_end_with_the_session_and_with_the_layout() {
    let ended = messages(&[Velocity(C4, 1.0), Velocity(DRUM, 1.0)]);
    let expected = [
        vec![0x90, 60, 127],
        vec![0x99, 36, 127],
        vec![0x80, 60, 64],
        vec![0x89, 36, 64],
    ];
    assert_eq!(ended, expected);
    let (mut sink, written) = sink();
    sink.send(&[event(1, Velocity(C4, 1.0))]).unwrap();
    sink.set_signals(&Signals::default());
    sink.send(&[event(2, Velocity(C4, 0.0))]).unwrap();
    drop(sink);
    let end = without_sensing(&written).pop();
    assert_eq!(end.as_deref(), Some(&[0x80, 60, 64][..]));
}

#[test]
fn a_note_that_two_keys_hold_ends_with_the_second() {
    let played = messages(&[
        Velocity(C4, 1.0),
        Velocity(ANOTHER_C4, 0.5),
        Velocity(C4, 0.0),
        Velocity(ANOTHER_C4, 0.0),
    ]);
    let expected: [[u8; 3]; 3] = [[0x90, 60, 127], [0x90, 60, 64], [0x80, 60, 64]];
    assert_eq!(played, expected);
}

#[test]
fn a_queue_that_is_closed_without_an_end_of_the_notes_ends_them_in_the_thread() {
    let (mut sink, written) = sink();
    sink.send(&[event(1, Velocity(DRUM, 1.0))]).unwrap();
    // As by a panic of the loop.
    sink.messages = None;
    sink.thread.join().unwrap();
    let messages = without_sensing(&written);
    let end = [vec![0x89, 36, 64], vec![0xb9, 123, 0]];
    assert!(messages.ends_with(&end), "{messages:?}");
}

/// A sink whose thread cannot write the end of middle C once, and the messages that it writes.
fn failing_sink() -> (Midi, Written) {
    let written = Written::default();
    let log = Arc::clone(&written);
    let mut failing = Some([0x80_u8, 60, 64]);
    let writer = move |message: &[u8]| {
        if failing.take_if(|it| it.as_slice() == message).is_some() {
            return Err(io::Error::from(io::ErrorKind::OutOfMemory));
        }
        log.lock().unwrap().push(message.to_vec());
        Ok(message.len())
    };
    let mut sink = Midi::start(Box::new(writer)).unwrap();
    sink.set_signals(&signals());
    (sink, written)
}

#[test]
fn a_write_that_fails_leaves_no_note() {
    let (mut sink, written) = failing_sink();
    for kind in [Velocity(C4, 1.0), Velocity(DRUM, 1.0), Velocity(C4, 0.0)] {
        sink.send(&[event(1, kind)]).unwrap();
    }
    // The thread may have ended before the last message.
    let _ = sink.close();
    let expected: [[u8; 3]; 6] = [
        [0x90, 60, 127],
        [0x99, 36, 127],
        [0x80, 60, 64],
        [0xb0, 123, 0],
        [0x89, 36, 64],
        [0xb9, 123, 0],
    ];
    assert_eq!(without_sensing(&written), expected);
}

#[test]
fn a_write_that_fails_while_the_loop_hangs_leaves_no_note() {
    let (mut sink, written) = failing_sink();
    sink.send(&[event(1, Velocity(C4, 1.0))]).unwrap();
    wait_for_all_notes_off(&written);
    let expected: [[u8; 3]; 3] = [[0x90, 60, 127], [0x80, 60, 64], [0xb0, 123, 0]];
    assert_eq!(without_sensing(&written), expected);
}

#[test]
fn a_loop_that_hangs_leaves_no_note() {
    let (mut sink, written) = sink();
    sink.send(&[event(1, Velocity(C4, 1.0))]).unwrap();
    wait_for_all_notes_off(&written);
    let messages = written.lock().unwrap().clone();
    let before = messages
        .iter()
        .take_while(|message| **message != ALL_NOTES_OFF);
    let sensing = before.filter(|message| **message == [0xfe]).count();
    assert!(sensing <= 2, "{sensing}");
}

#[test]
fn active_sensing_comes_before_the_first_note_and_goes_on_after_the_last() {
    let (mut sink, written) = sink();
    sink.send(&[event(1, Value(FADER, 0.5))]).unwrap();
    sink.send(&[event(2, Velocity(C4, 1.0))]).unwrap();
    sink.send(&[event(3, Velocity(C4, 0.0))]).unwrap();
    let note_off = vec![0x80, 60, 64];
    wait_until("signs of life after the note", || {
        std::thread::sleep(std::time::Duration::from_millis(10));
        let messages = written.lock().unwrap();
        let later = messages.iter().rev().take_while(|it| **it == [0xfe]);
        later.count() >= 2 && messages.contains(&note_off)
    });
    let messages = written.lock().unwrap().clone();
    let start = [vec![0xb1, 7, 64], vec![0xfe], vec![0x90, 60, 127]];
    assert!(messages.starts_with(&start), "{messages:?}");
}

/// Returns an output whose device reads nothing until the sender is dropped, and what it has read.
fn waiting_device() -> (Midi, crossbeam_channel::Sender<()>, Written) {
    let (gate, opened) = crossbeam_channel::bounded(0);
    let written = Written::default();
    let log = Arc::clone(&written);
    let writer = move |message: &[u8]| {
        let _ = opened.recv();
        log.lock().unwrap().push(message.to_vec());
        Ok(message.len())
    };
    let mut sink = Midi::start(Box::new(writer)).unwrap();
    sink.set_signals(&signals());
    (sink, gate, written)
}

#[test]
fn a_device_that_does_not_read_delays_no_step_and_loses_no_end_of_a_note() {
    let (mut sink, gate, written) = waiting_device();
    sink.send(&[event(1, Velocity(C4, 1.0))]).unwrap();
    for step in 0..1000 {
        sink.send(&[event(2, Value(FADER, (step % 100) as f32 / 100.0))])
            .unwrap();
    }
    assert!(
        sink.coalesced_motions() > 500,
        "{}",
        sink.coalesced_motions()
    );
    sink.send(&[event(3, Velocity(DRUM, 1.0))]).unwrap();
    assert_eq!((sink.dropped_presses(), sink.has_stalled()), (1, true));
    sink.send(&[event(4, Velocity(DRUM, 0.0)), event(4, Velocity(C4, 0.0))])
        .unwrap();
    sink.void_presses();
    drop(gate);
    sink.close().unwrap();
    let written = without_sensing(&written);
    let of_notes = written.iter().filter(|message| message[0] & 0xe0 == 0x80);
    let of_notes: Vec<_> = of_notes.collect();
    assert_eq!(of_notes, [&[0x90, 60, 127], &[0x80, 60, 64]]);
    assert_eq!(written.last().map(Vec::as_slice), Some(&[0xb1, 7, 126][..]));
}

#[test]
fn a_controller_of_a_key_returns_with_the_layout_also_while_the_device_does_not_read() {
    let (mut sink, gate, written) = waiting_device();
    for step in 0..1000 {
        let depth = (step % 100 + 1) as f32 / 101.0;
        sink.send(&[event(1, Depth(PEDAL, depth))]).unwrap();
    }
    sink.set_signals(&Signals::default());
    drop(gate);
    sink.close().unwrap();
    let last = written.lock().unwrap().pop();
    assert_eq!(last.as_deref(), Some(&[0xb0, 11, 0][..]));
}

#[test]
fn a_device_that_is_gone_is_reported() {
    let gone = |_: &[u8]| Err(io::Error::from(io::ErrorKind::BrokenPipe));
    let mut sink = Midi::start(Box::new(gone)).unwrap();
    sink.set_signals(&signals());
    sink.send(&[event(1, Velocity(C4, 1.0))]).unwrap();
    sink.thread.join().unwrap();
    let error = sink.send(&[event(2, Velocity(C4, 0.0))]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the output `midi` failed: the device does not accept messages any more"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_that_accepts_nothing_is_given_up_and_closed_at_the_end() {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use rustix::fs::{CWD, Mode, OFlags, mkfifoat};

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pipe");
    mkfifoat(CWD, &path, Mode::RUSR | Mode::WUSR).unwrap();
    let open = |flags| rustix::fs::open(&path, flags | OFlags::NONBLOCK, Mode::empty());
    let reader = open(OFlags::RDONLY).unwrap();
    let name = format!("midi:{}", path.display());
    let mut sink = crate::output::open(&name, &Capabilities::default()).unwrap();
    sink.set_signals(&signals());
    let filler = open(OFlags::WRONLY).unwrap();
    while rustix::io::write(&filler, &[0; 512]).is_ok() {}
    drop(filler);
    sink.send(&[event(1, Velocity(C4, 1.0))]).unwrap();
    let error = sink.close().unwrap_err().to_string();
    assert!(error.contains("did not end within 1 s"), "{error}");
    wait_until("the end of the last writer", || {
        let mut polled = [PollFd::new(&reader, PollFlags::IN)];
        poll(&mut polled, Some(&Timespec::default())).unwrap();
        std::thread::sleep(std::time::Duration::from_millis(10));
        polled[0].revents().contains(PollFlags::HUP)
    });
}

#[test]
fn what_is_no_device_is_refused_with_the_remedy() {
    let refused = |name: &str| {
        let opened = crate::output::open(name, &Capabilities::default());
        opened.err().unwrap().to_string()
    };
    let error = refused("midi:/dev/snd/no-such-device");
    assert!(
        error.contains("No such file") && error.contains("`amidi -l`"),
        "{error}"
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("notes");
    std::fs::write(&file, "").unwrap();
    let file_error = refused(&format!("midi:{}", file.display()));
    assert!(
        file_error.contains("neither a device nor a pipe"),
        "{file_error}"
    );
    #[cfg(target_os = "linux")]
    {
        let pipe = folder.path().join("pipe");
        let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
        rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, mode).unwrap();
        let pipe_error = refused(&format!("midi:{}", pipe.display()));
        assert!(
            pipe_error.ends_with("no program reads this pipe yet; start it first"),
            "{pipe_error}"
        );
    }
}
