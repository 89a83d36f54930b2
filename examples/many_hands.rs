//! Many hands at once: the reach of a board for people with hands of different sizes.
//!
//! For each size of hand, 64 people move their index finger over the default board, placed for their arm, and the presses of all
//! of them are counted:
//! `cargo run --release --example many_hands`

use std::f32::consts::TAU;

use ademan::batch::{HandBatch, LANES, LaneAngles};
use ademan::contact::Phase;
use ademan::hand::Dof;
use ademan::kinematics::typing_angle;
use ademan::setup::{ArmSetup, Setup};
use ademan::time::Timestamp;

/// People for each size of hand.
const PEOPLE: usize = 64;

/// Poses of each person, at 175 per second.
const FRAMES: usize = 1_750;

/// Returns the angles of eight people, each of whom taps at another speed.
fn angles(block: usize, frame: usize) -> LaneAngles {
    let mut angles = LaneAngles::default();
    for &dof in Dof::ALL {
        *angles.dof_mut(dof) = [typing_angle(dof) as f32; LANES];
    }
    for lane in 0..LANES {
        let taps_per_second = 1.0 + (block * LANES + lane) as f32 / 32.0;
        let phase = frame as f32 / 175.0 * taps_per_second * TAU;
        angles.dof_mut(Dof::IndexMcpFlexion)[lane] += 0.3 * phase.sin();
        angles.dof_mut(Dof::WristDeviation)[lane] += 0.2 * (0.1 * phase).sin();
    }
    angles
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let threads = std::thread::available_parallelism()?.get();
    let times: Vec<_> = (1..=FRAMES as u64)
        .map(|frame| Timestamp(frame * 5_714))
        .collect();
    for hand_mm in [165.0, 175.0, 185.0, 195.0, 205.0] {
        // Loading places the board for the arm: in another place a hand of this size may meet no key.
        let setup = Setup {
            arm: ArmSetup::Measured {
                hand_length_mm: hand_mm,
                forearm_length_mm: 1.34 * hand_mm,
            },
            ..Setup::default()
        };
        let setup = setup.load_files()?;
        let mut people = HandBatch::new(&setup.arm, &setup.layout.scene, PEOPLE);
        let angles: Vec<_> = (0..people.block_count())
            .flat_map(|block| (0..FRAMES).map(move |frame| angles(block, frame)))
            .collect();
        let touches = people.run(&times, &angles, threads);
        let is_press = |phase| phase == Phase::Pressed;
        let presses = touches.iter().filter(|it| is_press(it.touch.phase));
        println!("hands of {hand_mm} mm: {} presses", presses.count());
    }
    Ok(())
}
