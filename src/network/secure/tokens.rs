//! The tokens of this machine: made, listed and revoked.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::identity::Identity;
use super::token::Token;
use super::token_file::{self, TokenFile};
use super::token_list::TokenList;
use super::{file_error, secret_file};
use crate::network::{NetworkError, TokenEntry, TokenRole};

/// Longest name of a token.
const MAX_NAME_LENGTH: usize = 32;

/// Makes a token, adds its hash to the list in `folder`, and writes the file for its client. Returns the path of that file.
///
/// The first token also makes the certificate of this machine.
pub fn create(folder: &Path, name: &str, role: TokenRole) -> Result<PathBuf, NetworkError> {
    check_name(name)?;
    secret_file::create_folder(folder)?;
    let identity = Identity::load_or_create(folder)?;
    let mut list = TokenList::read(folder)?;
    let entry = TokenEntry {
        name: name.into(),
        role,
    };
    let token = Token::generate()?;
    list.add(entry.clone(), token.hash())?;
    let file = TokenFile {
        entry,
        server: identity.fingerprint(),
        token,
    };
    let path = file.create(folder)?;
    // After the file, so that no token is listed that nobody has.
    list.write(folder)
        .inspect_err(|_| _ = fs::remove_file(&path))?;
    Ok(path)
}

/// Returns the names and roles of all tokens.
pub fn list(folder: &Path) -> Result<Vec<TokenEntry>, NetworkError> {
    Ok(TokenList::read(folder)?.entries().cloned().collect())
}

/// Removes a token, and its file if that is still in `folder`. A running server disconnects its clients within a second.
pub fn revoke(folder: &Path, name: &str) -> Result<(), NetworkError> {
    check_name(name)?;
    let mut list = TokenList::read(folder)?;
    if !list.remove(name) {
        return Err(NetworkError::Token(format!(
            "there is no token `{name}`; `ademan token list` shows all"
        )));
    }
    list.write(folder)?;
    let path = token_file::path_of(folder, name);
    match fs::remove_file(&path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(file_error("remove", &path, error))
        }
        _ => Ok(()),
    }
}

/// Returns the role of the token in a file of a client.
pub fn role_of_file(path: &Path) -> Result<TokenRole, NetworkError> {
    Ok(TokenFile::read(path)?.entry.role)
}

/// Checks that a name is part of a file name and one word of a line.
fn check_name(name: &str) -> Result<(), NetworkError> {
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_');
    match name.len() {
        1..=MAX_NAME_LENGTH if name.bytes().all(is_letter) => Ok(()),
        _ => Err(NetworkError::Token(format!(
            "a name of a token has 1 to {MAX_NAME_LENGTH} letters, digits, `-` and `_`, such as `desk`"
        ))),
    }
}

#[cfg(test)]
mod tests {
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
}
