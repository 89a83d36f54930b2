//! The link for a headset, if a source of the setup waits for one.

use ademan::capture::SourceUri;
use ademan::setup::LoadedSetup;
use ademan::studio::headset::HeadsetLink;

use crate::failure::Failure;
use crate::headset_link;

/// Returns the link to the page of a setup, with its QR code. `None` if no source of the setup serves one.
pub fn link(setup: &LoadedSetup) -> Result<Option<HeadsetLink>, Failure> {
    let mut uris = setup.named_sources().filter_map(|source| source.uri);
    let Some(address) = uris.find_map(SourceUri::page_address) else {
        return Ok(None);
    };
    let url = headset_link::link(address)?;
    let code = headset_link::modules(&url);
    Ok(Some(HeadsetLink { url, code }))
}
