use std::fs;

use parry3d::math::Vec3;
use tempfile::TempDir;

use super::*;
use ademan_runtime::capture::recording::RecordedSetup;
use ademan_runtime::files::{Load, OpenDocument};
use ademan_runtime::setup::ReplaySettings;

/// A pyramid on a square: the square face becomes two triangles.
const PYRAMID: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 2\nf 1 2 3 4\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

/// A layout beside files.
fn layout(folder: &TempDir, file: &str) -> Arc<Layout> {
    let path = folder.path().join("own.ron");
    let text = format!(
        r#"Layout(name: "Own", triggers: [(name: "A", when: Angle(dof: "wrist-flexion", on_deg: 20, off_deg: 10, zero_deg: 0, full_deg: 40), shape: (file: "{file}", joint: "wrist"))])"#
    );
    fs::write(&path, text).unwrap();
    Arc::new(Layout::load(path.to_str().unwrap()).unwrap())
}

fn load_beside(layout: &Layout, file: &str) -> Result<TriangleMesh, ShapeError> {
    load(&layout.text, Some(&layout.file), file)
}

/// Reads a mesh with this content.
fn read(file: &str, content: impl AsRef<[u8]>) -> Result<TriangleMesh, ShapeError> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(file), content).unwrap();
    load_beside(&layout(&folder, file), file)
}

/// One triangle in glTF with its buffer as base64 text, moved by a node and its parent.
fn gltf(uri: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"translation":[0,0,5],"children":[1]}},{{"mesh":0,"scale":[2,2,2]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],
        "buffers":[{{"byteLength":36{uri}}}]}}"#
    )
}

fn triangle_bytes() -> Vec<u8> {
    let numbers = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect()
}

fn expected_triangle() -> Vec<Vec3> {
    vec![
        Vec3::new(0.0, 0.0, 5.0),
        Vec3::new(2.0, 0.0, 5.0),
        Vec3::new(0.0, 2.0, 5.0),
    ]
}

#[test]
fn an_obj_has_its_vertices_and_triangles() {
    let mesh = read("a.obj", PYRAMID).unwrap();
    assert_eq!(mesh.triangles.len(), 6);
    let highest = mesh
        .vertices
        .iter()
        .map(|vertex| vertex.z)
        .fold(0.0, f32::max);
    assert_eq!((mesh.vertices.len(), highest), (5, 2.0));
}

#[test]
fn a_gltf_has_the_transforms_of_its_nodes_and_its_buffer_inside_or_beside() {
    use base64::Engine;
    let text = base64::engine::general_purpose::STANDARD.encode(triangle_bytes());
    let inside = gltf(&format!(
        r#","uri":"data:application/octet-stream;base64,{text}""#
    ));
    assert_eq!(
        read("a.gltf", inside).unwrap().vertices,
        expected_triangle()
    );

    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("meshes")).unwrap();
    fs::write(folder.path().join("meshes/a.bin"), triangle_bytes()).unwrap();
    fs::write(
        folder.path().join("meshes/a.gltf"),
        gltf(r#","uri":"a.bin""#),
    )
    .unwrap();
    let mesh = load_beside(&layout(&folder, "meshes/a.gltf"), "meshes/a.gltf").unwrap();
    assert_eq!(mesh.vertices, expected_triangle());
    assert_eq!(mesh.triangles, [[0, 1, 2]]);

    // The same as one binary file.
    let json = gltf("");
    let json = format!("{json:width$}", width = json.len().next_multiple_of(4));
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    let part = |kind: &[u8], content: &[u8]| {
        let length = (content.len() as u32).to_le_bytes();
        [&length[..], kind, content].concat()
    };
    let parts = [
        part(b"JSON", json.as_bytes()),
        part(b"BIN\0", &triangle_bytes()),
    ]
    .concat();
    glb.extend((12 + parts.len() as u32).to_le_bytes());
    glb.extend(parts);
    assert_eq!(read("a.glb", glb).unwrap().vertices, expected_triangle());
}

