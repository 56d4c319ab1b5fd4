//! Free, occupied and unobserved cells of a voxel grid, from the rays of lidars: a ray frees every cell
//! between its sensor and its return, the cell of the return is occupied. Rays without a return say nothing.
//! Cells are walked by Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", Eurographics
//! 1987; distances to faces are computed anew for each, so that no error adds up along a ray.

use frames::{Agent, Pose, Sensor};
use nalgebra::Point3;

/// What rays say of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum RayState {
    /// No ray came there.
    Unobserved = 0,
    /// A ray passed.
    Free = 1,
    /// A ray came back from there.
    Occupied = 2,
}

/// Where cells are, in the frame of the agent that carries them.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Cells along x (forward), y (left), z (up).
    pub shape: [usize; 3],
    /// The most negative corner, metres.
    pub corner_m: [f64; 3],
    /// Side of a cell, metres.
    pub cell_m: f64,
}

/// Returns of a lidar at one frame. The coordinates are equally many, metres, in the sensor's frame; the rays
/// start at its origin.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'a> {
    /// Where the lidar sits.
    pub agent_from_sensor: Pose<Agent, Sensor>,
    #[allow(missing_docs, reason = "the names are their own documentation")]
    pub x: &'a [f32],
    #[allow(missing_docs, reason = "the names are their own documentation")]
    pub y: &'a [f32],
    #[allow(missing_docs, reason = "the names are their own documentation")]
    pub z: &'a [f32],
}

