//! Keys, in rows and one by one, as written → checked.

use parry3d::math::{Vec2, Vec3};

use super::{Checked, Spot, milliseconds};
use crate::command::{Command, ProfileName};
use crate::contact::surface::TREMOR_MARGIN;
use crate::device::keyboard::Activation;
use crate::device::{KeyAction, KeyCode, Latch, TextId};
use crate::document::DocumentError;
use crate::layout::model::{Key, label, metres, metres2};
use crate::layout::placement::Stance;
use crate::layout::ranged::{PressShare, ReleaseShare, Repress, Travel, Turn};
use crate::layout::schema::{self, Does, Form};
use crate::layout::text::Spanned;
use crate::names::UnknownName;

/// The longest text that a key writes, in characters.
const LONGEST_TEXT: usize = 32;

/// A key before it has its place in the scene; rows and single keys both become this.
pub(super) struct Draft<'a> {
    word: Spanned<'a>,
    name: &'a str,
    label: Option<String>,
    action: Option<KeyAction>,
    at: Vec2,
    stance: Stance,
    size: schema::Outline,
    travel: Travel,
    press: PressShare,
    release: ReleaseShare,
    analogue: bool,
    fires: Activation,
    repress: Repress,
}

impl<'a> Checked<'a> {
    pub(super) fn draft_row(
        &self,
        board: &schema::Board<'a>,
        row: &schema::Row<'a>,
        drafts: &mut Vec<Draft<'a>>,
    ) -> Result<(), DocumentError> {
        let pitch = metres(row.pitch_mm.unwrap_or(board.pitch_mm).get());
        for (column, code) in row.keys.0.split_whitespace().enumerate() {
            let word = Spanned(code);
            drafts.push(Draft {
                word,
                name: self.code(word)?.name(),
                label: None,
                action: Some(self.code_action(word, None)?),
                at: metres2(row.at_mm) + Vec2::X * (pitch * column as f32),
                stance: Stance::default(),
                size: row.size_mm.unwrap_or(board.size_mm),
                travel: board.travel_mm,
                press: board.press_share,
                release: board.release_share,
                analogue: board.analogue,
                fires: Activation::OnPress,
                repress: board.repress_ms,
            });
        }
        Ok(())
    }

