//! Inspection of a Linux machine. All paths are relative to a root directory, which is `/` except in tests.

use std::ffi::OsString;
use std::fs::{self, OpenOptions};
use std::io::ErrorKind;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use rustix::fs::{Access, AtFlags, CWD, OFlags, accessat};
use rustix::io::Errno;
use rustix::process::{getegid, geteuid, getgroups};

use super::super::Requirements;
use super::super::facts::{
    Compositor, DeviceNode, Facts, RunningInstance, RuntimeDir, UinputFacts, User, WatchdogScope,
    XDisplay,
};
use super::{wayland, x11};
use crate::advice::AccessDenied;
use crate::output::SUPPORTS_WAYLAND;
use crate::output::socket;
use crate::output::uinput::is_missing;
use crate::output::watchdog::scope_name;
use crate::priority;
use ademan_core::message::escape;

/// Checks of parts that this system does not have.
pub(in crate::doctor) const ABSENT: &[&str] = &[];

/// The facts list all USB serial adapters.
pub(in crate::doctor) const LISTS_PORTS: bool = true;

/// Prefixes of the device nodes of USB serial adapters.
const ADAPTERS: [&str; 2] = ["ttyUSB", "ttyACM"];

/// The environment variables that name displays and directories.
#[derive(Clone, Debug, Default)]
pub(in crate::doctor) struct Environment {
    pub display: Option<String>,
    pub wayland_display: Option<OsString>,
    pub runtime_dir: Option<PathBuf>,
}

impl Environment {
    /// Reads the variables of this process. An empty variable counts as not set.
    pub fn from_process() -> Self {
        let set = |name| std::env::var_os(name).filter(|value| !value.is_empty());
        Self {
            display: set("DISPLAY").map(|value| value.to_string_lossy().into_owned()),
            wayland_display: set("WAYLAND_DISPLAY"),
            runtime_dir: set("XDG_RUNTIME_DIR").map(PathBuf::from),
        }
    }
}

/// Inspects the machine.
pub(in crate::doctor) fn gather_facts(
    root: &Path,
    environment: &Environment,
    requirements: &Requirements,
) -> Facts {
    let machine = Machine::new(root);
    let runtime = runtime_dir(environment.runtime_dir.as_deref());
    Facts {
        user: machine.user(),
        ports: machine.ports(requirements),
        uinput: machine.uinput(),
        display: machine.display(environment.display.as_deref()),
        compositor: machine.compositor(environment),
        has_wayland: SUPPORTS_WAYLAND,
        granted_nice: priority::granted_nice(),
        watchdog_scope: machine.watchdog_scope(environment.runtime_dir.as_deref(), &runtime),
        runtime,
    }
}

/// Returns `true` if this process runs as root.
pub(in crate::doctor) fn is_running_as_root() -> bool {
    geteuid().is_root()
}

/// A machine below a root directory, and its groups.
struct Machine<'a> {
    root: &'a Path,
    /// Entries of `/etc/group`: name, id, members.
    groups: Vec<(String, u32, Vec<String>)>,
}

impl<'a> Machine<'a> {
    fn new(root: &'a Path) -> Self {
        let text = fs::read_to_string(root.join("etc/group")).unwrap_or_default();
        let group = |line: &str| {
            let mut parts = line.split(':');
            let (name, number) = (parts.next()?, parts.nth(1)?.parse().ok()?);
            let members = parts.next().unwrap_or("").split(',').map(str::to_owned);
            Some((name.to_owned(), number, members.collect()))
        };
        Self {
            root,
            groups: text.lines().filter_map(group).collect(),
        }
    }

    /// Returns an absolute path below the root directory.
    fn at(&self, path: impl AsRef<Path>) -> PathBuf {
        let path = path.as_ref();
        self.root.join(path.strip_prefix("/").unwrap_or(path))
    }

    fn user(&self) -> User {
        let id = geteuid().as_raw();
        let passwd = fs::read_to_string(self.at("/etc/passwd")).unwrap_or_default();
        let name = passwd.lines().find_map(|line| {
            let mut parts = line.split(':');
            let name = parts.next()?;
            (parts.nth(1)?.parse() == Ok(id)).then(|| name.to_owned())
        });
        User {
            name: name.unwrap_or_else(|| id.to_string()),
            is_root: is_running_as_root(),
            groups: own_groups()
                .into_iter()
                .map(|group| self.group_name(group))
                .collect(),
        }
    }

