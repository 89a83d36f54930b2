//! The check of the panic keys, which a session refuses to start without.

use super::Finding;
use crate::session::panic_keys;
use crate::setup::Setup;

/// Checks that the keyboards of this machine can be watched for the `panic_keys` of a setup. `None` if it has none.
///
/// Opens the keyboards for a moment.
pub fn check_panic_keys(setup: &Setup) -> Option<Finding> {
    if setup.panic_keys.is_empty() {
        return None;
    }
    let keys = panic_keys::parse_keys(&setup.panic_keys);
    let watched = match keys.and_then(|keys| panic_keys::check(&keys)) {
        Ok(()) => Ok("the keyboards of this machine can be watched for `panic_keys`".to_owned()),
        Err(error) => Err(error.to_string()),
    };
    Some(Finding::from_result("panic keys", true, watched))
}
