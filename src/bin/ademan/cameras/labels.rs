//! Labels of marks of one color: given in one image, and carried to the next ones.

use glam::DVec2;

/// Images for which a mark may be hidden and keep its label.
const MAX_HIDDEN: u32 = 10;

/// The labels of the marks of one camera.
pub struct LabelTracker {
    tracks: Vec<Track>,
    /// Largest distance of a mark from where it is expected, in pixels.
    max_jump: f64,
    is_started: bool,
}

struct Track {
    label: String,
    last: Option<Seen>,
}

#[derive(Clone, Copy)]
struct Seen {
    at: DVec2,
    /// Movement from one image to the next.
    step: DVec2,
    hidden: u32,
}

impl LabelTracker {
    /// Creates a tracker that gives its labels, from the left to the right, in the first image with as many marks.
    pub fn new(labels: &[String], max_jump: f64) -> Self {
        let track = |label: &String| Track {
            label: label.clone(),
            last: None,
        };
        Self {
            tracks: labels.iter().map(track).collect(),
            max_jump,
            is_started: false,
        }
    }

    /// Returns the label of each mark of the next image; `None` for marks without one. The marks are from the left to the right.
    pub fn update(&mut self, marks: &[DVec2]) -> Vec<Option<String>> {
        if !self.is_started {
            if marks.len() != self.tracks.len() {
                return vec![None; marks.len()];
            }
            self.is_started = true;
            for (track, &at) in self.tracks.iter_mut().zip(marks) {
                let (step, hidden) = (DVec2::ZERO, 0);
                track.last = Some(Seen { at, step, hidden });
            }
            let labels = self.tracks.iter().map(|track| Some(track.label.clone()));
            return labels.collect();
        }
        let mut labels = vec![None; marks.len()];
        for (index, mark) in self.pairs(marks) {
            let track = &mut self.tracks[index];
            labels[mark] = Some(track.label.clone());
            if let Some(seen) = &mut track.last {
                seen.step = (marks[mark] - seen.at) / f64::from(seen.hidden + 1);
                (seen.at, seen.hidden) = (marks[mark], 0);
            }
        }
        for track in &mut self.tracks {
            if labels.contains(&Some(track.label.clone())) {
                continue;
            }
            track.last = track.last.and_then(|seen| {
                let hidden = seen.hidden + 1;
                (hidden <= MAX_HIDDEN).then_some(Seen { hidden, ..seen })
            });
        }
        labels
    }

    /// Returns the pairs of tracks and marks, the nearest ones first.
    fn pairs(&self, marks: &[DVec2]) -> Vec<(usize, usize)> {
        let mut candidates = Vec::new();
        for (index, track) in self.tracks.iter().enumerate() {
            let Some(seen) = track.last else {
                continue;
            };
            let expected = seen.at + seen.step * f64::from(seen.hidden + 1);
            for (mark, at) in marks.iter().enumerate() {
                let distance = at.distance(expected);
                if distance <= self.max_jump {
                    candidates.push((distance, index, mark));
                }
            }
        }
        candidates.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for (_, index, mark) in candidates {
            if pairs
                .iter()
                .all(|&(track, other)| track != index && other != mark)
            {
                pairs.push((index, mark));
            }
        }
        pairs
    }

    /// Returns the labels that are lost and cannot be found again.
    pub fn lost(&self) -> impl Iterator<Item = &str> {
        let lost = self.tracks.iter().filter(|track| track.last.is_none());
        lost.map(|track| track.label.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_that_cross_keep_their_labels_and_hidden_ones_get_theirs_back() {
        let labels = ["a".to_owned(), "b".to_owned()];
        let mut tracker = LabelTracker::new(&labels, 10.0);
        assert_eq!(tracker.update(&[DVec2::ZERO]), [None]);
        for step in 0..20 {
            // One moves to the right, the other one to the left below it.
            let (a, b) = (
                DVec2::new(4.0 * f64::from(step), 0.0),
                DVec2::new(80.0 - 4.0 * f64::from(step), 5.0),
            );
            let marks = if a.x < b.x { vec![a, b] } else { vec![b, a] };
            let expected = if a.x < b.x { ["a", "b"] } else { ["b", "a"] };
            if step == 4 || step == 5 {
                assert_eq!(tracker.update(&[b]), [Some("b".to_owned())]);
                continue;
            }
            let expected = expected.map(|label| Some(label.to_owned()));
            assert_eq!(tracker.update(&marks), expected, "{step}");
        }
        for _ in 0..12 {
            tracker.update(&[]);
        }
        assert_eq!(tracker.lost().collect::<Vec<_>>(), ["a", "b"]);
    }
}