    fn group_name(&self, number: u32) -> String {
        let found = self.groups.iter().find(|(_, found, _)| *found == number);
        found.map_or_else(|| number.to_string(), |(name, ..)| name.clone())
    }

    fn ports(&self, requirements: &Requirements) -> Vec<(String, DeviceNode)> {
        let mut names = requirements.ports.clone();
        let entries = fs::read_dir(self.at("/dev")).into_iter().flatten();
        let mut adapters: Vec<_> = entries
            .flatten()
            .filter_map(|entry| entry.file_name().into_string().ok())
            .filter(|name| ADAPTERS.iter().any(|start| name.starts_with(start)))
            .map(|name| format!("/dev/{name}"))
            .collect();
        adapters.sort();
        names.extend(adapters);
        let mut seen = Vec::new();
        names.retain(|name| {
            let path = fs::canonicalize(self.at(name)).unwrap_or_else(|_| self.at(name));
            let is_new = !seen.contains(&path);
            seen.push(path);
            is_new
        });
        let node = |name: String| {
            let node = self.inspect_node(&self.at(&name));
            (name, node)
        };
        names.into_iter().map(node).collect()
    }

    /// Inspects a device node without opening it.
    fn inspect_node(&self, path: &Path) -> DeviceNode {
        match accessat(
            CWD,
            path,
            Access::READ_OK | Access::WRITE_OK,
            AtFlags::EACCESS,
        ) {
            Ok(()) => DeviceNode::Usable,
            Err(Errno::NOENT) => DeviceNode::Absent,
            Err(Errno::ACCESS | Errno::PERM) => DeviceNode::Denied(self.denied(path)),
            Err(error) => DeviceNode::Error(std::io::Error::from(error).to_string()),
        }
    }

    /// Returns the reason why the user may not open a file.
    fn denied(&self, path: &Path) -> AccessDenied {
        let Ok(metadata) = fs::metadata(path) else {
            return AccessDenied::Unknown;
        };
        let is_open_to_group = metadata.mode() & 0o060 == 0o060;
        if !is_open_to_group || metadata.gid() == 0 || own_groups().contains(&metadata.gid()) {
            return AccessDenied::OwnerOnly;
        }
        let group = self.group_name(metadata.gid());
        let user = self.user().name;
        let is_member = |(name, _, members): &(String, u32, Vec<String>)| {
            *name == group && members.contains(&user)
        };
        if self.groups.iter().any(is_member) {
            AccessDenied::LoginRequired(group)
        } else {
            AccessDenied::NotInGroup(group)
        }
    }

    fn uinput(&self) -> UinputFacts {
        let path = self.at("/dev/uinput");
        // Opening the node creates no device, and fails if no driver is behind it.
        let mut options = OpenOptions::new();
        let options = options
            .write(true)
            .custom_flags(OFlags::NONBLOCK.bits() as i32);
        let node = match options.open(&path) {
            Ok(_) => DeviceNode::Usable,
            Err(error) if is_missing(&error) => DeviceNode::Absent,
            Err(error) if error.kind() == ErrorKind::PermissionDenied => {
                DeviceNode::Denied(self.denied(&path))
            }
            Err(error) => DeviceNode::Error(error.to_string()),
        };
        UinputFacts {
            node,
            is_loaded: self.at("/sys/class/misc/uinput").exists(),
            can_be_loaded: self.has_uinput_module(),
        }
    }

    /// Returns `true` if the running kernel has the module `uinput`; `None` if its files are not visible.
    fn has_uinput_module(&self) -> Option<bool> {
        let release = fs::read_to_string(self.at("/proc/sys/kernel/osrelease")).ok()?;
        let dir = self.at("/lib/modules").join(release.trim_end());
        let list = |file: &str| fs::read_to_string(dir.join(file)).ok();
        let loadable = list("modules.dep")?;
        let built_in = list("modules.builtin").unwrap_or_default();
        Some(loadable.contains("/uinput.ko") || built_in.contains("/uinput.ko"))
    }

