//! A token, and its hash.

use std::fmt;

use ring::digest::{SHA256, digest};
use ring::rand::{SecureRandom, SystemRandom};
use subtle::ConstantTimeEq;

use super::hex;
use crate::network::NetworkError;

/// A secret of 256 random bits. It is printed nowhere.
#[derive(Clone)]
pub struct Token([u8; 32]);

impl Token {
    /// Returns a token from the random numbers of the operating system.
    pub fn generate() -> Result<Self, NetworkError> {
        let mut bytes = [0; 32];
        let filled = SystemRandom::new().fill(&mut bytes);
        let no_random = |_| NetworkError::Tls("the system has no random numbers".into());
        filled.map_err(no_random)?;
        Ok(Self(bytes))
    }

    /// Reads 64 hexadecimal digits.
    pub fn from_hex(text: &str) -> Option<Self> {
        hex::decode(text).map(Self)
    }

    /// Returns the digits, for the token file and the wire.
    pub fn to_hex(&self) -> String {
        hex::encode(&self.0)
    }

    /// Returns the hash that the list of a server holds.
    pub fn hash(&self) -> Hash {
        Hash::of(&self.0)
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(secret)")
    }
}

/// A SHA-256 hash: of a token, or of a certificate, whose fingerprint it is. Comparing two takes the same time whether they
/// differ early, late or not at all.
#[derive(Clone, Copy, Debug)]
pub struct Hash([u8; 32]);

impl Hash {
    /// Returns the hash of these bytes.
    pub fn of(bytes: &[u8]) -> Self {
        let mut hash = [0; 32];
        hash.copy_from_slice(digest(&SHA256, bytes).as_ref());
        Self(hash)
    }

    /// Reads 64 hexadecimal digits.
    pub fn from_hex(text: &str) -> Option<Self> {
        hex::decode(text).map(Self)
    }

    /// Returns the digits.
    pub fn to_hex(self) -> String {
        hex::encode(&self.0)
    }
}

impl PartialEq for Hash {
    fn eq(&self, other: &Self) -> bool {
        self.0.ct_eq(&other.0).into()
    }
}

impl Eq for Hash {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_differ_and_are_not_printed() {
        let [first, second] = [(); 2].map(|()| Token::generate().unwrap());
        assert_ne!(first.hash(), second.hash());
        assert_eq!(
            first.hash(),
            Token::from_hex(&first.to_hex()).unwrap().hash()
        );
        let printed = format!("{first:?}");
        assert!(!printed.contains(&first.to_hex()[..4]), "{printed}");
    }

    #[test]
    fn the_hash_is_sha_256() {
        let empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
        assert_eq!(Hash::of(b"").to_hex(), empty);
    }
}
