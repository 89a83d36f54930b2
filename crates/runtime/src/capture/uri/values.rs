//! The values of options of a URI.

use std::num::NonZeroU32;
use std::time::Duration;

use super::super::transport::MAX_DELAY;
pub(super) use super::super::transport::parse_path;
use ademan_core::message::escape;

pub(super) fn parse_baud(value: &str) -> Result<NonZeroU32, String> {
    value.parse().map_err(|_| {
        let value = escape(value);
        format!("`{value}` is not a bit rate, write bits per second: `baud=115200`")
    })
}

pub(super) fn parse_delay(value: &str) -> Result<Duration, String> {
    let delay = value.parse().ok().map(Duration::from_millis);
    delay.filter(|delay| *delay <= MAX_DELAY).ok_or_else(|| {
        let (value, longest) = (escape(value), MAX_DELAY.as_millis());
        format!("`{value}` is not a delay, write 0 to {longest} ms: `delay_ms=40`")
    })
}

/// Checks the origin of a page: a scheme, a host and perhaps a port, without a path.
pub(super) fn parse_origin(value: &str) -> Result<String, String> {
    let host = ["http://", "https://"]
        .iter()
        .find_map(|scheme| value.strip_prefix(scheme));
    match host {
        Some(host) if !host.is_empty() && !host.contains(['/', '*', '@']) => Ok(value.to_owned()),
        _ => Err(format!(
            "`{}` is not the address of a site, write it without a path: `origin=http://localhost:8000`",
            escape(value)
        )),
    }
}

/// Checks the name of a token file. A token itself is refused without being quoted: every user of the machine can see the
/// arguments of a program.
pub(super) fn parse_token_file(value: &str) -> Result<String, String> {
    let is_token = value.len() == 64 && value.bytes().all(|byte| byte.is_ascii_hexdigit());
    match value {
        "" => Err("`token_file=` is followed by nothing, write the name of the file".to_owned()),
        _ if is_token => Err(
            "`token_file=` is followed by a token, which others can see there; revoke it, and write the name of a file"
                .to_owned(),
        ),
        _ => Ok(parse_path(value)),
    }
}
