//! The structure of the sources: data flows in one direction, no modules import each other in a cycle, stages read no
//! clock, files stay small. Every line of every file is checked. Beside it, the tests that faults and security
//! requirements rely on.

#[path = "architecture/code.rs"]
mod code;
#[path = "architecture/evidence.rs"]
mod evidence;
#[path = "architecture/fault_table.rs"]
mod fault_table;
#[path = "architecture/faults.rs"]
mod faults;
#[path = "architecture/modules.rs"]
mod modules;
#[path = "architecture/security.rs"]
mod security;
#[path = "architecture/security_sources.rs"]
mod security_sources;
#[path = "architecture/security_table.rs"]
mod security_table;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use code::{Token, code, tokens, without_tests};
use modules::{Import, Modules};

/// The modules of the library in the order in which data flows. Each may import the ones before it.
const FLOW: &[&str] = &[
    "time",
    "message",
    "names",
    "hand",
    "geometry",
    "files",
    "document",
    "command",
    "advice",
    "priority",
    "network",
    "capture",
    "estimate",
    "kinematics",
    "contact",
    "device",
    "output",
    "layout",
    "pipeline",
    "snapshot",
    "trace",
    "recorder",
    "share",
    "batch",
    "calibrate",
    "sim",
    "setup",
    "session",
    "doctor",
    "studio",
];

/// The modules that work between a reading and its events.
const STAGES: &[&str] = &["estimate", "kinematics", "contact", "device", "pipeline"];

/// The folders and files that may read a clock.
const MAY_READ_A_CLOCK: &[&str] = &[
    "network/",
    "capture/",
    "output/",
    "session/",
    "share/",
    "sim/player.rs",
    "bin/",
];

/// The files that may ask for the operating system, beside those named `mod.rs`, `main.rs` and `tests.rs`.
const MAY_HAVE_CFG: &[&str] = &["lib.rs"];

/// The longest file, in lines.
const LONGEST_FILE: usize = 500;

/// A source file.
struct Source {
    /// Its path below `src`.
    name: String,
    text: String,
    tokens: Vec<Token>,
}

impl Source {
    /// All code, one blank between tokens.
    fn code(&self) -> String {
        code(&self.tokens)
    }

    /// The code without unit tests.
    fn shipped_code(&self) -> String {
        match self.name.ends_with("tests.rs") || self.name.contains("/tests/") {
            true => String::new(),
            false => code(&without_tests(&self.tokens)),
        }
    }

    /// The first part of the path: the module of the flow, or `bin`.
    fn module(&self) -> &str {
        self.name.split(['/', '.']).next().expect("a first part")
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn sources() -> Vec<Source> {
    let mut found = Vec::new();
    collect(&root(), &mut found);
    assert!(found.len() > 100, "src holds {} files", found.len());
    found.sort_by(|one, other| one.name.cmp(&other.name));
    found
}

fn collect(folder: &Path, found: &mut Vec<Source>) {
    for entry in fs::read_dir(folder).expect("a folder of sources").flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let name = path.strip_prefix(root()).expect("a path below src");
            let text = fs::read_to_string(&path).expect("a source file");
            found.push(Source {
                name: name.display().to_string(),
                tokens: tokens(&text),
                text,
            });
        }
    }
}

/// The crate below a folder of `src`: the library for `""`.
fn crate_of(sources: &[Source], folder: &str) -> Modules {
    let files = sources.iter().filter_map(|source| {
        let name = source.name.strip_prefix(folder)?;
        let is_of_library = !name.starts_with("bin/");
        is_of_library.then_some((name, source.text.as_str()))
    });
    Modules::read(files)
}

fn library(sources: &[Source]) -> Modules {
    crate_of(sources, "")
}

fn program(sources: &[Source]) -> Modules {
    crate_of(sources, "bin/ademan/")
}

fn position(module: &str) -> Option<usize> {
    FLOW.iter().position(|other| *other == module)
}

