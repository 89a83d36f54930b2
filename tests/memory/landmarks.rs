//! The path from lines of landmarks to events does not allocate after the start.

use ademan::capture::Reading;
use ademan::capture::protocol::{Decoder, body_landmarks};
use ademan::device::Events;
use ademan::hand::Side;
use ademan::setup::Setup;
use ademan::time::Timestamp;

use crate::steady_state::allocations;
use crate::support::body::{ONE_KEY, Person, RATE_HZ, taps};
use crate::support::wearer::load_layout;

#[test]
fn landmarks_are_processed_to_events_without_allocation() {
    let setup = Setup {
        source: Some(
            "file:body?protocol=body-landmarks"
                .parse()
                .expect("a source"),
        ),
        ..Setup::default()
    };
    let mut pipeline = load_layout(ONE_KEY, setup).pipeline();
    let mut frames = taps(&[Side::Right]);
    let mut hidden = Person::new();
    hidden.confidences = [0.1; Side::COUNT];
    frames.extend(vec![hidden.landmarks(); 5]);
    let lines: String = frames.iter().map(body_landmarks::encode).collect();
    let mut decoder = body_landmarks::decoder();
    let mut events = Events::new();
    let (mut steps, mut sent) = (0, 0);

    let before = allocations();
    for chunk in lines.as_bytes().chunks(1_000) {
        decoder.push(chunk, &mut |packet| {
            steps += 1;
            let reading = Reading::new(
                Timestamp::from_seconds(steps as f64 / RATE_HZ),
                Some(Side::Right),
                packet.sample,
            );
            events.clear();
            let _ = std::hint::black_box(pipeline.step(&reading, &mut events));
            sent += events.len();
        });
    }
    let allocated = allocations() - before;

    assert_eq!((pipeline.accepted(), steps), (steps, frames.len() as u64));
    assert_eq!(sent, 2, "a press and a release");
    assert_eq!(allocated, 0, "{allocated} allocations in {steps} steps");
}
