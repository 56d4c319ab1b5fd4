//! Numbers of the published SimBEV2X dataset (arXiv, tables and figure 3): what ours are printed beside.

use schema::{BevClass, DetectionClass, Tag};

/// Frames of the published dataset.
pub(crate) const FRAMES: f64 = 102_200.0;
/// BEV masks and voxel grids.
pub(crate) const GRIDS: f64 = 588_520.0;

/// A class of boxes: all, valid ones, and frames with fewer than five valid ones.
pub(crate) fn boxes(class: DetectionClass) -> [f64; 3] {
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
pub(crate) fn bev_cells(class: BevClass) -> f64 {
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
pub(crate) fn voxels(tag: Tag) -> [f64; 2] {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_add_up_to_the_published_totals() {
        let boxes = |k: usize| DetectionClass::ALL.iter().map(|&c| boxes(c)[k]).sum::<f64>();
        assert_eq!((boxes(0), boxes(1)), (27_337_066.0, 15_099_082.0));
        let cells: f64 = BevClass::ALL.iter().map(|&c| bev_cells(c)).sum();
        assert_eq!(cells, 27_876_258_233.0, "the figure's sum; the text's is 10 million less");
        let voxels = |k: usize| Tag::ALL.iter().map(|&t| voxels(t)[k]).sum::<f64>();
        assert_eq!((voxels(0), voxels(1)), (4_636_519_690_601.0, 3_098_326_620_874.0));
    }
}
