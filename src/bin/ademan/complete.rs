//! Candidates for the values of arguments, which a shell asks the program for when its user presses Tab.

use std::ffi::OsStr;
use std::path::Path;

use ademan::capture::recognition::port_names;
use ademan::capture::transport::Scheme;
use ademan::capture::uri::schemes;
use ademan::document::FileKind;
use ademan::files::own_names;
use ademan::output::{BACKENDS, Backend};
use clap_complete::engine::{
    ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter,
};

/// Candidates of a value.
type Candidates = Vec<CompletionCandidate>;

/// Completes a layout: shipped ones, ones in the configuration folder, and files.
pub fn layout() -> ArgValueCompleter {
    names_and_files(FileKind::Layout)
}

/// Completes a glove, as a layout.
pub fn glove() -> ArgValueCompleter {
    names_and_files(FileKind::Glove)
}

/// Completes a person, as a layout.
pub fn person() -> ArgValueCompleter {
    names_and_files(FileKind::Person)
}

/// Completes a setup file.
pub fn setup() -> ArgValueCompleter {
    ArgValueCompleter::new(|current: &OsStr| files(current, "ron"))
}

/// Completes a recording.
pub fn recording() -> ArgValueCompleter {
    ArgValueCompleter::new(|current: &OsStr| files(current, "mcap"))
}

/// Completes a source: its kind, then the serial ports or files.
pub fn source() -> ArgValueCompleter {
    ArgValueCompleter::new(source_candidates)
}

/// Completes the last of the outputs, which are separated by commas.
pub fn outputs() -> ArgValueCompleter {
    ArgValueCompleter::new(|current: &OsStr| {
        let current = current.to_string_lossy();
        let before = current.rfind(',').map_or("", |comma| &current[..=comma]);
        let candidate = |backend: &Backend| {
            let value = format!("{before}{}", backend.name);
            CompletionCandidate::new(value).help(Some(backend.summary.into()))
        };
        let candidates = BACKENDS.iter().map(|backend| candidate(backend));
        starting_with(&current, candidates)
    })
}

fn source_candidates(current: &OsStr) -> Candidates {
    let text = current.to_string_lossy();
    let Some((scheme, rest)) = text.split_once(':') else {
        let kinds = schemes().map(|scheme: Scheme| {
            let value = format!("{}:", scheme.name);
            CompletionCandidate::new(value).help(Some(scheme.summary.into()))
        });
        return starting_with(&text, kinds.chain(serial_ports()));
    };
    match scheme {
        "serial" => starting_with(&text, serial_ports()),
        "file" | "script" | "recording" => {
            let extension = if scheme == "recording" { "mcap" } else { "" };
            let paths = files(OsStr::new(rest), extension).into_iter();
            let prefix = format!("{scheme}:");
            paths.map(|path| path.add_prefix(&prefix)).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns a source for each serial port of this machine.
fn serial_ports() -> impl Iterator<Item = CompletionCandidate> {
    let source = |port: String| format!("serial:{port}");
    port_names()
        .into_iter()
        .map(source)
        .map(CompletionCandidate::new)
}

fn names_and_files(kind: FileKind) -> ArgValueCompleter {
    ArgValueCompleter::new(move |current: &OsStr| -> Candidates {
        let shipped = kind.shipped().map(str::to_owned);
        let names = shipped.chain(own_names(kind));
        let candidates = names.map(CompletionCandidate::new);
        let named = starting_with(&current.to_string_lossy(), candidates);
        named.into_iter().chain(files(current, "ron")).collect()
    })
}

/// Returns the files with an extension, or all for an empty one, and the folders.
fn files(current: &OsStr, extension: &'static str) -> Candidates {
    let is_wanted = move |path: &Path| {
        path.is_dir() || extension.is_empty() || path.extension().is_some_and(|it| it == extension)
    };
    PathCompleter::any().filter(is_wanted).complete(current)
}

fn starting_with(
    current: &str,
    candidates: impl Iterator<Item = CompletionCandidate>,
) -> Candidates {
    let starts = |candidate: &CompletionCandidate| {
        candidate.get_value().to_string_lossy().starts_with(current)
    };
    candidates.filter(starts).collect()
}