#[test]
fn bad_files_are_errors_that_say_what_to_do() {
    let many: String =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned() + &"f 1 2 3\n".repeat(MAX_TRIANGLES + 1);
    let large = " ".repeat(MAX_FILE_BYTES as usize + 1);
    for (file, content, expected) in [
        ("a.obj", "v 1 2\nf 1 1 1", "not valid OBJ"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0", "no triangle"),
        (
            "a.obj",
            "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3",
            "not a number",
        ),
        ("a.obj", many.as_str(), "20001 triangles"),
        ("a.obj", large.as_str(), "larger than 4 MiB"),
        ("a.gltf", "{}", "not valid glTF"),
        ("a.glb", "glTF", "not valid glTF"),
        ("a.gltf", &gltf(r#","uri":"absent.bin""#), "no such file"),
        ("a.gltf", &gltf(r#","uri":"../../etc/passwd""#), "folder"),
        (
            "a.gltf",
            &gltf(r#","uri":"data:;base64,AAAA""#),
            "another length",
        ),
        ("a.gltf", &gltf(""), "binary part is missing"),
    ] {
        let error = match read(file, content) {
            Err(error) => error.to_string(),
            Ok(mesh) => panic!("{expected}: {mesh:?}"),
        };
        let is_expected =
            error.contains(expected) || expected == "folder" && error.contains("no such file");
        assert!(is_expected, "{expected}: {error}");
    }
}

#[test]
fn a_gltf_takes_neither_more_time_nor_more_memory_than_its_size_permits() {
    let folder = tempfile::tempdir().unwrap();
    let read_beside = |content: &str| {
        fs::write(folder.path().join("a.bin"), vec![0_u8; 3 << 20]).unwrap();
        fs::write(folder.path().join("a.gltf"), content).unwrap();
        let error = load_beside(&layout(&folder, "a.gltf"), "a.gltf").unwrap_err();
        error.to_string()
    };
    let one = gltf(r#","uri":"a.bin""#);
    let twice_below = one.replace(r#""children":[1]"#, r#""children":[1,1]"#);
    let error = read_beside(&twice_below);
    assert!(error.contains("below several others"), "{error}");
    let buffer = r#"{"byteLength":36,"uri":"a.bin"}"#;
    let many = one.replace(buffer, &[buffer; 6].join(","));
    assert_ne!(many, one);
    let large = read_beside(&many);
    assert!(large.contains("more than 16 MiB"), "{large}");
    // One mesh of five primitives with the same 262 144 positions.
    let mut positions = one.replace(r#""count":3"#, r#""count":262144"#);
    positions = positions.replace(r#""byteLength":36"#, r#""byteLength":3145728"#);
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1}"#;
    let primitives = [primitive; 5].join(",");
    positions = positions.replace(r#"{"attributes":{"POSITION":0}}"#, &primitives);
    let indices =
        r#","max":[1,1,0]},{"bufferView":0,"componentType":5125,"count":3,"type":"SCALAR"}]"#;
    positions = positions.replace(r#","max":[1,1,0]}]"#, indices);
    let vertices = read_beside(&positions);
    assert!(vertices.contains("a million vertices"), "{vertices}");
}

#[test]
fn a_gltf_with_values_of_other_types_is_an_error() {
    use base64::Engine;
    let text = base64::engine::general_purpose::STANDARD.encode(triangle_bytes());
    let valid = gltf(&format!(
        r#","uri":"data:application/octet-stream;base64,{text}""#
    ));
    assert!(read("a.gltf", &valid).is_ok());
    let indexed = valid.replace(r#"{"POSITION":0}}"#, r#"{"POSITION":0},"indices":1}"#);
    let with_indices = |kind: &str, count: usize| {
        let accessor = format!(
            r#","max":[1,1,0]}},{{"bufferView":0,"componentType":{kind},"count":{count},"type":"SCALAR"}}]"#
        );
        indexed.replace(r#","max":[1,1,0]}]"#, &accessor)
    };
    // The first three bytes of the buffer are 0.
    let mesh = read("a.gltf", with_indices("5121", 3)).unwrap();
    assert_eq!(mesh.triangles, [[0, 0, 0]]);
    for content in [
        with_indices("5126", 3),
        with_indices("5121", 0),
        valid.replace(r#""type":"VEC3""#, r#""type":"SCALAR""#),
        valid.replace(
            r#""byteLength":36}],"#,
            r#""byteLength":36,"byteStride":4}],"#,
        ),
    ] {
        let error = read("a.gltf", &content).unwrap_err().to_string();
        assert!(error.contains("not valid glTF"), "{content}: {error}");
    }
}

#[test]
fn a_buffer_is_sought_in_the_folder_of_the_layout_only() {
    let below = Path::new("meshes");
    for name in ["a.bin", "./a.bin", "../a.bin", "../b/../a.bin"] {
        let expected = below.join(name).to_string_lossy().into_owned();
        assert_eq!(name_inside(below, name), Some(expected), "{name}");
    }
    for name in [
        "/net/host/a.bin",
        "//host/share/a.bin",
        "\\\\host\\share\\a.bin",
        "C:a.bin",
        "https://host/a.bin",
        "../../a.bin",
        "../../meshes/a.bin",
    ] {
        assert_eq!(name_inside(below, name), None, "{name}");
    }
}

#[cfg(unix)]
#[test]
fn a_link_that_leads_out_of_the_folder_is_not_followed() {
    let (outside, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    fs::write(outside.path().join("a.obj"), PYRAMID).unwrap();
    fs::write(folder.path().join("b.obj"), PYRAMID).unwrap();
    std::os::unix::fs::symlink(outside.path().join("a.obj"), folder.path().join("a.obj")).unwrap();
    std::os::unix::fs::symlink("b.obj", folder.path().join("c.obj")).unwrap();
    let layout = layout(&folder, "a.obj");
    assert!(matches!(
        load_beside(&layout, "a.obj"),
        Err(ShapeError::Outside)
    ));
    assert!(load_beside(&layout, "c.obj").is_ok());
}

#[test]
fn a_missing_mesh_is_a_message_and_the_others_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let mut shapes = Shapes::default();
    shapes.update(&layout(&folder, "absent.obj"));
    let errors: Vec<&str> = shapes.errors().collect();
    assert_eq!(
        errors,
        ["cannot draw absent.obj: there is no such file beside the layout or arm"]
    );
    let claws = Arc::new(Layout::load("claws").unwrap());
    shapes.update(&claws);
    assert_eq!(shapes.errors().count(), 0);
    assert!(
        shapes
            .mesh("claw.obj")
            .is_some_and(|mesh| mesh.triangles.len() == 14)
    );
    // A file with the name of a shipped mesh beside another layout is not that mesh.
    assert!(matches!(
        load_beside(&layout(&folder, "claw.obj"), "claw.obj"),
        Err(ShapeError::NotFound)
    ));
}

#[test]
fn an_arm_file_has_meshes_for_its_limbs() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = Document::shipped("unam").unwrap().text;
    let end = shipped.rfind(')').unwrap();
    let shapes = r#"shapes: [(file: "a.obj", joint: "wrist"), (file: "b.obj", joint: "elbow")])"#;
    let path = folder.path().join("own.ron");
    let path = path.to_str().unwrap();
    fs::write(path, format!("{}{shapes}", &shipped[..end])).unwrap();
    fs::write(folder.path().join("a.obj"), PYRAMID).unwrap();
    let mut loaded = Shapes::default();
    loaded.set_arm(&Document::from_path(path).unwrap());
    let limbs: Vec<_> = loaded
        .limbs()
        .map(|(shape, mesh)| (shape.joint, mesh.triangles.len()))
        .collect();
    assert_eq!(limbs, [(ademan_core::hand::Joint::Wrist, 6)]);
    assert!(
        loaded
            .errors()
            .next()
            .is_some_and(|error| error.starts_with("cannot draw b.obj"))
    );
    loaded.set_arm(&Document::shipped("unam").unwrap());
    assert_eq!((loaded.limbs().len(), loaded.errors().count()), (0, 0));
}

#[test]
fn no_mesh_is_opened_because_a_recording_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let own = layout(&folder, "a.obj");
    fs::write(folder.path().join("a.obj"), PYRAMID).unwrap();
    let recorded = RecordedSetup::default().with("layout", &own.file, &own.text);
    let shapes_with = |file: Option<&str>| {
        let settings = ReplaySettings {
            layout: file,
            ..ReplaySettings::default()
        };
        let setup = LoadedSetup::from_recording(&recorded, &settings).unwrap();
        let mut shapes = Shapes::for_setup(&setup);
        shapes.update(&Arc::new(setup.layout));
        shapes
    };
    let foreign = shapes_with(None);
    assert!(foreign.mesh("a.obj").is_none());
    let errors: Vec<&str> = foreign.errors().collect();
    assert_eq!(
        errors,
        [
            "cannot draw a.obj: a recording has no meshes, and no file is opened because it names one"
        ]
    );
    let replaced = shapes_with(Some(own.file.as_str()));
    assert!(replaced.mesh("a.obj").is_some());

    let shipped = Document::shipped("unam").unwrap().text;
    let end = shipped.rfind(')').unwrap();
    let limbs = r#"shapes: [(file: "a.obj", joint: "wrist")])"#;
    let text = format!("{}{limbs}", &shipped[..end]);
    let mut of_arm = Shapes::default();
    of_arm.set_arm(&Document::new(own.file.as_str(), text));
    assert_eq!((of_arm.limbs().len(), of_arm.errors().count()), (0, 1));
}
