//! Access to the files of a person. Only regular files are read. Files with what a person types can be read by this person only,
//! and files that decide what is typed are read only if no other user can write them.
//!
//! Opening a pipe waits for its other end, and opening a device may act on it: a path that leads to one of them is
//! refused before it is opened, and checked again on the open file.

use ademan_core::message::{escape_path, shell_word};
use std::fs::{self, File, FileType, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

mod config;
mod documents;
mod lock;
mod replace;
mod search;

pub use config::{config_folder, in_config_folder, state_folder, transcript_folder};
pub use documents::{Load, OpenDocument};
pub use lock::LockedFile;
pub use replace::{
    check_destination, check_overwrite, replace, replace_private_text, replace_private_text_if,
    replace_public_text, replace_text, replace_text_and_keep, replace_text_if, write_new,
    write_new_private,
};
pub use search::own_names;

#[cfg(unix)]
mod unix;
#[cfg(unix)]
use unix as system;

#[cfg(not(unix))]
mod unsupported;
#[cfg(not(unix))]
use unsupported as system;

/// The most symbolic links, one after the other, that lead to a file: as many as Linux follows.
const MAX_LINKS: usize = 40;

/// The number of attempts to open a file that other programs replace at the same time.
const MAX_OPEN_ATTEMPTS: usize = 5;

/// Reason why a file is not opened.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The path leads to a directory.
    #[error("this is a directory, name a file in it")]
    IsDirectory,
    /// The path leads to something else than a regular file.
    #[error("this is not a regular file but {0}, name a file")]
    NotRegular(&'static str),
    /// The path is a symbolic link.
    #[error("this is a symbolic link, name the file itself")]
    IsLink,
    /// The path leads through too many symbolic links.
    #[error(
        "more than {} symbolic links lead to this file, or they lead in a circle; name the file itself",
        MAX_LINKS
    )]
    TooManyLinks,
    /// Each time that the file was opened, another one had taken its place.
    #[error("another program replaces this file again and again; end it and try again")]
    KeepsChanging,
    /// A new file is to be created, and there is something at its path.
    #[error("the file exists; choose another name or remove it")]
    Exists,
    /// The file is to be replaced, and another program has changed it.
    #[error("another program has changed the file")]
    Changed,
    /// The file belongs to another user, who could read what is written or change what is read.
    #[error("this file belongs to another user, use one of your own")]
    OtherOwner,
    /// The file has several names (hard links): another user may have linked it to this path.
    #[error("this file has {0} names (hard links), use one that has a single name")]
    HardLinks(u64),
    /// Other users may change what is read.
    #[error(
        "other users may write this file; `chmod go-w {path}` makes it yours alone",
        path = shell_word(&.0.to_string_lossy())
    )]
    OthersMayWrite(PathBuf),
    /// Other users may replace the file by another one, as they may write to this folder.
    #[error(
        "other users may replace this file, as they may write to its folder; `chmod go-w {path}` makes the folder yours alone, or copy the file to such a folder",
        path = shell_word(&.0.to_string_lossy())
    )]
    OthersMayReplace(PathBuf),
    /// Other users may access the folder.
    #[error(
        "other users may access {}; restrict it to yourself: chmod 700 {}",
        escape_path(.0),
        shell_word(&.0.to_string_lossy())
    )]
    OpenFolder(PathBuf),
    /// Other users may read the file.
    #[error(
        "other users may read it, so that its secret may be known; make it private and replace its tokens: chmod 600 {path}",
        path = shell_word(&.0.to_string_lossy())
    )]
    Exposed(PathBuf),
    /// The operating system refuses.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// Opens a regular file for reading. Follows symbolic links, and never blocks: a named pipe is refused.
pub fn open_regular(path: &Path) -> Result<File, FileError> {
    check_regular(fs::metadata(path)?.file_type())?;
    let file = system::open_without_waiting(path)?;
    check_regular(file.metadata()?.file_type())?;
    system::wait_from_now_on(&file)?;
    Ok(file)
}

/// Reads a regular file of at most this many MiB.
pub fn read_regular(path: &Path, most_mib: u64) -> Result<Vec<u8>, FileError> {
    let most = most_mib << 20;
    let mut bytes = Vec::new();
    open_regular(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("it is larger than {most_mib} MiB")).into());
    }
    Ok(bytes)
}

/// Reads a regular file of at most this many MiB as text.
pub fn read_regular_text(path: &Path, most_mib: u64) -> Result<String, FileError> {
    let text = String::from_utf8(read_regular(path, most_mib)?);
    text.map_err(|_| io::Error::other("it is not UTF-8 text").into())
}

/// Opens a file for reading that decides what is typed: a layout, a setup, a glove, an arm or a script. Only this user and root
/// may own it, write it, or replace it by another file in its folder, nor any link that leads to it. In a folder with the sticky bit,
/// such as `/tmp`, only the owner of a file replaces it.
pub fn open_trusted(path: &Path) -> Result<File, FileError> {
    for _ in 0..MAX_OPEN_ATTEMPTS {
        if let Some(file) = open_checked(path, &system::check_way(path)?)? {
            return Ok(file);
        }
    }
    Err(FileError::KeepsChanging)
}

