//! Numbers of the published SimBEV2X dataset (its paper's tables and figures): what ours are shown beside.

use crate::{BevClass, DetectionClass, Tag};

/// Scenes by a whole number, in bins of one width.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneBins {
    /// Lower edge of the first bin.
    pub first: u64,
    /// Width of the bins.
    pub width: u64,
    /// Whether the last one has no end.
    pub open: bool,
    /// Scenes in each.
    pub scenes: &'static [u16],
}

/// The published dataset's numbers.
#[derive(Clone, Copy, Debug)]
pub struct Published;

impl Published {
    /// Frames of the published dataset.
    pub const FRAMES: f64 = 102_200.0;
    /// BEV masks and voxel grids.
    pub const GRIDS: f64 = 588_520.0;

    /// Scenes.
    pub const SCENES: f64 = 258.0;
    /// Frames of scenes added up, at 20 a second, as seconds.
    pub const SECONDS: f64 = Self::FRAMES / 20.0;
    /// Colour images.
    pub const IMAGES: f64 = 3_241_560.0;
    /// Data-collection vehicles and road-side units of all scenes added up.
    pub const AGENTS: [f64; 2] = [1248.0, 239.0];
    /// Accidents and road works of all scenes added up; ten or more count as ten.
    pub const HAZARDS: [f64; 2] = [746.0, 868.0];
    /// Cells of a BEV mask.
    pub const BEV_CELLS: f64 = 400.0 * 400.0;
    /// Voxels of a voxel grid.
    pub const VOXELS: f64 = 1280.0 * 1280.0 * 80.0;

    /// By whole seconds.
    pub const DURATIONS: SceneBins = SceneBins {
        first: 8,
        width: 1,
        open: false,
        scenes: &[3, 15, 12, 9, 16, 8, 15, 9, 12, 11, 9, 7, 9, 10, 10, 5, 12, 17, 10, 15, 11, 8, 8, 10, 7],
    };
    /// By data-collection vehicles.
    pub const VEHICLES: SceneBins =
        SceneBins { first: 2, width: 1, open: false, scenes: &[46, 32, 39, 40, 39, 26, 36] };
    /// By road-side units.
    pub const RSUS: SceneBins = SceneBins { first: 0, width: 1, open: false, scenes: &[162, 24, 25, 23, 24] };
    /// By accidents.
    pub const ACCIDENTS: SceneBins =
        SceneBins { first: 0, width: 1, open: true, scenes: &[36, 47, 48, 32, 41, 20, 15, 9, 4, 2, 4] };
    /// By road works.
    pub const ROAD_WORKS: SceneBins =
        SceneBins { first: 0, width: 1, open: true, scenes: &[14, 51, 51, 35, 38, 19, 14, 20, 7, 7, 2] };
    /// By vehicles of the background.
    pub const BACKGROUND_VEHICLES: SceneBins = SceneBins {
        first: 0,
        width: 20,
        open: true,
        scenes: &[22, 24, 17, 23, 14, 17, 18, 14, 6, 11, 5, 11, 4, 5, 8, 7, 6, 3, 4, 3, 36],
    };
    /// By pedestrians of the background.
    pub const PEDESTRIANS: SceneBins = SceneBins {
        first: 0,
        width: 20,
        open: true,
        scenes: &[50, 13, 16, 19, 19, 15, 18, 19, 12, 16, 11, 14, 9, 6, 7, 5, 2, 2, 0, 2, 3],
    };

    /// Scenes by clouds at the start (rows) and at the end (columns): none, low, moderate, heavy.
    pub const CLOUDINESS: [u64; 16] = [6, 15, 11, 15, 13, 24, 22, 12, 11, 26, 18, 19, 8, 14, 22, 22];
    /// The same by rain.
    pub const PRECIPITATION: [u64; 16] = [64, 6, 34, 20, 10, 4, 7, 5, 33, 10, 15, 14, 14, 3, 12, 7];
    /// The same by fog.
    pub const FOG_DENSITY: [u64; 16] = [57, 27, 19, 14, 33, 16, 13, 7, 17, 9, 6, 8, 12, 10, 6, 4];
    /// The same by the sun: night, dawn or dusk, day.
    pub const SUN_ALTITUDE: [u64; 9] = [26, 3, 47, 5, 0, 9, 50, 12, 106];

