"""A text field of GTK. Prints each change: the text, the word that is shown but not taken yet, and the activation.

Argument: `text`, `sentences` for a field that asks for capitals, `url` or `password`.
"""

import sys

import gi

gi.require_version("Gtk", "3.0")
from gi.repository import Gtk  # noqa: E402


def say(what, text):
    print(what, text, sep="\t", flush=True)


field = Gtk.Entry()
if sys.argv[1] == "password":
    field.set_visibility(False)
    field.set_input_purpose(Gtk.InputPurpose.PASSWORD)
if sys.argv[1] == "url":
    field.set_input_purpose(Gtk.InputPurpose.URL)
if sys.argv[1] == "sentences":
    field.set_input_hints(Gtk.InputHints.UPPERCASE_SENTENCES)
field.connect("changed", lambda field: say("text", field.get_text()))
field.connect("preedit-changed", lambda _, word: say("word", word))
field.connect("activate", lambda field: say("activated", field.get_text()))
window = Gtk.Window()
window.connect("focus-in-event", lambda *_: say("focused", ""))
window.add(field)
window.show_all()
Gtk.main()
