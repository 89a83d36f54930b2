//! The setup of a recording.
//!
//! A recording may come from anybody, so it is data and nothing else. Only the documents that it contains are used: no file
//! is opened because a recording names it, and none is written. If the events have an effect on other programs, the
//! permissions of the person who replays it apply.

use ron::ser::PrettyConfig;

use super::{LoadedSetup, Setup, SetupError, kind};
use crate::capture::recording::RecordedSetup;
use crate::files::OpenDocument;
use ademan_core::document::{Document, DocumentError, FileKind};
use ademan_core::layout::Layout;

/// Changes to the setup of a recording.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReplaySettings<'a> {
    /// The glove that replaces the recorded one: a shipped name or a path.
    pub glove: Option<&'a str>,
    /// The layout that replaces the recorded one: a shipped name or a path.
    pub layout: Option<&'a str>,
    /// The person in place of the recorded one: a shipped name or a path.
    pub person: Option<&'a str>,
    /// The setup whose permissions apply. Without one, the permissions of the recording do, which repeats the recorded
    /// session exactly; events must have no effect then.
    pub permissions: Option<&'a Setup>,
}

impl LoadedSetup {
    /// Loads the setup of a recording.
    pub fn from_recording(
        recorded: &RecordedSetup,
        settings: &ReplaySettings,
    ) -> Result<Self, SetupError> {
        Self::from_changed_recording(recorded, settings, |_| {})
    }

    /// Loads the setup of a recording after a change to it, which names no other file.
    pub fn from_changed_recording(
        recorded: &RecordedSetup,
        settings: &ReplaySettings,
        change: impl FnOnce(&mut Setup),
    ) -> Result<Self, SetupError> {
        let document = |kind: &str| {
            let entry = recorded.get(kind)?;
            Some(Document::new(entry.name.as_str(), entry.text.as_str()))
        };
        let mut setup: Setup = match document(kind::SETUP) {
            Some(setup) => setup.parse()?,
            None => Setup::default(),
        };
        change(&mut setup);
        let person = settings.person.map(str::to_owned);
        setup.person = person.or(setup.person);
        let own = settings.permissions;
        let ignored_permissions = own.map_or(Vec::new(), |own| setup.replace_permissions(own));
        let read = |kind: &str, name: &str| {
            let replacement = match kind {
                kind::GLOVE => settings.glove,
                kind::LAYOUT => settings.layout,
                kind::PERSON => settings.person,
                _ => None,
            };
            match (replacement, document(kind)) {
                (Some(other_name), _) => Document::open_kind(file_kind(kind), other_name),
                (None, Some(document)) => Ok(document),
                (None, None) => Document::shipped(name).map_err(|_| not_contained(kind, name)),
            }
        };
        let mut loaded = Self::new(setup, &read)?;
        loaded.has_files = false;
        loaded.load_language(super::text::refuse_model);
        loaded.ignored_permissions = ignored_permissions;
        Ok(loaded)
    }

    /// Returns `true` if a layout is data of a recording, whose name is no path on this machine. A file that replaces the recorded layout
    /// is none.
    pub fn has_recorded_layouts(&self) -> bool {
        let is_file = |layout: &Layout| {
            let mut documents = self.documents.iter();
            let document = documents.find(|(_, document)| document.file == layout.file);
            document.is_some_and(|(_, document)| document.path.is_some())
        };
        !self.has_files && !self.layouts().all(is_file)
    }

    /// Returns the setup and all its files as texts, for a recording.
    pub fn recorded_setup(&self) -> RecordedSetup {
        let setup = ron::ser::to_string_pretty(&self.setup, PrettyConfig::new().struct_names(true))
            .expect("a setup is plain data");
        let recorded = RecordedSetup::default().with(kind::SETUP, "setup", &setup);
        self.documents
            .iter()
            .fold(recorded, |recorded, (kind, document)| {
                recorded.with(kind, &document.file, &document.text)
            })
    }
}

/// Returns the kind of a file, by the kind of its text in a recording.
pub(super) fn file_kind(kind: &str) -> FileKind {
    match kind {
        kind::SETUP => FileKind::Setup,
        kind::GLOVE | kind::OTHER_GLOVE => FileKind::Glove,
        kind::ARM | kind::OTHER_ARM => FileKind::Arm,
        kind::PERSON => FileKind::Person,
        kind::LEARNED => FileKind::Learned,
        _ => FileKind::Layout,
    }
}

fn not_contained(kind: &str, name: &str) -> DocumentError {
    let message = format!(
        "the recording names this {kind} but does not contain it, and no file is opened because a recording names it; name \
         one with --layout or --glove"
    );
    DocumentError::for_file(name, message)
}

