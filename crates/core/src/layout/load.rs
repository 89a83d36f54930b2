//! Layouts from files and texts: the schema of a whole file, and the order in which its parts are built.

use serde::Deserialize;

use super::builder::{BoardSettings, LayoutBuilder, SHARE_BESIDE_BOARDS};
use super::controls::pointer::PointerSchema;
use super::controls::space::SpaceSchema;
use super::controls::trigger::TriggerSchema;
use super::controls::with_control_kinds;
use super::draft::LayoutDraft;
use super::fit::Fit;
use super::keys::{ChordSchema, KeyDefaults, KeySchema, LayerSchema, RowSchema, report_idle_keys};
use super::model::Layout;
use super::quantity::{
    ChordTimeout, Debounce, MultitapTimeout, Pitch, PressAt, ReleaseAt, Travel, duration,
};
use super::schema::{
    AnchorSchema, AutoRecenterSchema, BoardShapeSchema, ContactSchema, GapsSchema, Label,
    OutlineSchema, PoseSchema, PressSchema, TextModeSchema,
};
use super::sequences::{StepSchema, build_sequence};
use super::signals::SignalSchema;
use crate::document::{
    self, Document, DocumentError, Format, Pairs, Spanned, Structure, first_error, schema,
};
use crate::hand::Side;

schema! {
    /// A layout file.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Layout", deny_unknown_fields)]
    pub(super) struct LayoutSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// One line for `ademan layout list`.
        #[serde(borrow, default)]
        description: Option<Spanned<'a>>,
        /// Groups of keys and controls; each moves as one.
        #[serde(borrow, default)]
        pub boards: Vec<BoardSchema<'a>>,
        /// Labels by name of the key: `{"Q": "A", "W": "Z"}`.
        #[serde(borrow, default)]
        labels: Pairs<'a, Label>,
        /// Layers other than the base layer, at most 31.
        #[serde(borrow, default)]
        layers: Vec<LayerSchema<'a>>,
        /// Keys, texts and waits that a press of `action: Sequence("copy")` starts, by name: `{"copy": [Tap("ControlLeft C")]}`.
        #[serde(borrow, default)]
        sequences: Pairs<'a, Vec<StepSchema<'a>>>,
        /// Actions of keys that are pressed together.
        #[serde(borrow, default)]
        chords: Vec<ChordSchema<'a>>,
        /// Maximum time between the first and the last key press of a chord.
        #[serde(default)]
        chord_timeout_ms: ChordTimeout,
        /// Maximum time between two taps of a multitap key that choose one letter.
        #[serde(default)]
        multitap_timeout_ms: MultitapTimeout,
        /// Changes of the text decoder, if neither the setup nor the command line states them. Default: no decoder.
        #[serde(default)]
        text: Option<TextModeSchema>,
        /// Hand postures with an action or value.
        #[serde(borrow, default)]
        triggers: Vec<TriggerSchema<'a>>,
        /// The arm as a pointer.
        #[serde(borrow, default)]
        pointer: Option<PointerSchema<'a>>,
        /// Targets in space.
        #[serde(borrow, default)]
        spaces: Vec<SpaceSchema<'a>>,
        /// Messages of controls to music and stage programs, by name of the control: `{"C4": (note: 60)}`.
        #[serde(borrow, default)]
        signals: Pairs<'a, SignalSchema<'a>>,
    }
}

