//! IBus objects in messages: structures that begin with their name and a dictionary, `(sa{sv}…)`.
//!
//! Fields and their order: `ibus_text_serialize`, `ibus_lookup_table_serialize`, `ibus_component_serialize` and
//! `ibus_engine_desc_serialize` of libibus 1.5.

use std::collections::HashMap;

use zbus::zvariant::{Structure, StructureBuilder, Value};

use super::super::client::Candidates;

/// The name of the engine.
pub(super) const ENGINE: &str = "ademan";

/// `IBusAttrType` and `IBusAttrUnderline`.
const ATTRIBUTE_UNDERLINE: u32 = 1;
const UNDERLINE_SINGLE: u32 = 1;

/// `IBusOrientation`: the desktop decides.
const ORIENTATION_SYSTEM: i32 = 2;

fn object(name: &'static str) -> StructureBuilder<'static> {
    StructureBuilder::new()
        .add_field(name)
        .add_field(HashMap::<String, Value<'static>>::new())
}

fn built(builder: StructureBuilder<'static>) -> Structure<'static> {
    builder.build().expect("it has fields")
}

/// Returns an `IBusText`, underlined if it is not committed yet.
pub(super) fn text(text: &str, is_underlined: bool) -> Structure<'static> {
    let mut attributes = Vec::new();
    if is_underlined {
        let attribute = object("IBusAttribute")
            .add_field(ATTRIBUTE_UNDERLINE)
            .add_field(UNDERLINE_SINGLE)
            .add_field(0_u32)
            .add_field(text.chars().count() as u32);
        attributes.push(Value::from(built(attribute)));
    }
    let list = built(object("IBusAttrList").add_field(attributes));
    let text = object("IBusText")
        .add_field(text.to_owned())
        .append_field(Value::Value(Box::new(list.into())));
    built(text)
}

/// Returns an `IBusLookupTable` without a cursor.
pub(super) fn lookup_table(candidates: &Candidates) -> Structure<'static> {
    let texts: Vec<Value<'static>> = candidates
        .iter()
        .map(|candidate| text(candidate, false).into())
        .collect();
    let table = object("IBusLookupTable")
        .add_field(candidates.capacity() as u32)
        .add_field(0_u32)
        .add_field(false)
        .add_field(false)
        .add_field(ORIENTATION_SYSTEM)
        .add_field(texts)
        .add_field(Vec::<Value<'static>>::new());
    built(table)
}

/// Returns the `IBusComponent` with the engine.
pub(super) fn component() -> Structure<'static> {
    let version = env!("CARGO_PKG_VERSION");
    let license = env!("CARGO_PKG_LICENSE");
    // Name, long name, description, language, license, author, icon; `default` keeps the keymap.
    let mut engine = object("IBusEngineDesc");
    for field in [
        ENGINE,
        "Ademán",
        "Text of a hand in the air",
        "other",
        license,
        "",
        "",
        "default",
    ] {
        engine = engine.add_field(field);
    }
    // Its rank, then hotkeys, symbol, setup, variant and option of the keymap, version, text domain, key of the icon.
    engine = engine.add_field(0_u32);
    for field in ["", "", "", "", "", version, "", ""] {
        engine = engine.add_field(field);
    }
    // Name, description, version, license, author, home page, command line, text domain.
    let mut component = object("IBusComponent");
    for field in [
        "org.freedesktop.IBus.Ademan",
        "Ademán",
        version,
        license,
        "",
        "",
        "",
        "",
    ] {
        component = component.add_field(field);
    }
    component = component
        .add_field(Vec::<Value<'static>>::new())
        .add_field(vec![Value::from(built(engine))]);
    built(component)
}

/// Returns the name of an `IBusEngineDesc`, as in the property `GlobalEngine`.
pub(super) fn engine_name(mut description: &Value) -> Option<String> {
    while let Value::Value(inner) = description {
        description = inner;
    }
    let Value::Structure(structure) = description else {
        return None;
    };
    match structure.fields().get(2)? {
        Value::Str(name) if !name.is_empty() => Some(name.to_string()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arrayvec::ArrayString;

    /// The signatures that libibus 1.5.27 prints for its own objects (`g_variant_get_type_string`).
    #[test]
    fn objects_have_the_signatures_of_libibus() {
        let signature = |structure: Structure| structure.signature().to_string();
        assert_eq!(signature(text("hé", true)), "(sa{sv}sv)");
        let mut candidates = Candidates::new();
        candidates.push(ArrayString::from("the").unwrap());
        assert_eq!(signature(lookup_table(&candidates)), "(sa{sv}uubbiavav)");
        assert_eq!(signature(component()), "(sa{sv}ssssssssavav)");
    }

    #[test]
    fn the_name_of_an_engine_is_read_through_variants() {
        let engine = built(object("IBusEngineDesc").add_field("xkb:us::eng"));
        let value = Value::Value(Box::new(engine.into()));
        assert_eq!(engine_name(&value).as_deref(), Some("xkb:us::eng"));
        assert_eq!(engine_name(&Value::from(1_u32)), None);
    }
}
