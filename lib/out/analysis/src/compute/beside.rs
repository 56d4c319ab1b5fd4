//! Our numbers beside those of the published dataset, put so that sizes of datasets do not matter.

use schema::scene_info::SceneInfo;
use schema::{BevClass, DetectionClass, Published, Tag};

use super::scenes::{SCENE_HISTOGRAMS, SceneHistogram};
use super::share::ratio;
use super::weather::{WEATHER_TABLES, WeatherTable};
use crate::table::{Section, Table, Tables, Values};

/// The table of sizes.
pub(crate) const SIZE_TABLE: &str = "beside_size";
/// The table of frames by valid objects of each class: our column, then the published one with this ending.
pub(crate) const FRAMES_TABLE: &str = "beside_valid_per_frame";
/// Ending of columns of published values.
pub(crate) const PUBLISHED: &str = "_published";

/// Tables of the page: what both have, ours first. Those without numbers of ours have no rows.
pub(super) fn tables(ours: &Tables, scenes: &[&SceneInfo]) -> Vec<Table> {
    let mut tables = vec![size(ours), means(ours)];
    tables.extend(SCENE_HISTOGRAMS.iter().map(|spec| by_size(spec, scenes)));
    tables.extend(WEATHER_TABLES.iter().map(|spec| weather(spec, ours)));
    tables.extend(boxes(ours));
    tables.push(frames(ours));
    tables.extend([bev(ours), voxels(ours), filled(ours)]);
    tables
}

/// The table of scenes by size beside the published ones.
pub(crate) fn by_size_table(spec: &SceneHistogram) -> String {
    format!("beside_{}", spec.table)
}

/// The table of a matrix of weather beside the published one.
pub(crate) fn weather_table(spec: &WeatherTable) -> String {
    format!("beside_{}", spec.table)
}

/// A name, our value, the published one.
type Pair = (String, Option<f64>, Option<f64>);

fn table(name: &str, title: &str, note: &str, first: &str, decimals: usize, rows: &[Pair]) -> Table {
    let ratio = |(_, ours, theirs): &Pair| match (ours, theirs) {
        (Some(ours), Some(theirs)) if *theirs > 0.0 => Some(ours / theirs),
        _ => None,
    };
    Table::new(name, Section::Published, title, note)
        .with_strings(first, rows.iter().map(|row| row.0.as_str()))
        .with_numbers("ours", decimals, rows.iter().map(|row| row.1))
        .with_numbers("published", decimals, rows.iter().map(|row| row.2))
        .with_numbers("ours_by_published", 3, rows.iter().map(ratio))
}

/// A value of the row that a key names, where there is such a row.
fn look_up<T>(
    table: Option<&Table>,
    key: &str,
    name: &str,
    value: impl Fn(&Table, usize) -> Option<T>,
) -> Option<T> {
    let table = table?;
    let row = table.strings(key).iter().position(|found| found == name)?;
    value(table, row)
}

/// How large the datasets are.
fn size(ours: &Tables) -> Table {
    let count = |name: &str| {
        look_up(ours.get("overview"), "quantity", name, |t, row| t.counts("value").get(row).copied())
    };
    let images =
        look_up(ours.get("images_per_kind"), "kind", "RGB", |t, row| t.counts("images").get(row).copied());
    let boxes =
        |k: usize| DetectionClass::ALL.into_iter().map(|class| Published::boxes(class)[k]).sum::<f64>();
    let voxels: f64 = Tag::ALL.into_iter().map(|tag| Published::voxels(tag)[0]).sum();
    let filled =
        look_up(ours.get("voxel_cells"), "label", "total", |t, row| t.counts("filled").get(row).copied());
    let rows = [
        ("scenes", count("scenes"), Published::SCENES),
        ("frames", count("frames"), Published::FRAMES),
        ("recorded time, s", count("recorded_time_s"), Published::SECONDS),
        ("agent frames", count("agent_frames"), Published::GRIDS),
        ("colour images", images, Published::IMAGES),
        ("boxes", count("boxes"), boxes(0)),
        ("valid boxes", count("valid_boxes"), boxes(1)),
        ("BEV masks", count("bev_grids"), Published::GRIDS),
        ("voxel grids", count("voxel_grids"), Published::GRIDS),
        ("occupied voxels, filled", filled.filter(|n| *n > 0), voxels),
    ];
    let is_empty = count("scenes").is_none_or(|scenes| scenes == 0);
    let counted = rows.into_iter().filter(|row| !is_empty && row.1.is_some());
    let rows: Vec<Pair> =
        counted.map(|(name, ours, theirs)| (name.into(), ours.map(|n| n as f64), Some(theirs))).collect();
    let mut table = table(SIZE_TABLE, "Size", "", "quantity", 0, &rows);
    // Datasets may be thousands of times smaller.
    if let Some(Values::F64 { decimals, .. }) = table.columns.last_mut().map(|column| &mut column.values) {
        *decimals = 6;
    }
    table
}

