//! The files that were opened last.

use std::path::{self, Path};

use serde::{Deserialize, Serialize};

/// The most files that are kept.
pub const MAX_RECENT: usize = 8;

/// Files, the latest first, each once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct RecentFiles(Vec<String>);

impl RecentFiles {
    /// Moves a file to the front. The oldest one is dropped if there are too many. A path that is not UTF-8 is left out.
    pub fn push(&mut self, file: &Path) {
        let Ok(file) = path::absolute(file) else {
            return;
        };
        let Some(file) = file.to_str() else {
            return;
        };
        if self.0.first().is_some_and(|first| first == file) {
            return;
        }
        self.remove(file);
        self.0.insert(0, file.to_owned());
        self.0.truncate(MAX_RECENT);
    }

    /// Drops a file.
    pub fn remove(&mut self, file: &str) {
        self.0.retain(|other| other != file);
    }

    /// Iterates over the files, the latest first.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }

    /// Returns the files that have a part, in small letters, in their paths.
    pub fn with_part<'a>(&'a self, part: &'a str) -> impl Iterator<Item = &'a str> {
        self.iter()
            .filter(move |file| file.to_lowercase().contains(part))
    }

    /// Adds the files that have been added to another list since both were the list `before`: after those that have been added to this
    /// one, so that a full list drops its oldest files.
    pub fn merge(&mut self, other: &Self, before: &Self) {
        let is_new = |file: &String| !before.0.contains(file);
        let has_other_first = usize::from(self.0.first() != before.0.first());
        let last_own = self.0.iter().rposition(is_new);
        let place = last_own.map_or(has_other_first.min(self.0.len()), |last| last + 1);
        let added = other.0.iter().filter(|file| is_new(file));
        let added: Vec<String> = added
            .filter(|file| !self.0.contains(file))
            .cloned()
            .collect();
        self.0.splice(place..place, added);
        self.0.truncate(MAX_RECENT);
    }

    /// Returns at most [`MAX_RECENT`] files.
    #[must_use]
    pub fn checked(mut self) -> Self {
        self.0.truncate(MAX_RECENT);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_files_are_kept_each_once() {
        let mut recent = RecentFiles::default();
        for number in 0..20 {
            recent.push(Path::new(&format!("/layouts/{number}.ron")));
        }
        recent.push(Path::new("/layouts/15.ron"));
        recent.push(Path::new("/layouts/15.ron"));
        let numbers = ["15", "19", "18", "17", "16", "14", "13", "12"];
        let expected = numbers.map(|number| format!("/layouts/{number}.ron"));
        assert_eq!(recent.iter().collect::<Vec<_>>(), expected);
        recent.remove("/layouts/19.ron");
        assert_eq!(recent.iter().count(), MAX_RECENT - 1);
    }

    #[test]
    fn files_that_another_window_has_added_come_after_those_of_this_one() {
        let list = |names: &str| RecentFiles(names.split(' ').map(str::to_owned).collect());
        for (own, other, before, expected) in [
            ("a b", "a b", "a b", "a b"),
            ("x a b", "y a b", "a b", "x y a b"),
            ("a b", "y a b", "a b", "y a b"),
            ("b a", "y a b", "a b", "b y a"),
            ("b x a", "y a b", "a b", "b x y a"),
            // `a` was removed here.
            ("b", "y a b", "a b", "b y"),
            (
                "x 1 2 3 4 5 6 7",
                "y 1 2 3 4 5 6 7",
                "1 2 3 4 5 6 7 8",
                "x y 1 2 3 4 5 6",
            ),
        ] {
            let mut merged = list(own);
            merged.merge(&list(other), &list(before));
            assert_eq!(merged, list(expected), "{own} {other}");
        }
    }

    #[test]
    fn a_long_list_of_a_file_is_shortened() {
        let names: Vec<String> = (0..100).map(|number| number.to_string()).collect();
        assert_eq!(RecentFiles(names).checked().iter().count(), MAX_RECENT);
    }
}
