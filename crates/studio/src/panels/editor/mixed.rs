//! The comparison of the values that several parts have in a field.

use super::EditorPanel;
use crate::editor::Part;
use ademan_core::document::{Item, Node, read_tree};

/// The largest number of parts whose values are compared for each frame.
const MAX_COMPARED: usize = 200;

/// Returns `true` if parts have different values in a field.
pub(super) fn is_mixed(panel: &EditorPanel, parts: &[Part], field: &str) -> bool {
    let value = |part: &Part| panel.editor.own_value(*part, field);
    let compared = &parts[..parts.len().min(MAX_COMPARED)];
    compared
        .windows(2)
        .any(|pair| match (value(&pair[0]), value(&pair[1])) {
            (Some(one), Some(other)) => !is_same(one, other),
            (one, other) => one != other,
        })
}

/// Returns `true` if two values differ in their spelling at most, such as `4` and `4.0`.
fn is_same(one: &str, other: &str) -> bool {
    one == other
        || read_tree(one)
            .zip(read_tree(other))
            .is_some_and(|(own, its)| is_same_node((one, &own), (other, &its)))
}

/// Returns `true` if two values, each with the text that contains it, differ in their spelling at most.
fn is_same_node((text, node): (&str, &Node), (other_text, other): (&str, &Node)) -> bool {
    if let (Some(own), Some(its)) = (node.number(text), other.number(other_text)) {
        return own == its;
    }
    let (Some(group), Some(other_group)) = (&node.group, &other.group) else {
        return node.text(text) == other.text(other_text);
    };
    let is_same_item = |(own, its): (&Item, &Item)| {
        let is_same_key = match (&own.key, &its.key) {
            (Some(key), Some(other_key)) => text[key.clone()] == other_text[other_key.clone()],
            (None, None) => true,
            _ => false,
        };
        is_same_key && is_same_node((text, &own.value), (other_text, &its.value))
    };
    let mut pairs = group.items.iter().zip(&other_group.items);
    node.name(text) == other.name(other_text)
        && group.bracket == other_group.bracket
        && group.items.len() == other_group.items.len()
        && pairs.all(is_same_item)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_the_same_however_it_is_spelled() {
        for (one, other, expected) in [
            ("4", "4.0", true),
            ("-2.50", "-2.5", true),
            ("Some(4)", "4", true),
            ("4", "5", false),
            ("4", "\"4\"", false),
            ("Box(17, 20)", "Box( 17.0,20 )", true),
            ("Box(17, 20)", "Box(20, 17)", false),
            ("Box(17, 20)", "Disc(17)", false),
            ("(17)", "[17]", false),
            ("(0, 1)", "(0, 1, 2)", false),
            ("Arc(radius_mm: 60)", "Arc(radius_mm: 60.0)", true),
            ("Arc(radius_mm: 60)", "Arc(60)", false),
            ("\"a\"", "\"b\"", false),
            ("elbow", "wrist", false),
        ] {
            assert_eq!(is_same(one, other), expected, "{one} {other}");
            assert_eq!(is_same(other, one), expected, "{other} {one}");
        }
    }
}
