//! When keys fire, as written → checked.

use super::{Checked, milliseconds};
use crate::device::keyboard::{Activation, TapHold};
use crate::device::{KeyAction, Latch};
use crate::document::DocumentError;
use crate::layout::model::Key;
use crate::layout::schema;
use crate::layout::text::Spanned;

impl<'a> Checked<'a> {
    /// When a key fires whose action in the base layer is `action`; `None` for nothing.
    pub(super) fn fires(
        &mut self,
        key: &schema::Key<'a>,
        action: Option<KeyAction>,
    ) -> Result<Activation, DocumentError> {
        let fields = &key.fields;
        let word = key.word.0;
        let document = self.document;
        let refuse = |message: String| Err(document.error_at(word, message));
        let Some(action) = action else {
            let is_plain = fields.fires.is_none()
                && fields.hold.is_none()
                && fields.hold_ms.is_none()
                && fields.dwell_ms.is_none();
            return match is_plain {
                true => Ok(Activation::OnPress),
                false => refuse(format!(
                    "the key `{word}` does nothing on its own, so it has no way to fire"
                )),
            };
        };
        if fields.hold.is_none() && fields.hold_ms.is_some() {
            return refuse(format!(
                "the key `{word}` has a `hold_ms` but no `hold`, say what it does when it is held"
            ));
        }
        if fields.hold.is_some() && fields.fires.is_some() {
            return refuse(format!(
                "the key `{word}` cannot have both `fires` and `hold`: a tap of a key with a `hold` \
                 fires when it is let go of"
            ));
        }
        if fields.dwell_ms.is_some() && (fields.hold.is_some() || fields.fires.is_some()) {
            let other = if fields.hold.is_some() {
                "hold"
            } else {
                "fires"
            };
            return refuse(format!(
                "the key `{word}` cannot have both `{other}` and `dwell_ms`: it fires when a fingertip \
                 rests on it and at nothing else"
            ));
        }
        if let Some(dwell) = fields.dwell_ms {
            let fires = Activation::Dwell(milliseconds(dwell.get()));
            self.refuse_unless_code(word, action, fires)?;
            return Ok(fires);
        }
        let fires = match (fields.hold, fields.fires) {
            (Some(hold), _) => Activation::TapHold(TapHold {
                hold_action: self.action(hold.0, None)?,
                hold_after: milliseconds(fields.hold_ms.unwrap_or_default().get()),
            }),
            (None, Some(schema::Fires::Release)) => Activation::OnRelease,
            (None, Some(schema::Fires::Press) | None) => return Ok(Activation::OnPress),
        };
        self.refuse_unless_code(word, action, fires)?;
        Ok(fires)
    }

    /// Refuses what a key cannot do in a layer.
    pub(super) fn refuse_in_layer(
        &self,
        key: &Key,
        code: Spanned<'a>,
        action: KeyAction,
        layer: usize,
    ) -> Result<(), DocumentError> {
        if key.action(0) == Some(KeyAction::Layer(layer, Latch::Lock)) {
            let message = format!(
                "the key `{}` locks the layer `{}` and has to unlock it too, so it cannot do \
                 something else there",
                key.face.name, self.layers[layer]
            );
            return Err(self.document.error_at(code.0, message));
        }
        self.refuse_unless_code(code.0, action, key.fires)
    }

    /// Modifiers and layers are in force from the press on.
    fn refuse_unless_code(
        &self,
        word: &str,
        action: KeyAction,
        fires: Activation,
    ) -> Result<(), DocumentError> {
        let cannot = match (action, fires) {
            (
                KeyAction::Modifier(_, Latch::OneShot | Latch::Lock)
                | KeyAction::Layer(_, Latch::OneShot | Latch::Lock),
                Activation::Dwell(_),
            ) => return Ok(()),
            (KeyAction::Key(_) | KeyAction::Text(_) | KeyAction::Command(_), _)
            | (_, Activation::OnPress) => return Ok(()),
            (_, Activation::OnRelease) => "fire on release",
            (_, Activation::TapHold(_)) => "be what a tap of a key with a `hold` does",
            (_, Activation::Dwell(_)) => {
                let message = format!(
                    "`{word}` cannot fire by dwelling: it is in force as long as it is pressed only"
                );
                return Err(self.document.error_at(word, message));
            }
        };
        let message = format!("`{word}` cannot {cannot}, only keys that are no modifiers can");
        Err(self.document.error_at(word, message))
    }
}
