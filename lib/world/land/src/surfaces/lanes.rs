//! Lane surfaces, kerbs and verges.

use nalgebra::{Point3, Vector3};
use schema::Tag;
use schema::geometry::{Kerbs, MeshPart, Surface};

use crate::surfaces::blocks::Blocks;
use crate::surfaces::cover::{Cover, Facet, PATCH_BELOW_M};
use crate::surfaces::ground::GroundLevels;
use crate::surfaces::materials::{ASPHALT, GRASS, pavement};
use crate::surfaces::region::Region;
use crate::surfaces::sections::{Ground, Section, Strip, WIDEST_M};
use schema::Layer;

const WASTE: MeshPart = MeshPart::new(Tag::Ground, Surface::Asphalt, [0.12, 0.12, 0.12]);
const BALLAST: MeshPart = MeshPart::new(Tag::RailTrack, Surface::Gravel, [0.17, 0.155, 0.14]);
/// Faces of raised strips, but for their tag.
const KERB: MeshPart = MeshPart::new(Tag::Sidewalk, Surface::Concrete, [0.42, 0.42, 0.41]);
const MEDIAN: MeshPart = MeshPart::new(Tag::Ground, Surface::Concrete, [0.30, 0.29, 0.27]);
/// Kerb faces reach this far below the edge where nothing joins it, metres.
const SKIRT_M: f64 = 0.4;
/// What stands less over a road is no kerb, metres.
const LEAST_KERB_M: f64 = 0.03;
/// A surface this much nearer in height belongs to the same level, metres.
const SAME_LEVEL_M: f64 = 2.0;
/// Cross-section of the grass beside a road: distance from the edge and drop, metres.
const VERGE_PROFILE: [(f64, f64); 3] = [(0.0, 0.02), (1.0, 0.10), (3.2, 0.85)];

/// How high the ground is beside a road's edge, which is as high as that: grass falls off from it, where the
/// land is not much lower or higher. `far_m`: how far beyond the edge, metres.
#[must_use]
pub fn beside_edge(land_m: f64, edge_m: f64, far_m: f64) -> f64 {
    let drop = VERGE_PROFILE.array_windows().find(|[_, (far, _)]| far_m <= *far);
    let drop = drop.map(|[(a, from), (b, to)]| from + (far_m.max(*a) - a) / (b - a) * (to - from));
    match drop {
        Some(drop) if edge_m - land_m <= super::bridges::WALL_FROM_M => land_m.max(edge_m - drop),
        _ => land_m,
    }
}

/// Ways through a junction lie on one another: each this much over the next one, metres, so that a
/// picture shows one of them, and not both in turn; few junctions have more ways than there are heights.
/// What is drawn at their edges stays narrower than a fifth of a millimetre.
const OVER_M: f64 = 4e-6;
const WAYS: u32 = 47;

/// Raised strips are narrowed in steps of so many parts of their width, to half of it at most, where vehicles
/// of another road drive over an edge of them.
const PARTS: usize = 8;
/// A strip narrower than this is none, metres.
const LEAST_M: f64 = 0.5;

/// Lane surfaces for point queries. Those of no use to vehicles are left out where vehicles of another road
/// drive over them; of railways a patch remains there, so that the road goes on to where the ballast begins.
pub(crate) fn cover(sections: &[&Section], region: &Region) -> Cover {
    let region = region.grown(WIDEST_M);
    let mut cover = Cover::new(region);
    let mut add = |ground: fn(Ground) -> bool| {
        let mut facets: Vec<Facet> = Vec::new();
        for section in sections {
            for strip in section.strips.iter().filter(|s| ground(s.ground)) {
                for i in (0..section.s.len() - 1).filter(|i| section.inside(*i, &region)) {
                    let (mut road, mut ground) = (Some(section.road), strip.ground);
                    let [a, b, c, d] = if let Some(part) = free_part(section, strip, i, &cover) {
                        corners_of(strip, i, part)
                    } else if ground == Ground::Track {
                        (road, ground) = (None, Ground::Paved);
                        corners(strip, i).map(|p| Point3::new(p.x, p.y, p.z - PATCH_BELOW_M))
                    } else {
                        continue;
                    };
                    facets.extend([[a, b, c], [a, c, d]].map(|corners| Facet { corners, road, ground }));
                }
            }
        }
        facets.into_iter().for_each(|facet| cover.add(facet));
    };
    add(|g| g == Ground::Paved);
    add(|g| matches!(g, Ground::Walk | Ground::Median | Ground::Track | Ground::Waste));
    cover
}

