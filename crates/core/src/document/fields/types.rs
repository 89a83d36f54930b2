//! The types that fields have in common.

use std::collections::BTreeMap;

use super::{FieldType, Shape, Table};
use crate::document::{Pairs, Spanned};

impl FieldType for bool {
    fn shape() -> Shape {
        Shape::Bool
    }

    fn default_text() -> String {
        "`false`".into()
    }
}

impl FieldType for f64 {
    fn shape() -> Shape {
        Shape::AnyNumber
    }
}

impl FieldType for f32 {
    fn shape() -> Shape {
        Shape::AnyNumber
    }
}

impl FieldType for u32 {
    fn shape() -> Shape {
        Shape::Integer {
            min: 0,
            max: u32::MAX.into(),
        }
    }
}

impl FieldType for String {
    fn shape() -> Shape {
        Shape::Text {
            min_length: 0,
            max_length: None,
        }
    }
}

impl FieldType for &str {
    fn shape() -> Shape {
        Shape::Text {
            min_length: 0,
            max_length: None,
        }
    }
}

impl FieldType for Spanned<'_> {
    fn shape() -> Shape {
        Shape::Text {
            min_length: 1,
            max_length: None,
        }
    }
}

impl<T: FieldType> FieldType for Option<T> {
    fn shape() -> Shape {
        T::shape()
    }

    fn is_optional() -> bool {
        true
    }

    fn default_text() -> String {
        T::default_text()
    }

    fn explanation() -> String {
        T::explanation()
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        T::collect_tables(tables);
    }
}

impl<T: FieldType> FieldType for Vec<T> {
    fn shape() -> Shape {
        Shape::List(Box::new(T::shape()))
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        T::collect_tables(tables);
    }
}

impl<T: FieldType> FieldType for [T; 3] {
    fn shape() -> Shape {
        Shape::Tuple(vec![T::shape(), T::shape(), T::shape()])
    }
}

impl<A: FieldType, B: FieldType> FieldType for (A, B) {
    fn shape() -> Shape {
        Shape::Tuple(vec![A::shape(), B::shape()])
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        A::collect_tables(tables);
        B::collect_tables(tables);
    }
}

impl<A: FieldType, B: FieldType, C: FieldType> FieldType for (A, B, C) {
    fn shape() -> Shape {
        Shape::Tuple(vec![A::shape(), B::shape(), C::shape()])
    }

    fn default_text() -> String {
        let defaults = [A::default_text(), B::default_text(), C::default_text()];
        format!("({})", defaults.join(", "))
    }
}

impl<V: FieldType> FieldType for Pairs<'_, V> {
    fn shape() -> Shape {
        Shape::Map(Box::new(V::shape()))
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        V::collect_tables(tables);
    }
}

impl<V: FieldType> FieldType for BTreeMap<usize, V> {
    fn shape() -> Shape {
        Shape::NumberedMap(Box::new(V::shape()))
    }
}
