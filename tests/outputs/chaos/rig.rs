//! The course of an episode, and what is checked.

use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rustix::process::Signal;

use super::attack::{Attack, Target};
use super::episode::{Episode, TimedAttack};
use super::judge::{first_release, presses_after};
use super::scene::Scene;
use super::stats::ChaosStats;
use super::subject::request;
use crate::support::key_log::{Action, KeyLog};
use crate::support::x11::{XServer, wait_at_most, wait_for};

/// The longest time until all keys are released. An idle machine needs at most 400 ms; the rest is for a busy one.
const BOUND: Duration = Duration::from_secs(60);

/// The longest time for a movement of the hand, which takes 2 s on an idle machine.
const MOVEMENT: Duration = Duration::from_secs(20);

/// The number of attempts to arm the run and press a key: a stall of a busy machine ends one.
const ATTEMPTS: usize = 15;

/// The most resident memory: eight times what a run needs without attacks.
const MAX_MEMORY_KB: u64 = 100_000;

/// The number of messages to print after a violation.
const MESSAGES: usize = 40;

pub struct Rig {
    scene: Scene,
    log: KeyLog,
    stats: ChaosStats,
}

/// An episode in progress.
struct Course<'a> {
    episode: &'a Episode,
    /// The times at which the attacks took effect.
    begun: Vec<(TimedAttack, Instant)>,
    /// The time at which the X server responds again.
    display_responds: Instant,
    pause: Option<JoinHandle<Result<Instant, String>>>,
    /// The time at which a pause was acknowledged.
    paused: Option<Instant>,
}

impl Rig {
    pub fn new(server: XServer) -> Self {
        let log = KeyLog::start(&server);
        let scene = Scene::new(server);
        let stats = ChaosStats {
            starts: 1,
            ..ChaosStats::default()
        };
        Self { scene, log, stats }
    }

    /// Plays an episode. Returns the violated guarantee, if there is one.
    pub fn play(&mut self, episode: &Episode) -> Result<(), String> {
        self.start_pressing(episode.is_typing)?;
        self.stats.episodes += 1;
        let mut course = self.attack(episode);
        self.check_exit(&course)?;
        self.check_pause(&mut course)?;
        self.check_release(&course)?;
        self.check_watchdog(&course)?;
        self.check_response(&course)?;
        self.check_resources()?;
        for (timed, begun) in &course.begun {
            thread::sleep((*begun + timed.length).saturating_duration_since(Instant::now()));
        }
        for timed in &episode.attacks {
            self.scene.end(timed.attack);
        }
        self.check_clear(&course)?;
        self.check_silence(&course)
    }

    /// Ends the program and compares presses with releases.
    pub fn finish(&mut self) -> Result<(), String> {
        self.scene.lift_hand();
        self.scene.subject.signal(Signal::TERM);
        if !wait_for(|| self.scene.subject.exit_status().is_some()) {
            return Err("the program does not exit".into());
        }
        let is_clear = || self.log.pressed().is_empty();
        if wait_at_most(BOUND, is_clear) && self.scene.server.pressed_keys().is_empty() {
            Ok(())
        } else {
            Err(format!("stuck at the end: {:?}", self.log.pressed()))
        }
    }

    /// Returns the statistics.
    pub fn report(&mut self, length: Duration) -> &ChaosStats {
        let events = self.log.events();
        let count = |action| events.iter().filter(|event| event.action == action).count();
        self.stats.presses = count(Action::Press);
        self.stats.repeats = count(Action::Repeat);
        self.stats.releases = count(Action::Release);
        self.stats.length = length;
        &self.stats
    }

    /// Returns the last messages of the program.
    pub fn messages(&self) -> String {
        let lines = self.scene.subject.stderr.lines();
        lines[lines.len().saturating_sub(MESSAGES)..].join("\n")
    }

    /// Starts the program if it has exited, arms it, and waits until a key is pressed.
    fn start_pressing(&mut self, is_typing: bool) -> Result<(), String> {
        for _ in 0..ATTEMPTS {
            if let Some(status) = self.scene.subject.exit_status() {
                let last = self.scene.subject.stderr.lines().pop();
                println!("{status}, {}", last.unwrap_or_default());
                self.scene.restart_program();
                self.stats.starts += 1;
            }
            let before = self.log.len();
            self.scene.start_pressing(is_typing);
            if wait_at_most(MOVEMENT, || self.log.presses_after(before) > 0) {
                return Ok(());
            }
        }
        Err("the program does not type again".into())
    }

