//! The sources of a setup: the hand, or part of a hand, that each measures, and its permissions.

use std::path::Path;

use arrayvec::ArrayVec;

use super::{LoadedSetup, Setup, SetupError};
use crate::capture::recording::Replay;
use crate::capture::{
    self, Hc11Format, MAX_SOURCES, MergedSource, PartialSource, SidedSource, Source, SourceUri,
    StreamUri,
};
use crate::files::OpenDocument;
use crate::network;
use crate::sim::resolve_script;
use ademan_core::document::{Document, FileKind};
use ademan_core::hand::{HandPart, Side};
use ademan_core::message::escape;
use ademan_core::pipeline::{SourcePermissions, SourceRole};

/// A source that the setup names.
#[derive(Clone, Copy, Debug)]
pub struct NamedSource<'a> {
    /// The source.
    pub uri: Option<&'a SourceUri>,
    /// Its own permissions. A hand has the permissions that all of its sources have.
    pub permissions: SourcePermissions,
    /// `true` if the setup states its role.
    pub has_own_role: bool,
    /// The field of the setup, and the flag, that let it press keys.
    pub remedy: &'static str,
}

impl NamedSource<'_> {
    /// Returns what lets it press keys in a session. Commands reach a session only through its control socket.
    pub fn way_to_type(&self, has_control_socket: bool) -> String {
        let command = if has_control_socket {
            ", and `ademan ctl allow-keys` does until the session ends or another sender follows"
        } else {
            ""
        };
        format!("{} lets it type{command}", self.remedy)
    }
}

/// A source of fingers, and the permissions of all sources of its hands.
type HandPermissions<'a> = (
    Option<&'a SourceUri>,
    ArrayVec<SourcePermissions, MAX_SOURCES>,
);

/// A source to open.
struct OpenedPart<'a> {
    uri: &'a SourceUri,
    /// The hands that it measures.
    sides: ArrayVec<Side, { Side::COUNT }>,
    part: Option<HandPart>,
}

impl Setup {
    /// Makes the relative paths of recordings, files of bytes, scripts, tokens, and pages for headsets start in `folder`.
    pub(super) fn start_sources_in(&mut self, folder: &Path) {
        let other = self.other_hand.as_mut();
        let of_other = other.map(|hand| [&mut hand.source, &mut hand.arm_source]);
        let own = [&mut self.source, &mut self.arm_source];
        let sources = own.into_iter().chain(of_other.into_iter().flatten());
        for source in sources.flatten() {
            start_in(folder, source);
        }
    }
}

fn start_in(folder: &Path, source: &mut SourceUri) {
    match source {
        SourceUri::Recording { path } => *path = folder.join(path.as_path()),
        SourceUri::Stream(stream) => start_stream_in(folder, stream),
        SourceUri::Script { script } => *script = resolve_script(folder, script),
        SourceUri::Typist { .. } => {}
    }
}

fn start_stream_in(folder: &Path, stream: &mut StreamUri) {
    let start = |path: &mut String| *path = folder.join(&*path).to_string_lossy().into_owned();
    if stream.transport.scheme.name == "file" {
        start(&mut stream.address);
    }
    // A token without a folder is one of the network folder.
    if let Some(file) = &mut stream.token_file
        && network::token_path(file).is_ok_and(|path| path == Path::new(file))
    {
        start(file);
    }
    if let Some(pages) = &mut stream.pages {
        start(&mut pages.folder);
        if let Some(name) = &mut pages.layout {
            // The server of the page reports a layout that does not exist.
            *name =
                Document::resolve(folder, FileKind::Layout, name).unwrap_or_else(|_| name.clone());
        }
    }
}

/// The packet period of a recording, on which the stall timeout depends.
#[derive(Clone, Copy)]
enum PacketPeriod {
    Recorded,
    Unknown,
}

