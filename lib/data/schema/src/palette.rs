//! Further palettes of pictures.

use crate::BevClass;

/// Colour of a BEV class in the palette of Cityscapes (sRGB): what the original's `use_cityscapes_palette`
/// chooses.
#[must_use]
pub fn bev_cityscapes_rgb(class: BevClass) -> [u8; 3] {
    CITYSCAPES[class as usize]
}

/// By the number of the class.
const CITYSCAPES: [[u8; 3]; BevClass::COUNT] = [
    [128, 64, 128],
    [240, 80, 80],
    [227, 227, 227],
    [244, 35, 232],
    [157, 234, 50],
    [255, 165, 0],
    [200, 128, 128],
    [0, 0, 142],
    [0, 0, 70],
    [0, 60, 100],
    [0, 0, 230],
    [119, 11, 32],
    [255, 0, 0],
    [220, 20, 60],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_have_the_colours_of_semantic_images() {
        use crate::Tag;
        for (class, tag) in [
            (BevClass::Road, Tag::Road),
            (BevClass::Sidewalk, Tag::Sidewalk),
            (BevClass::TrafficCone, Tag::TrafficCone),
            (BevClass::Barrier, Tag::Barrier),
            (BevClass::Car, Tag::Car),
            (BevClass::Truck, Tag::Truck),
            (BevClass::Bus, Tag::Bus),
            (BevClass::Motorcycle, Tag::Motorcycle),
            (BevClass::Bicycle, Tag::Bicycle),
            (BevClass::Rider, Tag::Rider),
            (BevClass::Pedestrian, Tag::Pedestrian),
        ] {
            assert_eq!(bev_cityscapes_rgb(class), tag.camera_rgb(), "{class:?}");
        }
        assert_eq!(bev_cityscapes_rgb(BevClass::RoadLine), Tag::RoadLine.viewer_rgb());
    }
}
