//! Whole files that are written at once.

use std::fs::{self, File, Metadata};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::{
    FileError, check_absent, check_regular, create_new, create_private, folder_of, open_regular,
    own_target, system,
};

/// Creates a file of a new name.
type CreateFile = fn(&Path) -> Result<File, FileError>;

/// Most temporary files that killed processes of one number may leave beside a file.
const MAX_TEMPORARY_FILES: u32 = 1000;

/// Replaces the content of a file of this user atomically: a reader sees the old or the new text, also after a crash or on a
/// full disk. The group, permissions, extended attributes and symbolic links are kept.
pub fn replace_text(path: &Path, text: &str) -> Result<(), FileError> {
    replace_text_if(path, text, || true)
}

/// Replaces the content of a file as [`replace_text`] does, if `is_as_expected` returns `true` when the new text is on the disk.
/// Otherwise it fails with [`FileError::Changed`].
pub fn replace_text_if(
    path: &Path,
    text: &str,
    is_as_expected: impl FnOnce() -> bool,
) -> Result<(), FileError> {
    let (path, metadata) = writable_target(path)?;
    write_and_rename(
        (&path, create_private),
        text.as_bytes(),
        Some(&metadata),
        is_as_expected,
    )
}

/// Writes a file that only its owner can access, atomically as [`replace_text`]. A file or a symbolic link of that name is replaced; a
/// device, a pipe or a folder is refused.
pub fn replace_private_text(path: &Path, text: &str) -> Result<(), FileError> {
    replace_private_text_if(path, text, || true)
}

/// Writes a file as [`replace_private_text`] does, if `is_as_expected` returns `true` when the new text is on the disk. Otherwise it fails
/// with [`FileError::Changed`].
pub fn replace_private_text_if(
    path: &Path,
    text: &str,
    is_as_expected: impl FnOnce() -> bool,
) -> Result<(), FileError> {
    check_replaceable(path)?;
    write_and_rename(
        (path, create_private),
        text.as_bytes(),
        None,
        is_as_expected,
    )
}

/// Writes a file with the usual permissions, atomically as [`replace_text`]. A file of that name is replaced; a symbolic link, a device, a
/// pipe or a folder is refused. Another name of the file keeps its content.
pub fn replace(path: &Path, content: &[u8]) -> Result<(), FileError> {
    match check_absent(path) {
        Ok(()) | Err(FileError::Exists) => {}
        Err(error) => return Err(error),
    }
    write_and_rename((path, create_new), content, None, || true)
}

/// Writes a file with the usual permissions, as [`replace_private_text`] does.
pub fn replace_public_text(path: &Path, text: &str) -> Result<(), FileError> {
    check_replaceable(path)?;
    write_and_rename((path, create_new), text.as_bytes(), None, || true)
}

/// Writes a file of a new name with the usual permissions. Leaves none if the disk is full.
pub fn write_new(path: &Path, content: &[u8]) -> Result<(), FileError> {
    write_created(path, create_new(path)?, content)
}

/// Writes a file of a new name that only its owner can access. Leaves none if the disk is full.
pub fn write_new_private(path: &Path, content: &[u8]) -> Result<(), FileError> {
    write_created(path, create_private(path)?, content)
}

/// Writes a file that was just created, or removes it.
fn write_created(path: &Path, mut file: File, content: &[u8]) -> Result<(), FileError> {
    let written = file.write_all(content).and_then(|()| file.sync_all());
    if written.is_err() {
        let _ = fs::remove_file(path);
    }
    Ok(written?)
}

/// Writes a file with the usual permissions in place of a file or a symbolic link, which gets the name `backup`. The target of a link
/// stays. A reader finds a file at any time. If the new file cannot be written, the old one and an earlier backup are as they were.
pub fn replace_text_and_keep(path: &Path, backup: &Path, text: &str) -> Result<(), FileError> {
    check_replaceable(path)?;
    let (mut file, temporary) = create_temporary(path, create_new)?;
    let replaced = file
        .write_all(text.as_bytes())
        .and_then(|()| file.sync_all())
        .map_err(FileError::from)
        .and_then(|()| rename_and_keep(&temporary, path, backup));
    if replaced.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    replaced
}

/// Renames a file to `path`, and what was there to `backup`. Both stay as they were if that fails.
fn rename_and_keep(new: &Path, path: &Path, backup: &Path) -> Result<(), FileError> {
    let ((), kept) = create_temporary(path, |name| link_or_copy(path, name))?;
    if let Err(error) = fs::rename(new, path) {
        let _ = fs::remove_file(&kept);
        return Err(error.into());
    }
    if let Err(error) = fs::rename(&kept, backup) {
        let _ = fs::rename(&kept, path);
        return Err(error.into());
    }
    // It is still there if the backup was another name of the old file.
    let _ = fs::remove_file(&kept);
    Ok(())
}

/// Checks that [`replace_text`] can replace a file, before work whose result it keeps.
pub fn check_overwrite(path: &Path) -> Result<(), FileError> {
    let (path, _) = writable_target(path)?;
    check_destination(&path)
}

