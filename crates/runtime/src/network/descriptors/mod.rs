//! The file descriptors of the process, which connections share with everything else.

#[cfg(unix)]
mod unix;
#[cfg(unix)]
use unix::limit;

#[cfg(not(unix))]
mod unsupported;
#[cfg(not(unix))]
use unsupported::limit;

/// Descriptors that are left to devices, displays, files, and the clients of the control socket and the 6-DoF mouse. A run
/// without a desktop and clients has 12.
const RESERVED: usize = 48;

/// Least number of connections, whatever the limit is.
const MIN_CONNECTIONS: usize = 4;

/// Returns the largest number of connections that the program may keep open for clients that take no part in typing, so that
/// the control socket and a reload of files find a descriptor (`ulimit -n`).
pub(crate) fn max_connections() -> usize {
    max_connections_of(limit())
}

fn max_connections_of(limit: Option<usize>) -> usize {
    let limit = limit.unwrap_or(usize::MAX);
    limit.saturating_sub(RESERVED).max(MIN_CONNECTIONS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn connections_leave_descriptors_to_the_rest_of_the_program() {
        assert_eq!(max_connections_of(Some(64)), 16);
        assert_eq!(max_connections_of(Some(1024)), 976);
        assert_eq!(max_connections_of(Some(8)), MIN_CONNECTIONS);
        assert!(max_connections_of(None) > 1 << 20);
    }
}