    /// Begins all attacks, and ends those on the X server.
    fn attack<'a>(&mut self, episode: &'a Episode) -> Course<'a> {
        let start = Instant::now();
        let mut steps = Vec::new();
        for timed in &episode.attacks {
            steps.push((timed.start, timed, true));
            if timed.attack.blocks_display() {
                steps.push((timed.start + timed.length, timed, false));
            }
        }
        steps.sort_by_key(|(time, ..)| *time);
        let mut course = Course {
            episode,
            begun: Vec::new(),
            display_responds: start,
            pause: None,
            paused: None,
        };
        for (time, timed, is_begin) in steps {
            thread::sleep((start + time).saturating_duration_since(Instant::now()));
            if !is_begin {
                self.scene.end(timed.attack);
                course.display_responds = Instant::now();
                continue;
            }
            self.stats.count(timed.attack);
            self.scene.begin(timed.attack);
            if timed.attack == Attack::PauseByCommand {
                let socket = self.scene.socket().to_owned();
                let pause = move || request(&socket, "pause").map(|()| Instant::now());
                course.pause = Some(thread::spawn(pause));
            }
            course.begun.push((*timed, Instant::now()));
        }
        course
    }

    /// Checks that one SIGTERM ends the program.
    fn check_exit(&mut self, course: &Course) -> Result<(), String> {
        let has_exited = || self.scene.subject.exit_status().is_some();
        if course.episode.has(Attack::TerminateProgram) && !wait_at_most(BOUND, has_exited) {
            Err(format!("SIGTERM does not end the program within {BOUND:?}"))
        } else {
            Ok(())
        }
    }

    /// Checks that SIGUSR1 does not end the watchdog.
    fn check_watchdog(&self, course: &Course) -> Result<(), String> {
        let has = |target| {
            let mut attacks = course.episode.attacks.iter();
            attacks.any(|timed| timed.attack.target() == target)
        };
        if !course.episode.has(Attack::PauseBySignal) || has(Target::Processes) {
            return Ok(());
        }
        if self.scene.subject.watchdogs() == self.scene.signalled_watchdogs {
            Ok(())
        } else {
            Err("SIGUSR1 ends the watchdog".into())
        }
    }

    /// Waits until a pause is acknowledged, and checks that it is.
    fn check_pause(&mut self, course: &mut Course) -> Result<(), String> {
        let pause = course
            .pause
            .take()
            .map(|pause| pause.join().expect("no panic"));
        match pause {
            None => Ok(()),
            Some(Ok(paused)) => {
                course.paused = Some(paused);
                Ok(())
            }
            Some(Err(reason)) if self.must_respond(course) => {
                Err(format!("`ctl pause` is not acknowledged: {reason}"))
            }
            Some(Err(_)) => Ok(()),
        }
    }

    /// Checks that all keys are released while the hand still presses.
    fn check_release(&mut self, course: &Course) -> Result<(), String> {
        for (timed, begun) in &course.begun {
            let attack = timed.attack;
            let due = match attack {
                Attack::PauseByCommand => course.paused,
                _ => attack.must_release().then_some(*begun),
            };
            let Some(due) = due else { continue };
            let due = due.max(course.display_responds);
            let release = || first_release(&self.log.events(), due);
            if !wait_at_most(BOUND, || release().is_some()) {
                let pressed = self.log.pressed();
                return Err(format!("{pressed:?} stay pressed after {attack:?}"));
            }
            let release = release().expect("it was released before");
            self.stats.record_release(attack, release - due);
        }
        Ok(())
    }

    /// Checks that a program that runs answers a command.
    fn check_response(&mut self, course: &Course) -> Result<(), String> {
        if !self.must_respond(course) {
            return Ok(());
        }
        match request(self.scene.socket(), "state") {
            Err(reason) if self.must_respond(course) => {
                Err(format!("`ctl state` is not answered: {reason}"))
            }
            _ => Ok(()),
        }
    }

    /// Records the memory and the file descriptors of the program, and checks the memory.
    fn check_resources(&mut self) -> Result<(), String> {
        let Some((memory, descriptors)) = self.scene.subject.resources() else {
            return Ok(());
        };
        self.stats.memory = self.stats.memory.max(memory);
        self.stats.descriptors = self.stats.descriptors.max(descriptors);
        if memory > MAX_MEMORY_KB {
            return Err(format!("the program has {memory} kB of memory"));
        }
        Ok(())
    }

    /// Returns `true` if the program runs and no attack prevents a response.
    fn must_respond(&mut self, course: &Course) -> bool {
        let attacks = &course.episode.attacks;
        let is_silenced = attacks.iter().any(|timed| timed.attack.silences_program());
        !is_silenced && self.scene.subject.exit_status().is_none()
    }

    /// Checks that all keys are released after all attacks, when the hand has left the keys.
    fn check_clear(&mut self, course: &Course) -> Result<(), String> {
        let due = Instant::now();
        self.scene.lift_hand();
        let server = &self.scene.server;
        let is_clear = || {
            self.log.pressed().is_empty()
                && server.pressed_keys().is_empty()
                && server.pressed_buttons().is_empty()
        };
        if !wait_at_most(BOUND, is_clear) {
            let pressed = self.log.pressed();
            return Err(format!(
                "{pressed:?} stay pressed after the hand has left the keys"
            ));
        }
        let events = self.log.events();
        let release = first_release(&events, due).unwrap_or(due);
        for timed in &course.episode.attacks {
            if !timed.attack.must_release() {
                self.stats.record_release(timed.attack, release - due);
            }
        }
        Ok(())
    }

    /// Checks that nothing was pressed after a pause, except for a press on its way.
    fn check_silence(&self, course: &Course) -> Result<(), String> {
        let Some(paused) = course.paused else {
            return Ok(());
        };
        let due = paused.max(course.display_responds);
        match presses_after(&self.log.events(), due) {
            0 | 1 => Ok(()),
            count => Err(format!("{count} presses after a pause")),
        }
    }
}