    fn display(&self, name: Option<&str>) -> XDisplay {
        let Some(name) = name else {
            return XDisplay::Unset;
        };
        let (host, screen) = name.rsplit_once(':').unwrap_or((name, ""));
        if !matches!(host, "" | "unix") {
            return XDisplay::Unknown(format!("`{}` is on the network", escape(name)));
        }
        let number = screen.split('.').next().unwrap_or_default();
        let path = self.at(format!("/tmp/.X11-unix/X{number}"));
        let Ok(display) = number.parse::<u16>() else {
            return XDisplay::Unreachable(name.to_owned());
        };
        let machine = fs::read(self.at("/proc/sys/kernel/hostname")).unwrap_or_default();
        match x11::refusal(&path, machine.trim_ascii_end(), display) {
            Ok(None) => XDisplay::Reachable(name.to_owned()),
            Ok(Some(reason)) => XDisplay::Refused(reason),
            Err(_) => XDisplay::Unreachable(name.to_owned()),
        }
    }

    fn compositor(&self, environment: &Environment) -> Compositor {
        let Some(name) = &environment.wayland_display else {
            return Compositor::Unset;
        };
        let dir = environment.runtime_dir.as_deref();
        let socket = dir.unwrap_or(Path::new("/")).join(name);
        match wayland::globals(&socket) {
            Ok((process, globals)) => Compositor::Reachable {
                program: process.and_then(|process| self.program(process)),
                globals,
            },
            Err(error) => Compositor::Unreachable {
                socket,
                reason: error.to_string(),
            },
        }
    }

    fn watchdog_scope(&self, folder: Option<&Path>, runtime: &RuntimeDir) -> WatchdogScope {
        if let RuntimeDir::Present { run: Some(run), .. } = runtime
            && let Some(watchdog) = run.process.and_then(|process| self.watchdog(process))
        {
            let groups = fs::read_to_string(self.at(format!("/proc/{watchdog}/cgroup")));
            let scope = format!("/{}", scope_name(watchdog));
            let is_separate =
                groups.is_ok_and(|text| text.lines().any(|line| line.ends_with(&scope)));
            return if is_separate {
                WatchdogScope::Separate
            } else {
                WatchdogScope::Shared
            };
        }
        let listens =
            |name| folder.is_some_and(|folder| socket::connect(&folder.join(name)).is_ok());
        if ["systemd/private", "bus"].into_iter().all(listens) {
            WatchdogScope::Available
        } else {
            WatchdogScope::Unavailable
        }
    }

    /// Returns the process id of the watchdog that a run has started.
    fn watchdog(&self, run: i32) -> Option<u32> {
        let threads = fs::read_dir(self.at(format!("/proc/{run}/task"))).ok()?;
        let children =
            |thread: fs::DirEntry| fs::read_to_string(thread.path().join("children")).ok();
        let lists: String = threads.flatten().filter_map(children).collect();
        let is_watchdog = |process: &u32| {
            let arguments =
                fs::read(self.at(format!("/proc/{process}/cmdline"))).unwrap_or_default();
            arguments.split(|byte| *byte == 0).nth(1) == Some(b"watchdog")
        };
        lists
            .split_whitespace()
            .filter_map(|id| id.parse().ok())
            .find(is_watchdog)
    }

    fn program(&self, process: i32) -> Option<String> {
        let name = fs::read_to_string(self.at(format!("/proc/{process}/comm"))).ok()?;
        Some(name.trim_end().to_owned())
    }
}

/// Returns the group ids of this process.
fn own_groups() -> Vec<u32> {
    let mut groups = vec![getegid().as_raw()];
    groups.extend(
        getgroups()
            .into_iter()
            .flatten()
            .map(|group| group.as_raw()),
    );
    groups.sort_unstable();
    groups.dedup();
    groups
}

fn runtime_dir(dir: Option<&Path>) -> RuntimeDir {
    let Some(dir) = dir.filter(|dir| dir.is_absolute() && dir.is_dir()) else {
        return RuntimeDir::Absent;
    };
    let socket = dir.join("ademan").join("control.sock");
    let run = match socket::connect(&socket) {
        Ok(stream) => Some(RunningInstance {
            process: wayland::peer_process(&stream),
        }),
        // A process that accepts no connection within 1 s, or one of another user.
        Err(error) => {
            let is_in_use = matches!(
                error.kind(),
                ErrorKind::TimedOut | ErrorKind::PermissionDenied
            );
            is_in_use.then(RunningInstance::default)
        }
    };
    RuntimeDir::Present { socket, run }
}
