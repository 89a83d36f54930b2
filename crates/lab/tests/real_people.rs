//! Simulated people beside real ones: places and times of taps on a telephone, before and after a fit on half of the people.
//!
//! The recordings are not part of the project (dataset of tap typing with touch sensing images, CC BY 4.0).

mod support;

use ademan_core::hand::{Finger, Side};
use ademan_core::kinematics::ArmModel;
use ademan_core::layout::Layout;
use ademan_lab::people::{Draw, Participant};
use ademan_lab::sim::TypingKeys;
use ademan_lab::sim::fluent::{FluentHand, HandSetup, SourceKind, StartPosture, Tap};
use parry3d::math::Vec2;
use serde_json::Value;
use support::{shared, steady};

/// The size of a letter, in millimetres.
const KEY: [f64; 2] = [6.7, 10.2];
/// The dual Gaussian of fingers on glass (Bi & Zhai 2016 ?).
const GLASS: ([f64; 2], [f64; 2]) = ([1.296, 1.153], [0.0075, 0.0108]);

/// A real person: offsets of letters from the centers of the keys in millimetres, to the right and up, and the times since the tap
/// before, in milliseconds.
#[derive(Default)]
struct Real {
    name: String,
    offsets: Vec<[f64; 2]>,
    times: Vec<f64>,
}

fn real_people() -> Option<Vec<Real>> {
    let text = std::fs::read_to_string(shared("data/taps/tsi_odd_users.json")?).expect("a file");
    let phrases: Value = serde_json::from_str(&text).expect("JSON");
    let mut people: Vec<Real> = Vec::new();
    for phrase in phrases.as_array().expect("phrases") {
        let source = phrase["source"].as_str().expect("a source");
        let name = source.split('/').next().expect("a person");
        if people.iter().all(|person| person.name != name) {
            people.push(Real {
                name: name.to_owned(),
                ..Real::default()
            });
        }
        let person = people.iter_mut().find(|person| person.name == name);
        let person = person.expect("it was added");
        for tap in phrase["taps"].as_array().expect("taps") {
            let number = |field: &str| tap[field].as_f64().expect("a number");
            let key = tap["key"].as_str().expect("a key");
            if key.chars().count() == 1 && key.chars().all(char::is_alphabetic) {
                // The recording counts downwards.
                let offset = [number("dxNorm") * KEY[0], -number("dyNorm") * KEY[1]];
                person.offsets.push(offset);
            }
            if number("dtMs") > 0.0 {
                person.times.push(number("dtMs"));
            }
        }
    }
    Some(people)
}

/// The known facts about a group of people.
#[derive(Clone, Debug)]
struct Parameters {
    /// Mean and deviation of the offsets of people, in millimetres.
    offset: [(f64, f64); 2],
    scatter: [f64; 2],
    /// Mean and deviation of the logarithm of the median time, and the variation of times.
    median: (f64, f64),
    variation: f64,
}

fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len() as f64
}

fn deviation(numbers: &[f64]) -> f64 {
    let center = mean(numbers);
    let squares: Vec<f64> = numbers.iter().map(|it| (it - center).powi(2)).collect();
    mean(&squares).sqrt()
}

impl Parameters {
    /// Returns the parameters of the literature: no offsets, glass, and 12 to 30 words a minute.
    fn published() -> Self {
        Self {
            offset: [(0.0, 0.0); 2],
            scatter: GLASS.0,
            median: (12_000.0_f64.ln() - 20.0_f64.ln(), 0.25),
            variation: 0.375,
        }
    }

    fn fit(people: &[&Real]) -> Self {
        let means = |axis: usize| -> Vec<f64> {
            let own = |person: &&Real| {
                let own: Vec<f64> = person.offsets.iter().map(|it| it[axis]).collect();
                mean(&own)
            };
            people.iter().map(own).collect()
        };
        let within = |axis: usize| {
            let own = people.iter().flat_map(|person| {
                let own: Vec<f64> = person.offsets.iter().map(|it| it[axis]).collect();
                let center = mean(&own);
                own.into_iter().map(move |it| it - center)
            });
            let variance = deviation(&own.collect::<Vec<_>>()).powi(2);
            (variance - GLASS.1[axis] * KEY[axis].powi(2))
                .max(0.01)
                .sqrt()
        };
        let logarithms =
            |person: &&Real| -> Vec<f64> { person.times.iter().map(|time| time.ln()).collect() };
        // The median, as pauses to think are not part of the model.
        let medians: Vec<f64> = people
            .iter()
            .map(|person| {
                let mut all = logarithms(person);
                all.sort_by(f64::total_cmp);
                all[all.len() / 2]
            })
            .collect();
        // Quartiles are 1.35 deviations of a normal distribution apart.
        let spreads: Vec<f64> = people
            .iter()
            .map(|person| {
                let mut all = logarithms(person);
                all.sort_by(f64::total_cmp);
                (all[all.len() * 3 / 4] - all[all.len() / 4]) / 1.349
            })
            .collect();
        let spread = mean(&spreads);
        Self {
            offset: [0, 1].map(|axis| (mean(&means(axis)), deviation(&means(axis)))),
            scatter: [within(0), within(1)],
            median: (mean(&medians), deviation(&medians)),
            variation: ((spread * spread).exp() - 1.0).sqrt(),
        }
    }

