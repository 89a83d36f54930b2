//! Files of Unix.

use std::fs::{self, DirBuilder, File, FileType, Metadata, OpenOptions, Permissions};
use std::io;
use std::os::unix::fs::{
    DirBuilderExt, FileTypeExt, MetadataExt, OpenOptionsExt, PermissionsExt, symlink,
};
use std::path::Path;

use rustix::fs::{
    Access, Gid, OFlags, XattrFlags, access, fchown, fcntl_getfl, fcntl_setfl, fsetxattr, getxattr,
    listxattr,
};
use rustix::io::Errno;
use rustix::process::{getegid, geteuid};

use super::{FileError, MAX_LINKS, folder_of};

const OWNER_ONLY: u32 = 0o600;

/// Permissions to write of the group and of all others, and the sticky bit.
const GROUP_WRITES: u32 = 0o020;
const OTHERS_WRITE: u32 = 0o002;
const STICKY: u32 = 0o1000;

/// The longest list of names of extended attributes, and the longest value of one, in bytes (`XATTR_LIST_MAX` and
/// `XATTR_SIZE_MAX` in linux/limits.h).
const MAX_ATTRIBUTE_BYTES: usize = 1 << 16;

/// The extended attribute with the access control list of a file.
const ACCESS_LIST: &[u8] = b"system.posix_acl_access";

/// Opens a file for reading. A pipe that took its place does not block, and a terminal does not become the controlling
/// one.
pub fn open_without_waiting(path: &Path) -> io::Result<File> {
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
    OpenOptions::new()
        .read(true)
        .custom_flags(flags.bits() as i32)
        .open(path)
}

/// Creates a file that must not exist.
pub fn create_private(path: &Path) -> io::Result<File> {
    OpenOptions::new()
        .write(true)
        .create_new(true)
        .mode(OWNER_ONLY)
        .open(path)
}

/// Opens a file for writing as it is, or creates it. Neither follows a link nor waits, whatever took its place.
pub fn open_private(path: &Path) -> io::Result<File> {
    private_options().write(true).truncate(false).open(path)
}

/// Opens a file as [`open_private`] does. Each write is added at its end.
pub fn append_private(path: &Path) -> io::Result<File> {
    private_options().append(true).open(path)
}

fn private_options() -> OpenOptions {
    let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::NOCTTY;
    let mut options = OpenOptions::new();
    options
        .create(true)
        .mode(OWNER_ONLY)
        .custom_flags(flags.bits() as i32);
    options
}

/// Undoes the flag with which a file was opened, for file systems on which it has an effect on regular files.
pub fn wait_from_now_on(file: &File) -> io::Result<()> {
    let flags = fcntl_getfl(file)?;
    Ok(fcntl_setfl(file, flags - OFlags::NONBLOCK)?)
}

/// Sets the mode of an open file, which the mode at its creation does not do for one that existed.
pub fn make_private(file: &File) -> io::Result<()> {
    file.set_permissions(Permissions::from_mode(OWNER_ONLY))
}

/// Gives a new file the group, the mode and the extended attributes of the file at `path`, which it is going to replace. An
/// access control list is one of them.
pub fn copy_attributes(path: &Path, replaced: &Metadata, new: &File) -> io::Result<()> {
    let mut mode = replaced.mode() & 0o777;
    let group = Some(Gid::from_raw(replaced.gid()));
    let keeps_group = new.metadata()?.gid() == replaced.gid() || fchown(new, None, group).is_ok();
    if !keeps_group {
        // The user is no member of that group; another one gets no more than everybody.
        mode = mode & 0o707 | (mode & 0o007) << 3;
    }
    new.set_permissions(Permissions::from_mode(mode))?;
    let mut names = vec![0; MAX_ATTRIBUTE_BYTES];
    let length = match listxattr(path, &mut names[..]) {
        Err(Errno::NOTSUP) => 0,
        length => length?,
    };
    let names = names[..length].split(|byte| *byte == 0);
    let is_kept = |name: &&[u8]| !name.is_empty() && (keeps_group || *name != ACCESS_LIST);
    for name in names.filter(is_kept) {
        let copied = copy_attribute(path, name, new);
        // The system sets the attributes of its security modules, and permits few users to change them.
        if !name.starts_with(b"security.") {
            copied?;
        }
    }
    Ok(())
}

fn copy_attribute(path: &Path, name: &[u8], new: &File) -> io::Result<()> {
    let mut value = vec![0; MAX_ATTRIBUTE_BYTES];
    let length = getxattr(path, name, &mut value[..])?;
    Ok(fsetxattr(new, name, &value[..length], XattrFlags::empty())?)
}

