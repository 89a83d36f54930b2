use super::*;
use crate::capture::protocol::lucidgloves;

#[test]
fn an_arm_in_place_of_a_glove_is_refused_with_the_list_of_gloves() {
    let error = Glove::parse(&Document::shipped("unam").unwrap()).unwrap_err();
    let expected = "expected `Glove(…)`, found `Arm`; `ademan gloves` lists the gloves";
    assert_eq!(error.message(), expected);
}

fn error(row: &str) -> String {
    let text = format!(
        "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, rows: [\n({row}),\n])"
    );
    Glove::parse(&Document::new("g.ron", text))
        .unwrap_err()
        .to_string()
}

#[test]
fn the_shipped_glove_has_22_enabled_rows() {
    let glove = Glove::parse(&Document::shipped("unam-hc11").unwrap()).unwrap();
    assert_eq!(glove.map.rows().len(), 22);
    assert_eq!(glove.side, Side::Right);
}

#[test]
fn the_shipped_lucidgloves_have_all_inputs_and_finger_joints() {
    for (name, side) in [
        ("lucidgloves", Side::Right),
        ("lucidgloves-left", Side::Left),
    ] {
        let map = Glove::parse(&Document::shipped(name).unwrap()).unwrap().map;
        assert_eq!(
            Glove::parse(&Document::shipped(name).unwrap())
                .unwrap()
                .side,
            side
        );
        for &input in Input::ALL {
            assert!(map.inputs().iter().any(|row| row.input == input), "{input}");
        }
        for &dof in Dof::ALL.iter().filter(|dof| dof.finger().is_some()) {
            assert!(map.rows().iter().any(|row| row.dof == dof), "{dof}");
        }
        assert_eq!(map.required_channels(), lucidgloves::CHANNELS);
        assert_eq!(map.full_scale(), lucidgloves::FULL_SCALE);
    }
}

