//! Faults of tables.

use std::cell::RefCell;
use std::fs::{self, File};
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float32Type, Float64Type, Int32Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, BooleanArray, ListArray, RecordBatch, StringArray, StructArray};
use arrow_buffer::OffsetBuffer;
use arrow_schema::DataType;
use codecs::{NpzReader, NpzWriter, Scalar, encode_member};
use serde_json::Value;

use super::tools::{
    FRAME, Plant, a_backscatter, a_box, a_flat_box, change, edit, repaint, replaced, rewrite, sensor, table,
    with_depths,
};

/// Faults of the log, boxes and tracks.
pub(super) const OF_TABLES: &[Plant] = &[
    ("numbers", "values of center_m are no numbers", |store| {
        let row = a_box(store);
        change::<Float64Type>(table(store, "boxes"), "center_m", row, move |all| all[3 * row] = f64::NAN);
    }),
    ("seats", "sits, but on no bench", |store| {
        change::<Float32Type>(table(store, "log/states"), "seat_m", 0, |all| all.fill(0.4));
    }),
    ("units", "difficulty says \"simple\"", |store| {
        let words = |_: usize, rows: RecordBatch| {
            let words = rows.column_by_name("difficulty").expect("is there").as_string::<i32>();
            let mut words: Vec<String> = words.iter().flatten().map(str::to_owned).collect();
            words[0] = "simple".into();
            vec![replaced(&rows, "difficulty", Arc::new(StringArray::from(words)))]
        };
        edit(&table(store, "boxes_valid"), words, |note| note);
    }),
    ("units", "the sign_type of object", |store| {
        let words = |_: usize, rows: RecordBatch| {
            let facts = rows.column_by_name("attributes").expect("is there").as_struct();
            let (fields, mut values, nulls) = facts.clone().into_parts();
            let at = fields.iter().position(|field| field.name() == "sign_type").expect("is a field");
            let words = values[at].as_string::<i32>().iter();
            let words = words.map(|word| word.map(|word| word.replace("speed_limit", "how_fast")));
            values[at] = Arc::new(StringArray::from_iter(words));
            vec![replaced(&rows, "attributes", Arc::new(StructArray::new(fields, values, nulls)))]
        };
        edit(&table(store, "log/actors"), words, |note| note);
    }),
    ("files", "agents.parquet: has rows of scene 5", |store| {
        change::<UInt32Type>(table(store, "agents"), "scene", 0, |all| all.fill(5));
    }),
    ("box shape", "is_ego is wrong", |store| {
        let all = |_: usize, rows: RecordBatch| {
            let egos = BooleanArray::from(vec![true; rows.num_rows()]);
            vec![replaced(&rows, "is_ego", Arc::new(egos))]
        };
        edit(&table(store, "boxes_valid"), all, |note| note);
    }),
    ("times", "frame 4 is at", |store| {
        let row = 4;
        change::<Float64Type>(table(store, "log/frames"), "time_s", row, move |all| all[row] += 1e-6);
    }),
    ("poses", "from where the log has it", |store| {
        // A turned pose: by a hundredth of a degree.
        change::<Float64Type>(table(store, "agents"), "quaternion", 0, |all| all[1] += 1e-4);
    }),
    ("poses", "and says", |store| {
        // The last row is that of the object with the highest id: no agent.
        change::<Float32Type>(table(store, "log/states"), "velocity_mps", 0, |all| {
            let last = all.len() - 3;
            all[last] += 2.0;
        });
    }),
    ("box list", "does not list object", |store| {
        let row = a_box(store);
        for name in ["boxes", "boxes_valid"] {
            let without = |first: usize, rows: RecordBatch| {
                let at = row - first;
                vec![rows.slice(0, at), rows.slice(at + 1, rows.num_rows() - at - 1)]
            };
            edit(&table(store, name), without, |note| note);
        }
    }),
    ("box shape", "its corners is off", |store| {
        let row = a_box(store);
        for name in ["boxes", "boxes_valid"] {
            change::<Float64Type>(table(store, name), "corners_m", row, move |all| {
                all[24 * row..24 * (row + 1)].iter_mut().step_by(3).for_each(|x| *x += 0.01);
            });
        }
    }),
    ("counts", "num_lidar_pts is", |store| {
        let row = a_box(store);
        change::<UInt32Type>(table(store, "boxes_valid"), "num_lidar_pts", row, move |all| all[row] += 1);
    }),
    ("counts", "num_radar_pts is", |store| {
        let row = a_box(store);
        change::<UInt32Type>(table(store, "boxes_valid"), "num_radar_pts", row, move |all| all[row] += 1);
    }),
    ("counts", "num_pixels is", |store| {
        let row = a_box(store);
        change::<UInt32Type>(table(store, "boxes_valid"), "num_pixels", row, move |all| all[row] += 1);
    }),
    ("windows", "velocity_mps of object", |store| {
        change::<Float32Type>(table(store, "tracks_windows"), "velocity_mps", 0, |all| all[0] += 0.01);
    }),
    ("windows", "of future of object", |store| {
        change::<UInt8Type>(table(store, "tracks_windows"), "future_mask", 0, |all| all[0] ^= 1);
    }),
    ("windows", "yaw_rad of object", |store| {
        change::<Float64Type>(table(store, "tracks_windows"), "yaw_rad", 0, |all| all[0] += 0.001);
    }),
    ("windows", "has no window", |store| {
        let without = |_: usize, rows: RecordBatch| vec![rows.slice(1, rows.num_rows() - 1)];
        edit(&table(store, "tracks_windows"), without, |note| note);
    }),
    ("tracks", "min_distance_m of object", |store| {
        change::<Float64Type>(table(store, "tracks_agents"), "min_distance_m", 0, |all| all[0] += 0.01);
    }),
    ("tracks", "num_lidar_pts of object", |store| {
        change::<UInt32Type>(table(store, "tracks_frames"), "num_lidar_pts", 0, |all| all[7] += 1);
    }),
    ("tracks", "path_m of object", |store| {
        change::<Float64Type>(table(store, "tracks"), "path_m", 0, |all| all[0] += 0.1);
    }),
];

