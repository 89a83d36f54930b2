//! Tests of the parser of scripts.

use super::*;

fn script(text: &str) -> Result<Script, String> {
    let names = TargetNames::new(["Q", "Volume up"].map(str::to_owned));
    Script::parse(Document::new("a.txt", text), &names).map_err(|error| error.to_string())
}

fn actions(text: &str) -> Vec<HandAction> {
    script(text).unwrap().actions
}

#[test]
fn the_syntax_of_each_action_begins_with_its_name() {
    for (verb, syntax) in Verb::ALL.iter().zip(SYNTAX) {
        assert_eq!(syntax.split(' ').next(), Some(verb.name()));
    }
}

#[test]
fn the_guide_lists_every_action() {
    let guide = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scripts.md");
    let guide = std::fs::read_to_string(guide).expect("the guide exists");
    for syntax in SYNTAX {
        assert!(guide.contains(&format!("| `{syntax}` |")), "{syntax}");
    }
}

#[test]
fn actions_are_parsed_in_millimetres_degrees_and_milliseconds() {
    let (q, up) = (TargetId(0), TargetId(1));
    let point = TargetPoint {
        target: up,
        offset: Vec2::new(0.005, -0.0025),
    };
    let ms = Duration::from_millis;
    assert_eq!(
        actions("tap Q; press 'Volume up' 5 -2.5 # so\npush Q 0.5\nslide 1 2; slide 1 2 300"),
        [
            HandAction::tap(q),
            HandAction::Press(point),
            HandAction::Push(q, 0.5),
            HandAction::Slide(Vec2::new(1e-3, 2e-3), None),
            HandAction::Slide(Vec2::new(1e-3, 2e-3), Some(ms(300))),
        ]
    );
    assert_eq!(
        actions(
            "arc -180; lift; wait 1.5; pinch; unpinch 50; point 0 -45 -300; input stick-x -0.5"
        ),
        [
            HandAction::Arc(-std::f32::consts::PI, None),
            HandAction::Lift,
            HandAction::Wait(Duration::from_micros(1_500)),
            HandAction::Pinch(None),
            HandAction::Unpinch(Some(ms(50))),
            HandAction::Point(Vec2::new(0.0, -0.045).extend(-0.3), None),
            HandAction::SetInput(Input::StickX, -0.5),
        ]
    );
}

#[test]
fn joined_angles_are_one_action_with_the_longest_duration() {
    let radians = 30_f64.to_radians();
    let turned = [
        Dof::IndexMcpFlexion,
        Dof::WristFlexion,
        Dof::ForearmSupination,
    ];
    assert_eq!(
        actions("bend index 30 & set wrist-flexion 30 500 &roll 30 200"),
        [HandAction::SetAngles(
            turned.map(|dof| (dof, radians)).to_vec(),
            Some(Duration::from_millis(500))
        )]
    );
}

#[test]
fn errors_name_the_position_and_the_syntax() {
    let table = [
        (
            "tap Q\nteh Q",
            "a.txt:2:1: unknown action `teh`, expected one of: tap, press, ",
        ),
        ("tap X", "a.txt:1:5: unknown target `X`, expected one of: "),
        (
            "tpa Q",
            "a.txt:1:1: unknown action `tpa`, did you mean `tap`?",
        ),
        (
            "tap Q; tap 'Volume pu'",
            "a.txt:1:12: unknown target `Volume pu`, did you mean `Volume up`?",
        ),
        (
            "push Q",
            "a.txt:1:6: FRACTION is missing after this; write `push NAME FRACTION`",
        ),
        ("push Q 1.5", "a.txt:1:8: FRACTION is 0 to 1, not 1.5"),
        ("wait NaN", "a.txt:1:6: MS is 0 to 600000, not NaN"),
        (
            "slide 1 x",
            "a.txt:1:9: Y is a number, not `x`; write `slide X Y [MS]`",
        ),
        (
            "tap Q 5",
            "a.txt:1:7: Y is missing after this; write `tap NAME [X Y]`",
        ),
        ("lift Q", "a.txt:1:6: unexpected `Q`; write `lift`"),
        (
            "set wirst-flexion 5",
            "a.txt:1:5: unknown degree of freedom `wirst-flexion`, did you mean `wrist-flexion`?",
        ),
        (
            "bend pinky 5",
            "a.txt:1:6: unknown finger `pinky`, did you mean `little`?",
        ),
        (
            "roll 5 & tap Q",
            "a.txt:1:10: only `set`, `bend` and `roll` can be joined by `&`",
        ),
        (
            "roll 5 &",
            "a.txt:1:8: an action is missing beside this `&`",
        ),
        ("tap \"Q", "a.txt:1:5: the name has no closing \""),
        ("# nothing", "a.txt: the script has no action"),
    ];
    for (text, message) in table {
        let error = script(text)
            .err()
            .unwrap_or_else(|| panic!("{text} is read"));
        assert!(error.starts_with(message), "{text}: {error}");
    }
}
