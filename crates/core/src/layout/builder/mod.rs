//! Builds a checked layout: resolves names, places faces on boards, and reports what does not fit together at its position.
//!
//! The builder does not know the kinds of keys and controls. Their schemas, in [`keys`](super::keys) and
//! [`controls`](super::controls), add themselves.

mod actions;
mod board;
mod values;

pub(super) use board::{BoardSettings, FaceSpec, SHARE_BESIDE_BOARDS};

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use self::board::BoardDraft;
use super::draft::LayoutDraft;
use super::fit::{Fit, PoseFit};
use super::model::{
    BASE_LAYER, Board, Control, ControlKind, Key, Layout, MAX_LAYERS, MAX_TARGETS, SpaceTargets,
};
use super::schema::PoseSchema;
use super::shape::Shape;
use crate::command::TextMode;
use crate::contact::TargetId;
use crate::contact::surface::Scene;
use crate::device::keyboard::Chord;
use crate::device::pointer::PointerSettings;
use crate::device::signals::{MidiKind, Signal, Signals};
use crate::device::trigger::Trigger;
use crate::device::{Axis, KeyCode, Multitap, Multitaps, Sequence};
use crate::document::{Document, DocumentError, DocumentFault, Spanned, byte_offset, line_number};
use crate::hand::Side;
use crate::names::UnknownName;

/// A layout that is being built. Its parts are added to the public lists; names, targets and errors have methods.
pub(super) struct LayoutBuilder<'a> {
    pub document: &'a Document,
    /// The name of the layout, also for errors about the layout as a whole.
    pub name: Spanned<'a>,
    fit: Fit,
    pub scene: Scene,
    boards: Vec<Board>,
    pub keys: Vec<Key>,
    pub controls: Vec<Control>,
    /// The layers that were declared, base layer first.
    pub layers: Vec<String>,
    /// Indices of the layers that an action activates.
    activated_layers: BTreeSet<usize>,
    texts: Vec<String>,
    /// The sequences. There are few, so that their indices fit a [`SequenceId`](crate::device::SequenceId).
    pub sequences: Vec<Sequence>,
    multitaps: Vec<Multitap>,
    profiles: Vec<String>,
    pub chords: Vec<Chord>,
    pub triggers: Vec<(String, Trigger)>,
    /// The shapes of triggers.
    pub shapes: Vec<(TargetId, Shape)>,
    pub pointer: Option<PointerSettings>,
    pub spaces: Vec<SpaceTargets>,
    pub signals: Vec<(TargetId, Signal)>,
    has_text_commands: bool,
    /// The board that faces are added to.
    board: BoardDraft<'a>,
    /// Index in `keys` by name.
    key_indices: BTreeMap<&'a str, usize>,
    /// The axes that controls set, with the position of the name in the file.
    axes: Vec<(Axis, Spanned<'a>)>,
    /// Kind of the target with a name, and its position in the file.
    targets: BTreeMap<Cow<'a, str>, NamedTarget<'a>>,
    /// The positions of all targets in the file, by id: slices of the document.
    sources: Vec<&'a str>,
    /// The targets with errors that are reported, by the position of the error.
    faulty: Vec<(DocumentFault, Vec<TargetId>)>,
    /// The errors so far.
    errors: DocumentError,
    /// Number of parts with an error.
    failed: usize,
    /// Names of keys with an error, which are not in `key_indices`.
    failed_keys: BTreeSet<&'a str>,
}

/// The number of parts with an error at which the layout is given up. Each error searches the text for its line.
const MAX_FAILED: usize = 200;

#[derive(Clone, Copy)]
struct NamedTarget<'a> {
    /// The kind in messages: "key", "slider".
    kind: &'static str,
    /// Slice of the document.
    source: &'a str,
    target: TargetId,
}

impl<'a> LayoutBuilder<'a> {
    /// Starts a layout with this name for these hands.
    pub fn new(document: &'a Document, name: Spanned<'a>, fit: Fit) -> Self {
        Self {
            document,
            name,
            fit,
            scene: Scene::new(),
            boards: Vec::new(),
            keys: Vec::new(),
            controls: Vec::new(),
            layers: vec![BASE_LAYER.to_owned()],
            activated_layers: BTreeSet::from([0]),
            texts: Vec::new(),
            sequences: Vec::new(),
            multitaps: Vec::new(),
            profiles: Vec::new(),
            chords: Vec::new(),
            triggers: Vec::new(),
            shapes: Vec::new(),
            pointer: None,
            spaces: Vec::new(),
            signals: Vec::new(),
            has_text_commands: false,
            board: BoardDraft::default(),
            key_indices: BTreeMap::new(),
            axes: Vec::new(),
            targets: BTreeMap::new(),
            sources: Vec::new(),
            faulty: Vec::new(),
            errors: DocumentError::none(&document.file),
            failed: 0,
            failed_keys: BTreeSet::new(),
        }
    }