/// Returns the file of this user that a path leads to, unless it is read-only.
fn writable_target(path: &Path) -> Result<(PathBuf, Metadata), FileError> {
    let path = own_target(path)?;
    let metadata = fs::metadata(&path)?;
    if metadata.permissions().readonly() {
        let error = io::Error::new(io::ErrorKind::PermissionDenied, "it is read-only");
        return Err(error.into());
    }
    Ok((path, metadata))
}

/// Checks that a file can be written at a path, before work whose result it keeps: its folder exists and is writable, and the
/// path leads to nothing but a file or a symbolic link.
pub fn check_destination(path: &Path) -> Result<(), FileError> {
    check_replaceable(path)?;
    Ok(system::check_folder_access(folder_of(path))?)
}

/// Fails for what a rename would replace although it is not a file: a device such as `/dev/full`, a pipe.
fn check_replaceable(path: &Path) -> Result<(), FileError> {
    match fs::symlink_metadata(path) {
        Ok(metadata) if !metadata.is_symlink() => check_regular(metadata.file_type()),
        // An error is reported by the write.
        _ => Ok(()),
    }
}

/// Writes a file beside `path` with a function that creates it, and gives it that name, and the attributes of the file with this
/// metadata, unless `is_as_expected` returns `false` then.
fn write_and_rename(
    (path, create): (&Path, CreateFile),
    content: &[u8],
    replaced: Option<&Metadata>,
    is_as_expected: impl FnOnce() -> bool,
) -> Result<(), FileError> {
    let (mut file, temporary) = create_temporary(path, create)?;
    let kept = replaced.map_or(Ok(()), |replaced| {
        system::copy_attributes(path, replaced, &file)
    });
    let written = kept
        .and_then(|()| file.write_all(content))
        .and_then(|()| file.sync_all())
        .map_err(FileError::from)
        .and_then(|()| {
            if is_as_expected() {
                Ok(fs::rename(&temporary, path)?)
            } else {
                Err(FileError::Changed)
            }
        });
    if written.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    written
}

/// Gives a file or a symbolic link a second name, or copies it if that is not possible, as on FAT.
fn link_or_copy(path: &Path, name: &Path) -> Result<(), FileError> {
    match fs::hard_link(path, name) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(FileError::Exists),
        Err(_) => copy(path, name),
    }
}

/// Copies a symbolic link, which may lead nowhere, or the text and the permissions of a file to a new one.
fn copy(path: &Path, name: &Path) -> Result<(), FileError> {
    if fs::symlink_metadata(path)?.is_symlink() {
        check_absent(name)?;
        return Ok(system::copy_link(path, name)?);
    }
    let mut original = open_regular(path)?;
    // It has the permissions of the file only after its text.
    let mut new = create_private(name)?;
    let copied = io::copy(&mut original, &mut new)
        .and_then(|_| original.metadata())
        .and_then(|metadata| new.set_permissions(metadata.permissions()))
        .and_then(|()| new.sync_all());
    if copied.is_err() {
        let _ = fs::remove_file(name);
    }
    Ok(copied?)
}

/// Creates a file of a new name in the folder of another one. A process of the same number may have been killed before it
/// removed its own, as in a container, where each run has the same number.
fn create_temporary<T>(
    path: &Path,
    create: impl Fn(&Path) -> Result<T, FileError>,
) -> Result<(T, PathBuf), FileError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let process = std::process::id();
    for attempt in 0..MAX_TEMPORARY_FILES {
        let temporary = path.with_file_name(format!(".{name}.{process}.{attempt}"));
        match create(&temporary) {
            Err(FileError::Exists | FileError::IsLink) => {}
            created => return Ok((created?, temporary)),
        }
    }
    let text = format!("{MAX_TEMPORARY_FILES} files `.{name}.{process}.…` are left; remove them");
    Err(io::Error::new(io::ErrorKind::AlreadyExists, text).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_has_one_name_only_is_copied() {
        let folder = tempfile::tempdir().unwrap();
        let [path, name] = ["glove.ron", "copy"].map(|it| folder.path().join(it));
        fs::write(&path, "old").unwrap();
        copy(&path, &name).unwrap();
        assert_eq!(fs::read_to_string(&name).unwrap(), "old");
        fs::write(&name, "mine").unwrap();
        let refused = copy(&path, &name);
        assert!(matches!(refused, Err(FileError::Exists)), "{refused:?}");
        assert_eq!(fs::read_to_string(&name).unwrap(), "mine");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_that_has_one_name_only_is_copied_as_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let [link, name] = ["glove.ron", "copy"].map(|it| folder.path().join(it));
        std::os::unix::fs::symlink("absent", &link).unwrap();
        copy(&link, &name).unwrap();
        assert_eq!(fs::read_link(&name).unwrap(), Path::new("absent"));
        let refused = copy(&link, &name);
        assert!(matches!(refused, Err(FileError::IsLink)), "{refused:?}");
    }
}
