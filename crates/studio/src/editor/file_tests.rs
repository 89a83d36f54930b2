//! Files of edited layouts: saving, changes by others, full disks, recovery.

use std::fs::{self, OpenOptions};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use ademan_runtime::files::LockedFile;
use tempfile::TempDir;

use super::tests::key;
use super::*;

const TEXT: &str = "// mine
Layout(
    name: \"a\",
    boards: [
        (
            pose: (anchor: elbow),
            keys: [
                (code: \"A\", at_mm: (0, 0)), // first
                (code: \"B\", at_mm: (40, 0)),
                (code: \"C\", at_mm: (80, 0)),
                (code: \"D\", at_mm: (120, 0)),
            ],
        ),
    ],
)
";

fn file() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ron");
    fs::write(&path, TEXT).unwrap();
    (folder, path)
}

fn open(path: &Path) -> LayoutEditor {
    LayoutEditor::open(path.to_str().unwrap(), Fit::default()).unwrap()
}

/// Writes a file as another program does, with a time of its own.
fn write_later(path: &Path, text: &str) {
    fs::write(path, text).unwrap();
    let file = OpenOptions::new().write(true).open(path).unwrap();
    let now = file.metadata().unwrap().modified().unwrap();
    file.set_modified(now + Duration::from_secs(2)).unwrap();
}

fn move_key(editor: &mut LayoutEditor, index: usize, y: f64) {
    let parts = vec![key(index)];
    let by_mm = [0.0, y, 0.0];
    editor.apply(&Edit::Move { parts, by_mm }).unwrap();
}

#[test]
fn a_save_writes_the_text_and_nothing_else() {
    let (folder, path) = file();
    let mut editor = open(&path);
    assert_eq!(editor.file_state(), FileState::Saved);
    move_key(&mut editor, 0, 5.0);
    assert_eq!(editor.file_state(), FileState::Modified);
    editor.save().unwrap();
    assert_eq!(editor.file_state(), FileState::Saved);
    let expected = TEXT.replace("(0, 0)", "(0, 5)");
    assert_eq!(fs::read_to_string(&path).unwrap(), expected);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(editor.poll(), None);
    assert!(editor.undo() && editor.is_modified());
}

#[test]
fn a_shipped_layout_is_a_copy_until_it_has_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut editor = LayoutEditor::open("numpad", Fit::default()).unwrap();
    assert_eq!(editor.file_state(), FileState::Unsaved);
    assert!(matches!(editor.save(), Err(SaveError::NoFile)));
    let path = folder.path().join("mine.ron");
    editor.save_as(&path, false).unwrap();
    assert_eq!(editor.path(), Some(path.as_path()));
    assert_eq!(fs::read_to_string(&path).unwrap(), editor.text());
    let exists = editor.save_as(&path, false).unwrap_err();
    assert!(exists.to_string().contains("exists already"), "{exists}");
    editor.save_as(&path, true).unwrap();
}

#[test]
fn a_change_by_another_program_is_read_or_merged() {
    let (_folder, path) = file();
    let mut editor = open(&path);
    let theirs = TEXT.replace("(120, 0)", "(120, 7)");
    write_later(&path, &theirs);
    assert_eq!(editor.poll(), Some(Change::Reloaded));
    assert_eq!(editor.text(), theirs);
    move_key(&mut editor, 0, 5.0);
    let theirs = theirs.replace("// mine", "// ours");
    write_later(&path, &format!("{theirs}// end\n"));
    assert_eq!(editor.poll(), Some(Change::Merged));
    let merged = format!("{}// end\n", theirs.replace("(0, 0)", "(0, 5)"));
    assert_eq!(editor.text(), merged);
    editor.save().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), merged);
    while editor.undo() {}
    assert_eq!(editor.text(), TEXT);
}

#[test]
fn a_selected_key_stays_selected_when_another_program_adds_one_before_it() {
    let (_folder, path) = file();
    let mut editor = open(&path);
    editor.select([key(0)]);
    let first = "(code: \"A\"";
    let more = format!("(code: \"E\", at_mm: (0, 40)),\n                {first}");
    fs::write(&path, TEXT.replace(first, &more)).unwrap();
    assert_eq!(editor.poll(), Some(Change::Reloaded));
    assert_eq!(editor.selection(), [key(1)]);
    let line = "                (code: \"A\", at_mm: (0, 0)), // first\n";
    fs::write(&path, TEXT.replace(line, "")).unwrap();
    assert_eq!(editor.poll(), Some(Change::Reloaded));
    assert_eq!(editor.selection(), []);
}

