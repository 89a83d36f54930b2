//! The modules of a crate and what each of them imports, read from every line of its files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::code::{Token, tokens};

/// The names from the root of a crate to a module; empty for the root.
pub type ModulePath = Vec<String>;

/// A path in a module that leads to another module of the crate.
#[derive(Clone, Debug)]
pub struct Import {
    pub from: ModulePath,
    pub to: ModulePath,
    /// File and line.
    pub place: String,
}

/// The modules of one crate.
#[derive(Default)]
pub struct Modules {
    modules: BTreeMap<ModulePath, Module>,
}

#[derive(Default)]
struct Module {
    children: BTreeSet<String>,
    /// The path of each name that `use` declares, as written.
    names: BTreeMap<String, Vec<String>>,
    /// The modules of glob imports, as written.
    globs: Vec<Vec<String>>,
    /// Every path, as written, and where.
    paths: Vec<(Vec<String>, String)>,
}

impl Modules {
    /// Reads a crate: the name of each file below the folder of its root, and its text.
    pub fn read<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let mut modules = Self::default();
        for (file, text) in files {
            let path = module_of(file);
            let tokens = tokens(text);
            modules.modules.entry(path.clone()).or_default();
            Reader {
                modules: &mut modules.modules,
                file,
                tokens: &tokens,
                at: 0,
            }
            .module(&path);
        }
        let all: Vec<ModulePath> = modules.modules.keys().cloned().collect();
        for path in all {
            if let Some((name, parent)) = path.split_last()
                && let Some(parent) = modules.modules.get_mut(parent)
            {
                parent.children.insert(name.clone());
            }
        }
        modules
    }

    /// All modules.
    pub fn all(&self) -> impl Iterator<Item = &ModulePath> {
        self.modules.keys()
    }

    /// Every path that leads from one module to another.
    pub fn imports(&self) -> Vec<Import> {
        let mut imports = Vec::new();
        for (from, module) in &self.modules {
            for (path, place) in &module.paths {
                if let Some(to) = self.resolve(from, path, 0)
                    && to != *from
                {
                    imports.push(Import {
                        from: from.clone(),
                        to,
                        place: place.clone(),
                    });
                }
            }
        }
        imports
    }

    /// The module in which a path ends, as seen from a module; `None` if it leads out of the crate.
    fn resolve(&self, from: &[String], path: &[String], depth: usize) -> Option<ModulePath> {
        // Names that import each other in a circle.
        if depth > 16 {
            return None;
        }
        let (first, mut rest) = path.split_first()?;
        let mut module = match first.as_str() {
            "crate" => Vec::new(),
            "self" => from.to_vec(),
            "super" => from.split_last()?.1.to_vec(),
            _ => {
                rest = path;
                from.to_vec()
            }
        };
        let is_relative = rest.len() == path.len();
        for (index, name) in rest.iter().enumerate() {
            let Some(entry) = self.modules.get(&module) else {
                return Some(module);
            };
            if name == "super" {
                module.pop();
                continue;
            }
            if entry.children.contains(name) {
                module.push(name.clone());
                continue;
            }
            let alias = entry
                .names
                .get(name)
                .filter(|alias| alias.as_slice() != path);
            if let Some(alias) = alias {
                let mut target = alias.clone();
                target.extend_from_slice(&rest[index + 1..]);
                return self.resolve(&module, &target, depth + 1);
            }
            let mut globs = entry.globs.iter();
            if let Some(found) = globs.find_map(|glob| self.find(&module, glob, name, depth)) {
                module = found;
                continue;
            }
            return (!is_relative || index > 0).then_some(module);
        }
        Some(module)
    }

    /// The module in which `name` is found through an import of everything.
    fn find(
        &self,
        from: &[String],
        glob: &[String],
        name: &str,
        depth: usize,
    ) -> Option<ModulePath> {
        let target = self.resolve(from, glob, depth + 1)?;
        let entry = self.modules.get(&target)?;
        let is_there = entry.children.contains(name) || entry.names.contains_key(name);
        let path = [name.to_owned()];
        is_there
            .then(|| self.resolve(&target, &path, depth + 1))
            .flatten()
    }
}

/// The module that a file is, by its name below the folder of its root.
fn module_of(file: &str) -> ModulePath {
    let path = Path::new(file).with_extension("");
    let mut names: Vec<String> = path
        .iter()
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    if matches!(
        names.last().map(String::as_str),
        Some("mod" | "lib" | "main")
    ) {
        names.pop();
    }
    names
}

