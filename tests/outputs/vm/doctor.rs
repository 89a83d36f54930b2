//! `ademan doctor` on a machine with full access, and for an ordinary user on one without the kernel module and without
//! access to devices, whose advice the test follows.

use super::Scene;

/// Runs a command as a user who logs in now, with all current groups.
const LOGGED_IN: &str = "/usr/bin/setpriv --reuid=1000 --regid=1000 --init-groups";

/// Runs a command as a user who logged in before joining any group.
const LOGGED_IN_BEFORE: &str = "/usr/bin/setpriv --reuid=1000 --regid=1000 --clear-groups";

/// The command.
const DOCTOR: &str =
    "ademan doctor --source serial:$(ls /dev/ttyUSB* | head -n 1) --output uinput --test uinput";

/// Extracts the commands from the output: all lines after the table that are no comments.
const COMMANDS: &str = "sed '1,/^$/d; /^#/d; /^$/d' /tmp/said >/tmp/commands";

/// Runs all checks on a machine on which no `ademan` runs.
pub fn all(scene: &mut Scene) {
    let (succeeds, _) = examine(scene, "");
    assert!(succeeds, "with full access");
    scene.report("the doctor finds nothing missing");
    remove_access(scene);

    let first = follow(scene);
    for part in [
        "/dev/uinput does not exist: the kernel module `uinput` is not loaded",
        "sudo modprobe uinput",
        "which belongs to the group `dialout`",
        "sudo usermod --append --groups dialout $USER",
    ] {
        assert!(first.contains(part), "{part}: {first}");
    }
    let second = follow(scene);
    for part in [
        "no permission to open /dev/uinput; give it to a group of its own",
        "sudo udevadm control --reload && sudo udevadm trigger",
    ] {
        assert!(second.contains(part), "{part}: {second}");
    }
    scene.machine.run("udevadm settle --timeout=30");
    let (succeeds_early, early_output) = examine(scene, LOGGED_IN_BEFORE);
    let part = "you joined its group `uinput` after you logged in";
    assert!(
        !succeeds_early && early_output.contains(part),
        "{early_output}"
    );
    let (succeeds_late, late_output) = examine(scene, LOGGED_IN);
    assert!(succeeds_late, "{late_output}");
    scene.report("an ordinary user who follows the advice can create devices and open the port");
}

/// Adds an ordinary user, unloads the module, and moves it to where `modprobe` finds it.
fn remove_access(scene: &mut Scene) {
    let done = scene.machine.run(
        "rmmod uinput && echo 'ada:x:1000:1000::/tmp:/bin/sh' >>/etc/passwd && echo 'ada:x:1000:' >>/etc/group && \
         mkdir -p /lib/modules/$(uname -r)/kernel /etc/udev/rules.d /etc/modules-load.d /etc/security/limits.d && \
         mv /lib/modules/uinput.ko /lib/modules/$(uname -r)/kernel && depmod && \
         chown 1000:1000 /tmp/runtime && echo done",
    );
    assert_eq!(done, "done\n");
}

/// Runs the doctor as a user. Returns whether it succeeds, and its output.
fn examine(scene: &mut Scene, who: &str) -> (bool, String) {
    let output = scene.machine.run(&format!(
        "export XDG_RUNTIME_DIR=/tmp/runtime; mkdir -m 700 -p $XDG_RUNTIME_DIR; \
         {who} {DOCTOR} >/tmp/said 2>/tmp/error; code=$?; cat /tmp/said /tmp/error; echo exit $code"
    ));
    println!("{output}");
    (output.trim_end().ends_with("exit 0"), output)
}

/// Runs the doctor as a user who logs in now, and executes its commands. They run as root; `sudo` is a stand-in.
fn follow(scene: &mut Scene) -> String {
    let (succeeds, output) = examine(scene, LOGGED_IN);
    assert!(!succeeds, "something is missing: {output}");
    let done = scene.machine.run(&format!(
        "{COMMANDS}; USER=ada sh -ex /tmp/commands 2>&1; echo exit $?"
    ));
    println!("{done}");
    assert!(done.trim_end().ends_with("exit 0"), "{done}");
    output
}
