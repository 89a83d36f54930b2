//! The guide to layouts: its tables of fields, its gallery and its pictures are what the program writes.
//!
//! After an intended change: `ADEMAN_WRITE=1 cargo test --test files guide`, then look at the pictures and at the difference.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use ademan::document::{Table, shipped_layouts};
use ademan::layout::{Layout, field_tables, person_field_tables};
use ademan::setup::Setup;

const GUIDE: &str = "layouts/README.md";
const PERSONS: &str = "docs/persons.md";
const GALLERY: &str = "docs/layouts";
const TUTORIAL: &str = "docs/tutorial";

/// The start of a part of the guide that the program writes: `<!-- generated: fields Slider -->`.
const BEGIN: &str = "<!-- generated: ";
const END: &str = "<!-- end -->\n";

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Compares a file with its text, or writes it if `ADEMAN_WRITE` is set.
fn assert_file(name: &str, text: &str) {
    let path = path(name);
    if std::env::var_os("ADEMAN_WRITE").is_some() {
        fs::write(&path, text).expect("a file in the project");
        return;
    }
    let stored = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        stored == text,
        "{name} is out of date: ADEMAN_WRITE=1 cargo test --test files guide"
    );
}

fn guide() -> String {
    fs::read_to_string(path(GUIDE)).expect("the guide")
}

/// Returns the guide with each generated part as the program writes it, and the names of the parts.
fn regenerated(guide: &str) -> (String, Vec<String>) {
    let (mut text, mut parts) = (String::new(), Vec::new());
    let mut pieces = guide.split(BEGIN);
    text += pieces.next().expect("the start of the guide");
    for piece in pieces {
        let (part, rest) = piece.split_once(" -->\n").expect("the name of a part");
        let (_, after) = rest.split_once(END).expect("the end of a part");
        text += &format!("{BEGIN}{part} -->\n{}{END}{after}", generated(part));
        parts.push(part.to_owned());
    }
    (text, parts)
}

fn generated(part: &str) -> String {
    if part == "gallery" {
        return gallery();
    }
    let tables: Vec<Table> = field_tables()
        .into_iter()
        .chain(person_field_tables())
        .collect();
    let name = part.strip_prefix("fields ").expect("a kind of part");
    let table = tables.iter().find(|table| table.name == name);
    let table = table.unwrap_or_else(|| panic!("no structure has the name {name}"));
    markdown(table, &tables)
}

/// Returns a table of fields. Values that have a table of their own link to it.
fn markdown(table: &Table, tables: &[Table]) -> String {
    let is_enumeration = table.rows.iter().any(|row| row.default.is_empty());
    let first = if is_enumeration { "value" } else { "field" };
    let (name, meaning) = (table.name, &table.meaning);
    let mut text = format!("<a id=\"{}\"></a>**{name}**: {meaning}.\n\n", anchor(name));
    text += &format!("| {first} | default | valid | meaning |\n|---|---|---|---|\n");
    for row in &table.rows {
        let values = linked(&row.values, tables);
        let cells = [&row.default, &values, &row.meaning];
        text += &format!("| `{}` |", row.name);
        for cell in cells {
            text += &if cell.is_empty() {
                " |".to_owned()
            } else {
                format!(" {cell} |")
            };
        }
        text.push('\n');
    }
    text
}

fn anchor(name: &str) -> String {
    format!("fields-{}", name.to_lowercase())
}

fn linked(values: &str, tables: &[Table]) -> String {
    let (before, last) = values.rsplit_once(' ').unwrap_or(("", values));
    if tables.iter().all(|table| table.name != last) {
        return values.to_owned();
    }
    format!("{before} [{last}](#{})", anchor(last))
        .trim()
        .to_owned()
}

/// Returns all shipped layouts with their descriptions and pictures, two beside each other.
fn gallery() -> String {
    let mut text = String::from("| | |\n|---|---|\n");
    let cells: Vec<String> = Layout::shipped()
        .expect("valid layouts")
        .iter()
        .map(|(name, layout)| {
            let description = &layout.description;
            format!(
                "**`{name}`**: {description}<br>![{name}: {description}](../{GALLERY}/{name}.svg)"
            )
        })
        .collect();
    for pair in cells.chunks(2) {
        let second = pair.get(1).map_or("", String::as_str);
        text += &format!("| {} | {second} |\n", pair[0]);
    }
    text
}

#[test]
fn the_generated_parts_of_the_guide_are_up_to_date() {
    let (text, parts) = regenerated(&guide());
    let unique: BTreeSet<&String> = parts.iter().collect();
    assert_eq!(unique.len(), parts.len(), "a part occurs twice");
    for table in field_tables() {
        let part = format!("fields {}", table.name);
        assert!(unique.contains(&part), "the guide has no part `{part}`");
        for row in &table.rows {
            assert!(
                !row.meaning.is_empty(),
                "{}: {} has no meaning",
                table.name,
                row.name
            );
        }
    }
    assert!(parts.iter().any(|part| part == "gallery"));
    assert_file(GUIDE, &text);
}

#[test]
fn the_page_on_persons_lists_every_field() {
    let page = fs::read_to_string(path(PERSONS)).expect("the page on persons");
    let (text, parts) = regenerated(&page);
    for table in person_field_tables() {
        let part = format!("fields {}", table.name);
        assert!(parts.contains(&part), "the page has no part `{part}`");
    }
    assert_file(PERSONS, &text);
}

#[test]
#[cfg_attr(
    windows,
    ignore = "Windows rounds sines in another way, which shows in the last digits of a picture"
)]
fn each_shipped_layout_has_its_picture_in_the_gallery() {
    let mut expected = BTreeSet::new();
    for name in shipped_layouts() {
        assert_file(&format!("{GALLERY}/{name}.svg"), &picture(name));
        expected.insert(format!("{name}.svg"));
    }
    assert_eq!(file_names(GALLERY), expected);
}

/// Returns what `ademan layout show --svg` writes for a layout.
fn picture(layout: &str) -> String {
    let setup = Setup {
        layout: layout.into(),
        ..Setup::default()
    };
    let setup = setup.load_files().expect("a valid layout");
    setup.layout.to_svg(&setup.wearer()).expect("a picture")
}

/// A picture below a layout of the tutorial shows that layout.
#[test]
fn each_picture_of_the_tutorial_shows_the_layout_above_it() {
    let guide = guide();
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("layout.ron");
    let mut expected = BTreeSet::new();
    for block in guide.split("```ron\n").skip(1) {
        let (layout, after) = block.split_once("```").expect("the end of a layout");
        let marker = format!("](../{TUTORIAL}/");
        let next = after.split("```").next().unwrap_or_default();
        let Some((_, name)) = next.split_once(&marker) else {
            continue;
        };
        let name = name.split(')').next().expect("a name");
        fs::write(&file, layout).expect("a layout");
        let picture = picture(file.to_str().expect("a path in UTF-8"));
        assert_file(&format!("{TUTORIAL}/{name}"), &picture);
        expected.insert(name.to_owned());
    }
    assert!(expected.len() >= 3, "{expected:?}");
    assert_eq!(file_names(TUTORIAL), expected);
}

fn file_names(folder: &str) -> BTreeSet<String> {
    let files = fs::read_dir(path(folder)).expect("a folder of pictures");
    let names = files.flatten().map(|file| file.file_name());
    names
        .map(|name| name.to_string_lossy().into_owned())
        .collect()
}
