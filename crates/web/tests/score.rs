//! The score of a layout in the page.

use ademan_core::document::Document;
use ademan_web::Scoring;

fn shipped(name: &str) -> String {
    Document::shipped(name).expect("a shipped file").text
}

#[test]
fn people_type_one_after_the_other_and_each_key_is_counted() {
    let mut scoring = Scoring::new(&shipped("qwerty-flat"), 3).expect("a valid layout");
    for people in 1..=3 {
        let score = scoring.advance().expect("a score").expect("a person");
        assert_eq!((score.people, score.of), (people, 3));
        assert!(
            score.wpm[1] > 5.0 && score.wpm[2] >= score.wpm[0],
            "{:?}",
            score.wpm
        );
        assert!((0.0..0.9).contains(&score.errors[0]), "{:?}", score.errors);
        let e = &score.keys["E"];
        assert!(e.meant > 5 && e.hit <= e.meant, "{e:?}");
        assert_eq!(score.untypable, "");
    }
    assert!(scoring.advance().expect("no error").is_none());
}

#[test]
fn keys_that_are_too_small_are_missed_more_often_and_a_fault_is_refused() {
    let errors = |text: &str| {
        let mut scoring = Scoring::new(text, 4).expect("a valid layout");
        let mut errors = 0.0;
        while let Some(score) = scoring.advance().expect("a score") {
            errors = score.errors[0];
        }
        errors
    };
    let text = shipped("qwerty-flat");
    let small = text.replacen("pose: (", "pose: (scale: 0.6, ", 1);
    assert!(errors(&small) > 1.5 * errors(&text));
    assert!(Scoring::new("Layout(name: 1)", 2).is_err());
}
