//! The layout of a run, replaced when its file is saved.

use std::path::Path;
use std::sync::Arc;

use ademan::control::Reporter;
use ademan::device::Needs;
use ademan::device::{Action, Request};
use ademan::layout::Layout;
use ademan::monitor::Snapshot;
use ademan::output;
use ademan::reload::{Asker, FileCall, FileCalls, FileOrder, Report, Watcher};
use ademan::runtime::Replacement;
use ademan::settings::Assembly;
use crossbeam_channel::{Sender, bounded};

use crate::failure::Failure;

/// What a run cannot do with another layout.
struct Limits {
    output: String,
    /// What the output was opened for.
    opened: Needs,
    is_recorded: bool,
}

/// Looks after the layouts of a setup; those that are saved, or made larger or smaller, come out of the
/// other end of `replacements`. What becomes of them is said on standard error, and to `reporter`.
pub fn watch(
    assembly: &Assembly,
    is_recorded: bool,
    replacements: &Sender<Replacement>,
    reporter: Option<&Reporter>,
) -> Result<Vec<Watcher>, Failure> {
    let assembly = Arc::new(assembly.clone());
    let limits = Arc::new(Limits {
        output: assembly.setup.output.clone(),
        opened: assembly.needs(),
        is_recorded,
    });
    let watch = |(profile, layout): (usize, &Layout)| {
        let (limits, setup) = (limits.clone(), assembly.clone());
        let accept = move |layout: &Layout| {
            limits.accept(layout)?;
            setup.controls(layout).map_err(|error| error.to_string())
        };
        let mut reporter = reporter.cloned();
        let tell = move |outcome: Report| {
            say!("{outcome}");
            if let Some(reporter) = &mut reporter {
                reporter.report(&outcome);
            }
        };
        let replacements = replacements.clone();
        let file = Path::new(&layout.file).is_file().then_some(&*layout.file);
        Watcher::start(file, layout, profile, replacements, accept, tell)
    };
    let layouts = assembly.layouts().enumerate();
    Ok(layouts.map(watch).collect::<Result<_, _>>()?)
}

/// Passes on what keys ask for: larger boards have to be built, which the loop does not wait for.
pub struct Growth {
    files: Vec<FileCalls>,
    answer: Asker,
}

impl Growth {
    /// Of the layouts that these look after. What comes of it is said on standard error.
    pub fn of(watchers: &[Watcher]) -> Self {
        let (answer, answers) = bounded::<Result<String, String>>(16);
        std::thread::spawn(move || {
            for text in answers {
                say!("{}", text.unwrap_or_else(|error| error));
            }
        });
        Self {
            files: watchers.iter().map(Watcher::calls).collect(),
            answer,
        }
    }

    /// Takes a frame; does not wait.
    pub fn take(&self, frame: &Snapshot) {
        for event in &frame.events {
            let Action::Ask(Request::Scale(thousandths)) = event.action else {
                continue;
            };
            if let Some(file) = self.files.iter().find(|file| file.profile == frame.profile) {
                let order = FileOrder::Scale(f32::from(thousandths) / 1e3);
                let answer = self.answer.clone();
                // With so many waiting the boards grow later or not at all.
                let _ = file.calls.try_send(FileCall { order, answer });
            }
        }
    }
}

impl Limits {
    fn accept(&self, layout: &Layout) -> Result<(), String> {
        let file = &layout.file;
        if self.is_recorded {
            return Err(format!(
                "{file}: not used, as a recording is of one layout; start again to use it"
            ));
        }
        output::can_take(&self.output, &self.opened, &layout.needs())
            .map_err(|reason| format!("{file}: not used, as {reason}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(keys: &str) -> Layout {
        let text = format!(
            "Layout(name: \"a\", boards: [(place: (anchor: elbow), rows: [(at_mm: (0, 0), keys: \"{keys}\")])])"
        );
        Layout::parse(&text, "a.ron").unwrap()
    }

    fn limits(output: &str) -> Limits {
        Limits {
            output: output.into(),
            opened: layout("A B C").needs(),
            is_recorded: false,
        }
    }

    #[test]
    fn devices_of_the_kernel_take_layouts_that_need_no_more_than_they_have() {
        let limits = limits("uinput");
        assert_eq!(limits.accept(&layout("C A")), Ok(()));
        assert_eq!(
            limits.accept(&layout("A Z")).unwrap_err(),
            "a.ron: not used, as the output `uinput` was opened without `Z`; start again to use it"
        );
    }

    #[test]
    fn a_desktop_takes_every_layout_of_keys_unless_it_is_recorded() {
        let mut limits = limits("desktop");
        assert_eq!(limits.accept(&layout("Z")), Ok(()));
        limits.is_recorded = true;
        assert_eq!(
            limits.accept(&layout("Z")).unwrap_err(),
            "a.ron: not used, as a recording is of one layout; start again to use it"
        );
    }
}
