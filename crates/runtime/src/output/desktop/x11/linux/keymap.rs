//! The keymap of an X server with the state of its modifiers, and changes of single keys.

use x11rb::connection::Connection;
use x11rb::errors::ReplyError;
use x11rb::protocol::xkb::{ConnectionExt as _, ID, KeySymMap, SetMapAux, SetMapFlags, VMod};
use x11rb::protocol::xproto::{ConnectionExt as _, KeyButMask};
use x11rb::rust_connection::RustConnection;

use crate::output::character_key::CharacterKey;
use ademan_core::device::KeyCode;

/// Keysym of a key without a meaning.
pub const NO_SYMBOL: u32 = 0;

/// The key code whose event code in the kernel is 0. Receivers ignore it.
const RESERVED_CODE: u8 = 8;

/// The only version of the extension XKB.
const XKB_VERSION: (u16, u16) = (1, 0);

/// The predefined key type ALPHABETIC: of its two levels, Shift and Lock choose the second, and no other modifier has an
/// effect. A receiver converts no letter of such a key to upper case, as it would under Caps Lock with the type TWO_LEVEL.
const ALPHABETIC: u8 = 2;

/// Keysym of Num Lock.
const NUM_LOCK: u32 = 0xff7f;
/// Keysyms of Control. Keys with it are shortcuts.
const CONTROL: [u32; 2] = [0xffe3, 0xffe4];
/// Keysyms of Meta, Alt, Super and Hyper, left and right. Keys with them are shortcuts.
const META_TO_HYPER: [u32; 8] = [
    0xffe7, 0xffe8, 0xffe9, 0xffea, 0xffeb, 0xffec, 0xffed, 0xffee,
];

/// Bits of the group in the state of the keyboard.
const GROUP: u16 = 0b11 << 13;
/// Bits of the eight modifiers in the state of the keyboard.
const MODIFIERS: u16 = 0xff;

/// The keymap at one time.
#[derive(Debug)]
pub struct Keymap {
    /// The first key code.
    first: u8,
    keysyms: Vec<u32>,
    keysyms_per_key: usize,
    /// The keys of each of the eight modifiers.
    modifier_keys: Vec<u8>,
    /// The effective modifiers and the effective group.
    state: u16,
    /// A bit for each key code.
    pressed: [u8; 32],
}

impl Keymap {
    /// Reads the keymap and the state of the keyboard.
    pub fn read(server: &RustConnection, root: u32) -> Result<Self, ReplyError> {
        let setup = server.setup();
        let (first, count) = (setup.min_keycode, key_count(server));
        let keymap = server.get_keyboard_mapping(first, count)?;
        let modifiers = server.get_modifier_mapping()?;
        let pressed = server.query_keymap()?;
        let pointer = server.query_pointer(root)?;
        let keymap = keymap.reply()?;
        Ok(Self {
            first,
            keysyms_per_key: usize::from(keymap.keysyms_per_keycode).max(1),
            keysyms: keymap.keysyms,
            modifier_keys: modifiers.reply()?.keycodes,
            pressed: pressed.reply()?.keys,
            state: pointer.reply()?.mask.into(),
        })
    }

    /// Returns the keys that are not used: they have no keysym, and this program presses none of them, as it may press F24 without a
    /// keysym.
    pub fn unused_codes(&self) -> impl Iterator<Item = u8> {
        let is_unused = |(code, keysyms): &(u8, &[u32])| {
            *code != RESERVED_CODE
                && KeyCode::from_x11_code(*code).is_none()
                && keysyms.iter().all(|keysym| *keysym == NO_SYMBOL)
        };
        self.keys().filter(is_unused).map(|(code, _)| code)
    }

    /// Returns a key that is not pressed and types this keysym while no modifier is active and the first group is.
    pub fn unmodified_key(&self, keysym: u32) -> Option<u8> {
        let types = |(code, keysyms): (u8, &[u32])| {
            let is_free = !is_pressed(&self.pressed, code);
            (keysyms.first() == Some(&keysym) && is_free).then_some(code)
        };
        self.keys().find_map(types)
    }

