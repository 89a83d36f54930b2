//! The table of security requirements.

use crate::evidence::Evidence;

/// The degree to which a requirement is met.
pub enum Status {
    /// As these tests show.
    Met(&'static [Evidence]),
    /// As these tests show, with this exception.
    Partly(&'static [Evidence], &'static str),
    /// The requirement is about a feature that does not exist.
    NotApplicable(&'static str),
}

/// A security requirement.
pub struct Requirement {
    pub number: usize,
    pub name: &'static str,
    pub status: Status,
}

const fn requirement(number: usize, name: &'static str, status: Status) -> Requirement {
    Requirement {
        number,
        name,
        status,
    }
}

const NO_NETWORK_INPUT: &str =
    "no input is received from a network, except from the address that the user names";

pub const REQUIREMENTS: &[Requirement] = &[
    requirement(
        1,
        "nothing listens beyond this machine",
        Status::Met(&[
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
        "senders of input authenticate themselves",
        Status::NotApplicable(NO_NETWORK_INPUT),
    ),
    requirement(
        3,
        "datagrams are signed and numbered",
        Status::NotApplicable(NO_NETWORK_INPUT),
    ),
    requirement(
        4,
        "what leaves the machine is encrypted",
        Status::NotApplicable(
            "nothing leaves it; a serial converter (`tcp:`) sends in clear text, its only mode",
        ),
    ),
    requirement(
        5,
        "no web page reaches a port",
        Status::NotApplicable("there are no ports; sockets are files, which browsers cannot reach"),
    ),
    requirement(
        6,
        "a joint-angle server is read-only",
        Status::NotApplicable("there is none"),
    ),
    requirement(
        7,
        "sources have roles",
        Status::Met(&[
            (
                "src/pipeline/output_gate.rs",
                "a_pointer_presses_no_keys_and_what_is_for_keys_does_not_point",
            ),
            (
                "src/pipeline/output_gate.rs",
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
        "only keys of the layout, and no system keys",
        Status::Met(&[
            (
                "tests/pipeline/limits.rs",
                "a_layout_with_keys_of_the_system_is_used_only_by_a_setup_that_allows_them",
            ),
            (
                "src/pipeline/output_gate.rs",
                "keys_that_act_on_the_system_do_not_go_out_unless_they_may",
            ),
            (
                "src/output/uinput/linux/spec.rs",
                "each_device_has_the_required_capabilities_only",
            ),
        ]),
    ),
    requirement(
        9,
        "presses are rate-limited, and too many pause the session",
        Status::Met(&[
            (
                "tests/pipeline/limits.rs",
                "after_more_presses_than_may_be_everything_is_let_go_of_and_the_run_pauses",
            ),
            (
                "tests/pipeline/limits.rs",
                "a_source_at_this_machine_may_press_as_fast_as_anybody_types_and_one_on_the_network_may_not",
            ),
            (
                "src/pipeline/output_gate.rs",
                "half_a_second_of_presses_may_come_at_once_and_then_they_drip",
            ),
        ]),
    ),
    requirement(
        10,
        "guessing a secret is slow",
        Status::NotApplicable(
            "there is no secret; the kernel identifies the user of the control socket",
        ),
    ),
    requirement(
        11,
        "five ways to stop immediately",
        Status::Partly(
            &[
                (
                    "tests/outputs/vm/typing.rs",
                    "panic keys release all keys and pause",
                ),
                (
                    "tests/outputs/x11/watchdog.rs",
                    "sigusr1_pauses_until_a_resume",
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
                    "all_keys_are_released_after_the_glove_stops_sending",
                ),
            ],
            "200 times at full load: `cargo bench --bench release` for the signal and the socket, the pipeline alone for the gesture; the layout defines the gesture",
        ),
    ),
    requirement(
        12,
        "a session starts unarmed, and reports when it is armed",
        Status::Met(&[
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
        "no root, and a dedicated group",
        Status::Met(&[
            (
                "tests/cli/doctor.rs",
                "root_does_not_type_unless_he_insists_and_may_do_all_the_rest",
            ),
            (
                "tests/architecture/security_sources.rs",
                "the_udev_rules_give_uinput_to_its_own_group_or_the_seat_and_never_to_input",
            ),
        ]),
    ),
    requirement(
        14,
        "only its user can use the control socket",
        Status::Met(&[
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
        Status::NotApplicable("there is none"),
    ),
    requirement(
        16,
        "the systemd unit is a sandbox",
        Status::Partly(
            &[(
                "tests/cli/doctor.rs",
                "a_unit_and_a_launcher_are_what_their_own_tools_take",
            )],
            "DevicePolicy= and IPAddressDeny= do not apply to user units",
        ),
    ),
    requirement(
        17,
        "files start no program and follow no path",
        Status::Met(&[
            (
                "tests/architecture/security_sources.rs",
                "only_the_watchdog_is_ever_started",
            ),
            (
                "tests/architecture/security_sources.rs",
                "no_file_of_a_user_reads_the_environment",
            ),
        ]),
    ),
    requirement(
        18,
        "typed text is in no message, and recordings are private",
        Status::Met(&[
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
                "a_transcript_is_readable_by_its_owner_only",
            ),
        ]),
    ),
    requirement(
        19,
        "files with secrets are private",
        Status::NotApplicable("there are no secrets"),
    ),
    requirement(
        20,
        "a replay types only on request",
        Status::Met(&[(
            "tests/cli/security/replays.rs",
            "a_recording_that_is_replayed_presses_nothing_unless_the_desktop_is_named",
        )]),
    ),
    requirement(
        21,
        "all dependencies are known",
        Status::Partly(
            &[(
                "tests/architecture/security_sources.rs",
                "all_dependencies_come_from_the_registry_with_a_checksum",
            )],
            "the tests have no network and check no advisories",
        ),
    ),
    requirement(
        22,
        "memory is safe",
        Status::Met(&[(
            "tests/architecture/security_sources.rs",
            "the_program_contains_no_unsafe_code",
        )]),
    ),
];
