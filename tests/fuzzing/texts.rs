//! Text formats: files of users, names of sources, and lines of the control socket.

use std::sync::LazyLock;

use ademan::calibrate::{marks_from_text, marks_to_text};
use ademan::capture::SourceUri;
use ademan::contact::TargetNames;
use ademan::contact::board_pose::BoardPose;
use ademan::document::{Document, DocumentError, MAX_DOCUMENT_BYTES};
use ademan::estimate::AffineMap;
use ademan::files::Load;
use ademan::kinematics::ArmModel;
use ademan::layout::{Fit, Glove, Layout, Wearer, move_boards, scale_boards, write_calibration};
use ademan::layout_link::{self, layout_in_link};
use ademan::pipeline::LayoutInstance;
use ademan::session::control_socket::request;
use ademan::setup::{ArmSetup, Setup};
use ademan::sim::Script;

/// Returns an input as a document; `None` if it is not valid UTF-8, which is refused before parsing.
fn document(data: &[u8]) -> Option<Document> {
    Some(Document::new("fuzz.ron", str::from_utf8(data).ok()?))
}

/// Checks that an error has a message, and a position inside the file.
fn check_error(error: &DocumentError, document: &Document) {
    assert!(!error.message().is_empty());
    if let Some(line) = error.line() {
        assert!(line >= 1 && error.column().is_some_and(|column| column >= 1));
        assert!(line <= document.text.lines().count() + 1, "{error}");
    }
}

/// Parses a layout. A valid one has an instance, capabilities and drawings, and stays valid when its boards are moved or
/// scaled in the file.
pub fn layout(data: &[u8]) -> bool {
    let Some(document) = document(data) else {
        return false;
    };
    let layout = match Layout::from_document(document.clone()) {
        Ok(layout) => layout,
        Err(error) => {
            check_error(&error, &document);
            return false;
        }
    };
    let built = LayoutInstance::from_layout(&layout);
    assert_eq!(
        layout.target_names().iter().count(),
        built.target_names().iter().count()
    );
    assert!(layout.required_capabilities().iter().count() < 4096);
    let wearer = Wearer::default();
    if let Ok(svg) = layout.to_svg(&wearer) {
        assert!(svg.starts_with("<svg") && !svg.contains("\"NaN") && !svg.contains("\"inf"));
        assert!(layout.to_html(&wearer).is_ok());
    }
    assert!(layout.to_text().len() < 1 << 24);
    check_rewriting(&layout, &document);
    true
}

fn check_rewriting(layout: &Layout, document: &Document) {
    let surfaces = layout.scene.surfaces().iter();
    let places: Vec<BoardPose> = surfaces
        .map(|surface| BoardPose::from_pose(&surface.anchor_from_surface()))
        .take(layout.boards.len())
        .collect();
    let same = move_boards(document, &places, &Fit::default()).expect("a layout can be written");
    assert_eq!(
        same, document.text,
        "boards that are there keep their numbers"
    );

    let aside = |place: &BoardPose| BoardPose {
        right: (place.right + 0.0125).min(1.9),
        ..*place
    };
    let wanted: Vec<BoardPose> = places.iter().map(aside).collect();
    let text = move_boards(document, &wanted, &Fit::default()).expect("a layout can be written");
    let again = Layout::parse(&text, "moved.ron").unwrap_or_else(|error| panic!("{error}"));
    let moved_surfaces = again.scene.surfaces().iter();
    for (surface, expected) in moved_surfaces.zip(&wanted) {
        let place = BoardPose::from_pose(&surface.anchor_from_surface());
        assert!(
            (place.right - expected.right).abs() < 2e-5,
            "{place:?} {expected:?}"
        );
    }
    assert_eq!(again.keys, layout.keys);
    assert_eq!(
        again.required_capabilities(),
        layout.required_capabilities()
    );

    let scaled_text = scale_boards(document, 1.0).expect("a layout can be written");
    if let Err(error) = Layout::parse(&scaled_text, "scaled.ron") {
        // Rounded to four digits, a scale at the limit of its range can exceed it.
        assert!(error.to_string().contains("scale"), "{error}");
    }
}

