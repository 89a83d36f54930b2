//! The axes of gamepads and 6-DoF devices while parts are copied: one control sets each.

use std::ops::Range;

use super::draft::Draft;
use super::error::EditError;
use super::patch::Patch;
use crate::device::Axis;
use crate::document::{Node, quote};

/// The axes that controls set.
pub(super) struct TakenAxes(Vec<Axis>);

impl TakenAxes {
    /// Returns the axes of a layout.
    pub fn new(draft: &Draft) -> Self {
        let mut axes = Vec::new();
        visit(draft.text(), draft.tree(), &mut |_, axis| axes.push(axis));
        Self(axes)
    }

    /// Assigns free axes of the same kind to the copy of a part, and marks them as used.
    ///
    /// # Errors
    /// If none is free.
    pub fn replace(&mut self, patch: &mut Patch, text: &str, part: &Node) -> Result<(), EditError> {
        let mut own = Vec::new();
        visit(text, part, &mut |range, axis| own.push((range, axis)));
        for (range, axis) in own {
            let free = self.free(axis);
            let free = free.ok_or_else(|| EditError::NoAxis(axis.name().into()))?;
            self.0.push(free);
            if free != axis {
                patch.replace(range, quote(free.name()));
            }
        }
        Ok(())
    }

    /// Returns the axis itself, or the first one of its device and range, that is free.
    fn free(&self, axis: Axis) -> Option<Axis> {
        let kind = |it: Axis| (it.is_gamepad(), it.is_trigger());
        let others = Axis::ALL.iter().copied();
        let alike = others.filter(|other| kind(*other) == kind(axis));
        let mut candidates = [axis].into_iter().chain(alike);
        candidates.find(|it| !self.0.contains(it))
    }
}

/// Visits the quoted names of axes: `Axis("Wheel")`, `axes: ("LeftX", "LeftY")` and `axis: "MoveX"`.
fn visit<F: FnMut(Range<usize>, Axis)>(text: &str, node: &Node, found: &mut F) {
    let is_output = node.name(text) == Some("Axis");
    for item in node.items() {
        let field = item.key.clone().map(|key| &text[key]);
        if is_output || field == Some("axis") {
            visit_name(text, &item.value, found);
        }
        if field == Some("axes") {
            for axis in item.value.in_some(text).items() {
                visit_name(text, &axis.value, found);
            }
        }
        visit(text, &item.value, found);
    }
}

fn visit_name<F: FnMut(Range<usize>, Axis)>(text: &str, node: &Node, found: &mut F) {
    let node = node.in_some(text);
    if let Some(axis) = node.string(text).and_then(|name| name.parse().ok()) {
        found(node.range.clone(), axis);
    }
}

#[cfg(test)]
mod tests {
    use super::super::clipboard::{copied, paste};
    use super::super::draft::Draft;
    use super::super::error::EditError;
    use super::super::part::{ControlKind, Part};
    use crate::editing::duplicate_parts;
    use crate::layout::Layout;

    const STICKS: &str = "Layout(name: \"a\", boards: [(
    pose: (anchor: elbow, forward_mm: 320),
    joysticks: [(name: \"Stick\", at_mm: (0, 0), diameter_mm: 30, axes: (\"LeftX\", \"LeftY\"))],
    sliders: [(name: \"Gas\", at_mm: (0, 60), length_mm: 60, output: Axis(\"Throttle\"))],
    levers: [(name: \"Lift\", at_mm: (0, 90), length_mm: 60, width_mm: 20, output: Some(Axis(\"MoveZ\")))],
)])";

    #[test]
    fn copies_of_controls_set_free_axes_of_the_same_kind() {
        let edited = duplicate_parts(STICKS, &[Part::Board(0)], [400.0, 0.0]).unwrap();
        for axes in [
            "axes: (\"RightX\", \"RightY\")",
            "output: Axis(\"LeftTrigger\")",
            "output: Some(Axis(\"MoveX\"))",
        ] {
            assert!(edited.text.contains(axes), "{axes}: {}", edited.text);
        }
        Layout::parse(&edited.text, "a.ron").unwrap();
        // The next copy of the stick would need the wheel and the rudder, and the one after that has none.
        let again = duplicate_parts(&edited.text, &[Part::Board(1)], [400.0, 0.0]).unwrap();
        assert!(again.text.contains("axes: (\"Wheel\", \"Rudder\")"));
        let none = duplicate_parts(&again.text, &[Part::Board(0)], [800.0, 0.0]).unwrap_err();
        assert_eq!(none, EditError::NoAxis("LeftX".into()));
    }

    #[test]
    fn a_pasted_control_keeps_an_axis_that_is_free() {
        let stick = Part::control(0, ControlKind::Joystick, 0);
        let clipboard = copied(STICKS, &[stick]).unwrap();
        let paste = |text: &str| {
            let mut draft = Draft::new(text).unwrap();
            paste(&mut draft, 0, &clipboard, [0.0, 40.0]).unwrap();
            draft.text().to_owned()
        };
        let bare = "Layout(name: \"a\", boards: [(pose: (anchor: elbow, forward_mm: 320))])";
        assert!(paste(bare).contains("axes: (\"LeftX\", \"LeftY\")"));
        assert!(paste(STICKS).contains("axes: (\"RightX\", \"RightY\")"));
    }
}
