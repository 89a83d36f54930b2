//! Outputs by name: a list such as `transcript:log.txt,desktop` → one [`Sink`].

use std::path::Path;

use super::router::{Route, Router, route};
use super::watchdog::WatchdogSettings;
use super::{
    BACKENDS, Backend, DesktopPart, OpenRequest, OutputError, Sink, find_backend, ime, midi, null,
    spacenav, transcript,
};
use ademan_core::device::{Capabilities, Capability};
use ademan_core::message::escape;

/// One output of a list, as written.
struct NamedOutput<'a> {
    /// The name with its argument: `transcript:log.txt`.
    name: &'a str,
    backend: &'static Backend,
    argument: Option<&'a str>,
}

impl NamedOutput<'_> {
    /// Returns the backend that the keys of the output `ime` go through; `None` for other outputs.
    fn key_output(&self) -> Option<&'static Backend> {
        let argument = (self.backend == &ime::BACKEND).then_some(self.argument);
        argument.and_then(|argument| ime::key_output(argument).ok())
    }

    /// Returns what the output can send.
    fn capabilities(&self) -> Capabilities {
        match self.key_output() {
            None => (self.backend.capabilities)(),
            Some(keys) => Capabilities {
                text: true,
                ..(keys.capabilities)()
            },
        }
    }

    /// Returns what the output can send only if it was opened for it.
    fn fixed_capabilities(&self) -> Capabilities {
        let backend = self.key_output().unwrap_or(self.backend);
        if backend.is_fixed_when_open {
            (backend.capabilities)()
        } else {
            Capabilities::default()
        }
    }
}

/// Opens the outputs in a list of names separated by commas.
///
/// A name stands for a [`Backend`], optionally followed by a colon and an argument that contains no comma. With
/// several outputs, each capability is carried by the first output that supports it (see [`Router`]). Nothing is
/// opened if a required capability is not supported by any of them.
pub fn open(names: &str, required: &Capabilities) -> Result<Box<dyn Sink>, OutputError> {
    open_for_session(names, required, None, None)
}

/// Opens outputs as [`open`] does, with absolute positions within `part` of the desktop, and with a [watchdog](super::watchdog) for each
/// output whose keys would outlive this process.
pub fn open_for_session(
    names: &str,
    required: &Capabilities,
    part: Option<DesktopPart>,
    watchdog: Option<&WatchdogSettings>,
) -> Result<Box<dyn Sink>, OutputError> {
    check(names, required)?;
    let outputs = parse(names)?;
    let routes = routes(&outputs);
    let open_one = |(index, output): (usize, &NamedOutput)| {
        (output.backend.open)(&OpenRequest {
            name: output.name,
            argument: output.argument,
            required: &routed_to(&routes, index, required),
            watchdog,
        })
    };
    let sinks = outputs.iter().enumerate().map(open_one);
    let mut sinks = sinks.collect::<Result<Vec<_>, _>>()?;
    Ok(match part {
        None if sinks.len() == 1 => sinks.remove(0),
        _ => Box::new(Router::new(sinks).in_part(part.unwrap_or_default())),
    })
}

/// Checks that every required capability is supported by one of the outputs. Opens nothing.
pub fn check(names: &str, required: &Capabilities) -> Result<(), OutputError> {
    match unsupported(&parse(names)?, required) {
        None => Ok(()),
        Some(reason) => Err(OutputError::open(names, reason)),
    }
}

/// Checks that this build and this machine have what the outputs `ime`, `midi` and `spacenav` need, as far as that shows without opening
/// them.
pub fn check_presence(names: &str) -> Result<(), OutputError> {
    for output in parse(names)? {
        let present = if output.backend == &ime::BACKEND {
            ime::check_presence(output.argument)
        } else if output.backend == &midi::BACKEND {
            midi::check_presence(output.argument)
        } else if output.backend == &spacenav::BACKEND {
            spacenav::check_presence(output.argument)
        } else {
            Ok(())
        };
        present.map_err(|reason| OutputError::open(output.name, reason))?;
    }
    Ok(())
}

/// Checks that outputs opened for a layout that requires `opened` can serve a layout that requires `required`.
/// Returns the cause and the remedy otherwise.
pub fn check_layout_change(
    names: &str,
    opened: &Capabilities,
    required: &Capabilities,
) -> Result<(), String> {
    let outputs = parse(names).map_err(|error| error.to_string())?;
    if let Some(reason) = unsupported(&outputs, required) {
        return Err(reason);
    }
    let routes = routes(&outputs);
    for (index, output) in outputs.iter().enumerate() {
        let routed = routed_to(&routes, index, required);
        let fixed = output.fixed_capabilities();
        let is_missing = |new: &Capability| fixed.contains(*new) && !opened.contains(*new);
        if let Some(missing) = routed.iter().find(is_missing) {
            return Err(format!(
                "the output `{}` was opened without {missing}; restart to use it",
                escape(output.name)
            ));
        }
    }
    Ok(())
}