/// Parses a setup. A valid one can be serialised and parsed again without a change.
pub fn setup(data: &[u8]) -> bool {
    let Some(document) = document(data) else {
        return false;
    };
    let setup: Setup = match document.parse() {
        Ok(setup) => setup,
        Err(error) => {
            check_error(&error, &document);
            return false;
        }
    };
    let text = ron::to_string(&setup).expect("a setup is plain data");
    let again: Setup = Document::new("again.ron", &*text)
        .parse()
        .unwrap_or_else(|error| panic!("{error}"));
    // Compared as texts, because NaN is not equal to itself.
    assert_eq!(ron::to_string(&again).as_ref(), Ok(&text));
    // Only shipped files are opened.
    let model = |hand: ArmSetup| match hand {
        ArmSetup::Model(_) => ArmSetup::Model("unam".into()),
        measured => measured,
    };
    let known = Setup {
        glove: None,
        layout: "arrows".into(),
        profiles: Vec::new(),
        other_hand: None,
        person: None,
        arm: model(setup.arm),
        ..setup
    };
    match known.load_files() {
        Ok(loaded) => {
            drop(loaded.pipeline());
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

/// Parses a glove file. A valid one stays valid with another calibration.
pub fn glove(data: &[u8]) -> bool {
    let Some(document) = document(data) else {
        return false;
    };
    match Glove::parse(&document) {
        Ok(glove) => {
            assert!(glove.map.required_channels() <= ademan::capture::MAX_CHANNELS);
            check_calibrating(&glove, &document);
            true
        }
        Err(error) => {
            check_error(&error, &document);
            false
        }
    }
}

fn check_calibrating(glove: &Glove, document: &Document) {
    let halved: Vec<AffineMap> = glove
        .map
        .rows()
        .iter()
        .map(|row| AffineMap {
            gain: row.calibration.gain / 2.0,
            offset: row.calibration.offset + 0.25,
        })
        .collect();
    let new = glove.map.clone().with_calibrations(&halved);
    let text = write_calibration(document, &new, &glove.rest_pose).expect("a glove can be written");
    let again = Glove::parse(&Document::new("calibrated.ron", text));
    let again = again.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again.map.rows().len(), new.rows().len());
}

/// Reads the marks of a calibration in a recording. Valid ones survive a text.
pub fn marks(data: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(data) else {
        return false;
    };
    match marks_from_text(text) {
        Ok(marks) => {
            assert_eq!(marks_from_text(&marks_to_text(&marks)), Ok(marks));
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

/// Parses an arm file. A valid one has a finite pose.
pub fn arm(data: &[u8]) -> bool {
    use ademan::estimate::{Estimate, JointAngles};
    use ademan::time::Timestamp;

    let Some(document) = document(data) else {
        return false;
    };
    match ArmModel::parse(&document) {
        Ok(arm) => {
            let pose = arm.forward(&Estimate::new(Timestamp(0), JointAngles::default()));
            for (joint, joint_pose) in pose.known() {
                assert!(joint_pose.is_finite(), "{joint} is nowhere");
            }
            true
        }
        Err(error) => {
            check_error(&error, &document);
            false
        }
    }
}

/// Parses a person, whose arms are usable.
pub fn person(data: &[u8]) -> bool {
    use ademan::hand::Side;
    use ademan::layout::Person;

    let Some(document) = document(data) else {
        return false;
    };
    match Person::parse(&document) {
        Ok(person) => {
            for &side in Side::ALL {
                let arm = person.arm(side);
                assert!(arm.is_none_or(|arm| arm.is_ok()), "an arm without a use");
            }
            true
        }
        Err(error) => {
            check_error(&error, &document);
            false
        }
    }
}

/// Parses a line of the control socket.
pub fn request(data: &[u8]) -> bool {
    match request::validate(data) {
        Ok(()) => true,
        Err(reason) => {
            assert!(!reason.to_string().is_empty());
            false
        }
    }
}

/// Parses the URI of a source. A valid one can be formatted and parsed again without a change.
pub fn source(data: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(data) else {
        return false;
    };
    match text.parse::<SourceUri>() {
        Ok(source) => {
            let again = source.to_string().parse::<SourceUri>();
            assert_eq!(again.expect("a name that was written"), source);
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

/// Reads the layout in a link. One that is read survives a round trip.
pub fn layout_link(data: &[u8]) -> bool {
    let Ok(link) = str::from_utf8(data) else {
        return false;
    };
    match layout_in_link(link) {
        Ok(text) => {
            assert!(text.len() as u64 <= MAX_DOCUMENT_BYTES);
            let again = layout_link::layout_link("https://example.org/", &text);
            assert_eq!(layout_in_link(&again), Ok(text));
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

/// Parses a script for the arrow keys.
pub fn script(data: &[u8]) -> bool {
    static NAMES: LazyLock<TargetNames> = LazyLock::new(|| {
        let arrows = Layout::load("arrows").expect("a shipped layout");
        arrows.target_names()
    });
    let Some(document) = document(data) else {
        return false;
    };
    match Script::parse(document.clone(), &NAMES) {
        Ok(script) => {
            assert!(!script.actions().is_empty());
            for order in 0..script.actions().len() {
                check_error(&script.error(order, "here"), &document);
            }
            true
        }
        Err(error) => {
            check_error(&error, &document);
            false
        }
    }
}
