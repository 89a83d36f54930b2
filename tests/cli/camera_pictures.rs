//! Marks in pictures of cameras, from the pictures to the joints of an arm.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use ademan::cameras::{Camera, CamerasFile, CamerasFormat};
use glam::{DMat3, DQuat, DVec2, DVec3};

#[cfg(target_os = "linux")]
use crate::support::process::{Process, signal};
#[cfg(target_os = "linux")]
use crate::support::x11::wait_for;
use crate::{Ended, ademan, file, run, run_to_end, text};

const SIZE: [usize; 2] = [480, 360];

/// Radius of every mark in pixels.
const RADIUS: f64 = 3.0;

const RED: [f64; 3] = [0.9, 0.1, 0.1];
const GREEN: [f64; 3] = [0.1, 0.85, 0.15];
const BLUE: [f64; 3] = [0.1, 0.15, 0.9];
const WHITE: [f64; 3] = [0.95; 3];

/// A mark in a picture.
type Disc = (DVec2, [f64; 3]);

/// Returns the bytes of a picture of discs over a background with noise. A pixel has the share of a disc that 64 of its points are in.
fn draw(size: [usize; 2], discs: &[Disc], random: &mut fastrand::Rng) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(3 * size[0] * size[1]);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let pixel = DVec2::new(x as f64, y as f64);
            let mut color = DVec3::splat(0.1);
            for (center, paint) in discs {
                if pixel.distance(*center) < RADIUS + 1.0 {
                    let covered = (0..64).filter(|index| {
                        let [right, down] =
                            [index % 8, index / 8].map(|it| (f64::from(it) - 3.5) / 8.0);
                        (pixel + DVec2::new(right, down)).distance(*center) < RADIUS
                    });
                    color = color.lerp(DVec3::from(*paint), covered.count() as f64 / 64.0);
                }
            }
            for value in color.to_array() {
                let noise = (random.f64() + random.f64() - 1.0) * 0.05;
                bytes.push(((value + noise) * 255.0).round().clamp(0.0, 255.0) as u8);
            }
        }
    }
    bytes
}

fn write_png(path: &Path, size: [usize; 2], discs: &[Disc], random: &mut fastrand::Rng) {
    let file = fs::File::create(path).unwrap();
    let mut encoder = png::Encoder::new(file, size[0] as u32, size[1] as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fastest);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&draw(size, discs, random)).unwrap();
    writer.finish().unwrap();
}

/// Writes the pictures of a camera, one for each list of discs, and returns their folder.
fn write_pictures(folder: &Path, name: &str, pictures: &[Vec<Disc>]) -> PathBuf {
    let folder = folder.join(name);
    fs::create_dir(&folder).unwrap();
    let mut random = fastrand::Rng::with_seed(name.bytes().map(u64::from).sum());
    for (index, discs) in pictures.iter().enumerate() {
        write_png(
            &folder.join(format!("{index}.png")),
            SIZE,
            discs,
            &mut random,
        );
    }
    folder
}

/// Cameras around a volume of one metre that look at its middle.
fn room() -> Vec<Camera> {
    let camera = |index: usize| {
        let (sine, cosine) = (0.4 + 0.9 * index as f64).sin_cos();
        let position = DVec3::new(2.2 * cosine, 0.9, 2.2 * sine);
        let z = -position.normalize();
        let x = DVec3::NEG_Y.cross(z).normalize();
        let rotation = DMat3::from_cols(x, z.cross(x), z).transpose();
        Camera {
            focal: DVec2::splat(520.0),
            distortion: [-0.08, 0.02, 0.0, 0.0],
            rotation: DQuat::from_mat3(&rotation),
            translation: -(rotation * position),
            ..Camera::new(format!("cam{index}"), DVec2::from(SIZE.map(|it| it as f64)))
        }
    };
    (0..3).map(camera).collect()
}

/// Returns what a camera sees of points with their colors.
fn seen(camera: &Camera, points: &[(DVec3, [f64; 3])]) -> Vec<Disc> {
    let disc = |(point, color): &(DVec3, [f64; 3])| Some((camera.project(*point)?.pixel, *color));
    points.iter().filter_map(disc).collect()
}

