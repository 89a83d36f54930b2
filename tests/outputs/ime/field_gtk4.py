"""A text field of GTK 4, which prints what `field.py` prints. Argument: `text` or `password`."""

import sys

import gi

gi.require_version("Gtk", "4.0")
from gi.repository import GLib, Gtk  # noqa: E402


def say(what, text):
    print(what, text, sep="\t", flush=True)


field = Gtk.PasswordEntry() if sys.argv[1] == "password" else Gtk.Entry()
field.connect("changed", lambda field: say("text", field.get_text()))
field.get_delegate().connect("preedit-changed", lambda _, word: say("word", word))
field.connect("activate", lambda field: say("activated", field.get_text()))
window = Gtk.Window(child=field)
window.connect("notify::is-active", lambda window, _: window.is_active() and say("focused", ""))
window.present()
GLib.MainLoop().run()
