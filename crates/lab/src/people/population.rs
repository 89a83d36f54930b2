//! Populations: people whose parameters are drawn from ranges with a seed, and repetitions of one person of a file.

use super::draw::{Draw, mix};
use super::{Participant, Tier};
use crate::hand::{Finger, FingerSet};
use crate::kinematics::BoneLengths;
use crate::layout::{HandUse, Motion, Person};

/// The largest part by which an own bone differs from what the pipeline assumes.
const BONE_ERROR: f64 = 0.05;
/// Forearm length as a multiple of hand length (Drillis & Contini 1966).
const FOREARM: f64 = 1.352;
/// The mean hand lengths of men and of women, in millimetres: assumed.
///
/// Published samples differ by more than their errors: 183 and 166 mm in Buryanov & Kotiuk 2010, from whose 5th to 95th percentile the
/// simulated wearers of a calibration are drawn. The lab keeps its own figures, as other hands would be another population: every score
/// of these people would change.
const MEAN_HANDS: [f64; 2] = [190.0, 173.0];
/// The deviation of both from their mean, in millimetres: assumed.
const HAND_DEVIATION: f64 = 9.0;
/// The range of hand lengths, in millimetres.
const HANDS: (f64, f64) = (165.0, 205.0);

/// The people who type.
#[derive(Clone, Debug)]
pub enum People {
    /// A number of people of the general population.
    Drawn(u32),
    /// A person of a file: the size, the fingers, and the errors of its movements. The times and the differences from what the
    /// pipeline assumes are drawn, for each of a number of repetitions.
    Person(Box<Person>, u32),
}

/// Draws people. The same seed gives the same people, for any number of people.
pub fn population(people: &People, tier: Option<Tier>, seed: u64) -> Vec<Participant> {
    let (count, person) = match people {
        People::Drawn(count) => (*count, None),
        People::Person(person, count) => (*count, Some(person.as_ref())),
    };
    let draw = |number: u32| {
        let own_seed = mix(seed.wrapping_add(u64::from(number).wrapping_mul(0x5851_f42d)));
        let mut drawn = general(number, own_seed);
        if let Some(person) = person {
            adopt(&mut drawn, person);
        }
        if let Some(tier) = tier {
            let direction = Draw::new(own_seed, DIRECTION).between(0.0, std::f64::consts::TAU);
            tier.apply(&mut drawn, direction);
        }
        drawn
    };
    (0..count).map(draw).collect()
}

/// Purposes of the streams of random numbers.
const BODY: u64 = 1;
const BONE_ERRORS: u64 = 2;
const TIMES: u64 = 3;
const ERRORS: u64 = 4;
const DIRECTION: u64 = 5;

/// Returns a person of the general population.
fn general(number: u32, seed: u64) -> Participant {
    let mut body = Draw::new(seed, BODY);
    let [of_men, of_women] = MEAN_HANDS;
    let mean = if body.happens(0.5) { of_men } else { of_women };
    let hand = (mean + HAND_DEVIATION * body.normal()).clamp(HANDS.0, HANDS.1) * 1e-3;
    let forearm = hand * FOREARM * (1.0 + 0.03 * body.normal().clamp(-2.0, 2.0));
    let assumed = BoneLengths::from_hand_and_forearm(hand, forearm);
    let assumed = assumed.expect("the lengths are in the range of people");
    let (fingers, pace): (&[Finger], _) = match body.index(3) {
        0 => (&[Finger::Index], (12.0, 30.0)),
        1 => (&[Finger::Index, Finger::Middle], (18.0, 38.0)),
        _ => (Finger::ALL, (25.0, 50.0)),
    };
    let mut times = Draw::new(seed, TIMES);
    let mut errors = Draw::new(seed, ERRORS);
    let common = [1.5 * errors.normal(), 1.5 * errors.normal()];
    let offsets = std::array::from_fn(|_| common.map(|own| own + 0.7 * errors.normal()));
    Participant {
        number,
        seed,
        own: own_bones(&assumed, seed),
        assumed,
        fingers: fingers.iter().map(|it| it.name().to_owned()).collect(),
        one_hand: false,
        pace_wpm: times.between(pace.0, pace.1),
        interval_cv: times.between(0.30, 0.45),
        fitts_a_ms: times.between(50.0, 80.0),
        fitts_b_ms: times.between(60.0, 110.0),
        press_ms: times.between(60.0, 100.0),
        dwell_ms: times.between(20.0, 60.0),
        depth: errors.between(4.0, 10.0),
        depth_scatter: errors.between(1.0, 4.0),
        scatter: [errors.between(4.0, 7.0), errors.between(4.0, 7.0)],
        scatter_parts: [0.0075, 0.0108],
        elongation: errors.between(0.0, 0.5),
        offsets,
        drift: errors.between(0.3, 0.6),
        drift_kept: errors.between(0.8, 0.97),
        tremor: errors.log_normal(0.051, 0.6).clamp(0.008, 0.18),
        tremor_hz: errors.between(6.0, 10.0),
        sway: errors.between(0.5, 2.0),
        slip: errors.between(0.0, 4.0),
        enslaving: errors.between(0.3, 1.0),
        missed: errors.between(0.0, 0.02),
        spurious: errors.between(0.0, 0.02),
        adaptation: errors.between(0.8, 1.0),
        glove_gain_error: 0.1,
        glove_backlash_deg: errors.between(2.0, 5.0),
        corrects: 0.0,
        notice_ms: times.between(250.0, 700.0),
    }
}

