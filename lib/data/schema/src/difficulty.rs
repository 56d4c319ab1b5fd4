//! How hard objects are to detect.

use crate::DetectionClass;

/// How hard an object is to detect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Difficulty {
    Easy,
    Medium,
    Hard,
}

impl Difficulty {
    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Easy => "easy",
            Self::Medium => "medium",
            Self::Hard => "hard",
        }
    }
}

/// How hard an object is to detect, by points alone (`distance_m` none) or by points and distance.
#[must_use]
pub fn difficulty(class: DetectionClass, distance_m: Option<f64>, points: u32) -> Difficulty {
    use DetectionClass::*;
    let (medium_m, hard_m, easy_points, medium_points) = match class {
        Car => (30.0, 60.0, 80, 30),
        Truck | Bus => (40.0, 80.0, 100, 40),
        Pedestrian | Motorcycle | Bicycle => (20.0, 40.0, 40, 20),
        TrafficLight | TrafficSign | TrafficCone | Barrier => (20.0, 40.0, 20, 10),
    };
    // No distance: as if at hand.
    let distance_m = distance_m.unwrap_or(0.0);
    if distance_m >= hard_m || points < medium_points {
        Difficulty::Hard
    } else if distance_m >= medium_m || points < easy_points {
        Difficulty::Medium
    } else {
        Difficulty::Easy
    }
}

/// The difficulty of a class by name; an unknown class is hard.
#[must_use]
pub fn difficulty_of(class: &str, distance_m: Option<f64>, points: u32) -> Difficulty {
    DetectionClass::from_name(class).map_or(Difficulty::Hard, |class| difficulty(class, distance_m, points))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn difficulty_follows_the_table() {
        use DetectionClass::*;
        use Difficulty::*;
        for (class, distance, points, want) in [
            (Car, Some(29.9), 80, Easy),
            (Car, Some(30.0), 80, Medium),
            (Car, Some(29.9), 79, Medium),
            (Car, Some(60.0), 500, Hard),
            (Car, Some(1.0), 29, Hard),
            (Bus, Some(39.9), 100, Easy),
            (Truck, Some(79.9), 40, Medium),
            (Truck, Some(80.0), 400, Hard),
            (Pedestrian, Some(20.0), 40, Medium),
            (Bicycle, None, 40, Easy),
            (Motorcycle, None, 19, Hard),
            (TrafficCone, Some(19.0), 20, Easy),
            (Barrier, None, 10, Medium),
            (TrafficLight, Some(40.0), 99, Hard),
            (TrafficSign, None, 9, Hard),
        ] {
            assert_eq!(difficulty(class, distance, points), want, "{class:?} {distance:?} {points}");
        }
    }
}