/// Shoulder, elbow and wrist of an arm that waves, at an instant from 0 to 1.
fn arm(t: f64) -> [DVec3; 3] {
    let shoulder = DVec3::new(0.0, 0.25, 0.0);
    let (raise, bend) = (0.4 + 0.8 * t, 0.5 + 1.2 * (3.0 * t).sin().abs());
    let upper = DVec3::new(raise.sin(), -raise.cos(), 0.2).normalize();
    let elbow = shoulder + 0.3 * upper;
    let turned = DQuat::from_axis_angle(DVec3::new(0.2, 0.3, 1.0).normalize(), bend);
    [shoulder, elbow, elbow + 0.25 * (turned * upper)]
}

fn arm_points(t: f64) -> Vec<(DVec3, [f64; 3])> {
    arm(t).into_iter().zip([RED, GREEN, BLUE]).collect()
}

const ARM_MARKS: [&str; 4] = [
    "--color",
    "red,green,blue",
    "--label",
    "RightArm,RightForeArm,RightHand",
];

/// Prints the lines of marks in pictures of cameras.
fn markers(folders: &[PathBuf], options: &[&str]) -> Ended {
    let folders = folders.iter().map(|folder| text(folder));
    let words = ["cameras", "markers"].into_iter().chain(folders);
    run(words.chain(options.iter().copied()))
}

/// Returns the positions of shoulder, elbow and wrist that a file of markers gives.
fn traced(lines: &str) -> Vec<[DVec3; 3]> {
    let source = format!("file:{lines}?protocol=markers");
    let readings = run(["trace", "readings", "--source", &source]).done();
    let readings = readings.out.lines().map(|line| {
        let reading: serde_json::Value = serde_json::from_str(line).unwrap();
        ["shoulder", "elbow", "wrist"].map(|joint| {
            let position: [f64; 3] =
                serde_json::from_value(reading["joints_m"][joint].clone()).expect(line);
            DVec3::from(position)
        })
    });
    readings.collect()
}

