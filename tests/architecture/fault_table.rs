//! The table of faults, in the order of their numbers.

use crate::evidence::Coverage::{Missing, Partly, Tests};
use crate::evidence::{Row, row as fault};

const CHARACTERS: &str = "tests/outputs/x11/characters.rs";
const FLOODS: &str = "tests/cli/share/floods.rs";
const FORGED: &str = "tests/cli/faults/forged_messages.rs";
const GATEKEEPER: &str = "crates/runtime/src/network/secure/gatekeeper/tests.rs";
const NETWORK: &str = "tests/cli/network.rs";
const BURSTS: &str = "crates/runtime/src/output/desktop/tests/bursts.rs";
const STRANGERS: &str = "tests/cli/security/strangers.rs";

/// The faults, in the order of their numbers.
#[rustfmt::skip]
pub const FAULTS: &[Row] = &[
    // Capture, serial.
    fault(1, "port absent at start", Tests(&[
        ("tests/cli/wrong_use.rs", "invalid_sources_are_refused_with_a_remedy"),
        ("tests/capture/serial.rs", "an_absent_port_is_reported_with_the_present_ones"),
        ("tests/cli/signals.rs", "a_run_waits_for_a_device_and_reports_it_once"),
        ("crates/runtime/src/capture/reconnect.rs", "the_interval_doubles_up_to_two_seconds"),
    ])),
    fault(2, "port in use by another program", Tests(&[
        ("tests/cli/faults/lines.rs", "a_second_run_on_the_same_port_is_refused_at_once_and_the_first_goes_on"),
        ("tests/capture/serial.rs", "a_port_in_use_is_reported"),
    ])),
    fault(3, "port without permission", Tests(&[
        ("tests/cli/faults/lines.rs", "a_port_without_permission_names_the_group_and_never_asks_for_root"),
        ("crates/runtime/src/advice.rs", "advice_never_suggests_root_or_open_permissions"),
    ])),
    fault(4, "the cable is pulled while a key is held", Tests(&[
        ("tests/outputs/x11/ends.rs", "all_keys_are_released_after_the_cable_is_pulled"),
        ("tests/outputs/x11/replug.rs", "after_a_reconnection_a_finger_on_a_key_presses_nothing_until_the_hand_is_clear_of_all_keys"),
        ("tests/capture/serial.rs", "a_loss_is_reported_right_after_the_last_reading"),
        ("tests/capture/lost_source.rs", "a_key_is_released_at_a_loss_and_not_pressed_until_the_finger_has_left_it"),
        ("tests/outputs/vm/typing.rs", "pulling the cable releases all keys"),
    ])),
    fault(5, "unplugged, visible only as end of stream", Tests(&[
        ("crates/runtime/src/capture/stream/tests.rs", "each_end_of_a_live_stream_is_one_loss_and_reconnection_backs_off"),
        ("tests/capture/tcp.rs", "a_connection_that_breaks_inside_a_packet_is_lost_once_and_reconnected"),
    ])),
    fault(6, "unplugged, visible only as silence", Tests(&[
        ("tests/outputs/x11/ends.rs", "all_keys_are_released_after_the_glove_stops_sending"),
        ("tests/pipeline/arming.rs", "a_gap_longer_than_the_stall_timeout_releases_everything"),
    ])),
    fault(7, "plugged in again under another device name", Tests(&[
        ("tests/capture/serial.rs", "an_unplugged_glove_is_lost_once_and_followed_to_its_next_terminal"),
        ("crates/runtime/src/capture/transport/usb_port.rs", "a_lost_device_is_chosen_by_identity"),
        ("tests/outputs/vm/typing.rs", "after a reconnection at another port the glove types again"),
    ])),
    fault(8, "another device under the old name", Tests(&[
        ("crates/runtime/src/capture/transport/serial.rs", "another_device_and_ambiguous_devices_are_rejected_by_name"),
        ("crates/runtime/src/capture/transport/usb_port.rs", "a_lost_device_is_chosen_by_identity"),
        ("crates/runtime/src/capture/reconnect.rs", "each_reason_is_reported_once_in_a_row_until_the_connection_opens"),
        ("tests/outputs/vm/typing.rs", "after a reconnection at another port the glove types again"),
    ])),
    fault(9, "the first read starts in the middle of a packet", Tests(&[
        ("tests/pipeline/faulty_readings.rs", "a_stream_that_starts_inside_a_packet_types_the_same"),
    ])),
    fault(10, "one flipped bit", Tests(&[
        ("tests/pipeline/faulty_readings.rs", "one_flipped_bit_changes_no_event_and_costs_at_most_two_packets"),
        ("tests/pipeline/estimator.rs", "a_flipped_bit_in_one_reading_is_rejected"),
    ])),
    fault(11, "no delimiter, endless bytes", Tests(&[
        ("tests/cli/faults/lines.rs", "bytes_without_a_delimiter_need_no_memory_and_the_packets_after_them_are_decoded"),
        ("tests/capture/serial.rs", "packets_after_a_megabyte_of_noise_are_decoded"),
        ("crates/core/src/capture/protocol/hc11/tests.rs", "a_megabyte_of_noise_gives_no_packet_and_a_bounded_buffer"),
    ])),
    fault(12, "wrong baud", Tests(&[
        ("tests/cli/faults/lines.rs", "a_minute_of_noise_at_the_wrong_baud_types_nothing_is_reported_and_needs_no_memory"),
        ("tests/capture/serial.rs", "garbage_for_two_seconds_gives_one_warning"),
        ("tests/outputs/x11/ends.rs", "all_keys_are_released_when_the_glove_sends_noise"),
    ])),
    fault(13, "two packets in one read, one packet in twenty reads", Tests(&[
        ("crates/core/src/capture/protocol/hc11/tests.rs", "the_vectors_decode_alike_in_pieces_of_any_size"),
        ("tests/capture/serial.rs", "every_packet_arrives_at_9600_baud"),
        ("tests/capture/serial.rs", "every_packet_arrives_at_115200_baud"),
        ("crates/runtime/src/capture/stream/tests.rs", "readings_of_one_read_are_a_packet_period_apart"),
    ])),
    fault(14, "the microcontroller restarts in the middle of the stream", Tests(&[
        ("tests/cli/faults/lines.rs", "a_microcontroller_restart_releases_everything_and_disarms"),
        ("crates/core/src/capture/protocol/restart_text.rs", "lines_of_text_after_a_packet_are_one_restart"),
    ])),
    fault(15, "sequence numbers repeat or jump", Missing("no supported protocol has sequence numbers; times are row 20, and TLS checks its own order")),
    fault(16, "a sensor is railed", Tests(&[
        ("tests/pipeline/faulty_readings.rs", "a_railed_sensor_releases_the_key_of_its_finger_and_the_others_keep_typing"),
        ("tests/cli/faults/lines.rs", "a_broken_wire_is_reported_with_its_finger"),
        ("tests/pipeline/estimator.rs", "a_finger_with_a_broken_sensor_is_untrusted_after_one_second"),
        ("tests/pipeline/estimator.rs", "a_broken_wrist_sensor_makes_all_fingers_untrusted"),
    ])),
    fault(17, "closing a dead port blocks", Tests(&[
        ("crates/runtime/src/capture/stream/tests.rs", "a_port_that_blocks_while_closing_does_not_block_the_source"),
        ("crates/runtime/src/capture/thread/tests.rs", "dropping_leaves_a_blocked_thread_behind"),
    ])),
    fault(18, "interrupted and empty reads", Tests(&[
        ("crates/runtime/src/capture/stream/tests.rs", "interrupted_reads_and_timeouts_lose_nothing"),
    ])),
    // Capture, network and recordings.
    fault(19, "a datagram too short or too long", Tests(&[
        ("tests/capture/body_landmarks.rs", "datagrams_deliver_landmarks_and_those_too_short_or_too_long_are_skipped"),
        ("tests/capture/markers.rs", "a_datagram_holds_the_markers_of_all_cameras_and_a_cut_one_is_dropped"),
        ("tests/capture/network_poses.rs", "datagrams_of_opentrack_of_another_size_are_dropped"),
        ("tests/capture/text_line.rs", "udp_datagrams_deliver_angles_with_or_without_a_line_end"),
    ])),
    fault(20, "datagrams out of order, twice, lost", Partly(&[
        ("tests/pipeline/faulty_readings.rs", "lines_that_a_network_loses_doubles_and_reorders_add_no_press"),
        (
            "crates/core/src/capture/protocol/markers/tests.rs",
            "lines_that_are_late_or_come_twice_are_dropped_and_a_restarted_sender_is_accepted",
        ),
        ("crates/core/src/capture/protocol/joint_sets.rs", "invalid_lines_are_counted_by_reason"),
        ("crates/core/src/capture/protocol/text_line.rs", "a_line_may_state_its_time_and_one_that_is_repeated_or_no_number_is_refused"),
        ("crates/core/src/capture/protocol/imu/tests.rs", "lines_of_both_orders_separators_and_times_are_read"),
    ], "packets of opentrack and lines without a time have no order; datagrams come from this machine only")),
    fault(21, "a datagram of an unknown sender", Tests(&[
        ("tests/capture/network_poses.rs", "datagrams_of_another_sender_are_dropped_until_the_first_is_silent"),
    ])),
    fault(22, "a valid packet sent again", Tests(&[
        ("crates/runtime/src/network/secure/gatekeeper/tests.rs", "what_a_client_has_sent_admits_no_one_who_sends_it_again"),
    ])),
    fault(23, "half-open TCP connection", Tests(&[
        ("tests/capture/tcp.rs", "a_silent_peer_is_lost_after_five_seconds"),
        (
            "crates/runtime/src/capture/transport/websocket/receive.rs",
            "a_client_that_has_to_answer_is_asked_in_its_silence_and_then_given_up",
        ),
        ("tests/pipeline/arming.rs", "a_gap_longer_than_the_stall_timeout_releases_everything"),
    ])),
    fault(24, "one byte a second", Tests(&[
        ("tests/capture/websocket.rs", "a_second_client_and_one_that_sends_no_request_do_not_disturb_the_first"),
        ("crates/runtime/src/network/secure/gatekeeper/tests.rs", "silent_clients_are_closed_and_take_no_place_of_another_address"),
    ])),
    fault(25, "a length of 4 GiB", Tests(&[
        ("tests/cli/faults/files.rs", "a_length_of_four_gigabytes_is_refused_before_memory_is_allocated"),
        ("crates/recording/src/lengths.rs", "any_length_beyond_its_record_is_detected"),
    ])),
    fault(26, "a thousand connections", Tests(&[
        ("tests/cli/faults/clients.rs", "a_thousand_connections_end_and_the_first_client_is_served"),
        ("tests/cli/control.rs", "a_command_gets_through_sixteen_silent_clients"),
        ("tests/outputs/spacenav/mod.rs", "the_seventeenth_client_is_rejected"),
    ])),
    fault(27, "invalid UTF-8, NUL, byte order mark, CRLF", Tests(&[
        ("tests/cli/faults/files.rs", "invalid_utf8_is_refused_in_readings_and_files"),
        ("tests/cli/control.rs", "an_invalid_line_gets_an_error_and_the_connection_stays_open"),
    ])),
    fault(28, "JSON too deep, too long, or twice the same key", Tests(&[
        ("tests/cli/faults/files.rs", "json_that_is_too_deep_too_long_or_has_duplicate_keys_is_refused"),
        ("crates/core/src/command/tests.rs", "deeply_nested_json_is_refused"),
        ("crates/core/src/capture/protocol/body_landmarks.rs", "every_invalid_line_is_refused_with_its_reason"),
        ("crates/core/src/capture/protocol/body_landmarks.rs", "a_number_of_a_megabyte_is_skipped_in_bounded_memory"),
        ("tests/cli/control.rs", "an_invalid_line_gets_an_error_and_the_connection_stays_open"),
    ])),
    fault(29, "NaN, infinities and extreme numbers", Tests(&[
        ("tests/pipeline/faulty_readings.rs", "infinite_angles_are_rejected_and_the_third_in_a_row_releases_everything"),
        ("tests/cli/faults/files.rs", "numbers_that_no_sensor_can_measure_are_refused"),
        ("crates/core/src/capture/protocol/body_landmarks.rs", "every_invalid_line_is_refused_with_its_reason"),
        ("tests/files/layout_errors.rs", "a_wrong_number_on_a_board_has_its_position"),
    ])),
    fault(30, "angles outside their limits, missing channels", Tests(&[
        ("crates/core/src/estimate/limits.rs", "an_angle_slightly_outside_is_clamped_and_one_far_outside_is_rejected"),
        ("tests/pipeline/estimator.rs", "an_angle_slightly_outside_its_range_is_clamped_and_one_far_outside_rejects_the_reading"),
        ("tests/pipeline/estimator.rs", "readings_of_another_shape_are_rejected"),
        ("crates/core/src/capture/protocol/body_landmarks.rs", "every_invalid_line_is_refused_with_its_reason"),
        ("tests/pipeline/arming.rs", "rejected_readings_do_not_prevent_a_stall"),
    ])),
    fault(31, "landmarks that coincide", Tests(&[
        ("tests/pipeline/body_landmarks.rs", "landmarks_that_show_no_arm_are_rejected_with_their_reason"),
        ("crates/core/src/estimate/arm_attributes/tests.rs", "a_pose_without_a_plane_or_a_length_is_refused"),
        ("crates/core/src/estimate/t_pose.rs", "a_body_without_a_direction_is_refused_by_name"),
        (
            "crates/core/src/estimate/samples/joints.rs",
            "positions_that_are_not_finite_far_away_or_all_the_same_are_rejected",
        ),
    ])),
    fault(32, "the hand jumps to another position", Tests(&[
        ("tests/pipeline/faulty_readings.rs", "a_hand_that_jumps_to_and_fro_releases_at_the_third_reading_and_presses_nothing"),
        ("tests/pipeline/arming.rs", "a_jump_of_the_hand_releases_everything"),
        ("tests/pipeline/estimator.rs", "an_implausible_position_is_accepted_at_the_third_consistent_reading"),
    ])),
    fault(33, "a tracker confuses left and right", Tests(&[
        (
            "tests/pipeline/tracked_hands.rs",
            "a_tracker_that_exchanges_left_and_right_releases_both_hands_and_presses_nothing_until_they_leave_the_keys",
        ),
        (
            "crates/core/src/capture/protocol/hand_landmarks/tests.rs",
            "a_mirrored_image_and_labels_that_assume_one_give_the_same_hand",
        ),
    ])),
    fault(34, "the hand leaves the field of view", Tests(&[
        ("tests/pipeline/body_landmarks.rs", "an_arm_that_is_lost_releases_its_key_after_the_hold_time_and_the_other_hand_goes_on"),
        ("tests/pipeline/body_landmarks.rs", "an_arm_that_comes_back_on_its_key_presses_it_only_after_it_has_left_it"),
        (
            "tests/pipeline/tracked_hands.rs",
            "a_hand_that_is_not_seen_releases_its_key_after_the_hold_time_and_the_other_hand_goes_on",
        ),
        ("tests/pipeline/joint_positions.rs", "a_finger_that_leaves_the_view_for_two_readings_releases_its_key"),
        (
            "crates/core/src/estimate/samples/joints.rs",
            "a_hidden_tip_is_untrusted_and_a_hidden_elbow_distrusts_the_hand_after_200_ms",
        ),
    ])),
    fault(35, "the sender's clock jumps", Tests(&[
        ("tests/pipeline/faulty_readings.rs", "a_clock_that_jumps_or_stops_releases_everything_and_is_counted"),
        ("crates/runtime/src/capture/packet_clock.rs", "packets_of_one_read_are_dated_back_by_the_bytes_after_them"),
    ])),
    fault(36, "the wall clock is set back", Tests(&[
        ("tests/architecture/main.rs", "nothing_depends_on_the_wall_clock"),
    ])),
    fault(37, "a damaged recording", Tests(&[
        ("tests/cli/faults/files.rs", "a_damaged_recording_is_played_up_to_the_damage_releases_everything_and_ends_with_3"),
        ("tests/files/recordings.rs", "a_recording_cut_at_any_byte_gives_everything_but_its_last_second"),
        ("tests/files/recordings.rs", "every_flipped_bit_of_a_recording_is_detected"),
        ("tests/files/recordings.rs", "other_files_are_rejected_with_their_offset"),
        ("tests/files/recordings.rs", "an_endless_recording_is_read_in_pieces"),
    ])),
    fault(38, "a recording too fast, or with a gap of a year", Tests(&[
        ("tests/pipeline/faulty_readings.rs", "a_million_readings_a_second_stay_within_the_press_rate_limit"),
        ("crates/runtime/src/capture/pace.rs", "a_gap_of_a_year_takes_two_seconds"),
        ("tests/pipeline/arming.rs", "a_stall_by_clock_and_by_time_stamps_gives_the_same_events"),
    ])),
    // Pipeline, configuration, process.
    fault(39, "a layout file that cannot be read", Tests(&[
        ("tests/files/layout_errors.rs", "an_unreadable_file_reports_the_reason"),
        ("tests/files/layout_errors.rs", "a_file_has_at_most_one_mebibyte"),
        ("tests/files/layout_errors.rs", "an_endless_file_is_not_read"),
        ("tests/cli/wrong_use.rs", "wrong_names_are_refused_with_the_valid_ones"),
    ])),
    fault(40, "a syntax error, an unknown field, a wrong type", Tests(&[
        ("tests/files/layout_errors.rs", "a_syntax_error_has_its_position"),
        ("tests/files/layout_errors.rs", "a_wrong_missing_or_duplicate_field_has_its_position"),
        ("tests/cli/wrong_use.rs", "errors_in_a_setup_name_the_file_and_the_position"),
        ("tests/cli/wrong_use.rs", "all_layouts_are_checked_even_after_an_invalid_one"),
    ])),
    fault(41, "nesting 200 deep", Tests(&[
        ("tests/files/layout_errors.rs", "nesting_of_200_levels_is_an_error_and_not_a_crash"),
    ])),
    fault(42, "duplicate names, overlapping keys, sizes of zero or NaN", Tests(&[
        ("tests/files/layout_errors.rs", "a_duplicate_or_overlapping_key_has_its_position"),
        ("tests/pipeline/panels/handle_errors.rs", "controls_that_overlap_or_share_a_name_are_refused"),
        ("crates/core/src/layout/outline.rs", "touching_edges_do_not_overlap_and_a_tenth_of_a_millimetre_does"),
    ])),
    fault(43, "an unknown key, or a forbidden one", Tests(&[
        ("tests/files/layout_errors.rs", "an_unknown_name_on_a_board_has_its_position"),
        ("tests/pipeline/limits.rs", "system_keys_need_the_permission_of_the_setup"),
    ])),
    fault(44, "a bad file is saved while a key is held", Tests(&[
        ("tests/cli/reload.rs", "an_invalid_file_is_reported_with_its_position_and_keys_stay_pressed"),
    ])),
    fault(45, "a good file is saved while a key is held", Tests(&[
        ("tests/cli/reload.rs", "saving_the_layout_releases_keys_and_activates_it"),
        ("tests/pipeline/arming.rs", "a_new_layout_releases_everything_and_a_finger_in_a_key_must_leave_it"),
    ])),
    fault(46, "a file is saved a hundred times in a second", Tests(&[
        ("tests/cli/reload.rs", "after_a_hundred_saves_in_a_second_the_last_is_active_and_no_key_is_stuck"),
        ("crates/runtime/src/session/reload/mod.rs", "of_many_fast_saves_the_last_is_activated_and_few_others"),
        ("tests/pipeline/arming.rs", "a_hundred_new_layouts_release_a_pressed_key_once"),
    ])),
    fault(47, "a panic in any thread", Tests(&[
        ("tests/outputs/x11/panics.rs", "all_keys_are_released_after_a_panic_of_the_source"),
        ("tests/outputs/x11/panics.rs", "all_keys_are_released_after_a_panic_of_a_device"),
        ("tests/outputs/x11/panics.rs", "all_keys_are_released_after_a_panic_of_the_observer"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "a_panic_of_the_connection_releases_all_keys"),
        ("src/bin/ademan/panics.rs", "a_panic_of_a_detached_thread_stops_the_program_and_is_a_failure"),
    ])),
    fault(48, "a panic while panicking, a poisoned lock", Tests(&[
        ("tests/outputs/x11/watchdog.rs", "all_keys_are_released_after_an_abort"),
        ("tests/outputs/x11/watchdog.rs", "all_keys_are_released_after_a_crash"),
        ("tests/architecture/main.rs", "a_poisoned_lock_is_used_all_the_same"),
    ])),
    fault(49, "termination signals, and a second Ctrl-C", Tests(&[
        ("tests/outputs/x11/ends.rs", "all_keys_are_released_after_ctrl_c"),
        ("tests/outputs/x11/ends.rs", "all_keys_are_released_after_sigterm"),
        ("tests/outputs/x11/ends.rs", "all_keys_are_released_after_the_terminal_is_closed"),
        ("tests/outputs/x11/ends.rs", "all_keys_are_released_after_ctrl_c_twice"),
        ("tests/outputs/x11/ends.rs", "all_keys_are_released_after_two_signals_at_once"),
    ])),
    fault(50, "killed, or out of memory", Tests(&[
        ("tests/outputs/x11/watchdog.rs", "all_keys_are_released_after_a_kill"),
        ("tests/outputs/x11/watchdog.rs", "no_key_stays_pressed_after_a_kill_while_a_character_is_typed"),
        ("tests/outputs/x11/memory.rs", "all_keys_are_released_after_the_out_of_memory_killer"),
        ("tests/outputs/vm/typing.rs", "after SIGKILL all keys are released and the device is removed"),
    ])),
    fault(51, "stopped by a signal and continued", Tests(&[
        ("tests/outputs/x11/watchdog.rs", "all_keys_are_released_while_the_program_is_stopped_and_it_must_be_armed_again"),
        ("tests/outputs/wayland/ends.rs", "all_keys_are_released_while_the_program_is_stopped_and_it_types_again_afterwards"),
        ("tests/outputs/vm/typing.rs", "the watchdog releases uinput keys of a stopped program"),
        ("tests/capture/statistics.rs", "readings_from_before_a_stop_of_the_program_press_nothing_and_are_counted"),
        ("tests/capture/statistics.rs", "readings_that_have_waited_for_longer_than_the_stall_timeout_are_dropped"),
    ])),
    fault(52, "stopped from the terminal (Ctrl-Z)", Tests(&[
        ("tests/outputs/x11/watchdog.rs", "ctrl_z_releases_keys_before_the_stop_and_the_hand_must_leave_them_after_it"),
    ])),
    fault(53, "the watchdog is killed", Tests(&[
        ("tests/outputs/x11/lost_watchdog.rs", "a_killed_watchdog_is_restarted_once_and_the_run_pauses"),
        ("crates/runtime/src/output/uinput/linux/tests/watchdog.rs", "when_the_watchdog_is_lost_keys_are_released_and_none_is_pressed_until_it_has_restarted"),
    ])),
    fault(54, "the system is suspended while a key is held", Partly(&[
        ("crates/runtime/src/capture/thread/tests.rs", "a_suspend_is_a_loss_of_a_live_source_before_the_next_reading"),
        ("crates/runtime/src/capture/suspend/linux.rs", "a_suspend_is_reported_once"),
        ("tests/capture/lost_source.rs", "a_key_is_released_at_a_loss_and_not_pressed_until_the_finger_has_left_it"),
        ("tests/pipeline/arming.rs", "after_a_stall_the_hand_must_be_clear_of_every_key"),
    ], "no test suspends a machine: a simulated clock runs ahead, as after a suspend")),
    fault(55, "no uinput, or no permission for it", Tests(&[
        ("tests/cli/faults/disks.rs", "uinput_without_a_device_node_or_permission_is_refused_with_a_remedy"),
        ("crates/runtime/src/output/uinput/linux/tests/mod.rs", "an_open_error_contains_the_remedy"),
    ])),
    fault(56, "the system accepts no more events", Tests(&[
        ("crates/runtime/src/output/uinput/linux/tests/mod.rs", "a_report_is_tried_four_times_and_a_failed_release_is_repeated_on_closing"),
        ("crates/runtime/src/output/uinput/linux/tests/mod.rs", "a_failed_press_is_released_as_it_may_have_arrived"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "a_call_that_fails_three_times_is_repeated"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "after_a_failure_nothing_is_pressed_and_keys_that_may_be_pressed_are_released"),
        ("tests/outputs/x11/ends.rs", "a_dead_display_ends_the_run_with_an_error_at_the_next_key"),
        ("tests/outputs/x11/sink.rs", "a_dead_server_is_an_error"),
    ])),
    fault(57, "two sessions at once", Tests(&[
        ("tests/cli/control.rs", "a_second_run_is_refused_and_the_socket_of_a_killed_run_is_replaced"),
        ("tests/cli/faults/lines.rs", "a_second_run_on_the_same_port_is_refused_at_once_and_the_first_goes_on"),
        ("crates/runtime/src/output/socket/linux.rs", "a_socket_in_use_is_an_error_and_that_of_a_dead_process_is_replaced"),
    ])),
    fault(58, "the queue to the output is full", Tests(&[
        ("crates/runtime/src/output/desktop/tests/mod.rs", "a_full_queue_drops_presses_but_no_release"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "a_full_queue_coalesces_motion_and_drops_no_release"),
    ])),
    fault(59, "a client of the joint-angle server stops reading", Tests(&[
        ("crates/runtime/src/share/hub/tests.rs", "a_client_that_reads_nothing_is_disconnected_and_the_others_are_served"),
        ("crates/runtime/src/share/hub/tests.rs", "a_client_that_sends_is_disconnected"),
        ("crates/runtime/src/share/client.rs", "a_client_that_reads_late_is_told_how_many_lines_it_has_missed"),
        ("crates/runtime/src/share/outbox.rs", "a_slow_client_loses_whole_lines_and_never_the_one_that_was_begun"),
    ])),
    fault(60, "disk full, log closed", Tests(&[
        ("tests/cli/faults/disks.rs", "a_full_closed_or_missing_log_does_not_stop_a_session"),
        ("tests/cli/faults/disks.rs", "a_log_that_the_disk_has_no_room_for_is_reported_once_and_the_session_goes_on"),
        ("tests/cli/faults/disks.rs", "a_disk_that_fills_under_a_recording_ends_the_recording_and_not_the_typing"),
        ("tests/cli/bvh.rs", "a_full_disk_leaves_a_whole_file_and_the_typing_goes_on"),
        ("tests/cli/faults/disks.rs", "a_transcript_that_cannot_be_written_ends_the_session_with_the_reason"),
        ("tests/cli/signals.rs", "a_run_continues_when_its_standard_error_is_closed"),
    ])),
    // Found by attack.
    fault(61, "another client grabs the X server around a press, or the server is frozen, then the program dies", Tests(&[
        ("tests/outputs/x11/grabs.rs", "no_key_stays_pressed_if_the_program_is_killed_after_a_press_during_a_grab"),
        ("tests/outputs/x11/grabs.rs", "no_key_stays_pressed_if_the_program_is_killed_after_a_press_while_the_server_hangs"),
        ("crates/runtime/src/output/watchdog_process/release_thread.rs", "a_press_that_the_display_executes_after_the_release_is_released_too"),
        ("crates/runtime/src/output/watchdog_process/release_thread.rs", "a_key_is_released_at_every_fault_until_the_client_reports_its_release"),
        ("crates/runtime/src/output/watchdog_process/linux/client_state.rs", "a_key_and_an_axis_stay_in_the_record_until_the_client_reports_their_release"),
    ])),
    fault(62, "a grab of another client while a key is down", Tests(&[
        ("tests/outputs/x11/grabs.rs", "a_release_passes_the_grab_of_another_client"),
    ])),
    fault(63, "standard error or output is full and nobody reads", Tests(&[
        ("tests/outputs/x11/blocked_streams.rs", "a_key_is_released_when_the_finger_lifts_or_the_cable_is_pulled_and_the_run_ends_on_one_signal"),
        ("tests/outputs/spacenav/mod.rs", "a_lever_returns_to_its_center_while_nobody_reads_the_standard_streams"),
        ("tests/cli/faults/blocked_streams.rs", "a_run_with_full_streams_executes_commands_and_ends_in_order_on_one_signal"),
        ("tests/outputs/vm/killed.rs", "pulling the cable releases uinput keys while standard error is full"),
        ("crates/runtime/src/output/transcript/thread.rs", "a_dropping_transcript_never_waits_and_writes_the_count_and_the_releases_later"),
        ("src/bin/ademan/messages/queue.rs", "a_reader_that_reads_nothing_blocks_nobody_and_gets_the_count_later"),
    ])),
    fault(64, "program and watchdog killed in the same instant", Tests(&[
        ("tests/outputs/x11/both_killed.rs", "keys_of_a_run_that_was_killed_with_its_watchdog_are_released_by_the_command_of_the_unit"),
        ("tests/outputs/x11/both_killed.rs", "keys_of_a_run_that_was_killed_with_its_watchdog_are_released_by_the_next_run"),
        ("crates/runtime/src/output/pressed_key_file/linux.rs", "keys_are_abandoned_when_the_lock_ends_and_only_on_their_display"),
        ("tests/outputs/vm/service.rs", "keys_are_released_when_systemd_kills_the_unit"),
        ("tests/outputs/x11/service_manager.rs", "a_service_manager_that_does_not_reply_delays_neither_a_press_nor_a_release"),
        ("tests/outputs/vm/killed.rs", "the kernel releases uinput keys when both processes are killed"),
    ])),
    fault(65, "SIGUSR1, or any signal but KILL and STOP, to all processes of the program", Tests(&[
        ("tests/outputs/x11/watchdog.rs", "sigusr1_to_all_processes_is_an_emergency_stop_as_often_as_it_is_sent"),
        ("tests/outputs/x11/watchdog.rs", "no_signal_but_kill_and_stop_ends_or_stops_the_watchdog"),
        ("tests/outputs/x11/watchdog.rs", "signals_without_a_use_have_no_effect"),
    ])),
    fault(66, "the watchdog is stopped by a signal", Tests(&[
        ("tests/outputs/x11/lost_watchdog.rs", "a_stopped_watchdog_is_noticed_and_replaced"),
        ("tests/outputs/vm/killed.rs", "the program releases uinput keys when its watchdog is stopped"),
        ("crates/runtime/src/output/uinput/linux/tests/watchdog.rs", "a_watchdog_that_does_not_reply_is_replaced_after_keys_are_released"),
    ])),
    fault(67, "a busy machine", Partly(&[
        ("tests/outputs/x11/priority.rs", "the_loop_the_output_and_the_watchdog_have_the_priority_that_the_doctor_reports"),
        ("tests/cli/process_limits.rs", "the_doctor_reports_the_priority_that_the_system_permits"),
    ], "the time to the release: `cargo bench --bench release -- busy` measures it")),
    fault(68, "a pause, a stall or a lost watchdog while presses are queued", Tests(&[
        ("tests/outputs/x11/grabs.rs", "presses_that_wait_for_a_server_that_hangs_are_not_sent_after_a_pause"),
        ("tests/outputs/x11/grabs.rs", "presses_that_a_server_accepts_too_late_are_dropped_and_reported_once"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "void_presses_and_their_releases_are_not_sent_and_later_presses_are"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "a_press_that_has_waited_too_long_is_not_sent"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "a_press_is_not_sent_if_it_becomes_void_while_the_display_does_not_respond"),
        ("tests/outputs/x11/sink.rs", "a_press_that_a_server_has_not_read_in_time_is_revoked_while_it_hangs"),
        ("tests/outputs/x11/sink.rs", "a_press_that_becomes_void_while_a_server_hangs_is_revoked_at_once"),
        ("crates/runtime/src/output/desktop/tests/direct.rs", "what_was_written_together_with_a_revoked_press_is_revoked_too"),
        ("tests/outputs/x11/bursts.rs", "the_wheel_does_not_turn_after_a_pause_while_a_server_hangs"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "the_wheel_does_not_turn_if_that_becomes_void_while_the_display_does_not_respond"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "motion_without_room_in_the_queue_is_not_sent_after_a_pause"),
    ])),
    fault(69, "a system chord in any order, by any controls", Tests(&[
        ("crates/core/src/pipeline/output_gate/tests.rs", "a_system_chord_is_never_down_in_any_order_of_its_keys"),
        ("crates/core/src/pipeline/output_gate/tests.rs", "keys_released_early_are_released_once_and_before_all_presses_of_the_step"),
        ("tests/outputs/x11/system_chords.rs", "switches_in_any_order_leave_control_and_alt_pressed_but_not_delete"),
        ("tests/fuzzing/main.rs", "the_pipeline_keeps_its_invariants"),
    ])),
    fault(70, "a pause from outside, then the pause key of the layout", Tests(&[
        ("tests/pipeline/pauses.rs", "a_pause_key_ends_the_pause_of_the_layout_and_no_pause_from_outside"),
        ("tests/pipeline/pauses.rs", "a_source_that_may_only_point_ends_no_pause_from_outside"),
        ("tests/pipeline/pauses.rs", "presses_beyond_the_rate_limit_pause_until_a_command_from_outside"),
        ("tests/cli/roles.rs", "a_source_on_the_network_ends_its_own_pause_but_no_pause_by_a_command"),
    ])),
    fault(71, "a recording with a gap, replayed to a real output", Tests(&[
        ("tests/capture/gap.rs", "a_key_is_released_in_the_gap_of_a_paced_replay_with_the_time_of_the_stall"),
        ("tests/cli/determinism/gap.rs", "a_recording_with_a_gap_gives_the_same_bytes_at_any_speed"),
        ("tests/outputs/x11/gap.rs", "the_transcript_of_a_replay_with_a_gap_agrees_with_the_display"),
        ("crates/runtime/src/capture/pace.rs", "the_clock_passes_through_a_gap_and_stays_before_the_next_reading"),
    ])),
    fault(72, "a peer that causes messages", Tests(&[
        ("tests/cli/faults/message_floods.rs", "text_between_packets_causes_one_message_in_ten_seconds_and_a_count"),
        ("crates/runtime/src/message_limits.rs", "one_message_per_key_and_interval_is_sent_and_the_others_are_counted"),
        ("crates/runtime/src/message_limits.rs", "ever_new_sources_share_a_bounded_number_of_counters"),
    ])),
    fault(73, "a recording of a stranger with permissions, limits and paths", Tests(&[
        ("tests/cli/security/recordings.rs", "no_file_is_opened_because_a_recording_names_it"),
        ("tests/cli/security/recordings.rs", "a_replay_neither_writes_nor_reads_the_layout_file_that_a_recording_names"),
        ("tests/cli/security/recordings.rs", "system_chords_of_a_replay_need_the_permission_of_the_person_who_replays_it"),
        ("tests/cli/security/recordings.rs", "a_layout_with_system_keys_is_refused_for_an_output_that_types"),
        ("crates/runtime/src/setup/recorded.rs", "permissions_are_those_of_the_person_and_never_those_of_the_recording"),
    ])),
    fault(74, "escape sequences and line breaks in names from files and peers", Tests(&[
        ("tests/cli/faults/names.rs", "names_of_layouts_files_and_sources_are_printed_escaped"),
        ("tests/cli/faults/names.rs", "the_answers_of_a_session_are_printed_escaped"),
        ("crates/core/src/message/escape.rs", "a_text_becomes_one_line_that_cannot_act_on_a_terminal"),
        ("crates/core/src/document/error.rs", "names_messages_and_excerpts_contain_no_escape_codes"),
    ])),
    fault(75, "an existing transcript: another owner, a symbolic link, mode 0666", Tests(&[
        ("tests/cli/security/files.rs", "an_existing_transcript_becomes_private_and_links_and_files_of_others_are_refused"),
        ("tests/cli/security/files.rs", "a_layout_of_another_user_is_not_saved"),
        ("crates/runtime/src/files/tests.rs", "an_existing_file_becomes_private_before_it_is_written"),
    ])),
    fault(76, "a FIFO, device or folder as an input file; a foreign control server; silent clients", Tests(&[
        ("tests/cli/security/files.rs", "a_pipe_or_a_device_is_refused_as_any_file"),
        ("tests/cli/security/files.rs", "a_transcript_is_not_written_to_a_pipe_that_somebody_reads"),
        ("tests/cli/security/files.rs", "a_server_of_another_user_gets_no_command"),
        ("tests/cli/control.rs", "a_command_gets_through_sixteen_silent_clients"),
    ])),
    fault(77, "the program file is replaced; the process limit is reached at the start", Tests(&[
        ("tests/outputs/x11/lost_watchdog.rs", "the_watchdog_is_replaced_when_the_file_of_the_program_has_changed"),
        ("tests/cli/process_limits.rs", "a_program_that_may_start_few_threads_ends_with_a_remedy_and_not_with_a_panic"),
    ])),
    fault(78, "a glove with feedback does not read, is lost, or holds a finger when the session stops", Tests(&[
        ("tests/cli/haptics/mod.rs", "a_glove_that_never_reads_delays_no_key_and_no_end"),
        ("tests/cli/haptics/mod.rs", "all_fingers_are_free_after_every_way_to_stop"),
        ("tests/cli/haptics/mod.rs", "a_glove_that_comes_back_is_freed_and_held_again"),
        ("tests/cli/haptics/mod.rs", "a_finger_is_not_held_for_more_than_two_seconds"),
        ("tests/capture/haptics.rs", "a_panic_of_the_session_frees_all_fingers"),
    ])),
    fault(79, "a congested network delays readings by seconds", Tests(&[
        ("tests/capture/late_readings.rs", "readings_that_the_network_held_back_are_dropped_and_counted_and_later_ones_pass"),
        ("tests/cli/zenoh.rs", "a_hand_behind_a_congested_router_types_nothing_until_its_readings_are_young_again"),
        ("crates/runtime/src/capture/sender_clock.rs", "readings_of_a_growing_delay_are_too_old_beyond_the_limit_and_young_ones_pass_again"),
        ("crates/runtime/src/capture/sender_clock.rs", "a_clock_that_jumps_is_followed_at_once_or_after_ten_seconds"),
    ])),

    // Network, files and parsers, found by attack.
    fault(80, "a setup or layout of a stranger names output paths or other files", Tests(&[
        (STRANGERS, "a_setup_names_no_file_that_exists_for_its_transcript"),
        (STRANGERS, "a_transcript_of_a_setup_is_a_new_private_file_in_a_folder_of_its_own"),
        (STRANGERS, "names_in_a_transcript_start_no_program_in_a_shell"),
        (STRANGERS, "files_in_a_setup_are_relative_to_it_and_never_to_the_working_folder"),
        ("crates/runtime/src/output/transcript/line.rs", "names_and_characters_mean_nothing_to_a_shell"),
        ("crates/runtime/src/output/socket/linux.rs", "a_file_beside_a_socket_with_content_or_for_others_is_no_lock_and_stays"),
    ])),
    fault(81, "a WebSocket client floods frames that are not requests", Tests(&[
        (FLOODS, "a_client_that_floods_frames_is_disconnected_and_the_others_are_served"),
        (FLOODS, "a_run_under_floods_ends_by_the_command_stop_and_with_its_source"),
        (FLOODS, "an_unsolicited_pong_does_not_disconnect_a_client"),
        ("tests/capture/websocket.rs", "a_flood_of_frames_that_are_no_messages_ends_the_connection"),
        ("tests/outputs/chaos/mod.rs", "run_under_attack_leaves_no_key_pressed_and_presses_nothing_after_a_pause"),
    ])),
    fault(82, "a bare name in a shared folder; files of other users", Tests(&[
        (STRANGERS, "a_name_never_means_a_file_in_the_working_folder"),
        (STRANGERS, "a_file_with_the_path_of_a_shipped_one_is_not_followed"),
        (STRANGERS, "files_that_others_may_write_or_replace_are_refused"),
        (STRANGERS, "files_of_other_users_and_of_foreign_groups_are_refused"),
        (STRANGERS, "a_link_leads_to_a_file_that_others_may_not_replace"),
        (STRANGERS, "a_layout_that_another_user_edits_is_not_activated"),
    ])),
    fault(83, "connections that close at once, stay idle or send half a handshake", Tests(&[
        (FLOODS, "connections_that_close_at_once_leave_their_places_and_descriptors"),
        (FLOODS, "a_command_gets_through_while_clients_take_all_descriptors"),
        ("crates/runtime/src/share/hub/tests.rs", "the_client_that_has_been_silent_for_the_longest_time_makes_room_for_another"),
        ("crates/runtime/src/share/client.rs", "a_client_that_asks_for_nothing_in_time_is_told_the_reason_and_disconnected"),
    ])),
    fault(84, "token operations side by side, on a full disk, killed in between", Tests(&[
        (NETWORK, "tokens_that_are_revoked_beside_commands_that_make_others_stay_revoked"),
        (NETWORK, "a_token_command_that_is_killed_leaves_nothing_that_stops_the_next_one"),
        (NETWORK, "on_a_full_disk_a_token_is_not_said_to_be_revoked_and_is_revoked_once_there_is_room"),
    ])),
    fault(85, "a small recording that expands or keeps many setup texts", Tests(&[
        ("tests/files/recordings.rs", "setup_texts_that_expand_come_late_or_repeat_a_kind_take_no_memory"),
        ("tests/files/recordings.rs", "setup_texts_beyond_the_limits_are_refused"),
    ])),
    fault(86, "names with shell characters in completions", Tests(&[
        ("tests/cli/completion.rs", "bash_quotes_the_names_that_it_inserts"),
        ("tests/cli/completion.rs", "fish_quotes_the_names_that_it_inserts"),
        ("tests/cli/completion.rs", "zsh_quotes_the_names_that_it_inserts"),
        ("tests/cli/completion.rs", "no_shell_offers_a_name_that_a_terminal_acts_on"),
    ])),
    fault(87, "line breaks, control and bidirectional characters in any name, in any message", Tests(&[
        (FORGED, "no_command_prints_a_forged_line_of_a_name"),
        (FORGED, "lists_print_names_of_files_escaped"),
        (FORGED, "variables_and_the_name_of_the_program_forge_no_line"),
        (FORGED, "pictures_of_a_layout_contain_no_character_that_reverses_text"),
        (FORGED, "a_session_prints_names_of_its_layouts_and_profiles_escaped"),
        (FORGED, "a_recording_prints_names_of_its_layouts_escaped"),
        ("tests/architecture/main.rs", "a_path_becomes_part_of_a_message_by_being_escaped"),
    ])),
    fault(88, "a recording states the packet period of a run", Tests(&[
        ("tests/cli/determinism/gap.rs", "a_run_of_a_recording_keeps_the_stall_limit_of_the_setup_whatever_period_the_recording_states"),
        ("tests/capture/gap.rs", "a_key_is_released_while_the_disk_of_a_recording_hangs"),
        ("tests/files/recordings.rs", "times_of_a_recording_never_decrease"),
    ])),
    fault(89, "datagrams that are no packets, silent clients, guesses between valid tokens", Tests(&[
        ("tests/cli/senders.rs", "empty_datagrams_and_junk_lock_no_glove_out"),
        ("tests/cli/senders.rs", "a_datagram_of_a_second_sender_is_in_the_state_while_the_first_is_silent_and_in_the_last_line"),
        ("tests/capture/network_poses.rs", "datagrams_that_are_no_packets_keep_no_sender_out"),
        ("tests/capture/network_poses.rs", "no_frame_is_made_of_the_datagrams_of_two_senders"),
        ("tests/capture/websocket.rs", "clients_that_say_nothing_keep_no_other_client_out"),
        ("tests/capture/websocket.rs", "messages_that_are_no_packets_keep_no_other_client_out"),
        (GATEKEEPER, "silent_clients_of_many_addresses_keep_no_client_out"),
        (GATEKEEPER, "a_valid_token_resets_no_count_of_wrong_ones"),
    ])),
    fault(90, "IPv6 forms of IPv4 addresses", Tests(&[
        ("crates/runtime/src/network/address.rs", "other_machines_need_tls_and_an_address_of_one_network"),
        ("crates/runtime/src/network/address.rs", "only_addresses_of_this_machine_are_read_as_such_in_their_shortest_form"),
        ("crates/runtime/src/share/target.rs", "a_target_is_a_format_and_a_loopback_address"),
        (NETWORK, "servers_without_tls_a_token_or_an_address_of_one_network_do_not_start"),
    ])),
    fault(91, "root, records of other users and links, in every command", Tests(&[
        ("tests/cli/doctor.rs", "root_is_refused_without_allow_root_but_may_use_other_commands"),
        ("crates/runtime/src/output/pressed_key_file/linux.rs", "a_record_that_another_user_may_have_written_is_ignored"),
        (STRANGERS, "manual_pages_and_pictures_replace_files_but_are_not_written_through_links"),
    ])),
    fault(92, "words of megabytes, and request targets of other servers", Tests(&[
        (FORGED, "no_command_prints_a_line_of_a_long_word"),
        ("crates/core/src/message/escape.rs", "a_megabyte_becomes_the_start_of_a_line"),
        ("crates/runtime/src/capture/transport/websocket/admission.rs", "only_a_path_of_this_server_is_a_request_target"),
        ("tests/cli/share/websocket.rs", "only_the_pages_of_this_address_are_served_and_only_to_it"),
    ])),
    fault(93, "recipes of the guides that open a port", Tests(&[
        ("tests/cli/roles.rs", "a_recipe_of_the_guides_that_listens_names_one_address_and_the_role_of_a_pointer"),
    ])),

    // Runtime and outputs.
    fault(94, "a press is dropped, or the watchdog releases a key, while the layout holds a lock", Tests(&[
        ("tests/outputs/x11/output_stalls.rs", "no_bare_key_follows_a_lock_that_the_server_has_not_executed"),
        ("tests/outputs/x11/output_stalls.rs", "no_bare_key_follows_a_lock_that_the_watchdog_has_released"),
        ("crates/runtime/src/output/desktop/tests/mod.rs", "after_a_dropped_press_nothing_is_pressed_until_the_loop_has_noticed"),
        ("crates/runtime/src/output/uinput/linux/tests/watchdog.rs", "no_key_is_pressed_beside_one_that_the_watchdog_may_have_released"),
    ])),
    fault(95, "the keymap changes while characters are typed; a death after characters", Tests(&[
        (CHARACTERS, "a_keymap_that_the_user_changes_after_a_text_stays_unchanged"),
        (CHARACTERS, "the_watchdog_of_a_killed_run_removes_its_keys_from_the_keymap"),
        (CHARACTERS, "keys_in_the_keymap_of_a_run_that_was_killed_with_its_watchdog_are_removed_by_the_command_of_the_unit"),
        (CHARACTERS, "a_keymap_that_the_user_has_changed_since_a_run_was_killed_stays_unchanged"),
        (CHARACTERS, "without_an_unused_key_a_foreign_character_is_dropped_and_the_run_goes_on"),
    ])),
    fault(96, "Caps Lock, a second group or held modifiers while characters are typed", Tests(&[
        (CHARACTERS, "characters_arrive_under_caps_lock"),
        (CHARACTERS, "characters_arrive_with_the_second_group_of_a_keymap"),
        (CHARACTERS, "characters_arrive_with_a_held_shift"),
        (CHARACTERS, "with_a_held_control_or_alt_characters_are_dropped"),
    ])),
    fault(97, "a receiver that reads the keymap late; few spare keys", Tests(&[
        (CHARACTERS, "a_receiver_that_reads_the_keymap_late_reads_the_right_characters"),
        (CHARACTERS, "a_text_that_needs_more_keys_than_the_keymap_has_unused_is_dropped_entirely"),
        (BURSTS, "a_text_is_typed_entirely_or_dropped_entirely_and_is_no_failure"),
    ])),
    fault(98, "the output file exists", Tests(&[
        (STRANGERS, "no_command_writes_to_a_file_that_exists_or_through_a_link"),
        ("crates/runtime/src/files/tests.rs", "a_new_file_replaces_none_and_is_not_created_through_a_link"),
    ])),
    fault(99, "the disk fills during a recording", Tests(&[
        ("tests/cli/faults/disks.rs", "a_disk_that_fills_is_reported_at_once_and_in_the_state_while_the_typing_goes_on"),
        ("tests/outputs/x11/blocked_streams.rs", "a_transcript_on_a_full_disk_is_reported_and_the_desktop_continues"),
    ])),
    fault(100, "the watchdog is stopped while nothing is pressed", Tests(&[
        ("tests/outputs/x11/idle.rs", "a_watchdog_that_is_stopped_while_nothing_is_pressed_is_noticed_and_replaced"),
        ("tests/outputs/x11/idle.rs", "no_key_is_pressed_while_the_watchdog_is_stopped"),
    ])),
    fault(101, "all processes of the program's name are killed at once", Tests(&[
        ("tests/outputs/x11/watchdog.rs", "a_kill_of_all_processes_with_the_name_of_the_program_leaves_the_watchdog"),
    ])),
    fault(102, "an inherited signal mask, and ignored signals", Tests(&[
        ("tests/outputs/x11/watchdog.rs", "signals_that_the_parent_has_blocked_stop_the_typing_and_the_program"),
        ("tests/cli/signals.rs", "a_run_that_is_started_by_nohup_ignores_a_hangup_and_no_other_signal"),
    ])),
    fault(103, "other spellings of one display; a full runtime folder", Tests(&[
        ("tests/outputs/x11/both_killed.rs", "keys_of_a_killed_run_are_released_however_the_display_is_spelled"),
        ("tests/outputs/x11/both_killed.rs", "keys_of_a_killed_run_on_another_display_are_reported"),
        ("tests/outputs/x11/both_killed.rs", "a_runtime_folder_that_accepts_no_record_is_reported"),
    ])),
    fault(104, "the desktop is lost while nothing is pressed", Tests(&[
        ("tests/outputs/x11/idle.rs", "the_death_of_the_server_while_nothing_is_pressed_ends_the_run"),
        ("tests/outputs/x11/idle.rs", "the_death_of_the_server_while_no_reading_arrives_ends_the_run"),
    ])),
    fault(105, "one hand floods", Tests(&[
        ("crates/runtime/src/capture/event_queue.rs", "a_hand_that_floods_the_queue_displaces_no_reading_of_the_other"),
        ("crates/runtime/src/capture/merge/tests.rs", "no_two_live_readings_of_a_hand_have_the_same_time_although_the_other_hand_overtakes_it"),
        ("crates/runtime/src/capture/merge/tests.rs", "a_slow_consumer_receives_every_reading_of_a_hand_beside_one_that_floods"),
        ("tests/pipeline/hands_and_profiles.rs", "a_hand_beyond_the_rate_limit_touches_nothing_until_it_is_resumed_and_the_other_types"),
    ])),
    fault(106, "SIGTSTP and SIGCONT in a row; files that are replaced or left", Tests(&[
        ("tests/cli/signals.rs", "a_run_that_is_continued_before_it_has_stopped_goes_on"),
        ("crates/runtime/src/files/tests.rs", "a_replaced_file_keeps_its_group_mode_attributes_and_access_list"),
        ("crates/runtime/src/output/socket/linux.rs", "a_socket_that_is_closed_or_refused_leaves_no_file_behind"),
    ])),
    fault(107, "a display cannot type a text to which a Backspace or an Enter belongs", Tests(&[
        ("tests/outputs/x11/bursts.rs", "no_enter_follows_a_text_that_a_held_control_would_make_a_shortcut"),
        ("tests/outputs/x11/bursts.rs", "a_correction_that_the_keymap_cannot_type_deletes_nothing"),
        (BURSTS, "a_correction_is_executed_entirely_or_not_at_all"),
        (BURSTS, "a_key_after_a_text_that_cannot_be_typed_is_not_sent"),
    ])),
    fault(108, "a display is slow, or a pause comes, while a correction is typed", Tests(&[
        ("tests/outputs/x11/bursts.rs", "a_correction_on_a_slow_display_arrives_entirely_or_not_at_all"),
        (BURSTS, "a_correction_that_becomes_void_while_the_display_does_not_respond_deletes_nothing"),
        (BURSTS, "the_keys_of_a_burst_that_failed_are_released_at_the_end"),
        ("crates/runtime/src/output/desktop/tests/reports.rs", "the_keys_of_a_burst_are_reported_before_and_after_it"),
    ])),
    fault(109, "another window gets the focus before a correction", Tests(&[
        ("tests/outputs/x11/bursts.rs", "a_correction_does_not_reach_the_window_that_got_the_focus"),
        ("tests/outputs/x11/bursts.rs", "the_text_field_is_another_one_when_another_window_has_the_focus"),
        (BURSTS, "a_correction_does_not_reach_another_window"),
        (BURSTS, "an_idle_thread_notices_that_another_window_has_the_focus"),
    ])),
    fault(110, "another keyboard or mouse is pressed before a correction", Tests(&[
        ("tests/outputs/x11/other_devices.rs", "a_correction_deletes_nothing_that_another_keyboard_has_typed"),
        ("tests/outputs/x11/other_devices.rs", "a_correction_deletes_nothing_after_a_click_of_another_mouse"),
        ("tests/outputs/x11/other_devices.rs", "a_modifier_of_another_keyboard_drops_a_correction"),
        (BURSTS, "a_correction_deletes_nothing_after_a_press_of_another_device"),
        (BURSTS, "an_idle_thread_notices_a_press_of_another_device"),
    ])),
    fault(111, "a tracker repeats its last positions, also while keys are held, then measures the hand elsewhere", Tests(&[
        ("crates/core/src/estimate/repeated_positions.rs", "a_hand_that_is_elsewhere_after_its_positions_were_repeated_has_jumped"),
        ("tests/pipeline/repeated_positions.rs", "a_finger_that_appears_inside_a_key_has_to_leave_it_if_its_positions_were_repeated"),
        ("tests/pipeline/repeated_positions.rs", "a_hand_that_types_while_its_tracker_repeats_positions_presses_no_other_keys"),
        ("tests/pipeline/other_hand.rs", "a_board_whose_hand_was_repeated_presses_no_finger_where_it_appears"),
        ("crates/core/src/estimate/repeated_positions.rs", "a_source_that_repeats_everything_for_more_than_5_s_is_stuck_until_something_changes"),
        ("crates/core/src/estimate/fusion.rs", "a_hand_of_two_sources_is_stuck_if_both_repeat_positions_and_none_is_a_glove"),
        ("tests/pipeline/repeated_positions.rs", "a_key_is_released_after_its_tracker_has_repeated_all_positions_for_5_s"),
        ("tests/pipeline/repeated_positions.rs", "only_the_keys_of_the_hand_that_is_stuck_are_released"),
        ("tests/pipeline/repeated_positions.rs", "a_hand_that_is_stuck_releases_all_that_it_holds_and_presses_nothing_until_it_has_left"),
        ("tests/pipeline/repeated_positions.rs", "a_pinch_that_drags_is_released_and_moves_nothing_when_its_tracker_is_stuck"),
        ("tests/pipeline/repeated_positions.rs", "a_glove_with_constant_counts_keeps_its_key"),
    ])),
];
