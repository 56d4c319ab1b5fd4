//! nuScenes' attributes of objects, which its exports write and its metrics hold predictions against.

use crate::{ActorKind, Attribute, Attributes, DetectionClass, Tag};

/// nuScenes' attributes, with what each says.
pub const NUSCENES_ATTRIBUTES: [(&str, &str); 8] = [
    ("vehicle.moving", "The vehicle moves."),
    ("vehicle.stopped", "The vehicle stands and will go on."),
    ("vehicle.parked", "The vehicle stands for the whole scene."),
    ("cycle.with_rider", "Somebody rides it."),
    ("cycle.without_rider", "Nobody rides it."),
    ("pedestrian.sitting_lying_down", "The person sits on a bench."),
    ("pedestrian.standing", "The person stands."),
    ("pedestrian.moving", "The person moves."),
];

/// Slower than this is standing, m/s.
pub const STANDING_MPS: f64 = 0.2;

/// The class that a category of nuScenes counts as, by nuscenes-devkit's rule; others are neither learnt nor
/// evaluated.
#[must_use]
pub fn nuscenes_class(category: &str) -> Option<&'static str> {
    Some(match category {
        "movable_object.barrier" => "barrier",
        "movable_object.trafficcone" => "traffic_cone",
        "vehicle.bicycle" => "bicycle",
        "vehicle.bus.bendy" | "vehicle.bus.rigid" => "bus",
        "vehicle.car" => "car",
        "vehicle.construction" => "construction_vehicle",
        "vehicle.motorcycle" => "motorcycle",
        "vehicle.trailer" => "trailer",
        "vehicle.truck" => "truck",
        "human.pedestrian.adult"
        | "human.pedestrian.child"
        | "human.pedestrian.construction_worker"
        | "human.pedestrian.police_officer" => "pedestrian",
        _ => return None,
    })
}

/// Whether an object is a trailer to nuScenes: the trailer of an articulated lorry, a truck in a store.
#[must_use]
pub fn is_trailer(class: DetectionClass, facts: &Attributes) -> bool {
    class == DetectionClass::Truck && facts.get(&Attribute::SpecialType) == Some("trailer")
}

/// nuScenes' attribute of an object of a kind with tags that moves at a speed; cones, barriers, lights and
/// signs have none.
#[must_use]
pub fn nuscenes_attribute(
    class: DetectionClass,
    kind: ActorKind,
    tags: &[u8],
    facts: &Attributes,
    speed_mps: f64,
) -> Option<&'static str> {
    use DetectionClass::{Bicycle, Bus, Car, Motorcycle, Pedestrian, Truck};
    let moves = speed_mps > STANDING_MPS;
    match class {
        Car | Truck | Bus if moves => Some("vehicle.moving"),
        // What an accident left stands to the end.
        Car | Truck | Bus if kind == ActorKind::Parked || facts.get(&Attribute::Hazard).is_some() => {
            Some("vehicle.parked")
        }
        Car | Truck | Bus => Some("vehicle.stopped"),
        Motorcycle | Bicycle if tags.contains(&(Tag::Rider as u8)) => Some("cycle.with_rider"),
        Motorcycle | Bicycle => Some("cycle.without_rider"),
        Pedestrian if moves => Some("pedestrian.moving"),
        Pedestrian if facts.is_true(&Attribute::SitsOnBench) => Some("pedestrian.sitting_lying_down"),
        Pedestrian => Some("pedestrian.standing"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_follow_speed_kind_and_rider() {
        let none = Attributes::new();
        let hazard = Attributes::new().with(Attribute::Hazard, 0);
        use DetectionClass::{Bicycle, Car, Pedestrian, TrafficCone};
        let vehicle = |kind, facts, speed| nuscenes_attribute(Car, kind, &[14], facts, speed);
        assert_eq!(vehicle(ActorKind::Vehicle, &none, 3.0), Some("vehicle.moving"));
        assert_eq!(vehicle(ActorKind::Vehicle, &none, 0.1), Some("vehicle.stopped"));
        assert_eq!(vehicle(ActorKind::Parked, &none, 0.0), Some("vehicle.parked"));
        assert_eq!(vehicle(ActorKind::Vehicle, &hazard, 0.0), Some("vehicle.parked"));
        let cycle = |tags: &[u8]| nuscenes_attribute(Bicycle, ActorKind::Vehicle, tags, &none, 0.0);
        assert_eq!([cycle(&[13, 19]), cycle(&[19])], [Some("cycle.with_rider"), Some("cycle.without_rider")]);
        assert_eq!(
            nuscenes_attribute(Pedestrian, ActorKind::Walker, &[12], &none, 0.0),
            Some("pedestrian.standing")
        );
        let sits = Attributes::new().with(Attribute::SitsOnBench, true);
        assert_eq!(
            nuscenes_attribute(Pedestrian, ActorKind::Walker, &[12], &sits, 0.0),
            Some("pedestrian.sitting_lying_down")
        );
        assert_eq!(nuscenes_attribute(TrafficCone, ActorKind::Prop, &[30], &none, 0.0), None);
    }
}
