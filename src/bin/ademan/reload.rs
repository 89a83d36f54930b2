//! The layout of a run, replaced when its file is saved.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use ademan::control::Reporter;
use ademan::device::KeyCode;
use ademan::layout::Layout;
use ademan::output;
use ademan::reload::{Report, Watcher};
use ademan::runtime::Replacement;
use ademan::settings::Assembly;
use crossbeam_channel::Sender;

use crate::failure::Failure;

/// What a run cannot do with another layout.
struct Limits {
    /// The keys of an output that has no others.
    keys: Option<BTreeSet<KeyCode>>,
    is_recorded: bool,
}

/// Watches the layouts of a setup, but for shipped ones, which are not saved; they come out of the other
/// end of `replacements`. What becomes of them is said on standard error, and to `reporter`.
pub fn watch(
    assembly: &Assembly,
    is_recorded: bool,
    replacements: &Sender<Replacement>,
    reporter: Option<&Reporter>,
) -> Result<Vec<Watcher>, Failure> {
    let has_fixed_keys = output::has_fixed_keys(&assembly.setup.output);
    let assembly = Arc::new(assembly.clone());
    let limits = Arc::new(Limits {
        keys: has_fixed_keys.then(|| assembly.layout.codes()),
        is_recorded,
    });
    let is_file = |(_, layout): &(usize, &Layout)| Path::new(&layout.file).is_file();
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
        let file = &layout.file;
        Watcher::start(file, layout, profile, replacements, accept, tell)
    };
    let layouts = assembly.layouts().enumerate().filter(is_file);
    Ok(layouts.map(watch).collect::<Result<_, _>>()?)
}

impl Limits {
    fn accept(&self, layout: &Layout) -> Result<(), String> {
        let file = &layout.file;
        if self.is_recorded {
            return Err(format!(
                "{file}: not used, as a recording is of one layout; start again to use it"
            ));
        }
        let codes = layout.codes();
        let lacking = |keys: &BTreeSet<KeyCode>| codes.difference(keys).next().copied();
        match self.keys.as_ref().and_then(lacking) {
            Some(key) => Err(format!(
                "{file}: not used, as the output was opened without the key `{key}`; start again to use it"
            )),
            None => Ok(()),
        }
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

    #[test]
    fn an_output_with_fixed_keys_takes_layouts_with_no_others() {
        let limits = Limits {
            keys: Some(layout("A B C").codes()),
            is_recorded: false,
        };
        assert_eq!(limits.accept(&layout("C A")), Ok(()));
        assert_eq!(
            limits.accept(&layout("A Z")).unwrap_err(),
            "a.ron: not used, as the output was opened without the key `Z`; start again to use it"
        );
    }

    #[test]
    fn an_output_without_fixed_keys_takes_every_layout_unless_it_is_recorded() {
        let mut limits = Limits {
            keys: None,
            is_recorded: false,
        };
        assert_eq!(limits.accept(&layout("Z")), Ok(()));
        limits.is_recorded = true;
        assert_eq!(
            limits.accept(&layout("Z")).unwrap_err(),
            "a.ron: not used, as a recording is of one layout; start again to use it"
        );
    }
}
