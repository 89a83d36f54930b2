//! Files of pressed keys in `$XDG_RUNTIME_DIR/ademan`.

use std::env;
use std::fs::{self, File};
use std::io::{self, Read};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use rustix::fs::fstatfs;

use crate::files::{self, FileError, LockedFile};
use crate::output::character_key::{CharacterKey, KeymapChange};
use crate::output::socket;
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};
use ademan_core::message::{escape, escape_path};

/// Start of the names of the files.
const PREFIX: &str = "pressed-";

/// Number of event codes (`KEY_CNT` in linux/input-event-codes.h).
const KEY_COUNT: usize = 0x300;

/// Largest number of files of a process, which has one for each output to a display.
const MAX_OUTPUTS: u32 = 16;

/// Longest name of a display that is read, in bytes.
const MAX_NAME: u64 = 4096;

/// Start of the path of the socket of an X server, which may stand in its place in `DISPLAY`.
const X11_SOCKET: &str = "/tmp/.X11-unix/X";
/// Length of the keysyms of the keys that were added to the keymap: one for each key code.
const KEYSYMS: usize = 256 * KEYSYM;

/// Length of a keysym, in bytes.
const KEYSYM: usize = size_of::<u32>();

/// Types of file systems in memory, as in `linux/magic.h`: tmpfs and ramfs.
const MEMORY_TYPES: [u32; 2] = [0x0102_1994, 0x8584_58f6];

/// Number of times that a file is read until its process has exited, and the interval between them.
const EXIT_ATTEMPTS: u32 = 100;
const EXIT_INTERVAL: Duration = Duration::from_millis(10);

/// Returns the path of the file of an output of a process. `None` without a runtime folder.
fn file_path(process: u32, number: u32) -> Option<PathBuf> {
    socket::default_path(&format!("{PREFIX}{process}-{number}"))
}

/// The file of an output of this process.
pub struct PressedKeyFile {
    file: LockedFile,
    path: PathBuf,
    /// Position of the keysyms, after the name of the display.
    keysyms: u64,
    is_abandoned: AtomicBool,
}

impl PressedKeyFile {
    /// Creates a file for the display of the session. `None` without a runtime folder, and with a message if the folder
    /// accepts no file.
    pub fn create() -> Option<Self> {
        let process = std::process::id();
        let path = |number| file_path(process, number);
        let folder = path(0)?.parent()?.to_owned();
        let mut paths = (0..MAX_OUTPUTS).map_while(path);
        let created = match paths.find(|candidate| !candidate.exists()) {
            Some(unused) => Self::create_at(unused, &display()),
            None => Err(io::ErrorKind::AlreadyExists.into()),
        };
        created
            .inspect_err(|error| {
                tracing::warn!(
                    "cannot record pressed keys in {}: {error}; they stay pressed if the program and its watchdog are killed in the same instant",
                    escape(&folder.to_string_lossy())
                );
            })
            .ok()
    }

    /// Creates a file for `display`.
    pub fn create_at(path: PathBuf, display: &str) -> io::Result<Self> {
        let folder = path.parent().unwrap_or(Path::new("."));
        files::create_private_folder(folder).map_err(io::Error::other)?;
        // It gets its name when it is locked: without a lock it would count as abandoned.
        let unnamed = path.with_extension("new");
        let _ = fs::remove_file(&unnamed);
        let file = files::create_private(&unnamed).map_err(io::Error::other)?;
        let file = LockedFile::try_lock(file)?;
        // All bytes are written, so that a full disk shows here and not at a press. After the name is a NUL.
        let content = [&[0; KEY_COUNT], display.as_bytes(), &[0; 1 + KEYSYMS]].concat();
        let written = file
            .write_all_at(&content, 0)
            .and_then(|()| fs::rename(&unnamed, &path));
        written.inspect_err(|_| _ = fs::remove_file(&unnamed))?;
        Ok(Self {
            file,
            path,
            keysyms: (KEY_COUNT + display.len() + 1) as u64,
            is_abandoned: AtomicBool::new(false),
        })
    }

    /// Returns `true` if recording a key cannot wait for a disk.
    pub fn is_in_memory(&self) -> bool {
        fstatfs(&*self.file).is_ok_and(|system| MEMORY_TYPES.contains(&(system.f_type as u32)))
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
    display: String,
    path: PathBuf,
    /// Keeps other processes from releasing the keys too.
    _lock: LockedFile,
}

impl AbandonedKeys {
    /// Returns the abandoned keys of the display of the session, and the reason for each record that is skipped although keys
    /// may be pressed.
    pub fn find() -> Vec<Result<Self, String>> {
        let folder = socket::default_path(PREFIX);
        let folder = folder.as_deref().and_then(Path::parent);
        folder.map_or_else(Vec::new, |folder| Self::find_in(folder, &display()))
    }

