//! Boards with figures of their targets as colors.

use super::canvas::Canvas;
use super::controls::{draw_outline, placement};
use super::page::{self, Section};
use super::{TooManyShapes, board, document, element, text_width};
use crate::contact::TargetId;
use crate::layout::model::Layout;
use crate::layout::render::wearer::Wearer;

/// Number of steps of the color.
const STEPS: f32 = 8.0;

/// A figure of a target: a color over its front.
#[derive(Clone, Debug, PartialEq)]
pub struct Heat {
    /// The target.
    pub target: TargetId,
    /// The strength of the color, 0..=1; 0 is none.
    pub part: f32,
    /// The words that programs show as a tooltip and read aloud.
    pub words: String,
}

impl Layout {
    /// Returns one SVG element for each board, without a style sheet, with colors over its targets. [`heat_style`] has the
    /// rules for them.
    pub fn to_heat_svgs(&self, heats: &[Heat]) -> Result<Vec<String>, TooManyShapes> {
        self.check_size()?;
        let boards = 0..self.boards.len();
        let drawings = boards.map(|index| element(&draw(self, index, &Wearer::default(), heats)));
        Ok(drawings.collect())
    }

    /// Returns a drawing of the boards, one below the other, with colors over their targets, below a note.
    pub fn to_heat_svg(
        &self,
        wearer: &Wearer,
        heats: &[Heat],
        note: &str,
    ) -> Result<String, TooManyShapes> {
        self.check_size()?;
        let boards = 0..self.boards.len();
        let sections: Vec<Section> = boards
            .map(|index| Section {
                heading: None,
                content: draw(self, index, wearer, heats),
            })
            .collect();
        let page = page::compose(&self.name, note, &sections, text_width(self));
        Ok(document(&self.name, &page, &heat_style("")))
    }
}

fn draw(layout: &Layout, index: usize, wearer: &Wearer, heats: &[Heat]) -> Canvas {
    let mut view = board::draw(layout, index, wearer);
    for face in layout.faces(&layout.boards[index]) {
        let Some(heat) = heats.iter().find(|heat| heat.target == face.target) else {
            continue;
        };
        let step = (heat.part.clamp(0.0, 1.0) * STEPS).ceil() as u32;
        let mut front = Canvas::default();
        draw_outline(&format!("heat heat-{step}"), &face.outline, 0.0, &mut front);
        view.group(placement(&face.outline), Some(&heat.words), &front);
    }
    view
}

/// Returns the rules of drawings with colors: light, or dark where the reader prefers it. `rules` are added, in which `$role` stands
/// for the color of a role, as in the drawings.
pub fn heat_style(rules: &str) -> String {
    let steps = (0..=STEPS as u32).map(|step| {
        let opacity = f64::from(step) / f64::from(STEPS) * 0.75;
        format!(".heat-{step}{{fill-opacity:{opacity:.2}}}\n")
    });
    let heat = ".heat{fill:$warn}\n".to_owned() + &steps.collect::<String>();
    super::colored(&(rules.to_owned() + &heat)) + &super::sheet()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_has_its_color_and_its_words_and_the_others_have_none() {
        let shipped = Layout::shipped().expect("valid layouts");
        let (_, layout) = shipped
            .into_iter()
            .find(|(name, _)| *name == "numpad")
            .expect("a layout");
        let heat = Heat {
            target: layout.keys[0].face.target,
            part: 0.5,
            words: "7 <of> 10".into(),
        };
        let drawings = layout.to_heat_svgs(&[heat]).expect("a small layout");
        assert_eq!(drawings.len(), 1);
        assert_eq!(drawings[0].matches("heat heat-4").count(), 1);
        assert!(drawings[0].contains("7 &lt;of&gt; 10"), "{}", drawings[0]);
        assert!(!heat_style("").contains('$'));
    }
}
