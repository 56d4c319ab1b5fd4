//! Which lamps of an object burn, as bits of a `u32`; colour and strength of lights.

/// Position lamps.
pub const POSITION: u32 = 1;
/// Low beam.
pub const LOW_BEAM: u32 = 1 << 1;
/// High beam.
pub const HIGH_BEAM: u32 = 1 << 2;
/// Brake lamps.
pub const BRAKE: u32 = 1 << 3;
/// Right blinker.
pub const BLINK_RIGHT: u32 = 1 << 4;
/// Left blinker.
pub const BLINK_LEFT: u32 = 1 << 5;
/// Reversing lamps.
pub const REVERSE: u32 = 1 << 6;
/// Fog lamps.
pub const FOG: u32 = 1 << 7;
/// Emergency lights of police, ambulance, fire engine.
pub const EMERGENCY: u32 = 1 << 9;
/// The other half of the emergency lights, which flash in turn: of instances only, the log has [`EMERGENCY`]
/// for both.
pub const EMERGENCY_OTHER: u32 = 1 << 10;
/// Red lens of a traffic light.
pub const SIGNAL_RED: u32 = 1 << 16;
/// Yellow lens of a traffic light.
pub const SIGNAL_YELLOW: u32 = 1 << 17;
/// Green lens of a traffic light.
pub const SIGNAL_GREEN: u32 = 1 << 18;
/// A street lamp.
pub const STREET_LAMP: u32 = 1 << 19;
/// Nominal luminous flux of a street lamp, lumens: a bright LED luminaire of a main street.
pub const STREET_LAMP_LM: f64 = 20_000.0;
/// Light of a street lamp, sRGB.
pub const STREET_LAMP_RGB: [u8; 3] = [255, 226, 183];
/// Light of a window, sRGB.
pub const WINDOW_RGB: [u8; 3] = [255, 214, 170];
/// Lit windows of a building.
pub const BUILDING: u32 = 1 << 20;
/// A floodlight of works.
pub const WORK_LAMP: u32 = 1 << 21;
/// Luminous flux of a floodlight of works, lumens.
pub const WORK_LAMP_LM: f64 = 20_000.0;
