"""A desktop that shows notifications and the icons of a tray, through the D-Bus library of GLib.

Prints a line of JSON for each notification, registration, state of the icon and menu. A line of standard input is the
label of an entry of the menu, which is clicked, or closes the notification.
"""

import json
import sys

from gi.repository import Gio, GLib

ITEM = "org.kde.StatusNotifierItem"
CLOSE = "close the notification"
MENU = "com.canonical.dbusmenu"
INTERFACES = Gio.DBusNodeInfo.new_for_xml("""<node>
  <interface name="org.kde.StatusNotifierWatcher">
    <method name="RegisterStatusNotifierItem"><arg type="s" direction="in"/></method>
  </interface>
  <interface name="org.freedesktop.Notifications">
    <method name="Notify">
      <arg type="s" direction="in"/><arg type="u" direction="in"/><arg type="s" direction="in"/>
      <arg type="s" direction="in"/><arg type="s" direction="in"/><arg type="as" direction="in"/>
      <arg type="a{sv}" direction="in"/><arg type="i" direction="in"/><arg type="u" direction="out"/>
    </method>
  </interface>
</node>""")

bus = Gio.bus_get_sync(Gio.BusType.SESSION)
entries = {}
item = None
revision = 0


def report(**line):
    print(json.dumps(line), flush=True)


def call(path, interface, method, arguments):
    reply = bus.call_sync(item, path, interface, method, arguments, None, Gio.DBusCallFlags.NONE, 5000, None)
    return reply.unpack()


def read_icon():
    (properties,) = call("/StatusNotifierItem", "org.freedesktop.DBus.Properties", "GetAll", GLib.Variant("(s)", (ITEM,)))
    tool_tip = properties["ToolTip"]
    report(icon=properties["IconName"], status=properties["Status"], menu=properties["Menu"], tip=tool_tip[2:])


def read_menu():
    global revision
    (revision, (_, _, children)) = call("/MenuBar", MENU, "GetLayout", GLib.Variant("(iias)", (0, -1, [])))
    entries.clear()
    labels = []
    for number, properties, _ in children:
        label = properties.get("label", "-")
        entries[label] = number
        labels.append("*" + label if properties.get("toggle-state") == 1 else label)
    report(entries=labels)


def read(*parts):
    try:
        for part in parts:
            part()
    except GLib.Error:
        pass  # The run has ended.
    return False


def handle(_bus, _sender, _path, _interface, method, arguments, invocation):
    global item
    arguments = arguments.unpack()
    if method == "RegisterStatusNotifierItem":
        item = arguments[0]
        report(registered=item)
        invocation.return_value(None)
        GLib.idle_add(read, read_icon, read_menu)
    else:
        _, replaces, icon, summary, body, _, hints, _ = arguments
        report(replaces=replaces, icon=icon, summary=summary, body=body, urgency=hints["urgency"])
        invocation.return_value(GLib.Variant("(u)", (7,)))


def changed(*_):
    read(read_icon)


def announced(_bus, _sender, _path, _interface, _signal, arguments):
    # As libdbusmenu does, which Xfce and waybar use.
    if arguments.unpack()[0] > revision:
        read(read_menu)


def clicked(*_):
    label = sys.stdin.readline().strip()
    if label == CLOSE:
        closed = GLib.Variant("(uu)", (7, 1))
        bus.emit_signal(None, "/org/freedesktop/Notifications", "org.freedesktop.Notifications", "NotificationClosed", closed)
        # The program reads it before a later message.
        bus.flush_sync()
        report(closed=7)
    elif label:
        data = GLib.Variant("(isvu)", (entries[label], "clicked", GLib.Variant("s", ""), 0))
        call("/MenuBar", MENU, "Event", data)
    return bool(label)


for path, interface in zip(["/StatusNotifierWatcher", "/org/freedesktop/Notifications"], INTERFACES.interfaces):
    bus.register_object(path, interface, handle, None, None)
    Gio.bus_own_name_on_connection(bus, interface.name, Gio.BusNameOwnerFlags.NONE, None, None)
bus.signal_subscribe(None, ITEM, "NewIcon", None, None, Gio.DBusSignalFlags.NONE, changed)
bus.signal_subscribe(None, MENU, "LayoutUpdated", None, None, Gio.DBusSignalFlags.NONE, announced)
GLib.io_add_watch(sys.stdin, GLib.PRIORITY_DEFAULT, GLib.IO_IN | GLib.IO_HUP, clicked)
GLib.MainLoop().run()
