//! Pictures of layouts: each control with its shape and label, inside its outline and inside the page.

mod measure;

use ademan::files::Load;
use ademan::layout::{Face, Layout, Wearer};
use ademan::setup::Setup;
use measure::{Measured, Rect, measure};
use parry3d::math::Vec2;
use roxmltree::{Document, Node};

/// Returns the hands of the default setup at a shipped layout.
fn wearer(name: &str) -> Wearer {
    let setup = Setup {
        layout: name.into(),
        ..Setup::default()
    };
    setup.load_files().expect("a shipped layout").wearer()
}

fn parse(picture: &str) -> Document<'_> {
    Document::parse(picture).unwrap_or_else(|error| panic!("{error}:\n{picture}"))
}

/// Returns the groups that have a name.
fn groups<'a>(document: &'a Document, name: &str) -> Vec<Node<'a, 'a>> {
    let named = |node: &Node| {
        let mut children = node.children();
        children.any(|child| child.has_tag_name("title") && child.text() == Some(name))
    };
    let groups = document.descendants();
    groups
        .filter(|node| node.has_tag_name("g") && named(node))
        .collect()
}

fn texts(node: Node) -> Vec<String> {
    let texts = node.descendants().filter(|it| it.has_tag_name("text"));
    texts
        .map(|text| text.text().unwrap_or_default().to_owned())
        .collect()
}

fn shapes(node: Node) -> usize {
    let is_shape = |element: &Node| {
        let shapes = ["rect", "circle", "line", "polyline", "polygon", "path"];
        shapes.contains(&element.tag_name().name())
    };
    node.descendants().filter(is_shape).count()
}

#[test]
fn every_control_of_a_shipped_layout_has_its_shape_and_label() {
    for (name, layout) in Layout::shipped().unwrap() {
        let svg = layout.to_svg(&wearer(name)).unwrap();
        let document = parse(&svg);
        for face in layout.boards.iter().flat_map(|board| layout.faces(board)) {
            let groups = groups(&document, &face.name);
            let drawn = groups.first();
            let drawn = drawn.unwrap_or_else(|| panic!("{name}: `{}` is missing", face.name));
            assert!(shapes(*drawn) >= 2, "{name}: {} has no shape", face.name);
            let texts = texts(*drawn).join(" ");
            assert!(
                texts.contains(&face.label),
                "{name}: {}: {texts}",
                face.label
            );
        }
        let all = texts(document.root_element()).join("\n");
        let triggers = layout.triggers.iter().map(|(trigger, _)| trigger);
        let targets = layout.spaces.iter().flat_map(|space| &space.names);
        for part in triggers.chain(targets).chain([&layout.name]) {
            assert!(
                all.contains(part.as_str()),
                "{name}: {part} is missing in {all}"
            );
        }
        assert!(all.contains("elbow") && all.contains("mm"), "{name}: {all}");
        assert!(shapes(document.root_element()) > 10, "{name} is blank");
    }
}

#[test]
fn nothing_is_cut_by_the_page_and_labels_stay_inside_their_controls() {
    for (name, layout) in Layout::shipped().unwrap() {
        let svg = layout.to_svg(&wearer(name)).unwrap();
        let document = parse(&svg);
        let page = document.root_element();
        let view_box = page.attribute("viewBox").unwrap();
        let view_box: Vec<f32> = view_box.split(' ').map(|it| it.parse().unwrap()).collect();
        let page_area = Rect {
            min: Vec2::ZERO,
            max: Vec2::new(view_box[2], view_box[3]),
        };
        for Measured { what, area } in measure(page) {
            assert!(page_area.contains(&area), "{name}: {what} is cut: {area:?}");
        }
        for board in &layout.boards {
            for face in layout.faces(board) {
                let drawn = groups(&document, &face.name)[0];
                check_label(name, face, drawn);
            }
        }
    }
}

/// Checks that the texts of a front are inside its outline, in the frame of the front.
fn check_label(layout: &str, face: &Face, drawn: Node) {
    let half = face.outline.half_extents() * 1e3;
    let outline = Rect {
        min: -half,
        max: half,
    };
    for child in drawn.children() {
        for Measured { what, area } in measure(child) {
            let is_text = what.starts_with("text");
            assert!(
                !is_text || outline.contains(&area),
                "{layout}: {what} leaves `{}`: {area:?} in {outline:?}",
                face.name
            );
        }
    }
}

