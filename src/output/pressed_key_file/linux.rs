//! Files of pressed keys in `$XDG_RUNTIME_DIR/ademan`.

use std::env;
use std::fs::{self, File};
use std::io::{self, Read};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use rustix::fs::fstatfs;

use crate::device::KeyCode;
use crate::device::pressed_keys::{KeyDirection, PressedKeys};
use crate::files;
use crate::output::character_key::{CharacterKey, KeymapChange};
use crate::output::socket;

/// Start of the names of the files.
const PREFIX: &str = "pressed-";

/// Number of event codes (`KEY_CNT` in linux/input-event-codes.h).
const KEY_COUNT: usize = 0x300;

/// Largest number of files of a process, which has one for each output to a display.
const MAX_OUTPUTS: u32 = 16;

/// Longest name of a display that is read, in bytes.
const MAX_NAME: u64 = 4096;

/// Length of the keysyms of the keys that were added to the keymap: one for each key code.
const KEYSYMS: usize = 256 * KEYSYM;

/// Length of a keysym, in bytes.
const KEYSYM: usize = size_of::<u32>();

/// Types of file systems in memory, as in `linux/magic.h`: tmpfs and ramfs.
const MEMORY_TYPES: [u32; 2] = [0x0102_1994, 0x8584_58f6];

/// The file of an output of this process.
pub struct PressedKeyFile {
    file: File,
    path: PathBuf,
    /// Position of the keysyms, behind the name of the display.
    keysyms: u64,
    is_abandoned: AtomicBool,
}

impl PressedKeyFile {
    /// Creates a file for the display of the session. `None` without a runtime folder.
    pub fn create() -> Option<Self> {
        let process = std::process::id();
        let path = |number| socket::default_path(&format!("{PREFIX}{process}-{number}"));
        let mut paths = (0..MAX_OUTPUTS).map_while(path);
        let unused = paths.find(|path| !path.exists())?;
        Self::create_at(unused, &display()).ok()
    }

    /// Creates a file for `display`.
    pub fn create_at(path: PathBuf, display: &str) -> io::Result<Self> {
        let folder = path.parent().unwrap_or(Path::new("."));
        files::create_private_folder(folder).map_err(io::Error::other)?;
        // It gets its name when it is locked: without a lock it would count as abandoned.
        let unnamed = path.with_extension("new");
        let _ = fs::remove_file(&unnamed);
        let file = files::create_private(&unnamed).map_err(io::Error::other)?;
        file.try_lock()?;
        // Behind the name is a NUL.
        let keysyms = (KEY_COUNT + display.len() + 1) as u64;
        file.set_len(keysyms + KEYSYMS as u64)?;
        file.write_all_at(display.as_bytes(), KEY_COUNT as u64)?;
        fs::rename(unnamed, &path)?;
        Ok(Self {
            file,
            path,
            keysyms,
            is_abandoned: AtomicBool::new(false),
        })
    }

    /// Returns `true` if recording a key cannot wait for a disk.
    pub fn is_in_memory(&self) -> bool {
        fstatfs(&self.file).is_ok_and(|system| MEMORY_TYPES.contains(&(system.f_type as u32)))
    }

    /// Records a key: before a press and after a release. Writes one byte, which a reader sees entirely or not at all.
    pub fn record(&self, key: KeyCode, direction: KeyDirection) {
        let is_pressed = direction == KeyDirection::Press;
        // The watchdog remains if the file cannot be written.
        let _ = self
            .file
            .write_at(&[u8::from(is_pressed)], key.event_code().into());
    }

    /// Records a change of the keymap: before a key is added and after it is removed.
    pub fn record_character_key(&self, key: CharacterKey, change: KeymapChange) {
        let keysym = match change {
            KeymapChange::Added => key.keysym,
            KeymapChange::Removed => 0,
        };
        let position = self.keysyms + u64::from(key.code) * KEYSYM as u64;
        // The watchdog remains if the file cannot be written.
        let _ = self.file.write_at(&keysym.to_ne_bytes(), position);
    }

    /// Leaves the file behind at the end: keys could not be released.
    pub fn abandon(&self) {
        self.is_abandoned.store(true, Ordering::Relaxed);
    }
}

