//! Recognition of the fingers that tapped, from half a second of pictures of one hand: the landmarks of a camera, without
//! a board and without depth.
//!
//! ```
//! use ademan_core::contact::finger_taps::{PICTURES, TapClip, TapModel};
//!
//! let model = TapModel::shipped();
//! let mut clip = TapClip::default();
//! for _ in 0..PICTURES {
//!     clip.push([[0.0; 2]; 21]); // the 21 points of a hand in one picture
//! }
//! let fingers = model.fingers(&clip);
//! assert!(fingers.is_none_or(|fingers| fingers.is_empty()));
//! ```
//!
//! `train.py`, next to the weights, trains them and documents how; `docs/typing-measured.md` of the project states their accuracy.

mod features;
mod model;

pub use model::{SETS, TapModel, TapModelError};

/// Landmarks of a hand in one picture, in the order of MediaPipe: the wrist, then four for each finger from the thumb on, the tip
/// last. X is to the right and Y down, both in the same unit, of any size.
pub type Picture = [[f32; 2]; POINTS];

/// The number of landmarks of a hand.
pub const POINTS: usize = 21;

/// The pictures of a clip: half a second at 30 pictures a second.
pub const PICTURES: usize = 15;

/// The last pictures of a hand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TapClip {
    pictures: [Picture; PICTURES],
    count: usize,
}

impl TapClip {
    /// Creates a full clip.
    pub fn new(pictures: [Picture; PICTURES]) -> Self {
        Self {
            pictures,
            count: PICTURES,
        }
    }

    /// Appends a picture, and drops the oldest one of a full clip. Does not allocate.
    pub fn push(&mut self, picture: Picture) {
        if self.count == PICTURES {
            self.pictures.rotate_left(1);
            self.count -= 1;
        }
        self.pictures[self.count] = picture;
        self.count += 1;
    }

    /// Returns the pictures, the oldest first; `None` until there are [`PICTURES`].
    pub fn pictures(&self) -> Option<&[Picture; PICTURES]> {
        (self.count == PICTURES).then_some(&self.pictures)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::{Finger, FingerSet};

    /// A hand of which one fingertip moves to the side in one picture.
    fn picture(number: usize) -> Picture {
        let mut points = [[0.0; 2]; POINTS];
        for (index, point) in points.iter_mut().enumerate() {
            *point = [index as f32 * 3.0, (index % 4) as f32 * 20.0];
        }
        points[8][0] += if number >= 7 { 30.0 } else { 0.0 };
        points
    }

    #[test]
    fn a_clip_keeps_the_last_pictures() {
        let mut clip = TapClip::default();
        for number in 0..PICTURES + 3 {
            assert_eq!(clip.pictures().is_some(), number >= PICTURES, "{number}");
            clip.push(picture(number));
        }
        let pictures: [Picture; PICTURES] = std::array::from_fn(|index| picture(index + 3));
        assert_eq!(clip, TapClip::new(pictures));
    }

    #[test]
    fn the_size_and_the_place_in_the_picture_do_not_count() {
        let model = TapModel::shipped();
        let clip = std::array::from_fn(picture);
        let moved = clip.map(|points| points.map(|[x, y]| [2.0 * x + 50.0, 2.0 * y - 9.0]));
        let scores = model.scores(&TapClip::new(clip)).unwrap();
        let others = model.scores(&TapClip::new(moved)).unwrap();
        for (score, other) in scores.into_iter().zip(others) {
            assert!((score - other).abs() < 1e-2, "{score} {other}");
        }
        assert_eq!(
            model.fingers(&TapClip::new(clip)),
            model.fingers(&TapClip::new(moved))
        );
    }

    #[test]
    fn a_hand_that_moves_as_a_whole_taps_with_no_finger() {
        let moves = |number: usize| {
            let along = number as f32 * 9.0;
            picture(0).map(|[x, y]| [x + along, y - along])
        };
        let clip = TapClip::new(std::array::from_fn(moves));
        assert_eq!(TapModel::shipped().fingers(&clip), Some(FingerSet::NONE));
    }

    #[test]
    fn no_hand_and_numbers_that_are_none_have_no_fingers() {
        let model = TapModel::shipped();
        assert_eq!(model.fingers(&TapClip::default()), None);
        let mut pictures = std::array::from_fn(picture);
        pictures[3][4][1] = f32::NAN;
        assert_eq!(model.fingers(&TapClip::new(pictures)), None);
        assert_eq!(
            model.fingers(&TapClip::new([[[1.0; 2]; POINTS]; PICTURES])),
            None
        );
    }

    /// Reads the clips of a file of recorded taps; `None` if it is absent.
    fn recorded(file: &str) -> Option<Vec<(TapClip, FingerSet)>> {
        let folder = std::env::var_os("ADEMAN_SHARED").map_or_else(
            || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
            Into::into,
        );
        let path = folder.join("data/finger-taps").join(file);
        let Ok(text) = std::fs::read_to_string(path) else {
            println!("SKIPPED: there are no recorded taps");
            return None;
        };
        let clips: serde_json::Value = serde_json::from_str(&text).unwrap();
        let number = |value: &serde_json::Value| value.as_f64().unwrap() as f32;
        let clip = |clip: &serde_json::Value| {
            let point = |frame: usize, joint: usize| {
                [0, 1].map(|axis| number(&clip["x"][frame][joint][axis]))
            };
            let picture = |frame: usize| std::array::from_fn(|joint| point(frame, joint));
            let tapped = clip["y"]
                .as_array()
                .unwrap()
                .iter()
                .map(|it| it.as_i64().unwrap());
            let tapped = tapped.filter_map(|it| Finger::ALL.get(usize::try_from(it).ok()?));
            let tapped = tapped.fold(FingerSet::NONE, |set, finger| set.with(*finger));
            (TapClip::new(std::array::from_fn(picture)), tapped)
        };
        Some(clips.as_array().unwrap().iter().map(clip).collect())
    }

    #[test]
    fn recorded_taps_that_were_not_trained_on_are_recognized() {
        let Some(clips) = recorded("validate.json") else {
            return;
        };
        let model = TapModel::shipped();
        let read: Vec<(FingerSet, FingerSet)> = clips
            .iter()
            .map(|(clip, tapped)| (model.fingers(clip).expect("a hand"), *tapped))
            .collect();
        for finger in Finger::ALL {
            let count = |is_one: &dyn Fn(bool, bool) -> bool| {
                let both = |(a, b): &&(FingerSet, FingerSet)| {
                    is_one(a.contains(*finger), b.contains(*finger))
                };
                read.iter().filter(both).count() as f32
            };
            let (right, wrong) = (count(&|a, b| a && b), count(&|a, b| a != b));
            let f1 = 2.0 * right / (2.0 * right + wrong);
            println!("{finger}: F1 {f1:.3}");
            assert!(f1 >= 0.9, "{finger}: {f1}");
        }
        let exact = read.iter().filter(|(found, tapped)| found == tapped);
        let exact = exact.count() as f32 / clips.len() as f32;
        println!("{exact} of {} clips", clips.len());
        assert!(exact >= 0.93, "{exact}");
    }
}