/// What scenes have on average.
fn means(ours: &Tables) -> Table {
    let each = ours.get("scenes").filter(|table| !table.is_empty());
    let rows: Vec<Pair> = each.map_or_else(Vec::new, |each| {
        let n = each.len() as f64;
        let mean = |column: &str, most: u64| {
            Some(each.counts(column).iter().map(|&value| value.min(most) as f64).sum::<f64>() / n)
        };
        let seconds = each.numbers("duration_s").iter().flatten().sum::<f64>() / n;
        let [vehicles, rsus] = Published::AGENTS.map(|sum| Some(sum / Published::SCENES));
        let [accidents, works] = Published::HAZARDS.map(|sum| Some(sum / Published::SCENES));
        vec![
            ("duration, s".into(), Some(seconds), Some(Published::SECONDS / Published::SCENES)),
            ("data-collection vehicles".into(), mean("vehicles", u64::MAX), vehicles),
            ("road-side units".into(), mean("rsus", u64::MAX), rsus),
            ("accidents".into(), mean("accidents", 10), accidents),
            ("road works".into(), mean("road_works", 10), works),
        ]
    });
    let note = "Means over scenes; ten or more hazards count as ten.";
    table("beside_scene_means", "A scene on average", note, "quantity", 2, &rows)
}

/// Scenes by a number, percent of them, from 0 to the last published bin; what is beyond shares one more.
fn by_size(spec: &SceneHistogram, scenes: &[&SceneInfo]) -> Table {
    let there = &spec.published;
    // Bins of both begin at multiples of the width.
    let before = (there.first / there.width) as usize;
    let end = before + there.scenes.len();
    let values = scenes.iter().map(|scene| (spec.value)(scene) / there.width);
    let last = if there.open { end - 1 } else { end };
    let mut ours = vec![0_u64; end + 1];
    values.for_each(|bin| ours[usize::try_from(bin).map_or(last, |bin| bin.min(last))] += 1);
    // A bin beyond the published ones is there when we have such scenes.
    ours.truncate(if ours[end] > 0 { end + 1 } else { end });
    let has_scenes = |bin: usize| ours[bin] > 0 || bin >= before;
    let first = (0..ours.len()).find(|bin| has_scenes(*bin)).unwrap_or(0);
    let shown = || (first..ours.len()).filter(|_| !scenes.is_empty());
    let label = |bin: usize| {
        let lower = bin as u64 * there.width;
        match (bin >= last, there.width) {
            (true, _) => format!("{lower}+"),
            (false, 1) => lower.to_string(),
            (false, width) => format!("{lower}-{}", lower + width - 1),
        }
    };
    let published = |bin: usize| {
        let scenes = bin.checked_sub(before).and_then(|bin| there.scenes.get(bin)).copied().unwrap_or(0);
        Some(100.0 * f64::from(scenes) / Published::SCENES)
    };
    let percent = |bin: usize| Some(100.0 * ours[bin] as f64 / scenes.len() as f64);
    Table::new(&by_size_table(spec), Section::Published, spec.title, "Percent of the scenes.")
        .with_strings("bin", shown().map(label))
        .with_numbers("ours", 1, shown().map(percent))
        .with_numbers("published", 1, shown().map(published))
}

