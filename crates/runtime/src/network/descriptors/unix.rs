//! The limit of Unix: `RLIMIT_NOFILE`.

use rustix::process::{Resource, getrlimit};

/// Returns the largest number of descriptors of the process; `None` if there is no limit.
pub(super) fn limit() -> Option<usize> {
    let limit = getrlimit(Resource::Nofile).current?;
    usize::try_from(limit).ok()
}