    /// Returns `true` if a key still has only the keysym that this program has assigned to it.
    pub fn has(&self, key: CharacterKey) -> bool {
        let index = usize::from(key.code.wrapping_sub(self.first));
        let mut keysyms = self.keysyms.chunks(self.keysyms_per_key);
        keysyms
            .nth(index)
            .is_some_and(|keysyms| has_only(keysyms, key.keysym))
    }

    /// Returns `true` if no modifier but Num Lock and no group but the first is active.
    pub fn is_unmodified(&self) -> bool {
        let num_lock = self.modifiers_with(&[NUM_LOCK]);
        self.state & (GROUP | MODIFIERS & !num_lock) == 0
    }

    /// Returns `true` if Control, Alt, Meta, Super or Hyper is active: with it a key is a shortcut.
    pub fn is_shortcut(&self) -> bool {
        let control = u16::from(KeyButMask::CONTROL) | self.modifiers_with(&CONTROL);
        self.state & (control | self.modifiers_with(&META_TO_HYPER)) != 0
    }

    /// Returns the bits of the modifiers that have a key with one of these keysyms.
    fn modifiers_with(&self, keysyms: &[u32]) -> u16 {
        let has = |code: &u8| {
            let mut keys = self.keys();
            keys.any(|(other, of_key)| {
                other == *code && of_key.iter().any(|keysym| keysyms.contains(keysym))
            })
        };
        let keys_per_modifier = (self.modifier_keys.len() / 8).max(1);
        let modifiers = self.modifier_keys.chunks(keys_per_modifier).enumerate();
        let with = modifiers.filter(|(_, codes)| codes.iter().any(has));
        with.map(|(index, _)| 1 << index).sum()
    }

    fn keys(&self) -> impl Iterator<Item = (u8, &[u32])> {
        (self.first..=u8::MAX).zip(self.keysyms.chunks(self.keysyms_per_key))
    }
}

/// Returns `true` if a key is pressed in a state of the keyboard, which has a bit for each code.
pub fn is_pressed(keyboard: &[u8; 32], code: u8) -> bool {
    keyboard[usize::from(code / 8)] >> (code % 8) & 1 == 1
}

/// Enables the extension XKB for a connection. Returns `false` if the server does not have it.
pub fn enable_xkb(server: &RustConnection) -> bool {
    let (major, minor) = XKB_VERSION;
    let reply = server.xkb_use_extension(major, minor);
    reply.is_ok_and(|reply| reply.reply().is_ok_and(|reply| reply.supported))
}

/// Assigns a keysym to a key, in all groups and levels, and waits until the server has done so.
pub fn assign(server: &RustConnection, key: CharacterKey) -> Result<(), ReplyError> {
    let one_group = 1;
    set_keysyms(server, key.code, one_group, vec![key.keysym; 2])
}

/// Removes the keysym that this program has assigned to a key, unless the key has another one by now.
pub fn remove(server: &RustConnection, key: CharacterKey) -> Result<(), ReplyError> {
    let keymap = server.get_keyboard_mapping(key.code, 1)?.reply()?;
    if !has_only(&keymap.keysyms, key.keysym) {
        return Ok(());
    }
    let no_group = 0;
    set_keysyms(server, key.code, no_group, Vec::new())
}

/// Returns `true` if a key has this keysym and no other. A server may repeat it or fill up with [`NO_SYMBOL`].
fn has_only(keysyms: &[u32], keysym: u32) -> bool {
    let (assigned, others) = keysyms.split_at(keysyms.len().min(2));
    let is_filling = |other: &u32| [keysym, NO_SYMBOL].contains(other);
    assigned == [keysym; 2] && others.iter().all(is_filling)
}

fn key_count(server: &RustConnection) -> u8 {
    let setup = server.setup();
    setup.max_keycode - setup.min_keycode + 1
}

fn set_keysyms(
    server: &RustConnection,
    code: u8,
    group_info: u8,
    syms: Vec<u32>,
) -> Result<(), ReplyError> {
    let setup = server.setup();
    let total = syms.len() as u16;
    let keysyms = KeySymMap {
        kt_index: [ALPHABETIC; 4],
        group_info,
        width: syms.len() as u8,
        syms,
    };
    let change = server.xkb_set_map(
        ID::USE_CORE_KBD.into(),
        SetMapFlags::default(),
        setup.min_keycode,
        setup.max_keycode,
        // No types.
        0,
        0,
        // The keysyms of one key.
        code,
        1,
        total,
        // No actions, behaviors, explicit components, and modifiers.
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        VMod::default(),
        &SetMapAux::new().syms(vec![keysyms]),
    )?;
    change.check()
}

