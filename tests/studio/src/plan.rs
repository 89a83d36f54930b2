//! The plan of the layout editor: a person moves boards and targets in space, opens a board, and undoes.

use ademan::layout::Layout;
use ademan::studio::texts::text;
use egui::accesskit::{Role, Toggled};
use egui::{Key, Modifiers, Pos2, Rect, Vec2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::editor::{EditedFile, canvas, drag, press};
use crate::picture;
use crate::window::{Opening, StudioWindow};

/// A board for the fingers, and arcs for the thumb that move with the wrist. The fronts of the first one are 36 mm wide.
const FINGERS_AND_THUMB: &str = "// mine
Layout(
    name: \"Fingers and thumb\",
    boards: [
        // fingers
        (
            pose: (anchor: elbow, forward_mm: 320, height_mm: -45, /* x */ right_mm: 4),
            keys: [(code: \"A\", at_mm: (0, 0)), (code: \"B\", at_mm: (19, 0))],
        ),
        // thumb
        (
            pose: (anchor: elbow, forward_mm: 200, height_mm: -45, right_mm: -60),
            shape: Arc(radius_mm: 60),
            pitch_mm: 22,
            rows: [(at_mm: (-44, 0), keys: \"C D E F G\")],
        ),
    ],
)
";

/// Width of the first board in all views but that from the side, in millimetres.
const WIDTH_MM: f32 = 36.0;

const IN_SPACE: &str = "Layout(name: \"In space\", spaces: [(pose: (anchor: elbow), targets: [
    (name: \"Moon\", at_mm: (120, 0, -300), shape: Ball(50)), // a ball
    (name: \"Door\", at_mm: (160, 50, -320), shape: Box(60, 40, 30)),
])])
";

fn open_plan(file: &EditedFile) -> StudioWindow {
    let mut window = file.open();
    window.click(text("editor-plan"));
    window
}

/// Opens a layout in the editor of a session with another layout: the hand of the session plays that.
fn open_in_editor(file: &EditedFile, theme: egui::Theme) -> StudioWindow {
    let opening = Opening {
        theme,
        ..Opening::default()
    };
    let mut window = opening.open();
    window.open_in_editor(file.0.to_str().expect("a readable path"));
    window.click(text("workspace-layout"));
    window.draw(3);
    window
}

/// Returns the area of a board or target on the plan.
fn place(window: &StudioWindow, name: &str) -> Rect {
    let item = window
        .harness
        .get_by_role_and_label(Role::GraphicsObject, name);
    item.rect()
}

fn is_on_plan(window: &StudioWindow) -> bool {
    let mut canvases = window
        .harness
        .query_all_by_label(text("editor-plan-canvas"));
    canvases.next().is_some()
}

fn button(at: Pos2, pressed: bool) -> egui::Event {
    egui::Event::PointerButton {
        pos: at,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    }
}

#[test]
fn a_drag_in_the_front_view_is_written_undone_at_once_and_saved_with_its_comments() {
    let file = EditedFile::new("plan-front.ron", FINGERS_AND_THUMB);
    let mut window = open_plan(&file);
    window.click(text("editor-view-front"));
    let board = place(&window, "Board 1");
    let points_per_mm = board.width() / WIDTH_MM;
    drag(
        &mut window,
        board.center(),
        vec2(23.0, 31.0) * points_per_mm,
    );
    press(&mut window, Modifiers::COMMAND, Key::S);
    let moved = FINGERS_AND_THUMB
        .replace("right_mm: 4", "right_mm: 27")
        .replacen("height_mm: -45", "height_mm: -76", 1);
    assert_eq!(file.text(), moved);
    press(&mut window, Modifiers::NONE, Key::ArrowRight);
    press(&mut window, Modifiers::SHIFT, Key::ArrowUp);
    press(&mut window, Modifiers::COMMAND, Key::S);
    let nudged = moved
        .replace("right_mm: 27", "right_mm: 28")
        .replace("-76", "-75.9");
    assert_eq!(file.text(), nudged);
    for _ in 0..3 {
        press(&mut window, Modifiers::COMMAND, Key::Z);
    }
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert_eq!(file.text(), FINGERS_AND_THUMB);
}

/// Drags with the right button.
fn drag_right(window: &mut StudioWindow, from: Pos2, by: Vec2) {
    let secondary = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    for event in [
        egui::Event::PointerMoved(from),
        secondary(from, true),
        egui::Event::PointerMoved(from + by / 2.0),
        egui::Event::PointerMoved(from + by),
        secondary(from + by, false),
    ] {
        window.harness.event(event);
        window.draw(2);
    }
}

#[test]
fn the_free_view_is_turned_by_mouse_and_keys_and_stays_while_the_window_lives() {
    let file = EditedFile::new("plan-free.ron", FINGERS_AND_THUMB);
    let mut window = open_plan(&file);
    window.click(text("editor-view-free"));
    let ways = |window: &StudioWindow| {
        place(window, "Board 2").center() - place(window, "Board 1").center()
    };
    let first = ways(&window);
    let corner = canvas(&window).center_top() + vec2(0.0, 30.0);
    drag_right(&mut window, corner, vec2(120.0, -40.0));
    let turned = ways(&window);
    assert!((turned - first).length() > 30.0, "{first} {turned}");
    press(&mut window, Modifiers::NONE, Key::ArrowRight);
    let by_key = ways(&window);
    assert!((by_key - turned).length() > 5.0, "nothing is selected");
    window.click(text("view-above"));
    window.click(text("editor-view-free"));
    assert!((ways(&window) - by_key).length() < 0.5);
    let before = place(&window, "Board 1");
    drag(&mut window, before.center(), vec2(-60.0, 45.0));
    let moved = place(&window, "Board 1").center() - before.center();
    assert!((moved - vec2(-60.0, 45.0)).length() < 5.0, "{moved}");
    press(&mut window, Modifiers::COMMAND, Key::ArrowRight);
    let selected_way = ways(&window);
    press(&mut window, Modifiers::COMMAND, Key::ArrowLeft);
    assert!((ways(&window) - selected_way).length() > 5.0, "it turns");
    press(&mut window, Modifiers::COMMAND, Key::Z);
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert_eq!(file.text(), FINGERS_AND_THUMB, "one step of undo");
    let other = EditedFile::new("plan-free-other.ron", FINGERS_AND_THUMB);
    window.open_in_editor(other.0.to_str().expect("a readable path"));
    window.click(text("editor-plan"));
    assert!((ways(&window).normalized() - by_key.normalized()).length() < 0.05);
}

#[test]
fn the_free_view_does_not_turn_while_a_board_is_dragged() {
    let file = EditedFile::new("plan-both-buttons.ron", FINGERS_AND_THUMB);
    let mut window = open_plan(&file);
    window.click(text("editor-view-free"));
    let still = place(&window, "Board 2").center();
    let from = place(&window, "Board 1").center();
    let to = from + vec2(-60.0, 45.0);
    let second = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    for event in [
        egui::Event::PointerMoved(from),
        button(from, true),
        egui::Event::PointerMoved(from.lerp(to, 0.3)),
        second(from.lerp(to, 0.3), true),
        egui::Event::PointerMoved(to),
        button(to, false),
        second(to, false),
    ] {
        window.harness.event(event);
        window.draw(2);
    }
    let moved = place(&window, "Board 1").center() - from;
    assert!((moved - vec2(-60.0, 45.0)).length() < 5.0, "{moved}");
    assert!((place(&window, "Board 2").center() - still).length() < 1.0);
}

#[test]
fn boards_in_one_place_are_listed_during_the_drag_and_escape_undoes_it() {
    let file = EditedFile::new("plan-overlap.ron", FINGERS_AND_THUMB);
    let mut window = open_plan(&file);
    let from = place(&window, "Board 1").center();
    let to = place(&window, "Board 2").center_top() + vec2(0.0, 10.0);
    for event in [
        egui::Event::PointerMoved(from),
        button(from, true),
        egui::Event::PointerMoved(from.lerp(to, 0.5)),
        egui::Event::PointerMoved(to),
    ] {
        window.harness.event(event);
        window.draw(2);
    }
    assert!(window.has_words("boards 1 and 2 overlap by"));
    let right = window
        .harness
        .get_by_role_and_label(Role::SpinButton, "pose · right");
    let right = right.value().expect("the form shows the number");
    assert!(right.starts_with(['-', '−']), "the form follows: {right}");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(!window.has_words("overlap by"), "the drag is undone");
    window.harness.event(button(to, false));
    window.draw(2);
    assert!(!window.has_words("overlap by"));
    assert!(!window.is_enabled(text("editor-undo")));
}

#[test]
fn a_drag_of_two_frames_moves_a_board_from_its_press_to_its_release() {
    let file = EditedFile::new("plan-slow.ron", FINGERS_AND_THUMB);
    let mut window = open_plan(&file);
    window.click(text("editor-view-front"));
    let board = place(&window, "Board 1");
    let way = vec2(23.0, 31.0) * (board.width() / WIDTH_MM);
    let (from, to) = (board.center(), board.center() + way);
    let moved = egui::Event::PointerMoved;
    let frames = [
        [moved(from), button(from, true), moved(from + way * 0.6)],
        [moved(to), button(to, false), moved(to + way)],
    ];
    for events in frames {
        window.harness.input_mut().events.extend(events);
        window.draw(1);
    }
    press(&mut window, Modifiers::COMMAND, Key::S);
    let expected = FINGERS_AND_THUMB
        .replace("right_mm: 4", "right_mm: 27")
        .replacen("height_mm: -45", "height_mm: -76", 1);
    assert_eq!(file.text(), expected);
}

#[test]
fn a_board_that_is_pasted_beyond_the_picture_is_shown() {
    let file = EditedFile::new("plan-pasted.ron", FINGERS_AND_THUMB);
    let mut window = open_plan(&file);
    let pasted = "(boards: [(pose: (anchor: elbow, forward_mm: 320, right_mm: 900), \
                  keys: [(code: \"X\", at_mm: (0, 0))])])";
    window.harness.event(egui::Event::Paste(pasted.to_owned()));
    window.draw(3);
    let (area, shown) = (canvas(&window), place(&window, "Board 3"));
    assert!(area.contains_rect(shown), "{shown} in {area}");
}

#[test]
fn a_double_click_opens_a_board_and_escape_leads_back() {
    let file = EditedFile::new("plan-open.ron", FINGERS_AND_THUMB);
    let mut window = open_plan(&file);
    assert!(is_on_plan(&window));
    let at = place(&window, "Board 2").center_top() + vec2(0.0, 4.0);
    window.harness.hover_at(at);
    window.draw(2);
    let now = window.harness.ctx.input(|input| input.time);
    // The clicks of a slow hand, or of a machine that draws five frames a second.
    for after_s in [1.0, 1.4] {
        let input = window.harness.input_mut();
        input.time = Some(now + after_s);
        input.events.extend([button(at, true), button(at, false)]);
        window.draw(1);
    }
    window.harness.input_mut().time = None;
    window.draw(2);
    assert!(!is_on_plan(&window), "the board is open");
    let center = canvas(&window).center();
    drag(&mut window, center, Vec2::ZERO);
    assert!(window.has_words("Key E"), "its keys are selected there");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(!is_on_plan(&window), "the first Escape deselects the key");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(is_on_plan(&window));
}

#[test]
fn a_layout_of_targets_in_space_opens_on_the_plan_and_they_are_moved() {
    let file = EditedFile::new("plan-space.ron", IN_SPACE);
    let mut window = open_in_editor(&file, egui::Theme::Dark);
    assert!(is_on_plan(&window));
    window.click(text("view-side"));
    let moon = place(&window, "Moon");
    let points_per_mm = moon.width() / 50.0;
    drag(
        &mut window,
        moon.center(),
        vec2(-12.0, -20.0) * points_per_mm,
    );
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert_eq!(
        file.text(),
        IN_SPACE.replace("(120, 0, -300)", "(120, 20, -288)")
    );
}

#[test]
fn a_copied_board_overlaps_no_other_one_and_is_undone_at_once() {
    let file = EditedFile::new("plan-copy-board.ron", FINGERS_AND_THUMB);
    let mut window = open_plan(&file);
    let fingers = place(&window, "Board 1");
    drag(&mut window, fingers.center(), Vec2::ZERO);
    press(&mut window, Modifiers::COMMAND, Key::D);
    assert!(place(&window, "Board 3").min.x > place(&window, "Board 1").max.x);
    // The room beside the first board is taken: the second copy is farther away.
    let fingers = place(&window, "Board 1");
    drag(&mut window, fingers.center(), Vec2::ZERO);
    press(&mut window, Modifiers::COMMAND, Key::D);
    press(&mut window, Modifiers::COMMAND, Key::S);
    let layout = Layout::parse(&file.text(), "copied.ron").expect("a layout");
    assert_eq!(layout.boards.len(), 4);
    assert_eq!(layout.board_overlaps(), []);
    assert!(
        file.text()
            .contains("(code: \"B\", name: \"B 3\", at_mm: (19, 0))")
    );
    for _ in 0..2 {
        press(&mut window, Modifiers::COMMAND, Key::Z);
    }
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert_eq!(file.text(), FINGERS_AND_THUMB);
}

#[test]
fn a_right_click_offers_to_duplicate_a_board_and_a_key() {
    let file = EditedFile::new("menu.ron", FINGERS_AND_THUMB);
    let mut window = file.open();
    let duplicate = |window: &mut StudioWindow| {
        let entry = format!("{} Ctrl-D", text("editor-duplicate"));
        window.click(&entry);
    };
    window.harness.get_by_label("Board 2").click_secondary();
    window.draw(3);
    duplicate(&mut window);
    let tab = window.harness.get_by_label("Board 3").accesskit_node();
    assert_eq!(tab.toggled(), Some(Toggled::True), "the copy is shown");
    window.click("Board 1");
    let at = canvas(&window).center() + vec2(30.0, 0.0);
    window.harness.hover_at(at);
    for pressed in [true, false] {
        window.harness.event(egui::Event::PointerButton {
            pos: at,
            button: egui::PointerButton::Secondary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        window.draw(2);
    }
    duplicate(&mut window);
    press(&mut window, Modifiers::COMMAND, Key::S);
    let text = file.text();
    assert!(
        text.contains("name: \"C 2\"") && text.contains("name: \"B 2\""),
        "{text}"
    );
}

#[test]
fn a_copied_target_is_beside_its_original() {
    let file = EditedFile::new("plan-copy.ron", IN_SPACE);
    let mut window = open_in_editor(&file, egui::Theme::Dark);
    let moon = place(&window, "Moon").center();
    drag(&mut window, moon, Vec2::ZERO);
    press(&mut window, Modifiers::COMMAND, Key::D);
    let items = window.harness.query_all_by_role(Role::GraphicsObject);
    let places: Vec<Rect> = items.map(|item| item.rect()).collect();
    let moon = place(&window, "Moon");
    assert_eq!(places.len(), 3);
    assert!(places.iter().any(|it| it.min.x > moon.max.x), "{places:?}");
}

/// Returns the part of the plan that the only board takes, in the direction in which it takes more, if it is within the plan.
fn part_of_plan(window: &StudioWindow) -> Option<f32> {
    let plan = window.rect_of(text("editor-plan-canvas"));
    let board = place(window, "Board 1");
    let part = board.size() / plan.size();
    plan.contains_rect(board).then(|| part.max_elem())
}

#[test]
fn the_plan_is_fitted_to_each_size_until_it_is_zoomed() {
    let opening = Opening {
        size: [1280.0, 720.0],
        pixels_per_point: 2.0,
        ..Opening::on_layout("qwerty-flat")
    };
    let mut window = opening.open();
    window.click(text("workspace-layout"));
    window.click(text("editor-plan"));
    window.draw(3);
    // All but the empty edge, and corners of the plate without keys.
    let fitted = 0.70..0.90;
    let is_fitted =
        |window: &StudioWindow| part_of_plan(window).is_some_and(|it| fitted.contains(&it));
    assert!(is_fitted(&window), "{:?}", part_of_plan(&window));
    for size in [vec2(1000.0, 560.0), vec2(1600.0, 1000.0)] {
        window.harness.set_size(size);
        window.draw(3);
        assert!(is_fitted(&window), "{size}: {:?}", part_of_plan(&window));
    }
    let board = place(&window, "Board 1");
    window.harness.hover_at(board.center());
    window.harness.event(egui::Event::Zoom(0.5));
    window.draw(3);
    let zoomed = place(&window, "Board 1");
    assert!(zoomed.width() < board.width() * 0.6, "{zoomed}");
    window.harness.set_size(vec2(1280.0, 720.0));
    window.draw(3);
    assert_eq!(place(&window, "Board 1").size(), zoomed.size());
}

/// Keys for four fingers before the elbow, arcs for the thumb that move with the wrist, an upright board, and a ball.
const WORKPLACE: &str = "Layout(
    name: \"Workplace\",
    boards: [
        (
            pose: (anchor: elbow, bearing_deg: 10, forward_mm: 400, height_mm: -50, tilt_deg: 10),
            shape: Arc(radius_mm: 400),
            rows: [
                (at_mm: (-66.5, 9.5), keys: \"Q W E R T Y U I\"),
                (at_mm: (-62, -9.5), keys: \"A S D F G H J\"),
            ],
        ),
        (
            pose: (anchor: wrist, bearing_deg: -25, right_mm: -30, forward_mm: 60, height_mm: -60),
            shape: Arc(radius_mm: 70),
            pitch_mm: 22,
            rows: [(at_mm: (-44, 0), keys: \"Space Enter Tab Escape Delete\")],
        ),
        (
            pose: (anchor: elbow, bearing_deg: 40, forward_mm: 430, height_mm: 20, tilt_deg: 75),
            sliders: [
                (name: \"Volume\", at_mm: (0, 12), length_mm: 80),
                (name: \"Light\", at_mm: (0, -12), length_mm: 80),
            ],
        ),
    ],
    spaces: [(
        pose: (anchor: elbow),
        targets: [(name: \"Stop\", at_mm: (-160, 60, -380), shape: Ball(60))],
    )],
)
";

#[test]
fn the_plan_shows_boards_arcs_and_targets_where_they_are() {
    for (theme, name) in [(egui::Theme::Dark, "dark"), (egui::Theme::Light, "light")] {
        let file = EditedFile::new(&format!("plan-{name}.ron"), WORKPLACE);
        let mut window = open_in_editor(&file, theme);
        window.click(text("editor-plan"));
        let thumb = place(&window, "Board 2");
        drag(&mut window, thumb.center(), Vec2::ZERO);
        for view in [
            "editor-view-free",
            "editor-view-front",
            "view-side",
            "view-above",
        ] {
            window.click(text(view));
            picture::draw(&mut window, &format!("plan-{name}-{view}"));
        }
        let plan = canvas(&window);
        let panel = Rect::from_x_y_ranges(window.workspace().x_range(), plan.y_range());
        if theme == egui::Theme::Dark {
            picture::compare(&mut window, "studio-plan", panel);
        }
    }
}
