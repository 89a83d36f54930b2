//! A keyboard layout as written → [`Layout`]: names are looked up, boards are laid out in space, and
//! what does not fit together is refused at its place.

mod chords;
mod fires;
mod keys;
mod pointing;

use std::collections::BTreeMap;
use std::time::Duration;

use parry3d::math::Vec2;

use super::controls::Control;
use super::controls::space::SpaceTargets;
use super::model::{BASE_LAYER, Board, Face, Key, Layout, MAX_LAYERS, MAX_TARGETS, metres};
use super::outline::{Outline, first_overlap};
use super::placement::{self, BoardShape, Stance};
use super::ranged::{Distance, PressShare, ReleaseShare, Travel};
use super::schema::{self, Form};
use super::text::Spanned;
use crate::contact::TargetId;
use crate::contact::surface::{Scene, Target};
use crate::device::KeyCode;
use crate::device::keyboard::Chord;
use crate::device::pointer::PointerSettings;
use crate::device::trigger::Trigger;
use crate::document::Document;
use crate::document::{DocumentError, line_number};
use crate::names::UnknownName;

/// Reads and checks a document.
pub(super) fn layout(document: Document) -> Result<Layout, DocumentError> {
    let written: schema::Layout = document.parse()?;
    let Checked {
        scene,
        boards,
        keys,
        controls,
        layers,
        texts,
        profiles,
        chords,
        triggers,
        pointer,
        spaces,
        ..
    } = Checked::of(&document, &written)?;
    Ok(Layout {
        name: one_line(written.name),
        description: written.note.map_or(String::new(), one_line),
        scene,
        boards,
        keys,
        controls,
        layers,
        texts,
        profiles,
        chords,
        chord_timeout: milliseconds(written.chord_ms.get()),
        triggers,
        pointer,
        spaces,
        file: document.file.clone(),
        text: document.text.clone(),
    })
}

fn one_line(word: Spanned) -> String {
    word.0.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What has been checked so far.
pub(super) struct Checked<'a> {
    pub(super) document: &'a Document,
    /// The layout's name.
    name: Spanned<'a>,
    pub(super) scene: Scene,
    boards: Vec<Board>,
    keys: Vec<Key>,
    pub(super) controls: Vec<Control>,
    layers: Vec<String>,
    texts: Vec<String>,
    profiles: Vec<String>,
    chords: Vec<Chord>,
    pub(super) triggers: Vec<(String, Trigger)>,
    pointer: Option<PointerSettings>,
    spaces: Vec<SpaceTargets>,
    /// Name of a key → its place in `keys`.
    places: BTreeMap<&'a str, usize>,
    /// Name of a front → of what kind it is, and where it stands in the file.
    pub(super) names: BTreeMap<&'a str, (&'static str, &'a str)>,
    /// The targets of the board that is being added.
    targets: Vec<Target>,
    /// How many times as large what is on it is.
    scale: f32,
    /// Its fronts that are in its plane: where each is, of what kind, its name, and where it stands in the file.
    placed: Vec<(Outline, &'static str, &'a str, &'a str)>,
}

/// A front before it has its place on its board.
pub(super) struct Spot<'a> {
    /// What kind of control it is, for messages.
    pub what: &'static str,
    /// Where it stands in the file.
    pub word: Spanned<'a>,
    pub name: &'a str,
    pub label: String,
    pub at: Vec2,
    /// How far it is turned in the plane of the board, in radians, counter-clockwise.
    pub turn: f32,
    pub size: schema::Outline,
    pub travel: Travel,
    pub press: PressShare,
    pub release: ReleaseShare,
    /// See [`Target::margin`].
    pub margin: f32,
}

