use super::*;

#[test]
fn a_token_is_made_once_listed_without_its_secret_and_revoked() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("ademan").join("network");
    let path = create(&folder, "desk", TokenRole::Type).unwrap();
    create(&folder, "screen", TokenRole::See).unwrap();
    assert_eq!(role_of_file(&path).unwrap(), TokenRole::Type);
    let secret = TokenFile::read(&path).unwrap().token.to_hex();
    let stored = fs::read_to_string(folder.join("tokens")).unwrap();
    assert!(
        stored.starts_with("desk type ") && !stored.contains(&secret),
        "{stored}"
    );
    let names = |folder: &Path| {
        let listed = list(folder).unwrap().into_iter();
        listed
            .map(|entry| format!("{} {}", entry.name, entry.role))
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&folder), ["desk type", "screen see"]);
    let again = create(&folder, "desk", TokenRole::See)
        .unwrap_err()
        .to_string();
    assert!(again.contains("ademan token revoke desk"), "{again}");
    revoke(&folder, "desk").unwrap();
    assert_eq!(names(&folder), ["screen see"]);
    assert!(!path.exists());
    assert!(revoke(&folder, "desk").is_err());
}

#[test]
fn names_that_lead_out_of_the_folder_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["", "../desk", "a b", "a\n", ".", "é", &"a".repeat(33)] {
        let error = create(&folder.path().join("network"), name, TokenRole::See);
        assert!(error.unwrap_err().to_string().contains("letters"), "{name}");
    }
}

#[cfg(unix)]
#[test]
fn files_that_others_can_read_are_refused() {
    use std::os::unix::fs::PermissionsExt;

    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("network");
    let path = create(&folder, "desk", TokenRole::See).unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode(&folder), 0o700);
    for file in ["tokens", "key.pem", "certificate.pem", "desk.token"] {
        assert_eq!(mode(&folder.join(file)), 0o600, "{file}");
    }
    fs::set_permissions(&path, fs::Permissions::from_mode(0o644)).unwrap();
    let error = role_of_file(&path).unwrap_err().to_string();
    assert!(error.contains("chmod 600"), "{error}");
    fs::set_permissions(folder.join("tokens"), fs::Permissions::from_mode(0o640)).unwrap();
    assert!(list(&folder).unwrap_err().to_string().contains("chmod 600"));
}
