//! Colour looks through panes; nothing else does.

use crate::common::{at, block, instance, optics, set_view, sight, snapshot, with_scene};
use schema::Tag;
use schema::geometry::{Instance, Snapshot, Surface};
use schema::lights;
use schema::tables::Weather;
use settings::CameraSettings;
use shading::Picture;
use shading::Sight;

const SHELL: u16 = 7;

/// In the dark, a shell of glass ten metres ahead; behind it a wall that glows, and within it, to the right,
/// a block that does.
fn shell(glowing: bool) -> Snapshot {
    let lit = |mesh, object, pose| Instance {
        lights: if glowing { lights::POSITION } else { 0 },
        ..instance(mesh, object, pose)
    };
    let scene = snapshot(
        vec![
            block([4.0, 3.0, 3.0], Tag::Car, Surface::Window),
            block([1.0, 30.0, 30.0], Tag::Building, Surface::Lamp(lights::POSITION)),
            block([1.0, 1.0, 2.8], Tag::Car, Surface::Lamp(lights::POSITION)),
        ],
        vec![instance(0, SHELL, at(12.0, 0.0, 0.0, 0.0)), lit(1, 8, at(25.0, 0.0, -10.0, 0.0))],
    );
    Snapshot { cabins: vec![lit(2, SHELL, at(12.0, -0.8, 0.1, 0.0))], ..scene }
}

fn seen(scene: &Snapshot) -> Sight {
    let settings = CameraSettings { bloom: 0.0, ..CameraSettings::default() };
    let view = set_view([0.0; 3], [0.0; 3], optics(160, 90), &settings);
    let night = Weather { sun_altitude_deg: -40.0, ..Weather::default() };
    with_scene(scene, |scene| sight(scene, &view, &night))
}

/// Film values of the pixel at a share of the width, halfway up.
fn film(picture: &Picture, x: f64) -> [f64; 3] {
    let at = (picture.height / 2 * picture.width) as usize + (x * f64::from(picture.width)) as usize;
    [0, 1, 2].map(|c| crate::common::film(picture.rgb[3 * at + c]))
}

#[test]
fn light_passes_each_pane() {
    let through = seen(&shell(true)).picture.expect("in colour");
    let bare = Snapshot { instances: shell(true).instances.split_off(1), cabins: Vec::new(), ..shell(true) };
    let bare = seen(&bare).picture.expect("in colour");
    // Right of the middle the block is behind one pane, left of it the wall behind two; at the edge nothing
    // is before the wall.
    let ratio = |x: f64| film(&through, x)[1] / film(&bare, x)[1];
    assert!((ratio(0.02) - 1.0).abs() < 0.01, "{}", ratio(0.02));
    // A pane mirrors some six percent of the dark sky's light, which is none.
    assert!((ratio(0.45) - 0.49 * 0.94).abs() < 0.03, "{}", ratio(0.45));
    assert!((ratio(0.545) - 0.7 * 0.94).abs() < 0.04, "{}", ratio(0.545));
}

/// The same with an open door: an opening before a closed side 5 cm behind it, turned by so many radians.
fn opened(turn: f32) -> Snapshot {
    let clear = shell(true);
    let mut meshes = clear.meshes.to_vec();
    meshes[0] = block([0.02, 3.0, 3.0], Tag::Car, Surface::Opening);
    meshes.push(block([0.02, 6.0, 6.0], Tag::Car, Surface::Paint));
    let mut scene = snapshot(meshes, clear.instances);
    let (sin, cos) = frames::math::f32::sin_cos(turn);
    scene.instances[0] = instance(0, SHELL, at(10.0, 0.0, 0.0, turn));
    scene.instances.push(instance(3, SHELL, at(10.0 + 0.05 * cos, 0.05 * sin, -2.0, turn)));
    Snapshot { cabins: clear.cabins, ..scene }
}

