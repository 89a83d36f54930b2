//! Learning of the ranges of sensors.

use ademan::capture::{Hc11Format, Reading, Sample, hc11};
use ademan::device::Events;
use ademan::hand::Dof;
use ademan::setup::Setup;
use ademan::time::Timestamp;

use crate::steady_state::allocations;

#[test]
fn ranges_are_learned_and_unlearned_without_allocation() {
    let mut setup = Setup::default().load_files().expect("the default setup");
    let mut typist = setup
        .typist("a", &Hc11Format::default(), 0.0, 0)
        .expect("the hand can type");
    let counts = typist.next_counts().expect("a first posture");
    let clear: [u8; hc11::BODY_BYTES] = std::array::from_fn(|channel| counts[channel] as u8);
    setup.setup.learn_ranges = true;
    let glove = setup.glove.as_mut().expect("a glove");
    let mut rows = glove.map.rows().iter();
    let row = rows.find(|row| row.dof == Dof::RingMcpFlexion);
    let channel = row.expect("a sensor").channel;
    let count = f64::from(clear[channel]);
    let ranges = vec![(channel, (count - 40.0, count + 2.0))];
    let map = glove.map.clone().with_ranges(ranges);
    // The compensation of its hysteresis does not allocate, either.
    glove.map = map.with_hystereses(vec![(channel, 4.0)]);
    let mut stretched = clear;
    stretched[channel] += 6;
    let readings: Vec<Reading> = (1..=1_200)
        .map(|number| {
            // 1 s at rest, 1 s beyond the range, and so on.
            let posture = if number / 180 % 2 == 0 {
                &clear
            } else {
                &stretched
            };
            let sample = Sample::Channels(hc11::channels(posture));
            Reading::new(Timestamp(5_729 * number), None, sample)
        })
        .collect();
    let mut pipeline = setup.pipeline();
    let mut events = Events::new();

    let before = allocations();
    for reading in &readings {
        let _ = pipeline.step(reading, &mut events);
    }
    let learned = pipeline.learned_ranges().count();
    let undone = pipeline.undo_learning(&mut events);
    let allocated = allocations() - before;

    assert_eq!(learned, 1);
    assert_eq!(undone, Ok(()));
    assert_eq!(allocated, 0);
}
