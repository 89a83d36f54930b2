use super::*;

use ron::error::{Error, Position};
use serde::Deserialize;

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sample<'a> {
    #[serde(borrow)]
    name: &'a str,
    #[serde(default)]
    count: Option<u8>,
    size: Size,
    #[serde(default)]
    parts: Vec<Part>,
    #[serde(default)]
    pair: (f32, i16),
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Size(f64);

#[derive(Clone, Debug, PartialEq, Deserialize)]
enum Part {
    Empty,
    Text(String),
    Two(char, bool),
    Named {
        a: (),
        b: std::collections::BTreeMap<String, i64>,
    },
}

/// A text that has each kind of value.
const TEXT: &str = r#"Sample(name: "é", count: 3, size: Size(-1.5e3), pair: (0.25, -7), parts: [
    Empty, Text("a\"b"), Two('x', true), Named(a: (), b: {"k": -5, "l": 6}),
])"#;

#[test]
fn each_kind_of_value_is_read_as_rons_deserializer_reads_it() {
    let sample: Sample<'_> = read(TEXT).unwrap();
    let expected = ron_options().from_str::<Sample<'_>>(TEXT).unwrap();
    assert_eq!(sample, expected);
    assert_eq!((sample.name, sample.count), ("é", Some(3)));
    let start = TEXT.find('é').unwrap();
    assert_eq!(sample.name.as_ptr(), TEXT[start..].as_ptr());
}

/// Replaces a part of the text, and returns the error, which is the one that RON's deserializer has.
fn error(part: &str, by: &str) -> (Error, Position) {
    assert!(TEXT.contains(part), "{part}");
    let text = TEXT.replacen(part, by, 1);
    let error = read::<Sample<'_>>(&text).unwrap_err();
    let expected = ron_options().from_str::<Sample<'_>>(&text).unwrap_err();
    assert_eq!(error, expected, "{text}");
    (error.code, error.span.start)
}

#[test]
fn errors_have_the_kinds_and_positions_of_rons_deserializer() {
    let (code, position) = error("count", "counts");
    assert!(matches!(code, Error::NoSuchStructField { .. }), "{code:?}");
    assert_eq!((position.line, position.col), (1, 19));
    let missing = error("size: Size(-1.5e3), ", "").0;
    let expected = Error::MissingStructField {
        field: "size",
        outer: Some("Sample".into()),
    };
    assert_eq!(missing, expected);
    assert!(matches!(
        error("Empty", "Emty").0,
        Error::NoSuchEnumVariant { .. }
    ));
    assert!(matches!(
        error("count: 3", "name: \"a\"").0,
        Error::DuplicateStructField { .. }
    ));
    assert!(matches!(
        error("(0.25, -7)", "(0.25)").0,
        Error::ExpectedDifferentLength { found: 1, .. }
    ));
    assert!(matches!(
        error("(0.25, -7)", "(0.25, -7, 8)").0,
        Error::ExpectedStructLikeEnd
    ));
    assert_eq!(error("count: 3", "count: 300").0, Error::IntegerOutOfBounds);
    assert_eq!(error("count: 3", "count: x").0, Error::ExpectedInteger);
    assert_eq!(error("true", "yes").0, Error::ExpectedBoolean);
    assert_eq!(error("\"l\": 6", "\"l\"; 6").0, Error::ExpectedMapColon);
    assert_eq!(
        error("Text(\"a\\\"b\")", "Text(5)").0,
        Error::ExpectedString
    );
    for (part, by) in [
        ("[", "("),
        ("'x'", "x"),
        ("Size(", "Sizes("),
        ("\"é\"", "\"\\\\\""),
        ("])", "]"),
        ("Two('x', ", "Two("),
    ] {
        error(part, by);
    }
}
