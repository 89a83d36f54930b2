//! The files of this folder as text: layouts, gloves, arms, persons, and meshes of layouts.
//!
//! A crate of its own, because a published package contains only what lies in its folder, and the stages need the files without a disk.

/// Pairs each path (without `.ron`) with the text of the file.
macro_rules! files {
    ($($name:literal)+) => {
        &[$(($name, include_str!(concat!($name, ".ron")))),+]
    };
}

/// The path below `layouts/` without `.ron`, and the text, of each file.
pub const FILES: &[(&str, &str)] = files! {
    "arms/unam"
    "gloves/lucidgloves"
    "gloves/lucidgloves-left"
    "gloves/unam-hc11"
    "gloves/unam-hc11-left"
    "keyboards/arrows"
    "keyboards/azerty-flat"
    "keyboards/chords-bend"
    "keyboards/colemak-flat"
    "keyboards/dvorak-flat"
    "keyboards/number-entry"
    "keyboards/numpad"
    "keyboards/phone-pad"
    "keyboards/phone-words"
    "keyboards/qwerty-arc"
    "keyboards/qwerty-flat"
    "keyboards/qwerty-flat-22"
    "keyboards/qwerty-swipe"
    "keyboards/qwerty-two-arc"
    "keyboards/qwerty-two-flat"
    "keyboards/qwerty-words"
    "keyboards/qwertz-flat"
    "keyboards/spanish-flat"
    "keyboards/webcam-qwerty"
    "keyboards/wrist-remote"
    "panels/drum-pads"
    "panels/game"
    "panels/media"
    "panels/mixer"
    "panels/piano"
    "panels/radial"
    "panels/scroll-rings"
    "panels/steering-wheel"
    "panels/switches"
    "panels/touch-pad"
    "panels/workshop"
    "panels/xy-pad"
    "persons/adult"
    "persons/left-small"
    "pointers/arm-6dof"
    "pointers/arm-gamepad"
    "pointers/claws"
    "pointers/direct"
    "pointers/drive"
    "pointers/gestures"
    "pointers/joint"
    "pointers/lucidgloves-controller"
    "pointers/rate"
    "pointers/ray"
    "pointers/space"
    "pointers/webcam-mouse"
};

/// The name and the text of each mesh that a shipped layout draws.
pub const MESHES: &[(&str, &str)] = &[("claw.obj", include_str!("pointers/claw.obj"))];
