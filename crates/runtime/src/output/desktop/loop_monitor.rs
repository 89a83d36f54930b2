//! Detection of a loop that hangs while a key is pressed.

/// Number of checks in a row without a call from the loop after which it counts as hung. The loop calls at least every 50 ms
/// while readings are expected, and a check follows every 50 ms.
const MAX_MISSED_CHECKS: u32 = 4;

/// The calls from the loop, as the thread of an output sees them.
///
/// It counts checks instead of time: on a busy machine, or after the whole process was stopped, the thread is late as well, and
/// the loop has not had a turn.
#[derive(Debug, Default)]
pub struct LoopMonitor {
    calls: u64,
    missed: u32,
}

impl LoopMonitor {
    /// Checks whether the loop has called since the last check, and returns `true` if it hangs. `calls` is the number of its
    /// calls so far. It need not call unless a key is pressed.
    pub fn check(&mut self, calls: u64, is_key_pressed: bool) -> bool {
        if calls != self.calls || !is_key_pressed {
            self.calls = calls;
            self.missed = 0;
        } else {
            self.missed = self.missed.saturating_add(1);
        }
        self.missed >= MAX_MISSED_CHECKS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_hangs_if_it_does_not_call_between_several_checks_while_a_key_is_pressed() {
        let mut monitor = LoopMonitor::default();
        assert!(!(0..10).any(|calls| monitor.check(calls, true)), "calls");
        assert!(!(0..10).any(|_| monitor.check(9, false)), "no key");
        let hangs: Vec<_> = (0..5).map(|_| monitor.check(9, true)).collect();
        assert_eq!(hangs, [false, false, false, true, true]);
        assert!(!monitor.check(10, true), "it continues");
        // A loop that is late now and then.
        let calls = [11, 11, 11, 11, 12, 12, 12, 12, 13];
        assert!(!calls.into_iter().any(|calls| monitor.check(calls, true)));
    }
}
