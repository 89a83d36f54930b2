//! Questions to a person at a terminal. Each has an answer that is proposed.

use std::io::{self, BufRead, IsTerminal, Write};

use ademan::message::escape;

use crate::failure::Failure;
use crate::signals;

/// Asks questions, or accepts every proposal.
pub struct Questions {
    is_asking: bool,
}

impl Questions {
    /// Creates questions that are asked only if someone at a terminal can answer them.
    pub fn new(accepts_all: bool) -> Self {
        let is_on_terminal = io::stdin().is_terminal() && io::stdout().is_terminal();
        Self {
            is_asking: is_on_terminal && !accepts_all,
        }
    }

    /// Asks until the answer is accepted by `check`, which returns the reason otherwise. An empty answer is the proposal.
    pub fn ask<T>(
        &self,
        question: &str,
        proposal: &str,
        check: impl Fn(&str) -> Result<T, String>,
    ) -> Result<T, Failure> {
        loop {
            let answer = if self.is_asking {
                read_answer(&format!("{question} [{proposal}]: "))?
            } else {
                String::new()
            };
            let answer = if answer.is_empty() { proposal } else { &answer };
            match check(answer) {
                Ok(value) => return Ok(value),
                Err(reason) if self.is_asking => writeln!(io::stdout(), "{reason}")?,
                Err(reason) => return Err(Failure::wrong_use(reason)),
            }
        }
    }

    /// Asks whether to do something. The proposal is yes.
    pub fn confirm(&self, question: &str) -> Result<bool, Failure> {
        self.ask(question, "yes", |answer| match answer {
            "y" | "Y" | "yes" => Ok(true),
            "n" | "N" | "no" => Ok(false),
            other => Err(format!("`{}` is neither yes nor no", escape(other))),
        })
    }
}

fn read_answer(question: &str) -> Result<String, Failure> {
    let mut out = io::stdout();
    write!(out, "{question}")?;
    out.flush()?;
    let mut answer = String::new();
    let length = io::stdin().lock().read_line(&mut answer)?;
    if length == 0 || signals::is_stop_requested() {
        writeln!(out)?;
        return Err(interrupted());
    }
    Ok(answer.trim().to_owned())
}

/// Returns the failure of a start that was ended early.
pub fn interrupted() -> Failure {
    Failure::job("ended before the setup was written; run `ademan start` again")
}
