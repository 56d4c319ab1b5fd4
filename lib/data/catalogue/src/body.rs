//! What bodies of models look like: the facts that `meshes` builds them from.

/// The body of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Body {
    /// A car, van or pickup.
    Car(&'static CarBody),
    /// A lorry: a cab, and what it carries behind it.
    Lorry(Load),
    /// A semi-trailer with its load.
    Trailer(Load),
    /// A bus, or a section of one.
    Bus(BusBody),
    /// A motorcycle, a bicycle or a kick scooter.
    TwoWheeler(&'static TwoWheelerBody),
    /// Somebody on foot or in a wheelchair.
    Person(PersonBody),
    /// A cone.
    Cone(ConeBody),
    /// A barrier.
    Barrier(BarrierBody),
    /// A pack brings the mesh.
    Pack,
}

/// A car, van or pickup.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarBody {
    /// Proportions.
    pub shape: Shape,
    /// Rims.
    pub rim: Rim,
    /// Stripes and panels on the sides.
    pub livery: Livery,
    /// Colour of the lower band of the sides, linear RGB; none: the paint's.
    pub sill_rgb: Option<[f32; 3]>,
    /// Rows of seats behind the front ones.
    pub rear_seats: &'static [Seats],
    /// Whether a wall behind the seats hides the load.
    pub has_bulkhead: bool,
    /// Colour of the seats, linear RGB.
    pub seat_rgb: [f32; 3],
    /// Whether unpainted plastic covers the lower edges and arches.
    pub has_cladding: bool,
    /// Whether strips of plastic run along the sides.
    pub has_rub_strips: bool,
    /// Whether rails are on the roof.
    pub has_roof_rails: bool,
}

/// Proportions of a hull. Lengths are shares of the whole length counted from the nose, heights shares of the
/// whole height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Height of the bonnet's front edge.
    pub nose_z: f32,
    /// Lower edge of the windscreen: place and height.
    pub cowl: (f32, f32),
    /// Where the roof begins and ends.
    pub roof: (f32, f32),
    /// Lower edge of the rear window: place and height.
    pub deck: (f32, f32),
    /// Height of the tail's upper edge.
    pub tail_z: f32,
    /// Side windows begin and end here.
    pub windows: (f32, f32),
    /// Middles of the pillars between side windows.
    pub pillars: &'static [f32],
    /// Half width of the roof as a share of the half width.
    pub roof_width: f32,
    /// Gap under the body.
    pub clearance: f32,
    /// Whether there is a rear window.
    pub rear_glass: bool,
    /// Roof height where something is mounted on it.
    pub roof_z: f32,
    /// How far the middle of nose and tail project before their corners, metres.
    pub bow_m: [f32; 2],
    /// The same of the windscreen and the rear window.
    pub glass_bow_m: [f32; 2],
    /// How far the belt lies inside the widest place, as a share of the half width.
    pub tuck: f32,
    /// Half widths of nose and tail at their corners, as shares.
    pub ends_width: [f32; 2],
    /// How far the nose leans back: share of its height, metres.
    pub nose_lean: &'static [(f32, f32)],
    /// How far the tail leans forward: share of its height, metres.
    pub tail_lean: &'static [(f32, f32)],
    /// Height of the belt as shares of the bonnet's and the boot's.
    pub belt: [f32; 2],
    /// How far the edge of the roof lies below its middle, metres.
    pub crown_m: f32,
    /// How far the roof falls off to its front and rear ends.
    pub falls: [f32; 2],
}

/// What a rim looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rim {
    /// So many spokes of light metal.
    Spokes(usize),
    /// The same, dark.
    Dark(usize),
    /// A cover of plain steel with slots.
    Steel,
    /// A heavy vehicle's, bolted to a hub that projects.
    Heavy,
}

/// Stripes and panels on a car's or van's sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Livery {
    None,
    Taxi,
    Police,
    Ambulance,
    Delivery,
    Parcel,
    Camper,
    Shuttle,
    Craftsman,
    Motorhome,
}

/// A row of seats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seats {
    /// One on each side of the middle, at so many metres from it.
    Two(f32),
    /// A bench for three, with this half width, metres.
    Bench(f32),
    /// Two on each side of an aisle, as in a bus; none on the right at doors.
    Aisle {
        /// Whether there are some on the right, too.
        right: bool,
    },
}

/// What a lorry or a semi-trailer carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    /// A box for goods.
    Goods {
        /// Whether its walls are ribbed, not smooth.
        ribbed: bool,
    },
    /// A box with curtains for walls.
    Curtain,
    /// A flat bed.
    Flatbed,
    /// A low bed with sides that fold down.
    Dropside,
    /// A body that tips.
    Tipper,
    /// A concrete mixer's drum.
    Mixer,
    /// A tank.
    Tank,
    /// A refuse collector's body.
    Refuse,
    /// A recovery vehicle's crane.
    Tow,
    /// A street sweeper's body.
    Sweeper,
    /// A fire engine's body.
    Fire,
    /// A fire engine's turntable ladder.
    Ladder,
    /// The plate that a semi-trailer's front rests on.
    Coupling,
    /// A container on a semi-trailer.
    Container,
}

/// A bus, or a section of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusBody {
    /// A low-floor bus for towns.
    City,
    /// A coach for long ways.
    Coach,
    /// A school bus with a bonnet.
    School,
    /// The section of an articulated bus that drives.
    ArticulatedFront,
    /// The section that is towed.
    ArticulatedRear,
}

/// A motorcycle, a bicycle or a kick scooter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoWheelerBody {
    /// What it is built like.
    pub frame: Frame,
    /// Height of the saddle, metres.
    pub saddle_m: f32,
    /// How far its rider leans forward, radians.
    pub lean_rad: f32,
    /// The grips are so far below the machine's highest place, metres.
    pub grips_below_top_m: f32,
    /// The grips are so far behind the steering head, metres.
    pub grips_behind_head_m: f32,
    /// Height of the machine with nobody on it, metres.
    pub parked_height_m: f64,
}

/// What a two-wheeler is built like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Frame {
    Cruiser,
    Sport,
    Scooter,
    Moped,
    Police,
    Bicycle,
    CargoBicycle,
    KickScooter,
}

impl Frame {
    /// Whether it is a motorcycle on whose floor board feet rest.
    #[must_use]
    pub fn is_scooter(self) -> bool {
        matches!(self, Self::Scooter | Self::Moped)
    }
}

/// How somebody gets about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PersonBody {
    /// On foot, perhaps with a pram or a dog.
    OnFoot,
    /// In a wheelchair.
    Wheelchair,
}

/// What a cone is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConeBody {
    /// Two white bands.
    Traffic,
    /// Red without bands.
    Plain,
    /// Two white bands on a wide foot.
    Big,
    /// A drum.
    Barrel,
    /// A slim post.
    Skinny,
    /// One white band.
    Construction,
    /// One white band, low.
    Small,
}

/// What a barrier is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BarrierBody {
    /// Two boards on feet.
    Street,
    /// A block of concrete.
    Concrete,
    /// Wooden boards on trestles.
    Wooden,
}