#[test]
fn overlapping_changes_are_a_conflict_with_two_ways_out() {
    for resolution in [Resolution::KeepMine, Resolution::TakeTheirs] {
        let (_folder, path) = file();
        let mut editor = open(&path);
        move_key(&mut editor, 0, 5.0);
        let mine = editor.text().to_owned();
        let theirs = TEXT.replace("(0, 0)", "(0, 9)");
        write_later(&path, &theirs);
        let error = editor.save().unwrap_err();
        assert!(
            error.to_string().contains("keep yours or take theirs"),
            "{error}"
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), theirs);
        assert!(editor.conflict().is_some());
        assert!(editor.save().is_err());
        editor.resolve(resolution);
        editor.save().unwrap();
        let expected = match resolution {
            Resolution::KeepMine => &mine,
            Resolution::TakeTheirs => &theirs,
        };
        assert_eq!(&fs::read_to_string(&path).unwrap(), expected);
        assert_eq!(editor.text(), expected);
    }
}

#[test]
fn a_conflict_ends_with_the_changes_of_the_other_program() {
    let (_folder, path) = file();
    let mut editor = open(&path);
    move_key(&mut editor, 0, 5.0);
    // Another length, as both writes may lie within one tick of the file system.
    fs::write(&path, TEXT.replace("(0, 0)", "(0, 19)")).unwrap();
    assert_eq!(editor.poll(), Some(Change::Conflict));
    fs::write(&path, TEXT).unwrap();
    assert_eq!(editor.poll(), None);
    assert_eq!(editor.conflict(), None);
    editor.save().unwrap();
    assert_eq!(
        fs::read_to_string(&path).unwrap(),
        TEXT.replace("(0, 0)", "(0, 5)")
    );
}

#[test]
fn a_conflict_ends_with_the_next_change_once_the_edits_are_undone() {
    let (_folder, path) = file();
    let mut editor = open(&path);
    move_key(&mut editor, 0, 5.0);
    fs::write(&path, TEXT.replace("(0, 0)", "(0, 19)")).unwrap();
    assert_eq!(editor.poll(), Some(Change::Conflict));
    assert!(editor.undo() && !editor.is_modified());
    let theirs = TEXT.replace("(0, 0)", "(0, 119)");
    fs::write(&path, &theirs).unwrap();
    assert_eq!(editor.poll(), Some(Change::Reloaded));
    assert_eq!(editor.conflict(), None, "the earlier text is out of date");
    assert_eq!(editor.text(), theirs);
}

#[test]
fn two_valid_changes_that_overlap_on_the_board_are_a_conflict() {
    let (_folder, path) = file();
    let mut editor = open(&path);
    move_key(&mut editor, 0, 30.0);
    write_later(&path, &TEXT.replace("(120, 0)", "(0, 30)"));
    assert_eq!(editor.poll(), Some(Change::Conflict));
    assert!(editor.is_valid());
}

#[test]
fn an_unwritable_file_stays_and_so_does_the_text() {
    let (folder, path) = file();
    let mut editor = open(&path);
    move_key(&mut editor, 0, 5.0);
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    let error = editor.save().unwrap_err().to_string();
    assert!(
        error.contains("read-only") && error.contains("another name"),
        "{error}"
    );
    assert!(editor.is_modified());
    assert_eq!(fs::read_to_string(&path).unwrap(), TEXT);
    editor.save_as(&folder.path().join("b.ron"), false).unwrap();
    assert!(!editor.is_modified());
}

/// A disk of one page in memory.
struct TinyDisk(TempDir);

impl TinyDisk {
    fn mount() -> Option<Self> {
        let folder = tempfile::tempdir().ok()?;
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", "size=64k,mode=700", "none"]);
        let is_mounted = mount.arg(folder.path()).output().ok()?.status.success();
        is_mounted.then_some(Self(folder))
    }
}

impl Drop for TinyDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).output();
    }
}

#[test]
fn a_full_disk_keeps_the_old_file_and_the_text() {
    let Some(disk) = TinyDisk::mount() else {
        println!("SKIPPED: mounting a small disk is not permitted");
        return;
    };
    let path = disk.0.path().join("a.ron");
    fs::write(&path, TEXT).unwrap();
    let mut editor = open(&path);
    editor
        .start_recovery(&disk.0.path().join("editor"))
        .unwrap();
    let filler = disk.0.path().join("filler");
    assert!(fs::write(&filler, vec![b'x'; 1 << 20]).is_err());
    move_key(&mut editor, 0, 5.0);
    let error = editor.save().unwrap_err().to_string();
    assert!(
        error.contains("the disk is full") && error.contains("make room"),
        "{error}"
    );
    assert_eq!(fs::read_to_string(&path).unwrap(), TEXT);
    assert!(editor.is_modified());
    let start = std::time::Instant::now();
    while editor.recovery_error().is_none() {
        assert!(start.elapsed().as_secs() < 60, "no error");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        editor
            .recovery_error()
            .unwrap()
            .contains("save the layout soon")
    );
    fs::remove_file(&filler).unwrap();
    editor.save().unwrap();
    assert!(fs::read_to_string(&path).unwrap().contains("(0, 5)"));
}

