//! Layers.

use serde::Deserialize;

use super::ChordSchema;
use super::activation::check_layer_action;
use crate::document::{DocumentError, Pairs, Spanned, schema};
use crate::layout::builder::LayoutBuilder;
use crate::layout::schema::Action;

schema! {
    /// Actions of keys while a layer is active.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Layer", deny_unknown_fields)]
    pub(in crate::layout) struct LayerSchema<'a> {
        /// Name of the layer.
        #[serde(borrow)]
        pub name: Spanned<'a>,
        /// Name of a key → its key code in this layer. All other keys keep their action of the base layer.
        #[serde(borrow, default)]
        keys: Pairs<'a, Spanned<'a>>,
        /// Name of a key → any other action in this layer.
        #[serde(borrow, default)]
        actions: Pairs<'a, Action<'a>>,
        /// Actions of chords in this layer. All other chords keep their action of the base layer.
        #[serde(borrow, default)]
        chords: Vec<ChordSchema<'a>>,
    }
}

impl<'a> LayerSchema<'a> {
    /// Adds the actions to the keys. `layer` is the index of the declared layer.
    pub fn build(
        &self,
        builder: &mut LayoutBuilder<'a>,
        layer: usize,
    ) -> Result<(), DocumentError> {
        let codes = self.keys.0.iter();
        let codes = codes.map(|&(name, code)| (name, Action::Key(code)));
        for (name, action) in codes.chain(self.actions.0.iter().copied()) {
            let built = self.build_key(builder, layer, name, action);
            builder.collect(built)?;
        }
        Ok(())
    }

    /// Adds the actions to the chords, after the actions of the base layer.
    pub fn build_chords(
        &self,
        builder: &mut LayoutBuilder<'a>,
        layer: usize,
    ) -> Result<(), DocumentError> {
        for chord in &self.chords {
            let built = chord.build_in_layer(builder, layer);
            builder.collect(built)?;
        }
        Ok(())
    }

    fn build_key(
        &self,
        builder: &mut LayoutBuilder<'a>,
        layer: usize,
        name: Spanned<'a>,
        action: Action<'a>,
    ) -> Result<(), DocumentError> {
        let index = builder.key_index(name.text)?;
        let source = action.argument().unwrap_or(name).text;
        let action = builder.action(action, None)?;
        check_layer_action(builder, &builder.keys[index], source, action, layer)?;
        let actions = &mut builder.keys[index].actions;
        if actions.len() > layer {
            let message = format!(
                "duplicate key `{}` in the layer `{}`",
                name.text, self.name.text
            );
            return Err(builder.error(name.text, message));
        }
        actions.resize(layer, None);
        actions.push(Some(action));
        Ok(())
    }
}
