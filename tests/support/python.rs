//! A Python with packages that others wrote.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use super::process::limit_lifetimes;

/// Held during an installation. Tests of one binary share a folder, and a second `venv --clear` empties the folder of the first.
static INSTALLATION: Mutex<()> = Mutex::new(());

/// Returns a Python that can import `modules`: the one of the system, or else one with `packages` installed once per build folder in
/// the virtual environment `name`. An error is the reason why there is none.
pub fn python(name: &str, modules: &str, packages: &[&str]) -> Result<PathBuf, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let python = folder.join("bin/python");
    let import = format!("import {modules}");
    let system = PathBuf::from("python3");
    if run(&system, &["-c", &import]).is_ok() {
        return Ok(system);
    }
    let _installation = INSTALLATION.lock().unwrap_or_else(PoisonError::into_inner);
    if run(&python, &["-c", &import]).is_ok() {
        return Ok(python);
    }
    let folder = folder.display().to_string();
    run(&system, &["-m", "venv", "--clear", &folder])?;
    let options = "-m pip install --quiet --timeout 15 --retries 3";
    let mut install: Vec<&str> = options.split(' ').collect();
    install.extend(packages);
    run(&python, &install)?;
    Ok(python)
}

fn run(program: &Path, arguments: &[&str]) -> Result<(), String> {
    limit_lifetimes();
    match Command::new(program).args(arguments).output() {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => Err(String::from_utf8_lossy(&output.stderr).trim().to_owned()),
        Err(error) => Err(error.to_string()),
    }
}
