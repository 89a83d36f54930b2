//! `ademan serve --lan`: the page for a headset on the network, and a session with its hands.

use std::io::{self, IsTerminal, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, UdpSocket};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use ademan::capture::transport::written_path;
use ademan::message::{escape, shell_word};
use ademan::network::check_listen_address;
use ademan::session::control_socket::Client;
use clap::{Command, FromArgMatches};

use super::SessionArgs;
use crate::failure::Failure;
use crate::root_args::RootArgs;
use crate::{ctl, headset_link, link, run, signal_mask};

/// The port without `--port`.
const PORT: u16 = 8443;

/// The word by which the person at the computer lets the headset press keys.
const CONSENT: &str = "allow";

/// Time between reads of a terminal that belongs to another program.
const BACKGROUND_PERIOD: Duration = Duration::from_secs(1);

/// Serves the page, and runs a session with the hands of the headset.
pub fn run(
    address: &str,
    port: Option<u16>,
    folder: &Path,
    session: &SessionArgs,
) -> Result<(), Failure> {
    let address = listen_address(address, port.unwrap_or(PORT))?;
    let allow_root = session.allow_root;
    // Before a token is created and its link is shown.
    RootArgs { allow_root }.check(true)?;
    let layout = link::trusted(session.layout.clone(), session.trust)?;
    let source = page_source(address, &folder.to_string_lossy(), &layout);
    show(&headset_link::link(&address.to_string())?);
    ask_for_consent(session.control.clone());
    run::run(run_args(&source, &layout, session)?)
}

/// Returns the source that serves the page of a folder, which shows this layout.
fn page_source(address: SocketAddr, folder: &str, layout: &str) -> String {
    let [page, shown] = [folder, layout].map(written_path);
    format!("headset:{address}?page={page}&layout={shown}")
}

/// Returns the arguments of `ademan run`.
fn run_args(source: &str, layout: &str, session: &SessionArgs) -> Result<run::Args, Failure> {
    let mut list: Vec<String> = ["run", "--source", source, "--layout", layout]
        .map(str::to_owned)
        .to_vec();
    list.extend(["--output", &session.output, "--view", &session.view].map(str::to_owned));
    if let Some(control) = &session.control {
        list.extend([
            "--control".to_owned(),
            control.to_string_lossy().into_owned(),
        ]);
    }
    if session.allow_root {
        list.push("--allow-root".to_owned());
    }
    let command = <run::Args as clap::Args>::augment_args(Command::new("ademan serve --lan"));
    let matches = command.try_get_matches_from(list);
    let args = matches.and_then(|matches| run::Args::from_arg_matches(&matches));
    args.map_err(|error| Failure::wrong_use(error.to_string()))
}

/// Returns the address at which the page is served: the given one, or the address in the network with the default route.
fn listen_address(given: &str, port: u16) -> Result<SocketAddr, Failure> {
    let ip = match given {
        "" => network_address().ok_or_else(|| {
            Failure::wrong_use("this machine has no network, or several; name its address, which `ip address` shows: `--lan 192.168.1.7`")
        })?,
        given => given.parse().map_err(|_| {
            Failure::wrong_use(format!(
                "`{}` is not an address; write an address of this machine, which `ip address` shows: `--lan 192.168.1.7`",
                escape(given)
            ))
        })?,
    };
    let mut address = SocketAddr::new(ip, port);
    check_listen_address(address, true).map_err(Failure::wrong_use)?;
    if port == 0 {
        let free = TcpListener::bind(address).and_then(|listener| listener.local_addr());
        address = free.map_err(|error| {
            Failure::job(format!(
                "cannot listen on {ip}: {error}; name an address of this machine"
            ))
        })?;
    }
    Ok(address)
}

/// Returns the address that packets to other networks would have. None is sent.
fn network_address() -> Option<IpAddr> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
    // An address for documentation (RFC 5737).
    socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9)).ok()?;
    let ip = socket.local_addr().ok()?.ip();
    (!ip.is_unspecified() && !ip.is_loopback()).then_some(ip)
}

