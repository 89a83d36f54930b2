//! Hands shared beyond this machine: TLS, tokens and roles, with `openssl` as a peer that others wrote.

use std::fs::{self, Permissions};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{IpAddr, TcpListener, UdpSocket};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use tempfile::TempDir;

use crate::share::is_part_of;
use crate::support::process::{Process, signal};
use crate::support::run::{TIMEOUT, line_receiver};
use crate::text_line::pressed_keys;
use crate::{Ended, run_to_end};

/// The settings of one machine.
struct Machine(TempDir);

impl Machine {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn ademan(&self, arguments: &[&str]) -> Command {
        let mut command = crate::ademan(arguments);
        command.env("XDG_CONFIG_HOME", self.0.path());
        command
    }

    fn run(&self, arguments: &[&str]) -> Ended {
        run_to_end(&mut self.ademan(arguments))
    }

    fn network(&self) -> PathBuf {
        self.0.path().join("ademan/network")
    }

    /// Makes a token and returns its file.
    fn token(&self, name: &str, role: &str) -> PathBuf {
        self.run(&["token", "new", name, "--role", role]).done();
        self.network().join(format!("{name}.token"))
    }

    /// Starts a hand that types and shares. Returns it, its messages and its port.
    fn share(&self, text: &str, target: &str) -> Shared {
        let source = format!("typist:{text}");
        let run = ["run", "--control", "off", "--output", "none"];
        let mut command = self.ademan(&run);
        command.args(["--source", &source, "--share", target]);
        command.stderr(Stdio::piped());
        let mut process = Process::start(&mut command).expect("the program starts");
        let mut messages = BufReader::new(process.0.stderr.take().expect("it is piped"));
        let mut printed = String::new();
        let shared_target = loop {
            let start = printed.len();
            let length = messages.read_line(&mut printed).expect("UTF-8");
            assert!(length > 0, "{printed}");
            let shared = printed[start..].strip_prefix("sharing ");
            if let Some((named, _)) = shared.and_then(|line| line.split_once(": ")) {
                break named.to_owned();
            }
        };
        let (_, address) = shared_target.split_once(':').expect("a format");
        Shared {
            process,
            address: address.into(),
        }
    }
}

struct Shared {
    process: Process,
    address: String,
}