/// Opens a file after its editor has ended. A program that another test starts has a copy of the lock until it runs.
fn reopen(path: &Path, recovery: &Path) -> (LayoutEditor, Option<UnsavedWork>) {
    let start = std::time::Instant::now();
    loop {
        assert!(start.elapsed().as_secs() < 60, "it stays locked");
        let mut editor = open(path);
        let work = editor.start_recovery(recovery).unwrap();
        if !editor.is_open_elsewhere() {
            return (editor, work);
        }
    }
}

#[test]
fn unsaved_work_is_offered_at_the_next_start_and_gone_after_a_save() {
    let (folder, path) = file();
    let recovery = folder.path().join("state/editor");
    let mut editor = open(&path);
    assert_eq!(editor.start_recovery(&recovery).unwrap(), None);
    move_key(&mut editor, 0, 5.0);
    move_key(&mut editor, 0, 5.0);
    let text = editor.text().to_owned();
    drop(editor);
    let (mut reopened, work) = reopen(&path, &recovery);
    let work = work.unwrap();
    let name = path.to_str().unwrap().to_owned();
    assert_eq!((&work.name, &work.text), (&name, &text));
    reopened.restore_found_work();
    assert_eq!(reopened.text(), text);
    reopened.save().unwrap();
    drop(reopened);
    let (last, left_work) = reopen(&path, &recovery);
    assert_eq!(left_work, None);
    drop(last);
    let left = fs::read_dir(&recovery).unwrap().flatten();
    let left: Vec<_> = left.map(|entry| entry.path()).collect();
    assert!(
        left.iter()
            .all(|rest| rest.extension().is_some_and(|it| it == "lock")),
        "{left:?}"
    );
}

#[test]
fn two_editors_of_one_file_know_of_each_other_and_lose_nothing() {
    let (folder, path) = file();
    let recovery = folder.path().join("editor");
    let (mut first, mut second) = (open(&path), open(&path));
    first.start_recovery(&recovery).unwrap();
    second.start_recovery(&recovery).unwrap();
    assert!(!first.is_open_elsewhere() && second.is_open_elsewhere());
    move_key(&mut first, 0, 5.0);
    move_key(&mut second, 3, 5.0);
    first.save().unwrap();
    let error = second.save().unwrap_err();
    assert!(matches!(error, SaveError::Merged(_)), "{error}");
    second.save().unwrap();
    let text = fs::read_to_string(&path).unwrap();
    assert!(
        text.contains("(0, 5)") && text.contains("(120, 5)"),
        "{text}"
    );
    // Both saves may lie within one tick of the file system.
    write_later(&path, &text);
    assert_eq!(first.poll(), Some(Change::Reloaded));
}

/// Reopens a file, does something in the editor, and ends it. Returns the text of the work that was offered.
fn visit(path: &Path, recovery: &Path, act: impl FnOnce(&mut LayoutEditor)) -> Option<String> {
    let (mut editor, work) = reopen(path, recovery);
    act(&mut editor);
    work.map(|work| work.text)
}

#[test]
fn unsaved_work_is_offered_until_it_is_answered() {
    let (folder, path) = file();
    let recovery = folder.path().join("editor");
    let moved = |before: &str, after: &str| Some(TEXT.replace(before, after));
    let first = moved("(0, 0)", "(0, 5)");
    let second = moved("(40, 0)", "(40, 7)");
    let visit = |act: &dyn Fn(&mut LayoutEditor)| visit(&path, &recovery, act);
    assert_eq!(visit(&|editor| move_key(editor, 0, 5.0)), None);
    // The offer is not answered, and other work is neither saved nor discarded.
    assert_eq!(visit(&|editor| move_key(editor, 1, 7.0)), first);
    // A save is no answer.
    let save = |editor: &mut LayoutEditor| {
        move_key(editor, 2, 9.0);
        editor.save().unwrap();
    };
    assert_eq!(visit(&save), first);
    let answer = |editor: &mut LayoutEditor| {
        editor.restore_found_work();
        assert_eq!(Some(editor.text()), first.as_deref());
        let next = editor.found_work().map(|work| &work.text);
        assert_eq!(next, second.as_ref());
        editor.discard_found_work();
        assert_eq!(editor.found_work(), None);
    };
    assert_eq!(visit(&answer), first);
    // The restored work is not saved, so it is offered again. A close without saving discards it, and leaves the other work.
    let close = |editor: &mut LayoutEditor| editor.discard_unsaved_work();
    assert_eq!(visit(&close), first);
    let discard = |editor: &mut LayoutEditor| editor.discard_found_work();
    assert_eq!(visit(&discard), first);
    assert_eq!(visit(&|_| {}), None);
}

