//! The outer edges of streets and railways: where land begins.

use nalgebra::{Point3, Vector3};

use surfaces::{Ground, Section};

/// One side of a road, from its start to its end.
pub(crate) struct Frontage {
    /// Names its random stream: twice the road's index, plus one on the left.
    pub(crate) entity: u64,
    points: Vec<Point3<f64>>,
    away: Vec<Vector3<f64>>,
    /// Whether the outermost lane at each point is a sidewalk, and its width, metres.
    walk_m: Vec<f64>,
    along_m: Vec<f64>,
    /// Speed limit of the road, m/s (0: unknown).
    pub(crate) speed_mps: f64,
    /// Whether a railway runs at the edge.
    pub(crate) track: bool,
}

/// A place on a frontage.
pub(crate) struct Spot {
    pub(crate) point: Point3<f64>,
    /// Horizontal direction away from the road.
    pub(crate) away: Vector3<f64>,
    /// Width of the sidewalk, metres; 0 where there is none.
    pub(crate) walk_m: f64,
}

impl Spot {
    /// The place `far_m` beyond the edge (negative: on the sidewalk) and `along_m` sideways.
    pub(crate) fn beside(&self, far_m: f64, along_m: f64) -> Point3<f64> {
        let along = Vector3::new(-self.away.y, self.away.x, 0.0);
        self.point + self.away * far_m + along * along_m
    }

    /// Yaw of something that looks at the road.
    pub(crate) fn facing_yaw(&self) -> f64 {
        frames::math::atan2(-self.away.y, -self.away.x)
    }
}

impl Frontage {
    pub(crate) fn length_m(&self) -> f64 {
        self.along_m.last().copied().unwrap_or(0.0)
    }

    /// The place at a distance from the start.
    pub(crate) fn at(&self, along_m: f64) -> Option<Spot> {
        let k = self.along_m.partition_point(|d| *d <= along_m).clamp(1, self.along_m.len().checked_sub(1)?);
        let (d0, d1) = (self.along_m[k - 1], self.along_m[k]);
        let share = if d1 > d0 { ((along_m - d0) / (d1 - d0)).clamp(0.0, 1.0) } else { 0.0 };
        let away = self.away[k - 1] + (self.away[k] - self.away[k - 1]) * share;
        Some(Spot {
            point: self.points[k - 1] + (self.points[k] - self.points[k - 1]) * share,
            away: away.try_normalize(1e-9)?,
            walk_m: self.walk_m[k - 1].min(self.walk_m[k]),
        })
    }
}

/// Both sides of every road outside junctions, by road.
pub(crate) fn frontages(sections: &[&Section]) -> Vec<Frontage> {
    let mut found: Vec<Frontage> = Vec::new();
    for side in 0..2u64 {
        for section in sections.iter().filter(|s| !s.junction) {
            let Some((edge, away)) = section.edge(side as usize) else { continue };
            let Some(strip) = section.outermost(side as usize) else { continue };
            let entity = 2 * u64::from(section.road) + side;
            if found.last().is_none_or(|f| f.entity != entity) {
                found.push(Frontage {
                    entity,
                    points: Vec::new(),
                    away: Vec::new(),
                    walk_m: Vec::new(),
                    along_m: Vec::new(),
                    speed_mps: 0.0,
                    track: strip.ground == Ground::Track,
                });
            }
            let Some(front) = found.last_mut() else { continue };
            front.speed_mps = front.speed_mps.max(section.speed_mps);
            for (i, (point, away)) in edge.iter().zip(away).enumerate() {
                let step = front.points.last().map_or(0.0, |last| (point - last).norm());
                let walk =
                    if strip.ground == Ground::Walk { (strip.left[i] - strip.right[i]).norm() } else { 0.0 };
                front.along_m.push(front.length_m() + step);
                front.points.push(*point);
                front.away.push(away);
                front.walk_m.push(walk);
            }
        }
    }
    found.sort_by_key(|f| f.entity);
    found
}
