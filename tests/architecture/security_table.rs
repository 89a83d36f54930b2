//! The table of security requirements.

use crate::evidence::Coverage::{Missing, Partly, Tests};
use crate::evidence::{Row, row as requirement};

const GATEKEEPER_TESTS: &str = "crates/runtime/src/network/secure/gatekeeper/tests.rs";
const TOKEN_TESTS: &str = "crates/runtime/src/network/secure/tokens/tests.rs";
const FAILED_TRIES: &str = "crates/runtime/src/network/secure/failed_tries.rs";
const NETWORK_TESTS: &str = "tests/cli/network.rs";
const LAN_TESTS: &str = "tests/cli/web/lan.rs";
const FUZZING: &str = "tests/fuzzing/main.rs";

pub const REQUIREMENTS: &[Row] = &[
    requirement(
        1,
        "nothing listens beyond this machine without TLS and a token",
        Tests(&[
            (
                "tests/cli/security/sockets.rs",
                "a_session_with_all_features_opens_no_network_socket",
            ),
            (
                "tests/cli/security/sockets.rs",
                "the_test_detects_network_sockets",
            ),
            (
                "tests/cli/share/mod.rs",
                "an_address_that_others_can_reach_is_refused",
            ),
            (
                "crates/runtime/src/network/address.rs",
                "other_machines_need_tls_and_an_address_of_one_network",
            ),
            (
                NETWORK_TESTS,
                "servers_without_tls_a_token_or_an_address_of_one_network_do_not_start",
            ),
        ]),
    ),
    requirement(
        2,
        "senders of input authenticate themselves",
        Partly(
            &[
                (
                    GATEKEEPER_TESTS,
                    "a_server_with_another_certificate_receives_no_token",
                ),
                (
                    GATEKEEPER_TESTS,
                    "a_thousand_wrong_tokens_are_five_checks_and_another_address_is_served",
                ),
                (
                    GATEKEEPER_TESTS,
                    "what_a_client_has_sent_admits_no_one_who_sends_it_again",
                ),
                (
                    LAN_TESTS,
                    "the_page_types_into_the_program_once_keys_are_allowed_until_its_token_is_revoked",
                ),
                (
                    FUZZING,
                    "first_bytes_of_clients_of_tls_are_answered_or_refused",
                ),
                (
                    FUZZING,
                    "messages_of_other_machines_are_separated_from_noise",
                ),
            ],
            "a serial converter (`tcp:`) cannot, and the routers of zenoh decide who may publish; both only point by default",
        ),
    ),
    requirement(
        3,
        "datagrams are signed and numbered",
        Missing("no datagrams of other machines are received"),
    ),
    requirement(
        4,
        "what leaves the machine is encrypted",
        Partly(
            &[
                (
                    GATEKEEPER_TESTS,
                    "what_a_client_has_sent_admits_no_one_who_sends_it_again",
                ),
                (
                    NETWORK_TESTS,
                    "openssl_receives_lines_with_a_token_and_nothing_without_one",
                ),
                (
                    "crates/runtime/src/network/zenoh/mod.rs",
                    "a_router_is_one_of_this_machine",
                ),
            ],
            "a serial converter (`tcp:`) sends in clear text, its only mode",
        ),
    ),
    requirement(
        5,
        "no web page reaches a port",
        Tests(&[
            (
                "crates/runtime/src/share/hub/tests.rs",
                "a_client_that_sends_is_disconnected",
            ),
            (
                FUZZING,
                "clients_of_a_shared_hand_are_answered_or_disconnected",
            ),
            (
                "tests/cli/share/websocket.rs",
                "only_the_pages_of_this_address_are_served_and_only_to_it",
            ),
            (
                "tests/cli/share/page.rs",
                "a_page_of_another_origin_can_neither_connect_nor_read",
            ),
            (
                "tests/cli/share/json.rs",
                "a_request_that_is_wrong_too_long_or_one_too_many_ends_the_connection_with_the_reason",
            ),
            (
                "tests/capture/websocket.rs",
                "pages_of_other_sites_and_other_host_names_are_refused",
            ),
            (
                "tests/capture/websocket.rs",
                "other_addresses_and_origins_are_refused_with_a_remedy",
            ),
            (
                NETWORK_TESTS,
                "openssl_receives_lines_with_a_token_and_nothing_without_one",
            ),
            (
                LAN_TESTS,
                "a_client_without_the_token_or_of_another_page_is_refused",
            ),
        ]),
    ),
    requirement(
        6,
        "a joint-angle server is read-only",
        Tests(&[
            (
                "crates/runtime/src/share/hub/tests.rs",
                "a_client_that_sends_is_disconnected",
            ),
            (
                "crates/runtime/src/share/target.rs",
                "a_target_is_a_format_and_a_loopback_address",
            ),
            (
                "tests/cli/share/mod.rs",
                "poses_and_angles_are_shared_as_lines_of_json",
            ),
        ]),
    ),
    requirement(
        7,
        "sources have roles",
        Tests(&[
            (
                "crates/core/src/pipeline/output_gate/tests.rs",
                "a_pointer_source_presses_no_keys_and_a_key_source_does_not_point",
            ),
            (
                "crates/core/src/pipeline/output_gate/tests.rs",
                "each_source_has_its_own_role_and_releases_need_none",
            ),
            (
                "tests/pipeline/limits.rs",
                "the_default_role_is_both_and_pointer_on_the_network",
            ),
            (
                "tests/pipeline/hands_and_profiles.rs",
                "each_hand_has_the_role_of_its_source",
            ),
            (
                "tests/pipeline/hands_and_profiles.rs",
                "a_hold_of_a_pointer_source_is_not_typed_by_the_other_hand",
            ),
            (
                "tests/cli/roles.rs",
                "a_source_on_the_network_presses_no_keys_and_the_message_explains_how_to_allow_them",
            ),
            (
                "tests/cli/roles.rs",
                "a_source_on_the_network_types_with_a_role_that_allows_it",
            ),
            (
                "tests/cli/roles.rs",
                "a_source_on_the_network_types_between_allow_keys_and_forbid_keys",
            ),
            (
                NETWORK_TESTS,
                "a_source_has_no_more_than_the_role_of_its_token",
            ),
            (
                NETWORK_TESTS,
                "a_hand_of_one_machine_types_on_another_with_the_role_of_its_token_and_no_token_is_printed",
            ),
        ]),
    ),
    requirement(
        8,
        "only keys of the layout, and no system keys",
        Tests(&[
            (
                "tests/pipeline/limits.rs",
                "system_keys_need_the_permission_of_the_setup",
            ),
            (
                "crates/core/src/pipeline/output_gate/tests.rs",
                "system_keys_are_suppressed_unless_they_are_allowed",
            ),
            (
                "crates/core/src/pipeline/output_gate/tests.rs",
                "a_system_chord_is_never_down_in_any_order_of_its_keys",
            ),
            (
                "crates/runtime/src/output/uinput/linux/spec.rs",
                "each_device_has_the_required_capabilities_only",
            ),
        ]),
    ),
    requirement(
        9,
        "presses are rate-limited, and too many pause the session",
        Tests(&[
            (
                "tests/pipeline/limits.rs",
                "presses_beyond_the_rate_limit_release_everything_and_pause",
            ),
            (
                "tests/pipeline/limits.rs",
                "the_rate_limit_is_60_for_a_local_source_and_20_on_the_network",
            ),
            (
                "crates/core/src/pipeline/output_gate/tests.rs",
                "a_burst_of_half_a_second_passes_and_then_the_sustained_rate",
            ),
        ]),
    ),
    requirement(
        10,
        "guessing a secret is slow",
        Tests(&[
            (
                GATEKEEPER_TESTS,
                "a_thousand_wrong_tokens_are_five_checks_and_another_address_is_served",
            ),
            (
                GATEKEEPER_TESTS,
                "silent_clients_are_closed_and_take_no_place_of_another_address",
            ),
            (
                FAILED_TRIES,
                "an_address_has_five_tries_and_then_a_growing_pause",
            ),
            (
                FAILED_TRIES,
                "ten_thousand_addresses_take_the_memory_of_a_thousand_and_end_no_long_pause",
            ),
            (
                FAILED_TRIES,
                "a_machine_has_one_pause_for_all_addresses_that_it_can_choose",
            ),
        ]),
    ),
    requirement(
        11,
        "five ways to stop immediately",
        Partly(
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
                    "a_pause_releases_keys_and_types_nothing_until_it_ends_and_the_hand_is_clear",
                ),
                (
                    "tests/pipeline/stops.rs",
                    "a_gesture_of_one_hand_pauses_and_releases_the_keys_of_the_other_hand_in_the_same_step",
                ),
                (
                    "tests/pipeline/stops.rs",
                    "a_hand_whose_elbow_is_no_longer_measured_releases_at_the_third_reading",
                ),
                (
                    "tests/pipeline/hands_and_profiles.rs",
                    "a_missing_hand_releases_its_keys_and_the_other_one_continues",
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
        Tests(&[
            (
                "tests/pipeline/arming.rs",
                "output_is_armed_after_the_hand_has_been_clear_of_every_key_for_300_ms",
            ),
            (
                "tests/pipeline/arming.rs",
                "a_hand_on_a_key_at_the_start_presses_nothing",
            ),
        ]),
    ),
    requirement(
        13,
        "no root, and a dedicated group",
        Tests(&[
            (
                "tests/cli/doctor.rs",
                "root_is_refused_without_allow_root_but_may_use_other_commands",
            ),
            (
                "tests/architecture/packages.rs",
                "the_udev_rules_give_uinput_to_its_own_group_or_the_seat_and_never_to_input",
            ),
        ]),
    ),
    requirement(
        14,
        "only its user can use the control socket",
        Tests(&[
            (
                "tests/cli/control.rs",
                "the_socket_is_private_from_its_creation_on",
            ),
            (
                "tests/cli/control.rs",
                "commands_of_another_user_are_refused",
            ),
            (
                "tests/cli/control.rs",
                "a_directory_that_others_may_enter_is_refused",
            ),
            (
                "tests/cli/control.rs",
                "a_second_run_is_refused_and_the_socket_of_a_killed_run_is_replaced",
            ),
        ]),
    ),
    requirement(
        15,
        "a D-Bus interface fails closed",
        Tests(&[("tests/outputs/tray/mod.rs", "the_menu_refuses_another_user")]),
    ),
    requirement(
        16,
        "the systemd unit is a sandbox",
        Partly(
            &[(
                "tests/cli/doctor.rs",
                "the_unit_the_launcher_and_the_rules_pass_their_validators",
            )],
            "DevicePolicy= and IPAddressDeny= do not apply to user units",
        ),
    ),
    requirement(
        17,
        "files start no program and follow no path",
        Tests(&[
            (
                "tests/architecture/main.rs",
                "only_the_watchdog_and_its_call_of_systemd_are_ever_started",
            ),
            (
                "tests/architecture/main.rs",
                "no_file_of_a_user_reads_the_environment",
            ),
        ]),
    ),
    requirement(
        18,
        "typed text is in no message, and recordings are private",
        Tests(&[
            ("tests/cli/files.rs", "messages_do_not_contain_typed_text"),
            (
                "tests/cli/practice.rs",
                "the_simulated_hand_types_the_text_and_the_result_is_printed_and_kept",
            ),
            (
                "tests/cli/files.rs",
                "a_replay_of_a_recorded_run_gives_its_transcript",
            ),
            (
                "tests/cli/control.rs",
                "a_client_without_a_subscription_receives_no_events",
            ),
            (
                "crates/runtime/src/output/tests.rs",
                "a_transcript_is_readable_by_its_owner_only",
            ),
        ]),
    ),
    requirement(
        19,
        "files with secrets are private",
        Tests(&[
            (TOKEN_TESTS, "files_that_others_can_read_are_refused"),
            (FUZZING, "tokens_are_read_or_refused"),
            (
                TOKEN_TESTS,
                "a_token_is_made_once_listed_without_its_secret_and_revoked",
            ),
            (
                "crates/runtime/src/network/secure/token.rs",
                "tokens_differ_and_are_not_printed",
            ),
            (
                GATEKEEPER_TESTS,
                "a_client_with_a_token_receives_data_with_its_role_until_the_token_is_revoked",
            ),
        ]),
    ),
    requirement(
        20,
        "a replay types only on request",
        Tests(&[
            (
                "tests/cli/security/replays.rs",
                "a_replay_presses_nothing_unless_the_output_desktop_is_named",
            ),
            (
                "tests/cli/security/recordings.rs",
                "system_chords_of_a_replay_need_the_permission_of_the_person_who_replays_it",
            ),
        ]),
    ),
    requirement(
        21,
        "all dependencies are known",
        Partly(
            &[(
                "tests/architecture/packages.rs",
                "all_dependencies_come_from_the_registry_with_a_checksum",
            )],
            "the tests have no network and check no advisories",
        ),
    ),
    requirement(
        22,
        "memory is safe",
        Tests(&[(
            "tests/architecture/main.rs",
            "the_program_contains_no_unsafe_code_but_what_is_listed",
        )]),
    ),
];
