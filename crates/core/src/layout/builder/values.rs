//! Values of controls that have several.

use std::borrow::Cow;
use std::collections::btree_map::Entry;

use super::{LayoutBuilder, NamedTarget};
use crate::contact::TargetId;
use crate::device::value_output::NamedValue;
use crate::document::line_number;

impl LayoutBuilder<'_> {
    /// Registers the values of controls that have several, after all other targets. Reports names that are taken.
    pub fn add_values(&mut self) {
        let mut next = self.sources.len() as u32;
        let mut controls = std::mem::take(&mut self.controls);
        for control in &mut controls {
            let Some(front) = control.faces.first().map(|face| face.target) else {
                continue;
            };
            for value in control.kind.values_mut() {
                value.target = TargetId(next);
                next += 1;
                self.add_value(value, front);
            }
        }
        self.controls = controls;
    }

    fn add_value(&mut self, value: &NamedValue, front: TargetId) {
        let source = self.sources[front.0 as usize];
        let named = NamedTarget {
            kind: "value",
            source,
            target: value.target,
        };
        match self.targets.entry(Cow::Owned(value.name.clone())) {
            Entry::Vacant(entry) => {
                entry.insert(named);
            }
            Entry::Occupied(entry) => {
                let other = *entry.get();
                let line = line_number(&self.document.text, other.source);
                let message = format!(
                    "its value `{}` has the name of a {} in line {line}, set another `name`",
                    value.name, other.kind
                );
                let error = self.error(source, message);
                self.report(error, &[front]);
            }
        }
    }

    /// Returns the values of the control of a target, if it has several.
    pub fn values_of(&self, target: TargetId) -> &[NamedValue] {
        let mut controls = self.controls.iter();
        let control = controls.find(|it| it.faces.iter().any(|face| face.target == target));
        control.map_or(&[], |control| control.kind.values())
    }
}
