//! The recordings that are offered as a source.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::disk_search::DiskSearch;
use super::recent::{MAX_RECENT, RecentFiles};

/// The ending of recordings.
const ENDING: &str = "mcap";

/// The largest number of entries of a folder that are looked at.
const MAX_ENTRIES: usize = 10_000;

/// Starts to search in a folder, and in the folders of the recordings that were used last. Calls `notify` at the end.
pub fn search(
    folder: PathBuf,
    used: RecentFiles,
    notify: impl FnOnce() + Send + 'static,
) -> DiskSearch<Vec<PathBuf>> {
    DiskSearch::start("recordings", move || find(&folder, &used), notify)
}

/// Returns at most [`MAX_RECENT`] recordings, the newest first: the recordings in `folder`, the recordings that were used last, and
/// all others in the folders of these.
///
/// `ademan record` and `--record` write to a path that the person names, usually in one of these folders. Reads the disk, which may
/// take long.
fn find(folder: &Path, used: &RecentFiles) -> Vec<PathBuf> {
    let used: Vec<&Path> = used.iter().map(Path::new).collect();
    let mut folders: Vec<&Path> = std::iter::once(folder)
        .chain(used.iter().filter_map(|file| file.parent()))
        .collect();
    folders.sort_unstable();
    folders.dedup();
    let in_folders = folders.into_iter().flat_map(recordings_in);
    let used = used.iter().map(|file| file.to_path_buf());
    let mut found: Vec<(SystemTime, PathBuf)> = in_folders
        .chain(used)
        .filter_map(|path| Some((written_at(&path)?, path)))
        .collect();
    found.sort_by(|a, b| b.cmp(a));
    found.dedup();
    found.truncate(MAX_RECENT);
    found.into_iter().map(|(_, path)| path).collect()
}

fn recordings_in(folder: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = entries.take(MAX_ENTRIES).map(|entry| entry.path());
    paths.filter(|path| path.extension().is_some_and(|ending| ending == ENDING))
}

/// Returns the time of the last change of a regular file.
fn written_at(path: &Path) -> Option<SystemTime> {
    let metadata = fs::metadata(path).ok().filter(fs::Metadata::is_file)?;
    metadata.modified().ok()
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::time::Duration;

    use super::*;

    /// Writes a file that was changed a number of seconds after others.
    fn write(path: &Path, seconds: u64) {
        let file = File::create(path).expect("a file");
        let time = SystemTime::UNIX_EPOCH + Duration::from_secs(1_000_000 + seconds);
        file.set_modified(time).expect("a time");
    }

    #[test]
    fn recordings_of_the_folder_and_of_used_ones_are_listed_the_newest_first() {
        let folder = tempfile::tempdir().expect("a folder");
        let (here, there) = (folder.path().join("here"), folder.path().join("there"));
        fs::create_dir(&here).expect("a folder");
        fs::create_dir(&there).expect("a folder");
        write(&here.join("old.mcap"), 1);
        write(&here.join("notes.txt"), 9);
        fs::create_dir(here.join("folder.mcap")).expect("a folder");
        write(&there.join("new.mcap"), 3);
        write(&there.join("beside.mcap"), 2);
        let mut used = RecentFiles::default();
        used.push(&there.join("new.mcap"));
        used.push(&there.join("gone.mcap"));
        let expected = [
            there.join("new.mcap"),
            there.join("beside.mcap"),
            here.join("old.mcap"),
        ];
        assert_eq!(find(&here, &used), expected);
        assert_eq!(find(&here, &RecentFiles::default()), expected[2..]);
    }

    #[test]
    fn the_oldest_of_many_recordings_are_left_out() {
        let folder = tempfile::tempdir().expect("a folder");
        for number in 0..20 {
            write(&folder.path().join(format!("{number}.mcap")), number);
        }
        let found = find(folder.path(), &RecentFiles::default());
        assert_eq!(found.len(), MAX_RECENT);
        assert_eq!(found[0], folder.path().join("19.mcap"));
    }
}