    fn person(&self, number: u64) -> Participant {
        let mut draw = Draw::new(number, 77);
        let mut person = steady(&["index"]);
        person.seed = number;
        person.scatter = self.scatter;
        person.scatter_parts = GLASS.1;
        let [x, y] = self
            .offset
            .map(|(mean, deviation)| mean + deviation * draw.normal());
        person.offsets = [[x, y]; 5];
        let median = (self.median.0 + self.median.1 * draw.normal()).exp();
        person.pace_wpm = 12_000.0 / median;
        person.interval_cv = self.variation;
        person
    }

    /// Returns places and times of 40 simulated people with 25 taps each.
    fn simulated(&self) -> ([Vec<f64>; 2], Vec<f64>) {
        let (mut places, mut times) = ([Vec::new(), Vec::new()], Vec::new());
        let layout = telephone();
        let arm = ArmModel::anthropometric(Side::Right, &steady(&["index"]).assumed);
        let arm = arm.expect("an arm");
        for number in 0..40 {
            let person = self.person(number);
            let setup = HandSetup {
                assumed: &arm,
                own: &arm,
                map: None,
                source: SourceKind::Ideal,
            };
            let mut hand = FluentHand::new(
                setup,
                &person,
                &TypingKeys::new(&layout),
                StartPosture::Relaxed,
            );
            hand.restart(number);
            let mut draw = Draw::new(number, 78);
            for _ in 0..25 {
                let key = &layout.keys[draw.index(layout.keys.len())];
                let tap = Tap {
                    target: key.face.target,
                    finger: Finger::Index,
                    shift: Vec2::ZERO,
                    wanted: 0.0,
                    now: 0.0,
                    is_shallow: false,
                    is_exact: false,
                };
                let plan = hand.tap(&layout.scene, tap).expect("a key within reach");
                for (axis, place) in [plan.point.x, plan.point.y].into_iter().enumerate() {
                    places[axis].push(f64::from(place) * 1e3);
                }
                times.push(draw.log_normal(person.interval() * 1e3, person.interval_cv));
            }
        }
        (places, times)
    }
}

/// Returns a board with the letters of the telephone.
fn telephone() -> Layout {
    let rows = ["QWERTYUIOP", "ASDFGHJKL", "ZXCVBNM"];
    let keys = rows.iter().enumerate().flat_map(|(row, letters)| {
        let width = letters.len() as f64;
        letters.chars().enumerate().map(move |(column, letter)| {
            let x = (column as f64 - (width - 1.0) / 2.0) * KEY[0];
            let y = (1.0 - row as f64) * KEY[1];
            format!("(code: \"{letter}\", at_mm: ({x:.2}, {y:.2})),")
        })
    });
    let text = format!(
        "Layout(name: \"telephone\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45), \
         pitch_mm: 6.7, size_mm: Box(6.5, 10), keys: [{}])])",
        keys.collect::<String>()
    );
    Layout::parse(&text, "telephone").expect("a valid layout")
}

/// Returns the distance of Kolmogorov and Smirnov between two samples.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let part_below = |sample: &[f64], limit: f64| {
        let below = sample.iter().filter(|it| **it <= limit).count();
        below as f64 / sample.len() as f64
    };
    let limits = a.iter().chain(b);
    let gaps = limits.map(|&limit| (part_below(a, limit) - part_below(b, limit)).abs());
    gaps.fold(0.0, f64::max)
}

fn quantiles(sample: &[f64]) -> [f64; 5] {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    [0.05, 0.25, 0.5, 0.75, 0.95].map(|part| sorted[((sorted.len() - 1) as f64 * part) as usize])
}

#[test]
fn fitted_people_tap_where_and_when_other_real_people_do() {
    let Some(people) = real_people() else { return };
    let fitted: Vec<&Real> = people.iter().step_by(2).collect();
    let others: Vec<&Real> = people.iter().skip(1).step_by(2).collect();
    let real_places = [0, 1].map(|axis| -> Vec<f64> {
        let offsets = others.iter().flat_map(|person| &person.offsets);
        offsets.map(|offset| offset[axis]).collect()
    });
    let real_times: Vec<f64> = others.iter().flat_map(|it| it.times.clone()).collect();
    let measure = |name: &str, parameters: &Parameters| {
        let (places, times) = parameters.simulated();
        let distances = [
            distance(&real_places[0], &places[0]),
            distance(&real_places[1], &places[1]),
            distance(&real_times, &times),
        ];
        println!("{name}: {parameters:.2?}\n  distances x, y, time: {distances:.3?}");
        for (what, real, simulated) in [
            ("x mm", &real_places[0], &places[0]),
            ("y mm", &real_places[1], &places[1]),
            ("time ms", &real_times, &times),
        ] {
            let (real, simulated) = (quantiles(real), quantiles(simulated));
            println!("  {what}: real {real:.2?}, simulated {simulated:.2?}");
        }
        distances
    };
    let before = measure("before", &Parameters::published());
    let after = measure("after", &Parameters::fit(&fitted));
    // Half of the people say little about the offsets of the other half: the fit may not help by much.
    assert!(after[0] < 0.2 && after[1] < 0.2, "{after:?}");
    assert!(
        after[0] + after[1] < before[0] + before[1],
        "{before:?} {after:?}"
    );
    assert!(
        after[2] < 0.25 && after[2] < before[2],
        "{before:?} {after:?}"
    );
}

#[test]
fn the_distance_of_two_samples_is_0_for_the_same_and_1_for_separate_ones() {
    assert_eq!(distance(&[1.0, 2.0], &[1.0, 2.0]), 0.0);
    assert_eq!(distance(&[1.0, 2.0], &[3.0, 4.0]), 1.0);
    assert!((distance(&[1.0, 2.0, 3.0, 4.0], &[2.5, 3.0, 4.0, 5.0]) - 0.5).abs() < 1e-12);
}
