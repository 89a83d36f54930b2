//! The limits of a changed layout.

use std::collections::BTreeSet;

use parry3d::math::Vec2;

use crate::document::Document;
use crate::layout::Layout;
use crate::people::Participant;
use crate::sim::fluent::SourceKind;
use crate::trials::{Station, TrialError};

/// The tolerance of the outline of a board, in metres: rounding only.
const TOLERANCE: f32 = 1e-5;

/// The limits that an original layout sets.
#[derive(Clone, Debug)]
pub struct Limits {
    /// The corners of each board, in its plane.
    corners: Vec<(Vec2, Vec2)>,
    overlaps: usize,
    /// The people who have to reach all controls, and what each of them cannot reach on the original.
    reach: Vec<(Participant, BTreeSet<String>)>,
}

impl Limits {
    /// Takes the limits of a layout: its controls stay in the outlines of their boards, which may grow by `margin` metres on each side,
    /// and the people with the shortest, the median and the longest hand reach what they reach now.
    pub fn new(layout: &Layout, margin: f32, people: &[Participant]) -> Result<Self, TrialError> {
        let corners = layout.boards.iter().map(|board| {
            let (low, high) = layout.extent(board);
            let by = Vec2::splat(margin + TOLERANCE);
            (low - by, high + by)
        });
        let mut by_hand: Vec<&Participant> = people.iter().collect();
        by_hand.sort_by(|a, b| a.hand_mm().total_cmp(&b.hand_mm()));
        let ends = match by_hand.len() {
            0 => Vec::new(),
            count => vec![0, count / 2, count - 1],
        };
        let ends: BTreeSet<usize> = ends.into_iter().collect();
        let document = Document::new(layout.file.as_str(), layout.text.as_str());
        let reach = ends.into_iter().map(|index| {
            let person = by_hand[index].clone();
            let missed = missed(&document, &person)?;
            Ok((person, missed))
        });
        Ok(Self {
            corners: corners.collect(),
            overlaps: layout.board_overlaps().len(),
            reach: reach.collect::<Result<_, TrialError>>()?,
        })
    }

    /// Returns `true` if a layout keeps inside the outlines of its boards, and no more boards share space than before.
    pub fn allow_shape(&self, layout: &Layout) -> bool {
        let boards = layout.boards.iter().zip(&self.corners);
        let is_inside = boards.into_iter().all(|(board, (low, high))| {
            let (own_low, own_high) = layout.extent(board);
            own_low.cmpge(*low).all() && own_high.cmple(*high).all()
        });
        is_inside && layout.board_overlaps().len() <= self.overlaps
    }

    /// Returns `true` if the people reach everything that they reached on the original.
    pub fn allow_reach(&self, document: &Document) -> Result<bool, TrialError> {
        for (person, before) in &self.reach {
            if !missed(document, person)?.is_subset(before) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Returns the names of the controls that no finger of a person reaches.
fn missed(document: &Document, person: &Participant) -> Result<BTreeSet<String>, TrialError> {
    let mut station = Station::new(document, person, SourceKind::Ideal)?;
    let missed = station.out_of_reach();
    let names = station.layout().target_names();
    Ok(missed.iter().map(|it| names.get(*it).to_string()).collect())
}
