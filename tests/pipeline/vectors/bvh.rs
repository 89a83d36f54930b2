use ademan::capture::bvh::{Bvh, Node, PositionChannels};
use serde_json::Value;

use super::check::{assert_close, list, number, numbers, text};

/// Checks structure and world positions of whole texts, and that damaged texts are refused.
pub fn files(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["absolute"]);
    let files = list(&file["files"]);
    for case in files {
        let name = text(&case["name"]);
        let bvh = Bvh::parse(text(&case["bvh"]).as_bytes());
        let bvh = bvh.unwrap_or_else(|error| panic!("{name}: {error}"));
        let motion = bvh.motion();
        assert_close(motion.frame_time, number(&case["frame_time"]), 1e-12, name);
        assert_eq!(
            Some(motion.frame_count),
            case["n_frames"].as_u64(),
            "{name}"
        );
        let nodes = list(&case["nodes"]);
        assert_eq!(motion.skeleton.nodes().len(), nodes.len(), "{name}");
        for (node, wanted) in motion.skeleton.nodes().iter().zip(nodes) {
            assert_node(node, wanted);
        }
        let frames = list(&case["positions"]);
        assert_eq!(frames.len() as u64, motion.frame_count, "{name}");
        for (frame, wanted) in frames.iter().enumerate() {
            let positions = bvh.positions(frame as u64, PositionChannels::Add);
            for (position, expected) in positions.iter().zip(list(wanted)) {
                for (ours, theirs) in position.to_array().iter().zip(numbers(expected)) {
                    assert_close(*ours, theirs, tolerance, name);
                }
            }
        }
    }
    let errors = list(&file["errors"]);
    for case in errors {
        let name = text(&case["name"]);
        match Bvh::parse(text(&case["bvh"]).as_bytes()) {
            Ok(_) => panic!("{name} is accepted"),
            Err(error) => assert!(error.line > 0, "{name}: {error}"),
        }
    }
    files.len() + errors.len()
}

fn assert_node(node: &Node, wanted: &Value) {
    assert_eq!(node.name.as_deref(), wanted["name"].as_str());
    assert_eq!(Some(node.name.is_none()), wanted["end_site"].as_bool());
    let parent = node.parent.map(|parent| parent as u64);
    assert_eq!(parent, wanted["parent"].as_u64());
    assert_eq!(node.offset.to_array()[..], numbers(&wanted["offset"]));
    let channels: Vec<&str> = node.channels.iter().map(|channel| channel.name()).collect();
    let wanted: Vec<&str> = list(&wanted["channels"]).iter().map(text).collect();
    assert_eq!(channels, wanted);
}
