//! Recognition of network file systems on Linux.

use std::io;
use std::path::Path;

use rustix::fs::statfs;

/// Types of file systems that other machines or programs change without inotify events, as in `linux/magic.h`: 9p, AFS,
/// CephFS, CIFS, FUSE, NFS, SMB, SMB 2 and VirtualBox.
const REMOTE_TYPES: [u32; 9] = [
    0x0102_1997,
    0x5346_414f,
    0x00c3_6400,
    0xff53_4d42,
    0x6573_5546,
    0x0000_6969,
    0x0000_517b,
    0xfe53_4d42,
    0x786f_4256,
];

/// Returns `true` if every change in a directory causes an event.
pub(super) fn reports_remote_changes(directory: &Path) -> io::Result<bool> {
    let kind = statfs(directory)?.f_type as u32;
    Ok(!REMOTE_TYPES.contains(&kind))
}
