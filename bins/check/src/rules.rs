//! What is checked, and how exactly.

macro_rules! rules {
    ($( $rule:ident $name:literal: $says:literal, )+) => {
        /// A check.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub(crate) enum Rule {
            $( #[doc = $says] $rule, )+
        }

        impl Rule {
            /// All checks, in the order of the report.
            pub(crate) const ALL: &[Self] = &[$( Self::$rule ),+];

            /// Its name in reports.
            pub(crate) fn name(self) -> &'static str {
                match self {
                    $( Self::$rule => $name, )+
                }
            }

            /// What must hold, with its tolerance.
            pub(crate) fn says(self) -> &'static str {
                match self {
                    $( Self::$rule => $says, )+
                }
            }
        }
    };
}

rules! {
    Files "files": "every file that a manifest or the configuration names is there and can be read; tables say whose scene they are",
    Numbers "numbers": "no number is NaN or infinite",
    Times "times": "frames count from 0 without a gap, in steps of every_n_frames, frame k is at k x 0.05 s within 1 ns, for every agent and sensor",
    Units "units": "every value lies in its unit's range, every word in its vocabulary, lists of a row are equally long",
    Calibration "calibration": "poses, intrinsics, lenses and rates in sensor files are those of the configuration within 1e-9",
    Poses "poses": "agents are where the log has them within 1e-6; objects move as their velocities say within 0.5 m/s and 0.5 rad/s",
    Seats "seats": "who sits is a walker who stands still on a bench of the log: the rear of its box at the back rest within 5 cm, its middle on one of two places and the seat as high as the bench's within 1 cm, looking away from the back rest; no two have one place",
    BoxList "box list": "an agent lists exactly the objects that annotation asks for nearer than the radius, within 1 mm",
    BoxShape "box shape": "corners, centre, size, rotation, velocity, distance, angle, tags (or some of them) and state of a box are those of the log within 1e-5, and the agent's own is marked",
    ImageIds "image ids": "an instance image shows only ids of the log, each with a tag of its list; 0 is the sky or the horizon's land, vegetation and buildings",
    PointIds "point ids": "lidar and radar return only ids of the log, each with a tag of its list; of a rolling scan (here and below) what moves is carried on with its object from when the ray was fired to the frame's time; what fog and rain send back is left out",
    ScanTimes "scan times": "a lidar's return was fired at the frame's time, or in a rolling scan when its azimuth says, within half a slice and a column",
    Returns "returns": "returns of a beam count from 1 to their number, at growing distance (within noise) and no more than asked for; fog and rain have id, tag and incidence 0, where there is fog or rain and the lidar feels it",
    Semantic "semantic": "a semantic image shows the colours of the instance image's tags",
    Pictures "pictures": "images have the size that their calibration states, visible.parquet the pixels of the instance images",
    BoxPixels "box pixels": "an object's pixels lie within its projected box and 2 pixels around it (open doors 1.3 m further)",
    FlatBoxes "boxes 2d": "boxes_2d has each object with a class that an instance image shows, its pixels and the rectangle around them; the amodal rectangle holds that, lies in the projected box and 2 pixels around it and is at least 0.3 of it each way; shares follow from the rectangles (what others hide: an upper bound)",
    BoxPoints "box points": "a return of an object lies in its box and 0.1 m around it (open doors 1.3 m further)",
    DepthLidar "depth": "depth equals lidar range within 5 cm + 0.5 %, for more than half of the returns of an object whose pixel and 8 neighbours show it",
    Flow "flow": "flow equals the motion of object and camera in the log within 0.1 pixels + 2 % for what is fixed, 1.1 pixels + 2 % for bodies of vehicles, and as far again as the vehicle has come as low as wheels are (0.85 m, lorries and buses 1.25 m); for 9 of 10 pixels of an object; not for walkers, riders, bicycles and vehicles with an open door",
    FlowIds "flow ids": "a pixel amid its object, moved back by its flow, finds it within 1 pixel in the previous frame, or something nearer, for half of an object, which may be a fence, and a fifth of one of wires",
    VoxelPoints "voxels": "a return without noise lies in a voxel of its tag, or of one that goes before it, within 5 mm",
    VoxelFill "filling": "filled grids hold every voxel of the unfilled ones, and more only there",
    Cells "voxel rows": "lists of occupied voxels are in C order; each has a row in the files of ids and flow; its id is one of the log with the voxel's tag, and a box of that id reaches into the voxel or within 0.1 m of it (open doors 1.3 m further)",
    CellFlow "voxel flow": "a voxel's flow is the motion of its object in the log within 0.05 m/s + 1 %, for all of what stands and a quarter of the voxels of a vehicle that moves and has 24; the mean of a walker's within 0.5 m/s + 40 %; each of the others, of wheels and limbs, within 10 m/s + 110 %",
    Observed "observed": "a lidar sweeps at every frame that has a grid; cells of the lidars' returns are occupied and no others (edges within 1 mm either way), those on a ray's way are not unobserved, free ones are on a ray's way (samples of both)",
    BevObjects "bev objects": "an object's cells lie in the footprint of a box with its tag and half a cell's diagonal and 0.1 m around it",
    BevPresent "bev presence": "a box on the agent's own ground has a cell in its footprint and a cell around it",
    BevGround "bev ground": "returns from roads and sidewalks lie on cells of their class or within 1.5 cells of one",
    BevMapped "bev map": "where the vector map's ground leads from the agent without other decks, cells amid lanes, sidewalks (8 m from where lanes run over them) and crosswalks (on roads) are set (single cells and pairs aside), and lines beside driving lanes have a cell within one",
    BevStray "bev strays": "road cells lie within 7 m of the vector map's lanes and junctions, cells of sidewalks within 9 m, of crosswalks and lines within one cell of its own",
    BevIds "bev ids": "cells of objects have an id of the log with a class that they show, in the footprint of its box as above, and no other cells have one",
    BevHeights "bev heights": "paved cells have a height: the agent's within 0.5 m where it stands, the vector map's within 0.3 m below and 0.5 m above (kerbs), that of returns within 0.3 m",
    BevPaint "bev paint": "stop lines are those of the vector map within one cell",
    BevHazard "bev hazards": "hazard cells lie in an area of scene.json and a cell around it",
    Counts "counts": "points (edges within 1e-4 m either way), pixels, flags and difficulties of boxes and partial statistics equal a recount",
    Tracks "tracks": "merged lists, tracks and the spans in which agents saw them equal a recount from the agents' lists",
    Windows "windows": "windows of tracks are there for what may move, with the places of its boxes and the headings and velocities of the log (1e-5), and zeros where no agent lists it",
    Gnss "gnss": "fixes equal the pose within 6.5 standard deviations, exactly (1e-6 m) without noise",
    Imu "imu": "readings equal the change of the pose within 6.5 standard deviations, exactly (1e-4) without noise",
    RadarPresence "radar presence": "every radar has a return in every frame, as readers of the published set expect",
    RadarVelocity "radar velocity": "a return's velocity is that of the body hit within 0.05 m/s",
    Statistics "statistics": "the dataset's tables of boxes, cells and voxels equal a recount",
}

impl Rule {
    /// Rules that hold labels and readings against the log, the map or the world, or against ids and tags of
    /// points: a scene that was imported has none of these, and the values in their place were taken from its
    /// labels.
    pub(crate) const OF_THE_LOG: &[Self] = &[
        Self::Poses,
        Self::Seats,
        Self::BoxList,
        Self::BoxShape,
        Self::ImageIds,
        Self::PointIds,
        Self::Flow,
        Self::FlowIds,
        Self::BevMapped,
        Self::BevStray,
        Self::BevHazard,
        Self::Gnss,
        Self::Imu,
        Self::RadarVelocity,
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unlike() {
        let mut names: Vec<_> = Rule::ALL.iter().map(|rule| rule.name()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Rule::ALL.len());
    }
}
