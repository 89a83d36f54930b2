//! The stand-in on systems without owners and modes of files: the folder determines who may access a file.

use std::fs::{self, File, FileType, Metadata, OpenOptions};
use std::io;
use std::path::Path;

use super::FileError;

pub fn open_without_waiting(path: &Path) -> io::Result<File> {
    File::open(path)
}

pub fn create_private(path: &Path) -> io::Result<File> {
    File::create_new(path)
}

pub fn open_private(path: &Path) -> io::Result<File> {
    OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)
}

pub fn append_private(path: &Path) -> io::Result<File> {
    OpenOptions::new().append(true).create(true).open(path)
}

pub fn wait_from_now_on(_: &File) -> io::Result<()> {
    Ok(())
}

pub fn make_private(_: &File) -> io::Result<()> {
    Ok(())
}

pub fn copy_attributes(_: &Path, replaced: &Metadata, new: &File) -> io::Result<()> {
    new.set_permissions(replaced.permissions())
}

pub fn check_owner(_: &Metadata) -> Result<(), FileError> {
    Ok(())
}

pub fn check_writers(_: &Path, _: &Metadata) -> Result<(), FileError> {
    Ok(())
}

pub fn check_way(path: &Path) -> Result<Metadata, FileError> {
    Ok(fs::metadata(path)?)
}

pub fn is_same_file(_: &Metadata, _: &Metadata) -> bool {
    true
}

pub fn check_names(_: &Metadata) -> Result<(), FileError> {
    Ok(())
}

pub fn name_of(_: FileType) -> &'static str {
    "a device"
}

pub fn copy_link(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

pub fn create_folder(path: &Path) -> io::Result<()> {
    fs::create_dir(path)
}

pub fn check_folder_access(folder: &Path) -> io::Result<()> {
    if fs::metadata(folder)?.is_dir() {
        Ok(())
    } else {
        Err(io::ErrorKind::NotADirectory.into())
    }
}

pub fn is_private_folder(metadata: &Metadata) -> bool {
    metadata.is_dir()
}

pub fn is_private_file(_: &Metadata) -> bool {
    true
}

pub fn free_bytes(_: &Path) -> Option<u64> {
    None
}
