//! `ademan bridge webcam`: hands and bodies in the images of a camera, in Python with MediaPipe.

use std::ffi::{OsStr, OsString};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use ademan::files;
use ademan::message::{escape_path, shell_word};

use crate::failure::Failure;

/// The bridge of the webcam, in Python.
const WEBCAM: &str = include_str!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/examples/bridges/mediapipe_webcam.py"
));

/// The first line of the bridge when it is run: Python looks for modules in the working folder first, where a stranger's files may be.
const WITHOUT_WORKING_FOLDER: &str =
    "import sys; sys.path[:] = [folder for folder in sys.path if folder]\n";

/// The model of the hand landmarker, which is looked for if none is named.
const HAND_MODEL: &str = "hand_landmarker.task";

/// The place of the models.
const MODELS: &str = "https://ai.google.dev/edge/mediapipe/solutions/vision/";

/// Hands and bodies in the images of a camera, found by MediaPipe: lines for `protocol=hand-landmarks` and others
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan bridge webcam > webcam.py\n  ademan bridge webcam --run | ademan run --source 'stdin:?protocol=hand-landmarks' --layout webcam-mouse\n  ademan bridge webcam --run --model holistic_landmarker.task --camera film.mp4\n\nIt runs with your Python, with the packages mediapipe and opencv-python. `ademan webcam` starts it and `ademan run` together."
)]
pub struct Args {
    /// Run it: lines of JSON on standard output
    #[arg(long)]
    run: bool,
    #[command(flatten)]
    camera: CameraArgs,
}

/// The input of the bridge of the webcam.
#[derive(Clone, clap::Args)]
pub struct CameraArgs {
    /// Model file of MediaPipe: hand_landmarker.task, pose_landmarker.task for the arms, or holistic_landmarker.task for both. The
    /// default is hand_landmarker.task in this folder or the configuration folder
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Number or path of the camera, or a film or photo. The default is 0
    #[arg(long, value_name = "CAMERA")]
    camera: Option<OsString>,
    /// Play results of MediaPipe from a JSON file in place of a camera
    #[arg(long, value_name = "FILE", conflicts_with_all = ["model", "camera"])]
    results: Option<PathBuf>,
    /// Python that has the packages mediapipe and opencv-python
    #[arg(long, value_name = "PROGRAM", default_value = "python3")]
    python: OsString,
}

/// A kind of model: the name of its file, the option of the script, and the protocol of its lines.
struct Model {
    name: &'static str,
    option: Option<&'static str>,
    protocol: &'static str,
}

const KINDS: [Model; 3] = [
    Model {
        name: "hand_landmarker",
        option: None,
        protocol: "hand-landmarks",
    },
    Model {
        name: "holistic_landmarker",
        option: Some("--holistic"),
        protocol: "holistic",
    },
    Model {
        name: "pose_landmarker",
        option: Some("--body"),
        protocol: "body-landmarks",
    },
];

impl Model {
    /// Returns the kind of a file by its name, and the kind of hands for any other name.
    fn of(file: &Path) -> &'static Self {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let first_word = |kind: &&Self| {
            kind.name
                .split('_')
                .next()
                .is_some_and(|it| name.contains(it))
        };
        KINDS.iter().find(first_word).unwrap_or(&KINDS[0])
    }
}

pub fn run(args: &Args) -> Result<(), Failure> {
    if !args.run {
        return Ok(io::stdout().lock().write_all(WEBCAM.as_bytes())?);
    }
    let mut command = args.camera.command()?;
    let status = command
        .status()
        .map_err(|error| args.camera.no_python(&error))?;
    if status.success() {
        Ok(())
    } else {
        Err(Failure::job(
            "the bridge of the webcam has failed; its message is above",
        ))
    }
}

impl CameraArgs {
    /// Returns the protocol of the lines of the bridge.
    pub fn protocol(&self) -> &'static str {
        let model = self.model.as_deref();
        model.map_or(KINDS[0].protocol, |file| Model::of(file).protocol)
    }

    /// Returns the command that runs the bridge. Fails without a model or a file.
    pub fn command(&self) -> Result<Command, Failure> {
        let mut command = Command::new(&self.python);
        let script = format!("{WITHOUT_WORKING_FOLDER}{WEBCAM}");
        command.args(["-c", &script]).stdin(Stdio::null());
        if let Some(results) = &self.results {
            require(results)?;
            command.arg("--from").arg(results);
            return Ok(command);
        }
        let model = self.model()?;
        command.args(Model::of(&model).option).arg(&model);
        let camera = self.camera.as_deref().unwrap_or(OsStr::new("0"));
        command.arg("--camera").arg(camera);
        Ok(command)
    }

    /// Returns the error of a Python that does not start.
    pub fn no_python(&self, error: &io::Error) -> Failure {
        Failure::job(format!(
            "cannot start {}: {error}; install Python 3, or name it with `--python`",
            shell_word(&self.python.to_string_lossy())
        ))
    }

    fn model(&self) -> Result<PathBuf, Failure> {
        let in_this_folder = || Some(PathBuf::from(HAND_MODEL)).filter(|path| path.is_file());
        let named = self.model.clone().filter(|path| path.is_file());
        let found = match &self.model {
            Some(_) => named,
            None => in_this_folder().or_else(|| files::in_config_folder(HAND_MODEL)),
        };
        found.ok_or_else(|| {
            let missing = self.model.as_deref().unwrap_or(Path::new(HAND_MODEL));
            let kind = Model::of(missing).name;
            Failure::wrong_use(format!(
                "there is no model file {}: download {kind}.task from {MODELS}{kind} into this folder or the configuration \
                 folder (~/.config/ademan on Linux), or name its path with `--model`",
                escape_path(missing)
            ))
        })
    }
}

fn require(file: &Path) -> Result<(), Failure> {
    if file.is_file() {
        Ok(())
    } else {
        Err(Failure::wrong_use(format!(
            "there is no file {}: name results of MediaPipe with `--results`",
            escape_path(file)
        )))
    }
}
