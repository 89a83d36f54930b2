//! The pages of the first start.

use eframe::egui::{self, Key, Modifiers, RichText};

use super::actions;
use crate::first_start::{Answers, FirstStart, LAYOUTS, Page, Port};
use crate::texts::{text, text_with};
use ademan_core::hand::Side;
use ademan_core::message::{escape, escape_path};
use ademan_runtime::capture::SourceUri;
use ademan_runtime::capture::cameras::Camera;
use ademan_runtime::capture::recognition::Recognition;

/// Space around the pages, in points.
const MARGIN: i8 = 32;

/// Width of the pages, in points.
const WIDTH: f32 = 760.0;

/// Height of the row of buttons with the space above it, in points.
const BUTTONS_HEIGHT: f32 = 84.0;

/// Draws the present page. Returns the answers once the session is to start.
pub fn show(ui: &mut egui::Ui, first: &mut FirstStart) -> Option<Answers> {
    let mut answers = None;
    ui.input_mut(actions::drop_held_clicks);
    let frame = egui::Frame::central_panel(ui.style()).inner_margin(MARGIN);
    egui::CentralPanel::default().frame(frame).show(ui, |ui| {
        ui.set_max_width(WIDTH);
        let height = (ui.available_height() - BUTTONS_HEIGHT).max(80.0);
        let area = egui::ScrollArea::vertical().max_height(height);
        area.auto_shrink(false).show(ui, |ui| {
            ui.label(RichText::new(text("first-title")).size(15.0));
            ui.add_space(4.0);
            ui.heading(RichText::new(text(heading(first.page()))).size(26.0));
            ui.add_space(14.0);
            ui.spacing_mut().item_spacing.y = 8.0;
            match first.page() {
                Page::Source => show_sources(ui, first),
                Page::Hand => show_hands(ui, first),
                Page::Layout => show_layouts(ui, first),
                Page::Start => show_summary(ui, first),
            }
            if let Some(error) = &first.error {
                ui.label(large(&format!("× {error}")));
            }
        });
        ui.add_space(16.0);
        ui.horizontal(|ui| answers = show_buttons(ui, first));
    });
    answers
}

fn heading(page: Page) -> &'static str {
    match page {
        Page::Source => "first-source",
        Page::Hand => "first-hand",
        Page::Layout => "first-layout",
        Page::Start => "first-start",
    }
}

fn large(words: &str) -> RichText {
    RichText::new(words).size(16.0)
}

fn show_sources(ui: &mut egui::Ui, first: &mut FirstStart) {
    let chosen = first.source().cloned();
    let mut answer = None;
    let search = first.search();
    if search.ports().is_empty() {
        ui.label(large(text("first-no-port")));
    }
    for port in search.ports() {
        ui.label(large(&words_of(port, "first-silent")));
        let sources = match &port.heard {
            Some(Ok(Recognition::Sources(sources))) => sources.as_slice(),
            _ => &[],
        };
        for source in sources {
            let is_chosen = chosen.as_ref() == Some(source);
            if ui.radio(is_chosen, large(&name_of(source))).clicked() {
                answer = Some(Some(source.clone()));
            }
        }
    }
    for camera in search.cameras() {
        ui.label(large(&words_of_camera(camera)));
    }
    ui.add_space(6.0);
    let simulated = large(text("first-simulated"));
    if ui.radio(chosen.is_none(), simulated).clicked() {
        answer = Some(None);
    }
    ui.label(text("first-simulated-words"));
    if let Some(source) = answer {
        first.choose_source(source);
    }
}

/// Returns the name of a camera, and what to do with it.
pub(super) fn words_of_camera(camera: &Camera) -> String {
    let path = escape_path(&camera.path);
    let name = match camera.name.as_str() {
        "" => path.to_string(),
        name => format!("{name} ({path})"),
    };
    let values = [
        ("camera", name.into()),
        ("command", camera.command().into()),
    ];
    text_with("first-camera", &values)
}

/// Returns what was heard on a port. `silent` is the key of the text about a port that sends nothing, which says how to listen again.
pub(super) fn words_of(port: &Port, silent: &'static str) -> String {
    let name = ("port", escape(&port.name).into_owned().into());
    match &port.heard {
        None => text_with("first-listening", &[name]),
        Some(Ok(Recognition::Sources(_))) => text_with("first-recognized", &[name]),
        Some(Ok(Recognition::Unknown(bytes))) => {
            text_with("first-unknown", &[name, ("bytes", (*bytes).into())])
        }
        Some(Ok(Recognition::Silent)) => text_with(silent, &[name]),
        Some(Err(reason)) => text_with(
            "first-closed",
            &[name, ("reason", escape(reason).into_owned().into())],
        ),
    }
}