/// Faults of sensors.
pub(super) const OF_SENSORS: &[Plant] = &[
    ("files", "RAD_FRONT.parquet", |store| fs::remove_file(sensor(store, "RAD_FRONT")).expect("was there")),
    ("files", "IMU.parquet", |store| rewrite(&sensor(store, "IMU"), b"PAR1 and no more")),
    ("numbers", "values of x are no numbers", |store| {
        change::<Float32Type>(sensor(store, "LIDAR"), "x", FRAME, |all| all[9] = f32::NAN);
    }),
    ("times", "frame 10 is at", |store| {
        change::<Float64Type>(sensor(store, "LIDAR"), "time_s", FRAME, |all| all[0] += 1e-6);
    }),
    ("units", "intensity goes from", |store| {
        change::<Float32Type>(sensor(store, "LIDAR"), "intensity", FRAME, |all| all[9] = 1.5);
    }),
    ("calibration", "m and", |store| {
        let turned = |note: String| note.replace("\"translation\":[0.6,", "\"translation\":[0.601,");
        edit(&sensor(store, "IST-CAM_FRONT"), |_, rows| vec![rows], turned);
    }),
    ("image ids", "show 60000 with tag 1", |store| {
        repaint(sensor(store, "IST-CAM_FRONT"), |pixels| pixels[0] = [1, 0x60, 0xea]);
    }),
    ("semantic", "1 pixels of CAM_FRONT", |store| {
        repaint(sensor(store, "SEG-CAM_FRONT"), |pixels| pixels[77] = [1, 2, 3]);
    }),
    ("pictures", "visible.parquet says", |store| {
        change::<UInt32Type>(sensor(store, "visible"), "pixels", 0, |all| all[0] += 1);
    }),
    ("boxes 2d", "pixels is", |store| {
        let row = a_flat_box(store);
        change::<UInt32Type>(sensor(store, "boxes_2d"), "pixels", row, move |all| all[row] += 1);
    }),
    ("boxes 2d", "visible_px is", |store| {
        let row = a_flat_box(store);
        change::<Float32Type>(sensor(store, "boxes_2d"), "visible_px", row, move |all| all[4 * row] -= 1.0);
    }),
    ("boxes 2d", "does not hold visible_px", |store| {
        let row = a_flat_box(store);
        change::<Float32Type>(sensor(store, "boxes_2d"), "amodal_px", row, move |all| all[4 * row] += 1e4);
    }),
    ("boxes 2d", "beyond the projected box", |store| {
        // Every object's, to the left: of those that are whole no share changes.
        change::<Float32Type>(sensor(store, "boxes_2d"), "amodal_px", 0, |all| {
            all.iter_mut().step_by(4).filter(|left| **left > 4.0).for_each(|left| *left -= 4.0);
        });
    }),
    ("boxes 2d", "truncation is", |store| {
        let row = a_flat_box(store);
        change::<Float32Type>(sensor(store, "boxes_2d"), "truncation", row, move |all| all[row] += 0.01);
    }),
    ("boxes 2d", "may be hidden", |store| {
        change::<Float32Type>(sensor(store, "boxes_2d"), "occlusion", 0, |all| all.fill(1.0));
    }),
    ("boxes 2d", "there is no row", |store| {
        let row = a_flat_box(store);
        let without = move |_: usize, rows: RecordBatch| {
            vec![rows.slice(0, row), rows.slice(row + 1, rows.num_rows() - row - 1)]
        };
        edit(&sensor(store, "boxes_2d"), without, |note| note);
    }),
    ("depth", "are at another depth than in CAM_FRONT", |store| {
        // 6 % more: the middle byte is worth 1.5 cm, the highest 3.9 m.
        repaint(sensor(store, "DPT-CAM_FRONT"), |pixels| {
            for pixel in pixels.iter_mut().filter(|p| **p != [255; 3]) {
                let depth = u32::from_le_bytes([pixel[0], pixel[1], pixel[2], 0]);
                let [low, middle, high, _] = (depth + depth / 16).min(0xff_fffe).to_le_bytes();
                *pixel = [low, middle, high];
            }
        });
    }),
    ("flow", "CAM_FRONT:", |store| {
        // A pixel to the right.
        change::<Float32Type>(sensor(store, "FLW-CAM_FRONT"), "dx", FRAME, |all| {
            all.iter_mut().for_each(|dx| *dx += 2.0 / 160.0);
        });
    }),
    ("flow", "pixels of object", |store| {
        // Vehicles as if they stood still, fixed things as they are.
        for camera in ["CAM_FRONT", "CAM_FRONT_LEFT", "CAM_FRONT_RIGHT", "CAM_BACK"] {
            let (instances, flow) =
                (sensor(store, &format!("IST-{camera}")), sensor(store, &format!("FLW-{camera}")));
            if !instances.is_file() {
                continue;
            }
            let vehicles = RefCell::new(Vec::new());
            repaint(instances, |pixels| {
                let is_vehicle = |pixel: &[u8; 3]| (14..=18).contains(&pixel[0]);
                *vehicles.borrow_mut() = pixels.iter().map(is_vehicle).collect();
            });
            for column in ["dx", "dy"] {
                change::<Float32Type>(flow.clone(), column, FRAME, |all| {
                    all.iter_mut()
                        .zip(&*vehicles.borrow())
                        .filter(|(_, is)| **is)
                        .for_each(|(v, _)| *v = 0.0);
                });
            }
        }
    }),
    ("flow ids", "CAM_FRONT:", |store| {
        change::<Float32Type>(sensor(store, "FLW-CAM_FRONT"), "dy", FRAME, |all| {
            all.iter_mut().for_each(|dy| *dy += 0.6);
        });
    }),
    ("point ids", "from object 60000, which the log has not", |store| {
        change::<UInt16Type>(sensor(store, "SEG-LIDAR"), "id", FRAME, |all| all[0] = 60_000);
    }),
    ("units", "time_offset_s goes from", |store| {
        change::<Float32Type>(sensor(store, "TURNING"), "time_offset_s", FRAME, |all| all[9] = 0.001);
    }),
    ("scan times", "returns of LIDAR were fired", |store| {
        change::<Float32Type>(sensor(store, "LIDAR"), "time_offset_s", FRAME, |all| all[9] = -0.001);
    }),
    ("scan times", "returns of TURNING were fired", |store| {
        // Two slices late.
        change::<Float32Type>(sensor(store, "TURNING"), "time_offset_s", FRAME, |all| {
            all.iter_mut().for_each(|t| *t = (*t + 2.0 * 0.05 / 32.0).min(0.0));
        });
    }),
    ("scan times", "returns of SMOOTH were fired", |store| {
        change::<Float32Type>(sensor(store, "SMOOTH"), "time_offset_s", FRAME, |all| {
            all.iter_mut().for_each(|t| *t = (*t + 2.0 * 0.05 / 32.0).min(0.0));
        });
    }),
    ("returns", "is numbered out of turn", |store| {
        change::<UInt8Type>(sensor(store, "TURNING"), "return_number", FRAME, |all| all[0] = 3);
    }),
    ("returns", "of more returns of its beam than are asked for", |store| {
        for column in ["return_number", "return_count"] {
            change::<UInt8Type>(sensor(store, "SMOOTH"), column, FRAME, |all| {
                (0..)
                    .zip(&mut all[..3])
                    .for_each(|(k, n)| *n = if column == "return_count" { 3 } else { k + 1 });
            });
        }
        for column in ["x", "y", "z", "time_offset_s"] {
            change::<Float32Type>(sensor(store, "SMOOTH"), column, FRAME, |all| all.copy_within(0..1, 1));
            change::<Float32Type>(sensor(store, "SMOOTH"), column, FRAME, |all| all.copy_within(0..1, 2));
        }
    }),
    ("returns", "has an id, a tag or an angle", |store| {
        let at = a_backscatter(store);
        change::<UInt16Type>(sensor(store, "TURNING"), "id", FRAME, move |all| all[at] = 1);
    }),
    ("returns", "has an id, a tag or an angle", |store| {
        let at = a_backscatter(store);
        change::<UInt8Type>(sensor(store, "TURNING"), "tag", FRAME, move |all| all[at] = 1);
    }),
    ("returns", "that the lidar does not feel", |store| {
        change::<UInt8Type>(sensor(store, "SEG-TURNING"), "return_kind", FRAME, |all| all[0] = 1);
    }),
    ("returns", "is from behind glass, and the lidar does not", |store| {
        change::<UInt8Type>(sensor(store, "TURNING"), "return_kind", FRAME, |all| all[0] = 3);
    }),
    ("point ids", "from object 0, which the log has not", |store| {
        let at = a_backscatter(store);
        change::<UInt8Type>(sensor(store, "TURNING"), "return_kind", FRAME, move |all| all[at] = 0);
    }),
    ("radar velocity", "m/s off", |store| {
        change::<Float32Type>(sensor(store, "RAD_FRONT"), "velocity", FRAME, |all| {
            all.iter_mut().for_each(|v| *v += 0.1);
        });
    }),
    ("radar presence", "RAD_FRONT has no return", |store| {
        let none = |first: usize, rows: RecordBatch| {
            if first != FRAME {
                return vec![rows];
            }
            let columns = rows.columns().iter().map(|column| match column.as_list_opt::<i32>() {
                Some(list) => {
                    let DataType::List(field) = list.data_type() else { unreachable!() };
                    let empty = OffsetBuffer::from_lengths([0]);
                    Arc::new(ListArray::new(field.clone(), empty, list.values().slice(0, 0), None))
                        as ArrayRef
                }
                None => column.clone(),
            });
            vec![RecordBatch::try_new(rows.schema(), columns.collect()).expect("fits")]
        };
        edit(&sensor(store, "RAD_FRONT"), none, |note| note);
    }),
    ("gnss", "m off", |store| {
        change::<Float64Type>(sensor(store, "GNSS"), "altitude_m", FRAME, |all| all[FRAME] += 1e-5);
    }),
    ("gnss", "m off", |store| {
        change::<Float64Type>(sensor(store, "GNSS"), "longitude_deg", FRAME, |all| all[FRAME] += 1e-9);
    }),
    ("imu", "acceleration is", |store| {
        change::<Float64Type>(sensor(store, "IMU"), "acceleration_mps2", FRAME, |all| {
            all[3 * FRAME] += 0.001
        });
    }),
    ("imu", "rates are", |store| {
        change::<Float64Type>(sensor(store, "IMU"), "gyroscope_radps", FRAME, |all| all[3 * FRAME] += 0.001);
    }),
    ("imu", "compass is", |store| {
        change::<Float64Type>(sensor(store, "IMU"), "compass_rad", FRAME, |all| all[FRAME] -= 1e-6);
    }),
];

