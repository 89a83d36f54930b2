//! The schema of recordings.

use std::process::Command;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/recording/src/message");

#[test]
fn the_schema_in_recordings_is_what_protoc_makes_of_its_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = folder.path().join("ademan.binpb");
    let mut protoc = Command::new("protoc");
    protoc.arg(format!("--proto_path={FOLDER}"));
    protoc.arg(format!("--descriptor_set_out={}", made.display()));
    let status = match protoc.arg("ademan.proto").status() {
        Ok(status) => status,
        Err(error) => {
            println!("SKIPPED: cannot start protoc: {error}");
            return;
        }
    };
    assert!(status.success());
    let stored = std::fs::read(format!("{FOLDER}/ademan.binpb")).expect("the schema");
    let made = std::fs::read(made).expect("a schema");
    assert!(
        made == stored,
        "run `protoc --descriptor_set_out=ademan.binpb ademan.proto` in {FOLDER}"
    );
}
