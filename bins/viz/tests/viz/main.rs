//! The program on a store made by hand: every mode gives a picture of the stated size that shows what is
//! there.

mod store_at;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use pictures::{Canvas, decode_jpeg, decode_png};
use store_at::{IMAGE_PX, make, make_imported};

fn viz(store: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_viz"));
    // Options of all commands stand after the command.
    let (head, rest) = args.split_at(usize::from(args.first().is_some_and(|a| !a.starts_with('-'))));
    command.args(head).arg("--store").arg(store).args(rest).output().expect("starts")
}

#[track_caller]
fn done(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

#[track_caller]
fn refused(output: &Output, words: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    for word in words {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert_eq!(said.trim().lines().count(), 1, "one error: {said}");
}

/// All files in a folder, by their path in it.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(&next).expect("is a folder").flatten() {
            if entry.path().is_dir() {
                open.push(entry.path());
            } else {
                let path = entry.path().strip_prefix(folder).expect("is inside").to_owned();
                found.insert(path, std::fs::read(entry.path()).expect("reads"));
            }
        }
    }
    found
}

fn picture(name: &Path, bytes: &[u8]) -> Canvas {
    if name.extension().is_some_and(|e| e == "jpg") {
        return decode_jpeg(bytes).expect("is a JPEG");
    }
    let (size, rgb) = decode_png(bytes).expect("is a PNG");
    Canvas::from_rgb(size, &rgb).expect("fits")
}

/// The size of a mode's pictures.
fn size_of(mode: &str) -> [u32; 2] {
    match mode {
        _ if mode.contains("CAM_") => IMAGE_PX,
        _ if mode.contains("3D") => [1600, 900],
        "SCENE" => [2000, 2000],
        _ if mode.starts_with("BEV") => [40, 40],
        _ => [2560, 2560],
    }
}

#[test]
fn every_mode_shows_something_in_its_size_on_any_number_of_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = folder.path().join("store");
    make(&store);
    let listed = done(&viz(&store, &["--list"]));
    let modes: Vec<&str> = listed.lines().next().expect("vehicle_0").split_whitespace().skip(1).collect();
    // Five images, three clouds in two views, with boxes but for the semantic one, voxels, masks, together:
    // near and far.
    assert_eq!(modes.len(), 5 + 2 * (4 + 2 + 4) + 2 + 2 + 4 + 1, "{modes:?}");
    let drawn = |threads: &str| {
        let dest = folder.path().join(threads);
        done(&viz(&store, &["--every", "1", "--threads", threads, "--dest", &dest.to_string_lossy()]));
        files(&dest)
    };
    let (one, three) = (drawn("1"), drawn("3"));
    assert!(one == three, "the same files");
    for mode in modes {
        let owner = if mode == "SCENE" { "scene" } else { "vehicle_0" };
        let of_mode: Vec<_> =
            one.iter().filter(|(path, _)| path.starts_with(Path::new(owner).join(mode))).collect();
        assert_eq!(of_mode.len(), 2, "{mode}: a picture of each frame");
        for (path, bytes) in of_mode {
            let canvas = picture(path, bytes);
            assert_eq!(canvas.size(), size_of(mode), "{mode}");
            let rgb = canvas.to_rgb();
            let is_plain = rgb.chunks_exact(3).all(|p| p == &rgb[..3]);
            // Images of one colour stay so.
            let wants_one =
                ["SEG-", "IST-", "DPT-"].iter().any(|kind| mode.starts_with(kind) && mode.contains("CAM"));
            assert_eq!(is_plain, wants_one, "{mode}");
        }
    }
}

#[test]
fn what_is_drawn_stands_where_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let (store, dest) = (folder.path().join("store"), folder.path().join("out"));
    make(&store);
    let modes = "RGB-*,LIDARwBBOX-NEAR,COOP-NEAR,IST-*,DPT-*";
    done(&viz(
        &store,
        &["--modes", modes, "--frames", "1", "--agents", "vehicle_0", "--dest", &dest.to_string_lossy()],
    ));
    let all = files(&dest);
    let find = |mode: &str| {
        let (path, bytes) =
            all.iter().find(|(path, _)| path.components().any(|c| c.as_os_str() == mode)).expect(mode);
        assert!(path.to_string_lossy().contains("scene-0003-frame-0001-vehicle_0"), "{path:?}");
        picture(path, bytes)
    };
    let is_blue = |p: Option<[u8; 3]>| p.is_some_and(|[r, g, b]| b > 150 && r < 110 && g < 180);
    // The car's back is 6 m ahead, 2 m wide, from the ground to 1.5 m, the camera 1.5 m high: 32 pixels a
    // metre at 1 m.
    let photograph = find("RGB-CAM_FRONT");
    assert!(is_blue(photograph.pixel([26, 20])) && is_blue(photograph.pixel([37, 20])));
    assert!(!is_blue(photograph.pixel([32, 20])) && !is_blue(photograph.pixel([20, 20])));
    // From above 64 pixels a metre: the box from 6 to 10 m ahead, 1 m to each side, the point in its middle.
    let above = find("LIDARwBBOX-NEAR");
    for at in [[1280 - 64, 1280 - 512], [1280 + 64, 1280 - 512], [1280, 1280 - 384], [1280, 1280 - 640]] {
        assert!(is_blue(above.pixel(at)), "{at:?}: {:?}", above.pixel(at));
    }
    assert!(above.pixel([1280, 1280 - 512]).is_some_and(|p| p != [255; 3]));
    assert_eq!(above.pixel([1280 - 64, 1280 + 512]), Some([255; 3]), "the car behind was not seen");
    // The RSU's point is 18 m ahead of the vehicle, in the RSU's colour; the map's edge 3 m to the right.
    let together = find("COOP-NEAR");
    let (own, other) = (together.pixel([1280, 1280 - 512]), together.pixel([1280, 1280 - 18 * 64]));
    assert!(own != other && other.is_some_and(|p| p != [255; 3]), "{own:?} {other:?}");
    assert!(together.pixel([1280 + 3 * 64, 1280]).is_some_and(|p| p != [255; 3]));
    assert_eq!(find("DPT-CAM_FRONT").pixel([3, 3]), Some(pictures::depth_rgb(10.0)));
    assert_eq!(find("IST-CAM_FRONT").pixel([3, 3]), Some(pictures::id_rgb(9)));
}

