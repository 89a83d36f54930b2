//! The link that a headset opens: the page of a session with its token, and the QR code of the link.
//!
//! The link is a password. Only a person may see it: it is in no message, log or file.

mod qr_code;

use ademan::network::{TokenRole, network_folder, tokens};

use crate::failure::Failure;

pub use self::qr_code::blocks;
#[cfg(feature = "studio")]
pub use self::qr_code::modules;

/// The token of the link.
const TOKEN: &str = "headset";

/// Returns the link to the page at an address such as `192.168.1.7:8443`.
pub fn link(address: &str) -> Result<String, Failure> {
    Ok(format!("https://{address}/#token={}", token()?))
}

/// Returns the secret of the token of the link, which is made if there is none. It lasts until it is revoked.
fn token() -> Result<String, Failure> {
    let folder = network_folder()?;
    if let Some(secret) = tokens::secret_of(&folder, TOKEN) {
        return Ok(secret);
    }
    tokens::create(&folder, TOKEN, TokenRole::Point)?;
    tokens::secret_of(&folder, TOKEN).ok_or_else(|| {
        Failure::job(format!(
            "the token `{TOKEN}` was removed by another program; try again"
        ))
    })
}
