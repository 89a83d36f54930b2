//! Joint positions of one arm and hand from the markers on it.

use glam::DVec3;

use crate::capture::bvh::joint_of;
use crate::capture::markers::{ElbowCenter, wrist_center};
use crate::hand::{Joint, JointPositions, Side};
use crate::message::escape;

/// The site of a marker on the arm or hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MarkerSite {
    /// Over a joint.
    Joint(Joint),
    /// A side of the wrist: 0 beside the thumb, 1 beside the little finger.
    WristSide(usize),
}

/// A marker on the arm or hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenMarker {
    pub site: MarkerSite,
    pub position: DVec3,
    /// `true` if the position continues the motion before the marker was hidden.
    pub is_predicted: bool,
}

impl MarkerSite {
    /// Returns the site that a label states; `None` if it is of the other hand or of another part of the body. A label
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

/// The reason of a line whose labels are right.
pub(super) const NOT_SEEN_BY_TWO: &str = "no labelled marker of the hand is seen by two cameras";

/// Most labels that a message names.
const NAMED_LABELS: usize = 3;

/// Returns the reason why labels give no marker of a hand.
pub(super) fn why_no_marker<'a>(labels: impl Iterator<Item = &'a str>, hand: Side) -> String {
    let (mut unknown, mut is_of_other) = (Vec::new(), false);
    for label in labels {
        if MarkerSite::from_label(label, hand).is_some() {
            return NOT_SEEN_BY_TWO.to_owned();
        }
        if MarkerSite::from_label(label, hand.opposite()).is_some() {
            is_of_other = true;
        } else if !unknown.contains(&label) && unknown.len() < NAMED_LABELS {
            unknown.push(label);
        }
    }
    let other = hand.opposite();
    if is_of_other {
        return format!("the labels are of the {other} hand; use `hand={other}`");
    }
    if unknown.is_empty() {
        return "no marker has a label; label each of them in one camera at least".to_owned();
    }
    let unknown: Vec<String> = unknown
        .iter()
        .map(|it| format!("`{}`", escape(it)))
        .collect();
    format!(
        "no label names a joint of an arm or hand: {}; use names such as `RightHand`, `RELB` or `index-finger-tip`",
        unknown.join(", ")
    )
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

    /// Returns the joint positions in the unit of the markers. Of two markers at one site, the first counts. The wrist
    /// needs both markers on its sides, which show the turn of the forearm too, or one over its center.
    pub fn joints(&mut self, markers: &[SeenMarker]) -> JointPositions {
        let mut positions = JointPositions::default();
        let mut wrist_sides = [None; 2];
        for marker in markers {
            match marker.site {
                MarkerSite::Joint(joint) if positions.get(joint).is_none() => {
                    set(&mut positions, joint, marker.position, marker.is_predicted);
                }
                MarkerSite::Joint(_) => {}
                MarkerSite::WristSide(index) => {
                    wrist_sides[index].get_or_insert(*marker);
                }
            }
        }
        if let [Some(thumb), Some(little)] = wrist_sides {
            let is_predicted = thumb.is_predicted || little.is_predicted;
            let center = wrist_center(thumb.position, little.position);
            set(&mut positions, Joint::Wrist, center, is_predicted);
            positions.set_wrist_axis(thumb.position - little.position);
        }
        self.correct_elbow(positions)
    }

    /// Replaces the elbow marker by the center of the joint. Without shoulder and wrist the plane of the arm is unknown:
    /// an elbow with an offset is then left out.
    fn correct_elbow(&mut self, positions: JointPositions) -> JointPositions {
        if self.elbow.offset == 0.0 {
            return positions;
        }
        let arm = [Joint::Shoulder, Joint::Elbow, Joint::Wrist];
        let center = match arm.map(|joint| positions.get(joint)) {
            [Some(shoulder), Some(marker), Some(wrist)] => {
                self.elbow.update(shoulder, marker, wrist)
            }
            _ => None,
        };
        let mut corrected = JointPositions::default();
        for (joint, position) in positions.known() {
            if joint != Joint::Elbow {
                set(
                    &mut corrected,
                    joint,
                    position,
                    positions.is_predicted(joint),
                );
            }
        }
        if let Some(center) = center {
            let is_predicted = arm.iter().any(|&joint| positions.is_predicted(joint));
            set(&mut corrected, Joint::Elbow, center, is_predicted);
        }
        if let Some(axis) = positions.wrist_axis() {
            corrected.set_wrist_axis(axis);
        }
        corrected
    }

    pub fn reset(&mut self) {
        self.elbow.reset();
    }
}

fn set(positions: &mut JointPositions, joint: Joint, position: DVec3, is_predicted: bool) {
    positions.set(joint, position);
    if is_predicted {
        positions.set_predicted(joint);
    }
}
