#!/usr/bin/python3
"""An IBus panel, as desktops have one: writes each list of candidates to the file of ADEMAN_PANEL, and clicks the candidate
that ADEMAN_CLICK names."""

import os

import gi

gi.require_version("IBus", "1.0")
from gi.repository import GLib, IBus  # noqa: E402


class Panel(IBus.PanelService):
    def do_update_lookup_table(self, table, is_visible):
        count = table.get_number_of_candidates() if is_visible else 0
        texts = [table.get_candidate(index).get_text() for index in range(count)]
        with open(os.environ["ADEMAN_PANEL"], "a", encoding="utf-8") as log:
            print(*texts, sep="\t", file=log)
        if os.environ["ADEMAN_CLICK"] in texts:
            self.candidate_clicked(texts.index(os.environ["ADEMAN_CLICK"]), 1, 0)


bus = IBus.Bus()
panel = Panel(connection=bus.get_connection(), object_path=IBus.PATH_PANEL)
bus.request_name(IBus.SERVICE_PANEL, IBus.BusNameFlag.REPLACE_EXISTING)
GLib.MainLoop().run()