    /// Returns the records of a folder. None is used if another user could have put a file into it.
    pub fn find_in(folder: &Path, display: &str) -> Vec<Result<Self, String>> {
        match files::check_private_folder(folder) {
            Err(FileError::Io(error)) if error.kind() == io::ErrorKind::NotFound => {
                return Vec::new();
            }
            Err(error) => {
                return vec![Err(format!("cannot read {}: {error}", escape_path(folder)))];
            }
            Ok(()) => {}
        }
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let paths = entries.map(|entry| entry.path()).filter(|path| {
            let name = path.file_name().unwrap_or_default();
            name.to_string_lossy().starts_with(PREFIX) && path.extension().is_none()
        });
        let read = |path: PathBuf| {
            let name = escape_path(&path);
            let abandoned = match Self::read(path) {
                Ok(abandoned) => abandoned?,
                Err(error) => return Some(Err(format!("cannot read {name}: {error}"))),
            };
            if abandoned.display == display {
                return Some(Ok(abandoned));
            }
            (!abandoned.keys.is_empty()).then(|| Err(abandoned.other_display(display)))
        };
        paths.filter_map(read).collect()
    }

    /// Returns the name of the display, which a connection to it accepts.
    pub fn display_name(&self) -> &str {
        &self.display
    }

    /// Returns the reason why these keys are not released on `display`.
    fn other_display(&self, display: &str) -> String {
        let this = if display.is_empty() {
            "no display is set here".to_owned()
        } else {
            format!("this is `{}`", escape(display))
        };
        format!(
            "{} on the display `{}`, and {this}; repeat `ademan release-keys` on that display, or delete {}",
            self.keys.count(),
            escape(&self.display),
            escape_path(&self.path),
        )
    }

    /// Reads a file. `None` if its process runs.
    fn read(path: PathBuf) -> io::Result<Option<Self>> {
        let file = files::open_secret(&path).map_err(io::Error::other)?;
        let Ok(lock) = LockedFile::try_lock(file) else {
            return Ok(None);
        };
        let mut content: &File = &lock;
        let mut bytes = [0; KEY_COUNT];
        content.read_exact(&mut bytes)?;
        let mut rest = Vec::new();
        content
            .take(MAX_NAME + KEYSYMS as u64)
            .read_to_end(&mut rest)?;
        // An earlier version wrote no more than the name.
        let end = rest.iter().position(|byte| *byte == 0);
        let (name, keysyms) = rest.split_at(end.unwrap_or(rest.len()));
        let mut keys = PressedKeys::default();
        for key in KeyCode::all().filter(|key| bytes[usize::from(key.event_code())] == 1) {
            keys.press(key);
        }
        Ok(Some(Self {
            keys,
            character_keys: character_keys(keysyms.get(1..).unwrap_or_default()),
            display: String::from_utf8_lossy(name).into_owned(),
            path,
            _lock: lock,
        }))
    }

    /// Removes the file: the keys were released.
    pub fn forget(self) {
        let _ = fs::remove_file(&self.path);
    }

    /// Removes the file of a process that has exited, if all keys in it are among the `released` ones. It stays if the process still
    /// runs, has added keys to the keymap, or had several outputs, whose keys are released by other watchdogs.
    pub fn forget_released(process: u32, released: &PressedKeys) {
        let paths = (0..MAX_OUTPUTS).filter_map(|number| file_path(process, number));
        let mut paths = paths.filter(|path| path.exists());
        let (Some(path), None) = (paths.next(), paths.next()) else {
            return;
        };
        if let Some(abandoned) = Self::wait_for(&path)
            && abandoned.character_keys.is_empty()
            && (abandoned.keys.release_order()).all(|key| released.contains(key))
        {
            abandoned.forget();
        }
    }

