//! The roles of sources with tokens.

use super::{NamedSource, Setup, SetupError};
use crate::capture::SourceUri;
use crate::network::{self, TokenRole, tokens};
use ademan_core::message::escape;
use ademan_core::pipeline::SourceRole;

impl Setup {
    /// Gives each source without a role the role of its token. Reads the token files, which only the setup of the person who runs
    /// the program may name.
    pub fn use_token_roles(&mut self) -> Result<(), SetupError> {
        use_token_role(&self.source, &mut self.role)?;
        use_token_role(&self.arm_source, &mut self.arm_role)?;
        if let Some(other) = &mut self.other_hand {
            use_token_role(&other.source, &mut other.role)?;
            use_token_role(&other.arm_source, &mut other.arm_role)?;
        }
        Ok(())
    }
}

impl NamedSource<'_> {
    /// Returns its role in `ademan run`, where a source has the role of its token unless the setup states one. An error states why its
    /// token is refused, and the remedy.
    pub fn role_with_token(&self) -> Result<SourceRole, SetupError> {
        let Some(file) = self.uri.and_then(SourceUri::token_file) else {
            return Ok(self.permissions.role);
        };
        let token = token_role(file)?;
        if self.has_own_role {
            Ok(self.permissions.role)
        } else {
            granted_role(file, token)
        }
    }
}

fn use_token_role(
    source: &Option<SourceUri>,
    role: &mut Option<SourceRole>,
) -> Result<(), SetupError> {
    let file = source.as_ref().and_then(SourceUri::token_file);
    if let (Some(file), None) = (file, &role) {
        *role = Some(granted_role(file, token_role(file)?)?);
    }
    Ok(())
}

/// Returns the role of the token in a file.
fn token_role(file: &str) -> Result<TokenRole, SetupError> {
    let role = network::token_path(file).and_then(|path| tokens::role_of_file(&path));
    role.map_err(|error| SetupError::Value(error.to_string()))
}

/// Returns the role that the token in a file grants to a source.
fn granted_role(file: &str, token: TokenRole) -> Result<SourceRole, SetupError> {
    match token {
        TokenRole::See => Err(SetupError::Value(format!(
            "the token in {} has the role `see`, so its source may cause no event; use a token with the role `point` or \
             `type`, or state a role: `--role pointer`",
            escape(file)
        ))),
        TokenRole::Point => Ok(SourceRole::Pointer),
        TokenRole::Type => Ok(SourceRole::Both),
    }
}
