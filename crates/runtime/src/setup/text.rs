//! The text decoder of a setup.

use std::io::Read;
use std::path::Path;

use super::LoadedSetup;
use crate::files::{self, FileError};
use crate::output;
use crate::text::{self, Language, TextSetup};
use ademan_core::command::TextMode;
use ademan_core::device::{Capabilities, Capability};
use ademan_core::layout::Layout;
use ademan_core::message::{escape, escape_path};
use ademan_core::pipeline::LayoutInstance;

/// Largest file of a language model, in bytes: sixteen times the largest one that comes with the program.
const MAX_MODEL_BYTES: u64 = 1 << 26;

impl LoadedSetup {
    /// Adds a text decoder if the setup has none, and a layout has a mode or keys for it. It changes nothing where the layout has keys
    /// only.
    pub(super) fn add_text_setup(&mut self) {
        let asks =
            |layout: &Layout| !layout.text_mode.is_none_or(is_literal) || layout.has_text_commands;
        if self.setup.text.is_none() && self.layouts().any(asks) {
            self.setup.text = Some(TextSetup::default());
        }
    }

    /// Returns the mode in which the text decoder of a layout starts. `own` is the mode of its profile. The person decides before
    /// the layout, which may come from somebody else.
    fn text_mode(&self, layout: &Layout, own: Option<TextMode>) -> TextMode {
        let setup = self.setup.text.as_ref().and_then(|text| text.mode);
        let stated = own.or(setup.map(TextMode::from));
        stated.or(layout.text_mode).unwrap_or(TextMode::Literal)
    }

    /// Returns the modes in which the text decoders of all layouts start.
    fn text_modes(&self) -> impl Iterator<Item = TextMode> {
        let profiles = self.profiles.iter();
        let further = profiles.map(|profile| self.text_mode(&profile.layout, profile.text));
        std::iter::once(self.text_mode(&self.layout, None)).chain(further)
    }

    /// Loads the language of the text decoder with `read`. If that fails, there is no text decoder, and
    /// [`text_error`](Self::text_error) is the reason.
    pub(super) fn load_language(&mut self, read: impl FnOnce(&Path) -> Result<Vec<u8>, String>) {
        let mut corrections = Capabilities::from_iter([Capability::Text]);
        for layout in self.layouts() {
            corrections.extend(text::capabilities(layout, true).iter());
        }
        // Characters between keys arrive in order only where one output takes both.
        let writes_text = output::keeps_order(&self.setup.output, &corrections);
        let Some(setup) = &mut self.setup.text else {
            return;
        };
        // A recording says what the output of its session could do: a replay writes to another one.
        setup.accents &= writes_text;
        match Language::load(&setup.language, read) {
            Ok(language) => self.language = Some(language.with_learned(self.learned.clone())),
            Err(error) => self.text_error = Some(error),
        }
        let has_letters = |layout: &Layout| !text::capabilities(layout, false).keys.is_empty();
        let asks = self.text_modes().any(|mode| !is_literal(mode));
        if asks && self.language.is_some() && !self.layouts().any(has_letters) {
            let other = self
                .layouts()
                .find(|layout| text::shows_other_keymap(layout));
            let has_chords = self.layouts().any(|layout| !layout.chords.is_empty());
            let missing = if has_chords {
                "no layout has letters on keys of their own, and letters of chords are not corrected"
            } else {
                "no layout has letters"
            };
            self.text_error = Some(other.map_or_else(
                || missing.to_owned(),
                |layout| {
                    format!(
                        "`{}` is for a receiver with another keymap than US, as its labels show, and the decoder types for that one \
                         only; use a layout such as `qwerty-words`: the decoder writes the accents",
                        escape(&layout.name)
                    )
                },
            ));
        }
        match self.text_note() {
            Some(note) => tracing::warn!("{note}"),
            None => self.report_modes_of_layouts(),
        }
    }

    /// Reports the layouts whose files decide that words are changed.
    fn report_modes_of_layouts(&self) {
        let text = self.setup.text.as_ref();
        if text.is_some_and(|text| text.mode.is_some()) {
            return;
        }
        let profiles = self.profiles.iter();
        let further = profiles.filter(|profile| profile.text.is_none());
        let layouts = std::iter::once(&self.layout).chain(further.map(|profile| &profile.layout));
        for layout in layouts {
            if let Some(mode) = layout.text_mode.filter(|mode| !is_literal(*mode)) {
                tracing::info!(
                    "the file of `{}` states the text mode {mode}; `--decoder literal` types what is pressed",
                    escape(&layout.name)
                );
            }
        }
    }

    /// Returns the message about a text decoder that is missing, if the setup asks for one.
    pub fn text_note(&self) -> Option<String> {
        let error = self.text_error.as_ref()?;
        Some(format!("words are not corrected: {error}"))
    }

    /// Returns `true` if a text decoder finds the letters of multitap keys of the layout from the words.
    pub fn finds_letters(&self) -> bool {
        let decodes = self.setup.text.is_some() && !is_literal(self.text_mode(&self.layout, None));
        decodes && self.language.is_some() && text::finds_letters(&self.layout)
    }

    /// Returns the run-time instance of a layout, with a text decoder if the setup has one.
    pub(super) fn instance(&self, layout: &Layout, mode: Option<TextMode>) -> LayoutInstance {
        let setup = self.setup.text.as_ref().zip(self.language.as_ref());
        let filter = setup.and_then(|(setup, language)| {
            let mode = self.text_mode(layout, mode);
            language.filter(layout, mode, self.other_hand.is_some(), setup.accents)
        });
        LayoutInstance::from_layout(layout).with_filter(filter)
    }
}

