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
    let names = |listed_folder: &Path| {
        let listed = list(listed_folder).unwrap().into_iter();
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
fn tokens_that_are_revoked_while_others_are_made_stay_revoked() {
    let parent = tempfile::tempdir().unwrap();
    let folder = &parent.path().join("network");
    let names = |start: &str| (0..12).map(|index| format!("{start}{index}")).collect();
    let (old, kept): (Vec<String>, Vec<String>) = (names("old"), names("kept"));
    // The certificate is also made by all of them at once.
    std::thread::scope(|scope| {
        for name in &old {
            scope.spawn(move || create(folder, name, TokenRole::See).unwrap());
        }
    });
    std::thread::scope(|scope| {
        for (revoked, made) in old.iter().zip(&kept) {
            scope.spawn(move || revoke(folder, revoked).unwrap());
            scope.spawn(move || create(folder, made, TokenRole::See).unwrap());
        }
    });
    let listed = list(folder).unwrap().into_iter();
    let mut listed: Vec<String> = listed.map(|entry| entry.name).collect();
    listed.sort();
    let mut expected = kept;
    expected.sort();
    assert_eq!(listed, expected);
}

#[test]
fn what_a_command_that_was_killed_has_left_prevents_no_later_one() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("network");
    let file = create(&folder, "desk", TokenRole::See).unwrap();
    let text = fs::read_to_string(&file).unwrap();
    revoke(&folder, "desk").unwrap();
    let private = |name: &str, content: &str| {
        use std::io::Write;
        let mut left = crate::files::create_private(&folder.join(name)).unwrap();
        left.write_all(content.as_bytes()).unwrap();
    };
    // The file of a token that was not listed yet, and parts of the list.
    private("desk.token", &text);
    private("tokens.new", "desk se");
    let process = std::process::id();
    private(&format!(".tokens.{process}"), "desk se");
    private(&format!(".tokens.{process}.0"), "desk se");
    private(&format!(".desk.token.{process}.0"), "ademan tok");
    create(&folder, "desk", TokenRole::Type).unwrap();
    assert_eq!(role_of_file(&file).unwrap(), TokenRole::Type);
    revoke(&folder, "desk").unwrap();
    assert!(list(&folder).unwrap().is_empty());
    // The key of a certificate that was not written yet.
    fs::remove_file(folder.join("certificate.pem")).unwrap();
    let key = fs::read(folder.join("key.pem")).unwrap();
    create(&folder, "desk", TokenRole::See).unwrap();
    assert_eq!(fs::read(folder.join("key.pem")).unwrap(), key);
    crate::network::Gatekeeper::open(&folder).unwrap();
}

#[test]
fn a_token_file_of_another_machine_is_not_replaced() {
    let parent = tempfile::tempdir().unwrap();
    let (own, other) = (parent.path().join("own"), parent.path().join("other"));
    create(&own, "first", TokenRole::See).unwrap();
    let foreign = create(&other, "desk", TokenRole::Type).unwrap();
    fs::rename(&foreign, own.join("desk.token")).unwrap();
    let text = fs::read(own.join("desk.token")).unwrap();
    let error = create(&own, "desk", TokenRole::See)
        .unwrap_err()
        .to_string();
    assert!(error.contains("exists"), "{error}");
    assert_eq!(fs::read(own.join("desk.token")).unwrap(), text);
    assert_eq!(list(&own).unwrap().len(), 1);
}

#[test]
fn revoking_a_token_removes_no_file_of_another_machine() {
    let parent = tempfile::tempdir().unwrap();
    let (own, other) = (parent.path().join("own"), parent.path().join("other"));
    let path = create(&own, "desk", TokenRole::See).unwrap();
    let foreign = create(&other, "desk", TokenRole::Type).unwrap();
    fs::rename(&foreign, &path).unwrap();
    revoke(&own, "desk").unwrap();
    assert!(list(&own).unwrap().is_empty());
    assert_eq!(role_of_file(&path).unwrap(), TokenRole::Type);
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
    let mode = |file: &Path| fs::metadata(file).unwrap().permissions().mode() & 0o777;
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