/// Returns the protocol of a source and its address.
pub(super) fn name_of(source: &SourceUri) -> String {
    let title = source.protocol().map(|protocol| protocol.title());
    let source = source.to_string();
    format!("{} ({})", title.unwrap_or_default(), escape(&source))
}

fn show_hands(ui: &mut egui::Ui, first: &mut FirstStart) {
    ui.label(large(text("first-hand-words")));
    for (side, name) in [(Side::Right, "first-right"), (Side::Left, "first-left")] {
        if ui.radio(first.side() == side, large(text(name))).clicked() {
            first.choose_side(side);
        }
    }
}

fn show_layouts(ui: &mut egui::Ui, first: &mut FirstStart) {
    let proposal = first.proposal().map(str::to_owned);
    let chosen = first.layout();
    let (proposal, chosen) = match (proposal, chosen) {
        (Ok(proposal), Ok(chosen)) => (proposal, chosen),
        (Err(error), _) | (_, Err(error)) => {
            ui.label(large(&format!("× {error}")));
            return;
        }
    };
    let words = text_with("first-layout-words", &[("layout", proposal.clone().into())]);
    ui.label(large(&words));
    let is_proposal = |name: &str| name == proposal;
    let (proposed, others): (Vec<_>, Vec<_>) =
        LAYOUTS.iter().partition(|layout| is_proposal(&layout.name));
    let mirrored = first.mirrored().map(|it| (it.name(), it.original));
    if let Some((name, original)) = mirrored {
        let description = text_with("first-mirrored", &[("layout", original.into())]);
        show_layout(ui, first, &name, &description, &chosen);
    }
    for layout in proposed.into_iter().chain(others) {
        show_layout(ui, first, &layout.name, &layout.description, &chosen);
    }
}

fn show_layout(
    ui: &mut egui::Ui,
    first: &mut FirstStart,
    name: &str,
    description: &str,
    chosen: &str,
) {
    ui.horizontal(|ui| {
        if ui.radio(name == chosen, large(name)).clicked() {
            first.choose_layout(name);
        }
        ui.add(egui::Label::new(description).truncate());
    });
}

fn show_summary(ui: &mut egui::Ui, first: &mut FirstStart) {
    let source = first.source().map(name_of);
    let hand = match first.side() {
        Side::Right => text("first-right"),
        Side::Left => text("first-left"),
    };
    let layout = first.layout().unwrap_or_default();
    let grid = egui::Grid::new("answers").num_columns(2);
    grid.spacing([24.0, 8.0]).show(ui, |ui| {
        for (name, value) in [
            (
                text("first-summary-source"),
                source.as_deref().unwrap_or(text("first-simulated")),
            ),
            (text("first-summary-hand"), hand),
            (text("first-summary-layout"), &layout),
        ] {
            ui.label(large(name).strong());
            ui.label(large(value));
            ui.end_row();
        }
    });
    ui.add_space(8.0);
    if first.needs_glove() {
        let words = large(text("first-calibrate"));
        ui.checkbox(first.is_calibrated(), words);
    }
    if first.source().is_some() {
        ui.checkbox(first.is_kept(), large(text("first-keep")));
    }
    ui.label(large(text("typing-nowhere")));
}

/// Shows the buttons. Returns the answers once the session is to start.
fn show_buttons(ui: &mut egui::Ui, first: &mut FirstStart) -> Option<Answers> {
    ui.spacing_mut().button_padding = egui::vec2(14.0, 7.0);
    let page = first.page();
    let is_last = page == Page::Start;
    let next = ui.button(large(if is_last {
        text("first-begin")
    } else {
        text("tour-next")
    }));
    if ui.memory(|memory| memory.focused().is_none()) {
        next.request_focus();
    }
    let back = egui::Button::new(large(text("tour-back")));
    let back = ui.add_enabled(page != Page::Source, back);
    let is_skipped = !is_last && ui.button(large(text("first-skip"))).clicked();
    let escape = ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape));
    let is_all_skipped = ui.button(large(text("first-skip-all"))).clicked() || escape;
    let values = [
        ("step", (page as usize + 1).into()),
        ("count", Page::ALL.len().into()),
    ];
    ui.label(text_with("tour-step", &values));
    if is_all_skipped {
        return Some(FirstStart::skipped());
    }
    if next.clicked() && is_last {
        return match first.answers() {
            Ok(answers) => Some(answers),
            Err(error) => {
                first.error = Some(error.to_string());
                None
            }
        };
    }
    if next.clicked() {
        first.advance();
    } else if back.clicked() {
        first.go_back();
    } else if is_skipped {
        first.skip();
    }
    None
}
