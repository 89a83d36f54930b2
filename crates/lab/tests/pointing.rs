//! Simulated people click on rings of targets with the shipped pointers, through the whole pipeline.

mod support;

use std::num::NonZeroUsize;

use ademan_lab::measures::summarize;
use ademan_lab::people::{People, population};
use ademan_lab::sim::fluent::SourceKind;
use support::{Run, steady};

const POINTERS: [&str; 5] = ["direct", "joint", "ray", "rate", "webcam-mouse"];

#[test]
fn a_person_without_errors_clicks_on_wide_targets_with_every_pointer() {
    for layout in POINTERS {
        let people = [steady(&["index"])];
        let scores = Run::new(layout).of(&people, SourceKind::Ideal);
        let pointing = scores[0].pointing.as_ref().expect(layout);
        println!("{layout}: {pointing:?}");
        let wide = &pointing.series[0];
        assert_eq!(wide.given_up, 0, "{layout}: {wide:?}");
        assert!(wide.result.misses <= 2, "{layout}: {wide:?}");
        // Without scatter the effective width comes from the pointer alone.
        assert!(wide.result.throughput > 1.0, "{layout}: {wide:?}");
        let way = wide.result.path_efficiency;
        assert!(way > 0.5, "{layout}: {wide:?}");
    }
}

#[test]
fn a_pinch_does_not_take_the_cursor_of_a_webcam_along() {
    let scores = Run::new("webcam-mouse").of(&[steady(&["index"])], SourceKind::Ideal);
    let pointing = scores[0].pointing.as_ref().expect("it points");
    assert!(!pointing.series.is_empty());
    for series in &pointing.series {
        println!("{series:?}");
        assert!(series.slips <= 3, "{series:?}");
        // The cursor still settles. A fingertip would take it along by some 30 px.
        let settling = 5.0 + series.width_px / 10.0;
        assert!(series.slip_px < settling, "{series:?}");
    }
}

#[test]
fn an_ideal_cursor_has_the_throughput_of_people_and_a_real_one_has_less() {
    let people = population(&People::Drawn(8), None, 4);
    let scores = Run::new("direct").of(&people, SourceKind::Ideal);
    for score in &scores {
        let pointing = score.pointing.as_ref().expect("it points");
        let ideal = pointing
            .ideal_throughput
            .expect("a position follows the hand");
        println!("{}: {ideal:.2} {:.2}", score.number, pointing.throughput());
        // Of hands without a device: 4.5 to 7 bit/s on average.
        assert!((3.5..9.0).contains(&ideal), "{ideal}");
        assert!(pointing.throughput() < ideal, "{pointing:?}");
    }
    let summary = summarize(&scores).pointing.expect("figures");
    let ideal: f64 = scores
        .iter()
        .filter_map(|score| score.pointing.as_ref()?.ideal_throughput)
        .sum();
    let ideal = ideal / scores.len() as f64;
    assert!((4.5..7.0).contains(&ideal), "{ideal}");
    let part = summary.of_ideal.expect("a part").value;
    assert!((0.2..1.0).contains(&part), "{part}");
    assert_eq!(summary.by_width.len(), 3);
}

#[test]
fn a_camera_makes_a_pointer_worse_and_threads_change_nothing() {
    let people = population(&People::Drawn(4), None, 6);
    let of = |source, jobs| {
        let jobs = NonZeroUsize::new(jobs).expect("more than 0");
        let run = Run {
            jobs,
            ..Run::new("direct")
        };
        run.of(&people, source)
    };
    let ideal = of(SourceKind::Ideal, 1);
    assert_eq!(ideal, of(SourceKind::Ideal, 3));
    let throughput = |scores| {
        summarize(scores)
            .pointing
            .expect("figures")
            .throughput
            .value
    };
    let camera = of(SourceKind::Camera, 2);
    let (ideal, camera) = (throughput(&ideal), throughput(&camera));
    println!("{ideal} {camera}");
    assert!(camera < ideal, "{camera} {ideal}");
}

#[test]
fn sliders_have_the_time_and_the_error_of_a_value() {
    let people = population(&People::Drawn(2), None, 6);
    let summary = summarize(&Run::new("mixer").of(&people, SourceKind::Ideal));
    assert!(summary.pointing.is_none());
    assert!(
        (0.1..5.0).contains(&summary.value_seconds.value),
        "{summary:?}"
    );
    assert!(
        (0.001..0.5).contains(&summary.task_error.value),
        "{summary:?}"
    );
}