/// What the rays of some lidars say of each cell, as values of [`RayState`]; z runs fastest, then y. A return
/// makes its cell occupied whatever passed it. `cells` is working memory for the answer.
///
/// ```
/// use labels::carve::{Lattice, RayState, Sweep, carve};
///
/// // Three cells of a metre ahead; a lidar in the first one, a return in the second.
/// let lattice = Lattice { shape: [3, 1, 1], corner_m: [0.0; 3], cell_m: 1.0 };
/// let agent_from_sensor = frames::Pose::from_xyz_rpy([0.5, 0.5, 0.5], [0.0; 3]);
/// let sweep = Sweep { agent_from_sensor, x: &[1.0], y: &[0.0], z: &[0.0] };
/// let mut cells = Vec::new();
/// carve(&lattice, &[sweep], &mut cells);
/// assert_eq!(cells, [RayState::Free as u8, RayState::Occupied as u8, RayState::Unobserved as u8]);
/// ```
pub fn carve(lattice: &Lattice, sweeps: &[Sweep<'_>], cells: &mut Vec<u8>) {
    cells.clear();
    cells.resize(lattice.shape.iter().product(), RayState::Unobserved as u8);
    for_each_ray(lattice, sweeps, |from, to| {
        walk(lattice.shape, from, to, |cell| cells[cell] = RayState::Free as u8);
    });
    for_each_ray(lattice, sweeps, |_, to| {
        if let Some(cell) = lattice.holding(to) {
            cells[cell] = RayState::Occupied as u8;
        }
    });
}

/// Start and end of every ray, in cells from the lattice's corner.
fn for_each_ray(lattice: &Lattice, sweeps: &[Sweep<'_>], mut each: impl FnMut([f64; 3], [f64; 3])) {
    for sweep in sweeps {
        let in_cells = |point: Point3<f64>| {
            [0, 1, 2].map(|axis| (point[axis] - lattice.corner_m[axis]) / lattice.cell_m)
        };
        let from = in_cells(sweep.agent_from_sensor * Point3::origin());
        for ((&x, &y), &z) in sweep.x.iter().zip(sweep.y).zip(sweep.z) {
            let point = Point3::new(f64::from(x), f64::from(y), f64::from(z));
            each(from, in_cells(sweep.agent_from_sensor * point));
        }
    }
}

impl Lattice {
    /// Where in a list of cells that one is which holds a point, given in cells from the corner; none
    /// outside.
    fn holding(&self, at: [f64; 3]) -> Option<usize> {
        let is_inside = (0..3).all(|axis| at[axis] >= 0.0 && at[axis] < self.shape[axis] as f64);
        is_inside.then(|| index(self.shape, at.map(|x| x as usize)))
    }
}

fn index(shape: [usize; 3], [i, j, k]: [usize; 3]) -> usize {
    (i * shape[1] + j) * shape[2] + k
}

/// Calls `pass` with every cell that a segment touches within the lattice, from its start on.
fn walk(shape: [usize; 3], from: [f64; 3], to: [f64; 3], mut pass: impl FnMut(usize)) {
    // So small a way leaves no cell, and what divides by it is no number.
    let way = [0, 1, 2].map(|axis| to[axis] - from[axis]).map(|d| if d.abs() < 1e-12 { 0.0 } else { d });
    if !way.iter().all(|d| d.is_finite()) {
        return;
    }
    let per_cell = way.map(|d| 1.0 / d);
    // Where on the segment it comes in and goes out; an axis along which it does not move must hold it.
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        let side = shape[axis] as f64;
        if way[axis] == 0.0 {
            if from[axis] < 0.0 || from[axis] >= side {
                return;
            }
            continue;
        }
        let faces = [-from[axis] * per_cell[axis], (side - from[axis]) * per_cell[axis]];
        enter = enter.max(faces[0].min(faces[1]));
        leave = leave.min(faces[0].max(faces[1]));
    }
    if enter >= leave {
        return;
    }
    let mut cell = [0, 1, 2].map(|axis| {
        let at = from[axis] + way[axis] * enter;
        (at.floor().max(0.0) as usize).min(shape[axis] - 1)
    });
    // Where on the segment the cell's far face is, along an axis.
    let far_face = |cell: &[usize; 3], axis: usize| {
        let face = if way[axis] > 0.0 { cell[axis] + 1 } else { cell[axis] };
        if way[axis] == 0.0 { f64::INFINITY } else { (face as f64 - from[axis]) * per_cell[axis] }
    };
    let mut next = [0, 1, 2].map(|axis| far_face(&cell, axis));
    loop {
        pass(index(shape, cell));
        let axis = match next {
            [x, y, z] if x <= y && x <= z => 0,
            [_, y, z] if y <= z => 1,
            _ => 2,
        };
        if next[axis] >= leave {
            return;
        }
        if way[axis] > 0.0 {
            cell[axis] += 1;
        } else if cell[axis] > 0 {
            cell[axis] -= 1;
        } else {
            return;
        }
        if cell[axis] >= shape[axis] {
            return;
        }
        next[axis] = far_face(&cell, axis);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Length of a segment within a cell and a margin around it, as a share of the segment, by clipping at
    /// six planes.
    fn share_within(cell: [usize; 3], margin: f64, from: [f64; 3], to: [f64; 3]) -> f64 {
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let (low, high) = (cell[axis] as f64 - margin, cell[axis] as f64 + 1.0 + margin);
            let way = to[axis] - from[axis];
            if way == 0.0 {
                if from[axis] < low || from[axis] > high {
                    return 0.0;
                }
                continue;
            }
            let (a, b) = ((low - from[axis]) / way, (high - from[axis]) / way);
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        }
        (last - first).max(0.0)
    }

    fn segment() -> impl Strategy<Value = [[f64; 3]; 2]> {
        // Whole and half numbers too: along faces, through edges and corners.
        let number = prop_oneof![-4.0..12.0, (-8..24).prop_map(|n| 0.5 * f64::from(n))];
        let point = [number.clone(), number.clone(), number];
        [point.clone(), point]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn just_the_cells_on_the_way_are_passed([from, to] in segment()) {
            let shape = [8, 7, 5];
            let mut passed = vec![false; shape.iter().product()];
            walk(shape, from, to, |cell| passed[cell] = true);
            for i in 0..shape[0] {
                for j in 0..shape[1] {
                    for k in 0..shape[2] {
                        let cell = [i, j, k];
                        let is_passed = passed[index(shape, cell)];
                        // A ray that only grazes a face may be told to either side.
                        let surely = share_within(cell, -1e-9, from, to) > 1e-9;
                        let perhaps = share_within(cell, 1e-9, from, to) > 0.0;
                        prop_assert!(is_passed || !surely, "{cell:?} is missed");
                        prop_assert!(!is_passed || perhaps, "{cell:?} is not on the way");
                    }
                }
            }
        }
    }

    #[test]
    fn a_return_outlasts_a_ray_that_passes() {
        let lattice = Lattice { shape: [4, 1, 1], corner_m: [-2.0, -0.5, 1.0], cell_m: 1.0 };
        // Looks backward: a return three metres away comes first, then one a metre away on the same line.
        let agent_from_sensor = Pose::from_xyz_rpy([1.5, 0.0, 1.5], [0.0, 0.0, frames::deg(180.0)]);
        let sweep = Sweep { agent_from_sensor, x: &[3.0, 1.0], y: &[0.0; 2], z: &[0.0; 2] };
        let mut cells = vec![9; 7];
        carve(&lattice, &[sweep], &mut cells);
        assert_eq!(cells, [2, 1, 2, 1]);
    }

    #[test]
    fn what_is_outside_says_what_it_passes() {
        let lattice = Lattice { shape: [2, 2, 1], corner_m: [0.0; 3], cell_m: 0.5 };
        let agent_from_sensor = Pose::from_xyz_rpy([-3.0, 0.75, 0.25], [0.0; 3]);
        let sweep = Sweep { agent_from_sensor, x: &[9.0, f32::NAN], y: &[0.0; 2], z: &[0.0; 2] };
        let mut cells = Vec::new();
        carve(&lattice, &[sweep], &mut cells);
        assert_eq!(cells, [0, 1, 0, 1], "the row at y of 0.75 m, from end to end");
    }
}
