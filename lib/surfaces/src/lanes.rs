//! Lane surfaces, kerbs and verges.

use nalgebra::{Point3, Vector3};
use schema::Tag;
use schema::geometry::{Part, Surface};

use crate::blocks::Blocks;
use crate::cover::{Cover, Facet, PATCH_BELOW_M};
use crate::ground::GroundLevels;
use crate::materials::{ASPHALT, GRASS, PAVEMENT};
use crate::region::Region;
use crate::sections::{Ground, Section, Strip, WIDEST_M};
use schema::Layer;

const WASTE: Part = Part::new(Tag::Ground, Surface::Asphalt, [0.12, 0.12, 0.12]);
const BALLAST: Part = Part::new(Tag::RailTrack, Surface::Plain, [0.17, 0.155, 0.14]);
/// Faces of raised strips, but for their tag.
const KERB: Part = Part::new(Tag::Sidewalk, Surface::Concrete, [0.42, 0.42, 0.41]);
const MEDIAN: Part = Part::new(Tag::Ground, Surface::Concrete, [0.30, 0.29, 0.27]);
/// Kerb faces reach this far below the edge where nothing joins it, metres.
const SKIRT_M: f64 = 0.4;
/// A surface this much nearer in height belongs to the same level, metres.
const SAME_LEVEL_M: f64 = 2.0;
/// Cross-section of the grass beside a road: distance from the edge and drop, metres.
const VERGE_PROFILE: [(f64, f64); 3] = [(0.0, 0.02), (1.0, 0.10), (3.2, 0.85)];

/// Lane surfaces for point queries. Those of no use to vehicles are left out where vehicles of another road drive over
/// them; of railways a patch remains there, so that the road goes on to where the ballast begins.
pub(crate) fn cover(sections: &[&Section], region: &Region) -> Cover {
    let region = region.grown(WIDEST_M);
    let mut cover = Cover::new(region);
    let mut add = |ground: fn(Ground) -> bool| {
        let mut facets: Vec<Facet> = Vec::new();
        for section in sections {
            for strip in section.strips.iter().filter(|s| ground(s.ground)) {
                for i in (0..section.s.len() - 1).filter(|i| section.inside(*i, &region)) {
                    let mut quad = corners(strip, i);
                    let (mut road, mut ground) = (Some(section.road), strip.ground);
                    if !free_of_traffic(section, strip, i, &cover) {
                        if ground != Ground::Track {
                            continue;
                        }
                        (road, ground) = (None, Ground::Paved);
                        quad.iter_mut().for_each(|p| p.z -= PATCH_BELOW_M);
                    }
                    let [a, b, c, d] = quad;
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

/// Whether no paved surface of another road at the same level meets a piece of a strip that is of no use to vehicles.
pub(crate) fn free_of_traffic(section: &Section, strip: &Strip, i: usize, cover: &Cover) -> bool {
    if strip.ground == Ground::Paved {
        return true;
    }
    let quad = corners(strip, i);
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
        for (k, strip) in section.strips.iter().enumerate() {
            let (layer, top) = match strip.ground {
                Ground::Paved => (Layer::Road, ASPHALT),
                Ground::Waste => (Layer::Median, WASTE),
                Ground::Track => (Layer::Track, BALLAST),
                Ground::Walk => (Layer::Sidewalk, PAVEMENT),
                Ground::Median => (Layer::Median, MEDIAN),
                Ground::Land => continue,
            };
            // A face is what its strip is: an object has no tags beside its own.
            let face = Part { tag: layer.tag(), ..KERB };
            let right = k.checked_sub(1).and_then(|k| section.strips.get(k));
            let left = section.strips.get(k + 1);
            let kept: Vec<bool> = (0..here.len())
                .map(|i| asked(i) && free_of_traffic(section, strip, i, &ground.cover))
                .collect();
            for i in (0..kept.len()).filter(|i| kept[*i] && here[*i]) {
                blocks.quad(layer, top, corners(strip, i));
                if !strip.ground.raised() && strip.raise[i] == [0.0; 2] {
                    continue;
                }
                let down = |p: Point3<f64>, by: f64| Point3::new(p.x, p.y, p.z - by);
                if let Some(depth) = face_depth(strip, left, i, 0) {
                    let (a, b) = (strip.left[i + 1], strip.left[i]);
                    blocks.quad(layer, face, [down(a, depth[1]), down(b, depth[0]), b, a]);
                }
                if let Some(depth) = face_depth(strip, right, i, 1) {
                    let (a, b) = (strip.right[i], strip.right[i + 1]);
                    blocks.quad(layer, face, [down(a, depth[0]), down(b, depth[1]), b, a]);
                }
                // Where the strip begins or ends for good, or was cut away, its end is closed.
                if if i == 0 { section.ends[0] } else { !kept[i - 1] } {
                    let (a, b) = (strip.left[i], strip.right[i]);
                    blocks.quad(layer, face, [down(a, SKIRT_M), down(b, SKIRT_M), b, a]);
                }
                if if i + 1 == kept.len() { section.ends[1] } else { !kept[i + 1] } {
                    let (a, b) = (strip.right[i + 1], strip.left[i + 1]);
                    blocks.quad(layer, face, [down(a, SKIRT_M), down(b, SKIRT_M), b, a]);
                }
            }
        }
        verges(section, area, ground, blocks);
    }
}

/// How deep the face beside a raised strip reaches at a piece's start and end; none where the neighbour is as high.
fn face_depth(strip: &Strip, neighbour: Option<&Strip>, i: usize, side: usize) -> Option<[f64; 2]> {
    let Some(neighbour) = neighbour.filter(|n| n.ground != Ground::Land) else { return Some([SKIRT_M; 2]) };
    let depth = [i, i + 1].map(|i| strip.raise[i][side] - neighbour.raise[i][1 - side]);
    (depth[0] > 0.0 || depth[1] > 0.0).then(|| depth.map(|d| d.max(0.0) + 0.02))
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
