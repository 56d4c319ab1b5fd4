//! Sensor rigs: cameras, lidar, radar, GNSS, IMU.