#[test]
fn open_doors_take_no_light() {
    let bare = Snapshot { instances: shell(true).instances.split_off(1), cabins: Vec::new(), ..shell(true) };
    let bare = seen(&bare).picture.expect("in colour");
    for turn in [0.0, 0.6] {
        let through = seen(&opened(turn)).picture.expect("in colour");
        // Beside the opening the side is dark; in it the wall and the block shine as if nothing was before
        // them.
        assert!(film(&through, 0.36)[1] < 0.05 * film(&bare, 0.36)[1], "{turn}");
        for x in [0.45, 0.545] {
            let ratio = film(&through, x)[1] / film(&bare, x)[1];
            assert!((ratio - 1.0).abs() < 0.01, "{turn} {x}: {ratio}");
        }
    }
    let dark = Snapshot { cabins: Vec::new(), ..opened(0.0) };
    assert!(film(&seen(&dark).picture.expect("in colour"), 0.45)[1] < 0.1 * film(&bare, 0.45)[1]);
}

#[test]
fn half_of_the_sun_passes_panes_that_one_sees_through() {
    // A sheet of glass high over white ground, and a sun right above: what is under its middle is in its
    // shadow.
    let scene = |behind: bool| {
        let scene = snapshot(
            vec![
                block([80.0, 80.0, 0.1], Tag::Ground, Surface::Plain),
                block([10.0, 10.0, 0.1], Tag::Car, Surface::Window),
                block([0.1; 3], Tag::Car, Surface::Plain),
            ],
            vec![instance(0, 3, at(0.0, 0.0, -0.1, 0.0)), instance(1, SHELL, at(0.0, 0.0, 9.0, 0.0))],
        );
        let cabins = if behind { vec![instance(2, SHELL, at(0.0, 0.0, 9.2, 0.0))] } else { Vec::new() };
        Snapshot { cabins, ..scene }
    };
    let noon = Weather { sun_altitude_deg: 89.0, cloudiness: 0.0, ..Weather::default() };
    // Light on the ground under the sheet, from a camera that looks down below it, past its edges.
    let settings = CameraSettings { bloom: 0.0, vignetting: 0.0, ..CameraSettings::default() };
    let view = set_view([-0.6, 0.0, 1.4], [0.0, 1.57, 0.0], optics(160, 90), &settings);
    let light = |snapshot: &Snapshot| {
        let picture = with_scene(snapshot, |scene| sight(scene, &view, &noon)).picture.expect("in colour");
        let middle = |x: f64| film(&picture, x)[1];
        [0.3, 0.4, 0.6, 0.7].map(middle).iter().sum::<f64>() / 4.0
    };
    let bare = Snapshot { instances: scene(false).instances[..1].to_vec(), ..scene(false) };
    let [open, clear, dark] = [&bare, &scene(true), &scene(false)].map(light);
    // The sky's share is hidden alike; of the sun's half is left.
    let (sun, left) = (open - dark, clear - dark);
    assert!(dark < 0.4 * open, "{dark} {open}");
    let hidden_sky = 0.1 * open;
    assert!((left - 0.5 * sun).abs() < hidden_sky, "{left} of {sun}");
}

#[test]
fn a_shell_without_a_cabin_is_dark_glass() {
    let dark = Snapshot { cabins: Vec::new(), ..shell(true) };
    let [dark, clear] = [dark, shell(true)].map(|scene| seen(&scene).picture.expect("in colour"));
    assert!(film(&dark, 0.45)[1] < 0.2 * film(&clear, 0.45)[1]);
}

#[test]
fn labels_stop_at_the_glass() {
    let [with, without] =
        [shell(true), Snapshot { cabins: Vec::new(), ..shell(true) }].map(|s| seen(&s).seen);
    assert_eq!((&with.instance, &with.triangle), (&without.instance, &without.triangle));
    assert_eq!(with.depth_m, without.depth_m);
    let middle = with.index(80, 45);
    assert_eq!(with.instance[middle], 0);
    assert!((with.depth_m[middle] - 9.4).abs() < 1e-3, "{}", with.depth_m[middle]);
}
