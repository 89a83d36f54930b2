//! The meshes of the shapes of a layout: read once when the layout becomes active, and drawn in the 3D view.

mod gltf_file;
mod mesh;
mod obj_file;

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use self::mesh::{MAX_TRIANGLES, TriangleMesh};
use ademan_core::document::{Document, shipped_mesh};
use ademan_core::layout::{Layout, Shape, arm_shapes};
use ademan_core::message::escape;
use ademan_runtime::files::{FileError, open_trusted};
use ademan_runtime::setup::LoadedSetup;

/// The largest file of a mesh, and of each of its buffers, in bytes: 4 MiB.
pub const MAX_FILE_BYTES: u64 = 4 << 20;

/// The reason why a mesh is not drawn.
#[derive(Debug, thiserror::Error)]
pub enum ShapeError {
    /// The file cannot be read.
    #[error("cannot read the file: {0}")]
    File(#[from] FileError),
    /// The layout or arm is data of a recording, and the mesh does not come with the program.
    #[error("a recording has no meshes, and no file is opened because it names one")]
    Recorded,
    /// There is no such file, or the layout is not a file.
    #[error("there is no such file beside the layout or arm")]
    NotFound,
    /// The file is a link that leads out of the folder of the layout.
    #[error("the file lies outside the folder of the layout or arm; copy it there")]
    Outside,
    /// The file is too large.
    #[error("the file is larger than 4 MiB; reduce the number of triangles")]
    TooLarge,
    /// The mesh has too many triangles.
    #[error("the mesh has {0} triangles, and at most {MAX_TRIANGLES} are drawn; reduce them")]
    TooManyTriangles(usize),
    /// The mesh has no triangle.
    #[error("the mesh has no triangle; export faces")]
    Empty,
    /// A coordinate is not finite, or an index has no vertex.
    #[error(
        "the mesh has a coordinate that is not a number, or a face without a corner; export it again"
    )]
    Broken,
    /// The content is not of the format that the name states.
    #[error("the file is not valid {format}: {reason}")]
    Invalid {
        /// The format.
        format: &'static str,
        /// The error of its reader.
        reason: String,
    },
}

/// The meshes of the active layout.
#[derive(Clone, Default)]
pub struct Shapes {
    /// `true` if layouts are data of a recording, whose names are no paths on this machine.
    is_recorded: bool,
    layout: Option<Arc<Layout>>,
    meshes: BTreeMap<String, Arc<TriangleMesh>>,
    errors: Vec<String>,
    limbs: Vec<(Shape, Arc<TriangleMesh>)>,
    limb_errors: Vec<String>,
}

impl Shapes {
    /// Creates an empty set of meshes for the layouts of a setup.
    pub fn for_setup(setup: &LoadedSetup) -> Self {
        Self {
            is_recorded: setup.has_recorded_layouts(),
            ..Self::default()
        }
    }

    /// Reads the meshes of a layout, unless it read them last. A mesh that cannot be read has an
    /// [error](Self::errors).
    pub fn update(&mut self, layout: &Arc<Layout>) {
        if self
            .layout
            .as_ref()
            .is_some_and(|it| Arc::ptr_eq(it, layout))
        {
            return;
        }
        self.layout = Some(Arc::clone(layout));
        self.meshes.clear();
        self.errors.clear();
        for (_, shape) in &layout.shapes {
            if self.meshes.contains_key(&shape.file) {
                continue;
            }
            let path = (!self.is_recorded).then_some(layout.file.as_str());
            match load(&layout.text, path, &shape.file) {
                Ok(mesh) => _ = self.meshes.insert(shape.file.clone(), Arc::new(mesh)),
                Err(error) => self.errors.push(message(&shape.file, &error)),
            }
        }
        self.errors.dedup();
    }

    /// Reads the meshes of an arm file, which replace the skin of the hands. Without any that can be read, the skin stays.
    pub fn set_arm(&mut self, document: &Document) {
        self.limbs.clear();
        self.limb_errors.clear();
        // A text that was read from no file came with the program or a recording.
        let path = document.path.as_ref().map(|_| document.file.as_str());
        for shape in arm_shapes(document).unwrap_or_default() {
            match load(&document.text, path, &shape.file) {
                Ok(mesh) => self.limbs.push((shape, Arc::new(mesh))),
                Err(error) => self.limb_errors.push(message(&shape.file, &error)),
            }
        }
    }

    /// Iterates over the meshes in place of the skin.
    pub fn limbs(&self) -> impl ExactSizeIterator<Item = (&Shape, &TriangleMesh)> {
        self.limbs.iter().map(|(shape, mesh)| (shape, &**mesh))
    }

    /// Returns the mesh of a file, or `None` if it could not be read.
    pub fn mesh(&self, file: &str) -> Option<&TriangleMesh> {
        self.meshes.get(file).map(Arc::as_ref)
    }

    /// Returns a message for each file that could not be read.
    pub fn errors(&self) -> impl Iterator<Item = &str> {
        let errors = self.errors.iter().chain(&self.limb_errors);
        errors.map(String::as_str)
    }
}

fn message(file: &str, error: &ShapeError) -> String {
    format!("cannot draw {}: {error}", escape(file))
}

/// Reads the mesh in a file beside the layout or arm with this text and path, which data of a recording do not have. For a layout that
/// comes with the program, that file does too.
pub fn load(text: &str, path: Option<&str>, file: &str) -> Result<TriangleMesh, ShapeError> {
    if let Some(text) = shipped_mesh(text, file) {
        return obj_file::read(text.as_bytes());
    }
    let path = Path::new(path.ok_or(ShapeError::Recorded)?);
    if !path.is_file() {
        return Err(ShapeError::NotFound);
    }
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let bytes = read_inside(folder, file)?;
    let end = file.rsplit_once('.').map_or("", |(_, end)| end);
    if end.eq_ignore_ascii_case("obj") {
        obj_file::read(&bytes)
    } else {
        let mesh_folder = folder.join(file);
        let mesh_folder = mesh_folder.parent().unwrap_or(folder);
        gltf_file::read(&bytes, &mut |buffer| {
            let below = mesh_folder.strip_prefix(folder).unwrap_or(Path::new(""));
            let name = name_inside(below, buffer).ok_or(ShapeError::Outside)?;
            read_inside(folder, &name)
        })
    }
}

/// Returns the path of a buffer of a mesh, whose folder is `below` the folder of the layout, in relation to that folder; `None` if it leads
/// out. Even to look whether such a file exists may contact another machine.
fn name_inside(below: &Path, buffer: &str) -> Option<String> {
    if buffer.starts_with('/') || buffer.contains(['\\', ':']) {
        return None;
    }
    let first = below.components().count();
    buffer
        .split('/')
        .try_fold(first, |depth, part| match part {
            ".." => depth.checked_sub(1),
            "" | "." => Some(depth),
            _ => Some(depth + 1),
        })?;
    Some(below.join(buffer).to_string_lossy().into_owned())
}

/// Reads a file in a folder or below it, also through links, if no other user may change it.
fn read_inside(folder: &Path, file: &str) -> Result<Vec<u8>, ShapeError> {
    let not_found = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => ShapeError::NotFound,
        _ => FileError::from(error).into(),
    };
    let folder = fs::canonicalize(folder).map_err(not_found)?;
    let path: PathBuf = fs::canonicalize(folder.join(file)).map_err(not_found)?;
    if !path.starts_with(&folder) {
        return Err(ShapeError::Outside);
    }
    let mut bytes = Vec::new();
    let opened = open_trusted(&path)?;
    let read = opened.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(FileError::from)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        Err(ShapeError::TooLarge)
    } else {
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests;
