//! A keyboard layout as written → [`Layout`]: names are looked up, boards are laid out in space, and
//! what does not fit together is refused at its place.

mod fires;

use std::collections::BTreeMap;
use std::time::Duration;

use parry3d::math::{Pose, Rot3, Vec2};

use super::error::{LayoutError, line_of};
use super::file::Document;
use super::keyboard::{
    BASE_LAYER, Board, Key, Layout, MAX_KEYS, MAX_LAYERS, label, metres, metres2,
};
use super::number::{Distance, PressShare, ReleaseShare, Repress, Travel};
use super::outline::{Outline, first_overlap};
use super::placement;
use super::text::Word;
use super::written::{self, Does, Form};
use crate::contact::TargetId;
use crate::contact::surface::{Scene, TREMBLE, Target};
use crate::device::keyboard::Fires;
use crate::device::{KeyAction, KeyCode, Latch};
use crate::names::UnknownName;

/// Reads and checks a document.
pub(super) fn layout(document: Document) -> Result<Layout, LayoutError> {
    let written: written::Layout = document.parse()?;
    let Checked {
        scene,
        boards,
        keys,
        layers,
        texts,
        ..
    } = Checked::of(&document, &written)?;
    Ok(Layout {
        name: one_line(written.name),
        note: written.note.map_or(String::new(), one_line),
        scene,
        boards,
        keys,
        layers,
        texts,
        file: document.file.clone(),
        text: document.text.clone(),
    })
}

fn one_line(word: Word) -> String {
    word.0.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What has been checked so far.
struct Checked<'a> {
    document: &'a Document,
    scene: Scene,
    boards: Vec<Board>,
    keys: Vec<Key>,
    layers: Vec<String>,
    texts: Vec<String>,
    /// Name of a key → its place in `keys`.
    places: BTreeMap<&'a str, usize>,
    /// Where each key stands in the file.
    words: Vec<&'a str>,
}

/// A key before it has its place in the scene; rows and single keys both become this.
struct Draft<'a> {
    word: Word<'a>,
    name: &'a str,
    label: Option<String>,
    action: KeyAction,
    at: Vec2,
    size: written::Outline,
    travel: Travel,
    press: PressShare,
    release: ReleaseShare,
    analogue: bool,
    fires: Fires,
    repress: Repress,
}

impl<'a> Checked<'a> {
    fn of(document: &'a Document, written: &written::Layout<'a>) -> Result<Self, LayoutError> {
        let mut checked = Self {
            document,
            scene: Scene::new(),
            boards: Vec::new(),
            keys: Vec::new(),
            layers: vec![BASE_LAYER.to_owned()],
            texts: Vec::new(),
            places: BTreeMap::new(),
            words: Vec::new(),
        };
        for layer in &written.layers {
            checked.name_layer(layer.name)?;
        }
        for board in &written.boards {
            checked.add_board(board)?;
            if checked
                .boards
                .last()
                .is_some_and(|board| board.keys.is_empty())
            {
                let message = format!("board {} has no keys", checked.boards.len());
                return Err(document.error(written.name.0, message));
            }
        }
        if checked.keys.is_empty() {
            return Err(document.error(written.name.0, "the layout has no keys"));
        }
        for (name, label) in &written.labels.0 {
            let place = checked.place_of(*name)?;
            checked.keys[place].label.clone_from(&label.0);
        }
        for (place, layer) in written.layers.iter().enumerate() {
            checked.fill_layer(place + 1, layer)?;
        }
        Ok(checked)
    }

    fn name_layer(&mut self, name: Word<'a>) -> Result<(), LayoutError> {
        if name.0 == BASE_LAYER {
            let message = "`base` is what the keys do without a layer, name this one otherwise";
            return Err(self.document.error(name.0, message));
        }
        if self.layers.iter().any(|layer| layer == name.0) {
            let message = format!("the layer `{}` is here for the second time", name.0);
            return Err(self.document.error(name.0, message));
        }
        if self.layers.len() == MAX_LAYERS {
            let message = format!("a layout has at most {} layers", MAX_LAYERS - 1);
            return Err(self.document.error(name.0, message));
        }
        self.layers.push(name.0.to_owned());
        Ok(())
    }

