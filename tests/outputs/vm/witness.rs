//! Observers of the devices in the machine: `evtest` reads one device, `libinput` all of them.

use super::machine::Machine;

/// An input event, as printed by `evtest`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EvdevEvent {
    /// The name of the type: `EV_KEY`.
    pub kind: String,
    /// The code.
    pub code: u16,
    /// The name of the code: `KEY_H`.
    pub name: String,
    /// The value: 1 for a press, 0 for a release.
    pub value: i32,
}

impl EvdevEvent {
    /// Parses `Event: time 1.5, type 1 (EV_KEY), code 35 (KEY_H), value 1`. Returns `None` for any other line.
    fn parse(line: &str) -> Option<Self> {
        let (_, event) = line.split_once(", type ")?;
        let words: Vec<&str> = event
            .split([' ', ',', '(', ')'])
            .filter(|word| !word.is_empty())
            .collect();
        let [_, kind, "code", code, name, "value", value] = words[..] else {
            return None;
        };
        Some(Self {
            kind: kind.to_owned(),
            code: code.parse().ok()?,
            name: name.to_owned(),
            value: value.parse().ok()?,
        })
    }
}

/// A running `evtest`.
pub struct Evtest {
    /// The device node: `event3`.
    pub node: String,
    log: String,
}

impl Evtest {
    /// Starts `evtest` on the device of this name as soon as it exists.
    pub fn start(machine: &mut Machine, name: &str, number: usize) -> Self {
        let node = machine.wait_for(&format!("a device {name}"), |machine| {
            let found = machine.run(&format!(
                "grep -lx '{name}' /sys/class/input/event*/device/name"
            ));
            let node = found
                .split('/')
                .find(|part| part.starts_with("event") && *part != "event*");
            node.map(str::to_owned)
        });
        let log = format!("/tmp/evtest-{number}-{}.log", name.replace(' ', "-"));
        // With real-time priority, to read the last events of a device before it is removed.
        machine.run(&format!(
            "chrt -f 50 evtest /dev/input/{node} >{log} 2>&1 &"
        ));
        machine.wait_for(&format!("evtest on {name}"), |machine| {
            machine
                .run(&format!("cat {log}"))
                .contains("Testing ...")
                .then_some(())
        });
        Self { node, log }
    }

    /// Returns the events so far.
    pub fn events(&self, machine: &mut Machine) -> Vec<EvdevEvent> {
        let lines = machine.run(&format!("grep ', type ' {}", self.log));
        lines.lines().filter_map(EvdevEvent::parse).collect()
    }

    /// Returns the keys so far that were pressed (`true`) and released.
    pub fn keys(&self, machine: &mut Machine) -> Vec<(u16, bool)> {
        let events = self.events(machine).into_iter();
        let keys = events.filter(|event| event.kind == "EV_KEY");
        keys.map(|event| (event.code, event.value != 0)).collect()
    }
}

/// A running `libinput debug-events`.
pub struct Libinput {
    /// Number of lines to ignore.
    past: usize,
}

impl Libinput {
    const LOG: &str = "/tmp/libinput.log";

    /// Starts it.
    pub fn start(machine: &mut Machine) -> Self {
        machine.run(&format!(
            "libinput debug-events --show-keycodes >{} 2>&1 &",
            Self::LOG
        ));
        Self { past: 0 }
    }

    /// Ignores all lines so far.
    pub fn forget(&mut self, machine: &mut Machine) {
        self.past += self.lines(machine).len();
    }

    /// Returns the lines about devices and their events: `event3 KEYBOARD_KEY +1.52s KEY_H (35) pressed`.
    pub fn lines(&self, machine: &mut Machine) -> Vec<String> {
        let log = machine.run(&format!("tail -n +{} {}", self.past + 1, Self::LOG));
        let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
        log.lines()
            .map(|line| words(line.trim_start_matches('-')))
            .collect()
    }

    /// Waits for a line with all these parts.
    pub fn wait_for(&self, machine: &mut Machine, parts: &[&str]) -> String {
        machine.wait_for(&format!("libinput prints {parts:?}"), |machine| {
            let mut lines = self.lines(machine).into_iter();
            lines.find(|line| parts.iter().all(|part| line.contains(part)))
        })
    }

    /// Returns all lines; of successive motion or scroll lines, only the first. The complete log is copied to the host.
    pub fn log(machine: &mut Machine) -> Vec<String> {
        let log = machine.keep(Self::LOG);
        let mut lines: Vec<String> = log.lines().map(str::to_owned).collect();
        lines.dedup_by_key(|line| {
            let subject = line.trim_start_matches(['-', ' ']).split('+').next();
            let is_motion = line.contains("POINTER_MOTION") || line.contains("POINTER_SCROLL");
            if is_motion {
                subject.unwrap_or(line).to_owned()
            } else {
                line.clone()
            }
        });
        lines
    }
}
