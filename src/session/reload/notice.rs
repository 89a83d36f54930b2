//! Says when a file may have been changed, so that nobody has to look at it all the time.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::{self, PipeReader, PipeWriter, pipe};
use std::mem::MaybeUninit;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt;
use std::path::{Component, Path, PathBuf, absolute};
use std::thread;

use crossbeam_channel::{Receiver, Sender, bounded};
use rustix::event::{PollFd, PollFlags, poll};
use rustix::fs::inotify::{self, CreateFlags, Reader, WatchFlags};
use rustix::fs::statfs;
use rustix::io::Errno;

/// What happens in a folder when one of its files is saved, comes, goes or gets another name.
const IN_FOLDER: WatchFlags = WatchFlags::ATTRIB
    .union(WatchFlags::CLOSE_WRITE)
    .union(WatchFlags::CREATE)
    .union(WatchFlags::DELETE)
    .union(WatchFlags::MODIFY)
    .union(WatchFlags::MOVED_FROM)
    .union(WatchFlags::MOVED_TO);

/// What happens when a file or folder itself goes or gets another name.
const OF_ITSELF: WatchFlags = WatchFlags::DELETE_SELF.union(WatchFlags::MOVE_SELF);

/// The same file may be written under another name of it.
const OF_FILE: WatchFlags = WatchFlags::ATTRIB
    .union(WatchFlags::CLOSE_WRITE)
    .union(WatchFlags::MODIFY)
    .union(OF_ITSELF);

/// The kernel follows no more links than these on the way to a file (path_resolution(7)).
const MOST_LINKS: usize = 40;

/// File systems that others change without telling this kernel, as in `linux/magic.h`: 9p, AFS, CephFS, CIFS, FUSE, NFS, SMB,
/// SMB 2 and VirtualBox.
const REMOTE: [u32; 9] = [
    0x0102_1997,
    0x5346_414f,
    0x00c3_6400,
    0xff53_4d42,
    0x6573_5546,
    0x0000_6969,
    0x0000_517b,
    0xfe53_4d42,
    0x786f_4256,
];

/// Room for some of the events that the kernel has; the longest takes 16 bytes and a name of 256.
const EVENT_BYTES: usize = 1024;

/// Waits for a change of one file on a thread of its own, until this is dropped.
pub(super) struct FileWatcher {
    path: PathBuf,
    watches: Sender<Watch>,
    noticed: Receiver<()>,
    _end: PipeWriter,
}

impl FileWatcher {
    /// Of the file at `path`.
    pub fn start(path: &str) -> io::Result<Self> {
        let path = absolute(path)?;
        let (watches, to_wait) = bounded::<Watch>(1);
        let (notice, noticed) = bounded(1);
        let (end, kept) = pipe()?;
        let wait = move || {
            for watch in to_wait {
                if watch.wait(&end).is_err() || notice.send(()).is_err() {
                    return;
                }
            }
        };
        thread::Builder::new()
            .name("layout notice".into())
            .spawn(wait)?;
        Ok(Self {
            path,
            watches,
            noticed,
            _end: kept,
        })
    }

    /// From now on the first change is noticed, once. To be asked for again after each notice, and not before.
    pub fn arm(&self) -> io::Result<()> {
        let watch = match Watch::on(&self.path) {
            // A folder has gone while it was looked into.
            Err(error) if error.kind() == io::ErrorKind::NotFound => Watch::on(&self.path)?,
            watch => watch?,
        };
        self.watches
            .send(watch)
            .map_err(|_| io::Error::other("the thread that waits for changes has ended"))
    }

    /// Where it is noticed; closed when no more can be.
    pub fn noticed(&self) -> &Receiver<()> {
        &self.noticed
    }
}

/// All that has to be watched for one file: it, its folder, the folders of the links that lead to it, and
/// whether any folder on the way is moved.
struct Watch {
    inotify: OwnedFd,
    /// By number: in a folder, the entries that matter.
    entries: BTreeMap<i32, Vec<OsString>>,
}

impl Watch {
    /// Of an absolute path. What is not there yet is waited for in the folder that is.
    fn on(path: &Path) -> io::Result<Self> {
        let mut watch = Self {
            inotify: inotify::init(CreateFlags::CLOEXEC | CreateFlags::NONBLOCK)?,
            entries: BTreeMap::new(),
        };
        watch.follow(path)?;
        Ok(watch)
    }

