//! Simulated people type on shipped layouts through the whole pipeline.

mod support;

use std::num::NonZeroUsize;

use ademan_core::capture::{Reading, Sample};
use ademan_core::hand::{Dof, Finger};
use ademan_lab::measures::{PersonScore, summarize};
use ademan_lab::people::{Participant, People, Tier, population};
use ademan_lab::phrases::{Corpus, PhraseSet};
use ademan_lab::sim::fluent::SourceKind;
use ademan_lab::trials::{Observed, Station, Watch};
use support::{Run, steady};

#[test]
fn a_person_without_errors_types_without_errors_on_every_keyboard() {
    for layout in [
        "qwerty-flat",
        "qwerty-arc",
        "qwerty-two-flat",
        "chords-bend",
        "webcam-qwerty",
    ] {
        for fingers in [
            &["index"][..],
            &["thumb", "index", "middle", "ring", "little"],
        ] {
            if layout == "webcam-qwerty" && fingers.len() > 1 {
                // It is made for one finger: others are in its way.
                continue;
            }
            let people = [steady(fingers)];
            let scores = Run::new(layout).of(&people, SourceKind::Ideal);
            let score = &scores[0];
            assert!(score.characters > 100, "{layout} {fingers:?}: {score:?}");
            assert!(
                score.cer() < 0.005,
                "{layout} {fingers:?}: {:?} {:?}",
                score.cer(),
                score.wrong
            );
        }
    }
}

#[test]
fn more_scatter_makes_more_errors() {
    let cer = |tier| {
        let people = population(&People::Drawn(6), Some(tier), 3);
        let cer = summarize(&Run::new("qwerty-flat").of(&people, SourceKind::Ideal)).cer;
        println!("{tier}: {cer:?}");
        cer.value
    };
    let rates = [Tier::T0, Tier::T1, Tier::T3].map(cer);
    assert!(rates[0] < 0.06, "{rates:?}");
    assert!(rates[0] < rates[1] && rates[1] < rates[2], "{rates:?}");
    assert!(cer(Tier::Toff) > rates[1], "{rates:?}");
}

#[test]
fn scatter_is_stretched_along_the_movement_on_a_turned_board_too() {
    let run = Run {
        corpus: Corpus::from_text("two keys of a row", &"dj".repeat(80)).expect("a phrase"),
        ..Run::new("qwerty-flat")
    };
    let person = Participant {
        scatter: [4.0; 2],
        elongation: 0.5,
        ..steady(&["index"])
    };
    let score = run.of(&[person], SourceKind::Ideal).remove(0);
    let mut squares = [0.0_f64; 2];
    for key in &score.keys {
        assert!(key.places > 250, "{key:?}");
        squares[0] += key.spread_mm[0].powi(2);
        squares[1] += key.spread_mm[1].powi(2);
    }
    // Half more variance along the row, and a third less across it.
    let ratio = (squares[0] / squares[1]).sqrt();
    assert!((1.3..1.7).contains(&ratio), "{ratio}");
}

/// Returns an angle of a reading of joint angles.
fn angle(reading: &Reading, dof: Dof) -> f64 {
    let Sample::Angles { angles } = &reading.sample else {
        panic!("a reading without angles");
    };
    angles.get(dof)
}

#[test]
fn no_finger_turns_too_fast_for_the_pipeline() {
    let run = Run::new("qwerty-flat");
    let mut turned = 0;
    for person in population(&People::Drawn(6), Some(Tier::T2), 3) {
        let mut station =
            Station::new(&run.document, &person, SourceKind::Ideal).expect("a station");
        let strokes = station.strokes_for(run.corpus.phrases.iter().map(String::as_str));
        let mut watch = Watch::default();
        let mut observed = Observed::default();
        for (phrase, seed) in run.corpus.phrases.iter().zip(0..6) {
            station.type_watched(phrase, &strokes, seed, &mut observed, Some(&mut watch));
        }
        for pair in watch.readings.windows(2) {
            let [earlier, later] = pair else { continue };
            // Each phrase begins at time 0.
            if later.time <= earlier.time {
                continue;
            }
            let seconds = later.time.since(earlier.time).as_secs_f64();
            for &dof in Finger::FLEXIONS.as_flattened() {
                let speed = (angle(later, dof) - angle(earlier, dof)).abs() / seconds;
                turned += usize::from(speed > 5.0);
                assert!(speed < 40.0, "{dof:?} turns at {speed:.0} rad/s");
            }
        }
    }
    assert!(turned > 100, "{turned}");
}