/// Opens the file that [`check_way`](system::check_way) has found at a path. Returns `None` if another one has taken its place, as
/// when an editor saves.
fn open_checked(path: &Path, found: &Metadata) -> Result<Option<File>, FileError> {
    let file = open_regular(path)?;
    let metadata = file.metadata()?;
    if !system::is_same_file(found, &metadata) {
        return Ok(None);
    }
    system::check_writers(path, &metadata)?;
    Ok(Some(file))
}

/// Opens a file with a secret for reading: a regular file of this user that no one else can access.
pub fn open_secret(path: &Path) -> Result<File, FileError> {
    let file = open_regular(path)?;
    let metadata = file.metadata()?;
    system::check_owner(&metadata)?;
    if system::is_private_file(&metadata) {
        Ok(file)
    } else {
        Err(FileError::Exposed(path.into()))
    }
}

/// Creates a file that only its owner can access. Fails if anything exists at the path, also a link that leads nowhere.
pub fn create_private(path: &Path) -> Result<File, FileError> {
    created(path, system::create_private(path))
}

/// Creates a file with the usual permissions. Fails as [`create_private`] does.
pub fn create_new(path: &Path) -> Result<File, FileError> {
    created(path, File::create_new(path))
}

/// Returns the file, or the reason why it cannot be created: the kind of file that exists at its path.
fn created(path: &Path, created: io::Result<File>) -> Result<File, FileError> {
    match created {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            check_absent(path)?;
            Err(FileError::Exists)
        }
        created => Ok(created?),
    }
}

/// Checks that nothing exists at the path of a new file, before the work whose result the file will hold. Fails with the reason why
/// the file cannot be created.
pub fn check_absent(path: &Path) -> Result<(), FileError> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error.into()),
        Ok(metadata) => {
            check_no_link(&metadata)?;
            check_regular(metadata.file_type())?;
            Err(FileError::Exists)
        }
    }
}

/// Opens a file that only its owner can access for writing, or creates it. The content of an existing file stays.
///
/// An existing file must be a regular file of this user, with one name and not behind a symbolic link; its mode becomes
/// 0600 before this function returns.
pub fn open_private(path: &Path) -> Result<File, FileError> {
    open_own(path, system::open_private)
}

/// Opens a file as [`open_private`] does. Each write is added at its end, also if another program writes to it.
pub fn append_private(path: &Path) -> Result<File, FileError> {
    open_own(path, system::append_private)
}

/// Opens a file of this user, which becomes private.
fn open_own(path: &Path, open: fn(&Path) -> io::Result<File>) -> Result<File, FileError> {
    match fs::symlink_metadata(path) {
        Ok(metadata) => check_own(&metadata)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error.into()),
    }
    let file = open(path)?;
    check_own(&file.metadata()?)?;
    system::make_private(&file)?;
    system::wait_from_now_on(&file)?;
    Ok(file)
}

/// Returns the number of bytes that the user may still write on the disk of a file, which need not exist. `None` if the system does
/// not report it.
pub fn free_bytes(path: &Path) -> Option<u64> {
    system::free_bytes(folder_of(path))
}

/// Returns the folder of a file, which need not exist.
pub fn folder_of(path: &Path) -> &Path {
    let folder = path.parent();
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// Returns `true` if two paths name one file, which may not exist yet.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    one == other || resolved(one).is_some_and(|it| Some(it) == resolved(other))
}

/// Returns a path without links and relative parts; `None` if its folder does not exist.
fn resolved(path: &Path) -> Option<PathBuf> {
    fs::canonicalize(path).ok().or_else(|| {
        let folder = fs::canonicalize(folder_of(path)).ok()?;
        Some(folder.join(path.file_name()?))
    })
}

/// Creates a folder that only its owner can access. An existing folder must be private to this user.
pub fn create_private_folder(path: &Path) -> Result<(), FileError> {
    match system::create_folder(path) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error.into()),
        _ => {}
    }
    check_private_folder(path)
}

/// Checks that a path is a folder that only this user can access.
pub fn check_private_folder(path: &Path) -> Result<(), FileError> {
    if system::is_private_folder(&fs::symlink_metadata(path)?) {
        Ok(())
    } else {
        Err(FileError::OpenFolder(path.into()))
    }
}

/// Returns the file that an edited file is written to: the target of symbolic links, which must be a regular file of this
/// user.
///
/// Managers of personal files link them from another folder; such a link is kept and its target is replaced.
pub fn own_target(path: &Path) -> Result<PathBuf, FileError> {
    let target = fs::canonicalize(path)?;
    let metadata = fs::metadata(&target)?;
    check_regular(metadata.file_type())?;
    system::check_owner(&metadata)?;
    Ok(target)
}

fn check_own(metadata: &Metadata) -> Result<(), FileError> {
    check_no_link(metadata)?;
    check_regular(metadata.file_type())?;
    system::check_owner(metadata)?;
    system::check_names(metadata)
}

fn check_no_link(metadata: &Metadata) -> Result<(), FileError> {
    if metadata.is_symlink() {
        Err(FileError::IsLink)
    } else {
        Ok(())
    }
}

fn check_regular(kind: FileType) -> Result<(), FileError> {
    if kind.is_file() {
        return Ok(());
    }
    Err(if kind.is_dir() {
        FileError::IsDirectory
    } else {
        FileError::NotRegular(system::name_of(kind))
    })
}

#[cfg(all(test, target_os = "linux"))]
mod tests;