#[cfg(test)]
pub mod tests {
    use super::*;

    pub const SHIFT: u16 = 1;
    pub const LOCK: u16 = 2;
    const CONTROL: u16 = 4;
    const ALT: u16 = 8;
    const NUM: u16 = 16;
    pub const SECOND_GROUP: u16 = 1 << 13;

    const FIRST: u8 = 8;
    /// The first unused key, after the last key that this program can press.
    pub const UNUSED: u8 = 203;
    /// Keysym of F35.
    const F35: u32 = 0xffe0;

    /// Returns a keymap of `a`, Control, Alt and Num Lock, of other keys that are used, and of unused keys.
    pub fn keymap(unused: usize, state: u16) -> Keymap {
        let keys = [
            [0, 0],
            [0x61, 0x41],
            [0xffe3, 0],
            [0xffe9, 0xffe7],
            [NUM_LOCK, 0],
        ];
        let mut keysyms = keys.concat();
        keysyms.resize(2 * usize::from(UNUSED - FIRST), F35);
        keysyms.extend(vec![NO_SYMBOL; 2 * unused]);
        Keymap {
            first: FIRST,
            keysyms,
            keysyms_per_key: 2,
            modifier_keys: vec![0, 0, 10, 11, 12, 0, 0, 0],
            state,
            pressed: [0; 32],
        }
    }

    #[test]
    fn the_state_tells_plain_keys_from_modified_keys_and_shortcuts() {
        // State, whether it is unmodified, and whether keys are shortcuts.
        let table = [
            (0, true, false),
            (NUM, true, false),
            (SHIFT, false, false),
            (LOCK | NUM, false, false),
            (SECOND_GROUP, false, false),
            (CONTROL, false, true),
            (ALT | SHIFT, false, true),
            // A modifier without a key that is known, such as AltGr.
            (128, false, false),
            // A pressed button.
            (256, true, false),
        ];
        for (state, is_unmodified, is_shortcut) in table {
            let keymap = keymap(0, state);
            let actual = (keymap.is_unmodified(), keymap.is_shortcut());
            assert_eq!(actual, (is_unmodified, is_shortcut), "{state:#x}");
        }
    }

    #[test]
    fn a_pressed_key_is_not_used_for_a_character() {
        let mut keymap = keymap(2, 0);
        assert_eq!(keymap.unmodified_key(0x61), Some(9));
        keymap.pressed[1] = 1 << 1;
        assert_eq!(keymap.unmodified_key(0x61), None);
        let unused: Vec<u8> = keymap.unused_codes().collect();
        assert_eq!(unused, [UNUSED, UNUSED + 1]);
    }

    #[test]
    fn a_key_that_the_program_can_press_is_not_used_for_a_character_without_a_keysym_either() {
        let mut keymap = keymap(1, 0);
        let f24: KeyCode = "F24".parse().unwrap();
        let index = 2 * (usize::from(f24.x11_code()) - usize::from(FIRST));
        keymap.keysyms[index..index + 2].fill(NO_SYMBOL);
        assert_eq!(keymap.unused_codes().collect::<Vec<_>>(), [UNUSED]);
    }

    #[test]
    fn a_key_with_another_keysym_is_not_that_of_this_program() {
        let table = [
            (&[0xf1, 0xf1][..], true),
            (&[0xf1, 0xf1, 0xf1, 0xf1, 0, 0], true),
            (&[0xf1, 0xd1, 0xf1, 0xd1], false),
            (&[0xf1, 0xf1, 0x41], false),
            (&[0xf1, 0], false),
            (&[0, 0], false),
            (&[], false),
        ];
        for (keysyms, expected) in table {
            assert_eq!(has_only(keysyms, 0xf1), expected, "{keysyms:?}");
        }
    }
}