/// Checks that a file belongs to the user of this process.
pub fn check_owner(metadata: &Metadata) -> Result<(), FileError> {
    if metadata.uid() == geteuid().as_raw() {
        Ok(())
    } else {
        Err(FileError::OtherOwner)
    }
}

/// Checks that only the user of this process and root decide on the content of the file at `path`.
pub fn check_writers(path: &Path, metadata: &Metadata) -> Result<(), FileError> {
    check_trusted_owner(metadata)?;
    if is_writable_by_others(metadata) {
        Err(FileError::OthersMayWrite(path.into()))
    } else {
        Ok(())
    }
}

/// Follows the links at a path to a file, and checks that no other user can replace one of them or the file. Returns what describes
/// the file.
pub fn check_way(path: &Path) -> Result<Metadata, FileError> {
    let mut place = path.to_path_buf();
    for _ in 0..=MAX_LINKS {
        let metadata = fs::symlink_metadata(&place)?;
        check_folder_writers(folder_of(&place))?;
        if !metadata.is_symlink() {
            return Ok(metadata);
        }
        // Its owner can replace it, also in a folder with the sticky bit.
        check_trusted_owner(&metadata)?;
        // A link is relative to its folder.
        place = folder_of(&place).join(fs::read_link(&place)?);
    }
    Err(FileError::TooManyLinks)
}

/// Checks that only the user of this process and root can replace their files in a folder.
fn check_folder_writers(folder: &Path) -> Result<(), FileError> {
    let metadata = fs::metadata(folder)?;
    if is_writable_by_others(&metadata) && metadata.mode() & STICKY == 0 {
        Err(FileError::OthersMayReplace(folder.into()))
    } else {
        Ok(())
    }
}

/// Checks that a file belongs to the user of this process or to root.
fn check_trusted_owner(metadata: &Metadata) -> Result<(), FileError> {
    if metadata.uid() == 0 {
        Ok(())
    } else {
        check_owner(metadata)
    }
}

/// Returns `true` if both describe the same file.
pub fn is_same_file(one: &Metadata, other: &Metadata) -> bool {
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// Returns `true` if others than the owner may write. The group with the number of the user is the user's own: many systems
/// create one for each user, and make new files writable by it.
fn is_writable_by_others(metadata: &Metadata) -> bool {
    let (user, group) = (geteuid().as_raw(), getegid().as_raw());
    let is_own_group = user == group && metadata.gid() == group;
    let mode = metadata.mode();
    mode & OTHERS_WRITE != 0 || mode & GROUP_WRITES != 0 && !is_own_group
}

/// Checks that a file has one name.
pub fn check_names(metadata: &Metadata) -> Result<(), FileError> {
    match metadata.nlink() {
        0 | 1 => Ok(()),
        count => Err(FileError::HardLinks(count)),
    }
}

/// Returns the name of a kind of file that is neither a regular file nor a directory.
pub fn name_of(kind: FileType) -> &'static str {
    match kind {
        kind if kind.is_fifo() => "a pipe",
        kind if kind.is_socket() => "a socket",
        _ => "a device",
    }
}

/// Creates a symbolic link beside another one that leads to the same place. Fails if there is anything of that name.
pub fn copy_link(link: &Path, name: &Path) -> io::Result<()> {
    symlink(fs::read_link(link)?, name)
}

/// Creates a folder.
pub fn create_folder(path: &Path) -> io::Result<()> {
    DirBuilder::new().mode(0o700).create(path)
}

/// Checks that this process may create files in a folder.
pub fn check_folder_access(folder: &Path) -> io::Result<()> {
    if !fs::metadata(folder)?.is_dir() {
        return Err(io::ErrorKind::NotADirectory.into());
    }
    Ok(access(folder, Access::WRITE_OK | Access::EXEC_OK)?)
}

/// Returns `true` if this is a folder that only the user of this process can access.
pub fn is_private_folder(metadata: &Metadata) -> bool {
    metadata.is_dir() && check_owner(metadata).is_ok() && metadata.mode() & 0o077 == 0
}

/// Returns `true` if only its owner can access a file.
pub fn is_private_file(metadata: &Metadata) -> bool {
    metadata.mode() & 0o077 == 0
}

/// Returns the bytes that the user may still write on the disk of a folder.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail.saturating_mul(disk.f_frsize))
}
