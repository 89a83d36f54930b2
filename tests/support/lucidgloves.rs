//! A LucidGloves build that measures curls only, as lines of the alpha encoding.

use ademan::capture::protocol::lucidgloves::{FULL_SCALE, Fields};
use ademan::hand::Finger;

/// The rate of the lines, in hertz.
pub const RATE_HZ: f64 = 100.0;

/// The text that [`chords`] types with the layout `chords-bend`, and the fingers of each letter.
pub const TEXT: &str = "hello";
const CHORDS: [&[Finger]; 5] = [
    &[Finger::Middle, Finger::Ring],
    &[Finger::Index],
    &[Finger::Thumb, Finger::Little],
    &[Finger::Thumb, Finger::Little],
    &[Finger::Little],
];

/// The curl of a finger that presses, as a fraction.
pub const PRESSED: f64 = 0.8;

/// Lines of a movement of the fingers down or up.
const MOVE: usize = 12;

/// Returns the fields of a hand whose fingers have these curls, as fractions, with the stick at rest.
pub fn curls(curls: [f64; Finger::COUNT]) -> Fields {
    let count = |curl: f64| Some((curl * f64::from(FULL_SCALE)).round() as i64);
    Fields {
        curls: curls.map(count),
        stick: [Some(2047), Some(2047)],
        trigger: Some(0),
        ..Fields::default()
    }
}

/// Returns the fields of a straight hand for half a second, then of fingers that press and release, then of the straight hand.
pub fn taps(chords: &[&[Finger]]) -> Vec<Fields> {
    let straight = || vec![curls([0.0; Finger::COUNT]); 50];
    let mut hand = straight();
    for chord in chords {
        let down = (1..=MOVE).chain([MOVE; MOVE]);
        for step in down.chain((0..MOVE).rev()).chain([0; MOVE]) {
            let curl = PRESSED * step as f64 / MOVE as f64;
            let pose = |&finger: &Finger| if chord.contains(&finger) { curl } else { 0.0 };
            hand.push(curls(std::array::from_fn(|index| {
                pose(&Finger::ALL[index])
            })));
        }
    }
    hand.extend(straight());
    hand
}

/// Returns the fields of a hand that types [`TEXT`] with the layout `chords-bend`.
pub fn chords() -> Vec<Fields> {
    taps(&CHORDS)
}

/// Returns fields as a line of the legacy encoding: 13 numbers.
pub fn legacy(fields: &Fields) -> String {
    let numbers = fields.curls.iter().chain(&fields.stick);
    let numbers = numbers.map(|value| value.unwrap_or_default());
    let buttons = fields.buttons[..6]
        .iter()
        .map(|&is_down| i64::from(is_down));
    let all: Vec<String> = numbers
        .chain(buttons)
        .map(|number| number.to_string())
        .collect();
    format!("{}\n", all.join("&"))
}

/// Adds noise to the curls, equally distributed within `counts` above and below.
pub fn with_noise(mut fields: Fields, counts: i64, random: &mut fastrand::Rng) -> Fields {
    for curl in fields.curls.iter_mut().flatten() {
        *curl = (*curl + random.i64(-counts..=counts)).clamp(0, i64::from(FULL_SCALE));
    }
    fields
}
