//! Keys, in rows and one by one.

mod activation;
mod chords;
mod layers;

pub(super) use chords::{ChordSchema, report_idle_keys};
pub(super) use layers::LayerSchema;

use parry3d::math::Vec3;
use serde::Deserialize;

use self::activation::{ActivationSchema, HoldSchema};
use super::builder::{FaceSpec, LayoutBuilder};
use super::controls::value_output::{ValueOutputSchema, value_output};
use super::model::Key;
use super::placement::KeyPose;
use super::quantity::{
    Debounce, DwellTime, HoldAfter, Offset, Pitch, PressAt, ReleaseAt, Rotation, Travel, duration,
    metres, position,
};
use super::schema::{Action, ContactSchema, Label, LatchSchema, OutlineSchema};
use crate::device::keyboard::Activation;
use crate::device::value_output::ValueOutput;
use crate::device::{KeyAction, KeyCode};
use crate::document::{DocumentError, FieldType, Shape, Spanned, Table, schema};
use crate::hand::Finger;

/// The settings of a board that only its keys use.
#[derive(Clone, Copy)]
pub(super) struct KeyDefaults {
    /// Distance between the keys of a row.
    pub pitch: Pitch,
    /// Debounce time.
    pub debounce: Debounce,
    /// The depth of a press is reported as a value.
    pub reports_depth: bool,
}

schema! {
    /// Keys in a straight row, from left to right.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Row", deny_unknown_fields)]
    pub(super) struct RowSchema<'a> {
        /// Center of the first key.
        at_mm: (Offset, Offset),
        /// Key codes, separated by blanks.
        #[serde(borrow)]
        keys: Spanned<'a>,
        /// Distance between the centers of the keys. Default: as the board.
        #[serde(default)]
        pitch_mm: Option<Pitch>,
        /// Outline of the keys. Default: as the board.
        #[serde(default)]
        size_mm: Option<OutlineSchema>,
    }
}

/// A key.
#[derive(Debug, Deserialize)]
#[serde(try_from = "KeyFields<'a>", bound(deserialize = "'de: 'a"))]
pub(super) struct KeySchema<'a> {
    action: Action<'a>,
    /// Name of the key, or the name in its action.
    name: Spanned<'a>,
    fields: KeyFields<'a>,
}

schema! {
    /// A key, alone or beside rows.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Key", deny_unknown_fields)]
    struct KeyFields<'a> {
        /// Key code. A key has exactly one of `code`, `layer` and `action`.
        #[serde(borrow, default)]
        code: Option<Spanned<'a>>,
        /// Layer that the key activates; `base` is the base layer.
        #[serde(borrow, default)]
        layer: Option<Spanned<'a>>,
        /// Any other action, instead of `code` and `layer`.
        #[serde(borrow, default)]
        action: Option<Action<'a>>,
        /// Name in layers and messages; required if a code occurs twice. Default: the code or layer.
        #[serde(borrow, default)]
        name: Option<Spanned<'a>>,
        /// Text drawn on the key, 1 to 16 characters. Default: the label of the code.
        #[serde(default)]
        label: Option<Label>,
        /// Center.
        at_mm: (Offset, Offset),
        /// Distance in front of the board.
        #[serde(default)]
        lift_mm: Offset,
        /// Rotations about x, then y, then z of the board at the key, right-handed.
        #[serde(default)]
        rotation_deg: (Rotation, Rotation, Rotation),
        /// The key follows the tip of this finger on another hand; on a board with `anchor: wrist`. With `contact: Bend` required:
        /// the finger that bends.
        #[serde(default)]
        finger: Option<Finger>,
        /// Outline. Default: as the board.
        #[serde(default)]
        size_mm: Option<OutlineSchema>,
        /// Travel. Default: as the board.
        #[serde(default)]
        travel_mm: Option<Travel>,
        /// Press point. Default: as the board.
        #[serde(default)]
        press_at: Option<PressAt>,
        /// Release point. Default: as the board.
        #[serde(default)]
        release_at: Option<ReleaseAt>,
        /// Debounce time. Default: as the board.
        #[serde(default)]
        debounce_ms: Option<Debounce>,
        /// The depth of a press is reported as a value. Default: as the board.
        #[serde(default)]
        reports_depth: Option<bool>,
        /// Output of the depth of a press, besides the action: an axis is 0 while nothing touches the key.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
        /// Duration of a modifier or layer. Default: `Momentary`.
        #[serde(default)]
        latch: Option<LatchSchema>,
        /// Part of a press that activates the key. Default: `Press`.
        #[serde(default)]
        activate_on: Option<ActivationSchema>,
        /// Action of a held key.
        #[serde(borrow, default)]
        hold: Option<HoldSchema<'a>>,
        /// Time after which a pressed key counts as held; needs a `hold`.
        #[serde(default)]
        hold_after_ms: Option<HoldAfter>,
        /// Time after which a resting fingertip activates the key. Default: off.
        #[serde(default)]
        dwell_ms: Option<DwellTime>,
    }
}

impl FieldType for KeySchema<'_> {
    fn shape() -> Shape {
        KeyFields::shape()
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        KeyFields::collect_tables(tables);
    }
}

impl<'a> TryFrom<KeyFields<'a>> for KeySchema<'a> {
    type Error = &'static str;

    fn try_from(fields: KeyFields<'a>) -> Result<Self, Self::Error> {
        let action = match (fields.code, fields.layer, fields.action) {
            (Some(code), None, None) => Action::Key(code),
            (None, Some(layer), None) => Action::Layer(layer),
            (None, None, Some(action)) => action,
            (None, None, None) => return Err("the key has none of `code`, `layer` and `action`"),
            (Some(_), Some(_), _) => return Err("the key has both a `code` and a `layer`"),
            (_, _, Some(_)) => {
                return Err("the key has an `action` in addition to its `code` or `layer`");
            }
        };
        let Some(name) = fields.name.or(action.argument()) else {
            return Err("a key with this action needs a `name`");
        };
        Ok(Self {
            action,
            name,
            fields,
        })
    }
}