/// Declares the schema of a board, with one list for each kind of control.
macro_rules! board_schema {
    ($($kind:ident $list:ident: $module:ident::$schema:ident,)+) => {
        schema! {
            /// A group of keys and controls that moves as one.
            #[derive(Debug, Deserialize)]
            #[serde(rename = "Board", deny_unknown_fields)]
            pub(super) struct BoardSchema<'a> {
                /// Name in the editor and in messages. Default: its number.
                #[serde(default)]
                name: Option<Label>,
                /// Pose of the point (0, 0), and scale.
                pub pose: PoseSchema,
                /// The only hand that can touch the board. Default: either.
                #[serde(default)]
                pub hand: Option<Side>,
                /// Way in which fingers press the keys.
                #[serde(default)]
                contact: ContactSchema,
                /// Moment and place of a press.
                #[serde(default)]
                press: PressSchema,
                /// Owner of the gaps between keys.
                #[serde(default)]
                gaps: GapsSchema,
                /// A finger that stays down and moves over the letters of a word types it, while a text decoder runs.
                #[serde(default)]
                swipe: bool,
                /// Flat or curved.
                #[serde(default)]
                pub shape: BoardShapeSchema,
                /// Slow motion towards a resting hand. Default: off.
                #[serde(default)]
                auto_recenter: Option<AutoRecenterSchema>,
                /// Distance between the centers of adjacent keys of a row.
                #[serde(default)]
                pitch_mm: Pitch,
                /// Default outline. Default: `Box(17, 17)`.
                #[serde(default)]
                size_mm: OutlineSchema,
                /// Default travel of a key.
                #[serde(default)]
                travel_mm: Travel,
                /// Default press point, as a fraction of the travel; greater than `release_at`.
                #[serde(default)]
                press_at: PressAt,
                /// Default release point, as a fraction of the travel, or of the bend with `contact: Bend`. Default: 0.25 or 0.4.
                #[serde(default)]
                release_at: Option<ReleaseAt>,
                /// Time after a release during which a key ignores presses.
                #[serde(default)]
                debounce_ms: Debounce,
                /// Keys report the depth of a press as a value.
                #[serde(default)]
                reports_depth: bool,
                /// Rows of keys.
                #[serde(borrow, default)]
                rows: Vec<RowSchema<'a>>,
                /// Single keys.
                #[serde(borrow, default)]
                keys: Vec<KeySchema<'a>>,
                $(
                    #[serde(borrow, default)]
                    $list: Vec<super::controls::$module::$schema<'a>>,
                )+
            }
        }

        impl<'a> BoardSchema<'a> {
            fn build_controls(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
                $(
                    for control in &self.$list {
                        let built = control.build(builder);
                        builder.collect(built)?;
                    }
                )+
                Ok(())
            }
        }

        /// Returns the structures whose fields are easily taken for the fields of another one.
        pub(super) fn structures() -> Vec<Structure> {
            vec![
                Structure::of::<LayoutSchema>("Layout"),
                Structure::of::<BoardSchema>("boards"),
                Structure::of::<PoseSchema>("pose"),
                Structure::of::<RowSchema>("rows"),
                Structure::of::<KeySchema>("keys"),
                $(Structure::of::<super::controls::$module::$schema>(stringify!($list)),)+
                Structure::of::<LayerSchema>("layers"),
                Structure::of::<ChordSchema>("chords"),
                Structure::of::<TriggerSchema>("triggers"),
                Structure::of::<super::shape::ShapeSchema>("shape"),
                Structure::of::<PointerSchema>("pointer"),
                Structure::of::<SpaceSchema>("spaces"),
                Structure::of::<SignalSchema>("signals"),
            ]
        }
    };
}
with_control_kinds!(board_schema);

/// The format of layout files.
const FORMAT: Format = Format {
    name: "Layout",
    remedy: "; `ademan layout new NAME` writes a layout to start from",
    reread: |text| first_error::<LayoutSchema>(text),
    structures,
};

impl Layout {
    /// Parses a text for the design hand. `file` names it in errors.
    pub fn parse(text: &str, file: &str) -> Result<Self, DocumentError> {
        Self::from_document(Document::new(file, text))
    }

    /// Parses and checks a document for the design hand.
    pub fn from_document(document: Document) -> Result<Self, DocumentError> {
        Self::for_hands(document, Fit::default())
    }

    /// Parses and checks a document for the hands of a setup.
    pub fn for_hands(document: Document, fit: Fit) -> Result<Self, DocumentError> {
        LayoutDraft::read(&document, fit)?.into_layout()
    }

    /// Returns the layout of another text, with the same name of the file and for the same hands.
    pub fn with_text(&self, text: &str) -> Result<Self, DocumentError> {
        Self::for_hands(Document::new(self.file.as_str(), text), self.fit)
    }

    /// Returns the shipped layouts with their names, folder by folder.
    pub fn shipped() -> Result<Vec<(&'static str, Self)>, DocumentError> {
        document::shipped_layouts()
            .map(|name| Ok((name, Self::from_document(Document::shipped(name)?)?)))
            .collect()
    }
}

impl LayoutDraft {
    /// Reads a document for the hands of a setup, with its faults. Fails only on a text that is not a layout: its brackets, fields or
    /// values are wrong.
    pub fn read(document: &Document, fit: Fit) -> Result<Self, DocumentError> {
        let schema: LayoutSchema = document.parse_as(&FORMAT)?;
        let mut builder = LayoutBuilder::new(document, schema.name, fit);
        let built = schema.build(&mut builder);
        let chord_timeout = duration(schema.chord_timeout_ms.get());
        let multitap_timeout = duration(schema.multitap_timeout_ms.get());
        let text_mode = schema.text.map(Into::into);
        Ok(builder.finish(
            built,
            schema.description,
            chord_timeout,
            multitap_timeout,
            text_mode,
        ))
    }
}