/// The corners of a strip's piece, counter-clockwise from above.
fn corners(strip: &Strip, i: usize) -> [Point3<f64>; 4] {
    [strip.right[i], strip.right[i + 1], strip.left[i + 1], strip.left[i]]
}

/// A part of a strip's width: from where to where, as shares from its right border.
type Share = [f64; 2];
const WHOLE: Share = [0.0, 1.0];

/// The corners of a part of a strip's piece, in the order of [`corners`].
fn corners_of(strip: &Strip, i: usize, [from, to]: Share) -> [Point3<f64>; 4] {
    let at = |k: usize, share: f64| match share {
        // Whole pieces share their vertices with their neighbours to the last bit.
        0.0 => strip.right[k],
        1.0 => strip.left[k],
        _ => strip.right[k] + (strip.left[k] - strip.right[k]) * share,
    };
    [at(i, from), at(i + 1, from), at(i + 1, to), at(i, to)]
}

/// The part of a strip's piece on which no vehicles of another road drive: where their lane runs over one
/// edge of a raised strip, what lies beside it.
fn free_part(section: &Section, strip: &Strip, i: usize, cover: &Cover) -> Option<Share> {
    if free_of_traffic(section, strip, i, cover) {
        return Some(WHOLE);
    }
    let width = |k: usize| (strip.left[k] - strip.right[k]).norm();
    let narrowest_m = width(i).min(width(i + 1));
    let parts = (1..=PARTS / 2).map(|k| k as f64 / PARTS as f64);
    let mut parts = parts.filter(|cut| strip.ground.raised() && (1.0 - cut) * narrowest_m >= LEAST_M);
    parts.find_map(|cut| {
        let sides = [[cut, 1.0], [0.0, 1.0 - cut]];
        sides.into_iter().find(|part| is_free(section, &corners_of(strip, i, *part), cover))
    })
}

/// Whether no paved surface of another road at the same level meets a piece of a strip that is of no use to
/// vehicles.
pub(crate) fn free_of_traffic(section: &Section, strip: &Strip, i: usize, cover: &Cover) -> bool {
    strip.ground == Ground::Paved || is_free(section, &corners(strip, i), cover)
}

/// Whether no paved surface of another road at the same level meets a quadrangle.
fn is_free(section: &Section, quad: &[Point3<f64>; 4], cover: &Cover) -> bool {
    let middle = Point3::from((quad[0].coords + quad[1].coords + quad[2].coords + quad[3].coords) / 4.0);
    // Just inside the corners, so that lanes that only touch do not count.
    let mut probes = quad.map(|p| middle + (p - middle) * 0.94).to_vec();
    probes.push(middle);
    probes.extend((0..4).map(|k| middle + ((quad[k] + (quad[(k + 1) % 4] - quad[k]) * 0.5) - middle) * 0.94));
    !probes.iter().any(|p| {
        cover.at(p.x, p.y).any(|(f, z)| f.is_driven_by_others(section.road) && (z - p.z).abs() < SAME_LEVEL_M)
    })
}