impl<'a> RowSchema<'a> {
    /// Adds the keys of the row to the current board.
    pub fn build(
        &self,
        builder: &mut LayoutBuilder<'a>,
        defaults: KeyDefaults,
    ) -> Result<(), DocumentError> {
        for (column, code) in self.keys.text.split_whitespace().enumerate() {
            let built = self.build_key(builder, defaults, column, code);
            let name = code.parse().map_or(code, |key: KeyCode| key.name());
            builder.collect_key(name, built)?;
        }
        Ok(())
    }

    fn build_key(
        &self,
        builder: &mut LayoutBuilder<'a>,
        defaults: KeyDefaults,
        column: usize,
        code: &'a str,
    ) -> Result<(), DocumentError> {
        let code = Spanned { text: code };
        let known = builder.key_code(code).map(|key| key.name());
        let name = known.as_ref().map_or(code.text, |name| *name);
        let action = known.and_then(|_| builder.key_action(code, None));
        let action = builder.keep_error(action)?;
        let pitch = metres(self.pitch_mm.unwrap_or(defaults.pitch).get());
        let face = FaceSpec {
            name,
            label: builder.default_label(action, name),
            row_offset: pitch * column as f32,
            size: self.size_mm.unwrap_or(builder.board().size),
            is_key: true,
            ..builder.face_spec("key", code, &None, self.at_mm)
        };
        let face = builder.add_face(face)?;
        let key = Key {
            face,
            actions: vec![action],
            reports_depth: defaults.reports_depth,
            reports_velocity: false,
            output: ValueOutput::ValueOnly,
            activation: Activation::OnPress,
            debounce: duration(defaults.debounce.get()),
        };
        builder.add_key(name, key);
        Ok(())
    }
}

impl<'a> KeySchema<'a> {
    /// Returns the name of the key in layers and chords.
    pub fn name(&self) -> &'a str {
        match (self.fields.name, self.action) {
            (None, Action::Key(code)) => {
                let name = code.text.parse().map(|key: KeyCode| key.name());
                name.unwrap_or(code.text)
            }
            _ => self.name.text,
        }
    }

    /// Adds the key to the current board.
    pub fn build(
        &self,
        builder: &mut LayoutBuilder<'a>,
        defaults: KeyDefaults,
    ) -> Result<(), DocumentError> {
        let fields = &self.fields;
        let name = self.name();
        let action = match (self.action, fields.latch) {
            (Action::NoOp, None) => None,
            (action, latch) => {
                let action = builder.action(action, latch);
                builder.keep_error(action)?
            }
        };
        let activation = self.activation(builder, action);
        let activation = builder
            .keep_error(activation)?
            .unwrap_or(Activation::OnPress);
        let fit_offset = self.fit_offset(builder);
        let fit_offset = builder.keep_error(fit_offset)?.unwrap_or_default();
        let face = FaceSpec {
            fit_offset: fit_offset.truncate(),
            ..self.face_spec(builder, name, action)
        };
        let lift = metres(fields.lift_mm.get()) * builder.board().scale + fit_offset.z;
        let pose = KeyPose::new(lift, fields.rotation_deg);
        let face = builder.add_posed_face(face, pose)?;
        if let Some(finger) = fields.finger {
            match builder.board().contact {
                ContactSchema::Bend => {
                    let added = builder.add_bent_finger(self.name.text, finger);
                    builder.keep_error(added)?;
                }
                _ => builder.scene.set_finger(face.target, finger),
            }
        }
        let key = Key {
            face,
            actions: vec![action],
            reports_depth: fields.reports_depth.unwrap_or(defaults.reports_depth),
            reports_velocity: false,
            output: value_output(builder, fields.output)?,
            activation,
            debounce: duration(fields.debounce_ms.unwrap_or(defaults.debounce).get()),
        };
        builder.add_key(name, key);
        Ok(())
    }

    /// Returns the displacement that keeps the key at the fingertip of its finger, if it has one.
    fn fit_offset(&self, builder: &LayoutBuilder<'a>) -> Result<Vec3, DocumentError> {
        let Some(finger) = self.fields.finger else {
            return Ok(Vec3::ZERO);
        };
        let board = builder.board();
        let Some(fingertips) = board.fit.fingertips else {
            if board.contact == ContactSchema::Bend {
                return Ok(Vec3::ZERO);
            }
            let message =
                "`finger` is for keys of a board with `anchor: wrist` or with `contact: Bend`";
            return Err(builder.error(self.name.text, message));
        };
        // A fingertip has this position, so it does not scale with the sizes.
        let unscaled = position(self.fields.at_mm) * board.scale * (1.0 / board.fit.scale - 1.0);
        Ok(unscaled.extend(0.0) + fingertips[finger.index()])
    }

    fn face_spec(
        &self,
        builder: &LayoutBuilder<'a>,
        name: &'a str,
        action: Option<KeyAction>,
    ) -> FaceSpec<'a> {
        let fields = &self.fields;
        let board = builder.board();
        FaceSpec {
            name,
            label: match &fields.label {
                Some(Label(text)) => text.clone(),
                None => builder.default_label(action, name),
            },
            size: fields.size_mm.unwrap_or(board.size),
            travel: fields.travel_mm.unwrap_or(board.travel),
            press_at: fields.press_at.unwrap_or(board.press_at),
            release_at: fields.release_at.unwrap_or(board.release_at),
            is_key: true,
            ..builder.face_spec("key", self.name, &None, fields.at_mm)
        }
    }
}
