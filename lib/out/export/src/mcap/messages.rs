//! The messages that files hold: Foxglove's, by names and numbers of its public schemas, and three of our
//! own.
//!
//! What is drawn of a scene is here whole, with primitives that are never used: viewers look for their lists
//! by name.

use super::wire::messages;

messages! {
    /// Seconds and nanoseconds since the epoch.
    Timestamp in "google.protobuf" { seconds: i64 = 1, nanos: i32 = 2, }
    /// Seconds and nanoseconds.
    Duration in "google.protobuf" { seconds: i64 = 1, nanos: i32 = 2, }
    /// A vector of two.
    Vector2 in "foxglove" { x: f64 = 1, y: f64 = 2, }
    /// A vector of three.
    Vector3 in "foxglove" { x: f64 = 1, y: f64 = 2, z: f64 = 3, }
    /// A point.
    Point3 in "foxglove" { x: f64 = 1, y: f64 = 2, z: f64 = 3, }
    /// An orientation: w is last.
    Quaternion in "foxglove" { x: f64 = 1, y: f64 = 2, z: f64 = 3, w: f64 = 4, }
    /// A position and an orientation.
    Pose in "foxglove" { position: Vector3 = 1, orientation: Quaternion = 2, }
    /// Red, green, blue, alpha, 0 to 1.
    Color in "foxglove" { r: f64 = 1, g: f64 = 2, b: f64 = 3, a: f64 = 4, }
    /// A key and a value.
    KeyValuePair in "foxglove" { key: String = 1, value: String = 2, }
    /// Where one frame is in another.
    FrameTransform in "foxglove" {
        timestamp: Timestamp = 1,
        parent_frame_id: String = 2,
        child_frame_id: String = 3,
        translation: Vector3 = 4,
        rotation: Quaternion = 5,
    }
    /// Several of them.
    FrameTransforms in "foxglove" { transforms: Vec<FrameTransform> = 1, }
    /// A number within a packed element.
    PackedElementField in "foxglove" { name: String = 1, offset: u32 = 2, r#type: NumericType = 3, }
    enum NumericType as "NumericType" {
        Unknown = "UNKNOWN" 0, Uint8 = "UINT8" 1, Int8 = "INT8" 2, Uint16 = "UINT16" 3, Int16 = "INT16" 4,
        Uint32 = "UINT32" 5, Int32 = "INT32" 6, Float32 = "FLOAT32" 7, Float64 = "FLOAT64" 8,
    }
    /// Points with values.
    PointCloud in "foxglove" {
        timestamp: Timestamp = 1,
        frame_id: String = 2,
        pose: Pose = 3,
        point_stride: u32 = 4,
        fields: Vec<PackedElementField> = 5,
        data: Vec<u8> = 6,
    }
    /// An encoded picture.
    CompressedImage in "foxglove" {
        timestamp: Timestamp = 1,
        data: Vec<u8> = 2,
        format: String = 3,
        frame_id: String = 4,
    }
    /// A picture as numbers.
    RawImage in "foxglove" {
        timestamp: Timestamp = 1,
        width: u32 = 2,
        height: u32 = 3,
        encoding: String = 4,
        step: u32 = 5,
        data: Vec<u8> = 6,
        frame_id: String = 7,
    }
    /// Intrinsics: K of the raw picture, D of its lens.
    CameraCalibration in "foxglove" {
        timestamp: Timestamp = 1,
        width: u32 = 2,
        height: u32 = 3,
        distortion_model: String = 4,
        D: Vec<f64> = 5,
        K: Vec<f64> = 6,
        R: Vec<f64> = 7,
        P: Vec<f64> = 8,
        frame_id: String = 9,
    }
    /// A cell grid on the x-y plane of its pose: rows along y, columns along x.
    Grid in "foxglove" {
        timestamp: Timestamp = 1,
        frame_id: String = 2,
        pose: Pose = 3,
        column_count: u32 = 4,
        cell_size: Vector2 = 5,
        row_stride: u32 = 6,
        cell_stride: u32 = 7,
        fields: Vec<PackedElementField> = 8,
        data: Vec<u8> = 9,
    }
    /// A grid of boxes: slices along z, rows along y, columns along x.
    VoxelGrid in "foxglove" {
        timestamp: Timestamp = 1,
        frame_id: String = 2,
        pose: Pose = 3,
        row_count: u32 = 4,
        column_count: u32 = 5,
        cell_size: Vector3 = 6,
        slice_stride: u32 = 7,
        row_stride: u32 = 8,
        cell_stride: u32 = 9,
        fields: Vec<PackedElementField> = 10,
        data: Vec<u8> = 11,
    }
    /// A fix of a satellite receiver: degrees, metres.
    LocationFix in "foxglove" {
        latitude: f64 = 1,
        longitude: f64 = 2,
        altitude: f64 = 3,
        position_covariance: Vec<f64> = 4,
        position_covariance_type: CovarianceType = 5,
        timestamp: Timestamp = 6,
        frame_id: String = 7,
    }
    enum CovarianceType as "PositionCovarianceType" {
        Unknown = "UNKNOWN" 0, Approximated = "APPROXIMATED" 1, DiagonalKnown = "DIAGONAL_KNOWN" 2, Known = "KNOWN" 3,
    }
    /// An arrow along x.
    ArrowPrimitive in "foxglove" {
        pose: Pose = 1,
        shaft_length: f64 = 2,
        shaft_diameter: f64 = 3,
        head_length: f64 = 4,
        head_diameter: f64 = 5,
        color: Color = 6,
    }
    /// A box about its middle.
    CubePrimitive in "foxglove" { pose: Pose = 1, size: Vector3 = 2, color: Color = 3, }
    /// A line.
    LinePrimitive in "foxglove" {
        r#type: LineType = 1,
        pose: Pose = 2,
        thickness: f64 = 3,
        scale_invariant: bool = 4,
        points: Vec<Point3> = 5,
        color: Color = 6,
        colors: Vec<Color> = 7,
        indices: Vec<u32> = 8,
    }
    enum LineType as "Type" { Strip = "LINE_STRIP" 0, Loop = "LINE_LOOP" 1, List = "LINE_LIST" 2, }
    /// A text.
    TextPrimitive in "foxglove" {
        pose: Pose = 1,
        billboard: bool = 2,
        font_size: f64 = 3,
        scale_invariant: bool = 4,
        color: Color = 5,
        text: String = 6,
    }
    /// An ellipsoid.
    SpherePrimitive in "foxglove" { pose: Pose = 1, size: Vector3 = 2, color: Color = 3, }
    /// A cylinder or cone along z.
    CylinderPrimitive in "foxglove" {
        pose: Pose = 1,
        size: Vector3 = 2,
        bottom_scale: f64 = 3,
        top_scale: f64 = 4,
        color: Color = 5,
    }
    /// Triangles.
    TriangleListPrimitive in "foxglove" {
        pose: Pose = 1,
        points: Vec<Point3> = 2,
        color: Color = 3,
        colors: Vec<Color> = 4,
        indices: Vec<u32> = 5,
    }
    /// A model from a file.
    ModelPrimitive in "foxglove" {
        pose: Pose = 1,
        scale: Vector3 = 2,
        color: Color = 3,
        override_color: bool = 4,
        url: String = 5,
        media_type: String = 6,
        data: Vec<u8> = 7,
    }
    /// Takes things away.
    SceneEntityDeletion in "foxglove" { timestamp: Timestamp = 1, r#type: DeletionType = 2, id: String = 3, }
    enum DeletionType as "Type" { MatchingId = "MATCHING_ID" 0, All = "ALL" 1, }
    /// A thing that is drawn; the next of the same id takes its place.
    SceneEntity in "foxglove" {
        timestamp: Timestamp = 1,
        frame_id: String = 2,
        id: String = 3,
        lifetime: Duration = 4,
        frame_locked: bool = 5,
        metadata: Vec<KeyValuePair> = 6,
        arrows: Vec<ArrowPrimitive> = 7,
        cubes: Vec<CubePrimitive> = 8,
        spheres: Vec<SpherePrimitive> = 9,
        cylinders: Vec<CylinderPrimitive> = 10,
        lines: Vec<LinePrimitive> = 11,
        triangles: Vec<TriangleListPrimitive> = 12,
        texts: Vec<TextPrimitive> = 13,
        models: Vec<ModelPrimitive> = 14,
    }
    /// Things that are drawn from now on.
    SceneUpdate in "foxglove" { deletions: Vec<SceneEntityDeletion> = 1, entities: Vec<SceneEntity> = 2, }
    /// A reading of an IMU in its own frame: specific force in m/s2 (at rest z is +9.81), angular velocity in
    /// rad/s, heading in rad clockwise from the world's +y.
    Imu in "convoy" {
        timestamp: Timestamp = 1,
        frame_id: String = 2,
        acceleration_mps2: Vector3 = 3,
        gyroscope_radps: Vector3 = 4,
        compass_rad: f64 = 5,
    }
    /// Where an agent is and how it moves, in the world: metres, m/s, rad/s.
    AgentState in "convoy" {
        timestamp: Timestamp = 1,
        frame_id: String = 2,
        object_id: u32 = 3,
        pose: Pose = 4,
        velocity_mps: Vector3 = 5,
        angular_velocity_radps: Vector3 = 6,
    }
    /// Weather: parameters by name, in the units of the store's `log/frames`.
    Weather in "convoy" {
        timestamp: Timestamp = 1,
        cloudiness: f64 = 2,
        precipitation: f64 = 3,
        precipitation_deposits: f64 = 4,
        wind_intensity: f64 = 5,
        sun_azimuth_deg: f64 = 6,
        sun_altitude_deg: f64 = 7,
        wetness: f64 = 8,
        fog_density: f64 = 9,
        fog_distance_m: f64 = 10,
        fog_falloff: f64 = 11,
        scattering_intensity: f64 = 12,
        mie_scattering_scale: f64 = 13,
        rayleigh_scattering_scale: f64 = 14,
        dust_storm: f64 = 15,
    }
}

impl From<[f64; 3]> for Vector3 {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl Quaternion {
    /// From the order of our files.
    pub(crate) fn from_wxyz([w, x, y, z]: [f64; 4]) -> Self {
        Self { x, y, z, w }
    }
}

impl Pose {
    /// From a pose of ours.
    pub(crate) fn of<To: frames::Frame, From: frames::Frame>(pose: &frames::Pose<To, From>) -> Self {
        Self { position: pose.xyz().into(), orientation: Quaternion::from_wxyz(pose.wxyz()) }
    }
}

impl Color {
    /// From sRGB, with an opacity of 0 to 1.
    pub(crate) fn of(rgb: [u8; 3], a: f64) -> Self {
        let [r, g, b] = rgb.map(|value| f64::from(value) / 255.0);
        Self { r, g, b, a }
    }
}

impl KeyValuePair {
    /// A key and a value as text.
    pub(crate) fn of(key: &str, value: impl std::fmt::Display) -> Self {
        Self { key: key.to_owned(), value: value.to_string() }
    }
}