/// Returns bones that differ from the assumed ones, each by its own part.
fn own_bones(assumed: &BoneLengths, seed: u64) -> BoneLengths {
    let mut draw = Draw::new(seed, BONE_ERRORS);
    let mut off = |length: f64| length * (1.0 + draw.between(-BONE_ERROR, BONE_ERROR));
    BoneLengths {
        hand: off(assumed.hand),
        forearm: off(assumed.forearm),
        upper_arm: off(assumed.upper_arm),
        breadth: off(assumed.breadth),
        phalanges: assumed.phalanges.map(|finger| finger.map(&mut off)),
        thumb: assumed.thumb.map(&mut off),
    }
}

/// Takes the size, the fingers and the errors of a person of a file.
fn adopt(drawn: &mut Participant, person: &Person) {
    if let Some(bones) = person.bones {
        drawn.assumed = bones;
        drawn.own = own_bones(&drawn.assumed, drawn.seed);
    }
    let pressing = Finger::ALL.iter();
    let pressing = pressing.filter(|finger| person.fingers.contains(**finger));
    drawn.fingers = pressing.map(|finger| finger.name().to_owned()).collect();
    drawn.one_hand = person.hands == HandUse::One;
    let mut times = Draw::new(drawn.seed, TIMES);
    let pace = match person.fingers {
        FingerSet::ALL => (25.0, 50.0),
        fingers if fingers.contains(Finger::Middle) => (18.0, 38.0),
        _ => (12.0, 30.0),
    };
    let Motion {
        speed,
        scatter,
        offsets,
        tremor,
        enslaving,
    } = person.motion;
    drawn.pace_wpm = times.between(pace.0, pace.1) * speed;
    drawn.fitts_a_ms /= speed;
    drawn.fitts_b_ms /= speed;
    drawn.press_ms /= speed;
    drawn.dwell_ms /= speed;
    let millimetres = |metres: f32| f64::from(metres) * 1e3;
    drawn.scatter = [
        millimetres(scatter.deviation.x),
        millimetres(scatter.deviation.y),
    ];
    drawn.depth_scatter = millimetres(scatter.deviation.z);
    drawn.scatter_parts = [f64::from(scatter.parts.x), f64::from(scatter.parts.y)];
    drawn.offsets = offsets.map(|offset| [millimetres(offset.x), millimetres(offset.y)]);
    drawn.tremor = tremor.amplitude * 1e3;
    drawn.tremor_hz = tremor.frequency_hz;
    drawn.enslaving = enslaving;
    // A file says all errors of its person.
    drawn.elongation = 0.0;
    drawn.drift = 0.0;
    drawn.sway = 0.0;
    drawn.slip = 0.0;
    drawn.missed = 0.0;
    drawn.spurious = 0.0;
    drawn.adaptation = 1.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_people_begin_with_the_same_people() {
        let few = population(&People::Drawn(5), None, 7);
        let many = population(&People::Drawn(9), None, 7);
        assert_eq!(few[..], many[..5]);
        assert_ne!(population(&People::Drawn(5), None, 8), few);
    }

    #[test]
    fn no_bone_is_what_the_pipeline_assumes_and_none_is_far_from_it() {
        for person in population(&People::Drawn(100), None, 1) {
            let pairs = person.own.phalanges.iter().flatten();
            let pairs = pairs.zip(person.assumed.phalanges.iter().flatten());
            for (own, assumed) in pairs {
                let part = (own / assumed - 1.0).abs();
                assert!(part > 0.0 && part <= BONE_ERROR + 1e-9, "{part}");
            }
        }
    }

    #[test]
    fn a_tier_sets_the_scatter_and_leaves_the_hands_and_the_pace() {
        let own = population(&People::Drawn(4), None, 1);
        let tiered = population(&People::Drawn(4), Some(Tier::T3), 1);
        for (plain, changed) in own.iter().zip(&tiered) {
            assert_eq!((plain.own, plain.pace_wpm), (changed.own, changed.pace_wpm));
            assert_eq!(changed.scatter, [8.0; 2]);
            assert_eq!(changed.enslaving, plain.enslaving);
        }
        let worst = population(&People::Drawn(4), Some(Tier::T4), 1);
        assert!(worst.iter().all(|person| person.enslaving == 1.0));
    }
}
