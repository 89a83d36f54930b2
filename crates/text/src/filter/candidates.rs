//! Candidates as displays show them.

use ademan_core::pipeline::press_filter::CandidateText;

/// Returns what displays show of a candidate for the shown text: its last word, cut to the capacity.
pub(super) fn candidate_text(shown: &str, candidate: &str) -> CandidateText {
    let mut short = CandidateText::new();
    for character in last_word(shown, candidate).chars() {
        if short.try_push(character).is_err() {
            break;
        }
    }
    short
}

/// Returns the end of a candidate from the last word of the shown text, or from the first word in which both differ.
fn last_word<'a>(shown: &str, candidate: &'a str) -> &'a str {
    let last = shown.trim_end().rfind(' ').map_or(0, |space| space + 1);
    let pairs = shown.chars().zip(candidate.char_indices());
    let same = pairs.take_while(|&(left, (index, right))| left == right && index < last);
    let spaces = same.filter(|(left, _)| *left == ' ');
    let start = spaces.last().map_or(0, |(_, (index, _))| index + 1);
    candidate[start..].trim_end()
}