    /// Goes the way of the kernel. Each folder is watched before it is looked into, so that nothing is missed.
    fn follow(&mut self, path: &Path) -> io::Result<()> {
        let mut folder = PathBuf::from("/");
        let mut rest = parts(path);
        let mut links = 0;
        while let Some(part) = rest.pop() {
            if part == ".." {
                folder.pop();
                continue;
            }
            let entry = folder.join(&part);
            let is_last = rest.is_empty();
            let is_watched = is_last || is_link(&entry);
            if is_watched {
                self.add_entry(&folder, part.clone())?;
            } else {
                self.add_on_the_way(&folder)?;
            }
            match fs::read_link(&entry) {
                Ok(_) if links == MOST_LINKS => return Ok(()),
                // It has become a link just now.
                Ok(_) if !is_watched => rest.push(part),
                Ok(target) => {
                    links += 1;
                    if target.is_absolute() {
                        folder = PathBuf::from("/");
                    }
                    rest.extend(parts(&target));
                }
                // Nothing, or no link.
                Err(_) if is_last => return self.add_file(&entry),
                Err(_) if entry.is_dir() => folder = entry,
                Err(_) => return self.add_entry(&folder, part),
            }
        }
        Ok(())
    }

    /// That a folder is moved which he may not read, hence not watch, is not up to the user of this program.
    fn add_on_the_way(&self, folder: &Path) -> io::Result<()> {
        match self.add(folder, OF_ITSELF) {
            Err(error) if error.kind() != io::ErrorKind::PermissionDenied => Err(error),
            _ => Ok(()),
        }
    }

    fn add_entry(&mut self, folder: &Path, name: OsString) -> io::Result<()> {
        let number = self.add(folder, IN_FOLDER | OF_ITSELF)?;
        self.entries.entry(number).or_default().push(name);
        Ok(())
    }

    fn add(&self, folder: &Path, what: WatchFlags) -> io::Result<i32> {
        let kind = statfs(folder)?.f_type as u32;
        if REMOTE.contains(&kind) {
            let text = "the file system may be changed from elsewhere without a notice";
            return Err(io::Error::other(text));
        }
        let flags = what | WatchFlags::MASK_ADD | WatchFlags::ONLYDIR;
        Ok(inotify::add_watch(&self.inotify, folder, flags)?)
    }