#[test]
fn a_stage_imports_only_earlier_stages() {
    let is_backwards = |import: &Import| {
        let from = import.from.first().and_then(|module| position(module));
        let to = import.to.first().and_then(|module| position(module));
        from.zip(to).is_some_and(|(from, to)| to > from)
    };
    let imports = library(&sources()).imports();
    assert!(imports.len() > 1_000, "only {} imports", imports.len());
    let wrong: Vec<String> = imports
        .iter()
        .filter(|import| is_backwards(import))
        .map(|import| format!("{} imports {}", import.place, import.to.join("::")))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn no_modules_import_each_other_in_a_cycle() {
    let sources = sources();
    for modules in [library(&sources), program(&sources)] {
        let imports = modules.imports();
        let cycles: Vec<String> = modules
            .all()
            .flat_map(|parent| cycles_below(parent, &imports))
            .collect();
        assert!(cycles.is_empty(), "{cycles:#?}");
    }
}

/// The imports between children of a module, each with its subtree, that belong to a cycle.
fn cycles_below(parent: &[String], imports: &[Import]) -> Vec<String> {
    let depth = parent.len();
    let mut edges: BTreeMap<(&str, &str), &str> = BTreeMap::new();
    for Import { from, to, place } in imports {
        let is_below = |path: &[String]| path.len() > depth && path.starts_with(parent);
        if is_below(from) && is_below(to) && from[depth] != to[depth] {
            let edge = (from[depth].as_str(), to[depth].as_str());
            edges.entry(edge).or_insert(place);
        }
    }
    let reaches = |start: &str, goal: &str| {
        let (mut reached, mut open) = (BTreeSet::new(), vec![start]);
        while let Some(module) = open.pop() {
            let next = edges.keys().filter(|(from, _)| *from == module);
            open.extend(next.map(|(_, to)| *to).filter(|to| reached.insert(*to)));
        }
        reached.contains(goal)
    };
    edges
        .iter()
        .filter(|((from, to), _)| reaches(to, from))
        .map(|((from, to), place)| format!("{place}: {} {from} -> {to}", parent.join("::")))
        .collect()
}

#[test]
fn a_cycle_and_a_backward_import_are_found_wherever_they_are() {
    let files = [
        ("lib.rs", "pub mod a; pub mod b;"),
        ("a/mod.rs", "mod one; mod two; pub use two::Two;"),
        ("a/one.rs", "use super::Two; pub struct One;"),
        (
            "a/two.rs",
            "pub struct Two; #[cfg(test)] mod tests { use super::super::one::One; }\nfn f() { crate::b::g() }",
        ),
        (
            "b.rs",
            "//! use crate::a;\npub fn g() { let _ = \"crate::a\"; }",
        ),
    ];
    let modules = Modules::read(files);
    let imports = modules.imports();
    let found = |from: &str, to: &str| {
        let is_it = |import: &&Import| import.from.join("::") == from && import.to.join("::") == to;
        imports.iter().filter(is_it).count() > 0
    };
    assert!(found("a::one", "a::two"), "through a re-export");
    assert!(found("a::two::tests", "a::one"), "in a test module");
    assert!(found("a::two", "b"), "in an expression");
    assert!(!found("b", "a"), "not in comments and strings");
    assert_eq!(cycles_below(&["a".to_owned()], &imports).len(), 2);
}

#[test]
fn every_module_is_listed_in_the_order_of_the_flow() {
    let lib = fs::read_to_string(root().join("lib.rs")).expect("lib.rs");
    let declared: Vec<&str> = lib
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'))
        .collect();
    assert_eq!(declared, FLOW);
}

#[test]
fn stages_use_no_clock_no_lock_no_thread_and_no_hash_map() {
    let forbidden = [
        "Instant",
        "SystemTime",
        "Mutex",
        "RwLock",
        "std :: thread",
        "sleep (",
        "HashMap",
        "HashSet",
    ];
    let mut wrong = Vec::new();
    for source in sources() {
        if STAGES.contains(&source.module()) {
            let code = source.code();
            let found = forbidden.iter().filter(|word| code.contains(**word));
            wrong.extend(found.map(|word| format!("{}: {word}", source.name)));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn only_the_ends_of_the_flow_and_a_played_glove_read_a_clock() {
    for source in sources() {
        let may = MAY_READ_A_CLOCK
            .iter()
            .any(|prefix| source.name.starts_with(prefix));
        let reads = source.shipped_code().contains("Instant :: now");
        assert!(may || !reads, "{} reads a clock", source.name);
    }
}

#[test]
fn only_the_root_of_a_module_asks_for_the_operating_system() {
    let mut wrong = Vec::new();
    for source in sources() {
        let file = source.name.rsplit('/').next().expect("a last part");
        let may = matches!(file, "mod.rs" | "main.rs" | "tests.rs")
            || MAY_HAVE_CFG.contains(&source.name.as_str());
        if !may && asks_for_the_system(&source.tokens) {
            wrong.push(source.name);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Returns `true` if a `cfg` names an operating system or a family of them.
fn asks_for_the_system(tokens: &[Token]) -> bool {
    let mut cfg_depth = None;
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate() {
        match token.text.as_str() {
            "(" => {
                depth += 1;
                let before = at.checked_sub(1).map(|at| tokens[at].text.as_str());
                if before == Some("cfg") && cfg_depth.is_none() {
                    cfg_depth = Some(depth);
                }
            }
            ")" => {
                if cfg_depth == Some(depth) {
                    cfg_depth = None;
                }
                depth -= 1;
            }
            "target_os" | "unix" | "windows" | "target_family" if cfg_depth.is_some() => {
                return true;
            }
            _ => {}
        }
    }
    false
}

#[test]
fn files_stay_within_500_lines() {
    let long: Vec<String> = sources()
        .iter()
        .map(|source| (source.text.lines().count(), &source.name))
        .filter(|(lines, _)| *lines > LONGEST_FILE)
        .map(|(lines, name)| format!("{name}: {lines} lines"))
        .collect();
    assert!(long.is_empty(), "{long:#?}");
}

/// The wall clock can be set back. The age of a file is read from it, and only compared for equality; lines of a log tell their time.
/// `Path::display` writes control characters as they are. A path is escaped in a message, and as data it is a text.
#[test]
fn a_path_becomes_part_of_a_message_by_being_escaped() {
    for source in sources() {
        let displays = source.shipped_code().contains(". display ( )");
        assert!(!displays, "{}: use `escape_path`", source.name);
    }
}

#[test]
fn nothing_depends_on_the_wall_clock() {
    for source in sources() {
        let code = source.code();
        let depends = code.contains("SystemTime") || code.contains("ClockId :: Realtime");
        let may = source.name.starts_with("session/reload/")
            || source.name == "bin/ademan/messages/log_file.rs";
        assert!(may || !depends, "{} reads the wall clock", source.name);
    }
}

#[test]
fn a_poisoned_lock_is_used_all_the_same() {
    for source in sources() {
        let code: String = source.shipped_code().split_whitespace().collect();
        for panics in [".lock().unwrap()", ".lock().expect("] {
            assert!(
                !code.contains(panics),
                "{} panics at a poisoned lock",
                source.name
            );
        }
    }
}

/// A type is described by a noun phrase, a function by a verb in the third person.
#[test]
fn doc_comments_start_with_a_noun_or_a_verb() {
    let openings = [
        "What", "How", "Where", "Whether", "Whoever", "The same", "That of", "Those of",
    ];
    let starts_wrong = |line: &&str| {
        let line = line.trim_start();
        let text = line
            .strip_prefix("///")
            .or_else(|| line.strip_prefix("//!"));
        text.map(str::trim_start).is_some_and(|text| {
            let mut found = openings
                .iter()
                .filter_map(|opening| text.strip_prefix(opening));
            found.any(|rest| rest.starts_with([' ', ',', '\'']))
        })
    };
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    for folder in ["src", "tests", "benches", "examples"] {
        for (path, text) in security::files(&package.join(folder), ".rs") {
            let wrong: Vec<&str> = text.lines().filter(starts_wrong).collect();
            assert!(wrong.is_empty(), "{}: {wrong:#?}", path.display());
        }
    }
}
