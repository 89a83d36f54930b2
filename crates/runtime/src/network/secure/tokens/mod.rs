//! The tokens of this machine: made, listed and revoked.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::network::secure::folder_lock::FolderLock;
use crate::network::secure::identity::Identity;
use crate::network::secure::token::{Hash, Token};
use crate::network::secure::token_file::{self, TokenFile};
use crate::network::secure::token_list::TokenList;
use crate::network::secure::{file_error, hello};
use crate::network::{NetworkError, TokenEntry, TokenRole};

/// Longest name of a token.
const MAX_NAME_LENGTH: usize = 32;

/// Makes a token, adds its hash to the list in `folder`, and writes the file for its client. Returns the path of that file.
///
/// The first token also makes the certificate of this machine.
pub fn create(folder: &Path, name: &str, role: TokenRole) -> Result<PathBuf, NetworkError> {
    check_name(name)?;
    let lock = FolderLock::acquire(folder)?;
    let identity = Identity::open_locked(&lock)?;
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
    remove_unlisted(&token_file::path_of(folder, name), file.server);
    let path = file.create(folder)?;
    // After the file, so that every listed token has one.
    list.write(&lock)
        .inspect_err(|_| _ = fs::remove_file(&path))?;
    Ok(path)
}

/// Removes the file of a token of this machine that is not in the list, as a command that was killed leaves it. One of another
/// machine stays.
fn remove_unlisted(path: &Path, server: Hash) {
    if TokenFile::read(path).is_ok_and(|file| file.server == server) {
        let _ = fs::remove_file(path);
    }
}

/// Returns the names and roles of all tokens.
pub fn list(folder: &Path) -> Result<Vec<TokenEntry>, NetworkError> {
    Ok(TokenList::read(folder)?.entries().cloned().collect())
}

/// Removes a token, and its file if that is still in `folder`; a file with this name and the token of another machine stays. A running
/// server disconnects its clients within a second.
pub fn revoke(folder: &Path, name: &str) -> Result<(), NetworkError> {
    check_name(name)?;
    let unknown = || {
        NetworkError::Token(format!(
            "there is no token `{name}`; `ademan token list` shows all"
        ))
    };
    if TokenList::read(folder)?.is_empty() {
        return Err(unknown());
    }
    let lock = FolderLock::acquire(folder)?;
    let mut list = TokenList::read(folder)?;
    let path = token_file::path_of(folder, name);
    let is_foreign = TokenFile::read(&path).is_ok_and(|file| {
        let listed = list.find(&file.token.hash());
        listed.is_none_or(|token| token.entry.name != name)
    });
    if !list.remove(name) {
        return Err(unknown());
    }
    list.write(&lock).map_err(|error| {
        NetworkError::Token(format!("{error}; the token `{name}` is still valid"))
    })?;
    if is_foreign {
        return Ok(());
    }
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

/// Returns the secret in the file of a token of this machine, for a link: 64 hexadecimal digits. `None` if there is no such file,
/// or it is no longer valid.
pub fn secret_of(folder: &Path, name: &str) -> Option<String> {
    let file = TokenFile::read(&token_file::path_of(folder, name)).ok()?;
    let list = TokenList::read(folder).ok()?;
    let listed = list.find(&file.token.hash())?;
    (listed.entry.name == name).then(|| file.token.to_hex())
}

/// Returns the role in the text of a token file; `None` if it is not valid.
pub fn role_in(text: &str) -> Option<TokenRole> {
    Some(TokenFile::parse(text)?.entry.role)
}

/// Returns `true` if a text is a list of tokens.
pub fn is_list(text: &str) -> bool {
    TokenList::parse(text).is_ok()
}

/// Returns `true` if the first bytes of a client are a token.
pub fn is_hello(mut bytes: &[u8]) -> bool {
    matches!(hello::receive(&mut bytes), Ok(Some(_)))
}

/// Checks that a name is part of a file name and one word of a line.
fn check_name(name: &str) -> Result<(), NetworkError> {
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_');
    match name.len() {
        1..=MAX_NAME_LENGTH if name.bytes().all(is_letter) => Ok(()),
        _ => Err(NetworkError::Token(format!(
            "a token name has 1 to {MAX_NAME_LENGTH} letters, digits, `-` and `_`, such as `desk`"
        ))),
    }
}

#[cfg(test)]
mod tests;