    fn add_board(&mut self, board: &written::Board<'a>) -> Result<(), LayoutError> {
        let mut drafts = Vec::new();
        for row in &board.rows {
            self.draft_row(board, row, &mut drafts)?;
        }
        for key in &board.keys {
            drafts.push(self.draft_key(board, key)?);
        }
        let first = self.keys.len();
        let targets = drafts
            .into_iter()
            .map(|draft| self.add_key(&board.form, draft))
            .collect::<Result<Vec<Target>, _>>()?;
        self.refuse_overlaps(first)?;
        self.scene.add(
            placement::anchor(board.place.anchor),
            placement::anchor_from_board(board),
            targets,
        );
        self.boards.push(Board {
            keys: first..self.keys.len(),
            pitch: metres(board.pitch_mm.get()),
            radius: match board.form {
                Form::Flat => None,
                Form::Arc { radius_mm } => Some(metres(radius_mm.get())),
            },
        });
        Ok(())
    }

    fn draft_row(
        &self,
        board: &written::Board<'a>,
        row: &written::Row<'a>,
        drafts: &mut Vec<Draft<'a>>,
    ) -> Result<(), LayoutError> {
        let pitch = metres(row.pitch_mm.unwrap_or(board.pitch_mm).get());
        for (column, code) in row.keys.0.split_whitespace().enumerate() {
            let word = Word(code);
            drafts.push(Draft {
                word,
                name: self.code(word)?.name(),
                label: None,
                action: self.code_action(word, None)?,
                at: metres2(row.at_mm) + Vec2::X * (pitch * column as f32),
                size: row.size_mm.unwrap_or(board.size_mm),
                travel: board.travel_mm,
                press: board.press_share,
                release: board.release_share,
                analogue: board.analogue,
                fires: Fires::Press,
                repress: board.repress_ms,
            });
        }
        Ok(())
    }