/// Draws the pieces of lanes that begin in an area.
pub(crate) fn build(sections: &[&Section], area: &Region, ground: &GroundLevels, blocks: &mut Blocks) {
    for section in sections {
        let here: Vec<bool> = (0..section.s.len() - 1).map(|i| section.inside(i, area)).collect();
        if !here.contains(&true) {
            continue;
        }
        // A piece's ends depend on whether its neighbours are there, in the area or not.
        let asked = |i: usize| here[i.saturating_sub(1)..(i + 2).min(here.len())].contains(&true);
        let over_m = if section.junction { f64::from(section.road % WAYS) * OVER_M } else { 0.0 };
        let begins = section.strips.first().map_or([0.0; 2], |strip| [strip.right[0].x, strip.right[0].y]);
        for (k, strip) in section.strips.iter().enumerate() {
            let (layer, top) = match strip.ground {
                Ground::Paved => (Layer::Road, ASPHALT),
                Ground::Waste => (Layer::Median, WASTE),
                Ground::Track => (Layer::Track, BALLAST),
                Ground::Walk => (Layer::Sidewalk, pavement(begins)),
                Ground::Median => (Layer::Median, MEDIAN),
                Ground::Land => continue,
            };
            // A face is what its strip is: an object has no tags beside its own.
            let face = MeshPart { tag: layer.tag(), ..KERB };
            let along_m =
                if layer == Layer::Sidewalk { along(section, strip) } else { vec![0.0; here.len() + 1] };
            let right = k.checked_sub(1).and_then(|k| section.strips.get(k));
            let left = section.strips.get(k + 1);
            let kept: Vec<Option<Share>> = (0..here.len())
                .map(|i| free_part(section, strip, i, &ground.cover).filter(|_| asked(i)))
                .collect();
            for i in (0..kept.len()).filter(|i| here[*i]) {
                let Some(part) = kept[i] else { continue };
                let [right_start, right_end, left_end, left_start] = corners_of(strip, i, part)
                    .map(|p| if layer == Layer::Road { p + Vector3::z() * over_m } else { p });
                let beside = [(right, 0), (left, 1)]
                    .map(|(next, side)| is_kerbed(section, strip, next, (i, side), &ground.cover));
                let top = match Kerbs::on(beside) {
                    Some(kerbs) if top.surface.is_asphalt() => {
                        MeshPart { surface: Surface::KerbedAsphalt(kerbs), ..top }
                    }
                    _ => top,
                };
                let [near, far] = [along_m[i], along_m[i + 1]];
                let away = away_m(strip, i, part);
                let laid = [[near, away[0]], [far, away[1]], [far, away[2]], [near, away[3]]];
                blocks.quad_along(layer, top, [right_start, right_end, left_end, left_start], laid);
                if !strip.ground.raised() && strip.raise[i] == [0.0; 2] {
                    continue;
                }
                let down = |p: Point3<f64>, by: f64| Point3::new(p.x, p.y, p.z - by);
                // Where a part was cut off, its edge is one for good.
                let beside = |is_whole: bool, neighbour, side| {
                    if is_whole { face_depth(strip, neighbour, i, side) } else { Some([SKIRT_M; 2]) }
                };
                if let Some(depth) = beside(part[1] == 1.0, left, 0) {
                    let (a, b) = (left_end, left_start);
                    let laid = [far, near, near, far].map(|along| [along, 0.0]);
                    blocks.quad_along(layer, face, [down(a, depth[1]), down(b, depth[0]), b, a], laid);
                }
                if let Some(depth) = beside(part[0] == 0.0, right, 1) {
                    let (a, b) = (right_start, right_end);
                    let laid = [near, far, far, near].map(|along| [along, 0.0]);
                    blocks.quad_along(layer, face, [down(a, depth[0]), down(b, depth[1]), b, a], laid);
                }
                // Where the strip begins or ends for good, or was cut away, its end is closed.
                let goes_on = |k: Option<usize>| {
                    let next = k.and_then(|k| kept.get(k).copied().flatten());
                    next.is_some_and(|next| next[0] <= part[0] && next[1] >= part[1])
                };
                if if i == 0 { section.ends[0] } else { !goes_on(i.checked_sub(1)) } {
                    let (a, b) = (left_start, right_start);
                    blocks.quad(layer, face, [down(a, SKIRT_M), down(b, SKIRT_M), b, a]);
                }
                if if i + 1 == kept.len() { section.ends[1] } else { !goes_on(Some(i + 1)) } {
                    let (a, b) = (right_end, left_end);
                    blocks.quad(layer, face, [down(a, SKIRT_M), down(b, SKIRT_M), b, a]);
                }
            }
        }
        verges(section, area, ground, blocks);
    }
}

/// Metres along the middle of a strip to each of its samples; it goes on from where its section begins.
fn along(section: &Section, strip: &Strip) -> Vec<f64> {
    let middle = |i: usize| nalgebra::center(&strip.left[i], &strip.right[i]);
    let mut all = vec![section.s[0]];
    for i in 1..section.s.len() {
        all.push(all[i - 1] + (middle(i) - middle(i - 1)).xy().norm());
    }
    all
}

/// How far the corners of a part of a strip's piece, in the order of [`corners`], are from its inner border,
/// metres.
fn away_m(strip: &Strip, i: usize, [from, to]: Share) -> [f64; 4] {
    let at = |k: usize, share: f64| {
        let width_m = (strip.left[k] - strip.right[k]).xy().norm();
        width_m * if strip.lane.lane > 0 { share } else { 1.0 - share }
    };
    [at(i, from), at(i + 1, from), at(i + 1, to), at(i, to)]
}

/// How deep the face beside a raised strip reaches at a piece's start and end; none where the neighbour is as
/// high.
fn face_depth(strip: &Strip, neighbour: Option<&Strip>, i: usize, side: usize) -> Option<[f64; 2]> {
    let Some(neighbour) = neighbour.filter(|n| n.ground != Ground::Land) else { return Some([SKIRT_M; 2]) };
    let depth = [i, i + 1].map(|i| strip.raise[i][side] - neighbour.raise[i][1 - side]);
    (depth[0] > 0.0 || depth[1] > 0.0).then(|| depth.map(|d| d.max(0.0) + 0.02))
}

