//! The cameras of this machine, as Linux lists them. Other systems list none.

use std::fs;
use std::path::{Path, PathBuf};

use ademan_core::message::escape;

/// The list of cameras of Linux.
const LIST: &str = "/sys/class/video4linux";

/// The folder of the devices.
const DEVICES: &str = "/dev";

/// The prefix of the name of each device, before its number.
const PREFIX: &str = "video";

/// The command that tracks a hand with a camera.
const COMMAND: &str = "ademan webcam";

/// The largest number of entries of the list that are read.
const MAX_ENTRIES: usize = 256;

/// A camera that is connected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Camera {
    /// The number of its device.
    pub number: u32,
    /// The path of its device.
    pub path: PathBuf,
    /// The name that its maker gave it; may be empty.
    pub name: String,
}

impl Camera {
    /// Returns the command that tracks a hand with this camera.
    pub fn command(&self) -> String {
        match self.number {
            0 => COMMAND.to_owned(),
            number => format!("{COMMAND} --camera {number}"),
        }
    }
}

/// Returns the cameras, in the order of their numbers, without opening one. Devices of a camera that carry data about its images
/// and no images are left out.
pub fn cameras() -> Vec<Camera> {
    cameras_in(Path::new(LIST), Path::new(DEVICES))
}

fn cameras_in(list: &Path, devices: &Path) -> Vec<Camera> {
    let Ok(entries) = fs::read_dir(list) else {
        return Vec::new();
    };
    let entries = entries.flatten().take(MAX_ENTRIES);
    let found = entries.filter_map(|entry| {
        let file_name = entry.file_name();
        let number = file_name.to_str()?.strip_prefix(PREFIX)?.parse().ok()?;
        let path = devices.join(&file_name);
        let text = |name: &str| fs::read_to_string(entry.path().join(name)).ok();
        // Devices with a higher index carry data about the images. Drivers of old cameras give no index.
        let is_first = text("index").is_none_or(|index| index.trim() == "0");
        (is_first && path.exists()).then(|| Camera {
            number,
            path,
            name: escape(text("name").unwrap_or_default().trim()).into_owned(),
        })
    });
    let mut found: Vec<Camera> = found.collect();
    found.sort_by_key(|camera| camera.number);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_device_of_each_camera_is_listed_with_its_name_and_command() {
        let folder = tempfile::tempdir().unwrap();
        let (list, devices) = (folder.path().join("list"), folder.path().join("dev"));
        fs::create_dir(&devices).unwrap();
        let add = |name: &str, index: &str, maker: &str| {
            fs::create_dir_all(list.join(name)).unwrap();
            fs::write(list.join(name).join("index"), index).unwrap();
            fs::write(list.join(name).join("name"), maker).unwrap();
            fs::write(devices.join(name), "").unwrap();
        };
        add("video10", "0\n", "Desk camera\u{1b}[2J\n");
        add("video1", "1\n", "Built-in camera\n");
        add("video0", "0\n", "Built-in camera\n");
        add("v4l-subdev0", "0\n", "Part of a camera\n");
        add("video3", "0\n", "Unplugged\n");
        fs::remove_file(devices.join("video3")).unwrap();
        let found = cameras_in(&list, &devices);
        let shown = found.iter().map(|it| (it.name.as_str(), it.command()));
        assert_eq!(
            shown.collect::<Vec<_>>(),
            [
                ("Built-in camera", "ademan webcam".to_owned()),
                (
                    found[1].name.as_str(),
                    "ademan webcam --camera 10".to_owned()
                ),
            ]
        );
        assert_eq!(found[0].path, devices.join("video0"));
        assert!(found[1].name.starts_with("Desk camera"));
        assert!(!found[1].name.contains('\u{1b}'), "{:?}", found[1].name);
    }

    #[test]
    fn a_system_without_the_list_has_no_cameras() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(cameras_in(&folder.path().join("no"), folder.path()), []);
    }
}