/// Returns `true` if one output carries all required capabilities, so that events arrive in the order in which they are sent: a
/// [`Router`] sends the events of a step to one output after the other. `false` if the names are invalid.
pub fn keeps_order(names: &str, required: &Capabilities) -> bool {
    let routes = parse(names).map_or_else(|_| Vec::new(), |outputs| routes(&outputs));
    (0..routes.len()).any(|index| routed_to(&routes, index, required) == *required)
}

/// Returns `true` if events reach another program, because an output is neither a log nor [`none`](super::BACKENDS), or if the
/// names are invalid.
pub fn has_effect(names: &str) -> bool {
    let is_effective =
        |output: &NamedOutput| !output.backend.is_log && output.backend != &null::BACKEND;
    parse(names).map_or(true, |outputs| outputs.iter().any(is_effective))
}

/// Returns `true` if no output does anything with an event: each is [`none`](super::BACKENDS).
pub fn discards_all(names: &str) -> bool {
    parse(names).is_ok_and(|outputs| outputs.iter().all(|it| it.backend == &null::BACKEND))
}

/// Returns `true` if one of the outputs writes to the standard output.
pub fn uses_stdout(names: &str) -> bool {
    uses_backend(names, transcript::BACKEND.name)
}

/// Returns `true` if one of the outputs is this backend, without an argument.
pub fn uses_backend(names: &str, backend: &str) -> bool {
    names.split(',').any(|name| name.trim() == backend)
}

/// Returns the files of the transcripts among the outputs.
pub fn transcript_files(names: &str) -> impl Iterator<Item = &Path> {
    let outputs = parse(names).unwrap_or_default().into_iter();
    let transcripts = outputs.filter(|output| output.backend == &transcript::BACKEND);
    transcripts.filter_map(|output| output.argument.map(Path::new))
}

/// Returns all names for messages: `transcript, transcript:PATH, desktop, …`.
pub fn available() -> String {
    let forms = BACKENDS.iter().flat_map(|backend| {
        let with_argument = backend.argument.map(|argument| {
            let name = backend.name;
            format!("{name}:{argument}")
        });
        let alone = (!backend.is_argument_required).then(|| backend.name.to_owned());
        alone.into_iter().chain(with_argument)
    });
    forms.collect::<Vec<_>>().join(", ")
}

fn parse(names: &str) -> Result<Vec<NamedOutput<'_>>, OutputError> {
    names
        .split(',')
        .map(|name| parse_one(name.trim()))
        .collect()
}

fn parse_one(name: &str) -> Result<NamedOutput<'_>, OutputError> {
    let (backend, argument) = match name.split_once(':') {
        Some((backend, argument)) => (backend, Some(argument)),
        None => (name, None),
    };
    let backend = find_backend(backend)?;
    if argument.is_some() && backend.argument.is_none() {
        return Err(OutputError::UnexpectedArgument {
            output: name.into(),
        });
    }
    Ok(NamedOutput {
        name,
        backend,
        argument,
    })
}

fn routes(outputs: &[NamedOutput]) -> Vec<Route> {
    let route = |output: &NamedOutput| Route {
        capabilities: output.capabilities(),
        is_log: output.backend.is_log,
    };
    outputs.iter().map(route).collect()
}

/// Returns the required capabilities that the output at `index` carries.
fn routed_to(routes: &[Route], index: usize, required: &Capabilities) -> Capabilities {
    let is_routed_here = |capability: &Capability| route(routes, *capability) == Some(index);
    required.iter().filter(is_routed_here).collect()
}

