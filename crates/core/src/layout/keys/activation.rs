//! The part of a press that activates a key: press, release, tap or hold, dwell.

use serde::Deserialize;

use super::KeySchema;
use crate::device::keyboard::{Activation, TapHold};
use crate::device::{KeyAction, Latch};
use crate::document::{DocumentError, FieldType, Shape, Spanned, Table, schema};
use crate::layout::builder::LayoutBuilder;
use crate::layout::model::Key;
use crate::layout::quantity::{DwellTime, HoldAfter, duration};
use crate::layout::schema::Action;

schema! {
    /// The part of a press that activates a key.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
    #[serde(rename = "Activation")]
    pub(super) enum ActivationSchema {
        /// The press; the action lasts until the release.
        Press,
        /// The release; the action is tapped.
        Release,
    }
}

/// The action of a key that is held.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "HoldFields<'a>", bound(deserialize = "'de: 'a"))]
pub(super) struct HoldSchema<'a>(Action<'a>);

schema! {
    /// The action of a key that is held: exactly one of these.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Hold", deny_unknown_fields)]
    struct HoldFields<'a> {
        /// Key code.
        #[serde(borrow, default)]
        code: Option<Spanned<'a>>,
        /// Layer.
        #[serde(borrow, default)]
        layer: Option<Spanned<'a>>,
    }
}

impl FieldType for HoldSchema<'_> {
    fn shape() -> Shape {
        HoldFields::shape()
    }

    fn collect_tables(tables: &mut Vec<Table>) {
        HoldFields::collect_tables(tables);
    }
}

impl<'a> TryFrom<HoldFields<'a>> for HoldSchema<'a> {
    type Error = &'static str;

    fn try_from(fields: HoldFields<'a>) -> Result<Self, Self::Error> {
        match (fields.code, fields.layer) {
            (Some(code), None) => Ok(Self(Action::Key(code))),
            (None, Some(layer)) => Ok(Self(Action::Layer(layer))),
            (None, None) => Err("the hold has neither a `code` nor a `layer`"),
            (Some(_), Some(_)) => Err("the hold has both a `code` and a `layer`"),
        }
    }
}

/// The fields of a key or a chord that choose the part of a press that activates it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ActivationFields<'a> {
    /// "key" or "chord", for messages.
    pub kind: &'static str,
    /// Name, for messages.
    pub name: &'a str,
    pub activate_on: Option<ActivationSchema>,
    pub hold: Option<HoldSchema<'a>>,
    pub hold_after_ms: Option<HoldAfter>,
    pub dwell_ms: Option<DwellTime>,
}

impl<'a> KeySchema<'a> {
    /// Returns the activation of a key with this action in the base layer.
    pub(super) fn activation(
        &self,
        builder: &mut LayoutBuilder<'a>,
        action: Option<KeyAction>,
    ) -> Result<Activation, DocumentError> {
        let fields = &self.fields;
        let fields = ActivationFields {
            kind: "key",
            name: self.name.text,
            activate_on: fields.activate_on,
            hold: fields.hold,
            hold_after_ms: fields.hold_after_ms,
            dwell_ms: fields.dwell_ms,
        };
        fields.build(builder, action)
    }
}

impl<'a> ActivationFields<'a> {
    /// Returns the activation of a key or chord with this action in the base layer.
    pub(super) fn build(
        &self,
        builder: &mut LayoutBuilder<'a>,
        action: Option<KeyAction>,
    ) -> Result<Activation, DocumentError> {
        let name = self.name;
        if let Some(message) = self.conflict(action) {
            return Err(builder.error(name, message));
        }
        let Some(action) = action else {
            return Ok(Activation::OnPress);
        };
        let activation = match (self.dwell_ms, self.hold, self.activate_on) {
            (Some(dwell), ..) => Activation::Dwell(duration(dwell.get())),
            (None, Some(HoldSchema(hold)), _) => Activation::TapHold(TapHold {
                hold_action: builder.action(hold, None)?,
                hold_after: duration(self.hold_after_ms.unwrap_or_default().get()),
            }),
            (None, None, Some(ActivationSchema::Release)) => Activation::OnRelease,
            (None, None, Some(ActivationSchema::Press) | None) => Activation::OnPress,
        };
        check_action(builder, name, action, activation)?;
        Ok(activation)
    }

    /// Returns the message for fields that exclude each other.
    fn conflict(&self, action: Option<KeyAction>) -> Option<String> {
        let Self { kind, name, .. } = self;
        let has_hold = self.hold.is_some();
        let has_activate_on = self.activate_on.is_some();
        let has_dwell = self.dwell_ms.is_some();
        let has_any = has_hold || has_activate_on || has_dwell || self.hold_after_ms.is_some();
        if action.is_none() {
            return has_any.then(|| {
                format!(
                    "the {kind} `{name}` has no action of its own, remove `activate_on`, `hold` and `dwell_ms`"
                )
            });
        }
        if !has_hold && self.hold_after_ms.is_some() {
            return Some(format!(
                "the {kind} `{name}` has a `hold_after_ms` but no `hold`, add the action of a held {kind}"
            ));
        }
        if has_hold && has_activate_on {
            return Some(format!(
                "the {kind} `{name}` cannot have both `activate_on` and `hold`: a tap activates on release"
            ));
        }
        if has_dwell && (has_hold || has_activate_on) {
            let other = if has_hold { "hold" } else { "activate_on" };
            return Some(format!(
                "the {kind} `{name}` cannot have both `{other}` and `dwell_ms`: only a resting fingertip activates it"
            ));
        }
        None
    }
}

/// Rejects an action in a layer that the key cannot have.
pub(super) fn check_layer_action(
    builder: &LayoutBuilder,
    key: &Key,
    source: &str,
    action: KeyAction,
    layer: usize,
) -> Result<(), DocumentError> {
    let name = format!("key `{}`", key.face.name);
    check_unlocks(builder, source, &name, key.action(0), layer)?;
    check_action(builder, source, action, key.activation)
}

/// Rejects another action in the layer that a key or chord, `name` with its kind, locks.
pub(super) fn check_unlocks(
    builder: &LayoutBuilder,
    source: &str,
    name: &str,
    in_base_layer: Option<KeyAction>,
    layer: usize,
) -> Result<(), DocumentError> {
    if in_base_layer != Some(KeyAction::Layer(layer, Latch::Lock)) {
        return Ok(());
    }
    let message = format!(
        "the {name} locks the layer `{}` and must unlock it too, so it cannot have another action there",
        builder.layers[layer]
    );
    Err(builder.error(source, message))
}

/// Rejects an action that lasts as long as the press, unless the key activates on press.
pub(super) fn check_action(
    builder: &LayoutBuilder,
    name: &str,
    action: KeyAction,
    activation: Activation,
) -> Result<(), DocumentError> {
    let latch = match action {
        KeyAction::Modifier(_, latch) | KeyAction::Layer(_, latch) => latch,
        KeyAction::Clutch | KeyAction::Precision => Latch::Momentary,
        KeyAction::Key(_)
        | KeyAction::Text(_)
        | KeyAction::Multitap(_)
        | KeyAction::Sequence(_)
        | KeyAction::Command(_) => return Ok(()),
    };
    let what = match activation {
        Activation::OnPress => return Ok(()),
        Activation::Dwell(_) if latch != Latch::Momentary => return Ok(()),
        Activation::OnRelease => "activate on release",
        Activation::TapHold(_) => "be the tap of a key with a `hold`",
        Activation::Dwell(_) => "activate by dwelling",
    };
    let message = format!("`{name}` cannot {what}: it is active while it is pressed");
    Err(builder.error(name, message))
}
