//! Radial menus.

use std::f32::consts::{FRAC_PI_2, TAU};

use arrayvec::ArrayVec;
use parry3d::math::Vec2;
use serde::Deserialize;

use super::{ControlModel, Front, Handle, KindSpec};
use crate::contact::surface::DRAG_MARGIN;
use crate::device::radial_menu::{
    Choice, MAX_MODIFIERS, MAX_SECTORS, MenuState, RadialMenu, Sector,
};
use crate::device::{KeyAction, KeyCode};
use crate::document::{DocumentError, Spanned, ranged_numbers, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{ControlKind, Face};
use crate::layout::quantity::{Offset, Size};
use crate::layout::render::drawing::{Canvas, Words, draw_fitted, draw_label, draw_outline};
use crate::layout::schema::{Action, Label, OutlineSchema};

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "RadialMenu",
    name: "radial menu",
    words: ["Radial menu", "Menú radial"],
    new: r#"(name: "Menu", at_mm: AT, diameter_mm: 60, sectors: [(name: "Copy", tap: Key("C"), with: "Control"), (name: "Paste", tap: Key("V"), with: "Control")])"#,
};

/// The minimum diameter, in millimetres: with a hub of 0.2 its dead zone has a radius of 3 mm, above the tremor of a hand.
const MIN_DIAMETER_MM: f64 = 30.0;

ranged_numbers! {
    /// Diameter of the hub of a radial menu, as a fraction of its diameter.
    Hub = "a hub", 0.2 ..= 0.7, "", or 0.4;
}

schema! {
    /// A menu whose sectors are around the fingertip that presses its hub. The release over a sector taps its action.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "RadialMenu", deny_unknown_fields)]
    pub(in crate::layout) struct RadialMenuSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on its hub. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center.
        at_mm: (Offset, Offset),
        /// Outer diameter, at least 30. A fingertip that slides by half of it over a sector with a `menu` opens that.
        diameter_mm: Size,
        /// Diameter of the hub, which opens the menu, and of the dead zone around the fingertip, as a fraction of `diameter_mm`.
        #[serde(default)]
        hub: Hub,
        /// 2 to 8 sectors, clockwise; the first is away from you.
        #[serde(borrow)]
        sectors: Vec<SectorSchema<'a>>,
    }
}

schema! {
    /// A sector of a radial menu, with a `tap` or a `menu`.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Sector", deny_unknown_fields)]
    struct SectorSchema<'a> {
        /// Name in messages.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Action that is tapped.
        #[serde(borrow, default)]
        tap: Option<Action<'a>>,
        /// Names of up to 4 modifier keys that are held during the tap, separated by blanks.
        #[serde(borrow, default)]
        with: Option<Spanned<'a>>,
        /// 2 to 8 sectors of a nested menu.
        #[serde(borrow, default)]
        menu: Vec<NestedSectorSchema<'a>>,
    }
}

schema! {
    /// A sector of a nested radial menu.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "NestedSector", deny_unknown_fields)]
    struct NestedSectorSchema<'a> {
        /// Name in messages.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Action that is tapped.
        #[serde(borrow)]
        tap: Action<'a>,
        /// Names of up to 4 modifier keys that are held during the tap, separated by blanks.
        #[serde(borrow, default)]
        with: Option<Spanned<'a>>,
    }
}

impl<'a> RadialMenuSchema<'a> {
    /// Adds the menu to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let name = self.name.text;
        check_count(builder, "radial menu", self.name, self.sectors.len())?;
        if self.diameter_mm.get() < MIN_DIAMETER_MM {
            let message = format!(
                "the radial menu `{name}` needs a `diameter_mm` of at least {MIN_DIAMETER_MM}: the sectors of a smaller one are narrower than tremor"
            );
            return Err(builder.error(name, message));
        }
        let sectors = self.sectors.iter().map(|sector| sector.build(builder));
        let sectors: Vec<Sector> = sectors.collect::<Result<_, _>>()?;
        let radius = builder.board().metres(self.diameter_mm.get()) / 2.0;
        let has_nested = self.sectors.iter().any(|sector| !sector.menu.is_empty());
        // The hub may be pressed at its edge, and a nested menu opens one radius away from there.
        let reach = if has_nested { 0.5 * radius } else { 0.0 };
        let spec = FaceSpec {
            size: OutlineSchema::Disc(self.diameter_mm),
            margin: reach + DRAG_MARGIN,
            ..builder.face_spec("radial menu", self.name, &self.label, self.at_mm)
        };
        builder.add_single_face(spec, |target| {
            ControlKind::RadialMenu(RadialMenu {
                target,
                radius,
                hub_radius: radius * self.hub.get() as f32,
                sectors,
                shown: MenuState::Idle,
            })
        })
    }
}

