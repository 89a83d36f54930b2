//! Scenario files.

use std::collections::HashSet;
use std::fmt;
use std::path::Path;

use crate::rig::script::steps;

/// The length at which lines of a transcript are wrapped.
const WIDTH: usize = 110;

/// A file of scenarios.
pub struct ScenarioFile {
    /// The text before the first scenario.
    head: String,
    pub scenarios: Vec<Scenario>,
}

/// A script and its transcript.
pub struct Scenario {
    pub name: String,
    /// The text after `setup:`.
    pub setup: String,
    pub lines: Vec<ScriptLine>,
}

/// A line of the script, and its transcript.
pub struct ScriptLine {
    pub text: String,
    pub words: Vec<String>,
}

impl ScriptLine {
    /// Returns the steps of the line.
    pub fn steps(&self) -> impl Iterator<Item = &str> {
        steps(&self.text).into_iter().map(|step| step.text)
    }
}

impl ScenarioFile {
    /// Parses a file without its transcripts.
    pub fn parse(path: &Path, text: &str) -> Self {
        let mut page = Self {
            head: String::new(),
            scenarios: Vec::new(),
        };
        let mut names = HashSet::new();
        for line in text.lines() {
            if let Some(name) = line.strip_prefix("## ") {
                assert!(names.insert(name), "{}: `{name}` twice", path.display());
                page.scenarios.push(Scenario {
                    name: name.to_owned(),
                    setup: String::new(),
                    lines: Vec::new(),
                });
                continue;
            }
            let Some(scenario) = page.scenarios.last_mut() else {
                page.head += line;
                page.head.push('\n');
                continue;
            };
            if let Some(setup) = line.strip_prefix("setup: ") {
                scenario.setup = setup.to_owned();
            } else if !line.is_empty() && !line.starts_with(' ') {
                scenario.lines.push(ScriptLine {
                    text: line.to_owned(),
                    words: Vec::new(),
                });
            }
        }
        for scenario in &page.scenarios {
            let (path, name) = (path.display(), &scenario.name);
            assert!(
                !scenario.setup.is_empty(),
                "{path}: `{name}` has no `setup:`"
            );
            assert!(!scenario.lines.is_empty(), "{path}: `{name}` has no script");
        }
        page
    }
}

impl fmt::Display for ScenarioFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.head)?;
        for (index, scenario) in self.scenarios.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            writeln!(f, "## {}\nsetup: {}", scenario.name, scenario.setup)?;
            for line in &scenario.lines {
                writeln!(f, "{}", line.text)?;
                write_words(f, &line.words)?;
            }
        }
        Ok(())
    }
}

fn write_words(f: &mut fmt::Formatter<'_>, words: &[String]) -> fmt::Result {
    let mut width = 0;
    for word in words {
        let length = word.chars().count() + 1;
        if width > 0 && width + length > WIDTH {
            writeln!(f)?;
            width = 0;
        }
        let before = if width == 0 { "    " } else { " " };
        write!(f, "{before}{word}")?;
        width += length;
    }
    if width > 0 { writeln!(f) } else { Ok(()) }
}

/// Returns the scenarios that differ, as expected and as found.
pub fn difference(expected: &str, found: &str) -> String {
    let mut differences = String::new();
    let expected_scenarios: Vec<&str> = expected.split("\n## ").collect();
    for (index, scenario) in found.split("\n## ").enumerate() {
        let wanted = expected_scenarios.get(index).copied().unwrap_or_default();
        if wanted.trim_end() != scenario.trim_end() {
            differences += &format!(
                "expected {}\nfound {}\n\n",
                wanted.trim_end(),
                scenario.trim_end()
            );
        }
    }
    if differences.is_empty() {
        "only blank lines differ".to_owned()
    } else {
        differences
    }
}
