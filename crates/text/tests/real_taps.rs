//! Real taps of people on a telephone, leaving out the person that is measured.

mod support;

use ademan_text::touch::PairSums;
use ademan_text::{Key, Keyboard, Model, Prior, Tap};
use serde_json::Value;
use support::session::{Errors, Phrase, decode, nearest};
use support::shared;

/// The units of the recording in millimetres, from the size of its keys.
const MM_PER_PIXEL: [f32; 2] = [6.7 / 135.0, 10.2 / 206.0];

fn json(path: &str) -> Option<Value> {
    let text = std::fs::read_to_string(shared(path)?).expect("a file");
    Some(serde_json::from_str(&text).expect("JSON"))
}

fn number(value: &Value) -> f32 {
    value.as_f64().expect("a number") as f32
}

fn character(name: &str) -> char {
    match name.to_lowercase().as_str() {
        "space" => ' ',
        name => name.chars().next().expect("a name"),
    }
}

fn keyboard(file: &Value) -> Keyboard {
    let keys = file["keys_info"].as_object().expect("keys");
    Keyboard::new(keys.iter().map(|(name, key)| {
        let length = |field: &str, axis: usize| number(&key[field]) * MM_PER_PIXEL[axis];
        Key {
            character: character(name),
            center: [length("key_center_x", 0), length("key_center_y", 1)],
            size: [length("key_width", 0), length("key_height", 1)],
            hand: 0,
        }
    }))
}

/// A person with their phrases, and the offsets of their letters from the centers of the keys.
struct Person {
    name: String,
    phrases: Vec<Phrase>,
    offsets: Vec<(char, [f32; 2])>,
    /// Successive letters with their offsets.
    successive: Vec<[(char, [f32; 2]); 2]>,
}

fn people(file: &Value, keyboard: &Keyboard) -> Vec<Person> {
    let mut people: Vec<Person> = Vec::new();
    for phrase in file.as_array().expect("phrases") {
        let source = phrase["source"].as_str().expect("a source");
        let name = source.split('/').next().expect("a person");
        let mut offsets = Vec::new();
        let mut successive = Vec::new();
        let mut before = None;
        let taps = phrase["taps"].as_array().expect("taps").iter().map(|tap| {
            let character = character(tap["key"].as_str().expect("a key"));
            let key = keyboard.keys()[keyboard.index(character).expect("a key")];
            let offset = [
                number(&tap["dxNorm"]) * key.size[0],
                number(&tap["dyNorm"]) * key.size[1],
            ];
            let letter = character.is_alphabetic().then_some((character, offset));
            offsets.extend(letter);
            successive.extend(before.zip(letter).map(|(before, letter)| [before, letter]));
            before = letter;
            Tap::at(key.center[0] + offset[0], key.center[1] + offset[1])
        });
        let taps = taps.collect();
        let index = people
            .iter()
            .position(|person| person.name == name)
            .unwrap_or_else(|| {
                people.push(Person {
                    name: name.to_owned(),
                    phrases: Vec::new(),
                    offsets: Vec::new(),
                    successive: Vec::new(),
                });
                people.len() - 1
            });
        let meant = phrase["intended"].as_str().expect("a text").to_lowercase();
        people[index].phrases.push(Phrase {
            meant,
            taps,
            space: None,
        });
        people[index].offsets.extend(offsets);
        people[index].successive.extend(successive);
    }
    people
}

/// Returns the mean of the offsets of some letters.
fn mean_of(offsets: &[(char, [f32; 2])], is_one: impl Fn(char) -> bool) -> [f32; 2] {
    let some = offsets.iter().filter(|(letter, _)| is_one(*letter));
    let count = some.clone().count() as f32;
    std::array::from_fn(|axis| some.clone().map(|(_, offset)| offset[axis]).sum::<f32>() / count)
}

/// Fits the prior to the taps of people: mean and covariance around each one's own mean.
fn prior<'a>(people: impl Iterator<Item = &'a Person>) -> Prior {
    let (mut mean, mut squares, mut count) = ([0.0; 2], [0.0; 3], 0.0);
    for person in people {
        let number = person.offsets.len() as f32;
        let own = mean_of(&person.offsets, |_| true);
        for (_, offset) in &person.offsets {
            let [x, y] = [offset[0] - own[0], offset[1] - own[1]];
            for (sum, square) in squares.iter_mut().zip([x * x, y * y, x * y]) {
                *sum += square;
            }
        }
        mean = [mean[0] + own[0] * number, mean[1] + own[1] * number];
        count += number;
    }
    Prior {
        offset: mean.map(|sum| sum / count),
        covariance: squares.map(|sum| sum / count),
        // Thumbs on a telephone.
        first_drift: 0.6,
        drift: 0.05,
        ..Prior::default()
    }
}

