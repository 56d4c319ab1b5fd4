//! Rivers and lakes. OpenDRIVE has no word for them: they become flat objects of no type, named for what they
//! are.

use opendrive::{Corner, Network, Object, Orientation, Outline};

use crate::ids::Ids;
use crate::path::Path;
use crate::profile::Profile;

/// A level surface of water.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Water {
    /// `River`, `Lake`: what its name says is how it is known as water.
    pub(crate) name: String,
    /// Its edge, metres east and north.
    pub(crate) ring_m: Vec<[f64; 2]>,
    /// Height of its surface, metres.
    pub(crate) z_m: f64,
}

impl Water {
    /// A band of water along a line.
    pub(crate) fn along(name: &str, line_m: &[[f64; 2]], half_width_m: f64, z_m: f64) -> Self {
        let last = line_m.len().saturating_sub(1);
        let aside = |i: usize, side_m: f64| {
            let (a, b) = (line_m[i.saturating_sub(1)], line_m[(i + 1).min(last)]);
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let length = (dx * dx + dy * dy).sqrt().max(1e-9);
            [line_m[i][0] - dy / length * side_m, line_m[i][1] + dx / length * side_m]
        };
        let left = (0..line_m.len()).map(|i| aside(i, half_width_m));
        let right = (0..line_m.len()).rev().map(|i| aside(i, -half_width_m));
        Self { name: name.to_owned(), ring_m: left.chain(right).collect(), z_m }
    }
}

/// Hangs every water onto the network's first road, its corners turned to the world's axes.
pub(crate) fn waters(ids: &mut Ids, network: &mut Network, waters: &[Water]) {
    let Some(road) = network.roads.first_mut() else { return };
    let start = Path::of(road).pose_at(0.0);
    let z_m = Profile::of(&road.elevation).at(0.0);
    for water in waters {
        let corner = |[x, y]: &[f64; 2]| Corner::Local {
            u_m: x - start.x_m,
            v_m: y - start.y_m,
            z_m: 0.0,
            height_m: 0.0,
        };
        let corners = water.ring_m.iter().map(corner).collect();
        road.objects.push(Object {
            id: ids.next(),
            name: water.name.clone(),
            kind: "none".into(),
            z_offset_m: water.z_m - z_m,
            hdg_rad: -start.heading_rad,
            orientation: Orientation::Both,
            outlines: vec![Outline { closed: true, corners, ..Outline::default() }],
            ..Object::default()
        });
    }
}
