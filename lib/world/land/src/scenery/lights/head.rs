//! Heads of traffic lights.

use frames::math::sin_cos;
use nalgebra::{Point3, Vector3};
use schema::footprint::LightMount;
use schema::{ActorKind, Attribute, Attributes, Tag};

use crate::scenery::draft::Draft;
use crate::scenery::site::Site;

/// A kind of head: its model, its length, width and height, metres.
pub(super) struct HeadKind {
    model: &'static str,
    pub(super) size_m: [f64; 3],
}

/// For drivers.
pub(super) const SIGNAL: HeadKind = HeadKind { model: "light.signal", size_m: [0.36, 0.42, 1.10] };
/// For people who walk.
pub(super) const WALKERS: HeadKind = HeadKind { model: "light.walkers", size_m: [0.26, 0.25, 0.50] };

/// From the axis of a pole to the back of what it carries, metres.
pub(super) const BEHIND_M: f64 = 0.07;

/// A head that looks along `yaw_rad`; its pole, or the one that it hangs on, stands at `foot`.
pub(super) fn head(
    site: &Site<'_>,
    kind: &HeadKind,
    shows: &str,
    (foot, yaw_rad): (Point3<f64>, f64),
    mount: LightMount,
) -> Draft {
    let ground_z = site.levels().height(foot.x, foot.y, foot.z);
    let (s, c) = sin_cos(yaw_rad);
    let (face, left) = (Vector3::new(c, s, 0.0), Vector3::new(-s, c, 0.0));
    let arm = f64::from(mount.arm_m);
    let at =
        foot + left * if mount.pole_right { -arm } else { arm } + face * (0.5 * kind.size_m[0] + BEHIND_M);
    let xyz = [at.x, at.y, ground_z + f64::from(mount.height_m)];
    let mut draft =
        Draft::new(ActorKind::TrafficLight, kind.model, Tag::TrafficLight, kind.size_m, xyz, yaw_rad);
    draft.tags.insert(0, Tag::Pole);
    draft.variant = mount.to_variant();
    draft.opendrive_id = Some(shows.to_owned());
    draft.attributes = Attributes::new().with(Attribute::GroundZ, format_args!("{ground_z:.3}"));
    draft
}
