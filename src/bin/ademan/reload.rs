//! The layout of a run, replaced when its file is saved.

use std::path::Path;
use std::sync::Arc;

use ademan::command::Command;
use ademan::device::Capabilities;
use ademan::layout::Layout;
use ademan::output;
use ademan::session::Replacement;
use ademan::session::control_socket::Notifier;
use ademan::session::reload::{
    FileCall, FileCalls, FileOrder, LayoutManager, ReloadReport, ReplySender,
};
use ademan::setup::LoadedSetup;
use ademan::snapshot::Snapshot;
use crossbeam_channel::{Sender, bounded};

use crate::failure::Failure;

/// What a run cannot do with another layout.
struct Limits {
    output: String,
    /// What the output was opened for.
    opened: Capabilities,
    is_recorded: bool,
}

/// Looks after the layouts of a setup; those that are saved, or made larger or smaller, come out of the
/// other end of `replacements`. What becomes of them is said on standard error, and to `reporter`.
pub fn watch(
    assembly: &LoadedSetup,
    is_recorded: bool,
    replacements: &Sender<Replacement>,
    reporter: Option<&Notifier>,
) -> Result<Vec<LayoutManager>, Failure> {
    let assembly = Arc::new(assembly.clone());
    let limits = Arc::new(Limits {
        output: assembly.setup.output.clone(),
        opened: assembly.required_capabilities(),
        is_recorded,
    });
    let watch = |(profile, layout): (usize, &Layout)| {
        let (limits, setup) = (limits.clone(), assembly.clone());
        let accept = move |layout: &Layout| {
            limits.accept(layout)?;
            setup.controls(layout).map_err(|error| error.to_string())
        };
        let mut reporter = reporter.cloned();
        let tell = move |outcome: ReloadReport| {
            say!("{outcome}");
            if let Some(reporter) = &mut reporter {
                reporter.notify_reload(&outcome);
            }
        };
        let replacements = replacements.clone();
        let file = Path::new(&layout.file).is_file().then_some(&*layout.file);
        LayoutManager::start(file, layout, profile, replacements, accept, tell)
    };
    let layouts = assembly.layouts().enumerate();
    Ok(layouts.map(watch).collect::<Result<_, _>>()?)
}

/// Passes on what keys ask for: larger boards have to be built, which the loop does not wait for.
pub struct Growth {
    files: Vec<FileCalls>,
    answer: ReplySender,
}

impl Growth {
    /// Of the layouts that these look after. What comes of it is said on standard error.
    pub fn of(watchers: &[LayoutManager]) -> Self {
        let (answer, answers) = bounded::<Result<String, String>>(16);
        std::thread::spawn(move || {
            for text in answers {
                say!("{}", text.unwrap_or_else(|error| error));
            }
        });
        Self {
            files: watchers.iter().map(LayoutManager::calls).collect(),
            answer,
        }
    }

    /// Takes a frame; does not wait.
    pub fn take(&self, frame: &Snapshot) {
        for issued in &frame.commands {
            let Command::Scale { factor } = issued.command else {
                continue;
            };
            if let Some(file) = self.files.iter().find(|file| file.profile == frame.profile) {
                let order = FileOrder::Scale(factor);
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
        output::check_layout_change(&self.output, &self.opened, &layout.required_capabilities())
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
            opened: layout("A B C").required_capabilities(),
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
