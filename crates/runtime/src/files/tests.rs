use super::*;
use std::fs::Permissions;
use std::io::Write;
use std::os::unix::fs::{PermissionsExt, chown, lchown, symlink};
use std::os::unix::net::UnixListener;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use rustix::fs::{CWD, Mode, XattrFlags, getxattr, setxattr};

/// The id of another user.
const NOBODY: u32 = 65_534;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Creates a file with this mode and returns its path.
    fn file(&self, name: &str, mode: u32) -> PathBuf {
        let path = self.at(name);
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, Permissions::from_mode(mode)).unwrap();
        path
    }

    fn pipe(&self, name: &str) -> PathBuf {
        let path = self.at(name);
        let mode = Mode::RUSR | Mode::WUSR;
        rustix::fs::mkfifoat(CWD, &path, mode).unwrap();
        path
    }
}

fn mode(path: &Path) -> u32 {
    fs::metadata(path).unwrap().permissions().mode() & 0o777
}

#[test]
fn only_regular_files_are_opened_and_none_makes_the_caller_wait() {
    let folder = Folder::new();
    let (pipe, socket) = (folder.pipe("pipe"), folder.at("socket"));
    let _listener = UnixListener::bind(&socket).unwrap();
    let table = [
        (pipe.as_path(), "a pipe"),
        (&socket, "a socket"),
        (Path::new("/dev/zero"), "a device"),
    ];
    for (path, kind) in table {
        let expected = format!("this is not a regular file but {kind}, name a file");
        for opened in [open_regular(path), open_private(path)] {
            assert_eq!(opened.unwrap_err().to_string(), expected);
        }
    }
    for opened in [open_regular(folder.0.path()), open_private(folder.0.path())] {
        assert!(matches!(opened, Err(FileError::IsDirectory)));
    }
    let absent = open_regular(&folder.at("absent")).unwrap_err();
    assert!(matches!(absent, FileError::Io(error) if error.kind() == io::ErrorKind::NotFound));
}

#[test]
fn a_regular_file_is_read_through_links() {
    let folder = Folder::new();
    let file = folder.file("file", 0o644);
    symlink(&file, folder.at("link")).unwrap();
    let text = io::read_to_string(open_regular(&folder.at("link")).unwrap()).unwrap();
    assert_eq!(text, "old");
}

#[test]
fn a_file_that_is_too_large_is_refused_also_if_the_limit_cuts_a_character() {
    let folder = Folder::new();
    let path = folder.at("large");
    let most = "/".repeat(1 << 20);
    fs::write(&path, &most).unwrap();
    assert_eq!(read_regular_text(&path, 1).unwrap(), most);
    fs::write(&path, most + "é").unwrap();
    let error = read_regular_text(&path, 1).unwrap_err();
    assert_eq!(error.to_string(), "it is larger than 1 MiB");
}

#[test]
fn an_existing_file_becomes_private_before_it_is_written() {
    let folder = Folder::new();
    let path = folder.file("wide", 0o666);
    open_private(&path).unwrap();
    assert_eq!(
        (mode(&path), fs::read(&path).unwrap()),
        (0o600, b"old".to_vec())
    );
    let new = folder.at("new");
    open_private(&new).unwrap();
    assert_eq!(mode(&new), 0o600);
    assert!(create_private(&new).is_err());
}

#[test]
fn programs_that_append_to_one_file_keep_the_lines_of_each_other() {
    let folder = Folder::new();
    let path = folder.file("log", 0o600);
    let mut one = append_private(&path).unwrap();
    let mut other = append_private(&path).unwrap();
    one.write_all(b" one").unwrap();
    other.write_all(b" other").unwrap();
    one.write_all(b" again").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "old one other again");
}

#[test]
fn links_and_files_of_other_users_are_not_written() {
    let folder = Folder::new();
    let file = folder.file("file", 0o644);
    let link = folder.at("link");
    symlink(&file, &link).unwrap();
    assert!(matches!(open_private(&link), Err(FileError::IsLink)));
    assert_eq!(own_target(&link).unwrap(), fs::canonicalize(&file).unwrap());

    fs::hard_link(&file, folder.at("name")).unwrap();
    assert!(matches!(open_private(&file), Err(FileError::HardLinks(2))));
    fs::remove_file(folder.at("name")).unwrap();

    if chown(&file, Some(NOBODY), None).is_err() {
        println!("SKIPPED: only root can give a file to another user");
        return;
    }
    assert!(matches!(open_private(&file), Err(FileError::OtherOwner)));
    assert!(matches!(own_target(&link), Err(FileError::OtherOwner)));
    assert_eq!(
        (mode(&file), fs::read(&file).unwrap()),
        (0o644, b"old".to_vec())
    );
}

