//! A run under attack: the X server and its keymap, the output pipes, the processes, the cable, the layout file, the control
//! socket and the server of the shared hand fail at random times, several at once, while a hand holds a key or types.
//!
//! The run takes 20 s. `ADEMAN_CHAOS_SECONDS=600` sets its length, `ADEMAN_CHAOS_SEED` the seed, and
//! `ADEMAN_CHAOS_ATTACKS=KillProgram,GrabServer` the attacks; `-- --nocapture` prints the statistics:
//!
//! ```sh
//! ADEMAN_CHAOS_SECONDS=600 cargo test --test outputs chaos::run -- --nocapture
//! ```
//!
//! A log of all key events decides. It shows that
//! - all keys are released after each attack while the hand still presses, and all keys after it has left them;
//! - at most the press that was on its way arrives after a pause was acknowledged;
//! - the program answers commands and ends by one SIGTERM, whatever does not read its output;
//! - each press has a release;
//! - the memory of the program stays below 100 MB.
//!
//! Both processes killed at once are not among the attacks: an X server keeps their keys pressed.

mod attack;
mod episode;
mod judge;
mod rig;
mod scene;
mod stats;
mod subject;
mod viewers;

use std::time::{Duration, Instant};

use attack::Attack;
use episode::Episode;
use rig::Rig;

use crate::support::x11::XServer;

fn setting<T: std::str::FromStr>(name: &str, default: T) -> T {
    let value = std::env::var(name).ok();
    value.map_or(default, |value| {
        value.parse().unwrap_or_else(|_| panic!("{name}={value}"))
    })
}

/// Returns the attacks of the run: the ones in the setting, or all.
fn attacks() -> Vec<Attack> {
    let Ok(names) = std::env::var("ADEMAN_CHAOS_ATTACKS") else {
        return Attack::ALL.to_vec();
    };
    let attack = |name: &str| {
        let mut all = Attack::ALL.into_iter();
        all.find(|attack| format!("{attack:?}") == name)
            .unwrap_or_else(|| panic!("no attack {name}; there are {:?}", Attack::ALL))
    };
    names.split(',').map(attack).collect()
}

#[test]
fn run_under_attack_leaves_no_key_pressed_and_presses_nothing_after_a_pause() {
    let Some(server) = XServer::start() else {
        return;
    };
    let length = Duration::from_secs(setting("ADEMAN_CHAOS_SECONDS", 20));
    let seed = setting("ADEMAN_CHAOS_SEED", fastrand::u64(..1_000_000));
    println!("seed {seed}");
    let mut random = fastrand::Rng::with_seed(seed);
    let attacks = attacks();
    let mut deck = Vec::new();
    let mut rig = Rig::new(server);
    let start = Instant::now();
    while start.elapsed() < length {
        let episode = Episode::draw(&attacks, &mut deck, &mut random);
        if let Err(violation) = rig.play(&episode) {
            println!("{}", rig.report(start.elapsed()));
            panic!(
                "seed {seed}: {violation}; in {episode:#?}\n{}",
                rig.messages()
            );
        }
    }
    rig.finish()
        .unwrap_or_else(|violation| panic!("seed {seed}: {violation}"));
    println!("{}", rig.report(start.elapsed()));
}