    fn add_file(&self, path: &Path) -> io::Result<()> {
        match inotify::add_watch(&self.inotify, path, OF_FILE | WatchFlags::MASK_ADD) {
            // It comes, and that is seen in its folder; nobody may watch what he may not read.
            Ok(_) | Err(Errno::NOENT | Errno::ACCESS) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Waits for something that matters. An error is the end: the other side of `end` was dropped.
    fn wait(&self, end: &PipeReader) -> io::Result<()> {
        loop {
            let mut files = [
                PollFd::new(&self.inotify, PollFlags::IN),
                PollFd::new(end, PollFlags::IN),
            ];
            match poll(&mut files, None) {
                Ok(_) | Err(Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
            if !files[1].revents().is_empty() {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            if self.has_news() {
                return Ok(());
            }
        }
    }

    /// Takes all that has happened; whether any of it matters.
    fn has_news(&self) -> bool {
        let mut buffer = [MaybeUninit::uninit(); EVENT_BYTES];
        let mut events = Reader::new(&self.inotify, &mut buffer);
        let mut has_news = false;
        loop {
            match events.next() {
                Ok(event) => {
                    let name = event
                        .file_name()
                        .map(|name| OsStr::from_bytes(name.to_bytes()));
                    has_news |= self.matters(event.wd(), name);
                }
                Err(Errno::AGAIN) => return has_news,
                // A look too many does no harm.
                Err(_) => return true,
            }
        }
    }

    fn matters(&self, number: i32, name: Option<&OsStr>) -> bool {
        match (self.entries.get(&number), name) {
            (Some(entries), Some(name)) => entries.iter().any(|entry| entry == name),
            // Of the file, or of a folder itself.
            _ => true,
        }
    }
}

/// The parts of a path, the first one last.
fn parts(path: &Path) -> Vec<OsString> {
    let part = |part: Component| match part {
        Component::Normal(name) => Some(name.to_owned()),
        Component::ParentDir => Some("..".into()),
        _ => None,
    };
    path.components().rev().filter_map(part).collect()
}

fn is_link(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_symlink())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{create_dir, remove_file, rename, write};
    use std::os::unix::fs::symlink;
    use std::time::Duration;
    use tempfile::TempDir;

    /// How long anything on a busy machine may take.
    const LIMIT: Duration = Duration::from_secs(20);

    /// How long it takes to believe that nothing is noticed.
    const SILENCE: Duration = Duration::from_millis(200);

    type Step = (&'static str, fn(&Path));

    /// `a.ron` is a file, `link.ron` leads to `far/b.ron`, `set.ron` to `..data/c.ron`, and `..data` to `one`.
    fn folder() -> TempDir {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["far", "one", "two"] {
            create_dir(at(name)).unwrap();
        }
        for name in ["a.ron", "far/b.ron", "one/c.ron", "two/c.ron"] {
            write(at(name), name).unwrap();
        }
        symlink("far/b.ron", at("link.ron")).unwrap();
        symlink("..data/c.ron", at("set.ron")).unwrap();
        symlink("one", at("..data")).unwrap();
        folder
    }

    /// Asks for a notice, takes the step, and tells whether it was noticed within `limit`.
    fn is_noticed(name: &str, step: fn(&Path), limit: Duration) -> bool {
        let folder = folder();
        let path = folder.path().join(name);
        let notices = FileWatcher::start(path.to_str().unwrap()).unwrap();
        notices.arm().unwrap();
        step(folder.path());
        notices.noticed().recv_timeout(limit).is_ok()
    }

    #[test]
    fn a_file_that_changes_in_any_way_is_noticed() {
        let steps: [Step; 11] = [
            ("a.ron", |at| write(at.join("a.ron"), "new").unwrap()),
            ("a.ron", |at| remove_file(at.join("a.ron")).unwrap()),
            ("a.ron", |at| {
                rename(at.join("a.ron"), at.join("b")).unwrap()
            }),
            ("a.ron", |at| {
                rename(at.join("far/b.ron"), at.join("a.ron")).unwrap()
            }),
            ("none.ron", |at| write(at.join("none.ron"), "new").unwrap()),
            ("no/none.ron", |at| create_dir(at.join("no")).unwrap()),
            ("link.ron", |at| write(at.join("far/b.ron"), "new").unwrap()),
            ("link.ron", |at| {
                rename(at.join("a.ron"), at.join("far/b.ron")).unwrap()
            }),
            ("link.ron", |at| remove_file(at.join("link.ron")).unwrap()),
            ("set.ron", |at| {
                symlink("two", at.join("..new")).unwrap();
                rename(at.join("..new"), at.join("..data")).unwrap();
            }),
            ("far/b.ron", |at| {
                rename(at.join("far"), at.join("away")).unwrap()
            }),
        ];
        for (number, (name, step)) in steps.into_iter().enumerate() {
            assert!(is_noticed(name, step, LIMIT), "{number}: {name}");
        }
    }

    #[test]
    fn a_file_that_is_written_under_another_of_its_names_is_noticed() {
        let folder = folder();
        let (name, other_name) = (folder.path().join("a.ron"), folder.path().join("far/a"));
        fs::hard_link(&name, &other_name).unwrap();
        let notices = FileWatcher::start(name.to_str().unwrap()).unwrap();
        notices.arm().unwrap();
        write(other_name, "new").unwrap();
        assert!(notices.noticed().recv_timeout(LIMIT).is_ok());
    }

    #[test]
    fn what_happens_to_other_files_is_not_noticed() {
        let steps: [Step; 3] = [
            ("a.ron", |at| write(at.join("a.ron.swp"), "new").unwrap()),
            ("set.ron", |at| write(at.join("two/c.ron"), "new").unwrap()),
            ("far/b.ron", |at| write(at.join("a.ron"), "new").unwrap()),
        ];
        for (name, step) in steps {
            assert!(!is_noticed(name, step, SILENCE), "{name}");
        }
    }

    #[test]
    fn a_change_is_noticed_once_for_each_time_that_it_is_asked_for() {
        let folder = folder();
        let path = folder.path().join("a.ron");
        let notices = FileWatcher::start(path.to_str().unwrap()).unwrap();
        for round in 0..3 {
            write(&path, format!("not asked for {round}")).unwrap();
            assert!(notices.noticed().recv_timeout(SILENCE).is_err(), "{round}");
            notices.arm().unwrap();
            write(&path, format!("asked for {round}")).unwrap();
            assert!(notices.noticed().recv_timeout(LIMIT).is_ok(), "{round}");
        }
    }

    #[test]
    fn a_link_that_leads_to_itself_is_no_endless_way() {
        let folder = folder();
        symlink("turn.ron", folder.path().join("turn.ron")).unwrap();
        assert!(Watch::on(&folder.path().join("turn.ron")).is_ok());
    }
}
