//! The scene log: the only truth later stages read.

use crate::tables::weather::{Weather, weather_parameters};
use crate::{ActorKind, ActorRole, Attributes, LampKind, SignalState, framed, table};

table! {
    /// One row per object of a scene, moving or not: the id is the same number in every output.
    ActorRow in "log/actors" by "simulate-and-log" {
        /// Object id, 1..=65535.
        id: u16,
        /// `vehicle`, `walker`, `rsu`, `traffic_light`, `sign`, `prop`, `parked`, `building`, `vegetation`,
        /// `pole`, `surface`.
        kind: ActorKind,
        /// Model name; the mesh is made from it and the columns below.
        model: String,
        /// Who it is: `vehicle_0`, `rsu_1` for agents, else `background`, `walker`, `hazard`, `scenery`.
        role: ActorRole,
        /// Semantic tags of its parts; the last one with a detection class names its class.
        semantic_tags: Vec<u8>,
        /// Length along its x axis, m.
        length_m: f64,
        /// Width along its y axis, m.
        width_m: f64,
        /// Height along its z axis, m.
        height_m: f64,
        /// Colour, sRGB red, green, blue.
        color: Vec<u8>,
        /// Whether it never moves: then it has no rows in `states` and stands at the pose below.
        fixed: bool,
        /// Position in the world at frame 0, m: centre of the footprint on the ground.
        xyz_m: [f64; 3],
        /// Orientation in the world at frame 0: quaternion w, x, y, z.
        quaternion: [f64; 4],
        /// Number that varies its shape among objects of the same model.
        variant: u32,
        /// Object it is attached to: of what is towed, the one that tows it.
        parent: Option<i32>,
        /// OpenDRIVE id of its signal or object.
        opendrive_id: Option<String>,
        /// Further facts (`reckless`, `sign_type`, `use_wheelchair`, ...): see [Attributes](#attributes).
        attributes: Attributes,
    }
}

table! {
    /// One row per moving object and frame, frame -1 (one period before the first) included.
    StateRow in "log/states" by "simulate-and-log" {
        /// Frame number, from -1.
        frame: i32,
        /// Object id.
        id: u16,
        /// Position in the world, m: centre of the footprint on the ground.
        xyz_m: [f64; 3],
        /// Orientation in the world: quaternion w, x, y, z.
        quaternion: [f64; 4],
        /// Velocity in the world, m/s.
        velocity_mps: [f32; 3],
        /// Angular velocity in the world, rad/s.
        angular_velocity_radps: [f32; 3],
        /// What of the orientation's roll and pitch (it is Rz(yaw) Ry(pitch) Rx(roll)) is a body's lean on
        /// its springs, rad: right side down, nose down. Wheels stand on the ground by the pose without it;
        /// zeros of all but vehicles on four wheels.
        lean_rad: [f32; 2],
        /// Steering angle of the front wheels, rad, positive left.
        steer_rad: f32,
        /// Rotation of the wheels since the start, rad; of walkers the gait phase, which goes on while they
        /// stand (not of those with a pram).
        phase_rad: f32,
        /// Speed that a walker strides at, m/s: its own, smoothed. With the phase it says where arms and legs
        /// are.
        gait_mps: f32,
        /// Height of the seat that a walker sits on (of a bench), m; 0 of all others. Who sits does so for
        /// the whole scene, unless a vehicle hits them.
        seat_m: f32,
        /// Length, width and height of the box about a walker's pose, m; zeros of what keeps the size of its
        /// row in `actors`.
        size_m: [f32; 3],
        /// Lamps that burn, as bits: 1 position, 2 low beam, 4 high beam, 8 brake, 16 and 32 blinkers right
        /// and left, 64 reverse, 128 fog, 512 emergency. Blinkers and emergency lights flash while they are
        /// on.
        lights: u32,
        /// How far the doors stand open, rad: front left, front right, rear left, rear right. Boxes do not
        /// include open doors.
        door_rad: [f32; 4],
        /// Whether it stands still because all agents are farther away than `traffic.active_distance_m`.
        dormant: bool,
    }
}

macro_rules! define_frames {
    ($( #[doc = $doc:literal] $name:ident = $clear:literal, )+) => {
        table! {
            /// One row per frame: time and weather.
            FrameRow in "log/frames" by "simulate-and-log" {
                /// Frame number, from 0.
                frame: u32,
                /// Time since frame 0, s.
                time_s: f64,
                $( #[doc = $doc] $name: f64, )+
                /// Whether street lamps burn.
                street_lamps: bool,
                /// Whether windows are lit.
                building_lights: bool,
            }
        }

        impl FrameRow {
            /// The frame's weather.
            #[must_use]
            pub fn weather(&self) -> Weather {
                Weather { $( $name: self.$name, )+ }
            }

            /// A frame with a weather.
            #[must_use]
            pub fn new(frame: u32, weather: &Weather, street_lamps: bool, building_lights: bool) -> Self {
                let time_s = f64::from(frame) * crate::FRAME_PERIOD_S;
                Self { frame, time_s, $( $name: weather.$name, )+ street_lamps, building_lights }
            }
        }
    };
}
weather_parameters!(define_frames);

table! {
    /// One row per street lamp and building: its light when lights are on (`frames` says when they are).
    LampRow in "log/lamps" by "simulate-and-log" {
        /// Object id.
        id: u16,
        /// `street` or `building`.
        kind: LampKind,
        /// Whether it works.
        works: bool,
        /// Luminous flux of a street lamp, lm.
        flux_lm: Option<f64>,
        /// Colour of its light, sRGB red, green, blue.
        color: Vec<u8>,
    }
}

table! {
    /// One row per traffic light and frame, frame -1 included.
    SignalRow in "log/signals" by "simulate-and-log" {
        /// Frame number, from -1.
        frame: i32,
        /// Object id of the traffic light.
        id: u16,
        /// `Red`, `Yellow`, `Green` or `Off`.
        state: SignalState,
        /// OpenDRIVE id of the signal; of lights for walkers `crosswalk:` and the crosswalk's id.
        opendrive_id: String,
    }
}

framed!(StateRow, FrameRow, SignalRow);
