//! Episodes: attacks that overlap.

use std::time::Duration;

use fastrand::Rng;

use super::attack::Attack;

/// The most attacks at once.
const MAX_ATTACKS: usize = 4;

/// The longest time from the start of an episode to the start of an attack, in milliseconds.
const MAX_START: u64 = 400;

/// An attack from a time on, for a time.
#[derive(Clone, Copy, Debug)]
pub struct TimedAttack {
    pub attack: Attack,
    pub start: Duration,
    pub length: Duration,
}

/// The attacks of an episode, by their start, and the hand.
#[derive(Debug)]
pub struct Episode {
    pub attacks: Vec<TimedAttack>,
    /// The hand types; otherwise it holds a key.
    pub is_typing: bool,
}

impl Episode {
    /// Draws the next attacks from a shuffled deck, so that all are equally frequent.
    pub fn draw(attacks: &[Attack], deck: &mut Vec<Attack>, random: &mut Rng) -> Self {
        let mut drawn: Vec<TimedAttack> = Vec::new();
        let count = random.usize(1..=MAX_ATTACKS);
        while drawn.len() < count {
            if deck.is_empty() {
                deck.extend(attacks);
                random.shuffle(deck);
            }
            let is_free = |attack: &Attack| {
                let mut targets = drawn.iter().map(|other| other.attack.target());
                targets.all(|target| target != attack.target())
            };
            let Some(index) = deck.iter().rposition(is_free) else {
                break;
            };
            let attack = deck.remove(index);
            let (shortest, longest) = attack.length();
            drawn.push(TimedAttack {
                attack,
                start: Duration::from_millis(random.u64(..=MAX_START)),
                length: shortest + (longest - shortest).mul_f64(random.f64()),
            });
        }
        drawn.sort_by_key(|attack| attack.start);
        Self {
            attacks: drawn,
            is_typing: random.bool(),
        }
    }

    pub fn has(&self, attack: Attack) -> bool {
        self.attacks.iter().any(|timed| timed.attack == attack)
    }
}