impl<'a> SectorSchema<'a> {
    fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<Sector, DocumentError> {
        let name = self.name.text;
        match self.tap {
            Some(tap) if self.menu.is_empty() => {
                let label = Label::or_name(&self.label, self.name);
                choice(builder, label, tap, self.with).map(Sector::Choice)
            }
            None if !self.menu.is_empty() && self.with.is_none() => {
                check_count(builder, "menu of the sector", self.name, self.menu.len())?;
                let choices = self.menu.iter().map(|sector| {
                    let label = Label::or_name(&sector.label, sector.name);
                    choice(builder, label, sector.tap, sector.with)
                });
                Ok(Sector::Menu {
                    choices: choices.collect::<Result<_, _>>()?,
                    label: Label::or_name(&self.label, self.name),
                })
            }
            _ => {
                let message = format!(
                    "the sector `{name}` needs either a `tap`, which may have a `with`, or a `menu`"
                );
                Err(builder.error(name, message))
            }
        }
    }
}

fn check_count(
    builder: &LayoutBuilder,
    kind: &str,
    name: Spanned,
    count: usize,
) -> Result<(), DocumentError> {
    if (2..=MAX_SECTORS).contains(&count) {
        return Ok(());
    }
    let name = name.text;
    let message = format!("the {kind} `{name}` needs 2 to {MAX_SECTORS} sectors, not {count}");
    Err(builder.error(name, message))
}

fn choice<'a>(
    builder: &mut LayoutBuilder<'a>,
    label: String,
    tap: Action<'a>,
    with: Option<Spanned<'a>>,
) -> Result<Choice, DocumentError> {
    let action = builder.action(tap, None)?;
    let modifiers = match with {
        Some(with) => modifiers(builder, with, action)?,
        None => ArrayVec::new(),
    };
    Ok(Choice {
        label,
        action,
        modifiers,
    })
}

/// Returns the modifiers of a `with`, which only keys can have.
fn modifiers<'a>(
    builder: &LayoutBuilder<'a>,
    with: Spanned<'a>,
    action: KeyAction,
) -> Result<ArrayVec<KeyCode, MAX_MODIFIERS>, DocumentError> {
    if !matches!(action, KeyAction::Key(_)) {
        return Err(builder.error(with.text, "only a `tap` of a key can have a `with`"));
    }
    let mut modifiers = ArrayVec::new();
    for text in with.text.split_whitespace() {
        let code = builder.key_code(Spanned { text })?;
        if !code.is_modifier() {
            return Err(builder.error(text, format!("`{code}` is not a modifier key")));
        }
        if modifiers.try_push(code).is_err() {
            let message = format!("a tap has at most {MAX_MODIFIERS} modifiers");
            return Err(builder.error(text, message));
        }
    }
    Ok(modifiers)
}

impl ControlModel for RadialMenu {
    fn handle(&self) -> Handle {
        Handle::Stick {
            half: (self.radius + self.hub_radius) / 2.0,
        }
    }

    fn set_value(&mut self, _: usize, value: f32) {
        self.shown = self.state(value);
    }

    fn value_label(&self, value: f32) -> Option<&str> {
        self.label(self.state(value))
    }

    fn describe(&self, words: &Words) -> Vec<String> {
        let sectors = self.sectors.iter().map(|sector| match sector {
            Sector::Choice(choice) => describe_choice(choice, words),
            Sector::Menu { label, choices } => {
                let choices = choices.iter().map(|choice| describe_choice(choice, words));
                format!("{label} ({})", choices.collect::<Vec<_>>().join(", "))
            }
        });
        let sectors = sectors.collect::<Vec<_>>().join(", ");
        vec![format!("radial menu, clockwise: {sectors}")]
    }

    fn draw(&self, front: &Front, canvas: &mut Canvas) {
        draw_menu(self, front.face, canvas);
    }
}