#[test]
fn labels_of_any_characters_make_a_valid_picture() {
    let text = r#"Layout(name: "<&>'", description: "a < b", boards: [(pose: (anchor: elbow, tilt_deg: 20),
        keys: [(code: "A", name: "<b>", label: "]]>&amp;<!--", at_mm: (0, 0))],
        sliders: [(name: "&x;", at_mm: (60, 0), length_mm: 60, output: Axis("LeftX"))],
    )], layers: [(name: "<i>", keys: {"<b>": "Q"})])"#;
    let layout = Layout::parse(text, "t.ron").unwrap();
    let svg = layout.to_svg(&Wearer::default()).unwrap();
    let document = parse(&svg);
    let all = texts(document.root_element());
    for part in ["]]>&amp;<!--", "a < b", "&x;", "Layer: <i>"] {
        assert!(all.iter().any(|shown| shown == part), "{part} in {all:?}");
    }
    assert!(
        all.iter().any(|shown| shown.contains("tilt 20°")),
        "{all:?}"
    );
}

#[test]
fn each_kind_of_control_has_a_shape_of_its_own() {
    let kinds = [
        ("workshop", "Water", "3 turns"),
        ("scroll-rings", "Page", "Page"),
        ("radial", "Edit", "Copy"),
        ("workshop", "Lathe", "Lathe"),
        ("steering-wheel", "Wheel", "2.5 turns"),
        ("media", "Volume", "Volume"),
        ("media", "Seek", "Seek"),
        ("workshop", "Gear", "Gear"),
        ("game", "Stick", "Stick"),
        ("switches", "Mute", "Mute"),
        ("switches", "Brush", "Brush"),
        ("switches", "Screen", "Screen"),
        ("touch-pad", "Pad", "Pad"),
        ("xy-pad", "Filter", "Filter"),
        ("arrows", "ArrowUp", "depth"),
    ];
    let mut drawn: Vec<Vec<String>> = Vec::new();
    for (name, control, text) in kinds {
        let layout = Layout::load(name).unwrap();
        let svg = layout.to_svg(&Wearer::default()).unwrap();
        let document = parse(&svg);
        let group = groups(&document, control)[0];
        assert!(texts(group).iter().any(|it| it == text), "{control}");
        let elements = group.descendants().filter(|node| node.is_element());
        let elements = elements.map(|node| {
            let class = node.attribute("class").unwrap_or_default();
            format!("{} {class}", node.tag_name().name())
        });
        drawn.push(elements.collect());
    }
    for (index, shapes) in drawn.iter().enumerate() {
        let same = drawn.iter().position(|other| other == shapes);
        assert_eq!(
            same,
            Some(index),
            "{} as {:?}",
            kinds[index].1,
            same.map(|at| kinds[at].1)
        );
    }
}

#[test]
fn a_page_for_browsers_has_all_layers_and_refers_to_nothing_else() {
    for (name, layout) in Layout::shipped().unwrap() {
        let html = layout.to_html(&wearer(name)).unwrap();
        let options = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..Default::default()
        };
        let document = Document::parse_with_options(&html, options);
        let document = document.unwrap_or_else(|error| panic!("{name}: {error}"));
        let inputs = document.descendants();
        let radios = inputs.filter(|node| node.attribute("type") == Some("radio"));
        let expected = if layout.boards.is_empty() {
            0
        } else {
            layout.layers.len()
        };
        assert_eq!(radios.count(), expected, "{name}");
        for layer in 1..expected {
            let class = format!("in-layer layer-{layer}");
            let mut figures = document.descendants();
            let shown = figures.find(|node| node.attribute("class") == Some(&class));
            assert!(shapes(shown.unwrap()) > 10, "{name}, layer {layer}");
        }
        assert!(!html.contains("href") && !html.contains("src="), "{name}");
        assert!(html.contains("prefers-color-scheme:dark"), "{name}");
    }
}

#[test]
fn the_reach_in_a_picture_is_that_of_the_check() {
    for (name, layout) in Layout::shipped().unwrap() {
        let wearer = wearer(name);
        for area in &wearer.areas {
            let board = &layout.boards[area.board];
            for face in layout.faces(board) {
                let is_out = wearer
                    .out_of_reach
                    .iter()
                    .any(|(other, _)| *other == face.name);
                let inside = is_inside(&area.outlines, face.outline.center);
                // A track counts as out of reach with one of its ends, a point near the edge with either.
                let at_edge = is_inside(&area.outlines, face.outline.center + Vec2::Y * 2e-3)
                    != is_inside(&area.outlines, face.outline.center - Vec2::Y * 2e-3);
                assert!(
                    inside != is_out || at_edge,
                    "{name}: {} {is_out}",
                    face.name
                );
            }
        }
        let moves_with_wrist = name == "chords-bend";
        let expected = if moves_with_wrist {
            0
        } else {
            layout.boards.len()
        };
        assert_eq!(wearer.areas.len(), expected, "{name}");
    }
}