/// Shows the link on the standard output only: it contains the token, which must not remain in a log file.
fn show(link: &str) {
    let mut out = io::stdout().lock();
    let picture = headset_link::blocks(link)
        .filter(|_| out.is_terminal())
        .unwrap_or_default();
    let written = write!(
        out,
        "{picture}Open this link in the browser of the headset. It is a password: anyone who has it can move your pointer.\n{link}\n\
         The browser warns about the certificate, because this machine created it; accept the warning once.\n"
    );
    // A closed terminal ends the session by a signal.
    let _ = written.and_then(|()| out.flush());
}

/// Asks the person at the terminal to allow keys. A thread waits for the answer.
fn ask_for_consent(control: Option<PathBuf>) {
    let is_asked = io::stdin().is_terminal();
    say!(
        "the headset only points{}",
        remedy(control.as_deref(), is_asked)
    );
    if !is_asked || is_off(control.as_deref()) {
        return;
    }
    let listen = move || {
        if signal_mask::block_background_reads().is_err() {
            return;
        }
        let mut line = String::new();
        loop {
            line.clear();
            match io::stdin().read_line(&mut line) {
                Ok(0) => return,
                Ok(_) if line.trim() == CONSENT => consent(control.clone()),
                Ok(_) => {}
                // The program may return from the background.
                Err(_) => thread::sleep(BACKGROUND_PERIOD),
            }
        }
    };
    let _ = thread::Builder::new().name("consent".into()).spawn(listen);
}

/// Allows the headset to press keys, and reports the outcome.
fn consent(control: Option<PathBuf>) {
    match allow_keys(control) {
        Ok(()) => say!("the headset may press keys; `ademan ctl forbid-keys` revokes this"),
        Err(reason) => complain!("the headset may not press keys: {}", escape(&reason)),
    }
}

/// Returns the end of the message that the headset only points: how to let it press keys.
fn remedy(control: Option<&Path>, is_asked: bool) -> String {
    if is_off(control) {
        return ", as no command reaches the session; leave out `--control off` to let it press keys"
            .to_owned();
    }
    let socket = control.map_or(String::new(), |path| {
        format!("--socket {} ", shell_word(&path.to_string_lossy()))
    });
    let command = format!("`ademan ctl {socket}allow-keys`");
    if is_asked {
        format!("; type `{CONSENT}` and Enter to let it press keys, or {command}")
    } else {
        format!("; {command} lets it press keys")
    }
}

/// Returns `true` if the session has no control socket.
fn is_off(control: Option<&Path>) -> bool {
    control == Some(Path::new("off"))
}

fn allow_keys(control: Option<PathBuf>) -> Result<(), String> {
    let path = ctl::socket_path(control).map_err(|failure| failure.to_string())?;
    let mut client = Client::connect(&path).map_err(|error| error.to_string())?;
    let executed = client.execute(&ademan::command::Command::AllowKeys);
    executed.map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_and_the_layout_of_the_source_have_any_name() {
        let address = SocketAddr::from(([127, 0, 0, 1], 8443));
        assert_eq!(
            page_source(address, "/a%26b/web", "x&y.ron"),
            "headset:127.0.0.1:8443?page=/a%2526b/web&layout=x%26y.ron"
        );
    }

    #[test]
    fn the_way_to_press_keys_is_one_that_the_control_socket_permits() {
        let words = |control: Option<&str>| remedy(control.map(Path::new), true);
        assert!(words(None).ends_with("or `ademan ctl allow-keys`"));
        let named = words(Some("/tmp/sofa.sock"));
        assert!(named.ends_with("`ademan ctl --socket /tmp/sofa.sock allow-keys`"));
        let off = words(Some("off"));
        assert!(off.contains("leave out `--control off`"), "{off}");
        assert!(!off.contains(CONSENT), "{off}");
    }
}
