//! Faults of arrays, and those that need two files to agree.

use arrow_array::types::Float32Type;
use codecs::Scalar;

use super::tools::{
    FRAME, Plant, a_voxel, array, change, far_cells, raise, recell, repaint, reseen, reshape, sensor,
    two_alike,
};

/// Faults that need two files to agree, and of arrays.
pub(super) const OF_ARRAYS: &[Plant] = &[
    ("box pixels", "pixels beyond its box", |store| {
        // A pixel of a car in a corner of the picture, for each camera that sees one.
        for camera in ["FRONT_LEFT", "FRONT", "FRONT_RIGHT", "BACK_LEFT", "BACK", "BACK_RIGHT"] {
            repaint(sensor(store, &format!("IST-CAM_{camera}")), |pixels| {
                if let Some(car) = pixels.iter().copied().find(|p| p[0] == 14) {
                    pixels[..200].fill(car);
                    let last = pixels.len() - 1;
                    pixels[last] = car;
                }
            });
        }
    }),
    ("box points", "lies outside its box", |store| {
        // All that the semantic lidar sees is 2 m farther to the left than it was.
        change::<Float32Type>(sensor(store, "SEG-LIDAR"), "y", FRAME, |all| {
            all.iter_mut().for_each(|y| *y += 2.0)
        });
    }),
    ("voxels", "lies in voxel", |store| {
        let cell = a_voxel(store);
        recell(store.join("scenes/0000/occupancy/vehicle_0.npz"), Scalar::U8, move |tags| tags[cell] = 0);
    }),
    ("filling", "have another tag when filled", |store| {
        let cell = a_voxel(store);
        recell(store.join("scenes/0000/occupancy_filled/vehicle_0.npz"), Scalar::U8, move |tags| {
            tags[cell] ^= 1
        });
    }),
    ("voxel rows", "which is not in the log or has other tags", |store| {
        recell(array(store, "occupancy_ids"), Scalar::U16, |ids| {
            ids[..2].copy_from_slice(&60_000_u16.to_le_bytes())
        });
    }),
    ("voxel rows", "beyond its box", |store| {
        // All of the cells of one vehicle or person are said to be another's of the same tags.
        let ids = two_alike(store);
        recell(array(store, "occupancy_ids"), Scalar::U16, move |all| {
            for id in all.as_chunks_mut::<2>().0.iter_mut().filter(|id| **id == ids[0].to_le_bytes()) {
                *id = ids[1].to_le_bytes();
            }
        });
    }),
    ("files", "rows for", |store| {
        reshape(array(store, "occupancy_ids"), Scalar::U16, 2);
    }),
    ("voxel flow", "the object there at [0.00, 0.00, 0.00]", |store| {
        recell(array(store, "occupancy_flow"), Scalar::F32, |flow| {
            flow[..4].copy_from_slice(&0.2_f32.to_le_bytes())
        });
    }),
    ("voxel flow", "do not move as it does", |store| {
        // The other way round.
        recell(array(store, "occupancy_flow"), Scalar::F32, |flow| {
            flow.as_chunks_mut::<4>().0.iter_mut().for_each(|part| part[3] ^= 0x80);
        });
    }),
    ("voxel rows", "listed cells are not in C order", |store| {
        let path = store.join("scenes/0000/occupancy_cells/rsu_0.npz");
        recell(path, Scalar::U16, |cells| {
            let (first, rest) = cells.split_at_mut(8);
            first.swap_with_slice(&mut rest[..8]);
        });
    }),
    ("observed", "on a ray's way is unobserved", |store| {
        reseen(store, |seen| seen.iter_mut().filter(|cell| **cell == 1).for_each(|cell| *cell = 0));
    }),
    ("observed", "which is free", |store| {
        reseen(store, |seen| seen.iter_mut().filter(|cell| **cell == 0).for_each(|cell| *cell = 1));
    }),
    ("observed", "of a return is 1", |store| {
        let cell = |seen: &mut [u8]| seen.iter_mut().find(|cell| **cell == 2).map(|cell| *cell = 1);
        reseen(store, move |seen| assert!(cell(seen).is_some()));
    }),
    ("observed", "voxels without a return are occupied", |store| {
        reseen(store, |seen| *seen.last_mut().expect("has cells") = 2);
    }),
    ("bev objects", "car cells lie in no box", |store| {
        recell(store.join("scenes/0000/bev/vehicle_0.npz"), Scalar::Bool, |bits| {
            bits[7 * 160_000 + 5 * 400 + 5] = 1
        });
    }),
    ("bev presence", "has no car cell", |store| {
        recell(store.join("scenes/0000/bev/vehicle_0.npz"), Scalar::Bool, |bits| {
            bits[7 * 160_000..][..160_000].fill(0)
        });
    }),
    ("bev ground", "lies off the road", |store| {
        // A strip of 4 m right ahead.
        recell(store.join("scenes/0000/bev/vehicle_0.npz"), Scalar::Bool, |bits| {
            bits[150 * 400..190 * 400].fill(0);
        });
    }),
    ("bev map", "amid a road of the map is not set", |store| {
        recell(array(store, "bev"), Scalar::Bool, |bits| bits[..160_000].fill(0));
    }),
    ("bev map", "amid a sidewalk of the map is not set", |store| {
        recell(array(store, "bev"), Scalar::Bool, |bits| bits[3 * 160_000..][..160_000].fill(0));
    }),
    ("bev map", "amid a crosswalk of the map is not set", |store| {
        let path = store.join("scenes/0000/bev/rsu_0.npz");
        recell(path, Scalar::Bool, |bits| bits[4 * 160_000..][..160_000].fill(0));
    }),
    ("bev map", "there is no line about", |store| {
        recell(array(store, "bev"), Scalar::Bool, |bits| bits[2 * 160_000..][..160_000].fill(0));
    }),
    ("bev strays", "the road cell", |store| far_cells(store, 0)),
    ("bev strays", "the road_line cell", |store| far_cells(store, 2)),
    ("bev strays", "the sidewalk cell", |store| far_cells(store, 3)),
    ("bev strays", "the crosswalk cell", |store| far_cells(store, 4)),
    ("bev ids", "shows an object, or none", |store| {
        recell(array(store, "bev_ids"), Scalar::U16, |ids| ids.fill(0));
    }),
    ("bev ids", "beyond its box", |store| {
        // The agent's own object somewhere else: its cells are amid the mask.
        recell(array(store, "bev_ids"), Scalar::U16, |ids| {
            let own = 2 * (200 * 400 + 200);
            let own = [ids[own], ids[own + 1]];
            ids[..2].copy_from_slice(&own);
        });
    }),
    ("bev ids", "which is not in the log or of another class", |store| {
        recell(array(store, "bev_ids"), Scalar::U16, |ids| {
            for id in ids.as_chunks_mut::<2>().0.iter_mut().filter(|id| **id != [0; 2]) {
                *id = 60_000_u16.to_le_bytes();
            }
        });
    }),
    ("bev heights", "has no height", |store| {
        recell(array(store, "bev_heights"), Scalar::F32, |all| {
            all.as_chunks_mut::<4>().0.fill(f32::NAN.to_le_bytes());
        });
    }),
    ("bev heights", "the agent stands", |store| raise(store, 0.6)),
    ("bev heights", "the map says otherwise", |store| raise(store, 0.6)),
    ("bev heights", "meets ground at", |store| raise(store, 0.6)),
    ("bev paint", "there is no stop line about", |store| {
        let path = store.join("scenes/0000/bev_paint/rsu_0.npz");
        recell(path, Scalar::Bool, |bits| bits.fill(0));
    }),
    ("bev paint", "the stop line's cell", |store| {
        recell(array(store, "bev_paint"), Scalar::Bool, |bits| bits[..160_000].fill(1));
    }),
    ("bev hazards", "hazard cells lie in no area", |store| {
        recell(store.join("scenes/0000/bev/vehicle_0.npz"), Scalar::Bool, |bits| bits[160_000] = 1);
    }),
];