#[test]
fn unsaved_work_of_each_editor_of_a_file_is_offered_once_it_has_ended() {
    let (folder, path) = file();
    let recovery = folder.path().join("editor");
    let (mut first, mut second) = (open(&path), open(&path));
    first.start_recovery(&recovery).unwrap();
    second.start_recovery(&recovery).unwrap();
    move_key(&mut first, 0, 5.0);
    move_key(&mut second, 1, 7.0);
    let mut third = open(&path);
    assert_eq!(third.start_recovery(&recovery).unwrap(), None);
    let texts = [first.text().to_owned(), second.text().to_owned()];
    drop((first, second, third));
    let mut offered = Vec::new();
    visit(&path, &recovery, |editor| {
        while let Some(work) = editor.found_work() {
            offered.push(work.text.clone());
            editor.discard_found_work();
        }
    });
    assert_eq!(offered, texts);
    assert_eq!(visit(&path, &recovery, |_| {}), None);
}

#[test]
fn unsaved_work_is_offered_under_the_name_of_the_last_save() {
    let (folder, path) = file();
    let recovery = folder.path().join("editor");
    let copy = folder.path().join("b.ron");
    let mut editor = open(&path);
    editor.start_recovery(&recovery).unwrap();
    move_key(&mut editor, 1, 7.0);
    editor.save_as(&copy, false).unwrap();
    move_key(&mut editor, 0, 5.0);
    let text = editor.text().to_owned();
    drop(editor);
    assert_eq!(visit(&copy, &recovery, |_| {}), Some(text));
    assert_eq!(visit(&path, &recovery, |_| {}), None);
}

/// Returns the number of files of a folder that editors have locked.
fn locked_files(folder: &Path) -> usize {
    let entries = fs::read_dir(folder).unwrap().flatten();
    let locks = entries.filter(|entry| entry.path().extension().is_some_and(|it| it == "lock"));
    let is_locked = |path: PathBuf| LockedFile::try_lock(fs::File::open(path).unwrap()).is_err();
    locks.filter(|lock| is_locked(lock.path())).count()
}

#[test]
fn found_work_waits_for_an_answer_also_after_a_save_under_another_name() {
    let (folder, path) = file();
    let recovery = folder.path().join("editor");
    let leave = |editor: &mut LayoutEditor| move_key(editor, 0, 5.0);
    assert_eq!(visit(&path, &recovery, leave), None);
    let (mut editor, work) = reopen(&path, &recovery);
    assert!(work.is_some());
    editor.save_as(&folder.path().join("b.ron"), false).unwrap();
    assert_eq!(editor.found_work(), work.as_ref());
    // Of the old name, only the file with the found work is in use.
    assert_eq!(locked_files(&recovery), 2);
    editor.discard_found_work();
    assert_eq!(editor.found_work(), None);
    assert_eq!(visit(&path, &recovery, |_| {}), None);
    drop(editor);
}

#[test]
fn a_text_without_a_file_is_unsaved() {
    let (folder, path) = file();
    let recovery = folder.path().join("editor");
    let lose = |editor: &mut LayoutEditor| {
        fs::remove_file(&path).unwrap();
        assert!(matches!(editor.poll(), Some(Change::Unreadable(_))));
        assert_eq!(editor.file_state(), FileState::Modified);
        assert_eq!(editor.poll(), None, "reported once");
    };
    assert_eq!(visit(&path, &recovery, lose), None);
    fs::write(&path, TEXT.replace("(0, 0)", "(0, 9)")).unwrap();
    let work = visit(&path, &recovery, |editor| {
        lose(editor);
        editor.save().unwrap();
        assert_eq!(editor.file_state(), FileState::Saved);
        lose(editor);
        fs::write(&path, editor.text()).unwrap();
        assert_eq!(editor.poll(), None);
        assert_eq!(editor.file_state(), FileState::Saved);
    });
    assert_eq!(work.as_deref(), Some(TEXT));
}
