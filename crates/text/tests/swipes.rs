//! Words of phrases that the model was not built from, swiped by a simulated person.

mod support;

use ademan_text::Model;
use support::arguments::amount;
use support::phrases::phrases;
use support::swipes::{Hits, NearestShape, measure};

#[test]
fn swiped_words_are_read_with_fewer_errors_than_by_the_nearest_shape() {
    let tuning = std::env::var_os("ADEMAN_TEXT_TUNING").is_some();
    let Some(mut phrases) = phrases(!tuning) else {
        return;
    };
    phrases.truncate(amount("ADEMAN_TEXT_PHRASES", 25));
    let people = amount("ADEMAN_TEXT_PEOPLE", 2) as u64;
    let first = if tuning { 1_000 } else { 0 };
    let model = Model::from_bytes(ademan_text::languages::ENGLISH).expect("the model");
    let reference = NearestShape::new(&model);
    for (scatter, least) in [(3.0, 90.0), (5.0, 87.0), (8.0, 75.0)] {
        let measured = measure(&model, &reference, &phrases, scatter, first..first + people);
        let total = |hits: &[Hits]| {
            let mut sum = Hits::default();
            hits.iter().for_each(|hits| sum.merge(hits));
            sum
        };
        let [decoded, alone, nearest] =
            [&measured.decoded, &measured.alone, &measured.nearest].map(|hits| total(hits));
        println!(
            "{scatter} mm, {} words: first and one of three: decoded {:.1?}, without words before {:.1?}, nearest shape {:.1?} %",
            decoded.words,
            decoded.percent(),
            alone.percent(),
            nearest.percent()
        );
        assert!(decoded.percent()[0] >= least, "{scatter} mm: {decoded:?}");
        assert!(decoded.first > nearest.first, "{decoded:?} {nearest:?}");
    }
}