#[test]
fn a_file_is_trusted_if_no_other_user_can_write_or_replace_it() {
    let folder = Folder::new();
    let path = folder.file("layout", 0o644);
    let set =
        |target: &Path, mode| fs::set_permissions(target, Permissions::from_mode(mode)).unwrap();
    for (mode, is_trusted) in [(0o644, true), (0o600, true), (0o646, false), (0o666, false)] {
        set(&path, mode);
        assert_eq!(open_trusted(&path).is_ok(), is_trusted, "{mode:o}");
    }
    set(&path, 0o644);
    for (mode, is_trusted) in [
        (0o755, true),
        (0o777, false),
        (0o707, false),
        (0o1777, true),
    ] {
        set(folder.0.path(), mode);
        assert_eq!(open_trusted(&path).is_ok(), is_trusted, "{mode:o}");
    }
    let inner = folder.at("shared");
    fs::create_dir(&inner).unwrap();
    fs::rename(&path, inner.join("layout")).unwrap();
    symlink("shared/layout", &path).unwrap();
    set(&inner, 0o777);
    assert!(matches!(
        open_trusted(&path),
        Err(FileError::OthersMayReplace(shared)) if shared == inner
    ));
}

#[test]
fn the_refusal_of_a_file_that_others_may_change_names_the_command_against_it() {
    let folder = Folder::new();
    let path = folder.file("my layout", 0o666);
    let refused = || open_trusted(&path).unwrap_err().to_string();
    let command = |target: &Path| format!("`chmod go-w '{}'` makes", target.display());
    assert!(refused().contains(&command(&path)), "{}", refused());
    let shared = folder.at("its folder");
    fs::create_dir(&shared).unwrap();
    fs::set_permissions(&shared, Permissions::from_mode(0o777)).unwrap();
    fs::rename(&path, shared.join("layout")).unwrap();
    symlink(shared.join("layout"), &path).unwrap();
    assert!(refused().contains(&command(&shared)), "{}", refused());
}

#[test]
fn no_link_on_the_way_to_a_trusted_file_can_be_replaced_by_others() {
    let folder = Folder::new();
    let shared = folder.at("shared");
    fs::create_dir(&shared).unwrap();
    let file = folder.file("layout", 0o644);
    symlink("../layout", shared.join("between")).unwrap();
    let first = folder.at("first");
    symlink("shared/between", &first).unwrap();
    for (mode, is_trusted) in [(0o755, true), (0o777, false), (0o1777, true)] {
        fs::set_permissions(&shared, Permissions::from_mode(mode)).unwrap();
        assert_eq!(open_trusted(&first).is_ok(), is_trusted, "{mode:o}");
    }
    fs::remove_file(&file).unwrap();
    symlink("first", &file).unwrap();
    assert!(matches!(open_trusted(&first), Err(FileError::TooManyLinks)));
}

#[test]
fn a_link_of_another_user_does_not_lead_to_a_trusted_file() {
    let folder = Folder::new();
    folder.file("layout", 0o644);
    // As in `/tmp`.
    let shared = folder.at("shared");
    fs::create_dir(&shared).unwrap();
    fs::set_permissions(&shared, Permissions::from_mode(0o1777)).unwrap();
    let link = shared.join("link");
    symlink("../layout", &link).unwrap();
    assert!(open_trusted(&link).is_ok());
    if lchown(&link, Some(NOBODY), None).is_err() {
        println!("SKIPPED: only root can give a link to another user");
        return;
    }
    assert!(matches!(open_trusted(&link), Err(FileError::OtherOwner)));
}

#[test]
fn a_file_that_takes_the_place_of_a_checked_one_is_not_opened() {
    let folder = Folder::new();
    let path = folder.file("layout", 0o644);
    let found = system::check_way(&path).unwrap();
    assert!(open_checked(&path, &found).unwrap().is_some());
    fs::rename(folder.file("other", 0o644), &path).unwrap();
    assert!(open_checked(&path, &found).unwrap().is_none());
    assert!(open_trusted(&path).is_ok(), "it is checked again");
}

#[test]
fn a_new_file_replaces_none_and_is_not_created_through_a_link() {
    let folder = Folder::new();
    let file = folder.file("file", 0o644);
    symlink(folder.at("absent"), folder.at("dangling")).unwrap();
    symlink(&file, folder.at("link")).unwrap();
    fs::hard_link(&file, folder.at("name")).unwrap();
    for create in [create_private, create_new] {
        assert!(matches!(create(&file), Err(FileError::Exists)));
        assert!(matches!(
            create(folder.0.path()),
            Err(FileError::IsDirectory)
        ));
        for link in ["dangling", "link"] {
            assert!(matches!(create(&folder.at(link)), Err(FileError::IsLink)));
        }
    }
    for link in ["dangling", "link"] {
        let refused = replace(&folder.at(link), b"new");
        assert!(matches!(refused, Err(FileError::IsLink)));
    }
    assert!(!folder.at("absent").exists());
    replace(&folder.at("name"), b"new").unwrap();
    assert_eq!(fs::read(&file).unwrap(), b"old");
    assert_eq!(fs::read(folder.at("name")).unwrap(), b"new");
}