/// Returns the first required capability that no output supports, with the remedy; `None` if all are supported.
fn unsupported(outputs: &[NamedOutput], required: &Capabilities) -> Option<String> {
    let routes = routes(outputs);
    let missing = required
        .iter()
        .find(|required| route(&routes, *required).is_none())?;
    let names: Vec<_> = outputs.iter().map(|output| output.name).collect();
    let quoted = outputs
        .iter()
        .filter(|output| !output.backend.is_log)
        .map(|output| format!("`{}`", escape(output.name)));
    let quoted: Vec<_> = quoted.collect();
    let verb = match quoted.len() {
        1 => "does",
        _ => "do",
    };
    let is_alternative = |backend: &&&Backend| {
        !backend.is_log && **backend != &null::BACKEND && (backend.capabilities)().contains(missing)
    };
    let remedy = match BACKENDS.iter().find(is_alternative) {
        Some(Backend { name, .. }) => {
            format!(
                "add the output `{name}`: `{},{name}`",
                escape(&names.join(","))
            )
        }
        None => "remove it from the layout, or use the output `transcript`".into(),
    };
    Some(format!(
        "the layout requires {missing}, which {} {verb} not support; {remedy}",
        quoted.join(" and ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::key;
    use ademan_core::device::Axis;

    fn code(name: &str) -> Capability {
        Capability::Key(key(name))
    }

    fn message(outputs: &str, required: Capability) -> Option<String> {
        let outputs = parse(outputs).unwrap();
        unsupported(&outputs, &Capabilities::from_iter([required]))
    }

    #[test]
    fn an_unsupported_capability_is_reported_with_the_output_to_add() {
        let table = [
            (
                "desktop",
                code("PadSouth"),
                "the layout requires `PadSouth`, which `desktop` does not support; \
                 add the output `uinput`: `desktop,uinput`",
            ),
            (
                "transcript,desktop",
                Capability::Axis(Axis::LeftX),
                "the layout requires `LeftX`, which `desktop` does not support; \
                 add the output `uinput`: `transcript,desktop,uinput`",
            ),
            (
                "uinput",
                Capability::Text,
                "the layout requires characters, which `uinput` does not support; \
                 add the output `desktop`: `uinput,desktop`",
            ),
            (
                "desktop,uinput",
                Capability::Axis(Axis::TurnZ),
                "the layout requires `TurnZ`, which `desktop` and `uinput` do not support; \
                 add the output `spacenav`: `desktop,uinput,spacenav`",
            ),
            (
                "ime",
                code("PadSouth"),
                "the layout requires `PadSouth`, which `ime` does not support; \
                 add the output `uinput`: `ime,uinput`",
            ),
            (
                "spacenav",
                code("PadStart"),
                "the layout requires `PadStart`, which `spacenav` does not support; \
                 add the output `uinput`: `spacenav,uinput`",
            ),
        ];
        for (outputs, required, expected) in table {
            assert_eq!(message(outputs, required).as_deref(), Some(expected));
        }
    }

    #[test]
    fn each_backend_supports_what_its_receiver_has() {
        let pointer = [
            code("A"),
            code("MouseLeft"),
            Capability::RelativeMotion,
            Capability::AbsoluteMotion,
            Capability::Scroll,
        ];
        for required in pointer {
            assert_eq!(message("desktop", required), None, "{required}");
            assert_eq!(message("uinput", required), None, "{required}");
            assert_eq!(message("ime", required), None, "{required}");
            assert!(message("spacenav", required).is_some(), "{required}");
        }
        for required in [code("PadSouth"), Capability::Text] {
            assert_eq!(message("ime:uinput", required), None, "{required}");
            assert_eq!(message("ime,uinput", required), None, "{required}");
        }
        let six_axes = [
            Capability::Axis(Axis::MoveX),
            Capability::Axis(Axis::TurnZ),
            code("PadWest"),
        ];
        for required in six_axes {
            assert_eq!(message("spacenav", required), None, "{required}");
        }
    }

    #[test]
    fn only_the_output_none_discards_everything() {
        for (names, discards) in [
            ("none", true),
            ("none,none", true),
            ("none,transcript", false),
            ("transcript:log.txt", false),
            ("desktop", false),
            ("unknown", false),
        ] {
            assert_eq!(discards_all(names), discards, "{names}");
        }
    }

    #[test]
    fn two_outputs_keep_no_order_of_keys_and_text() {
        let required = Capabilities::from_iter([code("A"), code("Backspace"), Capability::Text]);
        let table = [
            ("desktop", true),
            ("ime:uinput", true),
            ("transcript", true),
            ("transcript,desktop,uinput", true),
            ("spacenav,desktop", true),
            ("uinput", false),
            ("uinput,desktop", false),
            ("uinput,ime", false),
            ("uinput,transcript", false),
            ("unknown", false),
        ];
        for (names, is_kept) in table {
            assert_eq!(keeps_order(names, &required), is_kept, "{names}");
        }
    }

    #[test]
    fn a_capability_is_routed_to_one_output() {
        let required = Capabilities::from_iter([
            code("A"),
            code("PadSouth"),
            Capability::Text,
            Capability::Scroll,
        ]);
        let routes = routes(&parse("uinput,transcript,desktop").unwrap());
        let to_uinput = [code("A"), code("PadSouth"), Capability::Scroll];
        let expected = [
            Capabilities::from_iter(to_uinput),
            Capabilities::default(),
            Capabilities::from_iter([Capability::Text]),
        ];
        for (index, wanted) in expected.iter().enumerate() {
            assert_eq!(routed_to(&routes, index, &required), *wanted, "{index}");
        }
    }
}
