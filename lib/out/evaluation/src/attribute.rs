//! nuScenes' attributes by their numbers.

use schema::{DetectionClass, NUSCENES_ATTRIBUTES, STANDING_MPS};

use crate::class::BoxClass;

/// Its number among [`NUSCENES_ATTRIBUTES`].
pub(crate) fn number_of_attribute(name: &str) -> Option<u8> {
    NUSCENES_ATTRIBUTES.iter().position(|(known, _)| *known == name).map(|i| i as u8)
}

/// The attribute that follows from what a box is and its velocity in the plane, m/s; none where that is not
/// known, or where the class has none.
pub(crate) fn by_speed(class: BoxClass, [x, y]: [f64; 2]) -> Option<u8> {
    use DetectionClass::{Bicycle, Bus, Car, Motorcycle, Pedestrian, Truck};
    let speed_mps = (x * x + y * y).sqrt();
    if speed_mps.is_nan() {
        return None;
    }
    let moves = speed_mps > STANDING_MPS;
    let name = match class.in_store()? {
        Car | Truck | Bus if moves => "vehicle.moving",
        Car | Truck | Bus => "vehicle.stopped",
        Motorcycle | Bicycle => "cycle.with_rider",
        Pedestrian if moves => "pedestrian.moving",
        Pedestrian => "pedestrian.standing",
        _ => return None,
    };
    number_of_attribute(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_follow_class_and_speed() {
        let of = |class: &str, velocity_mps| {
            let class = BoxClass::from_name(class).expect("is a class");
            by_speed(class, velocity_mps).map(|number| NUSCENES_ATTRIBUTES[usize::from(number)].0)
        };
        assert_eq!(of("trailer", [0.3, 0.4]), Some("vehicle.moving"));
        assert_eq!(of("car", [0.1, 0.0]), Some("vehicle.stopped"));
        assert_eq!(of("pedestrian", [0.0, 1.2]), Some("pedestrian.moving"));
        assert_eq!(of("bicycle", [0.0, 0.0]), Some("cycle.with_rider"));
        assert_eq!((of("car", [f64::NAN, 0.0]), of("barrier", [0.0, 0.0])), (None, None));
    }
}