fn worst_mm(found: &[[DVec3; 3]], expected: impl Fn(usize) -> [DVec3; 3]) -> f64 {
    let errors = found.iter().enumerate().flat_map(|(index, joints)| {
        let pairs = joints.iter().zip(expected(index));
        pairs
            .map(|(joint, place)| joint.distance(place) * 1000.0)
            .collect::<Vec<_>>()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn pictures_of_three_cameras_give_the_arm_that_moved() {
    const PICTURES: usize = 20;
    let folder = tempfile::tempdir().unwrap();
    let cameras = room();
    let folders: Vec<PathBuf> = cameras
        .iter()
        .map(|camera| {
            let time = |index: usize| index as f64 / PICTURES as f64;
            let pictures = (0..PICTURES).map(|index| seen(camera, &arm_points(time(index))));
            write_pictures(folder.path(), &camera.name, &pictures.collect::<Vec<_>>())
        })
        .collect();
    let exact = CamerasFile::new(&cameras).to_text(CamerasFormat::Ron);
    let exact = file(&folder, "exact.ron", exact);
    for count in [2, 3] {
        let options = [&ARM_MARKS[..], &["--cameras", &exact]].concat();
        let found = markers(&folders[..count], &options).done();
        found.reported("cam0: 60 marks in 20 pictures");
        let lines = file(&folder, &format!("lines{count}.jsonl"), &found.out);
        let joints = traced(&lines);
        assert_eq!(joints.len(), PICTURES);
        let worst = worst_mm(&joints, |index| arm(index as f64 / PICTURES as f64));
        println!("{count} cameras: largest error {worst:.2} mm");
        assert!(worst < 1.0, "{worst} mm");
    }
    check_calibrated(&folder, &cameras, &folders);
}

/// Calibrates the cameras by pictures of a wand, and checks the distances of all joints in all pictures.
fn check_calibrated(folder: &tempfile::TempDir, cameras: &[Camera], folders: &[PathBuf]) {
    let mut random = fastrand::Rng::with_seed(7);
    let mut place = |size: f64| DVec3::from_array([0; 3].map(|_| size * (random.f64() - 0.5)));
    let wand: Vec<_> = (0..60)
        .map(|_| {
            let (middle, half) = (place(0.5), place(1.0).normalize() * 0.15);
            [(middle - half, RED), (middle + half, GREEN)]
        })
        .collect();
    let wand_folder = folder.path().join("wand");
    fs::create_dir(&wand_folder).unwrap();
    let wands: Vec<PathBuf> = cameras
        .iter()
        .map(|camera| {
            let pictures: Vec<_> = wand.iter().map(|points| seen(camera, points)).collect();
            write_pictures(&wand_folder, &camera.name, &pictures)
        })
        .collect();
    let seen = markers(&wands, &["--color", "red,green", "--label", "a,b"]).done();
    let seen = file(folder, "wand.jsonl", &seen.out);
    let calibrated = folder.path().join("calibrated.ron");
    let size = format!("{}x{}", SIZE[0], SIZE[1]);
    let options = [
        "cameras",
        "calibrate",
        &seen,
        "--wand",
        "300",
        "--size",
        &size,
    ];
    let report = run(options.into_iter().chain(["--output", text(&calibrated)])).done();
    println!("{}", report.err);
    let arm_options = [&ARM_MARKS[..], &["--cameras", text(&calibrated)]].concat();
    let found = markers(folders, &arm_options).done();
    let lines = file(folder, "calibrated.jsonl", &found.out);
    let joints = traced(&lines);
    // A small wand hardly tells the center of the first camera's image from its rotation, so only distances count.
    let count = joints.len() as f64;
    let exact = (0..joints.len()).flat_map(|index| arm(index as f64 / count));
    let pairs: Vec<(DVec3, DVec3)> = joints.iter().flatten().copied().zip(exact).collect();
    let differences = pairs.iter().flat_map(|(own, own_exact)| {
        let distances = pairs.iter().map(|(other, exact_other)| {
            (own.distance(*other) - own_exact.distance(*exact_other)).abs() * 1000.0
        });
        distances.collect::<Vec<_>>()
    });
    let worst = differences.fold(0.0, f64::max);
    println!("calibrated by the wand: distances of joints are off by {worst:.2} mm at most");
    assert_eq!(pairs.len(), 60);
    assert!(worst < 2.0, "{worst} mm");
}

#[test]
fn a_film_has_the_marks_of_its_pictures_and_labels_stay_with_them() {
    let folder = tempfile::tempdir().unwrap();
    let at = |index: f64| {
        let (one, other) = (
            DVec2::new(100.0 + 8.0 * index, 100.0),
            DVec2::new(260.3 - 8.0 * index, 120.0),
        );
        vec![(one, WHITE), (other, WHITE)]
    };
    let pictures: Vec<_> = (0..20).map(|index| at(f64::from(index))).collect();
    let left = write_pictures(folder.path(), "left", &pictures);
    let found = markers(
        std::slice::from_ref(&left),
        &["--label", "a,b", "--rate-hz", "25"],
    )
    .done();
    for (index, line) in found.out.lines().enumerate() {
        let line: serde_json::Value = serde_json::from_str(line).unwrap();
        assert_eq!(line["time_us"], index * 40_000);
        let view = &line["cameras"][0];
        assert_eq!(view["name"], "left");
        for (mark, (center, _)) in ["a", "b"].iter().zip(&pictures[index]) {
            let marks = view["markers"].as_array().unwrap();
            let labelled = marks
                .iter()
                .find(|it| it["label"] == *mark)
                .expect("the label");
            let image: [f64; 2] = serde_json::from_value(labelled["image"].clone()).unwrap();
            assert!(center.distance(DVec2::from(image)) < 0.1, "{line}");
        }
    }
    assert_eq!(found.out.lines().count(), 20);

    let film = folder.path().join("films");
    fs::create_dir(&film).unwrap();
    let film = film.join("left.mkv");
    if !make_film(&left, "25", &film) {
        return;
    }
    let of_film = markers(std::slice::from_ref(&film), &["--label", "a,b"]).done();
    assert_eq!(of_film.out, found.out);
    let deep = folder.path().join("deep.mkv");
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg.args(["-v", "error", "-i"]).arg(&film);
    ffmpeg
        .args(["-pix_fmt", "rgb48be", "-c:v", "png"])
        .arg(&deep);
    assert!(ffmpeg.status().unwrap().success());
    let of_deep = markers(&[deep], &["--label", "a,b"]).done();
    assert_eq!(of_deep.out.lines().count(), 20);
    let no_film = file(&folder, "notes.txt", "no film");
    let refused = markers(&[no_film.into()], &[]).exited(2);
    refused.reported("neither a folder of pictures nor a film");
}

#[test]
fn a_film_that_is_a_list_of_other_films_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = [vec![(DVec2::new(50.0, 60.0), WHITE)], vec![]];
    let left = write_pictures(folder.path(), "left", &pictures);
    let part = folder.path().join("part.mkv");
    if !make_film(&left, "25", &part) {
        return;
    }
    // Without its end, it is read again and again.
    let playlist = format!(
        "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\nfile://{}\n",
        text(&part)
    );
    let lists = [playlist, "ffconcat version 1.0\nfile part.mkv\n".to_owned()];
    for (index, list) in lists.iter().enumerate() {
        let film = file(&folder, &format!("film{index}.mp4"), list);
        let refused = markers(&[film.into()], &[]).exited(2);
        refused.reported("neither a folder of pictures nor a film");
    }
}

/// Makes a film of the pictures of a folder. Returns `false` if that is not possible here.
fn make_film(pictures: &Path, rate_hz: &str, film: &Path) -> bool {
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg
        .args(["-v", "error", "-framerate", rate_hz, "-i"])
        .arg(pictures.join("%d.png"));
    let Ok(status) = ffmpeg.args(["-c:v", "png"]).arg(film).status() else {
        println!("SKIPPED: there is no ffmpeg");
        return false;
    };
    assert!(status.success(), "{}", film.display());
    true
}

/// Returns the first mark of each camera in a line.
fn first_marks(line: &str) -> Vec<Option<[f64; 2]>> {
    let line: serde_json::Value = serde_json::from_str(line).unwrap();
    let views = line["cameras"].as_array().unwrap().iter();
    let marks = views.map(|view| serde_json::from_value(view["markers"][0]["image"].clone()));
    marks.map(Result::ok).collect()
}

#[test]
fn cameras_stay_in_step_without_a_picture_and_films_of_other_rates_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let disc = |index: i32| vec![(DVec2::new(50.0 + 8.0 * f64::from(index), 60.0), WHITE)];
    let pictures: Vec<_> = (0..12).map(disc).collect();
    let left = write_pictures(folder.path(), "left", &pictures);
    let right = write_pictures(folder.path(), "right", &pictures);
    let film_folder = folder.path().join("films");
    fs::create_dir(&film_folder).unwrap();
    let films = ["left.mkv", "right.mkv"].map(|name| film_folder.join(name));
    let are_made = make_film(&left, "30", &films[0]) && make_film(&right, "25", &films[1]);

    fs::remove_file(right.join("5.png")).unwrap();
    let found = markers(&[left, right], &[]).done();
    found.reported("right/5.png");
    assert_eq!(found.out.lines().count(), 12);
    for (index, line) in found.out.lines().enumerate() {
        let [Some(of_left), of_right] = first_marks(line)[..] else {
            panic!("{line}");
        };
        assert_eq!(of_right.is_none(), index == 5, "{line}");
        let difference = of_left[0] - of_right.unwrap_or(of_left)[0];
        assert!(difference.abs() < 1.0, "{line}");
    }
    if !are_made {
        return;
    }
    let refused = markers(&films, &[]).exited(2);
    refused.reported("`left` has 30 pictures per second, and `right` 25");
    let resampled = markers(&films, &["--rate-hz", "25"]).done();
    let count = resampled.out.lines().count();
    assert!((10..=11).contains(&count), "{count} lines");
}

#[cfg(target_os = "linux")]
#[test]
fn an_interruption_leaves_no_part_of_the_lines() {
    use std::os::unix::fs::PermissionsExt;

    let folder = tempfile::tempdir().unwrap();
    let film = file(&folder, "film.mp4", "");
    let decoder = file(
        &folder,
        "ffmpeg",
        "#!/bin/sh\nexec tail -f --pid=$PPID /dev/null\n",
    );
    fs::set_permissions(&decoder, fs::Permissions::from_mode(0o755)).unwrap();
    let lines = folder.path().join("lines.jsonl");
    let path = std::env::var("PATH").unwrap();
    let path = format!("{}:{path}", text(folder.path()));
    let mut command = ademan(["cameras", "markers", &film, "--rate-hz", "30", "--output"]);
    command.arg(&lines).env("PATH", path);
    let mut program = Process::start(&mut command).unwrap();
    assert!(wait_for(|| lines.exists()), "no file");
    signal("INT", program.0.id());
    assert_eq!(program.0.wait().unwrap().code(), Some(130));
    assert!(!lines.exists());
}

#[test]
fn a_program_without_ffmpeg_says_how_to_install_it() {
    let folder = tempfile::tempdir().unwrap();
    let film = file(&folder, "film.mp4", "any");
    let mut command = ademan(["cameras", "markers", &film]);
    let ended = run_to_end(command.env("PATH", folder.path())).exited(1);
    ended.reported("cannot start ffmpeg");
    ended.reported("sudo apt install ffmpeg");
}

#[test]
fn pictures_without_marks_of_other_sizes_and_damaged_ones_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let disc = vec![(DVec2::new(50.0, 60.0), WHITE)];
    let dark = write_pictures(folder.path(), "dark", &[vec![], vec![]]);
    let ended = markers(std::slice::from_ref(&dark), &[]).exited(1);
    ended.reported("no mark was found: the largest value of a pixel is 0.1");
    ended.reported("lower it with `--threshold`");

    // A damaged picture shows nothing, so that the cameras stay in step.
    let left = write_pictures(
        folder.path(),
        "left",
        &[disc.clone(), disc.clone(), disc.clone()],
    );
    let second = left.join("1.png");
    let bytes = fs::read(&second).unwrap();
    fs::write(&second, &bytes[..bytes.len() / 2]).unwrap();
    let cut = markers(std::slice::from_ref(&left), &[]).done();
    cut.reported("left: 2 marks in 3 pictures");
    cut.reported("1.png: the PNG is damaged");
    let counts = cut.out.lines().map(|line| line.matches("image").count());
    assert_eq!(counts.collect::<Vec<_>>(), [1, 0, 1]);

    // Fewer pictures of one camera.
    let right = write_pictures(folder.path(), "right", std::slice::from_ref(&disc));
    let missing = markers(&[left.clone(), right.clone()], &[]).done();
    missing.reported("right has only 1 pictures");
    assert_eq!(missing.out.lines().count(), 1);

    let mut random = fastrand::Rng::with_seed(1);
    write_png(&right.join("1.png"), [320, 200], &disc, &mut random);
    let sizes = markers(&[right], &[]).exited(2);
    sizes.reported("320 × 200 pixels");
    sizes.reported("480 × 360");

    let mut camera = Camera::new("left".to_owned(), DVec2::new(640.0, 480.0));
    let cameras = CamerasFile::new(std::slice::from_ref(&camera)).to_text(CamerasFormat::Ron);
    let cameras = file(&folder, "cameras.ron", cameras);
    let other_size = markers(std::slice::from_ref(&left), &["--cameras", &cameras]).exited(2);
    other_size.reported("640 × 480");
    camera.name = "other".to_owned();
    let other_cameras = CamerasFile::new(&[camera]).to_text(CamerasFormat::Ron);
    let other_cameras = file(&folder, "other.ron", other_cameras);
    let other_name = markers(&[left], &["--cameras", &other_cameras]);
    other_name.reported("has no camera `left`");

    let empty = folder.path().join("empty");
    fs::create_dir(&empty).unwrap();
    let none = markers(&[empty], &[]);
    none.reported("there is no PNG or JPEG");
}

