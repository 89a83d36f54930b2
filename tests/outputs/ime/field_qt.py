"""A text field of Qt, which prints what `field.py` prints. Arguments: `text` or `password`, and the version of Qt."""

import importlib
import sys

widgets = importlib.import_module(f"PyQt{sys.argv[2]}.QtWidgets")


def say(what, text):
    print(what, text, sep="\t", flush=True)


class Field(widgets.QLineEdit):
    word = ""

    def inputMethodEvent(self, event):
        super().inputMethodEvent(event)
        if event.preeditString() != self.word:
            self.word = event.preeditString()
            say("word", self.word)

    def focusInEvent(self, event):
        super().focusInEvent(event)
        say("focused", "")


app = widgets.QApplication(sys.argv)
field = Field()
if sys.argv[1] == "password":
    field.setEchoMode(widgets.QLineEdit.EchoMode.Password)
field.textChanged.connect(lambda text: say("text", text))
field.returnPressed.connect(lambda: say("activated", field.text()))
field.show()
app.exec()