/// Whether a neighbour stands over a strip's piece on a side (0 is its right, 1 its left) and was not cut
/// away there.
fn is_kerbed(
    section: &Section,
    strip: &Strip,
    neighbour: Option<&Strip>,
    (i, side): (usize, usize),
    cover: &Cover,
) -> bool {
    let Some(neighbour) = neighbour.filter(|n| n.ground != Ground::Land) else { return false };
    let up = |i: usize| neighbour.raise[i][side] - strip.raise[i][1 - side];
    if up(i).min(up(i + 1)) <= LEAST_KERB_M {
        return false;
    }
    let kept = free_part(section, neighbour, i, cover);
    kept.is_some_and(|part| if side == 0 { part[1] == 1.0 } else { part[0] == 0.0 })
}

/// Grass that falls away from the outer edges, so that no gap shows between road and terrain.
fn verges(section: &Section, area: &Region, ground: &GroundLevels, blocks: &mut Blocks) {
    for side in 0..2 {
        let Some((edge, away)) = section.edge(side) else { continue };
        let profile: Vec<[Point3<f64>; 3]> = edge
            .iter()
            .zip(&away)
            .map(|(p, out)| VERGE_PROFILE.map(|(far, drop)| p + *out * far - Vector3::z() * drop))
            .collect();
        for i in 0..edge.len() - 1 {
            if !section.inside(i, area) {
                continue;
            }
            let elevated =
                ground.terrain.height(edge[i].x, edge[i].y) < edge[i].z - super::bridges::WALL_FROM_M;
            let (near, far) = (&profile[i], &profile[i + 1]);
            let mut probes = vec![near[1], near[2], far[1], far[2]];
            probes.push(Point3::from(0.5 * (near[1].coords + far[1].coords)));
            probes.push(Point3::from(0.5 * (near[2].coords + far[2].coords)));
            probes.push(Point3::from(0.5 * (near[0].coords + far[1].coords)));
            probes.push(Point3::from(0.5 * (near[1].coords + far[2].coords)));
            if elevated || probes.iter().any(|p| ground.cover.any(p.x, p.y)) {
                continue;
            }
            for k in 0..2 {
                let (a, b, c, d) = (near[k], far[k], far[k + 1], near[k + 1]);
                // Left of the road the profile runs to the left of s, right of it to the right.
                let quad = if side == 1 { [a, b, c, d] } else { [d, c, b, a] };
                blocks.quad(Layer::Terrain, GRASS, quad);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use opendrive::LaneType;
    use testkit::{map, one_way, road};

    use super::*;
    use crate::surfaces::Atlas;

    #[test]
    fn grass_falls_off_beside_an_edge_down_to_the_land() {
        // A tenth in the first metre, and from there on three quarters in 2.2 m.
        for (far_m, drop_m) in [(0.0, 0.02), (0.5, 0.06), (1.0, 0.10), (2.1, 0.475), (3.2, 0.85)] {
            assert!((beside_edge(-0.9, 0.0, far_m) + drop_m).abs() < 1e-9, "{far_m}");
        }
        // Higher land hides it, and beside a wall there is none.
        assert_eq!([beside_edge(0.3, 0.0, 0.5), beside_edge(-1.5, 0.0, 0.5)], [0.3, -1.5]);
        assert_eq!(beside_edge(-0.9, 0.0, 4.0), -0.9);
    }

    /// Height at y in the middle of a road whose sidewalk lies from y = -3.5 to -5.5 m, beside a lane of
    /// another road that reaches from `other_m` on to the right.
    fn height(other_m: f64, y: f64) -> f64 {
        let street = one_way(&[(LaneType::Driving, 3.5), (LaneType::Sidewalk, 2.0)]);
        let lane = one_way(&[(LaneType::Driving, 3.5)]);
        let roads =
            vec![road("1", [0.0, 0.0], 0.0, 60.0, street), road("2", [0.0, other_m], 0.0, 60.0, lane)];
        let map = map(roads);
        let atlas = Atlas::new(&map);
        let here = atlas.ground(&Region { min: [0.0, -32.0], max: [64.0, 32.0] });
        here.levels.height(30.0, y, 0.0)
    }

    /// What the roads of a street are made of whose lanes, from the reference line to the right, are of such
    /// types.
    fn made_of(lanes: &[LaneType]) -> Vec<Surface> {
        let lanes: Vec<(LaneType, f64)> = lanes.iter().map(|lane| (*lane, 3.0)).collect();
        made_of_roads(vec![road("1", [0.0, 0.0], 0.0, 60.0, one_way(&lanes))])
    }

    /// What lanes of 3 m below the x axis are made of, from there on.
    fn made_of_roads(roads: Vec<opendrive::Road>) -> Vec<Surface> {
        let map = map(roads);
        let atlas = Atlas::new(&map);
        let here = atlas.ground(&Region { min: [0.0, -32.0], max: [64.0, 32.0] });
        let mut made: Vec<(i32, Surface)> = Vec::new();
        for piece in here.surfaces().iter().filter(|piece| piece.layer == Layer::Road) {
            for k in 0..piece.mesh.triangles.len() {
                let middle = piece.mesh.corners(k).iter().map(|corner| corner.y).sum::<f32>() / 3.0;
                let lane = ((f64::from(middle) + piece.origin_m[1]) / -3.0).floor() as i32;
                let found = (lane, piece.mesh.part(k).surface);
                if !made.contains(&found) {
                    made.push(found);
                }
            }
        }
        made.sort_by_key(|(lane, _)| *lane);
        made.into_iter().map(|(_, surface)| surface).collect()
    }

    #[test]
    fn ways_through_a_junction_lie_over_one_another() {
        let map = testkit::crossing(false);
        let atlas = Atlas::new(&map);
        let here = atlas.ground(&Region { min: [-32.0, -32.0], max: [32.0, 32.0] });
        let heights = |is_wanted: fn(f64) -> bool| {
            let pieces = here.surfaces();
            let mut heights: Vec<f64> = pieces
                .iter()
                .filter(|piece| piece.layer == Layer::Road)
                .flat_map(|piece| {
                    piece
                        .mesh
                        .positions
                        .iter()
                        .map(|p| [0, 1, 2].map(|k| f64::from(p[k]) + piece.origin_m[k]))
                })
                .filter(|[x, y, _]| is_wanted(x.abs().max(y.abs())))
                .map(|[_, _, z]| z)
                .collect();
            heights.sort_by(f64::total_cmp);
            heights.dedup();
            heights
        };
        assert_eq!(heights(|away_m| away_m > 11.0), [0.0]);
        // Four ways cross in the middle.
        let apart = heights(|away_m| away_m < 9.0);
        let steps: Vec<f64> = apart.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.len() == 3 && steps.iter().all(|step| (step - OVER_M).abs() < 1e-9), "{apart:?}");
        assert!(apart[3] < 1e-4);
    }

    #[test]
    fn lanes_beside_sidewalks_have_kerbs() {
        use LaneType::{Driving, Median, Shoulder, Sidewalk};
        let kerbed = Surface::KerbedAsphalt;
        assert_eq!(made_of(&[Driving, Driving]), [Surface::Asphalt; 2]);
        assert_eq!(made_of(&[Driving, Sidewalk]), [kerbed(Kerbs::Right)]);
        assert_eq!(made_of(&[Median, Driving]), [kerbed(Kerbs::Left)]);
        assert_eq!(made_of(&[Median, Driving, Sidewalk]), [kerbed(Kerbs::Both)]);
        assert_eq!(made_of(&[Driving, Shoulder, Sidewalk]), [Surface::Asphalt, kerbed(Kerbs::Right)]);
        // Another road's lane on the same place takes the sidewalk away, and the kerb with it.
        let street = one_way(&[(Driving, 3.0), (Sidewalk, 3.0)]);
        let other = road("2", [0.0, -3.0], 0.0, 60.0, one_way(&[(Driving, 3.0)]));
        let both = vec![road("1", [0.0, 0.0], 0.0, 60.0, street), other];
        assert_eq!(made_of_roads(both), [Surface::Asphalt; 2]);
    }

    #[test]
    fn sidewalks_give_way_to_lanes_of_others_in_part() {
        // Raised by a kerb of 0.12 m. Beside the lane, all of it.
        for y in [-3.6, -5.4] {
            assert!((height(-5.6, y) - 0.12).abs() < 1e-9, "{y}");
        }
        // 0.3 m of 2 m driven over: two eighths go.
        for (y, want) in [(-3.6, 0.12), (-4.9, 0.12), (-5.3, 0.0)] {
            assert!((height(-5.2, y) - want).abs() < 1e-9, "{y}");
        }
        // 1.2 m: more than half, so it is no sidewalk there.
        let there = height(-4.3, -3.8);
        assert!(there < 0.1, "{there}");
    }
}
