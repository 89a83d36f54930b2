//! The session loop that reads a line itself, as in `ademan run` with a serial port, does not allocate.

use std::io::Write;
use std::thread;
use std::time::Duration;

use ademan::capture::hc11::{Framing, encode};
use ademan::capture::{Hc11Format, open, open_loopback};
use ademan::command::Command;
use ademan::output;
use ademan::session::{command_channel, run_pipeline};
use ademan::setup::Setup;
use ademan::snapshot::StepView;
use crossbeam_channel::bounded;

use crate::steady_state::allocations;
use crate::support::press::postures;

/// Longest wait for a step on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Packets that are sent.
const PACKETS: usize = 700;

/// Steps of accepted readings before the first one that counts, in which buffers reach their size.
const WARM_UP: usize = 100;

#[test]
fn a_line_is_read_decoded_and_stepped_without_allocation() {
    let setup = Setup {
        // The feeder may be late on a busy machine.
        stall_timeout_ms: 10_000,
        arm_immediately: true,
        ..Setup::default()
    };
    let setup = setup.load_files().expect("the default setup");
    let typist = setup.typist("a", &Hc11Format::default(), 0.0, 0);
    let at_rest = postures(typist.expect("the text can be typed"))[0];
    let mut line = open_loopback(Hc11Format::default()).expect("a pseudo terminal");
    let source = open(&line.uri).expect("the line opens");
    let (stop, commands) = command_channel();
    let (done, steps) = bounded(PACKETS);
    let feeder = thread::spawn(move || {
        for number in 0..PACKETS {
            let packet = encode(Framing::Double06, &at_rest);
            line.writer.write_all(&packet).expect("the line is open");
            // A packet is confirmed by the next one, at the latest.
            if number > 0 {
                steps.recv_timeout(TIMEOUT).expect("a step for each packet");
            }
        }
        stop.send(Command::Stop).expect("the run goes on");
        // It is unplugged after the run.
        line
    });
    let required = setup.required_capabilities();
    let mut sink = output::open("none", &required).expect("the output `none`");
    let (mut accepted, mut at_start, mut at_end) = (0, 0, 0);
    let observe = &mut |step: &StepView| {
        if step.reading.is_some() {
            let _ = done.try_send(());
        }
        if step.pose.is_some() {
            accepted += 1;
            if accepted == WARM_UP {
                at_start = allocations();
            }
            at_end = allocations();
        }
    };
    let mut pipeline = setup.pipeline();
    run_pipeline(source, &mut pipeline, &mut *sink, &commands, observe).expect("a run");
    drop(feeder.join().expect("every packet has a step"));
    assert!(accepted > PACKETS - WARM_UP, "only {accepted} steps");
    assert_eq!(at_end - at_start, 0, "in {accepted} steps");
}
