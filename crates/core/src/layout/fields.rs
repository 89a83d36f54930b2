//! The tables of fields of a layout file.

use super::load::LayoutSchema;
use crate::document::{FieldType, Table};
use crate::hand::{Dof, Finger, Input, Side};

/// Returns the tables of the fields of a layout file: the file itself first, each structure after the one that contains it.
pub fn field_tables() -> Vec<Table> {
    let mut tables = Vec::new();
    LayoutSchema::collect_tables(&mut tables);
    tables
}

/// Types whose values have a name in quotes.
macro_rules! quoted_names {
    ($($name:ident)+) => {$(
        impl FieldType for $name {
            fn values() -> String {
                let names = $name::ALL.iter().map(|value| format!("`\"{value}\"`"));
                names.collect::<Vec<String>>().join(", ")
            }
        }
    )+};
}
quoted_names!(Finger Input Side);

impl FieldType for Dof {
    fn values() -> String {
        "degree of freedom".into()
    }
}
