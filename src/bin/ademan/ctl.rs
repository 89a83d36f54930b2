//! `ademan ctl`: sends a command to a running session.

use std::io::{self, Write};
use std::path::PathBuf;

use ademan::capture::HeadsetStatus;
use ademan::command::{CommandOrigin, CommandSpec, FieldKind, SPECS};
use ademan::message::{escape, escape_json, escape_lines};
use ademan::session::control_socket::{self, Client};
use clap::{Arg, ArgMatches, Command, FromArgMatches, Subcommand};
use serde::Deserialize;
use serde_json::{Map, Value};

use crate::failure::Failure;

/// Send a command to a running session
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan ctl state\n  ademan ctl pause\n  ademan ctl nudge 0 0 -5 && ademan ctl save\n  ademan ctl subscribe --json\n\nThe exit code is 0 if the session has executed the command, 1 if it has refused it and 2 if no session can be reached."
)]
pub struct Args {
    #[command(subcommand)]
    request: Request,
    /// Control socket of the session. The default is the socket of `ademan run` without --control
    #[arg(long, global = true, value_name = "PATH")]
    socket: Option<PathBuf>,
    /// Print the reply as JSON
    #[arg(long, global = true)]
    json: bool,
}

/// The request that no session executes: the socket itself sends notifications.
const SUBSCRIBE: &str = "subscribe";

/// A line for the control socket.
struct Request {
    command: String,
    line: String,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let path = socket_path(args.socket)?;
    let mut client = Client::connect(&path)?;
    let reply = client.request(&args.request.line)?;
    let fields: Value = serde_json::from_str(&reply)
        .map_err(|error| Failure::job(format!("the reply is not JSON: {error}")))?;
    if args.json {
        print_line(&escape_json(&reply))?;
    }
    if fields["ok"] != true {
        let error = fields["error"].as_str().unwrap_or("refused without reason");
        return Err(Failure::job(error));
    }
    match args.request.command.as_str() {
        SUBSCRIBE => print_notifications(client, args.json),
        "stop" if !client.wait_until_closed() => Err(Failure::job(
            "the session was told to stop, but has not ended within 5 s",
        )),
        _ if args.json => Ok(()),
        command => print_line(&reply_text(command, &fields)),
    }
}

/// Returns the path of the control socket: the given one, or the default.
pub fn socket_path(given: Option<PathBuf>) -> Result<PathBuf, Failure> {
    let path = given.or_else(control_socket::default_path);
    path.ok_or_else(|| {
        Failure::wrong_use(
            "there is no default control socket, as XDG_RUNTIME_DIR names no folder; name the socket with --socket, and \
             start the session with the same path after --control",
        )
    })
}

impl Subcommand for Request {
    /// Adds one subcommand for each command of the session, from its table.
    fn augment_subcommands(parent: Command) -> Command {
        let subscribe = Command::new(SUBSCRIBE)
            .about("Print all events, including everything that is typed, until the session ends")
            .after_help(format!("Example: ademan ctl {SUBSCRIBE}"));
        let commands = SPECS.iter().map(subcommand);
        parent
            .subcommands(commands)
            .subcommand(subscribe)
            .subcommand_required(true)
            .arg_required_else_help(true)
    }

    fn augment_subcommands_for_update(parent: Command) -> Command {
        Self::augment_subcommands(parent)
    }

    fn has_subcommand(name: &str) -> bool {
        name == SUBSCRIBE || CommandSpec::find(name).is_ok()
    }
}

fn subcommand(spec: &CommandSpec) -> Command {
    let fields = spec.fields.iter().map(|field| {
        let arg = Arg::new(field.name).help(field.summary).required(true);
        match field.kind {
            FieldKind::Number { .. } | FieldKind::Whole { .. } => {
                // A value such as -5cm is refused as a number, not as an unknown option.
                arg.value_parser(number).allow_hyphen_values(true)
            }
            FieldKind::Name => arg,
            FieldKind::OneOf(words) => arg.value_parser(words.to_vec()),
        }
    });
    let values = spec
        .fields
        .iter()
        .map(|field| format!(" {}", field.example));
    let example: String = values.collect();
    Command::new(spec.name)
        .about(spec.summary)
        .args(fields)
        .after_help(format!("Example: ademan ctl {}{example}", spec.name))
}

fn number(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "this is not a number; write one such as 2.5 or -5".into())
}

