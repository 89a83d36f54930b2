//! Names of targets.

use std::fmt;
use std::sync::Arc;

use serde::Serialize;

use super::TargetId;

/// The names of the targets of a scene, in the order of their ids. Cloning is cheap: clones share the list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TargetNames(Arc<[String]>);

/// The name of a target, or its id if it has no name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum TargetName<'a> {
    /// The name.
    Name(&'a str),
    /// The id.
    Id(TargetId),
}

impl TargetNames {
    /// Creates the list; `names[i]` is the name of the target with id `i`.
    pub fn new(names: impl IntoIterator<Item = String>) -> Self {
        Self(names.into_iter().collect())
    }

    /// Returns the id of the first target with this name.
    pub fn find(&self, name: &str) -> Option<TargetId> {
        let index = self.0.iter().position(|other| other == name)?;
        Some(TargetId(index as u32))
    }

    /// Iterates over the names, in the order of the target ids.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }

    /// Returns the name of a target, or its id if it has no name.
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
            Self::Id(TargetId(id)) => id.fmt(f),
        }
    }
}
