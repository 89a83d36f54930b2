//! A person in front of a camera, as landmarks: the upper arms hang, and the forearms press one key for each hand.

use ademan::capture::body::{BODY_LANDMARKS, BodyLandmarks, Landmark};
use ademan::hand::Side;
use glam::{DMat3, DVec3};

/// Frames of the camera per second.
pub const RATE_HZ: f64 = 30.0;

/// Elevations of a forearm above its key and on it, in degrees.
const ABOVE_DEG: f64 = 15.0;
const ON_KEY_DEG: f64 = 0.0;

/// Frames that the forearm needs to the key or back.
const FRAMES_TO_KEY: usize = 6;

/// A layout with F below the left index finger and J below the right one; coordinates from the own shoulder.
pub const TWO_KEYS: &str = r#"Layout(name: "Two keys", boards: [
    (hand: "left", pose: (anchor: world, forward_mm: 335, height_mm: -270), size_mm: Box(40, 40), travel_mm: 10, keys: [(code: "F", at_mm: (30, 0))]),
    (hand: "right", pose: (anchor: world, forward_mm: 335, height_mm: -270), size_mm: Box(40, 40), travel_mm: 10, keys: [(code: "J", at_mm: (-30, 0))]),
])"#;

/// The key of the right hand alone.
pub const ONE_KEY: &str = r#"Layout(name: "One key", boards: [
    (pose: (anchor: world, forward_mm: 335, height_mm: -270), size_mm: Box(40, 40), travel_mm: 10, keys: [(code: "J", at_mm: (-30, 0))]),
])"#;

/// Elevations of the forearms in degrees and confidences of the arms, left before right.
#[derive(Clone, Copy, Debug)]
pub struct Person {
    pub elevations: [f64; Side::COUNT],
    pub confidences: [f32; Side::COUNT],
}

impl Person {
    /// Returns a person with both hands above the keys.
    pub fn new() -> Self {
        Self {
            elevations: [ABOVE_DEG; Side::COUNT],
            confidences: [0.9; Side::COUNT],
        }
    }

    /// Returns the person with a hand on its key.
    pub fn pressing(side: Side) -> Self {
        let mut person = Self::new();
        person.elevations[side.index()] = ON_KEY_DEG;
        person
    }

    /// Returns what a camera sees that is 20° to the side of the person.
    pub fn landmarks(&self) -> BodyLandmarks {
        let camera = DMat3::from_rotation_y(0.35);
        let mut points = [Landmark {
            position: [0.0, -0.6, 0.1],
            confidence: 0.9,
        }; BODY_LANDMARKS];
        for &side in Side::ALL {
            let positions = self.arm(side).into_iter().enumerate();
            for (pair, wearer) in positions {
                // To the right of the image, down, away from the camera, for a person who faces it.
                let image = camera * DVec3::new(-wearer.x, -wearer.y, wearer.z) + DVec3::ONE;
                points[11 + Side::COUNT * pair + side.index()] = Landmark {
                    position: image.as_vec3().to_array(),
                    // Shoulders and hips stay in view.
                    confidence: match pair {
                        1..=5 => self.confidences[side.index()],
                        _ => 0.9,
                    },
                };
            }
        }
        BodyLandmarks {
            points: points.into(),
        }
    }

    /// Returns shoulder, elbow, wrist, little finger, index finger, thumb and hip, to the right, up and backwards.
    fn arm(&self, side: Side) -> [DVec3; 7] {
        let outwards = match side {
            Side::Left => DVec3::NEG_X,
            Side::Right => DVec3::X,
        };
        let (sine, cosine) = self.elevations[side.index()].to_radians().sin_cos();
        let forearm = DVec3::new(0.0, sine, -cosine);
        let shoulder = outwards * 0.18 + DVec3::Y * 0.5;
        let elbow = shoulder + DVec3::NEG_Y * 0.3;
        let wrist = elbow + forearm * 0.25;
        [
            shoulder,
            elbow,
            wrist,
            wrist + forearm * 0.08 + outwards * 0.03,
            wrist + forearm * 0.09 - outwards * 0.03,
            wrist + forearm * 0.05 - outwards * 0.05,
            shoulder + DVec3::NEG_Y * 0.5,
        ]
    }
}

/// Returns the frames of a person who rests for half a second, taps the keys of these hands one after the other, and rests.
pub fn taps(sides: &[Side]) -> Vec<BodyLandmarks> {
    let resting = vec![Person::new(); 15];
    let mut frames = resting.clone();
    for &side in sides {
        let there = (0..=FRAMES_TO_KEY).map(|frame| frame as f64 / FRAMES_TO_KEY as f64);
        let back = there.clone().rev();
        for fraction in there.chain([1.0; 3]).chain(back) {
            let mut person = Person::new();
            person.elevations[side.index()] = ABOVE_DEG + (ON_KEY_DEG - ABOVE_DEG) * fraction;
            frames.push(person);
        }
    }
    frames.extend(resting);
    frames.iter().map(Person::landmarks).collect()
}