#[test]
fn what_is_not_there_is_one_clear_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = folder.path().join("store");
    make(&store);
    let dest = folder.path().join("out").to_string_lossy().into_owned();
    let run = |args: &[&str]| viz(&store, &[args, &["--dest", &dest]].concat());
    refused(&run(&["--scene", "7"]), &["its plan has no scene 7"]);
    refused(&run(&["--frames", "0,9"]), &["no frame 9", "frames 0 to 1"]);
    refused(&run(&["--agents", "vehicle_4"]), &["no agent `vehicle_4`", "vehicle_0, rsu_0"]);
    refused(
        &run(&["--modes", "RGB-CAM_ROOF"]),
        &["no picture `RGB-CAM_ROOF`", "RGB-CAM_FRONT", "VOXEL3D-FAR"],
    );
    let velocity = run(&["--modes", "LIDAR-FAR", "--colour", "velocity"]);
    refused(&velocity, &["scene 3 frame 0 vehicle_0 LIDAR-FAR", "no velocity", "distance, height, tag"]);
    refused(
        &viz(&folder.path().join("nowhere"), &["--dest", &dest]),
        &["no finished store", "convoy run --store"],
    );
    let sheet = folder.path().join("sheet.gif").to_string_lossy().into_owned();
    refused(&viz(&store, &["preview", "--out", &sheet]), &[".png or .jpg"]);
    refused(&viz(&store, &["film", "--out", &sheet]), &[".png"]);
    assert!(!Path::new(&dest).exists() && !Path::new(&sheet).exists());
}

#[test]
fn sheets_and_films_have_what_there_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = folder.path().join("store");
    make(&store);
    let out = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    done(&viz(&store, &["preview", "--width", "800", "--out", &out("sheet.png")]));
    let sheet = picture(Path::new("sheet.png"), &std::fs::read(out("sheet.png")).expect("reads"));
    assert_eq!(sheet.size()[0], 800);
    done(&viz(&store, &["film", "--every", "1", "--width", "400", "--out", &out("film.png")]));
    let bytes = std::fs::read(out("film.png")).expect("reads");
    // An animation control chunk says how many frames there are.
    let at = bytes.windows(4).position(|w| w == b"acTL").expect("is animated");
    assert_eq!(bytes[at + 4..at + 8], 2_u32.to_be_bytes());
}

/// Zeros that stand for unknown values are not painted: a user who asks for them is told, and what else may
/// be chosen.
#[test]
fn what_imports_do_not_know_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = folder.path().join("store");
    make_imported(&store);
    let out = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let run = |dest: &str, args: &[&str]| viz(&store, &[args, &["--dest", &out(dest)]].concat());
    let tags = "nobody knows the tag of points of LIDAR, as the scene was imported: colour them by distance, height, agent";
    for mode in ["LIDAR-FAR", "COOP-NEAR", "SCENE"] {
        refused(&run("named", &["--modes", mode, "--colour", "tag"]), &["scene 3", tags]);
    }
    refused(
        &run("named", &["--modes", "RADAR-FAR", "--colour", "id"]),
        &["id of points of RAD_FRONT", "distance, height, velocity, agent"],
    );
    // Without a choice of pictures those are left out that cannot be coloured so; of both lidars nobody knows
    // intensities.
    let told = run("tags", &["--colour", "tag"]);
    done(&told);
    let said = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(said.contains(tags) && said.contains("points of RAD_FRONT"), "{said}");
    assert_eq!(said.trim().lines().count(), 2, "a warning for each sensor: {said}");
    let drawn = files(Path::new(&out("tags")));
    let has = |mode: &str| drawn.keys().any(|path| path.components().any(|part| part.as_os_str() == mode));
    assert!(has("SEG-LIDAR-FAR") && has("BEV"), "{:?}", drawn.keys());
    assert!(
        !has("LIDAR-FAR") && !has("RADAR-FAR") && !has("COOP-FAR") && !has("SCENE"),
        "{:?}",
        drawn.keys()
    );
    refused(&run("intensities", &["--colour", "intensity"]), &["nobody knows the intensity"]);
    // Where nothing is said, pictures show what is known.
    done(&run("usual", &["--modes", "LIDAR-FAR,SEG-LIDAR-FAR,RADAR-FAR,SCENE,COOP-FAR"]));
    let drawn = files(Path::new(&out("usual")));
    assert_eq!(drawn.len(), 7, "of both agents but for SEG-LIDAR, RADAR and SCENE: {:?}", drawn.keys());
    done(&viz(&store, &["preview", "--width", "800", "--out", &out("sheet.png")]));
    done(&viz(&store, &["film", "--every", "1", "--width", "400", "--out", &out("film.png")]));
    assert!(!Path::new(&out("named")).exists() && !Path::new(&out("intensities")).exists());
}
