//! The lab: a person runs it on the layout that is edited, compares, and watches the worst simulated person.

use ademan::studio::texts::text;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::editor::{EditedFile, canvas, drag};
use crate::picture;
use crate::window::{Opening, StudioWindow};

/// Keys with room between them, so that a moved one overlaps no other.
const FIVE_KEYS: &str = "Layout(
    name: \"Five keys\",
    boards: [
        (
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
            keys: [
                (code: \"A\", at_mm: (0, 0)),
                (code: \"E\", at_mm: (40, 0)),
                (code: \"S\", at_mm: (-40, 0)),
                (code: \"T\", at_mm: (0, 40)),
                (code: \"Space\", at_mm: (0, -40)),
            ],
        ),
    ],
)
";

/// Runs the lab with a few people, and waits for the figures.
pub fn run(window: &mut StudioWindow, people: f64) {
    window.click(text("workspace-lab"));
    window.set_number(Role::SpinButton, text("lab-people"), people);
    window.set_number(Role::SpinButton, text("lab-phrases"), 1.0);
    window.click(text("lab-run"));
    finish(window);
}

fn finish(window: &mut StudioWindow) {
    let is_done = |window: &StudioWindow| {
        !window.has(text("lab-cancel")) && window.has(text("lab-worst-people"))
    };
    window.draw_until("the figures of the lab", is_done);
    window.draw(2);
}

/// Returns the name of the bar of the worst person.
pub fn worst(window: &StudioWindow) -> String {
    let is_bar = |label: &String| label.starts_with("Person ");
    let bars = window.harness.get_all_by_role(Role::Button);
    let mut bars = bars.filter_map(|bar| bar.accesskit_node().label());
    bars.find(is_bar).expect("a bar")
}

#[test]
fn a_layout_is_scored_and_its_worst_person_is_watched_while_the_session_goes_on() {
    let mut window = Opening::on_layout("qwerty-flat").open();
    run(&mut window, 4.0);
    assert!(window.has(text("lab-wpm")) && window.has(text("lab-substitutions")));
    let board = window.rect_of(text("lab-board"));
    assert!(board.width() > 300.0, "{board:?}");
    picture::document(&mut window, "studio-lab");

    let layout = window.model().view.layout.file.clone();
    let accepted = window.model().stats.accepted;
    let bar = worst(&window);
    window.click(&bar);
    let is_watched = |window: &StudioWindow| window.has(text("lab-watch-back"));
    window.draw_until("the person in the 3D view", is_watched);
    assert!(window.has(&bar), "who is watched is named");
    let can_go_on = |window: &StudioWindow| window.is_enabled(text("lab-watch-next"));
    window.draw_until("all readings of the person", can_go_on);
    window.click(text("lab-watch-next"));
    window.draw(40);
    // The picture of the guide is made by hand: this one has a path of this machine.
    picture::draw(&mut window, "studio-lab-watch");
    // The session is another one than what is shown.
    assert_eq!(window.model().view.layout.file, layout);
    window.play(50);
    assert!(window.model().stats.accepted >= accepted + 50);
    window.click(text("lab-watch-back"));
    let is_back = |window: &StudioWindow| {
        !window.has(text("lab-watch-back")) && window.has(text("lab-worst-people"))
    };
    window.draw_until("the figures again", is_back);
}

#[test]
fn an_edited_layout_is_compared_with_the_saved_one() {
    let file = EditedFile::new("lab.ron", FIVE_KEYS);
    let mut window = file.open();
    let center = canvas(&window).center();
    drag(&mut window, center, egui::vec2(25.0, 0.0));
    window.click(text("workspace-lab"));
    window
        .harness
        .get_by_role_and_label(Role::RadioButton, text("lab-compare-saved"))
        .click();
    window.draw(3);
    run(&mut window, 2.0);
    assert!(window.has_words(" minus "), "a comparison");
    assert!(!window.has(text("lab-stale")));
    window.click(text("workspace-layout"));
    let center = canvas(&window).center();
    drag(&mut window, center, egui::vec2(20.0, 0.0));
    window.click(text("workspace-lab"));
    assert!(
        window.has(text("lab-stale")),
        "the figures are of the text before"
    );
}

#[test]
fn the_lab_shows_the_whole_board_whatever_the_editor_shows() {
    let mut window = Opening::on_layout("qwerty-flat").open();
    window.click(text("workspace-lab"));
    let board = |window: &mut StudioWindow, name: &str| {
        window.draw(2);
        let area = window.rect_of(text("lab-board"));
        picture::draw(window, name).map(|picture| picture::crop(&picture, area))
    };
    let whole = board(&mut window, "studio-lab-whole");
    window.click(text("workspace-layout"));
    let center = canvas(&window).center();
    window.harness.hover_at(center);
    zoom(&mut window, 4.0);
    window.click(text("workspace-lab"));
    let after_editor = board(&mut window, "studio-lab-after-editor");
    assert!(whole == after_editor, "the zoom of the editor");
    let center = window.rect_of(text("lab-board")).center();
    window.harness.hover_at(center);
    zoom(&mut window, 2.0);
    let zoomed = board(&mut window, "studio-lab-zoomed");
    assert!(zoomed.is_none() || whole != zoomed, "the zoom of the lab");
}

/// Zooms at the mouse.
fn zoom(window: &mut StudioWindow, factor: f32) {
    window.harness.event(egui::Event::Zoom(factor));
    window.draw(2);
}

#[test]
fn a_run_is_cancelled_and_a_wrong_name_is_an_error() {
    let mut window = Opening::on_layout("qwerty-arc").open();
    window.click(text("workspace-lab"));
    window.set_number(Role::SpinButton, text("lab-people"), 900.0);
    window.click(text("lab-run"));
    assert!(window.has(text("lab-cancel")));
    window.click(text("lab-cancel"));
    let is_over = |window: &StudioWindow| window.has(text("lab-run"));
    window.draw_until("the end of the run", is_over);
    assert!(window.has(text("lab-no-results")));
    window
        .harness
        .get_by_role_and_label(Role::RadioButton, text("lab-compare-file"))
        .click();
    window.draw(3);
    assert!(!window.is_enabled(text("lab-run")));
    window.enter(text("lab-compare-name"), "qwerty-flta");
    window.click(text("lab-run"));
    assert!(window.has_words("qwerty-flat"), "a proposal for the name");
    assert!(!window.has(text("lab-cancel")));
}

#[test]
fn the_lab_is_drawn_in_light_and_dark() {
    for (theme, name) in [
        (egui::Theme::Light, "studio-lab-light"),
        (egui::Theme::Dark, "studio-lab-dark"),
    ] {
        let opening = Opening {
            theme,
            ..Opening::on_layout("qwerty-two-arc")
        };
        let mut window = opening.open();
        run(&mut window, 3.0);
        picture::draw(&mut window, name);
    }
}