fn is_literal(mode: TextMode) -> bool {
    mode == TextMode::Literal
}

/// Reads the file of a language model, which no other user may change: it decides what is typed in place of a word.
pub(super) fn read_model(path: &Path) -> Result<Vec<u8>, String> {
    let cannot_read = |reason: String| {
        format!(
            "cannot read the language model {}: {reason}",
            escape_path(path)
        )
    };
    let file = files::open_trusted(path).map_err(|error| match error {
        FileError::Io(error) => cannot_read(format!("{error}; `ademan text build` makes one")),
        error => cannot_read(error.to_string()),
    })?;
    let mut bytes = Vec::new();
    let read = file.take(MAX_MODEL_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|error| cannot_read(error.to_string()))?;
    if bytes.len() as u64 <= MAX_MODEL_BYTES {
        Ok(bytes)
    } else {
        let reason = "it is larger than 64 MiB; build it of fewer words and texts";
        Err(cannot_read(reason.into()))
    }
}

/// Refuses the file of a language model for a recording.
pub(super) fn refuse_model(path: &Path) -> Result<Vec<u8>, String> {
    Err(format!(
        "the language model {} is not in the recording, and no file is opened because a recording names it",
        escape_path(path)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::Setup;
    use ademan_core::document::Document;
    use ademan_core::pipeline::PressFilter;

    #[test]
    fn the_file_of_a_model_is_in_the_folder_of_the_setup() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("setup.ron");
        for (language, expected) in [
            ("my.adm", folder.path().join("my.adm")),
            ("/models/my.adm", "/models/my.adm".into()),
            ("es", "es".into()),
        ] {
            let text = format!("Setup(text: (mode: Auto, language: {language:?}))");
            std::fs::write(&path, text).unwrap();
            let setup = Setup::load(path.to_str().unwrap()).unwrap();
            let found = setup.text.unwrap().language;
            assert_eq!(Path::new(&found), expected);
        }
    }

    #[test]
    fn a_layout_in_place_of_one_without_letters_has_the_mode_of_its_profile() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("setup.ron");
        let text = "Setup(layout: \"qwerty-flat\", text: (mode: Auto), profiles: [\
                    (name: \"a\", layout: \"numpad\", text: Suggest), (name: \"b\", layout: \"numpad\")])";
        std::fs::write(&path, text).unwrap();
        let loaded = Setup::load(path.to_str().unwrap())
            .unwrap()
            .load_files()
            .unwrap();
        let mode = |profile| {
            let instance = loaded.profile_instance(profile, &loaded.layout).unwrap();
            let state = instance.filter().and_then(PressFilter::text_state);
            state.map(|state| state.mode)
        };
        assert_eq!(
            [0, 1, 2].map(mode),
            [TextMode::Auto, TextMode::Suggest, TextMode::Auto].map(Some)
        );
    }

    #[test]
    fn the_mode_of_a_layout_is_weaker_than_the_modes_of_its_profile_and_of_the_setup() {
        let folder = tempfile::tempdir().unwrap();
        let shipped = Document::shipped("qwerty-flat").unwrap().text;
        let layout = shipped.replacen("boards:", "text: Auto, boards:", 1);
        std::fs::write(folder.path().join("auto.ron"), layout).unwrap();
        let path = folder.path().join("setup.ron");
        let modes = |text: &str| {
            let written = format!(
                "Setup(layout: \"qwerty-flat\", {text}profiles: [\
                 (name: \"a\", layout: \"auto.ron\", text: Suggest), (name: \"b\", layout: \"auto.ron\")])"
            );
            std::fs::write(&path, written).unwrap();
            let setup = Setup::load(path.to_str().unwrap()).unwrap();
            let loaded = setup.load_files().unwrap();
            let layouts: Vec<&Layout> = loaded.layouts().collect();
            [0, 1, 2].map(|profile| {
                let instance = loaded.profile_instance(profile, layouts[profile]).unwrap();
                let state = instance.filter().and_then(PressFilter::text_state);
                state.map(|state| state.mode)
            })
        };
        let [literal, suggest, auto] =
            [TextMode::Literal, TextMode::Suggest, TextMode::Auto].map(Some);
        assert_eq!(modes(""), [literal, suggest, auto]);
        assert_eq!(
            modes("text: (language: \"es\"), "),
            [literal, suggest, auto]
        );
        assert_eq!(
            modes("text: (mode: Literal), "),
            [literal, suggest, literal]
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_model_that_others_may_change_or_that_is_no_file_is_not_read() {
        use std::os::unix::fs::PermissionsExt;

        let folder = tempfile::tempdir().unwrap();
        let model = folder.path().join("my.adm");
        std::fs::write(&model, "words").unwrap();
        assert_eq!(read_model(&model).unwrap(), b"words");
        let everybody = std::fs::Permissions::from_mode(0o666);
        std::fs::set_permissions(&model, everybody).unwrap();
        let open = read_model(&model).unwrap_err();
        assert!(open.contains("other users may write this file"), "{open}");

        let pipe = folder.path().join("pipe.adm");
        let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
        rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, mode).unwrap();
        let refused = read_model(&pipe).unwrap_err();
        assert!(refused.contains("but a pipe"), "{refused}");
    }
}