    /// Reads a file once its process has exited. The system closes the connection to the watchdog a moment before the file.
    fn wait_for(path: &Path) -> Option<Self> {
        for _ in 0..EXIT_ATTEMPTS {
            match Self::read(path.to_owned()) {
                Ok(None) => thread::sleep(EXIT_INTERVAL),
                read => return read.ok().flatten(),
            }
        }
        None
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

/// Returns the name of the display of the session. Each display has one name, however the environment spells it.
fn display() -> String {
    let value = |variable| env::var_os(variable).filter(|value| !value.is_empty());
    if let Some(compositor) = value("WAYLAND_DISPLAY") {
        let folder = value("XDG_RUNTIME_DIR").unwrap_or_default();
        return Path::new(&folder)
            .join(compositor)
            .to_string_lossy()
            .into_owned();
    }
    let name = value("DISPLAY").unwrap_or_default();
    canonical_x_display(&name.to_string_lossy())
}

/// Returns the name of an X server without its screen, and `:N` for a server of this machine: `unix:1.0` is `:1`.
fn canonical_x_display(name: &str) -> String {
    if let Some(number) = name.strip_prefix(X11_SOCKET) {
        return format!(":{}", without_screen(number));
    }
    let Some((host, number)) = name.rsplit_once(':') else {
        return name.to_owned();
    };
    let host = match host {
        "unix" | "unix/" | "unix/unix" => "",
        host => host,
    };
    format!("{host}:{}", without_screen(number))
}

fn without_screen(number: &str) -> &str {
    number.split_once('.').map_or(number, |(number, _)| number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;
    use std::io::Write;
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
        let skipped = AbandonedKeys::find_in(&inside, ":8").pop();
        let reason = skipped.expect("a reason").err().expect("another display");
        assert!(
            reason.starts_with("1 on the display `:7`, and this is `:8`"),
            "{reason}"
        );
        let mut found = AbandonedKeys::find_in(&inside, ":7");
        let found = found.pop().expect("an abandoned file").expect("its keys");
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
    fn a_record_that_another_user_may_have_written_is_ignored() {
        let folder = tempfile::tempdir().unwrap();
        let path = path(&folder, "pressed-1-0");
        let inside = path.parent().unwrap().to_owned();
        let file = PressedKeyFile::create_at(path.clone(), ":7").unwrap();
        file.record(key("A"), KeyDirection::Press);
        let copy = file.file.try_clone().unwrap();
        std::mem::forget(file);
        copy.unlock().unwrap();
        let is_found = || {
            let mut found = AbandonedKeys::find_in(&inside, ":7").into_iter();
            found.any(|record| record.is_ok())
        };
        assert!(is_found());
        let set = |target: &Path, mode| {
            fs::set_permissions(target, fs::Permissions::from_mode(mode)).unwrap();
        };
        for (changed, open, private) in [(&inside, 0o777, 0o700), (&path, 0o666, 0o600)] {
            set(changed, open);
            assert!(!is_found(), "{changed:?}");
            set(changed, private);
            assert!(is_found(), "{changed:?}");
        }
        for owned in [&path, &inside] {
            if std::os::unix::fs::chown(owned, Some(65_534), None).is_err() {
                println!("SKIPPED: only root can give a file to another user");
                return;
            }
            assert!(!is_found(), "{owned:?}");
            std::os::unix::fs::chown(owned, Some(0), None).unwrap();
        }
    }

    #[test]
    fn an_x_server_has_one_name() {
        let names = [
            ":7",
            ":7.0",
            "unix:7",
            "unix:7.1",
            "unix/:7",
            "unix/unix:7.0",
            "/tmp/.X11-unix/X7.0",
        ];
        for name in names {
            assert_eq!(canonical_x_display(name), ":7", "{name}");
        }
        let others = [
            ("other:7.0", "other:7"),
            ("localhost:10.0", "localhost:10"),
            ("", ""),
            ("wrong", "wrong"),
        ];
        for (name, expected) in others {
            assert_eq!(canonical_x_display(name), expected, "{name}");
        }
    }

    #[test]
    fn a_record_that_cannot_be_read_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let path = path(&folder, "pressed-1-0");
        files::create_private_folder(path.parent().unwrap()).unwrap();
        let mut file = files::create_private(&path).unwrap();
        file.write_all(b"short").unwrap();
        let found = AbandonedKeys::find_in(path.parent().unwrap(), ":7").pop();
        let reason = found.expect("a reason").err().expect("no keys");
        assert!(reason.starts_with("cannot read "), "{reason}");
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
        assert_eq!(
            found.expect("a file").expect("its keys").character_keys,
            [first, last]
        );

        // As written by an earlier version.
        let content = [&[0; KEY_COUNT], &b":7"[..]].concat();
        fs::write(&path, content).unwrap();
        let found_keys = AbandonedKeys::find_in(&inside, ":7").pop();
        assert_eq!(
            found_keys
                .expect("a file")
                .expect("its keys")
                .character_keys,
            []
        );
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