/// A matrix of weather and the published one.
fn weather(spec: &WeatherTable, ours: &Tables) -> Table {
    let own = ours.get(spec.table).filter(|own| own.counts("scenes").iter().any(|&n| n > 0));
    let rows = || 0..own.map_or(0, Table::len);
    let strings = |column: &str| {
        rows().filter_map(|row| Some(own?.strings(column).get(row)?.clone())).collect::<Vec<_>>()
    };
    let total = spec.published.iter().sum();
    Table::new(&weather_table(spec), Section::Published, spec.title, "Fractions of the scenes.")
        .with_strings("initial", strings("initial"))
        .with_strings("final", strings("final"))
        .with_counts("scenes", rows().filter_map(|row| own?.counts("scenes").get(row).copied()))
        .with_numbers("ours", 4, rows().map(|row| own?.numbers("fraction").get(row).copied().flatten()))
        .with_counts("published_scenes", rows().map(|row| spec.published[row]))
        .with_numbers("published", 4, rows().map(|row| ratio(spec.published[row], total)))
}

/// Objects a frame, and how many of them are valid.
fn boxes(ours: &Tables) -> [Table; 3] {
    let own = ours.get("boxes_per_class").filter(|own| !own.is_empty());
    let value = |class: &str, column: &str| {
        look_up(own, "class", class, |own, row| own.numbers(column).get(row).copied().flatten())
    };
    let rows = |column: &str, theirs: fn([f64; 3]) -> f64| -> Vec<Pair> {
        let classes = DetectionClass::ALL.into_iter().filter(|_| own.is_some());
        let row = |class: DetectionClass| {
            let ours = value(class.name(), column);
            (class.name().replace('_', " "), ours, Some(theirs(Published::boxes(class))))
        };
        classes.map(row).collect()
    };
    let valid = rows("valid_per_frame", |[_, valid, _]| valid / Published::FRAMES);
    let all = rows("all_per_frame", |[all, ..]| all / Published::FRAMES);
    let share = rows("valid_percent", |[all, valid, _]| 100.0 * valid / all);
    let note = "Unique objects, each once a frame. Valid: some agent saw it.";
    [
        table("beside_boxes", "Valid objects in a frame", note, "class", 2, &valid),
        table("beside_all_boxes", "Objects in a frame", note, "class", 2, &all),
        table("beside_valid_share", "Valid objects, percent of all", "", "class", 1, &share),
    ]
}

/// Frames by the number of valid objects in them, percent of all frames.
fn frames(ours: &Tables) -> Table {
    let own = ours.get("valid_per_frame").filter(|own| !own.is_empty());
    let bins = schema::measures::tracks::VALID_PER_FRAME_BINS;
    let edges: Vec<i32> = bins.edges().chain([bins.upper]).filter(|_| own.is_some()).collect();
    let label = |edge: i32| {
        if edge == bins.upper { format!("{edge}+") } else { format!("{edge}-{}", edge + bins.width - 1) }
    };
    let note = "Percent of the frames.";
    let mut table = Table::new(FRAMES_TABLE, Section::Published, "Frames by number of valid objects", note)
        .with_strings("bin", edges.iter().map(|&edge| label(edge)));
    for class in DetectionClass::ALL {
        let counts = own.map_or(&[][..], |own| own.counts(class.name()));
        let total: u64 = counts.iter().fold(0, |a, &b| a.saturating_add(b));
        let count = |edge: i32| {
            let row = own?.numbers("lower").iter().position(|lower| *lower == Some(f64::from(edge)))?;
            counts.get(row).copied()
        };
        let ours = |&edge: &i32| (total > 0).then(|| 100.0 * count(edge).unwrap_or(0) as f64 / total as f64);
        let theirs = Published::valid_per_frame(class);
        let published =
            |bin: usize| Some(100.0 * theirs.get(bin).copied().unwrap_or(0) as f64 / Published::FRAMES);
        table = table.with_numbers(class.name(), 2, edges.iter().map(ours)).with_numbers(
            &format!("{}{PUBLISHED}", class.name()),
            2,
            (0..edges.len()).map(published),
        );
    }
    table
}

/// Share of the grid that has a class.
fn bev(ours: &Tables) -> Table {
    let own = ours.get("bev_cells").filter(|own| !own.is_empty());
    let percent = |class: &str| {
        look_up(own, "class", class, |own, row| own.numbers("percent_of_grid").get(row).copied().flatten())
    };
    let classes = BevClass::ALL.into_iter().filter(|_| own.is_some());
    let row = |class: BevClass| {
        let theirs = 100.0 * Published::bev_cells(class) / (Published::GRIDS * Published::BEV_CELLS);
        (class.name().replace('_', " "), percent(class.name()), Some(theirs))
    };
    let note = "Percent of a mask's cells. The published masks are of 400 by 400 cells of 0.4 m; smaller ones show more road.";
    table(
        "beside_bev",
        "BEV cells, percent of the grid",
        note,
        "class",
        4,
        &classes.map(row).collect::<Vec<_>>(),
    )
}

