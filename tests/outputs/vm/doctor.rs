//! The doctor on a machine with everything, and for an ordinary user on one where the module is not loaded and
//! no device is for him: what he is told to do is done to the letter.

use super::Scene;

/// As whoever logs in now: with the groups that the user has by then.
const LOGGED_IN: &str = "/usr/bin/setpriv --reuid=1000 --regid=1000 --init-groups";

/// As whoever logged in before he joined any group.
const LOGGED_IN_BEFORE: &str = "/usr/bin/setpriv --reuid=1000 --regid=1000 --clear-groups";

/// What is asked of the doctor.
const QUESTION: &str =
    "ademan doctor --source serial:$(ls /dev/ttyUSB* | head -n 1) --output uinput --test uinput";

/// Takes the commands from what the doctor says: all after the table that is no comment.
const COMMANDS: &str = "sed '1,/^$/d; /^#/d; /^$/d' /tmp/said >/tmp/commands";

/// Examines a machine on which no program runs.
pub fn all(scene: &mut Scene) {
    let (is_well, _) = ask(scene, "");
    assert!(is_well, "on a machine with everything");
    scene.report("the doctor finds nothing missing");
    take_everything_away(scene);

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
    let (is_well, said) = ask(scene, LOGGED_IN_BEFORE);
    let part = "you joined its group `uinput` after you logged in";
    assert!(!is_well && said.contains(part), "{said}");
    let (is_well, said) = ask(scene, LOGGED_IN);
    assert!(is_well, "{said}");
    scene.report(
        "an ordinary user who does what the doctor says can make devices and open the port",
    );
}

/// There is an ordinary user; the module is out, and is where `modprobe` looks for it.
fn take_everything_away(scene: &mut Scene) {
    let done = scene.machine.run(
        "rmmod uinput && echo 'ada:x:1000:1000::/tmp:/bin/sh' >>/etc/passwd && echo 'ada:x:1000:' >>/etc/group && \
         mkdir -p /lib/modules/$(uname -r)/kernel /etc/udev/rules.d /etc/modules-load.d && \
         mv /lib/modules/uinput.ko /lib/modules/$(uname -r)/kernel && depmod && \
         chown 1000:1000 /tmp/runtime && echo done",
    );
    assert_eq!(done, "done\n");
}

/// Asks the doctor as somebody; whether all is well, and what he says.
fn ask(scene: &mut Scene, who: &str) -> (bool, String) {
    let said = scene.machine.run(&format!(
        "export XDG_RUNTIME_DIR=/tmp/runtime; mkdir -m 700 -p $XDG_RUNTIME_DIR; \
         {who} {QUESTION} >/tmp/said 2>/tmp/error; code=$?; cat /tmp/said /tmp/error; echo exit $code"
    ));
    println!("{said}");
    (said.trim_end().ends_with("exit 0"), said)
}

/// Asks as whoever logs in now, and does what he is told to, line by line. Whoever owns the machine does it: `sudo`
/// is there for the name.
fn follow(scene: &mut Scene) -> String {
    let (is_well, said) = ask(scene, LOGGED_IN);
    assert!(!is_well, "there is something to do: {said}");
    let done = scene.machine.run(&format!(
        "{COMMANDS}; USER=ada sh -ex /tmp/commands 2>&1; echo exit $?"
    ));
    println!("{done}");
    assert!(done.trim_end().ends_with("exit 0"), "{done}");
    said
}
