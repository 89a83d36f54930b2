//! Profiles that follow the application with the focus: a thread watches the desktop and asks the session for the profile of a rule.
//!
//! Names of applications are compared with the rules and dropped. Nothing here reads the title of a window.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(target_os = "linux")]
use linux as platform;
#[cfg(not(target_os = "linux"))]
mod unsupported;
#[cfg(not(target_os = "linux"))]
use unsupported as platform;

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use super::command_channel::CommandSender;
use super::notice::Notice;
use super::notice_thread::NoticeSender;
use super::reply::RequestError;
use crate::setup::ApplicationProfile;
use ademan_core::command::{Command, ProfileName};
use ademan_core::pipeline::MAIN_PROFILE;

/// Stands for no rule in [`ActiveRule`].
const NO_RULE: usize = usize::MAX;

/// Time until a command that found the queue full is sent again.
const RETRY_DELAY: Duration = Duration::from_millis(50);

/// The rules of a setup, and the index of the rule that holds, for readers on other threads.
#[derive(Clone, Debug)]
pub struct ActiveRule {
    rules: Arc<[ApplicationProfile]>,
    index: Arc<AtomicUsize>,
}

impl Default for ActiveRule {
    fn default() -> Self {
        Self::new(&[])
    }
}

impl ActiveRule {
    /// Creates rules of which none holds.
    pub fn new(rules: &[ApplicationProfile]) -> Self {
        Self {
            rules: rules.into(),
            index: Arc::new(AtomicUsize::new(NO_RULE)),
        }
    }

    /// Returns the application of the rule that holds, as the setup names it.
    pub fn application(&self) -> Option<&str> {
        let rule = self.rules.get(self.index.load(Ordering::Relaxed))?;
        Some(&rule.application)
    }

    /// Returns the index of the first rule for an application that has these names, or `NO_RULE`.
    fn find(&self, names: &[String]) -> usize {
        let has_name = |rule: &ApplicationProfile| names.iter().any(|name| rule.matches(name));
        self.rules.iter().position(has_name).unwrap_or(NO_RULE)
    }

    /// Moves the focus to an application that has these names. Returns the profile to activate if another rule holds than before, the
    /// absence of one included.
    fn update(&self, names: &[String]) -> Option<ProfileName> {
        let index = self.find(names);
        if self.index.swap(index, Ordering::Relaxed) == index {
            return None;
        }
        let rule = self.rules.get(index);
        ProfileName::from(rule.map_or(MAIN_PROFILE, |rule| &rule.profile)).ok()
    }
}

/// A thread that follows the focus. It ends when this is dropped.
pub(super) struct FocusWatch(
    #[allow(dead_code, reason = "its end is the signal")] platform::Cancel,
);

/// Starts a thread that activates the profile of the rule for the application with the focus, and the first profile if there is no rule.
/// A profile that another command has activated stays active until another rule holds.
///
/// The thread sends at most one notice, with the reason why it does not follow the focus from then on. The active profile stays.
/// Without rules there is no thread.
pub(super) fn watch(
    rule: ActiveRule,
    commands: &CommandSender,
    notices: NoticeSender,
) -> io::Result<Option<FocusWatch>> {
    if rule.rules.is_empty() {
        return Ok(None);
    }
    let commands = commands.clone();
    let lost = rule.clone();
    let report = move |reason| {
        lost.index.store(NO_RULE, Ordering::Relaxed);
        notices.send(Notice::DesktopFailed(format!(
            "the active profile stays, as `profiles_by_application` has no effect: {reason}"
        )));
    };
    let follow = move |names: &[String]| match rule.update(names) {
        None => true,
        Some(name) => activate(&commands, name),
    };
    platform::watch(follow, report).map(|cancel| Some(FocusWatch(cancel)))
}

/// Activates a profile, as soon as the queue has room. Returns `false` if the session has ended.
fn activate(commands: &CommandSender, name: ProfileName) -> bool {
    let command = Command::Profile { name };
    loop {
        // At most one command waits for a loop that waits for its source.
        match commands.request_with_timeout(command, Duration::MAX) {
            Err(RequestError::QueueFull) => thread::sleep(RETRY_DELAY),
            Err(RequestError::Ended) => return false,
            _ => return true,
        }
    }
}

/// Connects to the desktop for a moment. Returns its name and, if there is one, the rule for the application that has the focus.
///
/// # Errors
/// The reason why the focus cannot be followed, and what to do.
pub(crate) fn probe(
    rules: &[ApplicationProfile],
) -> Result<(&'static str, Option<&ApplicationProfile>), String> {
    let (desktop, names) = platform::probe()?;
    let index = ActiveRule::new(rules).find(&names);
    Ok((desktop, rules.get(index)))
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::super::command_channel::{Message, command_channel};
    use super::super::reply::Reply;
    use super::*;

    fn rules() -> ActiveRule {
        let rule = |application: &str, profile: &str| ApplicationProfile {
            application: application.into(),
            profile: profile.into(),
        };
        ActiveRule::new(&[rule("foot", "code"), rule("gimp", "draw")])
    }

    fn update(rule: &ActiveRule, names: &[&str]) -> Option<String> {
        let names: Vec<_> = names.iter().map(ToString::to_string).collect();
        rule.update(&names).map(|name| name.to_string())
    }

    #[test]
    fn a_profile_is_asked_for_when_another_rule_holds_and_not_before() {
        let rule = rules();
        assert_eq!(update(&rule, &["firefox"]), None, "main is active already");
        assert_eq!(update(&rule, &["foot"]).as_deref(), Some("code"));
        assert_eq!(rule.application(), Some("foot"));
        assert_eq!(update(&rule, &["footclient", "foot"]), None);
        assert_eq!(
            update(&rule, &["org.gimp", "Gimp"]).as_deref(),
            Some("draw")
        );
        assert_eq!(update(&rule, &["firefox"]).as_deref(), Some(MAIN_PROFILE));
        assert_eq!(rule.application(), None);
        assert_eq!(update(&rule, &["thunderbird"]), None, "no rule as before");
    }

    #[test]
    fn a_profile_that_finds_the_queue_full_is_asked_for_again() {
        let (sender, receiver) = command_channel();
        while sender.send(Command::Resume).is_ok() {}
        let name = ProfileName::from("code").unwrap();
        let session = thread::spawn(move || {
            thread::sleep(2 * RETRY_DELAY);
            let deadline = Instant::now() + Duration::from_secs(60);
            while Instant::now() < deadline {
                if let Some(Message::Command(queued)) = receiver.try_next()
                    && queued.command == (Command::Profile { name })
                {
                    return queued
                        .reply
                        .is_some_and(|it| it.send(Ok(Reply::Done)).is_ok());
                }
            }
            false
        });
        assert!(activate(&sender, name));
        assert!(session.join().unwrap(), "no profile was asked for");
    }
}