/// Faults of sums, which are compared when every frame is looked at.
pub(super) const OF_SUMS: &[Plant] = &[
    ("counts", "partial statistics: bev_cells", |store| {
        change::<UInt64Type>(table(store, "stats/bev-gt.vehicle_0"), "count", 0, |all| all[0] += 1);
    }),
    ("counts", "partial statistics: seen_by_vehicles", |store| {
        change::<Int32Type>(table(store, "stats/postprocess-valid.boxes"), "bin", 0, |all| {
            // The last row is of the last measure: a place, now in another quarter of the 80 by 80 squares.
            let last = all.len() - 1;
            let is_behind_right = all[last] / 80 >= 40 && all[last] % 80 >= 40;
            all[last] = if is_behind_right { 0 } else { 6399 };
        });
    }),
    ("statistics", "bev_cells.parquet: cells of road", |store| {
        change::<UInt64Type>(store.join("stats/bev_cells.parquet"), "cells", 0, |all| all[0] += 1);
    }),
];

/// Faults of a store whose sensors and labels are at a part of the frame rate.
pub(super) const OF_SELDOM: &[Plant] = &[
    ("times", "rows do not count every 2. of the 20 frames", |store| {
        let without = |first: usize, rows: RecordBatch| if first == 3 { Vec::new() } else { vec![rows] };
        edit(&sensor(store, "LIDAR"), without, |note| note);
    }),
    ("times", "not every 4. of 20 frames", |store| {
        let path = store.join("scenes/0000/bev/vehicle_0.npz");
        let mut reader = NpzReader::new(File::open(&path).expect("opens")).expect("is an archive");
        let mut writer = NpzWriter::new(Vec::new());
        for (name, as_name) in [("0000.npy", "0000.npy"), ("0004.npy", "0002.npy")] {
            let array = reader.read(name).expect("reads");
            let packed = encode_member(as_name, Scalar::Bool, &array.shape, &array.bytes, 1).expect("packs");
            writer.append(packed).expect("writes");
        }
        rewrite(&path, &writer.finish().expect("ends"));
    }),
    ("times", "has frame 3, only every 2. is wanted", |store| {
        change::<UInt32Type>(table(store, "hd_map"), "frame", 0, |all| all[2] = 3);
    }),
    ("calibration", "says every_n_frames is 1", |store| {
        let faster = |note: String| note.replace("\"every_n_frames\":2", "\"every_n_frames\":1");
        edit(&sensor(store, "LIDAR"), |_, rows| vec![rows], faster);
    }),
    ("observed", "no lidar sweeps, so that", |store| {
        let path = store.join("dataset.json");
        let mut dataset: Value = serde_json::from_slice(&fs::read(&path).expect("reads")).expect("is JSON");
        dataset["config"]["vehicle_rig"]["lidars"][0]["every_n_frames"] = 3.into();
        rewrite(&path, dataset.to_string().as_bytes());
    }),
    ("calibration", "the lens is", |store| {
        edit(&sensor(store, "IST-CAM_BENT"), |_, rows| vec![rows], |note| note.replace("-0.28", "-0.27"));
    }),
    ("depth", "are at another depth than in CAM_WIDE", |store| {
        let farther = |_: usize, rows: RecordBatch| vec![with_depths(&rows, |depth| depth + depth / 16)];
        edit(&sensor(store, "DPT-CAM_WIDE"), farther, |note| note);
    }),
];
