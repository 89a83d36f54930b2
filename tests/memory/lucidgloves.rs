//! The path from lines of LucidGloves to events does not allocate after the start.

use ademan::capture::Reading;
use ademan::capture::protocol::Decoder;
use ademan::capture::protocol::lucidgloves::{FULL_SCALE, Fields, decoder};
use ademan::device::Events;
use ademan::setup::Setup;
use ademan::time::Timestamp;

use crate::steady_state::allocations;
use crate::support::lucidgloves::{RATE_HZ, chords};

#[test]
fn lines_of_a_glove_are_processed_to_events_without_allocation() {
    let setup = Setup {
        source: Some("file:glove?protocol=lucidgloves".parse().expect("a source")),
        layout: "chords-bend".into(),
        ..Setup::default()
    };
    let mut pipeline = setup.load_files().expect("a valid setup").pipeline();
    let lines: String = chords().iter().map(Fields::encode).collect();
    let mut decoder = decoder(FULL_SCALE);
    let mut events = Events::new();
    let (mut steps, mut sent) = (0, 0);

    let before = allocations();
    for piece in lines.as_bytes().chunks(99) {
        decoder.push(piece, &mut |packet| {
            steps += 1;
            let time = Timestamp::from_seconds(steps as f64 / RATE_HZ);
            let reading = Reading::new(time, None, packet.sample);
            events.clear();
            let _ = std::hint::black_box(pipeline.step(&reading, &mut events));
            sent += events.len();
        });
    }
    let allocated = allocations() - before;

    assert_eq!(pipeline.accepted(), steps);
    assert!(sent >= 10, "five presses and releases");
    assert_eq!(allocated, 0, "{allocated} allocations in {steps} steps");
}
