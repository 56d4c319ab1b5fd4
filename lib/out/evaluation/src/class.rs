//! What boxes are, as far as metrics tell it apart.

use schema::DetectionClass;

use crate::nuscenes;
use crate::opv2v::is_opv2v_vehicle;

/// The class of a target or a prediction: one of a store's, or one that nuScenes alone has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxClass {
    /// One of a store's.
    Detection(DetectionClass),
    /// A trailer: to all but nuScenes a truck, as in a store.
    Trailer,
    /// A construction vehicle, of which a store has none.
    ConstructionVehicle,
}

impl BoxClass {
    const TRAILER: &str = "trailer";
    const CONSTRUCTION_VEHICLE: &str = "construction_vehicle";

    /// The class with a name: of a store's, or of nuScenes'.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            Self::TRAILER => Some(Self::Trailer),
            Self::CONSTRUCTION_VEHICLE => Some(Self::ConstructionVehicle),
            _ => DetectionClass::from_name(name).map(Self::Detection),
        }
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Detection(class) => class.name(),
            Self::Trailer => Self::TRAILER,
            Self::ConstructionVehicle => Self::CONSTRUCTION_VEHICLE,
        }
    }

    /// The class that it has in a store.
    #[must_use]
    pub fn in_store(self) -> Option<DetectionClass> {
        match self {
            Self::Detection(class) => Some(class),
            Self::Trailer => Some(DetectionClass::Truck),
            Self::ConstructionVehicle => None,
        }
    }

    /// Its number among SimBEV2X's, which are a store's in their order.
    pub(crate) fn in_simbev2x(self) -> Option<usize> {
        let own = self.in_store()?;
        DetectionClass::ALL.into_iter().position(|class| class == own)
    }

    /// Its number among nuScenes', and the distance from the ego up to which it counts, m.
    pub(crate) fn in_nuscenes(self) -> Option<(usize, f64)> {
        nuscenes::class_named(self.name())
    }

    /// Whether it is a vehicle to OPV2V.
    pub(crate) fn is_opv2v_vehicle(self) -> bool {
        self.in_store().is_some_and(is_opv2v_vehicle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trailers_are_trucks_but_to_nuscenes() {
        let of = |name: &str| BoxClass::from_name(name).expect("is a class");
        for name in ["car", "truck", "trailer", "construction_vehicle", "traffic_sign"] {
            assert_eq!(of(name).name(), name);
        }
        assert_eq!(BoxClass::from_name("cat"), None);
        assert_eq!(of("trailer").in_simbev2x(), of("truck").in_simbev2x());
        assert!(of("trailer").is_opv2v_vehicle() && !of("construction_vehicle").is_opv2v_vehicle());
        assert_eq!(of("construction_vehicle").in_simbev2x(), None);
        let numbers = ["car", "truck", "trailer", "construction_vehicle", "traffic_sign"];
        let numbers = numbers.map(|name| of(name).in_nuscenes().map(|(number, _)| number));
        assert_eq!(numbers, [Some(0), Some(1), Some(3), Some(4), None]);
    }
}
