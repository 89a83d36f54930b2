//! Flags that override fields of a setup, shared by several subcommands.

use std::fmt::Debug;
use std::path::Path;
use std::str::FromStr;

use ademan::capture::SourceUri;
use ademan::files;
use ademan::message::escape;
use ademan::pipeline::SourceRole;
use ademan::setup::{OWN_SETUP, ReplaySettings, Setup};
use ademan::text::TextChoice;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::failure::Failure;
use crate::source_value::{self, SourceValue};
use crate::{complete, link};

/// Flags that override a setup file.
#[derive(Clone, Default, clap::Args)]
pub struct SetupArgs {
    #[arg(long, value_name = "URI", value_parser = SourceValue, add = complete::source(), help = "Source of readings", long_help = source_value::help())]
    source: Option<SourceUri>,
    /// Source of the arm, if the fingers have another one: a camera beside a glove
    #[arg(long, value_name = "URI", value_parser = SourceValue)]
    arm_source: Option<SourceUri>,
    /// Events that the source may cause: pointer, keys or both. The default is both, and pointer for a source on the
    /// network
    #[arg(long, value_parser = role())]
    role: Option<SourceRole>,
    /// Events that the source of the arm may cause. The hand causes only those that both of its sources may
    #[arg(long, value_parser = role())]
    arm_role: Option<SourceRole>,
    /// Glove: the name of one that comes with the program, or a file
    #[arg(long, add = complete::glove())]
    glove: Option<String>,
    /// Person: the name of one that comes with the program (see `ademan person list`), or a file
    #[arg(long, value_name = "FILE", add = complete::person())]
    person: Option<String>,
    /// Layout: the name of one that comes with the program (see `ademan layout list`), a file, or a link of the page (docs/web.md)
    #[arg(long, add = complete::layout())]
    layout: Option<String>,
    /// Use the layout of a link, which somebody else made
    #[arg(long)]
    trust: bool,
    /// Correct words at their end (auto), only suggest, or neither until `ademan ctl text` says so (literal): `auto`, `auto:es`, or
    /// `auto:MODEL.adm`. The default language is the language of the setup, or English
    #[arg(long, value_name = "MODE[:LANGUAGE]")]
    decoder: Option<TextChoice>,
    /// File of what the decoder has learned of you: where you tap, and your words. It is read at the start, if it is there, and
    /// written by `ademan ctl save-learned`
    #[arg(long, value_name = "FILE")]
    learned: Option<String>,
    /// Widen the ranges of finger sensors that drift while the glove is worn, within limits; `ademan ctl undo-learning` undoes it
    #[arg(long)]
    learn_ranges: bool,
}

impl SetupArgs {
    /// Creates the flags of a command for one glove.
    pub fn for_glove(
        source: Option<SourceUri>,
        glove: Option<String>,
        person: Option<String>,
    ) -> Self {
        Self {
            person,
            source,
            glove,
            ..Self::default()
        }
    }

    /// Creates the flags of a command for a layout.
    pub fn for_layout(layout: String) -> Self {
        Self {
            layout: Some(layout),
            ..Self::default()
        }
    }

    /// Returns the flags with a layout.
    pub fn with_layout(self, layout: String) -> Self {
        Self {
            layout: Some(layout),
            ..self
        }
    }

    /// Returns `true` if a layout is named.
    pub fn names_layout(&self) -> bool {
        self.layout.is_some()
    }

    /// Returns `true` if the events that a source may cause are named.
    pub fn names_role(&self) -> bool {
        self.role.is_some() || self.arm_role.is_some()
    }

    /// Returns `true` if a file of what the text decoder has learned is named.
    pub fn names_learned(&self) -> bool {
        self.learned.is_some()
    }

    /// Sets a source on standard input, and a layout, if none is named.
    pub fn default_to(&mut self, source: &str, layout: Option<&str>) -> Result<(), Failure> {
        match &self.source {
            None => {
                let source = source.parse();
                self.source = Some(source.expect("the source of a command is valid"));
            }
            Some(named) if named.to_string().starts_with("stdin:") => {}
            Some(other) => {
                return Err(Failure::wrong_use(format!(
                    "the source is the camera, not `{}`; `--source` may only set options: `{source}&swap_hands=yes`",
                    escape(&other.to_string())
                )));
            }
        }
        self.layout = self.layout.take().or(layout.map(str::to_owned));
        Ok(())
    }

    /// Reads a setup file and applies the flags. Without a file, it is `setup.ron` in the configuration folder if there is one.
    pub fn read_setup(&self, file: Option<&str>) -> Result<Setup, Failure> {
        let own = files::in_config_folder(OWN_SETUP);
        let mut setup = match (file, own) {
            (Some(path), _) => Setup::load(path)?,
            (None, Some(path)) => {
                let path = path.to_string_lossy();
                say!("using {}", escape(&path));
                Setup::load(&path)?
            }
            (None, None) => Setup::default(),
        };
        setup.role = role_beside(self.source.as_ref(), setup.source.as_ref(), setup.role);
        setup.source = self.source.clone().or(setup.source);
        let own_arm = setup.arm_source.as_ref();
        setup.arm_role = role_beside(self.arm_source.as_ref(), own_arm, setup.arm_role);
        setup.arm_source = self.arm_source.clone().or(setup.arm_source);
        setup.glove = self.glove.clone().or(setup.glove);
        setup.person = self.person.clone().or(setup.person);
        setup.layout = self.trusted_layout()?.unwrap_or(setup.layout);
        self.override_text(&mut setup);
        self.override_permissions(&mut setup);
        Ok(setup)
    }