impl<'a> LayoutSchema<'a> {
    /// Adds all parts to the builder, also those after an error.
    fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        for layer in &self.layers {
            let declared = builder.declare_layer(layer.name);
            builder.collect(declared)?;
        }
        for (name, steps) in &self.sequences.0 {
            let built = build_sequence(builder, *name, steps);
            builder.collect(built)?;
        }
        for (index, board) in self.boards.iter().enumerate() {
            let mut others = self.boards[..index].iter().chain(&self.boards[index + 1..]);
            let has_neighbors = others.any(|other| board.shares_hand(other));
            let built = board.build(builder, has_neighbors);
            builder.collect(built)?;
        }
        let has_controls = !self.boards.is_empty()
            || !self.triggers.is_empty()
            || self.pointer.is_some()
            || !self.spaces.is_empty();
        if !has_controls {
            let message = "the layout has no keys and no other controls, add `boards`";
            return Err(builder.error(self.name.text, message));
        }
        for (index, (name, label)) in self.labels.0.iter().enumerate() {
            let mut earlier = self.labels.0[..index].iter();
            let labelled = if earlier.any(|(other, _)| other.text == name.text) {
                Err(builder.error(name.text, format!("duplicate label of `{}`", name.text)))
            } else {
                builder.set_label(name.text, &label.0)
            };
            builder.collect(labelled)?;
        }
        // Declared layers have their indices from the file.
        let has_all_layers = builder.layers.len() == self.layers.len() + 1;
        if has_all_layers {
            for (index, layer) in self.layers.iter().enumerate() {
                layer.build(builder, index + 1)?;
            }
        }
        for chord in &self.chords {
            let built = chord.build(builder);
            builder.collect(built)?;
        }
        if has_all_layers {
            for (index, layer) in self.layers.iter().enumerate() {
                layer.build_chords(builder, index + 1)?;
            }
        }
        let signals = self.signals.0.iter();
        let (of_keys, of_others): (Vec<_>, Vec<_>) =
            signals.partition(|(name, _)| builder.has_key(name.text));
        for (name, signal) in of_keys {
            let built = signal.build(builder, Spanned { text: name.text });
            builder.collect(built)?;
        }
        // A key may have its action in a part that has failed.
        if builder.failed() == 0 {
            report_idle_keys(builder);
        }
        for trigger in &self.triggers {
            let built = trigger.build(builder);
            builder.collect(built)?;
        }
        if let Some(pointer) = &self.pointer {
            let built = pointer.build(builder);
            builder.collect(built)?;
        }
        for (index, space) in self.spaces.iter().enumerate() {
            let built = space.build(builder, index + 1);
            builder.collect(built)?;
        }
        builder.add_values();
        for (name, signal) in of_others {
            let built = signal.build(builder, Spanned { text: name.text });
            builder.collect(built)?;
        }
        Ok(())
    }
}

impl<'a> BoardSchema<'a> {
    /// Returns `true` if one hand can touch both boards.
    fn shares_hand(&self, other: &Self) -> bool {
        self.hand.is_none() || other.hand.is_none() || self.hand == other.hand
    }

    fn build(
        &self,
        builder: &mut LayoutBuilder<'a>,
        has_neighbors: bool,
    ) -> Result<(), DocumentError> {
        if self.hand.is_none() && self.pose.anchor == AnchorSchema::Other {
            let message = "a board with `anchor: other` is for one hand, set its `hand`";
            return Err(builder.error(builder.name.text, message));
        }
        let fit = builder.pose_fit(&self.pose, self.hand);
        builder.begin_board(BoardSettings {
            shape: self.shape.shape(&fit),
            scale: self.pose.scale.get() as f32 * fit.scale,
            fit,
            size: self.size_mm,
            travel: self.travel_mm,
            press_at: self.press_at,
            release_at: self.release_at.unwrap_or(match self.contact {
                ContactSchema::Touch => ReleaseAt::default(),
                ContactSchema::Bend => ReleaseAt::BEND,
            }),
            contact: self.contact,
            press: self.press,
            swipe: self.swipe,
            max_share: match (self.gaps, has_neighbors) {
                (GapsSchema::Dead, _) => 0.0,
                (GapsSchema::Nearest, true) => SHARE_BESIDE_BOARDS,
                (GapsSchema::Nearest, false) => f32::INFINITY,
            },
        });
        let defaults = KeyDefaults {
            pitch: self.pitch_mm,
            debounce: self.debounce_ms,
            reports_depth: self.reports_depth,
        };
        for row in &self.rows {
            row.build(builder, defaults)?;
        }
        for key in &self.keys {
            let built = key.build(builder, defaults);
            builder.collect_key(key.name(), built)?;
        }
        self.build_controls(builder)?;
        builder.end_board(
            self.name.as_ref().map(|name| &*name.0),
            self.hand,
            self.pose.anchor.into(),
            self.pose.anchor_from_board(self.shape, &fit),
            self.pitch_mm.get(),
            self.auto_recenter.map(Into::into),
        )
    }
}
