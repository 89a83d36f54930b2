use parry3d::math::Vec2;

use super::*;

fn person(text: &str) -> Person {
    Person::parse(&Document::new("p.ron", text)).expect("a valid person")
}

fn error(text: &str) -> String {
    let error = Person::parse(&Document::new("p.ron", text));
    error.expect_err("an invalid person").to_string()
}

#[test]
fn an_empty_person_is_the_default_one() {
    assert_eq!(person("Person()"), Person::default());
}

#[test]
fn one_length_gives_the_others_in_proportion() {
    let from_hand = person("Person(hand_length_mm: 160)").bones.unwrap();
    assert!((from_hand.forearm - 0.160 * 0.146 / 0.108).abs() < 1e-9);
    assert!((from_hand.breadth - 0.160 * 0.456).abs() < 1e-9);
    for (field, length) in [
        ("forearm_length_mm", from_hand.forearm),
        ("hand_breadth_mm", from_hand.breadth),
        ("upper_arm_length_mm", from_hand.upper_arm),
    ] {
        let bones = person(&format!("Person({field}: {})", length * 1e3)).bones;
        let hand = bones.unwrap().hand;
        assert!((hand - 0.160).abs() < 1e-6, "{field}: {hand}");
    }
}

#[test]
fn lengths_of_the_file_replace_those_in_proportion() {
    let text = "Person(hand_length_mm: 210, hand_breadth_mm: 88, forearm_length_mm: 270, upper_arm_length_mm: 330)";
    let bones = person(text).bones.unwrap();
    let found = [bones.hand, bones.breadth, bones.forearm, bones.upper_arm];
    let expected = [0.210, 0.088, 0.270, 0.330];
    for (length, wanted) in found.into_iter().zip(expected) {
        assert!((length - wanted).abs() < 1e-9, "{length} {wanted}");
    }
    let arm = person(text).arm(Side::Left).unwrap().unwrap();
    assert_eq!(arm.side(), Side::Left);
}

#[test]
fn every_field_reaches_the_person() {
    let person = person(
        "Person(name: \"p\", side: \"left\", hands: One, fingers: [\"index\", \"thumb\"], resting: [\"ring\"],\n\
         joint_limits_deg: {\"index-mcp-flexion\": (-10, 70)}, speed: 0.5, enslaving: 0.3,\n\
         scatter: (x_mm: 3, y_mm: 4, depth_mm: 5, x_part: 0.01), offsets_mm: {\"index\": (1, -2)},\n\
         tremor: (amplitude_mm: 3, frequency_hz: 5))",
    );
    assert_eq!(person.side, Some(Side::Left));
    assert_eq!(person.hands, HandUse::One);
    let both = FingerSet::NONE.with(Finger::Index).with(Finger::Thumb);
    assert_eq!(person.fingers, both);
    assert_eq!(person.resting, FingerSet::NONE.with(Finger::Ring));
    let (low, high) = person.limits.range(Dof::IndexMcpFlexion);
    assert!((low.to_degrees() + 10.0).abs() < 1e-9 && (high.to_degrees() - 70.0).abs() < 1e-9);
    let motion = person.motion;
    assert_eq!((motion.speed, motion.enslaving), (0.5, 0.3));
    assert_eq!(motion.tremor.frequency_hz, 5.0);
    assert!((motion.tremor.amplitude - 0.003).abs() < 1e-9);
    assert_eq!(
        motion.offsets[Finger::Index.index()],
        Vec2::new(1.0, -2.0) * 1e-3
    );
    // √(3² + 0.01 × 40²) = 5.
    let deviation = motion.scatter.deviation_at(Vec2::new(0.040, 0.019)) * 1e3;
    assert!(
        (deviation.x - 5.0).abs() < 1e-4 && (deviation.y - 4.0).abs() < 1e-4,
        "{deviation}"
    );
}

#[test]
fn contradictions_are_refused_at_their_line_with_a_remedy() {
    for (text, place, reason) in [
        (
            "Person(\nhand_length_mm: 160,\nhand_breadth_mm: 120)",
            "p.ron:3:18",
            "it is 48 to 104 mm; measure both again",
        ),
        (
            "Person(\nhand_length_mm: 200,\nforearm_length_mm: 150)",
            "p.ron:3:20",
            "180 to 360 mm",
        ),
        (
            "Person(forearm_length_mm: 250,\nupper_arm_length_mm: 150)",
            "p.ron:2:22",
            "measure both again",
        ),
        (
            "Person(fingers: [\"index\"],\nresting: [\"index\"])",
            "p.ron:2:",
            "remove it from `resting` or from `fingers`",
        ),
        (
            "Person(\nresting: [\"index\"])",
            "p.ron:2:",
            "list the fingers that press",
        ),
        (
            "Person(fingers: [\"index\", \"index\"])",
            "p.ron:1:",
            "duplicate finger",
        ),
        ("Person(fingers: [\"indx\"])", "p.ron:1:", "`index`"),
        (
            "Person(\ntremor: (frequency_hz: 5))",
            "p.ron:2:24",
            "needs an `amplitude_mm`",
        ),
        (
            "Person(joint_limits_deg: {\"index-mcp-flexion\": (70, -10)})",
            "p.ron:1:",
            "smaller angle first",
        ),
        (
            "Person(joint_limits_deg: {\"index-mcp-flexion\": (0, 120)})",
            "p.ron:1:",
            "beyond (-45, 90)",
        ),
        (
            "Person(fingers: [\"index\"], offsets_mm: {\"ring\": (1, 1)})",
            "p.ron:1:",
            "`fingers` does not list it",
        ),
        (
            "Person(\nhand_length_mm: 16)",
            "p.ron:2:17",
            "16 is out of range",
        ),
    ] {
        let error = error(text);
        assert!(
            error.contains(place) && error.contains(reason),
            "{text}\n{error}"
        );
    }
}

#[test]
fn the_shipped_persons_are_valid_and_have_their_names() {
    for name in ["adult", "left-small"] {
        let document = Document::shipped(name).expect("a shipped person");
        assert_eq!(Person::parse(&document).expect("a person").name, name);
    }
}

#[test]
fn every_field_states_its_default() {
    let tables = person_field_tables();
    let rows = &tables[0].rows;
    assert_eq!(tables[0].name, "Person");
    assert!(rows.iter().all(|row| row.default != "required"));
    let row = |name: &str| rows.iter().find(|row| row.name == name).unwrap();
    assert_eq!(row("hand_length_mm").values, "100 to 300 mm");
    assert_eq!(row("speed").default, "1");
}