impl Setup {
    /// Replaces all permissions by the permissions of `own`. Returns the names of the fields that differ.
    ///
    /// The defaults are the permissions of a source on this machine, whatever source the recording names.
    fn replace_permissions(&mut self, own: &Self) -> Vec<&'static str> {
        let other = self.other_hand.as_ref();
        let other_roles = other.map_or([None; 2], |hand| [hand.role, hand.arm_role]);
        let mut further_roles = other_roles.into_iter().chain([self.arm_role]).flatten();
        let fields = [
            (
                "role",
                self.role != own.role || further_roles.any(|role| Some(role) != own.role),
            ),
            (
                "stall_timeout_ms",
                self.stall_timeout_ms != own.stall_timeout_ms,
            ),
            (
                "arm_immediately",
                self.arm_immediately != own.arm_immediately,
            ),
            (
                "max_presses_per_second",
                self.max_presses_per_second != own.max_presses_per_second,
            ),
            (
                "allow_system_keys",
                self.allow_system_keys != own.allow_system_keys,
            ),
            ("panic_keys", self.panic_keys != own.panic_keys),
        ];
        let permissions = own.permissions(None, own.role);
        let role = Some(permissions.role);
        (self.role, self.arm_role) = (role, role);
        if let Some(other_hand) = &mut self.other_hand {
            // Without a source of its own it has the role of the first source, and a setup that states another one is refused.
            other_hand.role = other_hand.source.as_ref().and(role);
            other_hand.arm_role = role;
        }
        self.max_presses_per_second = Some(permissions.rate_limit.per_second);
        self.stall_timeout_ms = own.stall_timeout_ms;
        self.arm_immediately = own.arm_immediately;
        self.allow_system_keys = own.allow_system_keys;
        self.panic_keys.clone_from(&own.panic_keys);
        // No permission: the monitors of this machine.
        self.desktop_part = own.desktop_part;
        let differing = fields.into_iter().filter(|(_, differs)| *differs);
        differing.map(|(name, _)| name).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::pipeline::{PressRateLimit, SourcePermissions, SourceRole};

    const GREEDY: &str = "Setup(source: \"typist:hello\", role: Both, arm_immediately: true, stall_timeout_ms: 10000, \
                          max_presses_per_second: 1000, allow_system_keys: true, panic_keys: [\"A\"], \
                          other_hand: (source: \"typist:hello\", role: Both))";

    fn load(permissions: Option<&Setup>) -> Result<LoadedSetup, SetupError> {
        load_text(GREEDY, permissions)
    }

    fn load_text(text: &str, permissions: Option<&Setup>) -> Result<LoadedSetup, SetupError> {
        let recorded = RecordedSetup::default().with(kind::SETUP, "setup", text);
        let settings = ReplaySettings {
            permissions,
            ..ReplaySettings::default()
        };
        LoadedSetup::from_recording(&recorded, &settings)
    }

    #[test]
    fn permissions_are_those_of_the_person_and_never_those_of_the_recording() {
        let own = Setup {
            role: Some(SourceRole::Pointer),
            max_presses_per_second: Some(7),
            stall_timeout_ms: 300,
            ..Setup::default()
        };
        let loaded = load(Some(&own)).unwrap();
        let permissions = SourcePermissions {
            role: SourceRole::Pointer,
            rate_limit: PressRateLimit { per_second: 7 },
        };
        let sources: Vec<_> = loaded.sources().map(|(_, source)| source).collect();
        assert_eq!(sources, [permissions, permissions]);
        let setup = &loaded.setup;
        assert_eq!(setup.stall_timeout_ms, 300);
        assert!(!setup.arm_immediately && !setup.allow_system_keys);
        assert_eq!(setup.panic_keys, [""; 0]);
        assert_eq!(
            loaded.ignored_permissions,
            [
                "role",
                "stall_timeout_ms",
                "arm_immediately",
                "max_presses_per_second",
                "allow_system_keys",
                "panic_keys"
            ]
        );
    }

    #[test]
    fn a_replay_with_an_effect_uses_the_part_of_the_desktop_of_this_machine() {
        let text = "Setup(source: \"typist:hello\", desktop_part: (left: 0.5))";
        let part = |own: Option<&Setup>| load_text(text, own).unwrap().setup.desktop_part;
        assert_eq!(part(Some(&Setup::default())), None);
        assert_eq!(part(None).map(|it| it.left), Some(0.5));
    }

    #[test]
    fn both_hands_of_one_source_have_the_permissions_of_the_person() {
        let own = Setup {
            role: Some(SourceRole::Pointer),
            ..Setup::default()
        };
        let text = "Setup(source: \"typist:hello\", role: Both, other_hand: ())";
        let loaded = load_text(text, Some(&own)).unwrap();
        let roles: Vec<_> = loaded.sources().map(|(_, source)| source.role).collect();
        assert_eq!(roles, [SourceRole::Pointer]);
        assert_eq!(loaded.ignored_permissions, ["role"]);
    }

    #[test]
    fn without_a_setup_of_their_own_the_defaults_of_a_local_source_apply() {
        let loaded = load(Some(&Setup::default())).unwrap();
        let (_, permissions) = loaded.sources().next().unwrap();
        assert_eq!(permissions, SourcePermissions::LOCAL);
        assert_eq!(loaded.setup.stall_timeout_ms, 200);
    }

    #[test]
    fn a_replay_without_effect_repeats_the_permissions_of_the_recording() {
        let loaded = load(None).unwrap();
        let (_, permissions) = loaded.sources().next().unwrap();
        assert_eq!(permissions.rate_limit.per_second, 1000);
        assert_eq!(loaded.setup.stall_timeout_ms, 10_000);
        assert_eq!(loaded.ignored_permissions, [""; 0]);
    }
}