impl<'a> Checked<'a> {
    fn of(document: &'a Document, written: &schema::Layout<'a>) -> Result<Self, DocumentError> {
        let mut checked = Self {
            document,
            name: written.name,
            scene: Scene::new(),
            boards: Vec::new(),
            keys: Vec::new(),
            controls: Vec::new(),
            layers: vec![BASE_LAYER.to_owned()],
            texts: Vec::new(),
            profiles: Vec::new(),
            chords: Vec::new(),
            triggers: Vec::new(),
            pointer: None,
            spaces: Vec::new(),
            places: BTreeMap::new(),
            names: BTreeMap::new(),
            targets: Vec::new(),
            scale: 1.0,
            placed: Vec::new(),
        };
        for layer in &written.layers {
            checked.name_layer(layer.name)?;
        }
        for board in &written.boards {
            checked.add_board(board)?;
            if checked
                .boards
                .last()
                .is_some_and(|board| board.keys.is_empty() && board.controls.is_empty())
            {
                let message = format!("board {} has no keys", checked.boards.len());
                return Err(document.error_at(written.name.0, message));
            }
        }
        let is_empty = written.pointer.is_none() && written.spaces.is_empty();
        if checked.boards.is_empty() && is_empty {
            return Err(document.error_at(written.name.0, "the layout has no keys"));
        }
        for (name, label) in &written.labels.0 {
            let place = checked.place_of(*name)?;
            checked.keys[place].face.label.clone_from(&label.0);
        }
        for (place, layer) in written.layers.iter().enumerate() {
            checked.fill_layer(place + 1, layer)?;
        }
        for chord in &written.chords {
            checked.add_chord(chord)?;
        }
        checked.refuse_idle_keys()?;
        for trigger in &written.triggers {
            checked.add_trigger(trigger)?;
        }
        checked.add_pointer_and_spaces(written)?;
        Ok(checked)
    }

    fn name_layer(&mut self, name: Spanned<'a>) -> Result<(), DocumentError> {
        if name.0 == BASE_LAYER {
            let message = "`base` is what the keys do without a layer, name this one otherwise";
            return Err(self.document.error_at(name.0, message));
        }
        if self.layers.iter().any(|layer| layer == name.0) {
            let message = format!("the layer `{}` is here for the second time", name.0);
            return Err(self.document.error_at(name.0, message));
        }
        if self.layers.len() == MAX_LAYERS {
            let message = format!("a layout has at most {} layers", MAX_LAYERS - 1);
            return Err(self.document.error_at(name.0, message));
        }
        self.layers.push(name.0.to_owned());
        Ok(())
    }

    fn add_board(&mut self, board: &schema::Board<'a>) -> Result<(), DocumentError> {
        self.scale = board.place.scale.get() as f32;
        let mut drafts = Vec::new();
        for row in &board.rows {
            self.draft_row(board, row, &mut drafts)?;
        }
        for key in &board.keys {
            drafts.push(self.draft_key(board, key)?);
        }
        let (first_key, first_control) = (self.keys.len(), self.controls.len());
        for draft in drafts {
            self.add_key(&board.form, draft)?;
        }
        for toggle in &board.toggles {
            self.add_toggle(board, toggle)?;
        }
        for radio in &board.radios {
            self.add_radio(board, radio)?;
        }
        for surface in &board.touch_surfaces {
            self.add_touch_surface(board, surface)?;
        }
        for slider in &board.sliders {
            self.add_slider(board, slider)?;
        }
        for knob in &board.knobs {
            self.add_knob(board, knob)?;
        }
        for lever in &board.levers {
            self.add_lever(board, lever)?;
        }
        for valve in &board.valves {
            self.add_valve(board, valve)?;
        }
        for joystick in &board.joysticks {
            self.add_joystick(board, joystick)?;
        }
        self.refuse_overlaps()?;
        self.scene.add_surface_for(
            board.hand,
            placement::anchor(board.place.anchor),
            placement::anchor_from_board(board),
            std::mem::take(&mut self.targets),
        );
        self.placed.clear();
        self.boards.push(Board {
            keys: first_key..self.keys.len(),
            controls: first_control..self.controls.len(),
            pitch: metres(board.pitch_mm.get()) * self.scale,
            shape: BoardShape::of(&board.form),
            auto_recenter: board.drift.as_ref().map(placement::drift),
        });
        Ok(())
    }

    /// Puts a front on the board that is being added.
    pub(in crate::layout) fn put(
        &mut self,
        form: &Form,
        spot: Spot<'a>,
    ) -> Result<Face, DocumentError> {
        self.put_freely(form, spot, Stance::default())
    }

