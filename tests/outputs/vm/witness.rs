//! Who sees in the machine what the kernel's devices do: `evtest` reads one device, `libinput` all of them.

use super::machine::Machine;

/// An event as `evtest` read it from the kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Heard {
    /// The name of its type: `EV_KEY`.
    pub kind: String,
    /// The number of its code in the type.
    pub code: u16,
    /// The name of its code: `KEY_H`.
    pub name: String,
    /// Its value: 1 for a key that goes down, 0 for one that comes up.
    pub value: i32,
}

impl Heard {
    /// Of `Event: time 1.5, type 1 (EV_KEY), code 35 (KEY_H), value 1`; none of any other line.
    fn of(line: &str) -> Option<Self> {
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

/// `evtest` on a device.
pub struct Evtest {
    /// The device, as in `event3`.
    pub node: String,
    log: String,
}

impl Evtest {
    /// On the device of this name, once there is one.
    pub fn on(machine: &mut Machine, name: &str, number: usize) -> Self {
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
        // At a priority above all else: what a device that goes away says last is for who reads it at once.
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

    /// What it has read so far.
    pub fn heard(&self, machine: &mut Machine) -> Vec<Heard> {
        let lines = machine.run(&format!("grep ', type ' {}", self.log));
        lines.lines().filter_map(Heard::of).collect()
    }

    /// The keys that it has read, with whether they went down.
    pub fn keys(&self, machine: &mut Machine) -> Vec<(u16, bool)> {
        let heard = self.heard(machine).into_iter();
        let keys = heard.filter(|event| event.kind == "EV_KEY");
        keys.map(|event| (event.code, event.value != 0)).collect()
    }
}

/// `libinput debug-events`, on all devices that come and go.
pub struct Libinput {
    /// Lines that belong to what was before.
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

    /// From now on, only new lines count.
    pub fn forget(&mut self, machine: &mut Machine) {
        self.past += self.lines(machine).len();
    }

    /// What it says about devices and their events: `event3 KEYBOARD_KEY +1.52s KEY_H (35) pressed`.
    pub fn lines(&self, machine: &mut Machine) -> Vec<String> {
        let log = machine.run(&format!("tail -n +{} {}", self.past + 1, Self::LOG));
        let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
        log.lines()
            .map(|line| words(line.trim_start_matches('-')))
            .collect()
    }

    /// Waits for a line with all these parts.
    pub fn wait_for(&self, machine: &mut Machine, parts: &[&str]) -> String {
        machine.wait_for(&format!("libinput says {parts:?}"), |machine| {
            let mut lines = self.lines(machine).into_iter();
            lines.find(|line| parts.iter().all(|part| line.contains(part)))
        })
    }

    /// What it has said from the start; of many lines about the same, such as motion, the first. All of it is kept
    /// beside the log of the kernel.
    pub fn log(machine: &mut Machine) -> Vec<String> {
        let log = machine.keep(Self::LOG);
        let mut lines: Vec<String> = log.lines().map(str::to_owned).collect();
        lines.dedup_by_key(|line| {
            let subject = line.trim_start_matches(['-', ' ']).split('+').next();
            let is_motion = line.contains("POINTER_MOTION") || line.contains("POINTER_SCROLL");
            match is_motion {
                true => subject.unwrap_or(line).to_owned(),
                false => line.clone(),
            }
        });
        lines
    }
}