#[test]
fn invalid_inputs_and_assumed_angles_are_rejected() {
    let with = |fields: &str| {
        let text = format!("Glove(name: \"g\", side: \"right\", full_scale_counts: 255, {fields})");
        let glove = Glove::parse(&Document::new("g.ron", text));
        glove.unwrap_err().to_string()
    };
    let row = "label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 1, offset_rad: 0";
    for (fields, message) in [
        (
            r#"rows: [], inputs: [(input: "stick-z", channel: 1, zero_counts: 0, full_counts: 1)]"#
                .to_owned(),
            "did you mean `stick-x`?",
        ),
        (
            r#"rows: [], inputs: [(input: "menu", channel: 64, zero_counts: 0, full_counts: 1)]"#
                .to_owned(),
            "channel 64 does not exist",
        ),
        (
            r#"rows: [], inputs: [(input: "menu", channel: 1, zero_counts: 1, full_counts: 1)]"#
                .to_owned(),
            "a `full_counts` other than",
        ),
        (
            r#"rows: [], assumed_deg: {"elbow-flexion": 200}"#.to_owned(),
            "outside the range",
        ),
        (
            format!("rows: [({row})], assumed_deg: {{\"elbow-flexion\": 20}}"),
            "both measured and assumed",
        ),
    ] {
        let error = with(&fields);
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn an_angle_whose_row_is_disabled_may_be_assumed() {
    let row = "label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 1, offset_rad: 0";
    let text = format!(
        "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, rows: [({row}, disabled: \"loose\")], assumed_deg: {{\"elbow-flexion\": 90}})"
    );
    let glove = Glove::parse(&Document::new("g.ron", text)).unwrap();
    assert!(glove.map.rows().is_empty());
    let right_angle = 90_f64.to_radians();
    assert_eq!(
        glove.map.assumed_angles(),
        [(Dof::ElbowFlexion, right_angle)]
    );
}

#[test]
fn a_curvature_is_of_a_channel_in_use_and_within_a_fifth_of_the_full_scale() {
    let row = "(label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 2.55, offset_rad: 0)";
    let parse = |curvature: &str| {
        let text = format!(
            "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, curvature_counts: {{{curvature}}}, rows: [{row}])"
        );
        Glove::parse(&Document::new("g.ron", text)).map_err(|error| error.to_string())
    };
    let map = parse("1: 25.5").unwrap().map;
    let radians = map.radians(&map.rows()[0], 127.5);
    assert!((radians - 1.02).abs() < 1e-9, "{radians}");
    assert!(
        parse("2: 1")
            .unwrap_err()
            .contains("channel 2, which no row has")
    );
    assert!(parse("1: 52").unwrap_err().contains("at most 51"));
    assert!(parse("1: NaN").unwrap_err().contains("at most 51"));
}

#[test]
fn a_hysteresis_is_of_a_channel_in_use_and_within_a_fifth_of_the_full_scale() {
    let row = "(label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 2.55, offset_rad: 0)";
    let parse = |hysteresis: &str| {
        let text = format!(
            "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, hysteresis_counts: {{{hysteresis}}}, rows: [{row}])"
        );
        Glove::parse(&Document::new("g.ron", text)).map_err(|error| error.to_string())
    };
    let map = parse("1: 7.5").unwrap().map;
    assert_eq!((map.hysteresis(1), map.hysteresis(2)), (7.5, 0.0));
    for (hysteresis, message) in [
        ("2: 1", "channel 2, which no row has"),
        ("1: 52", "0 to 51 are possible"),
        ("1: -1", "0 to 51 are possible"),
        ("1: NaN", "0 to 51 are possible"),
    ] {
        let error = parse(hysteresis).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn a_range_is_of_a_channel_in_use_and_rises_within_the_full_scale() {
    let row = "(label: \"a\", dof: \"elbow-flexion\", channel: 1, offset_counts: 0, full_scale_rad: 2.55, offset_rad: 0)";
    let parse = |range: &str| {
        let text = format!(
            "Glove(name: \"g\", side: \"right\", full_scale_counts: 255, range_counts: {{{range}}}, rows: [{row}])"
        );
        Glove::parse(&Document::new("g.ron", text)).map_err(|error| error.to_string())
    };
    let map = parse("1: (6, 154)").unwrap().map;
    assert_eq!(map.range(1), Some((6.0, 154.0)));
    assert_eq!(map.range(2), None);
    for (range, message) in [
        ("2: (6, 154)", "channel 2, which no row has"),
        ("1: (154, 6)", "the smaller count first"),
        ("1: (6, 256)", "within 0 to 255"),
        ("1: (NaN, 100)", "the range of channel 1 is (NaN, 100)"),
    ] {
        let error = parse(range).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn an_invalid_row_is_rejected_at_its_position() {
    let row = |channel: &str, full_scale: &str| {
        error(&format!(
            "label: \"a\", dof: \"elbow-flexion\", channel: {channel}, offset_counts: 0, full_scale_rad: {full_scale}, offset_rad: 0"
        ))
    };
    let channel = row("64", "1");
    assert!(
        channel.starts_with("g.ron:2:45: channel 64 does not exist, channels are 0 to 63\n"),
        "{channel}"
    );
    assert!(row("-1", "1").starts_with("g.ron:2:46: channel -1 does not exist"));
    assert!(row("1", "0").starts_with("g.ron:2:82: an angle that does not change is 0"));
    assert!(row("1", "NaN").starts_with("g.ron:2:82: NaN is out of range"));
    let escaped = error("label: \"a\\tb\", dof: \"elbow-flexion\"");
    assert!(
        escaped.contains(": this text must be written without `\\`\n"),
        "{escaped}"
    );
    let unknown = error("label: \"a\", dof: \"elbow-flexoin\"");
    assert!(
        unknown.contains("did you mean `elbow-flexion`?"),
        "{unknown}"
    );
}