/// Returns `true` for a point inside an odd number of outlines.
fn is_inside(outlines: &[Vec<Vec2>], point: Vec2) -> bool {
    let mut crossings = 0;
    for outline in outlines {
        for (index, a) in outline.iter().enumerate() {
            let b = outline[(index + 1) % outline.len()];
            if (a.y > point.y) != (b.y > point.y) {
                let x = a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y);
                crossings += usize::from(x > point.x);
            }
        }
    }
    crossings % 2 == 1
}

#[test]
fn a_key_out_of_reach_is_marked_and_named() {
    let text =
        "Layout(name: \"t\", boards: [(pose: (anchor: elbow, forward_mm: 300, height_mm: -45),
        keys: [(code: \"A\", at_mm: (0, 0)), (code: \"B\", at_mm: (0, 900))])])";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("far.ron");
    std::fs::write(&path, text).unwrap();
    let wearer = wearer(path.to_str().unwrap());
    let layout = Layout::load(path.to_str().unwrap()).unwrap();
    let svg = layout.to_svg(&wearer).unwrap();
    let document = parse(&svg);
    let marks = document.descendants();
    assert_eq!(
        marks
            .filter(|node| node.attribute("class") == Some("out"))
            .count(),
        1
    );
    let all = texts(document.root_element()).join(" ");
    assert!(all.contains("Out of reach: B by "), "{all}");
}

#[test]
fn a_layer_shows_only_the_boards_that_it_changes_and_a_cylinder_has_no_area() {
    let board = |key, shape| {
        format!(
            "(pose: (anchor: elbow, forward_mm: 300), shape: {shape}, keys: [(code: \"{key}\", at_mm: (0, 0))])"
        )
    };
    let (flat, round) = (board("A", "Flat"), board("B", "Cylinder(radius_mm: 200)"));
    let text = format!(
        "Layout(name: \"t\", boards: [{flat}, {round}], layers: [(name: \"l\", keys: {{\"B\": \"Q\"}})])"
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.ron");
    std::fs::write(&path, &text).unwrap();
    let wearer = wearer(path.to_str().unwrap());
    let boards: Vec<usize> = wearer.areas.iter().map(|area| area.board).collect();
    assert_eq!(boards, [0]);
    let svg = Layout::parse(&text, "t.ron")
        .unwrap()
        .to_svg(&wearer)
        .unwrap();
    let document = parse(&svg);
    assert_eq!(groups(&document, "A").len(), 1);
    assert_eq!(groups(&document, "B").len(), 2);
}

#[test]
fn the_largest_layouts_are_drawn_or_refused() {
    let key = |index: usize| {
        let (x, y) = (index % 100 * 20, index / 100 * 20);
        format!(
            "(code: \"A\", name: \"k{index}\", at_mm: ({}, {}))",
            x as i32 - 1000,
            y as i32 - 1000
        )
    };
    let keys: Vec<String> = (0..10_000).map(key).collect();
    let board = format!("(pose: (anchor: world), keys: [{}])", keys.join(","));
    let layers: Vec<String> = (1..32)
        .map(|layer| format!("(name: \"l{layer}\", keys: {{\"k0\": \"Q\"}})"))
        .collect();
    let one_layer = format!("Layout(name: \"t\", boards: [{board}])");
    let svg = Layout::parse(&one_layer, "t.ron")
        .unwrap()
        .to_svg(&Wearer::default());
    assert!(svg.unwrap().len() > 1_000_000);
    let all = format!(
        "Layout(name: \"t\", boards: [{board}], layers: [{}])",
        layers.join(",")
    );
    let layout = Layout::parse(&all, "t.ron").unwrap();
    let error = layout.to_svg(&Wearer::default()).unwrap_err().to_string();
    assert!(
        error.contains("more than 200000") && error.contains("fewer keys"),
        "{error}"
    );
    assert!(layout.to_html(&Wearer::default()).is_err());
}

#[test]
fn curved_boards_and_boards_at_any_angle_are_drawn() {
    let shapes = [
        "Flat",
        "Arc(radius_mm: 300)",
        "Cylinder(radius_mm: 200, curved: Columns)",
    ];
    for shape in shapes {
        for tilt in [-90, 0, 30, 90] {
            let text = format!(
                "Layout(name: \"t\", boards: [(pose: (anchor: world, bearing_deg: -170, tilt_deg: {tilt}), shape: {shape},
                    rows: [(at_mm: (-20, 0), keys: \"Q W E\")], keys: [(code: \"1\", at_mm: (0, 30), lift_mm: 20, rotation_deg: (30, 20, 10))])])"
            );
            let layout = Layout::parse(&text, "t.ron").unwrap();
            let svg = layout.to_svg(&Wearer::default()).unwrap();
            let document = parse(&svg);
            let all = texts(document.root_element()).join(" ");
            let written = if tilt == 0 {
                "level".to_owned()
            } else {
                format!("tilt {tilt}°")
            };
            assert!(all.contains(&written), "{shape}: {all}");
        }
    }
}
