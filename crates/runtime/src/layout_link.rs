//! Links that carry a layout in their fragment, as the page of `web/` makes them.
//!
//! `#layout=` is followed by the text, compressed as raw DEFLATE (RFC 1951), in base64 for URLs without padding (RFC 4648). A
//! browser sends the fragment of a link to no server. Only the fragment is read: nothing is loaded from the address before it.

use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::{TINFLStatus, decompress_to_vec_with_limit};

use ademan_core::document::{Document, DocumentError, MAX_DOCUMENT_BYTES};
use ademan_core::layout::Layout;

/// The page of `ademan serve` on this machine.
pub const LOCAL_PAGE: &str = "http://127.0.0.1:8081/";

/// The start of the fragment.
const FRAGMENT: &str = "#layout=";

/// The longest link, in bytes: incompressible text of the largest document, in base64.
const MAX_LINK_BYTES: usize = 3 << 19;

/// The level of compression, of 10.
const LEVEL: u8 = 9;

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/// The reason why a link has no layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutLinkError {
    /// The link is longer than any layout makes it.
    #[error("the link is longer than {MAX_LINK_BYTES} bytes; ask for the file of the layout")]
    TooLong,
    /// The link was cut or changed on its way.
    #[error("the layout in the link is damaged; copy the whole link, in quotes")]
    Damaged,
    /// The layout is larger than a file may be.
    #[error("the layout in the link is larger than 1 MiB")]
    TooLarge,
    /// The layout is not a text.
    #[error("the layout in the link is not valid UTF-8")]
    NotText,
}

/// Returns `true` if a name is a link with a layout, not the name of a file.
pub fn is_layout_link(name: &str) -> bool {
    let is_address = name.starts_with("https://") || name.starts_with("http://");
    is_address && name.contains(FRAGMENT)
}

/// Returns the link to the layout of a document at the address of a page, whose own fragment is left out.
///
/// # Errors
/// If the layout has faults, or is larger than a file may be.
pub fn share_layout(page: &str, document: Document) -> Result<String, DocumentError> {
    if document.text.len() as u64 > MAX_DOCUMENT_BYTES {
        let message = "the layout is larger than 1 MiB";
        return Err(DocumentError::for_file(&document.file, message));
    }
    let layout = Layout::from_document(document)?;
    let page = page.split('#').next().unwrap_or_default();
    Ok(layout_link(page, &layout.text))
}

/// Returns the link to a layout at the address of a page, without a fragment.
pub fn layout_link(page: &str, text: &str) -> String {
    let mut link = format!("{page}{FRAGMENT}");
    for bytes in compress_to_vec(text.as_bytes(), LEVEL).chunks(3) {
        let bits = bytes
            .iter()
            .fold(0, |bits, &byte| bits << 8 | u32::from(byte));
        let bits = bits << (8 * (3 - bytes.len()));
        let digit = |index: usize| DIGITS[(bits >> (18 - 6 * index) & 63) as usize];
        link.extend((0..=bytes.len()).map(|index| char::from(digit(index))));
    }
    link
}

/// Returns the text of the layout in a link, of at most 1 MiB.
pub fn layout_in_link(link: &str) -> Result<String, LayoutLinkError> {
    let (_, encoded) = link.split_once(FRAGMENT).ok_or(LayoutLinkError::Damaged)?;
    if encoded.len() > MAX_LINK_BYTES {
        return Err(LayoutLinkError::TooLong);
    }
    let compressed = from_base64(encoded).ok_or(LayoutLinkError::Damaged)?;
    let text = decompress_to_vec_with_limit(&compressed, MAX_DOCUMENT_BYTES as usize);
    let text = text.map_err(|error| match error.status {
        TINFLStatus::HasMoreOutput => LayoutLinkError::TooLarge,
        _ => LayoutLinkError::Damaged,
    })?;
    String::from_utf8(text).map_err(|_| LayoutLinkError::NotText)
}

fn from_base64(encoded: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(encoded.len() / 4 * 3 + 2);
    for digits in encoded.as_bytes().chunks(4) {
        let mut bits = 0;
        for &digit in digits {
            bits = bits << 6 | DIGITS.iter().position(|&own| own == digit)? as u32;
        }
        bits <<= 6 * (4 - digits.len());
        let [_, decoded @ ..] = u32::to_be_bytes(bits);
        // One digit alone is not a byte.
        bytes.extend(decoded.get(..digits.len().checked_sub(1).filter(|&it| it > 0)?)?);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::document::shipped_layouts;

    #[test]
    fn every_layout_passes_through_a_link() {
        let texts = shipped_layouts().map(|name| Document::shipped(name).unwrap().text);
        for text in texts.chain(["", "a", "é", "ab", "abc"].map(str::to_owned)) {
            let link = layout_link("https://example.org/", &text);
            assert!(is_layout_link(&link));
            assert_eq!(layout_in_link(&link), Ok(text));
        }
        assert!(!is_layout_link("layouts/#layout=x.ron"));
    }

    #[test]
    fn only_a_layout_that_others_can_use_is_shared() {
        let document = Document::shipped("numpad").unwrap();
        let text = document.text.clone();
        let link = share_layout("https://example.org/a/#b", document).unwrap();
        assert!(link.starts_with("https://example.org/a/#layout="), "{link}");
        assert_eq!(layout_in_link(&link), Ok(text));
        let shared = |own: &str| share_layout(LOCAL_PAGE, Document::new("a.ron", own));
        let faulty = shared("Layout(name: \"a\", bords: [])").unwrap_err();
        assert!(faulty.to_string().contains("bords"), "{faulty}");
        let large = format!("Layout(name: \"a\"){}", " ".repeat(1 << 20));
        let large = shared(&large).unwrap_err().to_string();
        assert!(large.contains("larger than 1 MiB"), "{large}");
    }

    #[test]
    fn a_link_that_is_cut_foreign_or_a_bomb_is_refused() {
        let text = Document::shipped("qwerty-flat").unwrap().text;
        let link = layout_link("https://example.org/", &text);
        assert_eq!(
            layout_in_link(&link[..link.len() / 2]),
            Err(LayoutLinkError::Damaged)
        );
        assert_eq!(
            layout_in_link("https://example.org/#layout=%20"),
            Err(LayoutLinkError::Damaged)
        );
        assert_eq!(
            layout_in_link("https://example.org/"),
            Err(LayoutLinkError::Damaged)
        );
        let bomb = layout_link("https://example.org/", &" ".repeat(1 << 28));
        assert!(bomb.len() < MAX_LINK_BYTES);
        assert_eq!(layout_in_link(&bomb), Err(LayoutLinkError::TooLarge));
        let long = format!(
            "https://example.org/#layout={}",
            "A".repeat(MAX_LINK_BYTES + 1)
        );
        assert_eq!(layout_in_link(&long), Err(LayoutLinkError::TooLong));
    }
}