/// Adds the successive letters of people to the sums of the other and of the same hand, if the left thumb types up to T, G and B. They
/// are around the mean of each thumb: an offset of one thumb is drift, and would look like a correlation of its taps.
fn pairs_of(people: &[Person]) -> [PairSums; 2] {
    let is_left = |letter: char| "qwertasdfgzxcvb".contains(letter);
    let mut sums = [PairSums::default(); 2];
    for person in people {
        let means = [false, true]
            .map(|is_of_left| mean_of(&person.offsets, |letter| is_left(letter) == is_of_left));
        let centered = |(letter, offset): (char, [f32; 2])| {
            let mean = means[usize::from(is_left(letter))];
            // A slip to another key is no scatter.
            std::array::from_fn(|axis| (offset[axis] - mean[axis]).clamp(-6.0, 6.0))
        };
        for [first, second] in &person.successive {
            let is_same_hand = is_left(first.0) == is_left(second.0);
            sums[usize::from(is_same_hand)].add(centered(*first), centered(*second));
        }
    }
    sums
}

#[test]
fn a_real_tap_is_beside_its_key_on_the_side_of_the_tap_before() {
    let (Some(taps), Some(keys)) = (
        json("data/taps/tsi_odd_users.json"),
        json("data/taps/keyboard_data.json"),
    ) else {
        return;
    };
    let [other, same] = pairs_of(&people(&taps, &keyboard(&keys)));
    println!(
        "correlation of {} pairs of one thumb: {:.3}, of {} pairs of both: {:.3}",
        same.pairs,
        same.correlation(),
        other.pairs,
        other.correlation()
    );
    // The standard error of either is 0.05 with these numbers of pairs along two axes.
    assert!((0.1..0.3).contains(&same.correlation()), "{same:?}");
    assert!((0.0..0.2).contains(&other.correlation()), "{other:?}");
    let prior = Prior::default();
    assert!((prior.same_hand - same.correlation()).abs() < 0.1);
    assert!((prior.other_hand - other.correlation()).abs() < 0.1);
}

#[test]
fn real_taps_are_read_with_few_errors_leaving_one_person_out() {
    let (Some(taps), Some(keys)) = (
        json("data/taps/tsi_odd_users.json"),
        json("data/taps/keyboard_data.json"),
    ) else {
        return;
    };
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let keyboard = keyboard(&keys);
    let people = people(&taps, &keyboard);
    assert_eq!(people.len(), 8);
    let (mut plain, mut decoded) = (Errors::default(), Errors::default());
    for person in &people {
        let others = people.iter().filter(|other| other.name != person.name);
        let texts = decode(&model, &keyboard, prior(others), &person.phrases);
        let (mut own_plain, mut own) = (Errors::default(), Errors::default());
        for (phrase, text) in person.phrases.iter().zip(&texts) {
            own_plain.add(&phrase.meant, &nearest(&keyboard, &phrase.taps));
            own.add(&phrase.meant, text);
            println!(
                "  {:40} {:40} {text}",
                phrase.meant,
                nearest(&keyboard, &phrase.taps)
            );
        }
        println!(
            "{}: nearest key {:.2} % CER {:.1} % words, decoded {:.2} % CER {:.1} % words",
            person.name,
            own_plain.cer(),
            own_plain.wer(),
            own.cer(),
            own.wer(),
        );
        plain.merge(&own_plain);
        decoded.merge(&own);
    }
    println!(
        "all: nearest key {:.2} % CER {:.1} % of {} words, decoded {:.2} % CER {:.1} % words",
        plain.cer(),
        plain.wer(),
        plain.words,
        decoded.cer(),
        decoded.wer(),
    );
    let all = prior(people.iter());
    println!("prior of all: {:?} {:?}", all.offset, all.covariance);
    // The baseline is as bad as the data says, and the decoder clearly better.
    assert!(plain.cer() > 4.0 && plain.wer() > 14.0, "{plain:?}");
    assert!(decoded.cer() <= 1.0, "{decoded:?}");
    assert!(decoded.wer() <= 4.0, "{decoded:?}");
}