    /// Keeps the error of a part, so that the next part can be built. Fails if too many have failed.
    pub fn collect(&mut self, built: Result<(), DocumentError>) -> Result<(), DocumentError> {
        let Err(error) = built else {
            return Ok(());
        };
        self.errors.add(error);
        self.failed += 1;
        if self.failed < MAX_FAILED {
            Ok(())
        } else {
            Err(self.consequence())
        }
    }

    /// Keeps the error of a value of a part that is built without it. Fails as [`collect`](Self::collect).
    pub fn keep_error<T>(
        &mut self,
        value: Result<T, DocumentError>,
    ) -> Result<Option<T>, DocumentError> {
        match value {
            Ok(value) => Ok(Some(value)),
            Err(error) => self.collect(Err(error)).map(|()| None),
        }
    }

    /// Adds an error of targets that are built all the same, so that they can be drawn and edited.
    pub fn report(&mut self, error: DocumentError, targets: &[TargetId]) {
        let faults = error.errors().iter().cloned();
        self.faulty
            .extend(faults.map(|fault| (fault, targets.to_vec())));
        self.errors.add(error);
    }

    /// Keeps the error of the key with this name as [`collect`](Self::collect) does. Layers and chords may name the key.
    pub fn collect_key(
        &mut self,
        name: &'a str,
        built: Result<(), DocumentError>,
    ) -> Result<(), DocumentError> {
        if built.is_err() {
            self.failed_keys.insert(name);
        }
        self.collect(built)
    }

    /// Returns the number of parts that have failed. What is missing after a failure may be in such a part.
    pub fn failed(&self) -> usize {
        self.failed
    }

    /// Returns the error of a part that fails because of another one.
    pub fn consequence(&self) -> DocumentError {
        DocumentError::none(&self.document.file)
    }

    /// Completes the layout with its errors. `built` is the outcome of its last part.
    pub fn finish(
        mut self,
        built: Result<(), DocumentError>,
        description: Option<Spanned>,
        chord_timeout: Duration,
        multitap_timeout: Duration,
        text_mode: Option<TextMode>,
    ) -> LayoutDraft {
        if let Err(error) = built {
            self.errors.add(error);
        }
        let offset = |source: &&str| byte_offset(&self.document.text, source).unwrap_or(0);
        let range = |source: &&str| offset(source)..offset(source) + source.len();
        let sources = self.sources.iter().map(range).collect();
        let (errors, faulty) = (self.errors.in_order(), self.faulty);
        let one_line = |text: Spanned| text.text.split_whitespace().collect::<Vec<_>>().join(" ");
        let layers = self.layers.iter().enumerate();
        let idle_layers = layers.filter(|(index, _)| !self.activated_layers.contains(index));
        let idle_layers = idle_layers.map(|(_, name)| name.clone()).collect();
        let layout = Layout {
            name: one_line(self.name),
            description: description.map_or(String::new(), one_line),
            file: self.document.file.clone(),
            text: self.document.text.clone(),
            fit: self.fit,
            scene: self.scene,
            boards: self.boards,
            keys: self.keys,
            controls: self.controls,
            layers: self.layers,
            idle_layers,
            profiles: self.profiles,
            texts: self.texts,
            sequences: self.sequences,
            multitaps: Multitaps {
                keys: self.multitaps,
                timeout: multitap_timeout,
            },
            chords: self.chords,
            chord_timeout,
            triggers: self.triggers,
            shapes: self.shapes,
            pointer: self.pointer,
            spaces: self.spaces,
            signals: Signals::new(self.signals),
            text_mode,
            has_text_commands: self.has_text_commands,
        };
        LayoutDraft::new(layout, errors, faulty, sources)
    }

    /// Returns an error at `source`, a slice of the document.
    pub fn error(&self, source: &str, message: impl std::fmt::Display) -> DocumentError {
        self.document.error_at(source, message)
    }

    /// Returns the fit of a board or volume that is reserved for a hand, if any.
    pub fn pose_fit(&self, pose: &PoseSchema, side: Option<Side>) -> PoseFit {
        self.fit.of(pose, side)
    }

    /// Records that a control sets an axis, and reports a second one. Two controls would overwrite each other's position.
    pub fn claim_axis(&mut self, axis: Axis, name: Spanned<'a>) {
        if let Some((_, first)) = self.axes.iter().find(|(other, _)| *other == axis) {
            let line = line_number(&self.document.text, first.text);
            let message =
                format!("the control in line {line} sets the axis `{axis}` too, name another axis");
            let error = self.error(name.text, message);
            self.report(error, &[]);
            return;
        }
        self.axes.push((axis, name));
    }

    /// Adds a layer, so that actions can name it.
    pub fn declare_layer(&mut self, name: Spanned<'a>) -> Result<(), DocumentError> {
        let name = name.text;
        if name == BASE_LAYER {
            let message = "`base` is the layer without a name, choose another name";
            return Err(self.error(name, message));
        }
        if self.layers.iter().any(|layer| layer == name) {
            return Err(self.error(name, format!("duplicate layer `{name}`")));
        }
        if self.layers.len() == MAX_LAYERS {
            let message = format!("a layout has at most {} layers", MAX_LAYERS - 1);
            return Err(self.error(name, message));
        }
        self.layers.push(name.to_owned());
        Ok(())
    }