    /// Returns the layout that is named: for a link that is trusted, the file to which its layout is written.
    fn trusted_layout(&self) -> Result<Option<String>, Failure> {
        let layout = self.layout.clone();
        layout
            .map(|name| link::trusted(name, self.trust))
            .transpose()
    }

    /// Returns the flags with the file of a layout in place of its link.
    pub fn with_trusted_layout(&self) -> Result<Self, Failure> {
        Ok(Self {
            layout: self.trusted_layout()?,
            ..self.clone()
        })
    }

    /// Applies the mode and the language of the text decoder.
    pub fn override_decoder(&self, setup: &mut Setup) {
        if let Some(decoder) = &self.decoder {
            setup.text = Some(decoder.applied_to(setup.text.take()));
        }
    }

    /// Applies the flags of the text decoder.
    fn override_text(&self, setup: &mut Setup) {
        self.override_decoder(setup);
        if let Some(learned) = self.learned.clone() {
            setup.text.get_or_insert_default().learned = Some(learned);
        }
    }

    /// Applies the flags that name no file and no source.
    pub fn override_permissions(&self, setup: &mut Setup) {
        setup.arm_role = self.arm_role.or(setup.arm_role);
        setup.role = self.role.or(setup.role);
        setup.learn_ranges |= self.learn_ranges;
    }

    /// Returns the recording that is the only source.
    pub fn recording(&self) -> Option<&Path> {
        match (&self.source, &self.arm_source) {
            (Some(SourceUri::Recording { path }), None) => Some(path),
            _ => None,
        }
    }

    /// Returns the replacements of the glove, the layout and the person of a recording.
    pub fn replay_settings(&self) -> ReplaySettings<'_> {
        ReplaySettings {
            glove: self.glove.as_deref(),
            layout: self.layout.as_deref(),
            person: self.person.as_deref(),
            permissions: None,
        }
    }
}

/// Returns the role of a setup if the source that is named takes the place of `own`, the source of the setup. A role that lets that one
/// press keys is not for another one on the network, where other programs may send readings too.
pub fn role_beside(
    named: Option<&SourceUri>,
    own: Option<&SourceUri>,
    role: Option<SourceRole>,
) -> Option<SourceRole> {
    let is_other = named.is_some_and(|named| {
        named.is_remote() && own.is_some_and(|own| own.to_string() != named.to_string())
    });
    role.filter(|role| !is_other || *role == SourceRole::Pointer)
}

/// Returns the parser of `--role` and `--arm-role`.
pub fn role() -> impl TypedValueParser<Value = SourceRole> {
    named(SourceRole::ALL, SourceRole::name)
}

/// Returns the parser of an argument that is the name of one of these values.
pub fn named<T: Copy + Send + Sync + 'static, const N: usize>(
    values: [T; N],
    name_of: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(values.map(name_of)).map(move |name| {
        let value = values.into_iter().find(|value| name_of(*value) == name);
        value.expect("the parser accepts only these names")
    })
}

/// Returns the parser of an argument that is one of these names.
pub fn one_of<T>(names: &'static [&'static str]) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err: Debug> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).map(|name| {
        name.parse::<T>()
            .expect("the parser accepts only these names")
    })
}

/// Parses a number in a closed range.
pub fn number_in(text: &str, min: f64, max: f64, unit: &str) -> Result<f64, String> {
    let number: f64 = text
        .parse()
        .map_err(|_| format!("`{}` is not a number", escape(text)))?;
    if (min..=max).contains(&number) {
        return Ok(number);
    }
    let tenfold = number * 10.0;
    let advice = if unit == "mm" && (min..=max).contains(&tenfold) {
        format!("; {number} cm are {tenfold:.0} mm")
    } else {
        String::new()
    };
    Err(format!("it is {min} to {max} {unit}{advice}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_role_that_lets_a_source_press_keys_is_not_for_another_one_on_the_network() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("setup.ron");
        let role_of = |fields: &str, source: &str| {
            std::fs::write(&path, format!("Setup({fields})")).unwrap();
            let flags = SetupArgs {
                source: Some(source.parse().unwrap()),
                ..SetupArgs::default()
            };
            flags.read_setup(path.to_str()).unwrap().role
        };
        let (glove, other) = ("tcp:192.168.1.7:4001", "tcp:192.168.1.8:4001");
        let own = |role: &str| format!("source: \"{glove}\", role: {role}");
        let both = Some(SourceRole::Both);
        assert_eq!(role_of(&own("Both"), other), None);
        assert_eq!(role_of(&own("Keys"), other), None);
        assert_eq!(
            role_of(&own("Pointer"), other),
            Some(SourceRole::Pointer),
            "it presses no keys"
        );
        assert_eq!(role_of(&own("Both"), glove), both);
        assert_eq!(role_of(&own("Both"), "serial:/dev/ttyUSB0"), both);
        assert_eq!(role_of("role: Both", other), both, "it is for any source");
    }
}