/// Share of the occupied voxels that have a label.
fn voxels(ours: &Tables) -> Table {
    let own = ours.get("voxel_cells");
    let count = |label: &str| {
        look_up(own, "label", label, |own, row| own.counts("unfilled").get(row).map(|&n| n as f64))
    };
    let total = count("total").filter(|total| *total > 0.0);
    let all: f64 = Tag::ALL.into_iter().map(|tag| Published::voxels(tag)[1]).sum();
    let rows: Vec<Pair> = Tag::ALL
        .into_iter()
        .filter_map(|tag| {
            let ours = 100.0 * count(tag.name()).unwrap_or(0.0) / total?;
            let theirs = 100.0 * Published::voxels(tag)[1] / all;
            let name = tag.name().replace('_', " ");
            (ours > 0.0 || theirs > 0.0).then_some((name, Some(ours), Some(theirs)))
        })
        .collect();
    let note = "Percent of the occupied voxels, insides not filled. The published grids are of 0.1 m; of larger voxels thin \
                things take a larger share.";
    table("beside_voxels", "Voxels, percent of the occupied ones", note, "label", 3, &rows)
}

/// How much filling adds.
fn filled(ours: &Tables) -> Table {
    let own = ours.get("voxel_cells");
    let rows: Vec<Pair> = Tag::ALL
        .into_iter()
        .filter_map(|tag| {
            let ours = look_up(own, "label", tag.name(), |own, row| {
                own.numbers("filled_by_unfilled").get(row).copied().flatten()
            })?;
            let [filled, plain] = Published::voxels(tag);
            // Labels that filling leaves alone in both say nothing.
            let theirs = (plain > 0.0).then(|| filled / plain);
            let says = ours != 1.0 || theirs.is_some_and(|theirs| theirs != 1.0);
            says.then(|| (tag.name().replace('_', " "), Some(ours), theirs))
        })
        .collect();
    let note = "Voxels with the insides of closed objects filled, by those without. Larger voxels leave less to fill.";
    table("beside_filled", "Filled by unfilled voxels", note, "label", 3, &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_are_those_of_the_published_figure_and_one_beyond() {
        let scene = |seconds: f64, works: u16| SceneInfo {
            duration_s: seconds,
            n_road_work_hazards: works.into(),
            ..SceneInfo::default()
        };
        let spec = |table: &str| SCENE_HISTOGRAMS.iter().find(|spec| spec.table == table).expect("there");
        let rows = |table: &Table| -> Vec<(String, f64, f64)> {
            let values = |column: &str, row: usize| table.numbers(column)[row].expect("a number");
            let bins = table.strings("bin").iter().enumerate();
            bins.map(|(row, bin)| (bin.clone(), values("ours", row), values("published", row))).collect()
        };
        let scenes = [scene(6.0, 0), scene(8.0, 9), scene(40.0, 10), scene(50.0, 77)];
        let scenes: Vec<&SceneInfo> = scenes.iter().collect();
        let durations = rows(&by_size(spec("scenes_by_duration"), &scenes));
        // From the shortest of ours, 6 s, to 32 s, and what is longer.
        assert_eq!(durations.len(), 28);
        assert_eq!((durations[0].clone(), durations[1].1), (("6".into(), 25.0, 0.0), 0.0));
        assert_eq!((durations[2].0.as_str(), durations[2].1), ("8", 25.0));
        assert!((durations[2].2 - 300.0 / 258.0).abs() < 1e-12);
        assert_eq!(durations[27], ("33+".into(), 50.0, 0.0));
        let works = rows(&by_size(spec("scenes_by_road_works"), &scenes));
        assert_eq!(works.len(), 11);
        assert_eq!((works[10].0.as_str(), works[10].1, works[9].1), ("10+", 50.0, 25.0));
        assert!(by_size(spec("scenes_by_rsus"), &[]).is_empty());
    }
}