    fn draft_key(
        &self,
        board: &written::Board<'a>,
        key: &written::Key<'a>,
    ) -> Result<Draft<'a>, LayoutError> {
        let fields = &key.fields;
        let word = fields.name.unwrap_or(key.does.word());
        let name = match (fields.name, key.does) {
            (None, Does::Code(code)) => self.code(code)?.name(),
            _ => word.0,
        };
        let label = fields.label.as_ref().map(|label| label.0.clone());
        let action = self.action(key.does, fields.latch)?;
        Ok(Draft {
            word,
            name,
            label,
            action,
            at: metres2(fields.at_mm),
            size: fields.size_mm.unwrap_or(board.size_mm),
            travel: fields.travel_mm.unwrap_or(board.travel_mm),
            press: fields.press_share.unwrap_or(board.press_share),
            release: fields.release_share.unwrap_or(board.release_share),
            analogue: fields.analogue.unwrap_or(board.analogue),
            fires: self.fires(key, action)?,
            repress: fields.repress_ms.unwrap_or(board.repress_ms),
        })
    }

    fn action(
        &self,
        does: Does<'a>,
        latch: Option<written::Latch>,
    ) -> Result<KeyAction, LayoutError> {
        match does {
            Does::Code(code) => self.code_action(code, latch),
            Does::Layer(layer) => self.layer_action(layer, latch),
        }
    }

    fn code_action(
        &self,
        word: Word<'a>,
        latch: Option<written::Latch>,
    ) -> Result<KeyAction, LayoutError> {
        let code = self.code(word)?;
        match latch {
            _ if code.is_modifier() => Ok(KeyAction::Modifier(code, checked_latch(latch))),
            None => Ok(KeyAction::Key(code)),
            Some(_) => {
                let message =
                    format!("`{code}` cannot have a latch, only modifiers and layers can");
                Err(self.document.error(word.0, message))
            }
        }
    }

    fn layer_action(
        &self,
        word: Word<'a>,
        latch: Option<written::Latch>,
    ) -> Result<KeyAction, LayoutError> {
        let Some(layer) = self.layers.iter().position(|layer| layer == word.0) else {
            let names = self.layers.iter().map(String::as_str);
            let error = UnknownName::new("layer", word.0, names);
            return Err(self.document.error(word.0, error));
        };
        Ok(KeyAction::Layer(layer, checked_latch(latch)))
    }

    fn code(&self, word: Word<'a>) -> Result<KeyCode, LayoutError> {
        word.0
            .parse()
            .map_err(|error: UnknownName| self.document.error(word.0, error))
    }

    fn add_key(&mut self, form: &Form, draft: Draft<'a>) -> Result<Target, LayoutError> {
        let error = |message: String| self.document.error(draft.word.0, message);
        let name = draft.name;
        if self.keys.len() == MAX_KEYS {
            return Err(error(format!("a layout has at most {MAX_KEYS} keys")));
        }
        if let Some(&place) = self.places.get(name) {
            let line = line_of(&self.document.text, self.words[place]);
            return Err(error(format!(
                "there is a key `{name}` already in line {line}, give this one a `name` of its own"
            )));
        }
        if draft.at.abs().max_element() > metres(*Distance::RANGE.end()) {
            return Err(error(format!(
                "the key `{name}` lies more than {} mm from the middle of its board",
                Distance::RANGE.end()
            )));
        }
        let (press, release) = (draft.press.get(), draft.release.get());
        if press <= release {
            return Err(error(format!(
                "the press_share {press} of the key `{name}` must be more than its release_share {release}"
            )));
        }
        let shape = placement::shape(draft.size);
        let outline = match placement::outline(form, draft.at, shape) {
            Some(outline) => outline,
            None => {
                return Err(error(format!(
                    "the key `{name}` lies beyond the ends of its arc"
                )));
            }
        };
        let place = self.keys.len();
        self.places.insert(name, place);
        self.words.push(draft.word.0);
        self.keys.push(Key {
            name: name.to_owned(),
            label: draft
                .label
                .unwrap_or_else(|| self.default_label(draft.action)),
            target: TargetId(place as u32),
            at: draft.at,
            outline,
            actions: vec![Some(draft.action)],
            analogue: draft.analogue,
            fires: draft.fires,
            repress: milliseconds(draft.repress.get()),
        });
        Ok(Target {
            shape,
            surface_from_target: Pose::from_parts(
                outline.middle.extend(0.0),
                Rot3::from_rotation_z(outline.rotation),
            ),
            travel: metres(draft.travel.get()),
            press_share: press as f32,
            release_share: release as f32,
            margin: TREMBLE,
        })
    }

    fn default_label(&self, action: KeyAction) -> String {
        label(action, &self.layers, &self.texts).to_owned()
    }

    fn refuse_overlaps(&self, first: usize) -> Result<(), LayoutError> {
        let keys = &self.keys[first..];
        let outlines: Vec<Outline> = keys.iter().map(|key| key.outline).collect();
        let Some((a, b)) = first_overlap(&outlines) else {
            return Ok(());
        };
        let line = line_of(&self.document.text, self.words[first + a]);
        let message = format!(
            "the key `{}` overlaps the key `{}` of line {line}",
            keys[b].name, keys[a].name
        );
        Err(self.document.error(self.words[first + b], message))
    }

    fn fill_layer(
        &mut self,
        layer: usize,
        written: &written::Layer<'a>,
    ) -> Result<(), LayoutError> {
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
                return Err(self.document.error(name.0, message));
            }
            actions.resize(layer, None);
            actions.push(Some(action));
        }
        Ok(())
    }

    /// The key with that name; a key code may be written in any of its ways.
    fn place_of(&self, name: Word) -> Result<usize, LayoutError> {
        let code = || Some(name.0.parse::<KeyCode>().ok()?.name());
        let own = self.places.get(name.0);
        let found = own.or_else(|| self.places.get(code()?)).copied();
        found.ok_or_else(|| {
            let error = UnknownName::new("key", name.0, self.places.keys().copied());
            let message = format!("this layout has no such key: {error}");
            self.document.error(name.0, message)
        })
    }
}

fn checked_latch(latch: Option<written::Latch>) -> Latch {
    match latch {
        None | Some(written::Latch::Held) => Latch::Held,
        Some(written::Latch::OneShot) => Latch::OneShot,
        Some(written::Latch::Lock) => Latch::Lock,
    }
}

/// Milliseconds of a file, to the microsecond.
fn milliseconds(milliseconds: f64) -> Duration {
    Duration::from_micros((milliseconds * 1e3).round() as u64)
}