/// Returns the value of a line of a token file.
fn value(token_file: &Path, key: &str) -> String {
    let text = fs::read_to_string(token_file).expect("a token file");
    let line = text.lines().find_map(|line| line.strip_prefix(key));
    line.expect("the line").trim().to_owned()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Returns an address of this machine that others can connect to, or the loopback address if it has none.
fn own_address() -> IpAddr {
    // Nothing is sent: the system only chooses the address that it would send from.
    let chosen = UdpSocket::bind("0.0.0.0:0").and_then(|socket| {
        socket.connect("192.0.2.200:9")?;
        socket.local_addr()
    });
    match chosen {
        Ok(address) => address.ip(),
        Err(_) => {
            println!("this machine has no network, so the loopback address stands for one");
            IpAddr::from([127, 0, 0, 1])
        }
    }
}

/// Runs `openssl s_client` with this input. `None` if it is not installed.
fn s_client(address: &str, options: &[&str], input: &str) -> Option<Process> {
    let mut command = Command::new("openssl");
    command
        .args(["s_client", "-quiet", "-connect", address])
        .args(options);
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let Ok(mut process) = Process::start(&mut command) else {
        println!("SKIPPED: openssl is not installed");
        return None;
    };
    let stdin = process.0.stdin.as_mut().expect("it is piped");
    let _ = stdin.write_all(input.as_bytes());
    Some(process)
}

/// Returns the first lines that a process writes.
fn lines(process: &mut Process, count: usize) -> Vec<String> {
    let stdout = process.0.stdout.take().expect("it is piped");
    let lines = BufReader::new(stdout).lines().map_while(Result::ok);
    lines.take(count).collect()
}

#[test]
fn a_hand_of_one_machine_types_on_another_with_the_role_of_its_token_and_no_token_is_printed() {
    let (capture, desk) = (Machine::new(), Machine::new());
    let token_file = capture.token("desk", "type");
    let secret = value(&token_file, "secret");
    let typed_text = "hola hola hola hola hola";
    let target = format!("text-line+tls:{}:0", own_address());
    let mut shared = capture.share(typed_text, &target);
    fs::create_dir_all(desk.network()).expect("a folder");
    fs::rename(&token_file, desk.network().join("desk.token")).expect("the same disk");
    // Connects and reads nothing: neither the hand nor the other client waits for it.
    let stopped = s_client(&shared.address, &[], &format!("token {secret}\n"));
    if let Some(stopped) = &stopped {
        signal("STOP", stopped.0.id());
    }
    let source = format!(
        "tcp+tls:{}?protocol=text-line&token_file=desk.token",
        shared.address
    );
    let recording = desk.0.path().join("typed.mcap");
    let mut command = desk.ademan(&["run", "--control", "off", "--armed", "-vv"]);
    command
        .arg("--record")
        .arg(&recording)
        .args(["--source", &source]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut second = Process::start(&mut command).expect("the program starts");
    let arguments = fs::read(format!("/proc/{}/cmdline", second.0.id())).expect("it runs");
    assert!(shared.process.0.wait().expect("a child process").success());
    let messages = line_receiver(second.0.stderr.take().expect("it is piped"));
    let mut printed = String::new();
    // What was shared last is typed before the end of the connection is noticed.
    while !printed.contains("lost ") {
        let Ok(line) = messages.recv_timeout(TIMEOUT) else {
            panic!("the connection is not lost: {printed}");
        };
        printed.extend([line.as_str(), "\n"]);
    }
    let has_stalled = printed.contains("stalled:");
    signal("TERM", second.0.id());
    let mut transcript = String::new();
    let mut stdout = second.0.stdout.take().expect("it is piped");
    stdout.read_to_string(&mut transcript).expect("UTF-8");
    for line in messages {
        printed.extend([line.as_str(), "\n"]);
    }
    let typed = pressed_keys(&transcript).concat().replace("Space", " ");
    assert!(typed.len() >= 5, "{typed}\n{printed}");
    let shared_text = typed_text.to_uppercase();
    // A busy machine may cause a stall, in which keys are lost.
    let is_shared = if has_stalled {
        is_part_of(&typed, &shared_text)
    } else {
        shared_text.ends_with(&typed)
    };
    assert!(is_shared, "{typed}\n{printed}");
    let recorded = fs::read(&recording).expect("a recording");
    let bytes = [
        arguments,
        recorded,
        printed.into_bytes(),
        transcript.into_bytes(),
    ]
    .concat();
    assert!(!text(&bytes).contains(&secret[..8]), "the token is printed");
}

#[test]
fn a_client_with_a_token_asks_for_kinds_of_json() {
    let machine = Machine::new();
    let secret = value(&machine.token("screen", "see"), "secret");
    let long = "hola ".repeat(60);
    let shared = machine.share(&long, &format!("json+tls:{}:0", own_address()));
    let request = format!("token {secret}\n{{\"kinds\":[\"angles\"],\"rate_hz\":20}}\n");
    let Some(mut client) = s_client(&shared.address, &["-tls1_3"], &request) else {
        return;
    };
    let received = lines(&mut client, 4);
    assert_eq!(received[0], "ok");
    assert!(
        received[1..]
            .iter()
            .all(|line| line.contains("\"kind\":\"angles\""))
    );
}

#[test]
fn openssl_receives_lines_with_a_token_and_nothing_without_one() {
    let machine = Machine::new();
    let token_file = machine.token("screen", "see");
    let secret = value(&token_file, "secret");
    let long = "hola ".repeat(60);
    let shared = machine.share(&long, &format!("pose+tls:{}:0", own_address()));
    let hello = format!("token {secret}\n");
    let Some(mut client) = s_client(&shared.address, &["-tls1_3"], &hello) else {
        return;
    };
    let received = lines(&mut client, 3);
    assert_eq!(received[0], "ok");
    let line: serde_json::Value = serde_json::from_str(&received[1]).expect("JSON");
    assert!(line["positions"].is_object(), "{line}");

    let wrong = format!("token {}\n", "0".repeat(64));
    let request = format!(
        "GET / HTTP/1.1\r\nHost: {}\r\nOrigin: https://attacker.example\r\n\r\n",
        shared.address
    );
    for refused in [&wrong, &request] {
        let mut refused_client = s_client(&shared.address, &["-tls1_3"], refused).expect("openssl");
        assert_eq!(lines(&mut refused_client, 2), ["refused"], "{refused}");
    }
    let mut old = s_client(&shared.address, &["-tls1_2"], &hello).expect("openssl");
    assert_eq!(lines(&mut old, 1), [""; 0], "only TLS 1.3");
    // Says nothing, and is closed.
    let mut silent = s_client(&shared.address, &["-tls1_3"], "").expect("openssl");
    assert_eq!(lines(&mut silent, 1), [""; 0]);

    let certificate = machine.network().join("certificate.pem");
    let mut command = Command::new("openssl");
    command
        .args(["x509", "-noout", "-fingerprint", "-sha256", "-in"])
        .arg(&certificate);
    let printed = text(&command.output().expect("openssl").stdout);
    let (_, printed) = printed.trim().split_once('=').expect("a fingerprint");
    let fingerprint = printed.replace(':', "").to_lowercase();
    assert_eq!(fingerprint, value(&token_file, "server"));
}

#[test]
fn servers_without_tls_a_token_or_an_address_of_one_network_do_not_start() {
    let machine = Machine::new();
    let own = own_address();
    let refused = |target: &str, remedy: &str| {
        println!("{target}");
        let run = ["run", "--source", "typist:a", "--share", target];
        machine.run(&run).exited(2).reported(remedy);
    };
    if !own.is_loopback() {
        refused(&format!("pose:{own}:0"), "`+tls`");
    }
    refused("pose+tls:0.0.0.0:0", "name the address of one");
    refused("pose+tls:[::ffff:0.0.0.0]:0", "name the address of one");
    refused(
        &format!("pose+tls:{own}:0"),
        "ademan token new NAME --role see",
    );
    machine.token("screen", "see");
    let tokens = machine.network().join("tokens");
    fs::set_permissions(&tokens, Permissions::from_mode(0o644)).expect("an own file");
    refused(&format!("pose+tls:{own}:0"), "chmod 600");
}

#[test]
fn a_source_has_no_more_than_the_role_of_its_token() {
    let machine = Machine::new();
    let see = machine.token("screen", "see");
    let point = machine.token("mouse", "point");
    let source = |file: &Path| {
        format!(
            "tcp+tls:127.0.0.1:1?protocol=text-line&token_file={}",
            file.display()
        )
    };
    let run = |file: &Path| machine.run(&["run", "--control", "off", "--source", &source(file)]);
    run(&see).reported("has the role `see`");
    run(&point).reported("cannot open tcp+tls:127.0.0.1:1");
    run(Path::new("nope.token")).reported("copy it from the machine");
    fs::set_permissions(&point, Permissions::from_mode(0o640)).expect("an own file");
    run(&point).reported("chmod 600");
    let secret = value(&see, "secret");
    run(Path::new(&secret)).reported("revoke it");
}

#[test]
fn doctor_states_the_role_of_the_token_of_a_source_and_finds_one_that_a_run_refuses() {
    let machine = Machine::new();
    let server = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = server.local_addr().expect("it is bound");
    let check = |file: &Path, role: &str| {
        let source = format!(
            "tcp+tls:{address}?protocol=text-line&token_file={}",
            file.display()
        );
        let mut arguments = vec!["doctor", "--source", &source];
        arguments.extend(role.split_whitespace());
        let ended = machine.run(&arguments);
        let words: Vec<&str> = ended.out.split_whitespace().collect();
        (ended.code == Some(0), words.join(" "))
    };
    let see = machine.token("screen", "see");
    let point = machine.token("mouse", "point");
    let typing = machine.token("desk", "type");
    for (file, role, points) in [
        (&point, "", true),
        (&typing, "", false),
        (&typing, "--role pointer", true),
        (&see, "--role pointer", true),
    ] {
        let (is_ok, printed) = check(file, role);
        assert!(is_ok, "{printed}");
        assert_eq!(printed.contains("only a pointer"), points, "{printed}");
    }
    for (file, reason) in [
        (&*see, "has the role `see`"),
        (Path::new("nope.token"), "there is no token file"),
    ] {
        let (is_ok, printed) = check(file, "");
        assert!(!is_ok, "{printed}");
        assert!(printed.contains(reason), "{reason}: {printed}");
    }
}

#[test]
fn tokens_are_listed_without_their_secrets_and_revoked() {
    let machine = Machine::new();
    let secret = value(&machine.token("desk", "type"), "secret");
    machine.token("screen", "see");
    let listed = machine.run(&["token", "list"]).out;
    assert!(
        listed.contains("desk") && listed.contains("type"),
        "{listed}"
    );
    assert!(!listed.contains(&secret[..8]), "{listed}");
    machine.run(&["token", "revoke", "desk"]).done();
    let rest = machine.run(&["token", "list"]).out;
    assert_eq!(rest.lines().count(), 1, "{rest}");
    let again = machine.run(&["token", "revoke", "desk"]).exited(2);
    again.reported("ademan token list");
}

#[test]
fn tokens_that_are_revoked_beside_commands_that_make_others_stay_revoked() {
    let machine = Machine::new();
    machine.token("screen", "see");
    for round in 0..8 {
        let old = format!("old{round}");
        machine.token(&old, "see");
        let start = |arguments: &[&str]| {
            let mut command = machine.ademan(arguments);
            command.stdout(Stdio::null()).stderr(Stdio::null());
            Process::start(&mut command).expect("the program starts")
        };
        let new = [0, 1, 2].map(|index| format!("new{round}-{index}"));
        let mut commands: Vec<_> = new
            .iter()
            .map(|name| start(&["token", "new", name, "--role", "see"]))
            .collect();
        commands.push(start(&["token", "revoke", &old]));
        for mut command in commands {
            assert!(command.0.wait().expect("a child").success());
        }
        let listed = machine.run(&["token", "list"]).out;
        assert!(!listed.contains(&old), "{listed}");
        for name in &new {
            assert!(listed.contains(name), "{name}: {listed}");
        }
    }
}

#[test]
fn a_token_command_that_is_killed_leaves_nothing_that_stops_the_next_one() {
    let machine = Machine::new();
    for delay_us in (0..6000_u64).step_by(300) {
        let mut command = machine.ademan(&["token", "new", "desk", "--role", "see"]);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        let process = Process::start(&mut command).expect("the program starts");
        std::thread::sleep(Duration::from_micros(delay_us));
        // It is killed with SIGKILL, wherever it is.
        drop(process);
        // Either it was made, or it can be made.
        let revoke = ["token", "revoke", "desk"];
        if machine.run(&revoke).code != Some(0) {
            machine.token("desk", "see");
            machine.run(&revoke).done();
        }
    }
    let listed = machine.run(&["token", "list"]);
    assert_eq!(listed.out, "");
    listed.reported("no tokens yet; `ademan token new");
}

/// Runs on a disk that only the commands see, and fills it.
const ON_A_FULL_DISK: &str = r#"
mount -t tmpfs -o size=64k,mode=700 none "$XDG_CONFIG_HOME" || exit 77
"$0" token new desk --role see >/dev/null || exit 1
"$0" token new screen --role see >/dev/null || exit 1
folder="$XDG_CONFIG_HOME/ademan/network"
rm "$folder"/*.token
head -c 100000 /dev/zero >"$XDG_CONFIG_HOME/filler" 2>/dev/null
for round in 1 2; do
    "$0" token revoke desk && { echo "revoked on a full disk"; "$0" token list; exit 0; }
    "$0" token new more --role see && exit 2
done
echo full
"$0" token list
rm "$XDG_CONFIG_HOME/filler"
"$0" token revoke desk || exit 3
"$0" token new more --role see >/dev/null || exit 4
echo room
"$0" token list
"#;

#[test]
fn on_a_full_disk_a_token_is_not_said_to_be_revoked_and_is_revoked_once_there_is_room() {
    let machine = Machine::new();
    let program = machine.ademan(&[]);
    let mut command = Command::new("unshare");
    command
        .args(["--mount", "sh", "-c", ON_A_FULL_DISK])
        .arg(program.get_program())
        .env("XDG_CONFIG_HOME", machine.0.path());
    let ended = match command.output() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            println!("SKIPPED: no file system of its own: {error}");
            return;
        }
        output => Ended::from(output.expect("the program starts")),
    };
    if ended.code == Some(77) || ended.err.starts_with("unshare:") {
        println!("SKIPPED: no file system of its own: {}", ended.err);
        return;
    }
    let ended = ended.done();
    let (full, room) = ended.out.split_once("room\n").expect(&ended.err);
    assert!(full.starts_with("full\ndesk "), "{}", ended.out);
    ended.reported("No space left");
    ended.reported("`desk` is still valid");
    assert!(!room.contains("desk ") && room.contains("more "), "{room}");
}