impl FromArgMatches for Request {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let (command, arguments) = matches
            .subcommand()
            .ok_or_else(|| clap::Error::new(clap::error::ErrorKind::MissingSubcommand))?;
        let mut line = Map::new();
        line.insert("command".into(), command.into());
        let fields = CommandSpec::find(command).map_or(&[][..], |spec| spec.fields);
        for field in fields {
            let value = match field.kind {
                FieldKind::Number { .. } | FieldKind::Whole { .. } => {
                    arguments.get_one::<f64>(field.name).copied().into()
                }
                FieldKind::Name | FieldKind::OneOf(_) => {
                    arguments.get_one::<String>(field.name).cloned().into()
                }
            };
            line.insert(field.name.into(), value);
        }
        Ok(Self {
            command: command.to_owned(),
            line: Value::Object(line).to_string(),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Returns a reply for a person.
fn reply_text(command: &str, reply: &Value) -> String {
    match command {
        "state" => state_text(reply),
        "pause" => "paused: everything is released".into(),
        "resume" => "resumed: output is armed once the hand is clear of every key".into(),
        "stop" => "ended".into(),
        _ => reply["text"]
            .as_str()
            .map_or("done".into(), |text| escape_lines(text).into_owned()),
    }
}

/// Returns the line about what the text decoder has learned.
fn typing_text(reply: &Value) -> String {
    let Some(typing) = reply.get("typing") else {
        return String::new();
    };
    if typing["taps"] == 0 && typing["words"] == 0 {
        return "\ntyping     nothing learned yet".to_owned();
    }
    let [offset, scatter] = ["offset_mm", "scatter_mm"].map(|field| &typing[field]);
    format!(
        "\ntyping     {} learned: {} mm right of and {} mm below the centers of keys, scatter {} and {} mm; {} of your own",
        plural(&typing["taps"], "tap", "taps"),
        offset[0],
        offset[1],
        scatter[0],
        scatter[1],
        plural(&typing["words"], "word", "words"),
    )
}

fn state_text(reply: &Value) -> String {
    let stats = &reply["stats"];
    let mut state = plain_text(&reply["state"]).unwrap_or_default();
    if let Some(origin) = reply["paused_by"].as_str() {
        let origin = origin.parse().map(CommandOrigin::description);
        state += &format!(" by {}", origin.unwrap_or("a command"));
    }
    let or_unknown = |value| plain_text(value).unwrap_or_else(|| "unknown".into());
    let mut readings = format!("{}: {} accepted", stats["received"], stats["accepted"]);
    for (reason, count) in non_zero(&stats["rejected"]) {
        readings += &format!(", {count} rejected ({reason})");
    }
    readings += &format!(", {} dropped", stats["dropped"]);
    for (reason, count) in non_zero(&stats["invalid"]) {
        readings += &format!("; {count} invalid ({reason})");
    }
    for (reason, count) in non_zero(&stats["suppressed"]) {
        readings += &format!("; {count} suppressed ({})", reason.replace('_', " "));
    }
    let mut learned = String::new();
    if let Some(ranges) = reply.get("learned") {
        let joint = or_unknown(&ranges["largest"]);
        learned = format!(
            "\nlearned    {} of sensors, at most {} % wider ({joint}); `ademan ctl undo-learning` undoes it",
            plural(&ranges["channels"], "range", "ranges"),
            ranges["percent"]
        );
    }
    let typing = typing_text(reply);
    let mut profile = or_unknown(&reply["profile"]);
    if let Some(application) = plain_text(&reply["application"]) {
        profile += &format!(" (the rule for {application} holds)");
    }
    let headset = HeadsetStatus::deserialize(&reply["headset"]).ok();
    let headset = headset.map_or(String::new(), |headset| format!("\nsource     {headset}"));
    let incomplete = reply["incomplete"].as_array().into_iter().flatten();
    let incomplete = incomplete.filter_map(plain_text);
    let incomplete: String = incomplete
        .map(|file| format!("\nfiles      {file}"))
        .collect();
    format!(
        "state      {state}\nprofile    {profile}\nlayout     {}\nsteps      {}\nreadings   {readings}\nstalls     {}; the device was lost {}\ndropped    {}{headset}{learned}{typing}{incomplete}",
        or_unknown(&reply["layout"]),
        reply["steps"],
        stats["stalls"],
        plural(&stats["losses"], "time", "times"),
        plural(&reply["dropped_presses"], "press", "presses"),
    )
}

/// Returns a count with its noun.
fn plural(count: &Value, one: &str, many: &str) -> String {
    let noun = match count.as_u64() {
        Some(1) => one,
        _ => many,
    };
    format!("{count} {noun}")
}

fn non_zero(counts: &Value) -> impl Iterator<Item = (&String, &Value)> {
    let counts = counts.as_object().into_iter().flatten();
    counts.filter(|(_, count)| **count != 0)
}

/// Returns a string without quotes, any other value as JSON, both escaped, and `None` for null.
fn plain_text(value: &Value) -> Option<String> {
    match value {
        Value::Null => None,
        Value::String(text) => Some(escape(text).into_owned()),
        value => Some(escape_json(&value.to_string()).into_owned()),
    }
}

fn print_notifications(mut client: Client, as_json: bool) -> Result<(), Failure> {
    while let Some(line) = client.next_notification()? {
        match serde_json::from_str(&line) {
            Ok(Value::Object(fields)) if !as_json => print_line(&notification_text(&fields))?,
            _ => print_line(&escape_json(&line))?,
        }
    }
    Ok(())
}

/// Returns the time in ms if there is one, the event, and its other fields.
fn notification_text(fields: &Map<String, Value>) -> String {
    let time = fields.get("time_us").and_then(Value::as_u64);
    let time = time.map_or(String::new(), |time| {
        format!("{}.{:03}", time / 1_000, time % 1_000)
    });
    let event = fields.get("event").or_else(|| fields.get("command"));
    let is_detail = |(key, value): &(&String, &Value)| {
        !matches!(key.as_str(), "time_us" | "event" | "command") && !value.is_boolean()
    };
    let details = fields.iter().filter(is_detail);
    let details = details.filter_map(|(key, value)| match (key.as_str(), value) {
        // An error in a file has several lines.
        ("text", Value::String(text)) => Some(escape_lines(text).into_owned()),
        _ => plain_text(value),
    });
    let words = event.and_then(plain_text).into_iter().chain(details);
    words.fold(format!("{time:>12}"), |line, word| line + " " + &word)
}

fn print_line(line: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    writeln!(out, "{line}")?;
    Ok(out.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thing_has_a_noun_in_the_singular() {
        let losses = |count: u64| plural(&count.into(), "loss", "losses");
        assert_eq!([0, 1, 2].map(losses), ["0 losses", "1 loss", "2 losses"]);
    }
}