    /// Frames by valid objects of a class: 0 to 4, 5 to 9, ..., 100 and more; bins behind the last are empty.
    #[must_use]
    pub fn valid_per_frame(class: DetectionClass) -> &'static [u64] {
        use DetectionClass::*;
        match class {
            Car => &[
                2081, 2452, 6053, 8915, 8164, 9277, 8896, 8298, 6510, 4860, 3400, 3021, 3898, 4345, 2038,
                2052, 1991, 1442, 1059, 1692, 11_756,
            ],
            Truck => &[35_552, 30_664, 15_710, 9098, 4922, 3156, 1822, 704, 369, 142, 51, 10],
            Bus => &[96_743, 5318, 139],
            Motorcycle => &[63_009, 24_832, 11_378, 2884, 97],
            Bicycle => &[77_425, 19_425, 5144, 206],
            Pedestrian => &[
                25_278, 8899, 8211, 6407, 3784, 4392, 4194, 3918, 3378, 2748, 2217, 2085, 1627, 2602, 2773,
                1844, 1771, 1095, 1261, 2062, 11_654,
            ],
            TrafficLight => &[42_142, 18_139, 15_963, 12_176, 6265, 2370, 1938, 1659, 776, 768, 4],
            TrafficSign => &[
                20_909, 19_224, 17_588, 7908, 6713, 4743, 3332, 3497, 3282, 4129, 3994, 3011, 2237, 1053,
                343, 234, 3,
            ],
            TrafficCone => &[72_460, 16_394, 6448, 3630, 889, 1176, 956, 165, 82],
            Barrier => &[78_417, 12_543, 6701, 3935, 451, 134, 19],
        }
    }

    /// A class of boxes: all, valid ones, and frames with fewer than five valid ones.
    #[must_use]
    pub fn boxes(class: DetectionClass) -> [f64; 3] {
        use DetectionClass::*;
        match class {
            Car => [8_969_282.0, 5_209_929.0, 2081.0],
            Truck => [1_539_699.0, 923_630.0, 35_552.0],
            Bus => [206_571.0, 146_310.0, 96_743.0],
            Motorcycle => [893_555.0, 462_674.0, 63_009.0],
            Bicycle => [670_171.0, 315_425.0, 77_425.0],
            Pedestrian => [8_123_729.0, 4_337_994.0, 25_278.0],
            TrafficLight => [1_458_201.0, 964_036.0, 42_142.0],
            TrafficSign => [3_268_554.0, 1_991_774.0, 20_909.0],
            TrafficCone => [1_333_855.0, 422_427.0, 72_460.0],
            Barrier => [873_449.0, 324_883.0, 78_417.0],
        }
    }

    /// Cells of a BEV class.
    #[must_use]
    pub fn bev_cells(class: BevClass) -> f64 {
        use BevClass::*;
        match class {
            Road => 18_423_410_070.0,
            Hazard => 130_789_092.0,
            RoadLine => 2_203_938_665.0,
            Sidewalk => 5_764_613_682.0,
            Crosswalk => 530_387_859.0,
            TrafficCone => 1_435_393.0,
            Barrier => 3_920_504.0,
            Car => 586_268_097.0,
            Truck => 144_110_972.0,
            Bus => 49_656_143.0,
            Motorcycle => 7_145_620.0,
            Bicycle => 2_177_515.0,
            Rider => 4_059_365.0,
            Pedestrian => 24_345_256.0,
        }
    }

    /// Voxels of a tag, filled and unfilled; those that the published set has none of, 0.
    #[must_use]
    pub fn voxels(tag: Tag) -> [f64; 2] {
        use Tag::*;
        match tag {
            Road => [187_936_233_179.0; 2],
            Sidewalk => [189_922_307_774.0; 2],
            Building => [1_674_330_702_776.0, 900_817_475_055.0],
            Wall => [23_378_189_499.0; 2],
            Fence => [18_363_831_129.0; 2],
            Pole => [8_989_939_222.0, 8_579_662_196.0],
            TrafficLight => [531_133_151.0, 498_884_251.0],
            TrafficSign => [402_163_184.0, 400_975_040.0],
            Vegetation => [1_898_647_383_174.0, 1_198_452_609_539.0],
            Terrain => [436_551_954_377.0; 2],
            Pedestrian => [2_183_767_111.0, 2_094_463_408.0],
            Rider => [443_567_509.0, 443_130_500.0],
            Car => [69_524_669_086.0, 42_413_913_362.0],
            Truck => [29_759_074_139.0, 13_310_215_313.0],
            Bus => [19_140_621_987.0, 6_826_241_522.0],
            Motorcycle => [404_215_458.0, 397_784_633.0],
            Bicycle => [75_849_624.0, 75_835_868.0],
            Static => [8_419_060_788.0, 7_171_988_904.0],
            Dynamic => [4_702_667_653.0, 3_235_741_524.0],
            Other => [2_150_601_495.0; 2],
            Water => [379_943_469.0; 2],
            RoadLine => [10_380_085_422.0; 2],
            Ground => [20_361_839_035.0; 2],
            Bridge => [7_216_751_179.0, 6_893_309_672.0],
            RailTrack => [16_379_034_314.0, 11_447_168_465.0],
            GuardRail => [5_681_437_028.0, 5_591_909_462.0],
            TrafficCone => [65_986_418.0, 62_982_599.0],
            Barrier => [196_681_421.0, 187_344_182.0],
            Unlabeled | Sky | Train | Rock => [0.0; 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_add_up_to_the_published_totals() {
        let boxes = |k: usize| DetectionClass::ALL.iter().map(|&c| Published::boxes(c)[k]).sum::<f64>();
        assert_eq!((boxes(0), boxes(1)), (27_337_066.0, 15_099_082.0));
        let cells: f64 = BevClass::ALL.iter().map(|&c| Published::bev_cells(c)).sum();
        assert_eq!(cells, 27_876_258_233.0, "the figure's sum; the text's is 10 million less");
        let voxels = |k: usize| Tag::ALL.iter().map(|&t| Published::voxels(t)[k]).sum::<f64>();
        assert_eq!((voxels(0), voxels(1)), (4_636_519_690_601.0, 3_098_326_620_874.0));
    }

    #[test]
    fn every_scene_and_frame_is_in_a_bin() {
        let bins = [
            Published::DURATIONS,
            Published::VEHICLES,
            Published::RSUS,
            Published::ACCIDENTS,
            Published::ROAD_WORKS,
            Published::BACKGROUND_VEHICLES,
            Published::PEDESTRIANS,
        ];
        for bins in bins {
            assert_eq!(bins.scenes.iter().map(|&n| f64::from(n)).sum::<f64>(), Published::SCENES);
        }
        let sum = |bins: SceneBins| -> f64 {
            (bins.first..).zip(bins.scenes).map(|(value, &n)| value as f64 * f64::from(n)).sum()
        };
        assert_eq!([sum(Published::VEHICLES), sum(Published::RSUS)], Published::AGENTS);
        assert_eq!([sum(Published::ACCIDENTS), sum(Published::ROAD_WORKS)], Published::HAZARDS);
        for matrix in [
            &Published::CLOUDINESS[..],
            &Published::PRECIPITATION,
            &Published::FOG_DENSITY,
            &Published::SUN_ALTITUDE,
        ] {
            assert_eq!(matrix.iter().sum::<u64>() as f64, Published::SCENES);
        }
        for class in DetectionClass::ALL {
            let frames = Published::valid_per_frame(class);
            assert_eq!(frames.iter().sum::<u64>() as f64, Published::FRAMES, "{class:?}");
            assert_eq!(frames[0] as f64, Published::boxes(class)[2]);
        }
    }
}
