//! Setups that name shipped files.

use std::path::Path;

use ademan::setup::Setup;

#[test]
fn a_shipped_glove_has_no_file_even_in_the_folder_of_the_sources() {
    // The tests run in that folder.
    let file = "layouts/gloves/unam-hc11.ron";
    assert!(Path::new(file).is_file());
    let path = |glove: Option<&str>| {
        let setup = Setup {
            glove: glove.map(str::to_owned),
            ..Setup::default()
        };
        let setup = setup.load_files().expect("the shipped files");
        setup.glove_path().map(str::to_owned)
    };
    assert_eq!(path(None), None);
    assert_eq!(path(Some("unam-hc11")), None);
    assert_eq!(path(Some(file)).as_deref(), Some(file));
}
