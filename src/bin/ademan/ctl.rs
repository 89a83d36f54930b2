//! `ademan ctl`: asks a run for something.

use std::io::{self, Write};
use std::path::PathBuf;

use ademan::session::control_socket::{self as control, Client};
use serde_json::{Value, json};

use crate::args::{CtlArgs, CtlRequest};
use crate::failure::Failure;

pub fn run(args: &CtlArgs) -> Result<(), Failure> {
    let path = args.socket.clone().or_else(control::default_path);
    let path: PathBuf = path.ok_or_else(|| {
        Failure::wrong_use(
            "XDG_RUNTIME_DIR names no folder: name the socket of the run with --socket, and give the run the same with --control",
        )
    })?;
    let mut caller = Client::connect(&path)?;
    let answer = caller.request(&request(&args.request).to_string())?;
    let read: Value = serde_json::from_str(&answer)
        .map_err(|error| Failure::job(format!("the answer makes no sense: {error}")))?;
    let is_done = read["ok"] == true;
    if args.json {
        print_line(&answer)?;
    }
    if !is_done {
        let error = read["error"].as_str().unwrap_or("refused, for no reason");
        return Err(Failure::job(error));
    }
    match args.request {
        CtlRequest::Subscribe => print_news(caller, args.json),
        CtlRequest::Stop if !caller.wait_until_closed() => Err(Failure::job(
            "the run was asked to end, and has not ended yet",
        )),
        _ if args.json => Ok(()),
        _ => print_line(&told(&args.request, &read)),
    }
}

fn request(request: &CtlRequest) -> Value {
    match request {
        CtlRequest::State => json!({"ask": "state"}),
        CtlRequest::Pause => json!({"ask": "pause"}),
        CtlRequest::Resume => json!({"ask": "resume"}),
        CtlRequest::Reload => json!({"ask": "reload"}),
        CtlRequest::Profile { name } => json!({"ask": "profile", "name": name}),
        CtlRequest::NextProfile => json!({"ask": "next-profile"}),
        CtlRequest::Recentre => json!({"ask": "recentre"}),
        CtlRequest::Nudge { x_mm, y_mm, z_mm } => {
            json!({"ask": "nudge", "x_mm": x_mm, "y_mm": y_mm, "z_mm": z_mm})
        }
        CtlRequest::Tilt { deg } => json!({"ask": "tilt", "deg": deg}),
        CtlRequest::Scale { factor } => json!({"ask": "scale", "factor": factor}),
        CtlRequest::Save => json!({"ask": "save"}),
        CtlRequest::Subscribe => json!({"ask": "subscribe"}),
        CtlRequest::Stop => json!({"ask": "stop"}),
    }
}

/// What was done, for a person.
fn told(request: &CtlRequest, answer: &Value) -> String {
    match request {
        CtlRequest::State => state(answer),
        CtlRequest::Pause => "paused: everything is released".into(),
        CtlRequest::Resume => "goes on once the hand was seen off all keys".into(),
        CtlRequest::Stop => "ended".into(),
        _ => word(&answer["text"]).unwrap_or_else(|| "done".into()),
    }
}

fn state(answer: &Value) -> String {
    let tally = &answer["tally"];
    let mut state = word(&answer["state"]).unwrap_or_default();
    if answer["paused"] == true {
        state += ", as somebody asked for it";
    }
    let known = |value| word(value).unwrap_or_else(|| "unknown".into());
    let mut account = format!(
        "{} readings: {} accepted",
        tally["received"], tally["accepted"]
    );
    for (reason, count) in tally["rejected"].as_object().into_iter().flatten() {
        if *count != 0 {
            account += &format!(", {count} rejected ({reason})");
        }
    }
    account += &format!(", {} superseded", tally["superseded"]);
    for (reason, count) in tally["withheld"].as_object().into_iter().flatten() {
        if *count != 0 {
            account += &format!("; {count} withheld ({})", reason.replace('_', " "));
        }
    }
    format!(
        "state      {state}\nprofile    {}\nlayout     {}\nframes     {}\naccount    {account}\nstalls     {}; the device was lost {} times\nrefused    {} presses",
        known(&answer["profile"]),
        known(&answer["layout"]),
        answer["frames"],
        tally["stalls"],
        tally["losses"],
        answer["refused_presses"],
    )
}

/// A text as it is, any other value as JSON; nothing for none.
fn word(value: &Value) -> Option<String> {
    match value {
        Value::Null => None,
        Value::String(text) => Some(text.clone()),
        value => Some(value.to_string()),
    }
}

fn print_news(mut caller: Client, as_json: bool) -> Result<(), Failure> {
    while let Some(line) = caller.next_notification()? {
        match serde_json::from_str(&line) {
            Ok(Value::Object(news)) if !as_json => print_line(&news_line(&news))?,
            _ => print_line(&line)?,
        }
    }
    Ok(())
}

/// The time in ms where there is one, what happened, and with what.
fn news_line(news: &serde_json::Map<String, Value>) -> String {
    let time = news.get("time_us").and_then(Value::as_u64);
    let time = time.map_or(String::new(), |time| {
        format!("{}.{:03}", time / 1_000, time % 1_000)
    });
    let mut line = format!("{time:>12}");
    let event = news.get("event").and_then(word);
    let details = news
        .iter()
        .filter(|(key, value)| !matches!(key.as_str(), "time_us" | "event") && !value.is_boolean());
    let details = details.filter_map(|(_, value)| word(value));
    for word in event.into_iter().chain(details) {
        line += " ";
        line += &word;
    }
    line
}

fn print_line(line: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    writeln!(out, "{line}")?;
    Ok(out.flush()?)
}