/// An access control list in the form of its attribute: the owner may write, user 1234 and the group may read.
fn access_list() -> Vec<u8> {
    let entries: [(u16, u16, u32); 5] = [
        (0x01, 6, u32::MAX),
        (0x02, 4, 1234),
        (0x04, 4, u32::MAX),
        (0x10, 4, u32::MAX),
        (0x20, 0, u32::MAX),
    ];
    let mut list = 2_u32.to_le_bytes().to_vec();
    for (tag, permissions, id) in entries {
        list.extend(tag.to_le_bytes());
        list.extend(permissions.to_le_bytes());
        list.extend(id.to_le_bytes());
    }
    list
}

#[test]
fn a_device_or_a_pipe_is_not_replaced_by_a_file() {
    let folder = Folder::new();
    let pipe = folder.pipe("pipe");
    for replace in [replace_private_text, replace_public_text] {
        let refused = replace(&pipe, "new");
        assert!(
            matches!(refused, Err(FileError::NotRegular(_))),
            "{refused:?}"
        );
        let refused_folder = replace(folder.0.path(), "new");
        assert!(
            matches!(refused_folder, Err(FileError::IsDirectory)),
            "{refused_folder:?}"
        );
        let file = folder.file("file", 0o644);
        replace(&file, "new").unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
    }
    assert!(!fs::metadata(&pipe).unwrap().is_file());
    assert_eq!(mode(&folder.at("file")) & 0o077, 0o044);
}

#[test]
fn a_replaced_file_keeps_its_group_mode_attributes_and_access_list() {
    use std::os::unix::fs::MetadataExt;

    let folder = Folder::new();
    let path = folder.file("layout.ron", 0o640);
    const OTHER_GROUP: u32 = 65_534;
    if chown(&path, None, Some(OTHER_GROUP)).is_err() {
        println!("SKIPPED in part: only root can give a file to any group");
    }
    let list = access_list();
    let attributes: [(&str, &[u8]); 2] =
        [("user.origin", b"mine"), ("system.posix_acl_access", &list)];
    let is_set = |(name, value): &(&str, &[u8])| {
        let set = setxattr(&path, *name, value, XattrFlags::empty());
        if let Err(error) = set {
            println!("SKIPPED in part: no attribute {name} on this file system: {error}");
        }
        set.is_ok()
    };
    let attributes: Vec<_> = attributes.into_iter().filter(is_set).collect();
    let state = || {
        let metadata = fs::metadata(&path).unwrap();
        (metadata.uid(), metadata.gid(), metadata.mode())
    };
    let before = state();
    replace_text(&path, "new").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(state(), before);
    for (name, value) in attributes {
        let mut found = vec![0; 1000];
        let length = getxattr(&path, name, &mut found[..]).unwrap();
        assert_eq!(&found[..length], value, "{name}");
    }
    assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 1);
}

#[test]
fn a_file_that_changes_while_its_new_text_is_written_is_not_replaced() {
    let folder = Folder::new();
    let path = folder.file("layout.ron", 0o600);
    let names = || fs::read_dir(folder.0.path()).unwrap().count();
    let replaced = replace_text_if(&path, "new", || {
        assert_eq!(names(), 2, "the new text is on the disk");
        fs::write(&path, "edited").unwrap();
        false
    });
    assert!(matches!(replaced, Err(FileError::Changed)), "{replaced:?}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "edited");
    assert_eq!(names(), 1);
    replace_text_if(&path, "new", || true).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
}

#[test]
fn a_file_whose_old_text_is_kept_can_be_read_at_any_time() {
    let folder = Folder::new();
    let (path, backup) = (folder.file("glove.ron", 0o640), folder.at("glove.ron.bak"));
    let is_over = AtomicBool::new(false);
    let (replaced, missing) = thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let mut missing = 0;
            while !is_over.load(Ordering::Relaxed) {
                missing += u32::from(!path.exists());
            }
            missing
        });
        let write = |number: u32| replace_text_and_keep(&path, &backup, &number.to_string());
        let replaced: Result<Vec<()>, _> = (0..100).map(write).collect();
        is_over.store(true, Ordering::Relaxed);
        (replaced, reader.join().unwrap())
    });
    replaced.unwrap();
    assert_eq!(missing, 0);
    let texts = [&path, &backup].map(|it| fs::read_to_string(it).unwrap());
    assert_eq!(texts, ["99", "98"]);
    assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 2);
}

#[test]
fn a_file_that_cannot_be_kept_stays_and_a_link_is_kept_as_a_link() {
    let folder = Folder::new();
    let (path, link) = (folder.file("glove.ron", 0o640), folder.at("link"));
    fs::create_dir(folder.at("folder")).unwrap();
    assert!(replace_text_and_keep(&path, &folder.at("folder"), "new").is_err());
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    symlink(&path, &link).unwrap();
    replace_text_and_keep(&link, &folder.at("link.bak"), "new").unwrap();
    assert_eq!(fs::read_link(folder.at("link.bak")).unwrap(), path);
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(fs::read_to_string(&link).unwrap(), "new");
    assert!(fs::symlink_metadata(&link).unwrap().is_file());
    assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 4);
}
