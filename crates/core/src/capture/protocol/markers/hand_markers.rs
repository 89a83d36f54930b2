//! Joint positions of one arm and hand from the markers on it.

use glam::DVec3;

use crate::capture::bvh::joint_of;
use crate::capture::markers::{ElbowCenter, wrist_center};
use crate::hand::{Joint, JointPositions, Side};

/// The place of a marker on the arm or hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MarkerSite {
    /// Over a joint.
    Joint(Joint),
    /// On one of the two sides of the wrist.
    WristSide(usize),
}

impl MarkerSite {
    /// Returns the place that a label states; `None` if it is of the other hand or of another part of the body. A label
    /// without a side is of `hand`.
    pub fn from_label(label: &str, hand: Side) -> Option<Self> {
        let letters = label.chars().filter(char::is_ascii_alphanumeric);
        let plain: String = letters.map(|letter| letter.to_ascii_lowercase()).collect();
        let (side, site) = match plug_in_gait(&plain) {
            Some((side, site)) => (Some(side), site),
            None => match wrist_side(&plain) {
                Some((side, index)) => (side, Self::WristSide(index)),
                None => {
                    let named = joint_of(label)?;
                    (named.side, Self::Joint(named.joint))
                }
            },
        };
        (side.unwrap_or(hand) == hand).then_some(site)
    }
}

/// Reads the names of the marker set Plug-in Gait; `FIN` is over the knuckle of the middle finger.
fn plug_in_gait(plain: &str) -> Option<(Side, MarkerSite)> {
    let (side, site) = plain.split_at_checked(1)?;
    let side = match side {
        "l" => Side::Left,
        "r" => Side::Right,
        _ => return None,
    };
    let site = match site {
        "sho" => MarkerSite::Joint(Joint::Shoulder),
        "elb" => MarkerSite::Joint(Joint::Elbow),
        "wra" => MarkerSite::WristSide(0),
        "wrb" => MarkerSite::WristSide(1),
        "fin" => MarkerSite::Joint(Joint::MiddlePhalanxProximal),
        _ => return None,
    };
    Some((side, site))
}

fn wrist_side(plain: &str) -> Option<(Option<Side>, usize)> {
    let sides = [
        (None, plain),
        (Some(Side::Left), plain.strip_prefix("left").unwrap_or("")),
        (Some(Side::Right), plain.strip_prefix("right").unwrap_or("")),
    ];
    sides.into_iter().find_map(|(side, rest)| match rest {
        "wrista" => Some((side, 0)),
        "wristb" => Some((side, 1)),
        _ => None,
    })
}

/// The conversion of markers to joint positions.
#[derive(Clone, Debug)]
pub(super) struct HandMarkers {
    elbow: ElbowCenter,
}

impl HandMarkers {
    /// Creates the conversion. `elbow_offset` is in metres.
    pub fn new(elbow_offset: f64) -> Self {
        Self {
            elbow: ElbowCenter::new(elbow_offset),
        }
    }

    /// Returns the joint positions in the unit of the markers. Of two markers at one place, the first counts. The wrist
    /// needs both markers on its sides, or one over its centre.
    pub fn joints(&mut self, markers: &[(MarkerSite, DVec3)]) -> JointPositions {
        let mut positions = JointPositions::default();
        let mut wrist_sides = [None; 2];
        for &(site, position) in markers {
            match site {
                MarkerSite::Joint(joint) if positions.get(joint).is_none() => {
                    positions.set(joint, position);
                }
                MarkerSite::Joint(_) => {}
                MarkerSite::WristSide(index) => {
                    wrist_sides[index].get_or_insert(position);
                }
            }
        }
        if let [Some(first), Some(second)] = wrist_sides {
            positions.set(Joint::Wrist, wrist_center(first, second));
        }
        self.correct_elbow(positions)
    }

    /// Replaces the elbow marker by the centre of the joint. Without shoulder and wrist the plane of the arm is unknown:
    /// an elbow with an offset is then left out.
    fn correct_elbow(&mut self, positions: JointPositions) -> JointPositions {
        let get = |joint| positions.get(joint);
        let arm = (get(Joint::Shoulder), get(Joint::Elbow), get(Joint::Wrist));
        let center = match arm {
            (Some(shoulder), Some(marker), Some(wrist)) => {
                self.elbow.update(shoulder, marker, wrist)
            }
            (_, marker, _) if self.elbow.offset == 0.0 => marker,
            _ => None,
        };
        let mut corrected = JointPositions::default();
        for (joint, position) in positions.known() {
            match joint {
                Joint::Elbow => {
                    if let Some(center) = center {
                        corrected.set(joint, center);
                    }
                }
                _ => corrected.set(joint, position),
            }
        }
        corrected
    }

    pub fn reset(&mut self) {
        self.elbow.reset();
    }
}
