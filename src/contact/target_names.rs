//! What targets are called.

use std::fmt;
use std::sync::Arc;

use serde::Serialize;

use super::TargetId;

/// What the targets of a scene are called, in the order of their numbers. Copies are cheap.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TargetNames(Arc<[String]>);

/// A target by its name, or by its number where it has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum TargetName<'a> {
    /// The name.
    Name(&'a str),
    /// The number.
    Id(TargetId),
}

impl TargetNames {
    /// Target number `i` is called `names[i]`.
    pub fn new(names: impl IntoIterator<Item = String>) -> Self {
        Self(names.into_iter().collect())
    }

    /// The target that is called so.
    pub fn find(&self, name: &str) -> Option<TargetId> {
        let place = self.0.iter().position(|other| other == name)?;
        Some(TargetId(place as u32))
    }

    /// The names, in the order of the targets.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }

    /// What a target is called.
    pub fn get(&self, target: TargetId) -> TargetName<'_> {
        match self.0.get(target.0 as usize) {
            Some(name) => TargetName::Name(name),
            None => TargetName::Id(target),
        }
    }
}

impl fmt::Display for TargetName<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => f.pad(name),
            Self::Id(TargetId(number)) => number.fmt(f),
        }
    }
}
