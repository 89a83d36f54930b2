//! The path from datagrams of VMC and opentrack to events does not allocate after the start.

use ademan::capture::Reading;
use ademan::capture::protocol::{Decoder, opentrack, vmc};
use ademan::device::Events;
use ademan::estimate::bones_from_angles;
use ademan::hand::{BoneRotations, Joint, Side};
use ademan::setup::Setup;
use ademan::time::Timestamp;

use crate::steady_state::allocations;
use crate::support::source::{TYPING_RATE_HZ, typing_estimates};

/// Returns the allocations and the accepted readings of datagrams from this source.
fn process(source: &str, decoder: &mut dyn Decoder, datagrams: &[Vec<u8>]) -> (u64, u64) {
    let setup = Setup {
        source: Some(source.parse().expect("a source")),
        ..Setup::default()
    };
    let mut pipeline = setup.load_files().expect("a valid setup").pipeline();
    let mut events = Events::new();
    let mut steps = 0;
    let before = allocations();
    for datagram in datagrams {
        let mut emit = |packet: ademan::capture::protocol::Packet| {
            steps += 1;
            let time = Timestamp::from_seconds(f64::from(steps) / TYPING_RATE_HZ);
            let reading = Reading::new(time, Some(Side::Right), packet.sample);
            events.clear();
            let _ = std::hint::black_box(pipeline.step(&reading, &mut events));
        };
        decoder.push(datagram, &mut emit);
        decoder.finish(&mut emit);
    }
    (allocations() - before, pipeline.accepted())
}

#[test]
fn datagrams_are_processed_to_events_without_allocation() {
    let frames = |estimate: &ademan::estimate::Estimate| {
        vmc::encode(&BoneRotations {
            right: bones_from_angles(&estimate.angles, Side::Right),
            ..BoneRotations::default()
        })
    };
    let frames: Vec<Vec<u8>> = typing_estimates("a").0.iter().map(frames).collect();
    let count = frames.len() as u64;
    let source = "udp:127.0.0.1:39539?protocol=vmc";
    let processed = process(source, &mut vmc::decoder(), &frames);
    assert_eq!(processed, (0, count));

    let pose = |index: usize| opentrack::encode(&[0.1 * index as f64, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let poses: Vec<Vec<u8>> = (0..100).map(|index| pose(index).to_vec()).collect();
    let opentrack_source = "udp:127.0.0.1:4242?protocol=opentrack";
    let opentrack_processed = process(
        opentrack_source,
        &mut opentrack::decoder(Joint::Wrist),
        &poses,
    );
    assert_eq!(opentrack_processed, (0, 100));
}