/// Returns the label of a choice and its keys: `Copy Ctrl+C`.
fn describe_choice(choice: &Choice, words: &Words) -> String {
    let mut keys: Vec<&str> = choice.modifiers.iter().map(|code| code.label()).collect();
    let action = words.action(choice.action);
    if keys.is_empty() && action == choice.label {
        return action;
    }
    keys.push(&action);
    format!("{} {}", choice.label, keys.join("+"))
}

/// Draws the hub with the sectors around it, or the sectors of the nested menu that is open.
fn draw_menu(menu: &RadialMenu, face: &Face, canvas: &mut Canvas) {
    draw_outline("well", &face.outline, 0.0, canvas);
    let ring = Ring {
        outer: menu.radius * 1e3,
        inner: menu.hub_radius * 1e3,
    };
    let open = match menu.shown {
        MenuState::Nested(index) => menu.sectors.get(index).map(|sector| (sector, None)),
        MenuState::Choice(index, choice) => {
            menu.sectors.get(index).map(|sector| (sector, Some(choice)))
        }
        MenuState::Idle | MenuState::Sector(_) => None,
    };
    let hub_label = match open {
        Some((sector, highlighted)) => {
            let labels = sector.nested().iter().map(|choice| (&*choice.label, false));
            ring.draw(labels, highlighted, canvas);
            sector.label()
        }
        None => {
            let highlighted = match menu.shown {
                MenuState::Sector(index) => Some(index),
                _ => None,
            };
            let sectors = menu.sectors.iter();
            let labels = sectors.map(|sector| (sector.label(), !sector.nested().is_empty()));
            ring.draw(labels, highlighted, canvas);
            &face.label
        }
    };
    canvas.circle("cap", Vec2::ZERO, ring.inner);
    let room = Vec2::new(ring.inner * 0.85, ring.inner * 0.4);
    draw_label("label", hub_label, Vec2::ZERO, room, canvas);
}

/// The ring of the sectors of a menu, in millimetres.
struct Ring {
    outer: f32,
    inner: f32,
}

/// The largest font size of a sector, in millimetres.
const MAX_SECTOR_LABEL: f32 = 4.2;

impl Ring {
    /// Draws sectors, each with its label and whether it has a nested menu.
    fn draw<'a>(
        &self,
        labels: impl ExactSizeIterator<Item = (&'a str, bool)>,
        highlighted: Option<usize>,
        canvas: &mut Canvas,
    ) {
        let width = TAU / labels.len() as f32;
        for (index, (label, has_menu)) in labels.enumerate() {
            let middle = index as f32 * width - FRAC_PI_2;
            if highlighted == Some(index) {
                let edges = [middle - width / 2.0, middle + width / 2.0];
                canvas.arc("mark", Vec2::ZERO, self.outer * 0.97, edges);
                canvas.arc("mark", Vec2::ZERO, self.inner * 1.08, edges);
            }
            let edge = Vec2::from_angle(middle + width / 2.0);
            canvas.line("range", [edge * self.inner, edge * self.outer]);
            let at = Vec2::from_angle(middle) * (self.outer + self.inner) / 2.0;
            let thickness = self.outer - self.inner;
            // A chord of the ring, which is as wide as the ring at the sides of the front.
            let chord = 2.0 * at.length() * (width / 2.0).min(FRAC_PI_2).sin();
            let side = Vec2::from_angle(middle).x.abs();
            let room = Vec2::new(
                chord + (thickness - chord) * side,
                thickness + (chord - thickness) * side,
            );
            let half = room * Vec2::new(0.45, 0.35);
            draw_fitted("label", label, at, half, MAX_SECTOR_LABEL, canvas);
            if has_menu {
                draw_chevron(middle, self.outer * 0.94, thickness * 0.1, canvas);
            }
        }
    }
}

/// Draws an arrow outwards at the edge of a sector with a nested menu.
fn draw_chevron(angle: f32, radius: f32, size: f32, canvas: &mut Canvas) {
    let direction = Vec2::from_angle(angle);
    let tip = direction * radius;
    let wings = [-1.0, 1.0].map(|side| tip - direction * size + direction.perp() * side * size);
    canvas.polyline("icon", &[wings[0], tip, wings[1]]);
}