impl LoadedSetup {
    /// Returns all sources, at most four: the first source, the source of its arm, and the two sources of the other hand.
    pub fn named_sources(&self) -> impl Iterator<Item = NamedSource<'_>> {
        let setup = &self.setup;
        let named = |uri, role: Option<SourceRole>, remedy| NamedSource {
            uri,
            permissions: setup.permissions(uri, role),
            has_own_role: role.is_some(),
            remedy,
        };
        let first = named(
            setup.source.as_ref(),
            setup.role,
            "`role: Both` next to this source in the setup or `--role both`",
        );
        let arm_remedy = "`arm_role: Both` next to this source in the setup or `--arm-role both`";
        let arm = setup.arm_source.as_ref();
        let arm = arm.map(|uri| named(Some(uri), setup.arm_role, arm_remedy));
        let other = setup.other_hand.iter().flat_map(move |hand| {
            let source = hand.source.as_ref();
            let remedy = "`role: Both` next to this source in the setup";
            let source = source.map(|uri| named(Some(uri), hand.role, remedy));
            let other_arm = hand.arm_source.as_ref();
            let other_arm_remedy = "`arm_role: Both` next to this source in the setup";
            let other_arm = other_arm.map(|uri| named(Some(uri), hand.arm_role, other_arm_remedy));
            source.into_iter().chain(other_arm)
        });
        std::iter::once(first).chain(arm).chain(other)
    }

    /// Returns the sources of fingers with the permissions of their hands: the first source, then the source of the other
    /// hand if it has one. A hand may cause only what the source of its arm may cause too.
    pub fn sources(&self) -> impl Iterator<Item = (Option<&SourceUri>, SourcePermissions)> {
        let sources = self.permissions_of_hands().into_iter();
        sources.filter_map(|(source, permissions)| {
            let combined = permissions.into_iter().reduce(SourcePermissions::and)?;
            Some((source, combined))
        })
    }

    /// Returns the sources of fingers, each with its own permissions and the permissions of the arms of its hands.
    fn permissions_of_hands(&self) -> ArrayVec<HandPermissions<'_>, { Side::COUNT }> {
        let setup = &self.setup;
        let own = setup.permissions(setup.source.as_ref(), setup.role);
        let own_arm = setup.arm_source.as_ref();
        let own_arm = own_arm.map(|arm| setup.permissions(Some(arm), setup.arm_role));
        let mut first: ArrayVec<_, MAX_SOURCES> = [own].into_iter().chain(own_arm).collect();
        let mut second: Option<HandPermissions<'_>> = None;
        if let Some(other) = &setup.other_hand {
            let arm = match (&other.arm_source, self.other_arm_source()) {
                (Some(arm), _) => Some(setup.permissions(Some(arm), other.arm_role)),
                (None, Some(arm)) => Some(setup.permissions(Some(arm), setup.arm_role)),
                (None, None) => None,
            };
            match &other.source {
                Some(source) => {
                    let fingers = setup.permissions(Some(source), other.role);
                    second = Some((Some(source), [fingers].into_iter().chain(arm).collect()));
                }
                None => first.extend(arm),
            }
        }
        [(setup.source.as_ref(), first)]
            .into_iter()
            .chain(second)
            .collect()
    }

    /// Checks that the roles of the sources of each hand permit anything together.
    pub(super) fn check_roles(&self) -> Result<(), SetupError> {
        let are_exclusive = |(_, permissions): &HandPermissions<'_>| {
            let has = |role| permissions.iter().any(|source| source.role == role);
            has(SourceRole::Keys) && has(SourceRole::Pointer)
        };
        if self.permissions_of_hands().iter().any(are_exclusive) {
            let message = "`role: Keys` of one source and the role `Pointer` of another one permit nothing together; a \
                           source on the network has the role `Pointer` unless the setup says otherwise: set `arm_role: Keys`";
            return Err(SetupError::Value(message.into()));
        }
        Ok(())
    }

    /// Checks that a hand has only one source if that source measures both the arm and the fingers.
    pub(super) fn check_parts(&self) -> Result<(), SetupError> {
        let setup = &self.setup;
        let other = setup.other_hand.as_ref();
        let has_parts = |source: &&SourceUri| source.has_parts();
        let arms = [&setup.arm_source]
            .into_iter()
            .chain(other.map(|hand| &hand.arm_source));
        let mut arms = arms.flatten().peekable();
        let sources = [&setup.source]
            .into_iter()
            .chain(other.map(|hand| &hand.source));
        let whole = sources.flatten().find(has_parts);
        match arms.peek().and(whole).or_else(|| arms.find(has_parts)) {
            None => Ok(()),
            Some(source) => Err(SetupError::Value(format!(
                "`arm_source`: {} measures the arm and the fingers; remove `arm_source`, or use `body-landmarks` and \
                 `hand-landmarks`, which ignore the rest of such a line",
                escape(&source.to_string())
            ))),
        }
    }

    /// Checks that no two sources need the same port.
    pub(super) fn check_ports(&self) -> Result<(), SetupError> {
        let uris: Vec<&SourceUri> = self.setup.source_uris().collect();
        let mut pairs = uris.iter().enumerate();
        let second = pairs.find(|(index, uri)| uris[..*index].iter().any(|it| it.excludes(uri)));
        let Some((_, uri)) = second else {
            return Ok(());
        };
        let remedy = if uri.has_both_hands() {
            "name it once, as it shows both hands"
        } else {
            "give each source a port of its own"
        };
        Err(SetupError::Value(format!(
            "two sources of the setup have one port, which only one can open: {}; {remedy}",
            escape(&uri.to_string())
        )))
    }

    /// Returns the source of the other hand's arm: its own, or the arm source of the first hand if it shows both arms.
    pub(super) fn other_arm_source(&self) -> Option<&SourceUri> {
        let own = self.setup.other_hand.as_ref()?.arm_source.as_ref();
        let first = self.setup.arm_source.as_ref();
        own.or(first.filter(|source| source.has_both_hands()))
    }

    /// Opens a source, merged with all others of the setup.
    pub fn open_source(&self, source: &SourceUri) -> Result<Box<dyn Source>, SetupError> {
        self.open_merged_source(source, PacketPeriod::Recorded)
    }

    /// Opens a source as [`open_source`](Self::open_source) does, for the outputs of the setup: a recording does not raise its
    /// stall timeout.
    pub fn open_source_for_outputs(
        &self,
        source: &SourceUri,
    ) -> Result<Box<dyn Source>, SetupError> {
        self.open_merged_source(source, PacketPeriod::Unknown)
    }

    fn open_merged_source(
        &self,
        source: &SourceUri,
        period: PacketPeriod,
    ) -> Result<Box<dyn Source>, SetupError> {
        self.check_channels_of_two_gloves(source)?;
        let mut parts = self.parts(source);
        if parts.len() == 1 {
            let part = parts.remove(0);
            return self.open_single_source(part.uri, part.sides, period);
        }
        let mut sources = ArrayVec::new();
        for OpenedPart { uri, sides, part } in parts {
            let side = match sides.as_slice() {
                [side] => Some(*side),
                _ => None,
            };
            sources.push(PartialSource {
                source: self.open_single_source(uri, sides, period)?,
                side,
                part,
                delay: uri.delay(),
            });
        }
        Ok(Box::new(MergedSource::start(sources)?))
    }

    /// Checks that two gloves on one source have channels of their own: otherwise one hand would move the other.
    fn check_channels_of_two_gloves(&self, source: &SourceUri) -> Result<(), SetupError> {
        let is_shared = matches!(&self.setup.other_hand, Some(other) if other.source.is_none());
        let other = self.other_hand.as_ref();
        let gloves = self
            .glove
            .as_ref()
            .zip(other.and_then(|hand| hand.glove.as_ref()));
        let is_stream = matches!(source, SourceUri::Stream(_)) && source.needs_glove();
        let Some((first, second)) = gloves.filter(|_| is_shared && is_stream) else {
            return Ok(());
        };
        let mut channels = first.map.channels();
        match channels.find(|channel| second.map.channels().any(|it| it == *channel)) {
            None => Ok(()),
            Some(channel) => Err(SetupError::Value(format!(
                "`other_hand` has no `source`, and both gloves have channel {channel} of the first one, so that one hand would move the \
                 other; set the `source` of the other hand, or name a `glove` there with channels of its own"
            ))),
        }
    }

    /// Opens a source for the first hand, without the others of the setup.
    pub fn open_source_alone(&self, source: &SourceUri) -> Result<Box<dyn Source>, SetupError> {
        self.open_single_source(source, [self.arm.side()], PacketPeriod::Recorded)
    }

    /// Returns the sources with the parts that they measure. `first` replaces the first source of the setup.
    fn parts<'a>(&'a self, first: &'a SourceUri) -> ArrayVec<OpenedPart<'a>, MAX_SOURCES> {
        let setup = &self.setup;
        let other = setup.other_hand.as_ref().zip(self.other_hand.as_ref());
        let second_source = other.and_then(|(hand, _)| hand.source.as_ref());
        let second_arm = other.and_then(|(hand, _)| hand.arm_source.as_ref());
        let first_side = self.arm.side();
        let second_side = other.map(|(_, hand)| hand.arm.side());
        let fingers = |arm: Option<&SourceUri>| arm.map(|_| HandPart::Fingers);
        let mut parts = ArrayVec::new();
        let mut add = |uri, sides: [Option<Side>; Side::COUNT], part| {
            let sides = sides.into_iter().flatten().collect();
            parts.push(OpenedPart { uri, sides, part });
        };
        let shared = second_side.filter(|_| second_source.is_none());
        let part = fingers(setup.arm_source.as_ref()).or(fingers(
            self.other_arm_source().filter(|_| shared.is_some()),
        ));
        add(first, [Some(first_side), shared], part);
        if let Some(arm) = &setup.arm_source {
            let both = second_side.filter(|_| second_arm.is_none() && arm.has_both_hands());
            add(arm, [Some(first_side), both], Some(HandPart::Arm));
        }
        if let Some(source) = second_source {
            add(
                source,
                [second_side, None],
                fingers(self.other_arm_source()),
            );
        }
        if let Some(arm) = second_arm {
            add(arm, [second_side, None], Some(HandPart::Arm));
        }
        parts
    }

    /// Opens a source that measures the hands of these sides.
    fn open_single_source(
        &self,
        source: &SourceUri,
        sides: impl IntoIterator<Item = Side>,
        period: PacketPeriod,
    ) -> Result<Box<dyn Source>, SetupError> {
        let line = Hc11Format::default();
        Ok(match source {
            SourceUri::Recording { path } => {
                // The setup has the permissions.
                let replay = Replay::open(path)?.without_permissions();
                Box::new(match period {
                    PacketPeriod::Recorded => replay,
                    PacketPeriod::Unknown => replay.without_packet_period(),
                })
            }
            // The simulated person has all hands of the setup, also where another source measures one of them.
            SourceUri::Typist { text, format } => {
                let stream: Box<dyn Source> = match format {
                    None => Box::new(self.typist(text, &line, 0.0, 0)?),
                    Some(format) => Box::new(self.encoded_typist(text, format, 0.0, 0)?),
                };
                Box::new(SidedSource::new(stream, sides))
            }
            SourceUri::Script { script } => {
                let stream = Box::new(self.scripted(script, &line, 0.0, 0)?);
                Box::new(SidedSource::new(stream, sides))
            }
            SourceUri::Stream(stream) => {
                let sides: ArrayVec<Side, { Side::COUNT }> = sides.into_iter().collect();
                let mut opened = capture::open(&SourceUri::Stream(stream.for_sides(&sides)))?;
                opened.set_max_age(self.pipeline.stall_timeout);
                let has_two_gloves = source.needs_glove() && sides.len() > 1;
                if source.has_both_hands() {
                    Box::new(SidedSource::new(opened, sides))
                } else if has_two_gloves {
                    Box::new(SidedSource::with_two_gloves(opened, sides))
                } else {
                    opened
                }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_lets_a_source_type_only_through_a_control_socket() {
        let setup = Setup::default().load_files().unwrap();
        let source = setup.named_sources().next().unwrap();
        for has_control_socket in [false, true] {
            let way = source.way_to_type(has_control_socket);
            assert!(way.contains("`--role both`"), "{way}");
            assert_eq!(way.contains("`ademan ctl"), has_control_socket, "{way}");
        }
    }

    #[test]
    fn relative_paths_of_sources_start_in_the_folder_of_the_setup() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("desk & hand");
        std::fs::create_dir(&folder).unwrap();
        let path = folder.join("setup.ron");
        std::fs::write(folder.join("lift.txt"), "lift").unwrap();
        let there = |name: &str| folder.join(name).to_string_lossy().into_owned();
        let in_option = |name: &str| there(name).replace('&', "%26");
        for (written, expected) in [
            (
                "recording:days/one.mcap",
                format!("recording:{}", there("days/one.mcap")),
            ),
            (
                "file:hand.bvh?protocol=bvh",
                format!("file:{}?protocol=bvh", there("hand.bvh")),
            ),
            (
                "headset:192.168.1.7:8443?page=web&layout=numpad",
                format!(
                    "headset:192.168.1.7:8443?page={}&layout=numpad",
                    in_option("web")
                ),
            ),
            (
                "tcp+tls:desk:8443?token_file=./desk.token",
                format!("tcp+tls:desk:8443?token_file={}", in_option("./desk.token")),
            ),
            (
                "tcp+tls:desk:8443?token_file=desk.token",
                "tcp+tls:desk:8443?token_file=desk.token".into(),
            ),
            ("script:wave", format!("script:{}", there("wave"))),
            ("script:lift.txt", format!("script:{}", there("lift.txt"))),
            (
                "recording:/days/one.mcap",
                "recording:/days/one.mcap".into(),
            ),
            ("script:tap A; lift", "script:tap A; lift".into()),
            ("script:lift", "script:lift".into()),
            ("typist:one.mcap", "typist:one.mcap".into()),
        ] {
            let text = format!(
                "Setup(source: {written:?}, other_hand: (source: {written:?}), arm_source: {written:?})"
            );
            std::fs::write(&path, text).unwrap();
            let setup = Setup::load(path.to_str().unwrap()).unwrap();
            let sources: Vec<SourceUri> = setup.source_uris().cloned().collect();
            let expected: SourceUri = expected.parse().unwrap();
            assert_eq!(sources, [expected.clone(), expected.clone(), expected]);
        }
    }
}
