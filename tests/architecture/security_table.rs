//! The list.

use crate::evidence::Witness;

/// How far a requirement is met.
pub enum State {
    /// By what these tests prove.
    Met(&'static [Witness]),
    /// The same, but for this.
    Partly(&'static [Witness], &'static str),
    /// What it is about does not exist.
    NotApplicable(&'static str),
}

/// Something that is required.
pub struct Requirement {
    pub number: usize,
    pub name: &'static str,
    pub state: State,
}

const fn requirement(number: usize, name: &'static str, state: State) -> Requirement {
    Requirement {
        number,
        name,
        state,
    }
}

const NO_NETWORK_INPUT: &str =
    "nothing is received from a network but from a converter box that the user names";

pub const REQUIREMENTS: &[Requirement] = &[
    requirement(
        1,
        "nothing listens beyond this machine",
        State::Met(&[
            (
                "tests/cli/security/sockets.rs",
                "a_run_with_all_that_it_offers_has_no_socket_of_a_network",
            ),
            (
                "tests/cli/security/sockets.rs",
                "a_socket_of_a_network_would_be_found",
            ),
        ]),
    ),
    requirement(
        2,
        "who sends input shows a secret",
        State::NotApplicable(NO_NETWORK_INPUT),
    ),
    requirement(
        3,
        "datagrams are signed and counted",
        State::NotApplicable(NO_NETWORK_INPUT),
    ),
    requirement(
        4,
        "what leaves the machine is encrypted",
        State::NotApplicable(
            "nothing leaves it; a converter box (`tcp:`) sends in clear, as it knows nothing else",
        ),
    ),
    requirement(
        5,
        "no web page reaches a port",
        State::NotApplicable("there are no ports; sockets are files, which browsers do not reach"),
    ),
    requirement(
        6,
        "a server of joint angles only tells",
        State::NotApplicable("there is none"),
    ),
    requirement(
        7,
        "sources have roles",
        State::Met(&[
            (
                "src/pipeline/gate.rs",
                "a_pointer_presses_no_keys_and_what_is_for_keys_does_not_point",
            ),
            (
                "src/pipeline/gate.rs",
                "each_source_has_a_role_of_its_own_and_releases_have_none",
            ),
            (
                "tests/pipeline/limits.rs",
                "a_source_on_the_network_is_a_pointer_unless_the_setup_says_more_and_any_other_is_both",
            ),
            (
                "tests/pipeline/hands_and_profiles.rs",
                "each_hand_has_the_role_of_its_source",
            ),
            (
                "tests/pipeline/hands_and_profiles.rs",
                "what_a_pointer_begins_is_not_typed_when_the_other_hand_is_seen",
            ),
            (
                "tests/cli/roles.rs",
                "key_poses_of_a_source_on_the_network_press_no_keys_and_the_user_is_told_how_to_allow_them",
            ),
            (
                "tests/cli/roles.rs",
                "with_the_role_both_they_do_and_nothing_is_told_of_it",
            ),
        ]),
    ),
    requirement(
        8,
        "only keys of the layout, and none of the system",
        State::Met(&[
            (
                "tests/pipeline/limits.rs",
                "a_layout_with_keys_of_the_system_is_used_only_by_a_setup_that_allows_them",
            ),
            (
                "src/pipeline/gate.rs",
                "keys_that_act_on_the_system_do_not_go_out_unless_they_may",
            ),
            (
                "src/output/uinput/declared.rs",
                "a_device_is_made_when_it_is_needed_and_has_what_is_needed",
            ),
        ]),
    ),
    requirement(
        9,
        "presses have a limit, and too many pause",
        State::Met(&[
            (
                "tests/pipeline/limits.rs",
                "after_more_presses_than_may_be_everything_is_let_go_of_and_the_run_pauses",
            ),
            (
                "tests/pipeline/limits.rs",
                "a_source_at_this_machine_may_press_as_fast_as_anybody_types_and_one_on_the_network_may_not",
            ),
            (
                "src/pipeline/gate.rs",
                "half_a_second_of_presses_may_come_at_once_and_then_they_drip",
            ),
        ]),
    ),
    requirement(
        10,
        "guessing a secret is slow",
        State::NotApplicable("there is no secret; the control socket knows its user by the kernel"),
    ),
    requirement(
        11,
        "five ways to stop at once",
        State::Partly(
            &[
                (
                    "tests/outputs/vm/typing.rs",
                    "two keys of the machine's own keyboard let go of what the hand holds, and pause",
                ),
                (
                    "tests/outputs/x11/watchdog.rs",
                    "a_signal_pauses_until_somebody_resumes",
                ),
                (
                    "tests/cli/control.rs",
                    "a_pause_lets_go_and_nothing_is_typed_until_it_is_ended_and_the_hand_was_off",
                ),
                (
                    "tests/pipeline/stops.rs",
                    "a_gesture_of_one_hand_lets_go_of_what_the_other_holds_in_that_very_frame_and_pauses",
                ),
                (
                    "tests/pipeline/stops.rs",
                    "a_hand_whose_elbow_is_not_told_any_more_lets_go_at_the_third_reading",
                ),
                (
                    "tests/pipeline/hands_and_profiles.rs",
                    "a_hand_that_stays_away_lets_go_of_what_both_hold_and_both_have_to_be_off_the_keys_first",
                ),
                (
                    "tests/outputs/x11/ends.rs",
                    "nothing_is_down_after_the_glove_fell_silent",
                ),
            ],
            "200 times at full load: `cargo bench --bench release` for the signal and the socket, the engine alone for the gesture; which gesture is up to the layout",
        ),
    ),
    requirement(
        12,
        "it starts paused, and says when it arms",
        State::Met(&[
            (
                "tests/pipeline/arming.rs",
                "it_starts_paused_and_arms_when_the_hand_was_off_all_keys_for_300_ms",
            ),
            (
                "tests/pipeline/arming.rs",
                "a_hand_that_lies_on_a_key_at_the_start_presses_nothing",
            ),
        ]),
    ),
    requirement(
        13,
        "no root, and a group of its own",
        State::Met(&[
            (
                "tests/cli/doctor.rs",
                "root_does_not_type_unless_he_insists_and_may_do_all_the_rest",
            ),
            (
                "tests/architecture/security_sources.rs",
                "the_rules_give_uinput_to_a_group_of_its_own_or_to_the_seat_and_never_to_input",
            ),
        ]),
    ),
    requirement(
        14,
        "the control socket is its user's alone",
        State::Met(&[
            (
                "tests/cli/control.rs",
                "the_socket_is_its_owners_alone_from_the_first_instant_on",
            ),
            ("tests/cli/control.rs", "another_user_is_not_listened_to"),
            (
                "tests/cli/control.rs",
                "a_folder_that_others_may_enter_is_refused",
            ),
            (
                "tests/cli/control.rs",
                "a_second_run_is_refused_and_the_socket_of_a_killed_one_is_taken_over",
            ),
        ]),
    ),
    requirement(
        15,
        "a D-Bus interface fails closed",
        State::NotApplicable("there is none"),
    ),
    requirement(
        16,
        "the unit is a sandbox",
        State::Partly(
            &[(
                "tests/cli/doctor.rs",
                "a_unit_and_a_launcher_are_what_their_own_tools_take",
            )],
            "DevicePolicy= and IPAddressDeny= are not for units of a user",
        ),
    ),
    requirement(
        17,
        "files run nothing and lead nowhere",
        State::Met(&[
            (
                "tests/architecture/security_sources.rs",
                "nothing_but_the_guardian_is_ever_started",
            ),
            (
                "tests/architecture/security_sources.rs",
                "no_file_that_people_write_reads_the_environment",
            ),
        ]),
    ),
    requirement(
        18,
        "what is typed is in no message, and recordings are private",
        State::Met(&[
            ("tests/cli/files.rs", "what_is_typed_is_in_no_message"),
            (
                "tests/cli/files.rs",
                "a_run_that_is_recorded_gives_the_transcript_that_was_printed",
            ),
            (
                "tests/cli/control.rs",
                "who_has_not_subscribed_hears_nothing_of_what_is_typed",
            ),
            (
                "src/output/tests.rs",
                "only_its_owner_can_read_a_transcript",
            ),
        ]),
    ),
    requirement(
        19,
        "files with secrets are private",
        State::NotApplicable("there are no secrets"),
    ),
    requirement(
        20,
        "a replay types only when it is told to",
        State::Met(&[(
            "tests/cli/security/replays.rs",
            "a_recording_that_is_replayed_presses_nothing_unless_the_desktop_is_named",
        )]),
    ),
    requirement(
        21,
        "what it is built of is known",
        State::Partly(
            &[(
                "tests/architecture/security_sources.rs",
                "what_is_built_is_what_the_lock_file_says",
            )],
            "advisories are not looked up by the tests, which have no network",
        ),
    ),
    requirement(
        22,
        "memory is safe",
        State::Met(&[(
            "tests/architecture/security_sources.rs",
            "there_is_no_unsafe_code_in_the_program",
        )]),
    ),
];
