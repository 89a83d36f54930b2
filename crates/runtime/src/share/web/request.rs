//! A request of HTTP, and the answers to one that gets no page.

use tungstenite::handshake::machine::TryParse;
use tungstenite::handshake::server::{Request, create_response, write_response};

use super::pages;

/// Longest request, in bytes: a browser sends some 600.
const MAX_BYTES: usize = 8192;

/// Returns the request at the start of these bytes, and its length; `None` if it is not complete. Fails with the answer if it is
/// wrong or too long.
pub(crate) fn parse_request(bytes: &[u8]) -> Result<Option<(usize, Request)>, Vec<u8>> {
    if bytes.len() > MAX_BYTES {
        let status = "431 Request Header Fields Too Large";
        return Err(pages::refusal(status, "the request is too long"));
    }
    let wrong = |_| pages::refusal("400 Bad Request", "not a GET request of HTTP 1.1");
    Request::try_parse(bytes).map_err(wrong)
}

/// Returns the answer after which the connection is a WebSocket. Fails with the answer to a request for something else.
pub(crate) fn upgrade(request: &Request) -> Result<Vec<u8>, Vec<u8>> {
    let mut bytes = Vec::new();
    create_response(request)
        .and_then(|response| write_response(&mut bytes, &response))
        .map_err(|_| pages::refusal("426 Upgrade Required", "this is a WebSocket"))?;
    Ok(bytes)
}

/// Returns the answer to a client that may not connect.
pub(crate) fn forbid(reason: &str) -> Vec<u8> {
    pages::refusal("403 Forbidden", reason)
}

/// Returns the answer to a request for a page that does not exist.
pub(crate) fn no_such_page() -> Vec<u8> {
    pages::refusal("404 Not Found", "there is no such page")
}
