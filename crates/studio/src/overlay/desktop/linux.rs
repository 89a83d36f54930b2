//! X servers, including the X servers of Wayland desktops.

use eframe::EventLoopBuilderHook;
use winit::platform::x11::EventLoopBuilderExtX11;
use x11rb::protocol::xproto::ConnectionExt;

use super::Ability;

/// Returns the ability of the desktop. Wayland has none without an X server.
pub fn ability() -> Ability {
    match has_compositor() {
        Some(true) => Ability::Transparent,
        Some(false) => Ability::Opaque,
        None => Ability::None,
    }
}

/// Returns `true` if the X server has a compositor, which owns a selection (Extended Window Manager Hints 1.5, "Compositing
/// Managers"). `None` without an X server.
fn has_compositor() -> Option<bool> {
    let (client, screen) = x11rb::connect(None).ok()?;
    let name = format!("_NET_WM_CM_S{screen}");
    let atom = client.intern_atom(false, name.as_bytes()).ok()?;
    let atom = atom.reply().ok()?.atom;
    let owner = client.get_selection_owner(atom).ok()?;
    Some(owner.reply().ok()?.owner != x11rb::NONE)
}

/// Opens windows on the X server even if there is a Wayland compositor: its protocol has no window that stays above the others.
pub fn prefer_x11() -> Option<EventLoopBuilderHook> {
    Some(Box::new(|builder| {
        builder.with_x11();
    }))
}