impl Drop for PressedKeyFile {
    /// Removes the file: every key was released, unless it was abandoned.
    fn drop(&mut self) {
        if !*self.is_abandoned.get_mut() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// The keys of a process that ended without releasing them.
pub struct AbandonedKeys {
    /// The keys and buttons.
    pub keys: PressedKeys,
    /// The keys that were added to the keymap.
    pub character_keys: Vec<CharacterKey>,
    path: PathBuf,
    /// Keeps other processes from releasing the keys too.
    _lock: File,
}

impl AbandonedKeys {
    /// Returns the abandoned keys of the display of the session.
    pub fn find() -> Vec<Self> {
        let folder = socket::default_path(PREFIX);
        let folder = folder.as_deref().and_then(Path::parent);
        folder.map_or_else(Vec::new, |folder| Self::find_in(folder, &display()))
    }

    fn find_in(folder: &Path, display: &str) -> Vec<Self> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let paths = entries.map(|entry| entry.path()).filter(|path| {
            let name = path.file_name().unwrap_or_default();
            name.to_string_lossy().starts_with(PREFIX) && path.extension().is_none()
        });
        paths
            .filter_map(|path| Self::read(path, display).ok().flatten())
            .collect()
    }

    /// Reads a file. `None` if its process runs or it is of another display.
    fn read(path: PathBuf, display: &str) -> io::Result<Option<Self>> {
        let mut file = files::open_regular(&path).map_err(io::Error::other)?;
        if file.try_lock().is_err() {
            return Ok(None);
        }
        let mut bytes = [0; KEY_COUNT];
        file.read_exact(&mut bytes)?;
        let mut rest = Vec::new();
        (&file)
            .take(MAX_NAME + KEYSYMS as u64)
            .read_to_end(&mut rest)?;
        // An earlier version wrote no more than the name.
        let end = rest.iter().position(|byte| *byte == 0);
        let (name, keysyms) = rest.split_at(end.unwrap_or(rest.len()));
        if name != display.as_bytes() {
            return Ok(None);
        }
        let mut keys = PressedKeys::default();
        for key in KeyCode::all().filter(|key| bytes[usize::from(key.event_code())] == 1) {
            keys.press(key);
        }
        Ok(Some(Self {
            keys,
            character_keys: character_keys(keysyms.get(1..).unwrap_or_default()),
            path,
            _lock: file,
        }))
    }

    /// Removes the file: the keys were released.
    pub fn forget(self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// Decodes the keys that were added to the keymap.
fn character_keys(keysyms: &[u8]) -> Vec<CharacterKey> {
    let keysyms = keysyms.as_chunks().0.iter();
    let keys = (0..=u8::MAX)
        .zip(keysyms)
        .map(|(code, keysym)| CharacterKey {
            code,
            keysym: u32::from_ne_bytes(*keysym),
        });
    keys.filter(|key| key.keysym != 0).collect()
}

/// Returns the name of the display of the session.
fn display() -> String {
    let name = |variable| env::var_os(variable).filter(|name| !name.is_empty());
    let name = name("WAYLAND_DISPLAY").or_else(|| name("DISPLAY"));
    name.unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;
    use std::os::unix::fs::PermissionsExt;
    use std::process::Command;

    fn path(folder: &tempfile::TempDir, name: &str) -> PathBuf {
        folder.path().join("ademan").join(name)
    }

    #[test]
    fn keys_are_abandoned_when_the_lock_ends_and_only_on_their_display() {
        let folder = tempfile::tempdir().unwrap();
        let path = path(&folder, "pressed-1-0");
        let inside = path.parent().unwrap().to_owned();
        let file = PressedKeyFile::create_at(path.clone(), ":7").unwrap();
        assert_eq!(
            fs::metadata(&path).unwrap().permissions().mode() & 0o777,
            0o600
        );
        file.record(key("A"), KeyDirection::Press);
        file.record(key("MouseLeft"), KeyDirection::Press);
        file.record(key("A"), KeyDirection::Release);
        assert!(AbandonedKeys::find_in(&inside, ":7").is_empty());

        let copy = file.file.try_clone().unwrap();
        std::mem::forget(file);
        copy.unlock().unwrap();
        assert!(AbandonedKeys::find_in(&inside, ":8").is_empty());
        let mut found = AbandonedKeys::find_in(&inside, ":7");
        let found = found.pop().expect("an abandoned file");
        let keys: Vec<_> = found.keys.release_order().collect();
        assert_eq!(keys, [key("MouseLeft")]);
        assert!(
            AbandonedKeys::find_in(&inside, ":7").is_empty(),
            "found twice"
        );
        found.forget();
        assert!(!path.exists());
    }

    #[test]
    fn keys_of_the_keymap_are_abandoned_until_they_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = path(&folder, "pressed-1-0");
        let inside = path.parent().unwrap().to_owned();
        let key = |code, keysym| CharacterKey { code, keysym };
        let file = PressedKeyFile::create_at(path.clone(), ":7").unwrap();
        let (first, last) = (key(9, 0x0100_03bb), key(255, 0x0101_f642));
        for added in [first, key(92, 0xf1), last] {
            file.record_character_key(added, KeymapChange::Added);
        }
        file.record_character_key(key(92, 0xf1), KeymapChange::Removed);
        file.abandon();
        drop(file);
        let found = AbandonedKeys::find_in(&inside, ":7").pop();
        assert_eq!(found.expect("a file").character_keys, [first, last]);

        // As written by an earlier version.
        let content = [&[0; KEY_COUNT], &b":7"[..]].concat();
        fs::write(&path, content).unwrap();
        let found = AbandonedKeys::find_in(&inside, ":7").pop();
        assert_eq!(found.expect("a file").character_keys, []);
    }

    #[test]
    fn only_a_file_system_in_memory_counts_as_one() {
        let program = env::current_exe().unwrap();
        for folder in [Path::new("/dev/shm"), program.parent().unwrap()] {
            let folder = tempfile::tempdir_in(folder).unwrap();
            let file = PressedKeyFile::create_at(path(&folder, "pressed-1-0"), ":7").unwrap();
            let mut stat = Command::new("stat");
            stat.args(["--file-system", "--format=%T"]).arg(&file.path);
            let kind = stat.output().expect("stat of coreutils").stdout;
            let is_in_memory = matches!(kind.trim_ascii(), b"tmpfs" | b"ramfs");
            assert_eq!(file.is_in_memory(), is_in_memory, "{folder:?}");
        }
    }

    #[test]
    fn an_orderly_end_removes_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = path(&folder, "pressed-1-0");
        let file = PressedKeyFile::create_at(path.clone(), ":7").unwrap();
        assert!(path.exists());
        drop(file);
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 0);
    }
}
