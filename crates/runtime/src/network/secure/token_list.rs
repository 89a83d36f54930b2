//! The list of a server: the name, role and hash of each token.

use std::path::{Path, PathBuf};

use super::folder_lock::FolderLock;
use super::secret_file;
use super::token::Hash;
use crate::network::{NetworkError, TokenEntry, TokenRole};
use ademan_core::message::escape;

/// Most tokens: one for each program of a large laboratory.
const MAX_TOKENS: usize = 256;

/// A token of the list.
#[derive(Clone, Debug)]
pub struct ListedToken {
    pub entry: TokenEntry,
    hash: Hash,
}

/// All tokens that a server admits.
#[derive(Clone, Debug, Default)]
pub struct TokenList(Vec<ListedToken>);

impl TokenList {
    /// Reads the list in a folder. A missing file is an empty list.
    pub fn read(folder: &Path) -> Result<Self, NetworkError> {
        let path = path_of(folder);
        let text = secret_file::read(&path)?.unwrap_or_default();
        Self::parse(&text).map_err(|line| NetworkError::Content {
            path,
            reason: format!("line {line} is not `NAME ROLE HASH`; remove it and make a new token"),
        })
    }

    /// Reads the text of a list. The error is the number of the first invalid line.
    pub fn parse(text: &str) -> Result<Self, usize> {
        let lines = text.lines().enumerate();
        let tokens = lines.map(|(index, line)| parse(line).ok_or(index + 1));
        Ok(Self(tokens.collect::<Result<_, _>>()?))
    }

    /// Replaces the list in a folder, and checks that the folder now has this list.
    pub fn write(&self, lock: &FolderLock) -> Result<(), NetworkError> {
        let path = path_of(lock.folder());
        let line = |token: &ListedToken| {
            let TokenEntry { name, role } = &token.entry;
            format!("{name} {role} {}\n", token.hash.to_hex())
        };
        let text: String = self.0.iter().map(line).collect();
        secret_file::replace(&path, &text)?;
        match secret_file::read(&path)? {
            Some(written) if written == text => Ok(()),
            _ => Err(NetworkError::Token(format!(
                "the list of tokens in {} was changed by another program; try again",
                escape(&path.to_string_lossy())
            ))),
        }
    }

    /// Adds a token.
    pub fn add(&mut self, entry: TokenEntry, hash: Hash) -> Result<(), NetworkError> {
        let name = &entry.name;
        if self.0.iter().any(|token| token.entry.name == *name) {
            return Err(NetworkError::Token(format!(
                "there is a token `{name}`; choose another name, or `ademan token revoke {name}`"
            )));
        }
        if self.0.len() == MAX_TOKENS {
            return Err(NetworkError::Token(format!(
                "there are {MAX_TOKENS} tokens, no more are kept; revoke one that is not used"
            )));
        }
        self.0.push(ListedToken { entry, hash });
        Ok(())
    }

    /// Removes a token. Returns `false` if there is none of this name.
    pub fn remove(&mut self, name: &str) -> bool {
        let before = self.0.len();
        self.0.retain(|token| token.entry.name != name);
        self.0.len() < before
    }

    /// Returns the token with this hash. Compares all, so that the time tells nothing about the list.
    pub fn find(&self, hash: &Hash) -> Option<&ListedToken> {
        let same = |token: &&ListedToken| token.hash == *hash;
        self.0
            .iter()
            .filter(same)
            .fold(None, |_, token| Some(token))
    }

    /// Returns all names and roles.
    pub fn entries(&self) -> impl Iterator<Item = &TokenEntry> {
        self.0.iter().map(|token| &token.entry)
    }

    /// Returns `true` if no client is admitted.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

fn path_of(folder: &Path) -> PathBuf {
    folder.join("tokens")
}

fn parse(line: &str) -> Option<ListedToken> {
    let mut words = line.split(' ');
    let entry = TokenEntry {
        name: words.next()?.to_owned(),
        role: words.next()?.parse::<TokenRole>().ok()?,
    };
    let hash = Hash::from_hex(words.next()?)?;
    words
        .next()
        .is_none()
        .then_some(ListedToken { entry, hash })
}