struct Reader<'a> {
    modules: &'a mut BTreeMap<ModulePath, Module>,
    file: &'a str,
    tokens: &'a [Token],
    at: usize,
}

impl Reader<'_> {
    fn peek(&self, ahead: usize) -> &str {
        let token = self.tokens.get(self.at + ahead);
        token.map_or("", |token| token.text.as_str())
    }

    fn before(&self) -> &str {
        let token = self.at.checked_sub(1).and_then(|at| self.tokens.get(at));
        token.map_or("", |token| token.text.as_str())
    }

    fn place(&self) -> String {
        let line = self.tokens.get(self.at).map_or(0, |token| token.line);
        format!("{}:{line}", self.file)
    }

    /// Reads to the end of a module: of the file, or of the braces that it is in.
    fn module(&mut self, path: &ModulePath) {
        let mut depth = 0;
        while self.at < self.tokens.len() {
            match self.peek(0) {
                "{" => depth += 1,
                "}" if depth == 0 => return,
                "}" => depth -= 1,
                "mod" if self.peek(2) == "{" && self.before() != "::" => {
                    let mut inner = path.clone();
                    inner.push(self.peek(1).to_owned());
                    self.modules.entry(inner.clone()).or_default();
                    self.at += 3;
                    self.module(&inner);
                }
                "mod" if self.peek(2) == ";" => self.at += 1,
                "use" => {
                    self.at += 1;
                    let is_of_module = depth == 0;
                    self.tree(path, &[], is_of_module);
                    continue;
                }
                word if is_name(word)
                    && self.peek(1) == "::"
                    && !matches!(self.before(), "::" | "." | "<") =>
                {
                    self.path(path);
                    continue;
                }
                word if is_name(word) && self.peek(1) == "::" && self.before() == "<" => {
                    self.path(path);
                    continue;
                }
                _ => {}
            }
            self.at += 1;
        }
    }

    /// Reads a path outside of `use`.
    fn path(&mut self, module: &ModulePath) {
        let place = self.place();
        let mut names = vec![self.peek(0).to_owned()];
        self.at += 1;
        while self.peek(0) == "::" && is_name(self.peek(1)) {
            names.push(self.peek(1).to_owned());
            self.at += 2;
        }
        self.add(module, names, place);
    }

    /// Reads what stands after `use`, or one branch of it.
    fn tree(&mut self, module: &ModulePath, prefix: &[String], is_of_module: bool) {
        let mut names = prefix.to_vec();
        loop {
            let place = self.place();
            match self.peek(0) {
                "::" => self.at += 1,
                "{" => {
                    self.at += 1;
                    while !matches!(self.peek(0), "}" | "") {
                        self.tree(module, &names, is_of_module);
                        self.at += usize::from(self.peek(0) == ",");
                    }
                    self.at += 1;
                    return;
                }
                "*" => {
                    self.at += 1;
                    self.add(module, names.clone(), place);
                    if is_of_module {
                        self.entry(module).globs.push(names);
                    }
                    return;
                }
                "as" => {
                    let name = self.peek(1).to_owned();
                    self.at += 2;
                    self.leaf(module, names, name, place, is_of_module);
                    return;
                }
                word if is_name(word) => {
                    names.push(word.to_owned());
                    self.at += 1;
                    if !matches!(self.peek(0), "::" | "as") {
                        if names.last().is_some_and(|name| name == "self") {
                            names.pop();
                        }
                        let name = names.last().cloned().unwrap_or_default();
                        self.leaf(module, names, name, place, is_of_module);
                        return;
                    }
                }
                _ => return,
            }
        }
    }

    fn leaf(
        &mut self,
        module: &ModulePath,
        names: Vec<String>,
        name: String,
        place: String,
        is_of_module: bool,
    ) {
        self.add(module, names.clone(), place);
        if is_of_module {
            self.entry(module).names.insert(name, names);
        }
    }

    fn add(&mut self, module: &ModulePath, names: Vec<String>, place: String) {
        self.entry(module).paths.push((names, place));
    }

    fn entry(&mut self, module: &ModulePath) -> &mut Module {
        self.modules.entry(module.clone()).or_default()
    }
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}