    /// Adds a key to the current board. Its face was added under `name`.
    pub fn add_key(&mut self, name: &'a str, key: Key) {
        // The first of several keys with this name, of which the others are reported.
        self.key_indices.entry(name).or_insert(self.keys.len());
        self.keys.push(key);
    }

    /// Returns the index of the key with this name. Every spelling of a key code is accepted.
    pub fn key_index(&self, name: &str) -> Result<usize, DocumentError> {
        let code = name.parse().map_or(name, |key: KeyCode| key.name());
        let find = |spelling: &str| self.key_indices.get(spelling).copied();
        find(name).or_else(|| find(code)).ok_or_else(|| {
            if [name, code]
                .iter()
                .any(|name| self.failed_keys.contains(name))
            {
                return self.consequence();
            }
            let error = UnknownName::new("key", name, self.key_indices.keys().copied());
            self.error(name, format!("this layout has no such key: {error}"))
        })
    }

    /// Returns `true` if there is a key with this name.
    pub fn has_key(&self, name: &str) -> bool {
        self.key_index(name).is_ok()
    }

    /// Returns the target with this name, and its kind. Every spelling of a key code is accepted.
    pub fn target(&self, name: &str) -> Result<(TargetId, &'static str), DocumentError> {
        if let Some(named) = self.targets.get(name) {
            return Ok((named.target, named.kind));
        }
        if let Ok(index) = self.key_index(name) {
            return Ok((self.keys[index].face.target, "key"));
        }
        if self.failed > 0 {
            return Err(self.consequence());
        }
        let error = UnknownName::new("control", name, self.targets.keys().map(|known| &**known));
        Err(self.error(name, format!("this layout has no such control: {error}")))
    }

    /// Adds the signal of a target. A key with one reports what the signal sends.
    pub fn add_signal(
        &mut self,
        name: Spanned<'a>,
        target: TargetId,
        signal: Signal,
    ) -> Result<(), DocumentError> {
        if self.signals.iter().any(|(other, _)| *other == target) {
            let message = format!("duplicate signal of `{}`", name.text);
            return Err(self.error(name.text, message));
        }
        if let Some(key) = self.keys.iter_mut().find(|key| key.face.target == target) {
            let is_control = matches!(signal.midi, Some(MidiKind::Control(_)));
            key.reports_velocity = signal.address.is_some() || !is_control;
            key.reports_depth |= is_control;
        }
        self.signals.push((target, signal));
        Ok(())
    }

    /// Sets the label of the key with this name.
    pub fn set_label(&mut self, name: &str, label: &str) -> Result<(), DocumentError> {
        let index = self.key_index(name)?;
        label.clone_into(&mut self.keys[index].face.label);
        Ok(())
    }

    /// Returns the position of a key in the file.
    pub fn key_source(&self, key: &Key) -> &'a str {
        let source = self.sources.get(key.face.target.0 as usize);
        source.copied().unwrap_or(self.name.text)
    }

    /// Adds a control with one face to the current board. `kind` gets the target of the face.
    pub fn add_single_face(
        &mut self,
        spec: FaceSpec<'a>,
        kind: impl FnOnce(TargetId) -> ControlKind,
    ) -> Result<(), DocumentError> {
        let face = self.add_face(spec)?;
        let kind = kind(face.target);
        let faces = vec![face];
        self.controls.push(Control { faces, kind });
        Ok(())
    }

    /// Registers a target, and returns its id. Reports a name that is taken.
    pub fn add_target(
        &mut self,
        kind: &'static str,
        name: &'a str,
        source: &'a str,
    ) -> Result<TargetId, DocumentError> {
        let index = self.sources.len();
        if index == MAX_TARGETS {
            let message = format!("a layout has at most {MAX_TARGETS} keys and other controls");
            return Err(self.error(source, message));
        }
        let id = TargetId(index as u32);
        self.sources.push(source);
        if let Some(other) = self.targets.get(name) {
            let line = line_number(&self.document.text, other.source);
            let remedy = if self.is_in_list(source) {
                "list it in `keys` with another `name`"
            } else {
                "set another `name`"
            };
            let message = format!(
                "duplicate name `{name}`: there is a {} with this name in line {line}, {remedy}",
                other.kind
            );
            let error = self.error(source, message);
            self.report(error, &[id]);
            return Ok(id);
        }
        self.targets.insert(
            name.into(),
            NamedTarget {
                kind,
                source,
                target: id,
            },
        );
        Ok(id)
    }

    /// Returns `true` if `source` is one of several names in one text, such as the keys of a row.
    fn is_in_list(&self, source: &str) -> bool {
        let text = &self.document.text;
        byte_offset(text, source).is_some_and(|start| {
            let (before, after) = (&text[..start], &text[start + source.len()..]);
            !before.ends_with('"') || !after.starts_with('"')
        })
    }
}
