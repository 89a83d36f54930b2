//! The file that a client has: a token, and the fingerprint of the server that issued it.

use std::path::{Path, PathBuf};

use super::secret_file;
use super::token::{Hash, Token};
use crate::network::{NetworkError, TokenEntry, TokenRole};
use ademan_core::message::escape_path;

/// The first line. Its number changes with the form of the file.
const HEADER: &str = "ademan token 1";

/// A token as its client knows it.
#[derive(Debug)]
pub struct TokenFile {
    pub entry: TokenEntry,
    /// The fingerprint of the certificate of the server.
    pub server: Hash,
    pub token: Token,
}

impl TokenFile {
    /// Reads a file, which only its owner may be able to access.
    pub fn read(path: &Path) -> Result<Self, NetworkError> {
        let Some(text) = secret_file::read(path)? else {
            return Err(NetworkError::Token(format!(
                "there is no token file {}; copy it from the machine whose `ademan token new` has made it",
                escape_path(path)
            )));
        };
        Self::parse(&text).ok_or_else(|| NetworkError::Content {
            path: path.into(),
            reason:
                "it is not a token file; `ademan token new NAME --role see` on the server makes one"
                    .into(),
        })
    }

    /// Reads the text of a file.
    pub fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        if lines.next()?.trim_end() != HEADER {
            return None;
        }
        let mut value = |key: &str| {
            let (name, value) = lines.next()?.trim_end().split_once(' ')?;
            (name == key).then_some(value)
        };
        let name = value("name")?.to_owned();
        let role: TokenRole = value("role")?.parse().ok()?;
        Some(Self {
            entry: TokenEntry { name, role },
            server: Hash::from_hex(value("server")?)?,
            token: Token::from_hex(value("secret")?)?,
        })
    }

    /// Writes the file of a new token into a folder. Returns its path. Fails if it exists.
    pub fn create(&self, folder: &Path) -> Result<PathBuf, NetworkError> {
        let Self {
            entry,
            server,
            token,
        } = self;
        let path = path_of(folder, &entry.name);
        let text = format!(
            "{HEADER}\nname {}\nrole {}\nserver {}\nsecret {}\n",
            entry.name,
            entry.role,
            server.to_hex(),
            token.to_hex()
        );
        secret_file::create(&path, &text)?;
        Ok(path)
    }
}

/// Returns the path of the file of a token in a folder.
pub fn path_of(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.token"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_cut_or_changed_is_refused_without_being_quoted() {
        let folder = tempfile::tempdir().unwrap();
        let file = TokenFile {
            entry: TokenEntry {
                name: "desk".into(),
                role: TokenRole::Type,
            },
            server: Hash::of(b"certificate"),
            token: Token::generate().unwrap(),
        };
        let path = file.create(folder.path()).unwrap();
        let read = TokenFile::read(&path).unwrap();
        assert_eq!((read.entry, read.server), (file.entry, file.server));
        assert_eq!(read.token.hash(), file.token.hash());
        let text = std::fs::read_to_string(&path).unwrap();
        for end in 0..text.len() - 1 {
            assert!(TokenFile::parse(&text[..end]).is_none(), "cut at {end}");
        }
        std::fs::write(&path, text.replace("role type", "role everything")).unwrap();
        let error = TokenFile::read(&path).unwrap_err().to_string();
        assert!(error.contains("not a token file"), "{error}");
        assert!(!error.contains(&file.token.to_hex()), "{error}");
    }
}
