//! The macro that declares the structures of a file with their tables.

/// Returns the [`Attributes`](crate::document::Attributes) of a declaration.
#[doc(hidden)]
#[macro_export]
macro_rules! schema_attributes {
    ($([$($attribute:tt)*])*) => {
        $crate::document::Attributes {
            lines: &[$($crate::schema_doc_line!($($attribute)*)),*],
            texts: &[$(stringify!($($attribute)*)),*],
        }
    };
}

/// Returns the text of a line of a doc comment, an empty text for another attribute.
#[doc(hidden)]
#[macro_export]
macro_rules! schema_doc_line {
    (doc = $line:literal) => {
        $line
    };
    ($($other:tt)*) => {
        ""
    };
}

/// Declares a structure or an enumeration of a file, with its [`Table`](crate::document::Table).
///
/// An enumeration of values without contents has no table: the fields of its type explain them.
#[macro_export]
macro_rules! schema {
    (
        $(#[$($attribute:tt)*])*
        $visibility:vis struct $name:ident $(<$lifetime:lifetime>)? {
            $(
                $(#[$($field_attribute:tt)*])*
                $field_visibility:vis $field:ident: $type:ty,
            )+
        }
    ) => {
        $(#[$($attribute)*])*
        $visibility struct $name $(<$lifetime>)? {
            $(
                $(#[$($field_attribute)*])*
                $field_visibility $field: $type,
            )+
        }

        impl$(<$lifetime>)? $crate::document::FieldType for $name$(<$lifetime>)? {
            fn shape() -> $crate::document::Shape {
                let attributes = $crate::schema_attributes!($([$($attribute)*])*);
                $crate::document::Shape::Table(attributes.name(stringify!($name)))
            }

            fn collect_tables(tables: &mut Vec<$crate::document::Table>) {
                let attributes = $crate::schema_attributes!($([$($attribute)*])*);
                let mut rows = Vec::new();
                $(
                    let field = $crate::schema_attributes!($([$($field_attribute)*])*);
                    let name = field.name(stringify!($field)).to_owned();
                    let is_optional = attributes.has_defaults();
                    rows.push($crate::document::Row::field::<$type>(name, &field, is_optional));
                )+
                let name = attributes.name(stringify!($name));
                if $crate::document::add_table(tables, name, &attributes, rows, false) {
                    $(<$type as $crate::document::FieldType>::collect_tables(tables);)+
                }
            }
        }
    };
    (
        $(#[$($attribute:tt)*])*
        $visibility:vis enum $name:ident $(<$lifetime:lifetime>)? {
            $(
                $(#[$($value_attribute:tt)*])*
                $value:ident
                $(($($content:ty),+))?
                $({
                    $(
                        $(#[$($field_attribute:tt)*])*
                        $field:ident: $type:ty,
                    )+
                })?,
            )+
        }
    ) => {
        $(#[$($attribute)*])*
        $visibility enum $name $(<$lifetime>)? {
            $(
                $(#[$($value_attribute)*])*
                $value
                $(($($content),+))?
                $({
                    $(
                        $(#[$($field_attribute)*])*
                        $field: $type,
                    )+
                })?,
            )+
        }

        impl$(<$lifetime>)? $name$(<$lifetime>)? {
            /// Returns the values, and the fields of each.
            fn described_values() -> $crate::document::Values {
                let attributes = $crate::schema_attributes!($([$($attribute)*])*);
                let mut values = $crate::document::Values::default();
                $(
                    let mut name = stringify!($value).to_owned();
                    if attributes.has_lower_case_values() {
                        name.make_ascii_lowercase();
                    }
                    let contents: Vec<$crate::document::Shape> =
                        vec![$($(<$content as $crate::document::FieldType>::shape()),+)?];
                    values.has_contents |= !contents.is_empty();
                    let value_attributes = $crate::schema_attributes!($([$($value_attribute)*])*);
                    if value_attributes.is_of_default_value() {
                        values.default = Some(name.clone());
                    }
                    values.rows.push($crate::document::Row::value(name, contents, &value_attributes));
                    $($(
                        values.has_contents = true;
                        values.rows.push($crate::document::Row::field::<$type>(
                            concat!(stringify!($value), "(", stringify!($field), ")").to_owned(),
                            &$crate::schema_attributes!($([$($field_attribute)*])*),
                            false,
                        ));
                    )+)?
                )+
                values
            }
        }

        impl$(<$lifetime>)? $crate::document::FieldType for $name$(<$lifetime>)? {
            fn shape() -> $crate::document::Shape {
                let values = Self::described_values();
                if values.has_contents {
                    let attributes = $crate::schema_attributes!($([$($attribute)*])*);
                    return $crate::document::Shape::Table(attributes.name(stringify!($name)));
                }
                values.words()
            }

            fn default_text() -> String {
                Self::described_values().default_text()
            }

            fn explanation() -> String {
                let values = Self::described_values();
                if values.has_contents {
                    return String::new();
                }
                values.meanings()
            }

            fn collect_tables(tables: &mut Vec<$crate::document::Table>) {
                let values = Self::described_values();
                if !values.has_contents {
                    return;
                }
                let attributes = $crate::schema_attributes!($([$($attribute)*])*);
                let name = attributes.name(stringify!($name));
                if $crate::document::add_table(tables, name, &attributes, values.rows, true) {
                    $(
                        $($(<$content as $crate::document::FieldType>::collect_tables(tables);)+)?
                        $($(<$type as $crate::document::FieldType>::collect_tables(tables);)+)?
                    )+
                }
            }
        }
    };
}
