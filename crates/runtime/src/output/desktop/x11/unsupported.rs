//! Operating systems on which `enigo` injects keys.

use crate::output::desktop::enigo_display::EnigoDisplay;
use crate::output::desktop::injector::Injector;

/// Connects to the X server of this name, or to the desktop of the session.
pub fn connect(name: Option<&str>) -> Result<Box<dyn Injector>, String> {
    Ok(Box::new(EnigoDisplay::connect(name)?))
}
