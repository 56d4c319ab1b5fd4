//! What cameras see of a town, by pictures and by rays through their pixels: the same triangles, pixel by
//! pixel.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use frames::{Agent, Pose, World};
use glam::Vec3;
use land::tiles::{Surroundings, TileMaker};
use opendrive::Map;
use plan::PlanMap;
use render::cpu::CpuRenderer;
use render::{CameraQuery, PinholeCamera, RayQuery, Renderer};
use runner::StageSettings;
use schema::geometry::Snapshot;
use schema::tables::StateRow;
use schema::{ActorRole, AgentId, ObjectId};
use settings::stages::{PlanSettings, SimulationSettings};
use testkit::{Agreement, PixelRays, camera_at};
use traffic::SceneInput;
use world::{Moment, SceneWorld};

const CONFIG: &str = "seed = 27\n[scenes.train]\n\"convoy/demo\" = 1\n[agents]\nmin_vehicles = 1\nmax_vehicles = 1\n\
                      min_rsus = 0\nmax_rsus = 0\n[timing]\nmin_duration_s = 1\nmax_duration_s = 1\n\
                      [traffic]\nvehicles = 150\n[walkers]\ncount = 100\n";
/// Late enough that all have moved.
const FRAME: i32 = 8;

/// A town with traffic around an agent: where the agent is, and another vehicle close to it.
fn town() -> (Snapshot, Pose<World, Agent>, Pose<World, Agent>) {
    let settings = settings::parse(CONFIG, "test").expect("the configuration is valid");
    let network = town::generate(&town::named("convoy/demo").expect("is named")).expect("is generated");
    let plan_map = PlanMap { map: Map::new(network), hash: String::new() };
    let mut maps = BTreeMap::from([("convoy/demo".to_owned(), plan_map)]);
    let plan = plan::plan(&PlanSettings::of(&settings), &maps).expect("is planned");
    let map = maps.remove("convoy/demo").expect("is there").map;
    let simulation = SimulationSettings::of(&settings);
    let centres: Vec<[f64; 3]> = plan.agents.iter().map(|a| a.xyz_m).collect();
    let maker = TileMaker::new(&map, &settings.world.scenery, catalogue::Catalogue::built_in());
    let Surroundings { actors: fixed, ground } =
        maker.around(&centres, simulation.reach_m, 1).expect("there are ids");
    let input = SceneInput {
        catalogue: catalogue::Catalogue::built_in(),
        map: &map,
        scene: &plan.scenes[0],
        agents: &plan.agents,
        hazards: &[],
        weather: &[],
        routes: &[],
        trajectories: &[],
        settings: &simulation,
        fixed: &fixed,
        first_id: fixed.last().map_or(1, |a| a.id + 1),
    };
    let log = traffic::simulate(&input, &mut |_, _| ControlFlow::Continue(())).expect("is simulated");
    let own =
        log.actors.iter().find(|a| a.role == ActorRole::Agent(AgentId::vehicle(0))).expect("is there").id;
    let of = |frame: i32| -> &[StateRow] {
        let first = log.states.partition_point(|s| s.frame < frame);
        &log.states[first..log.states.partition_point(|s| s.frame <= frame)]
    };
    let pose = |id: ObjectId| {
        let state = of(FRAME).iter().find(|s| s.id == id).expect("has a state");
        Pose::<World, Agent>::from_xyz_wxyz(state.xyz_m, state.quaternion)
    };
    let at = pose(own);
    let away =
        |id: ObjectId| (pose(id).xyz()[0] - at.xyz()[0]).abs() + (pose(id).xyz()[1] - at.xyz()[1]).abs();
    let others = log.actors.iter().filter(|a| a.id != own && a.kind == schema::ActorKind::Vehicle);
    let beside = others.map(|a| a.id).min_by(|a, b| away(*a).total_cmp(&away(*b))).expect("there is traffic");
    let beside = pose(beside);
    let mut actors = fixed;
    actors.extend(log.actors.iter().cloned());
    let world = SceneWorld::new(&actors, ground).expect("has meshes");
    let moment = Moment {
        states: of(FRAME),
        previous: of(FRAME - 1),
        signals: &[],
        frame: &log.frames[FRAME as usize],
    };
    (world.snapshot(&moment, at.xyz(), 1000.0), at, beside)
}

/// Cameras: from where, in a body's frame, along which way, how wide.
fn views(
    world: &Snapshot,
    own: &Pose<World, Agent>,
    other: &Pose<World, Agent>,
) -> Vec<(&'static str, PinholeCamera)> {
    let ahead = Vec3::X;
    let far = Vec3::new(0.0, 0.0, 60.0);
    let list = [
        ("ahead", own, Vec3::new(0.5, 0.0, 1.6), ahead, 90.0),
        ("behind", own, Vec3::new(-3.0, 0.0, 1.2), Vec3::new(-1.0, 0.3, -0.1), 120.0),
        ("distant", own, Vec3::new(3.0, 0.0, 1.6), Vec3::new(1.0, 0.02, -0.01), 6.0),
        ("grazing", own, Vec3::new(3.0, 0.0, 0.04), ahead, 60.0),
        ("above", own, far, Vec3::new(1.0, 0.2, -0.6), 70.0),
        ("wheels", other, Vec3::new(0.4, 2.4, 0.35), Vec3::new(0.05, -1.0, 0.0), 80.0),
        ("under", other, Vec3::new(-3.5, 0.1, 0.12), Vec3::new(1.0, 0.02, 0.03), 70.0),
        ("near plane", own, Vec3::new(0.3, 0.2, 0.7), Vec3::new(0.8, -0.5, 0.05), 130.0),
    ];
    let camera = |(name, body, from, along, fov_deg): (_, &Pose<World, Agent>, Vec3, Vec3, f64)| {
        let local = world.origin.local_from_body(body);
        let fov_rad = frames::deg(fov_deg) as f32;
        (name, camera_at(local.transform_point3(from), local.transform_vector3(along), 480, 270, fov_rad))
    };
    list.map(camera).into()
}

#[test]
#[expect(clippy::print_stderr, reason = "the numbers are what is asked for")]
fn a_towns_pictures_are_what_rays_see() {
    let (world, own, other) = town();
    let mut renderer = CpuRenderer::default();
    renderer.prepare(&world.meshes).expect("has no device");
    let scene = renderer.place(&world).expect("all meshes are prepared");
    let mut all = Agreement::default();
    for (name, camera) in views(&world, &own, &other) {
        let rays = PixelRays::new(&camera);
        let seen = scene.render(&[CameraQuery::of(camera)]).expect("has no device").remove(0);
        let hits = scene.trace(&[RayQuery::of(rays.batch())]).expect("has no device").remove(0);
        let found = rays.compare(&world, &seen, &hits).unwrap_or_else(|why| panic!("{name}: {why}"));
        assert!(found.seen > 40_000, "{name}: {found:?}");
        eprintln!("{name}: {found:?}");
        // Through a telephoto lens of 6 degrees rounding is twenty times as wide, and what is far off has
        // triangles of a pixel: there only what differs is judged (above), as everywhere.
        if name != "distant" {
            all += found;
        }
    }
    eprintln!("all but the distant: {all:?}");
    // What rounding may decide is rare: how rare depends on how small the triangles are that are seen from
    // above.
    assert!(all.on_edges * 50 < all.seen, "{all:?}");
}
