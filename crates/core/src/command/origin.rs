//! The origin of a command.

use crate::names::named_enum;

named_enum! {
    /// The origin of a command, on which depends which pauses it may end.
    ///
    /// Every origin may pause. A pause is ended by its own side or a stronger one: a key of the layout ends only the
    /// pauses of the layout, so that a hand never undoes a pause that was requested from outside.
    pub enum CommandOrigin ("origin") {
        /// A key or gesture of the layout.
        Layout = "layout",
        /// The terminal, which suspends the process (Ctrl-Z).
        Suspend = "suspend",
        /// A client: the control socket or the owner of the session.
        Client = "command",
        /// A signal.
        Signal = "signal",
        /// The panic keys.
        PanicKeys = "panic-keys",
        /// The press rate limit.
        RateLimit = "rate-limit",
        /// The loss of the watchdog.
        Watchdog = "watchdog",
    }
}

impl CommandOrigin {
    /// Returns `true` if a command from here may end a pause that `pause` has requested.
    pub const fn may_end_pause_of(self, pause: Self) -> bool {
        self.strength() >= pause.strength()
    }

    /// Returns the origin of a pause that `self` has requested when `other` requests one too: the stronger of both.
    #[must_use]
    pub const fn or_stronger(self, other: Self) -> Self {
        if self.may_end_pause_of(other) {
            self
        } else {
            other
        }
    }

    /// Returns the words that follow "paused by" in a message.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Layout => "a key or gesture of the layout",
            Self::Suspend => "Ctrl-Z",
            Self::Client => "a command",
            Self::Signal => "a signal",
            Self::PanicKeys => "the panic keys",
            Self::RateLimit => "the press rate limit",
            Self::Watchdog => "the loss of the watchdog",
        }
    }

    /// Returns the rank of the side. A suspend ends by itself when the process continues; a pause that was requested
    /// from elsewhere in the meantime remains.
    const fn strength(self) -> u8 {
        match self {
            Self::Layout => 0,
            Self::Suspend => 1,
            Self::Client | Self::Signal | Self::PanicKeys | Self::RateLimit | Self::Watchdog => 2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_ends_only_its_own_pauses_and_every_other_side_ends_those() {
        for &origin in CommandOrigin::ALL {
            let is_layout = origin == CommandOrigin::Layout;
            assert_eq!(
                CommandOrigin::Layout.may_end_pause_of(origin),
                is_layout,
                "{origin}"
            );
            assert!(origin.may_end_pause_of(CommandOrigin::Layout), "{origin}");
            assert!(CommandOrigin::Client.may_end_pause_of(origin), "{origin}");
        }
    }

    #[test]
    fn a_pause_keeps_its_first_origin_unless_a_stronger_one_follows() {
        let [layout, suspend, client, signal] = [
            CommandOrigin::Layout,
            CommandOrigin::Suspend,
            CommandOrigin::Client,
            CommandOrigin::Signal,
        ];
        assert_eq!(layout.or_stronger(suspend), suspend);
        assert_eq!(suspend.or_stronger(layout), suspend);
        assert_eq!(suspend.or_stronger(client), client);
        assert_eq!(client.or_stronger(signal), client);
    }
}