    /// The same with a front that may stand out of its board.
    fn put_freely(
        &mut self,
        form: &Form,
        spot: Spot<'a>,
        stance: Stance,
    ) -> Result<Face, DocumentError> {
        let Spot { what, name, .. } = spot;
        let error = |message: String| self.document.error_at(spot.word.0, message);
        let place = self.scene.len() + self.targets.len();
        if place == MAX_TARGETS {
            return Err(error(format!(
                "a layout has at most {MAX_TARGETS} keys and other controls"
            )));
        }
        self.refuse_second(name, spot.word)?;
        if spot.at.abs().max_element() > metres(*Distance::RANGE.end()) {
            return Err(error(format!(
                "the {what} `{name}` lies more than {} mm from the middle of its board",
                Distance::RANGE.end()
            )));
        }
        let (press, release) = (spot.press.get(), spot.release.get());
        if press <= release {
            return Err(error(format!(
                "the press_share {press} of the {what} `{name}` must be more than its release_share {release}"
            )));
        }
        let shape = placement::shape(spot.size, self.scale);
        let bend = BoardShape::of(form);
        let at = spot.at * self.scale;
        let Some(mut outline) = placement::outline(bend, at, shape) else {
            let ends = match bend {
                BoardShape::Rows(_) | BoardShape::Columns(_) => {
                    "more than half a turn round its cylinder"
                }
                BoardShape::Flat | BoardShape::Arc(_) => "beyond the ends of its arc",
            };
            return Err(error(format!("the {what} `{name}` lies {ends}")));
        };
        outline.rotation += spot.turn + stance.turn.z;
        self.names.insert(name, (what, spot.word.0));
        if stance.is_in_plane() {
            self.placed.push((outline, what, name, spot.word.0));
        }
        self.targets.push(Target {
            shape,
            surface_from_target: bend.surface_from_spot(&outline) * stance.spot_from_target(),
            travel: metres(spot.travel.get()),
            press_at: press as f32,
            release_at: release as f32,
            margin: spot.margin,
        });
        Ok(Face {
            name: name.to_owned(),
            label: spot.label,
            target: TargetId(place as u32),
            row_position: at,
            outline,
        })
    }

    /// Refuses a name that is taken.
    pub(super) fn refuse_second(&self, name: &str, word: Spanned<'a>) -> Result<(), DocumentError> {
        let Some((what, other)) = self.names.get(name) else {
            return Ok(());
        };
        let line = line_number(&self.document.text, other);
        let message = format!(
            "there is a {what} `{name}` already in line {line}, give this one a `name` of its own"
        );
        Err(self.document.error_at(word.0, message))
    }

    fn refuse_overlaps(&self) -> Result<(), DocumentError> {
        let outlines: Vec<Outline> = self.placed.iter().map(|placed| placed.0).collect();
        let Some((a, b)) = first_overlap(&outlines) else {
            return Ok(());
        };
        let (_, what, name, word) = self.placed[b];
        let (_, other, other_name, other_word) = self.placed[a];
        let line = line_number(&self.document.text, other_word);
        let message =
            format!("the {what} `{name}` overlaps the {other} `{other_name}` of line {line}");
        Err(self.document.error_at(word, message))
    }

    fn fill_layer(
        &mut self,
        layer: usize,
        written: &schema::Layer<'a>,
    ) -> Result<(), DocumentError> {
        for &(name, code) in &written.keys.0 {
            let place = self.place_of(name)?;
            let action = self.code_action(code, None)?;
            self.refuse_in_layer(&self.keys[place], code, action, layer)?;
            let actions = &mut self.keys[place].actions;
            if actions.len() > layer {
                let message = format!(
                    "the key `{}` is in the layer `{}` for the second time",
                    name.0, written.name.0
                );
                return Err(self.document.error_at(name.0, message));
            }
            actions.resize(layer, None);
            actions.push(Some(action));
        }
        Ok(())
    }

    /// The key with that name; a key code may be written in any of its ways.
    fn place_of(&self, name: Spanned) -> Result<usize, DocumentError> {
        let code = || Some(name.0.parse::<KeyCode>().ok()?.name());
        let own = self.places.get(name.0);
        let found = own.or_else(|| self.places.get(code()?)).copied();
        found.ok_or_else(|| {
            let error = UnknownName::new("key", name.0, self.places.keys().copied());
            let message = format!("this layout has no such key: {error}");
            self.document.error_at(name.0, message)
        })
    }
}

/// Milliseconds of a file, to the microsecond.
fn milliseconds(milliseconds: f64) -> Duration {
    Duration::from_micros((milliseconds * 1e3).round() as u64)
}
