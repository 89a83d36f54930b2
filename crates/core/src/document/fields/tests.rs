use super::*;
use crate::document::ranged_numbers;
use crate::schema;

ranged_numbers! {
    /// A length.
    Length = "a length", 1.0 ..= 9.0, " mm", or 4.0;
}

schema! {
    /// A rod.
    #[derive(serde::Deserialize)]
    #[serde(rename = "Rod", deny_unknown_fields)]
    #[expect(dead_code, reason = "only its table is read")]
    struct RodSchema {
        /// Length of the rod,
        /// from end to end.
        #[serde(default)]
        length_mm: Length,
        /// Diameter. Default: a tenth of the length.
        #[serde(default)]
        diameter_mm: Option<Length>,
        /// Ends of the rod.
        ends: (Length, Length),
        /// Shape of the tip.
        #[serde(default)]
        tip: Tip,
    }
}

schema! {
    /// The shape of a tip.
    #[derive(serde::Deserialize)]
    #[expect(dead_code, reason = "only its table is read")]
    #[derive(Default)]
    enum Tip {
        /// Flat.
        #[default]
        Flat,
        /// A cone.
        Cone {
            /// Height.
            height_mm: Length,
        },
    }
}

#[test]
fn a_table_has_the_names_defaults_and_ranges_of_the_fields() {
    let mut tables = Vec::new();
    RodSchema::collect_tables(&mut tables);
    let cells: Vec<[&str; 4]> = tables
        .iter()
        .flat_map(|table| &table.rows)
        .map(|row| [row.name.as_str(), &row.default, &row.values, &row.meaning])
        .collect();
    let default = Length::default().get().to_string();
    let expected = [
        [
            "length_mm",
            default.as_str(),
            "1 to 9 mm",
            "Length of the rod, from end to end",
        ],
        [
            "diameter_mm",
            "a tenth of the length",
            "1 to 9 mm",
            "Diameter",
        ],
        [
            "ends",
            "required",
            "2 numbers, each 1 to 9 mm",
            "Ends of the rod",
        ],
        ["tip", "`Flat`", "Tip", "Shape of the tip"],
        ["Flat", "", "", "Flat"],
        ["Cone", "", "", "A cone"],
        ["Cone(height_mm)", "required", "1 to 9 mm", "Height"],
    ];
    assert_eq!(cells, expected);
    let names: Vec<&str> = tables.iter().map(|table| table.name).collect();
    assert_eq!(names, ["Rod", "Tip"]);
}