    pub(super) fn draft_key(
        &mut self,
        board: &schema::Board<'a>,
        key: &schema::Key<'a>,
    ) -> Result<Draft<'a>, DocumentError> {
        let fields = &key.fields;
        let word = key.word;
        let name = match (fields.name, key.does) {
            (None, Does::Key(code)) => self.code(code)?.name(),
            _ => word.0,
        };
        let label = fields.label.as_ref().map(|label| label.0.clone());
        let action = match (key.does, fields.latch) {
            (Does::Nothing, None) => None,
            (does, latch) => Some(self.action(does, latch)?),
        };
        Ok(Draft {
            word,
            name,
            label,
            action,
            at: metres2(fields.at_mm),
            stance: self.stance(fields),
            size: fields.size_mm.unwrap_or(board.size_mm),
            travel: fields.travel_mm.unwrap_or(board.travel_mm),
            press: fields.press_share.unwrap_or(board.press_share),
            release: fields.release_share.unwrap_or(board.release_share),
            analogue: fields.analogue.unwrap_or(board.analogue),
            fires: self.fires(key, action)?,
            repress: fields.repress_ms.unwrap_or(board.repress_ms),
        })
    }

    fn stance(&self, fields: &schema::KeyFields) -> Stance {
        let (x, y, z) = fields.turn_deg;
        let radians = |turn: Turn| turn.get().to_radians() as f32;
        Stance {
            lift: metres(fields.lift_mm.get()) * self.scale,
            turn: Vec3::new(radians(x), radians(y), radians(z)),
        }
    }

    /// What a press does; `latch` is for modifiers and layers only.
    pub(in crate::layout) fn action(
        &mut self,
        does: Does<'a>,
        latch: Option<schema::Latch>,
    ) -> Result<KeyAction, DocumentError> {
        let action = match does {
            Does::Key(code) => return self.code_action(code, latch),
            Does::Layer(layer) => return self.layer_action(layer, latch),
            Does::Write(text) => KeyAction::Text(self.text(text)?),
            Does::Profile(name) => {
                let name = self.profile(name)?;
                KeyAction::Command(Command::Profile { name })
            }
            Does::NextProfile => KeyAction::Command(Command::NextProfile),
            Does::Pause => KeyAction::Command(Command::TogglePause),
            Does::Recentre => KeyAction::Command(Command::Recenter),
            Does::Nudge(x, y, z) => KeyAction::Command(Command::Nudge {
                x_mm: x.get() as f32,
                y_mm: y.get() as f32,
                z_mm: z.get() as f32,
            }),
            Does::Scale(factor) => KeyAction::Command(Command::Scale {
                factor: factor.get() as f32,
            }),
            Does::Tilt(tilt) => KeyAction::Command(Command::Tilt {
                deg: tilt.get() as f32,
            }),
            Does::Clutch => KeyAction::Clutch,
            Does::Precision => KeyAction::Precision,
            Does::Nothing => {
                let message = "only keys that take part in chords can do nothing on their own";
                return Err(self.document.error_at(self.name.0, message));
            }
        };
        match latch {
            None => Ok(action),
            Some(_) => {
                let place = does.word().unwrap_or(self.name).0;
                let message = "only modifiers and layers can have a latch";
                Err(self.document.error_at(place, message))
            }
        }
    }

    fn text(&mut self, word: Spanned<'a>) -> Result<TextId, DocumentError> {
        let length = word.0.chars().count();
        if length > LONGEST_TEXT {
            let message = format!("a key writes at most {LONGEST_TEXT} characters, not {length}");
            return Err(self.document.error_at(word.0, message));
        }
        let place = place_in(&mut self.texts, word.0);
        let place = place.try_into().expect("there are at most 10 000 keys");
        Ok(TextId(place))
    }

    fn profile(&mut self, word: Spanned<'a>) -> Result<ProfileName, DocumentError> {
        place_in(&mut self.profiles, word.0);
        ProfileName::from(word.0).map_err(|_| {
            let message = "the name of a profile has at most 64 bytes";
            self.document.error_at(word.0, message)
        })
    }

    pub(super) fn code_action(
        &self,
        word: Spanned<'a>,
        latch: Option<schema::Latch>,
    ) -> Result<KeyAction, DocumentError> {
        let code = self.code(word)?;
        match latch {
            _ if code.is_modifier() => Ok(KeyAction::Modifier(code, checked_latch(latch))),
            None => Ok(KeyAction::Key(code)),
            Some(_) => {
                let message =
                    format!("`{code}` cannot have a latch, only modifiers and layers can");
                Err(self.document.error_at(word.0, message))
            }
        }
    }

    fn layer_action(
        &self,
        word: Spanned<'a>,
        latch: Option<schema::Latch>,
    ) -> Result<KeyAction, DocumentError> {
        let Some(layer) = self.layers.iter().position(|layer| layer == word.0) else {
            let names = self.layers.iter().map(String::as_str);
            let error = UnknownName::new("layer", word.0, names);
            return Err(self.document.error_at(word.0, error));
        };
        Ok(KeyAction::Layer(layer, checked_latch(latch)))
    }

    fn code(&self, word: Spanned<'a>) -> Result<KeyCode, DocumentError> {
        word.0
            .parse()
            .map_err(|error: UnknownName| self.document.error_at(word.0, error))
    }

    pub(super) fn add_key(&mut self, form: &Form, draft: Draft<'a>) -> Result<(), DocumentError> {
        let front = self.put_freely(
            form,
            Spot {
                what: "key",
                word: draft.word,
                name: draft.name,
                label: draft
                    .label
                    .unwrap_or_else(|| self.default_label(draft.action, draft.name)),
                at: draft.at,
                turn: 0.0,
                size: draft.size,
                travel: draft.travel,
                press: draft.press,
                release: draft.release,
                margin: TREMOR_MARGIN,
            },
            draft.stance,
        )?;
        self.places.insert(draft.name, self.keys.len());
        self.keys.push(Key {
            face: front,
            actions: vec![draft.action],
            analog: draft.analogue,
            fires: draft.fires,
            debounce: milliseconds(draft.repress.get()),
        });
        Ok(())
    }

    fn default_label(&self, action: Option<KeyAction>, name: &str) -> String {
        let label = action.map_or(name, |action| label(action, &self.layers, &self.texts));
        label.to_owned()
    }
}

/// The place of `text` in a list, at whose end it is put if it is new.
fn place_in(list: &mut Vec<String>, text: &str) -> usize {
    let found = list.iter().position(|other| other == text);
    found.unwrap_or_else(|| {
        list.push(text.to_owned());
        list.len() - 1
    })
}

fn checked_latch(latch: Option<schema::Latch>) -> Latch {
    match latch {
        None | Some(schema::Latch::Held) => Latch::Momentary,
        Some(schema::Latch::OneShot) => Latch::OneShot,
        Some(schema::Latch::Lock) => Latch::Lock,
    }
}
