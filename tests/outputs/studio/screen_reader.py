"""A reader of the widgets of all windows through the accessibility bus, as a screen reader is one.

Prints a line of JSON for each line of standard input: a list of the widgets with name, `is_checked` and area, in pixels from the left
and from the top of the screen, with width and height.
"""

import json
import sys
import time

from gi.repository import Gio, GLib

ACCESSIBLE = "org.a11y.atspi.Accessible"
ROOT = ("org.a11y.atspi.Registry", "/org/a11y/atspi/accessible/root")
CHECKED = 1 << 4  # ATSPI_STATE_CHECKED
SCREEN = 0  # ATSPI_COORD_TYPE_SCREEN


def call(bus, widget, interface, method, arguments=None):
    name, path = widget
    return bus.call_sync(name, path, interface, method, arguments, None, Gio.DBusCallFlags.NONE, 5000, None).unpack()


def connect():
    session = Gio.bus_get_sync(Gio.BusType.SESSION)
    daemon = ("org.freedesktop.DBus", "/org/freedesktop/DBus")
    name = GLib.Variant("(s)", ("org.a11y.Bus",))
    # The launcher of the accessibility bus starts at the same time.
    while not call(session, daemon, "org.freedesktop.DBus", "NameHasOwner", name)[0]:
        time.sleep(0.01)
    (address,) = call(session, ("org.a11y.Bus", "/org/a11y/bus"), "org.a11y.Bus", "GetAddress")
    flags = Gio.DBusConnectionFlags.AUTHENTICATION_CLIENT | Gio.DBusConnectionFlags.MESSAGE_BUS_CONNECTION
    return Gio.DBusConnection.new_for_address_sync(address, flags, None, None)


def describe(bus, widget):
    arguments = GLib.Variant("(ss)", (ACCESSIBLE, "Name"))
    (name,) = call(bus, widget, "org.freedesktop.DBus.Properties", "Get", arguments)
    ((states, _),) = call(bus, widget, ACCESSIBLE, "GetState")
    (area,) = call(bus, widget, "org.a11y.atspi.Component", "GetExtents", GLib.Variant("(u)", (SCREEN,)))
    return {"name": name, "is_checked": bool(states & CHECKED), "area": area}


def widgets(bus, parent):
    try:
        (children,) = call(bus, parent, ACCESSIBLE, "GetChildren")
    except GLib.Error:
        # A picture that was drawn since has other widgets.
        return
    for child in children:
        try:
            yield describe(bus, child)
        except GLib.Error:
            # So it has, or this is a program, which has no area.
            pass
        yield from widgets(bus, child)


bus = connect()
for _ in sys.stdin:
    print(json.dumps(list(widgets(bus, ROOT))), flush=True)