#[test]
fn pictures_that_give_no_lines_leave_no_file_in_the_way_of_the_next_try() {
    let folder = tempfile::tempdir().unwrap();
    let disc = vec![(DVec2::new(50.0, 60.0), WHITE)];
    let dark = write_pictures(folder.path(), "dark", &[vec![]]);
    let mixed = write_pictures(folder.path(), "mixed", std::slice::from_ref(&disc));
    let second = mixed.join("1.png");
    let mut random = fastrand::Rng::with_seed(1);
    write_png(&second, [320, 200], &disc, &mut random);
    let lines = folder.path().join("lines.jsonl");
    let output = ["--output", text(&lines)];
    for (pictures, code) in [(dark, 1), (mixed.clone(), 2)] {
        let ended = markers(&[pictures], &output).exited(code);
        assert!(!ended.err.contains("wrote"), "{}", ended.err);
        assert!(!lines.exists(), "{}", ended.err);
    }
    fs::remove_file(second).unwrap();
    let ended = markers(&[mixed], &output).done();
    ended.reported("wrote");
    assert_eq!(fs::read_to_string(&lines).unwrap().lines().count(), 1);
}

#[test]
fn marks_that_touch_each_other_are_counted_and_give_no_false_centre() {
    let folder = tempfile::tempdir().unwrap();
    let alone = (DVec2::new(300.4, 200.7), WHITE);
    let touching = [
        (DVec2::new(50.0, 60.0), WHITE),
        (DVec2::new(54.0, 61.0), WHITE),
    ];
    let cut = (DVec2::new(100.0, 358.9), WHITE);
    let discs = [vec![alone, cut], touching.to_vec()].concat();
    let left = write_pictures(folder.path(), "left", &[discs]);
    let ended = markers(&[left], &[]).done();
    ended.reported("left: 1 marks in 1 pictures");
    ended.reported("left: 1 shapes at the edge");
    ended.reported("left: 1 shapes are left out because they are too long");
    assert_eq!(ended.out.matches("image").count(), 1);
}
