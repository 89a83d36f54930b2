//! The layout of a run, replaced when its file is saved.

use std::collections::BTreeSet;
use std::path::Path;

use ademan::device::KeyCode;
use ademan::layout::Layout;
use ademan::output;
use ademan::reload::{Report, Watcher};
use ademan::settings::Assembly;

use crate::failure::Failure;

/// What a run cannot do with another layout.
struct Limits {
    /// The keys of an output that has no others.
    keys: Option<BTreeSet<KeyCode>>,
    is_recorded: bool,
}

/// Watches the layout of a setup; `None` for a shipped one, which is not saved.
pub fn watch(assembly: &Assembly, is_recorded: bool) -> Result<Option<Watcher>, Failure> {
    let path = &assembly.setup.layout;
    if !Path::new(path).is_file() {
        return Ok(None);
    }
    let has_fixed_keys = output::has_fixed_keys(&assembly.setup.output);
    let limits = Limits {
        keys: has_fixed_keys.then(|| assembly.layout.codes()),
        is_recorded,
    };
    let accept = move |layout: &Layout| limits.accept(layout);
    Ok(Some(Watcher::start(path, &assembly.layout, accept, tell)?))
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

fn tell(report: Report) {
    match report {
        Report::Replaced(layout) => say!("{}: in force from now on", layout.file),
        Report::Wrong(error) => say!("{error}\nthe layout in force stays"),
        Report::Refused(reason) => say!("{reason}"),
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
