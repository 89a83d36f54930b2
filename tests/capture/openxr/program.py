"""The programs of the test: Monado's service and `ademan run`, both below a folder with Debian, or in this system."""

import os
import queue
import shutil
import signal
import subprocess
import threading
import time

RUNTIME = "/run/ademan-openxr"
ENVIRONMENT = {
    "HOME": "/root",
    "LIBGL_ALWAYS_SOFTWARE": "1",
    "P_OVERRIDE_ACTIVE_CONFIG": "remote",
    "PATH": "/usr/local/bin:/usr/bin:/bin",
    "XDG_RUNTIME_DIR": RUNTIME,
    "XRT_COMPOSITOR_NULL": "1",
    "XRT_NO_STDIN": "1",
    "XR_RUNTIME_JSON": "/usr/share/openxr/1/openxr_monado.json",
}
CHROOT = shutil.which("chroot", path="/usr/sbin:/sbin:/usr/bin:/bin")


class Machine:
    """A root folder whose programs are started, and the logs of these."""

    def __init__(self, root, logs):
        self.root, self.logs = root, logs
        os.makedirs(self.path(RUNTIME), mode=0o700, exist_ok=True)
        os.chmod(self.path(RUNTIME), 0o700)

    def path(self, path):
        return os.path.join(self.root, path.lstrip("/"))

    def command(self, *arguments):
        return list(arguments) if self.root == "/" else [CHROOT, self.root, *arguments]

    def start(self, *arguments, **options):
        return subprocess.Popen(self.command(*arguments), env=ENVIRONMENT, **options)

    def service(self):
        """Starts Monado without a display, and waits for its socket."""
        socket = self.path(f"{RUNTIME}/monado_comp_ipc")
        if os.path.exists(socket):
            os.remove(socket)
        log = open(os.path.join(self.logs, "service.log"), "a")
        process = self.start("monado-service", stdout=log, stderr=log)
        wait_for("the service", lambda: os.path.exists(socket), 30)
        # It listens for the driver's connection a little later.
        time.sleep(1)
        return process

    def doctor(self):
        """Returns the row of the headset."""
        ended = subprocess.run(
            self.command("ademan-openxr-test", "doctor", "--source", "openxr:"),
            env=ENVIRONMENT,
            capture_output=True,
            text=True,
            timeout=60,
        )
        rows = [row for row in ended.stdout.splitlines() if " headset " in row]
        return " ".join(rows[0].split()) if rows else ended.stdout + ended.stderr


class Program:
    """`ademan run` with the source `openxr:`. Each line that it prints has the time of its arrival."""

    def __init__(self, machine, layout, name):
        self.process = machine.start(
            *["ademan-openxr-test", "run", "--allow-root", "--source", "openxr:", "--wait"],
            *["--layout", layout, "--output", "transcript", "--control", "off", "--role", "both"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.lines, self.messages, self.events = queue.Queue(), [], []
        self.log = open(os.path.join(machine.logs, f"{name}.log"), "w")
        threading.Thread(target=self._read_events, daemon=True).start()
        threading.Thread(target=self._read_messages, daemon=True).start()

    def _read_events(self):
        for line in self.process.stdout:
            self._note(line)
            # `1179.763 down H`
            parts = line.split()
            if len(parts) == 3:
                event = (time.monotonic(), parts[1], parts[2])
                self.events.append(event)

    def _read_messages(self):
        for line in self.process.stderr:
            self._note(line)
            # The runtime and the loader print more than this program.
            if not is_of_runtime(line):
                self.messages.append(line.strip())

    def _note(self, line):
        self.log.write(f"{time.monotonic():.3f} {line}")
        self.log.flush()

    def typed(self):
        """The keys that went down, in order."""
        return [key for _, kind, key in self.events if kind == "down"]

    def is_down(self, key):
        kinds = [kind for _, kind, other in self.events if other == key]
        return bool(kinds) and kinds[-1] == "down"

    def all_up(self):
        return not any(self.is_down(key) for key in self.typed())

    def said(self, text):
        return any(text in message for message in self.messages)

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(timeout=20)
        self.log.close()


def is_of_runtime(line):
    starts = ("LOG ", "ERROR ", "Error [", "XR_", "\t", "#", "Please", "It is called", "In build")
    return line.startswith(starts) or not line.strip()


def wait_for(what, is_true, seconds):
    """Waits until a condition holds. Returns the seconds that it took."""
    began = time.monotonic()
    while not is_true():
        if time.monotonic() - began > seconds:
            raise AssertionError(f"waited {seconds} s in vain: {what}")
        time.sleep(0.005)
    return time.monotonic() - began