#[test]
fn a_known_backlash_brings_back_what_ten_fingers_in_a_glove_lose() {
    let people = population(&People::Drawn(16), Some(Tier::T0), 2);
    let ten: Vec<_> = people
        .into_iter()
        .filter(|it| it.fingers.len() == 5)
        .collect();
    assert!(ten.len() >= 3, "{}", ten.len());
    let wrong = |source| {
        summarize(&Run::new("qwerty-flat").of(&ten, source))
            .cer
            .value
    };
    let (unknown, known) = (wrong(SourceKind::Glove), wrong(SourceKind::MeasuredGlove));
    assert!(unknown > 0.04, "{unknown}");
    assert!(known < 0.3 * unknown, "{known} of {unknown}");
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let people = population(&People::Drawn(5), None, 11);
    let scores = |jobs| {
        let jobs = NonZeroUsize::new(jobs).expect("more than 0");
        Run {
            jobs,
            ..Run::new("qwerty-arc")
        }
        .of(&people, SourceKind::Camera)
    };
    let one: Vec<PersonScore> = scores(1);
    assert!(one.iter().any(|score| score.errors() > 0));
    assert_eq!(one, scores(3));
    let fewer = Run::new("qwerty-arc").of(&people[..2], SourceKind::Camera);
    assert_eq!(one[..2], fewer);
}

#[test]
fn all_sensors_measure_a_person_well_enough_to_type() {
    for source in SourceKind::ALL {
        let people = population(&People::Drawn(4), Some(Tier::T0), 5);
        let scores = Run::new("qwerty-flat").of(&people, *source);
        let summary = summarize(&scores);
        println!("{source}: {:?} {:?}", summary.cer, summary.hits);
        assert!(summary.characters > 300, "{source}");
        assert!(summary.cer.value < 0.6, "{source}: {:?}", summary.cer);
    }
}

#[test]
fn a_layout_that_does_not_type_is_scored_by_its_tasks() {
    let people = population(&People::Drawn(2), Some(Tier::T0), 5);
    let scores = Run::new("workshop").of(&people, SourceKind::Ideal);
    let summary = summarize(&scores);
    for task in &scores[0].tasks {
        println!("{task:?}");
    }
    assert_eq!(summary.characters, 0);
    assert!(summary.tasks_done.value > 0.5, "{summary:?}");
    assert!(
        scores
            .iter()
            .flat_map(|it| &it.tasks)
            .any(|task| task.error.is_some())
    );
}

#[test]
fn a_person_corrects_with_the_backspace_of_a_layout_be_it_a_key_or_a_chord() {
    for layout in ["qwerty-flat", "chords-bend"] {
        let score = |corrects| {
            let person = Participant {
                missed: 0.1,
                corrects,
                notice_ms: 300.0,
                ..steady(&["index"])
            };
            Run::new(layout).of(&[person], SourceKind::Ideal).remove(0)
        };
        let (careless, careful) = (score(0.0), score(1.0));
        println!("{layout}: {} {}", careless.cer(), careful.cer());
        assert!(careful.cer() < 0.5 * careless.cer(), "{layout}");
        assert!(careful.keystrokes > careless.keystrokes, "{layout}");
        assert_eq!(careless.keystrokes_by_class, None);
        let classes = careful.keystrokes_by_class.expect("the person corrects");
        assert!(classes.fixes > 0 && classes.fixed > 0, "{classes:?}");
        if layout == "qwerty-flat" {
            // Each key types a character that stays or is deleted, or is a Backspace: the phrases need no Shift.
            let counted = careful.transcribed() + classes.fixed + classes.fixes;
            assert_eq!(careful.keystrokes, counted, "{classes:?}");
        }
    }
}

#[test]
fn the_fastest_pace_is_of_the_movements_between_the_characters() {
    let run = Run {
        corpus: Corpus::from_text("one key", "aaaa").expect("a phrase"),
        ..Run::new("qwerty-flat")
    };
    let person = steady(&["index"]);
    let score = run
        .of(std::slice::from_ref(&person), SourceKind::Ideal)
        .remove(0);
    // The hand stays above the key: three movements for three characters after the first.
    let expected = 12.0 / (person.fitts_a_ms * 1e-3);
    let difference = (score.fitts_wpm - expected).abs();
    assert!(
        difference < 0.01 * expected,
        "{} {expected}",
        score.fitts_wpm
    );
}

#[test]
fn characters_that_a_layout_cannot_type_are_named_and_left_out() {
    let run = Run {
        corpus: Corpus::shipped(PhraseSet::Es),
        ..Run::new("qwerty-flat")
    };
    let scores = run.of(&[steady(&["index"])], SourceKind::Ideal);
    assert!(scores[0].untypable.contains('í'), "{}", scores[0].untypable);
    assert!(!scores[0].untypable.contains('e'));
    assert!(scores[0].cer() < 0.005, "{}", scores[0].cer());
}
