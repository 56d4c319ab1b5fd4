//! What a stage writes is there whole or not at all, however often it is stopped.

use std::io::Write;

use schema::table::{Column, Row};
use schema::tables::{GnssRow, LidarRow, SignalRow};
use store::{
    Area, Attempt, Identity, Listing, MadeBy, Manifest, Problem, Scope, StoreError, TableOptions, keys,
    verify,
};

use crate::common::{Bench, SCOPE, STAGE, gnss, identity, key, on_every_backend, run, run_half};

on_every_backend!(
    rows_come_back_and_checksums_hold,
    columns_that_nobody_asks_for_are_not_read,
    parts_of_an_object_are_read_alone,
    listings_tell_sizes_and_folders,
    what_is_far_too_large_for_a_record_is_not_read,
    lists_keep_one_frame_per_group,
    groups_are_encoded_on_any_thread,
    some_rows_of_a_table_are_read,
    a_text_that_means_nothing_is_named_with_its_place,
    a_killed_try_keeps_its_finished_units,
    a_try_killed_after_its_manifest_is_tidied,
    leftovers_of_the_plan_are_found_all_over_the_store,
    a_finished_unit_of_another_config_is_not_kept,
    what_depends_on_what_it_did_is_kept,
    a_stopped_try_keeps_what_is_still_as_it_was,
    what_a_stopped_try_of_other_settings_wrote_is_removed,
    forcing_changes_the_digest_once_even_when_killed_between,
    what_a_new_try_no_longer_writes_is_removed,
    broken_shards_are_named,
    damaged_records_are_done_again,
    two_outputs_of_one_name_are_refused,
    of_two_that_put_one_succeeds,
    two_processes_of_one_mind_agree,
    two_builds_of_one_version_agree,
    an_edited_program_takes_up_no_unit_of_another,
    two_processes_at_odds_leave_no_manifest,
    an_object_is_replaced_whole,
    a_manifest_is_replaced_only_as_it_was_read,
);

const TWO: [&str; 2] = ["vehicle_0", "vehicle_1"];

fn rows_come_back_and_checksums_hold(bench: &Bench) {
    let store = &bench.store;
    let manifest = run(store, "c", false, &TWO).expect("runs");
    assert_eq!(manifest.outputs.len(), 2);
    let rows: Vec<GnssRow> = store.read_rows(&manifest, &key("vehicle_1")).expect("reads");
    assert_eq!(rows, gnss(40));
    let checked = verify(store, &[(SCOPE, STAGE)], |_| {}).expect("verifies");
    assert_eq!((checked.manifests, checked.shards, checked.findings), (1, 2, vec![]));
    let manifest = SCOPE.manifest(STAGE);
    assert_eq!(bench.tree().into_keys().collect::<Vec<_>>(), [manifest, key("vehicle_0"), key("vehicle_1")]);
}

schema::columns! {
    /// How high.
    Altitude of GnssRow { altitude_m: f64 }
}

fn columns_that_nobody_asks_for_are_not_read(bench: &Bench) {
    let manifest = run(&bench.store, "c", false, &TWO[..1]).expect("runs");
    // That of the scene follows the four letters that a file begins with; nobody asks for it, so that what
    // is damaged reaches into the next one.
    let mut bytes = bench.bytes(&key("vehicle_0"));
    bytes[4..80].fill(0xff);
    bench.put(&key("vehicle_0"), &bytes);
    let whole: Result<Vec<GnssRow>, _> = bench.store.read_rows(&manifest, &key("vehicle_0"));
    assert!(matches!(whole, Err(StoreError::Corrupt { .. })), "{whole:?}");
    let some: Vec<Altitude> = bench.store.read_rows(&manifest, &key("vehicle_0")).expect("reads");
    assert_eq!(some, gnss(40).iter().map(|r| Altitude { altitude_m: r.altitude_m }).collect::<Vec<_>>());
}

fn parts_of_an_object_are_read_alone(bench: &Bench) {
    bench.put("a/b", b"0123456789");
    let shard = bench.store.backend().open("a/b", None).expect("opens");
    assert_eq!(shard.size(), 10);
    assert_eq!(shard.read_at(3..7).expect("reads"), "3456");
    assert_eq!(shard.read_at(0..10).expect("reads"), "0123456789");
    assert!(shard.read_at(10..10).expect("is empty").is_empty());
    assert!(shard.read_at(8..11).is_err(), "beyond its end");
    assert!(matches!(bench.store.backend().open("a", None), Err(StoreError::Missing { .. })));
    assert!(matches!(bench.store.backend().open("a/c", None), Err(StoreError::Missing { .. })));
    assert_eq!(bench.store.backend().size("a/c").expect("asks"), None);
    // Folders end where their name does.
    bench.put("ab/c", b"");
    assert_eq!(bench.store.backend().keys("a").expect("lists"), ["a/b"]);
}

fn listings_tell_sizes_and_folders(bench: &Bench) {
    let backend = bench.store.backend();
    assert_eq!(backend.list("").expect("lists"), Listing::default());
    assert_eq!(backend.folders("scenes").expect("lists"), [""; 0]);
    for (key, bytes) in [("scenes/0007/log/a", 3), ("scenes/0010/b", 0), ("scenes/note", 1), ("top", 2)] {
        bench.put(key, &vec![7; bytes]);
    }
    let listed = |folder: &str| -> Vec<(String, u64)> {
        let listing = backend.list(folder).expect("lists");
        listing.objects.into_iter().map(|object| (object.key, object.bytes)).collect()
    };
    assert_eq!(listed("scenes/0007"), [("scenes/0007/log/a".to_owned(), 3)]);
    let all = [("scenes/0007/log/a", 3), ("scenes/0010/b", 0), ("scenes/note", 1), ("top", 2)];
    assert_eq!(listed(""), all.map(|(key, bytes)| (key.to_owned(), bytes)));
    assert_eq!(backend.folders("scenes").expect("lists"), ["0007", "0010"]);
    assert_eq!(backend.folders("").expect("lists"), ["scenes"]);
    assert_eq!(backend.folders("scenes/0007").expect("lists"), ["log"]);

    if !backend.lists_unfinished() {
        return;
    }
    let begun = backend.create("scenes/0010/c", STAGE).expect("creates");
    let has_unfinished = |folder: &str| backend.list(folder).expect("lists").has_unfinished;
    assert_eq!(["", "scenes/0010", "scenes/0007"].map(has_unfinished), [true, true, false]);
    drop(begun);
    assert!(!has_unfinished(""));
}

fn what_is_far_too_large_for_a_record_is_not_read(bench: &Bench) {
    let mut sink = bench.store.backend().create("plan/_manifest.json", STAGE).expect("creates");
    for _ in 0..65 {
        sink.write_all(&vec![b' '; 1 << 20]).expect("writes");
    }
    sink.commit().expect("commits");
    let error = bench.store.manifest(Scope::Plan, "spawn-planner").expect_err("is refused");
    assert!(matches!(error, StoreError::Corrupt { .. }), "{error}");
    assert!(error.to_string().contains("has 68157440 bytes"), "{error}");
}

fn sweep(frame: u32) -> LidarRow {
    LidarRow {
        frame,
        x: vec![1.5; 1000 + frame as usize],
        ring: vec![3; 1000 + frame as usize],
        tag: vec![9; 1000 + frame as usize],
        ..LidarRow::default()
    }
}

fn lists_keep_one_frame_per_group(bench: &Bench) {
    let rows: Vec<LidarRow> = (0..5).map(sweep).collect();
    let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    let mut table = unit.table("scenes/0007/x.parquet", TableOptions::frames(Vec::new())).expect("opens");
    table.push(&rows).expect("writes");
    unit.add(table.finish().expect("finishes"));
    unit.finish().expect("commits");
    let manifest = attempt.commit().expect("commits");
    let groups: Vec<Vec<LidarRow>> = bench
        .store
        .row_groups(&manifest, "scenes/0007/x.parquet")
        .expect("opens")
        .map(|g| g.expect("reads"))
        .collect();
    assert_eq!(groups.iter().map(Vec::len).collect::<Vec<_>>(), [1; 5]);
    assert_eq!(groups.concat(), rows);
    // Rows may be passed over.
    let mut some = bench.store.row_groups::<LidarRow>(&manifest, "scenes/0007/x.parquet").expect("opens");
    assert_eq!(some.next().expect("has one").expect("reads"), rows[..1]);
    some.pass(2).expect("passes");
    assert_eq!(some.next().expect("has one").expect("reads"), rows[3..4]);
    some.pass(7).expect("passes beyond the end");
    assert!(some.next().is_none());
}

/// Groups that threads encoded give the bytes of rows that were pushed.
fn groups_are_encoded_on_any_thread(bench: &Bench) {
    let rows: Vec<LidarRow> = (0..5).map(sweep).collect();
    let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    let [pushed, appended] = ["a", "b"].map(|name| format!("scenes/0007/{name}.parquet"));
    let mut table = unit.table(&pushed, TableOptions::frames(Vec::new())).expect("opens");
    table.push(&rows).expect("writes");
    unit.add(table.finish().expect("finishes"));
    let mut table = unit.table(&appended, TableOptions::frames(Vec::new())).expect("opens");
    let encoder = table.encoder();
    let groups = std::thread::scope(|threads| {
        let encoder = &encoder;
        // Two rows are two groups of such a table.
        let encode = |rows| threads.spawn(move || encoder.encode(rows).expect("encodes"));
        let begun: Vec<_> = [&rows[1..3], &rows[3..4]].map(encode).into();
        begun.into_iter().flat_map(|thread| thread.join().expect("ends")).collect::<Vec<_>>()
    });
    // Both ways in one table.
    table.push(&rows[..1]).expect("writes");
    groups.into_iter().for_each(|group| table.append(group).expect("writes"));
    table.push(&rows[4..]).expect("writes");
    let shard = table.finish().expect("finishes");
    assert_eq!(shard.output().rows, 5);
    unit.add(shard);
    // A group that was begun ends before the next one.
    let open = "scenes/0007/c.parquet";
    let mut table = unit.table(open, TableOptions::default()).expect("opens");
    table.push(&rows[..2]).expect("writes");
    let groups = table.encoder().encode(&rows[2..]).expect("encodes");
    assert_eq!(groups.len(), 1);
    groups.into_iter().for_each(|group| table.append(group).expect("writes"));
    unit.add(table.finish().expect("finishes"));
    unit.finish().expect("commits");
    let manifest = attempt.commit().expect("commits");
    assert!(bench.bytes(&pushed) == bench.bytes(&appended));
    let groups = bench.store.row_groups::<LidarRow>(&manifest, open).expect("opens");
    let groups: Vec<Vec<LidarRow>> = groups.map(|group| group.expect("reads")).collect();
    assert_eq!(groups.concat(), rows);
}

fn some_rows_of_a_table_are_read(bench: &Bench) {
    // Three groups of the default size, of which batches are a part.
    let rows: Vec<SignalRow> = (0..150_000)
        .map(|frame| SignalRow { frame, id: (frame % 1000) as u16, ..SignalRow::default() })
        .collect();
    let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    unit.rows("scenes/0007/log/signals.parquet", &rows).expect("writes");
    unit.finish().expect("commits");
    let manifest = attempt.commit().expect("commits");
    let read = |wanted: &[std::ops::Range<usize>], passed: usize| {
        let groups =
            bench.store.rows_at::<SignalRow>(&manifest, "scenes/0007/log/signals.parquet", wanted.to_vec());
        let mut groups = groups.expect("opens");
        groups.pass(passed).expect("passes");
        groups.flat_map(|group| group.expect("reads")).collect::<Vec<_>>()
    };
    let all = std::slice::from_ref(&(0..150_000));
    let ends: &[&[std::ops::Range<usize>]] = &[
        &[],
        all,
        &[5..6, 65_530..65_540, 65_541..65_541, 149_999..150_000],
        &[70_000..70_001, 131_071..131_073],
        &[0..1, 1..20_000, 149_990..200_000, 300_000..300_001],
    ];
    for wanted in ends {
        let expected: Vec<&SignalRow> = wanted
            .iter()
            .flat_map(|range| range.start.min(150_000)..range.end.min(150_000))
            .map(|i| &rows[i])
            .collect();
        for passed in [0, 1, 7, 20_000] {
            let found = read(wanted, passed);
            assert!(found.iter().eq(expected.iter().copied().skip(passed)), "{wanted:?} but {passed}");
        }
    }
}

fn a_text_that_means_nothing_is_named_with_its_place(bench: &Bench) {
    // More rows than are read at once.
    let signals = SignalRow::to_columns(&vec![SignalRow::default(); 10_000]);
    let mut columns: Vec<_> = SignalRow::fields().iter().map(|field| field.name).zip(signals).collect();
    let Some((_, Column::Str(texts))) = columns.iter_mut().find(|(name, _)| *name == "state") else {
        panic!("states are texts");
    };
    texts[9_000] = "Blue".into();
    let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    unit.columns("scenes/0007/log/signals.parquet", columns).expect("writes");
    unit.finish().expect("commits");
    let manifest = attempt.commit().expect("commits");
    let error = bench.store.read_rows::<SignalRow>(&manifest, "scenes/0007/log/signals.parquet");
    let error = error.expect_err("no light is blue").to_string();
    for part in ["scenes/0007/log/signals.parquet", "column `state`, row 9000: `Blue` is no signal state"] {
        assert!(error.contains(part), "{error}");
    }
}

fn a_killed_try_keeps_its_finished_units(broken: &Bench) {
    let clean = broken.another();
    run(&clean.store, "c", false, &TWO).expect("runs");

    // The process dies with one unit finished and a shard in hand.
    let store = &broken.store;
    let attempt = Attempt::start(store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is new");
    unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
    unit.finish().expect("finishes");
    let unit = attempt.unit("vehicle_1").expect("asks").expect("is new");
    let mut hand = unit.file(&key("vehicle_1")).expect("opens");
    hand.write_all(b"half a shard").expect("writes");
    std::mem::forget(hand);
    assert!(store.manifest(SCOPE, STAGE).expect("asks").is_none());
    let left = store.backend().unfinished("").expect("lists");
    if store.backend().lists_unfinished() {
        assert!(left.len() == 1 && left[0].owner == STAGE && left[0].abandoned, "{left:?}");
    }
    assert!(!store.backend().keys("").expect("lists").contains(&key("vehicle_1")), "half is nothing");

    let attempt = Attempt::start(store, identity("c"), false).expect("starts again");
    assert!(attempt.unit("vehicle_0").expect("asks").is_none(), "is kept");
    let mut unit = attempt.unit("vehicle_1").expect("asks").expect("was lost");
    unit.rows(&key("vehicle_1"), &gnss(40)).expect("writes");
    unit.finish().expect("finishes");
    attempt.commit().expect("commits");
    assert_eq!(clean.tree(), broken.tree());
}

fn a_try_killed_after_its_manifest_is_tidied(bench: &Bench) {
    let store = &bench.store;
    run(store, "c", false, &["vehicle_0"]).expect("runs");
    let clean = bench.tree();
    store.write_json(&SCOPE.part(STAGE, "vehicle_0"), STAGE, &1).expect("writes");
    store.write_json(&SCOPE.redo(STAGE), STAGE, &1).expect("writes");
    Attempt::tidy(store, SCOPE, STAGE).expect("tidies");
    assert_eq!(clean, bench.tree());
}

fn leftovers_of_the_plan_are_found_all_over_the_store(bench: &Bench) {
    let backend = bench.store.backend();
    if !backend.lists_unfinished() {
        return;
    }
    let of_plan = [keys::DATASET, "maps/convoy/demo.xodr.zst", keys::PLAN_SCENES, "models/van/van.glb"];
    for key in of_plan {
        std::mem::forget(backend.create(key, "spawn-planner").expect("creates"));
    }
    assert_eq!(backend.unfinished("").expect("lists").len(), 4);
    assert_eq!(backend.unfinished("maps").expect("lists").len(), 1);
    assert_eq!(backend.sweep(Area::Below("plan"), "bev-gt").expect("sweeps"), 0, "not its owner");
    Attempt::tidy(&bench.store, Scope::Plan, "spawn-planner").expect("tidies");
    assert!(bench.tree().is_empty());
}

fn a_finished_unit_of_another_config_is_not_kept(bench: &Bench) {
    run_half(&bench.store, "old", false);
    let attempt = Attempt::start(&bench.store, identity("new"), false).expect("starts");
    assert!(attempt.unit("vehicle_0").expect("asks").is_some());
}

/// A table of a sensor, made from some settings.
fn table(name: &str) -> String {
    keys::scene(7, &format!("sensors/vehicle_0/{name}.parquet"))
}

/// Makes or keeps tables, each named with what it is made from, without finishing the unit; tells which were
/// kept.
fn unit_of<'a>(attempt: &'a Attempt, tables: &[(&str, &str)]) -> (store::Unit<'a>, Vec<String>) {
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is to do");
    for &(name, made_from) in tables {
        if !unit.keep(&table(name), made_from).expect("asks") {
            let rows = gnss(made_from.len() as u32);
            let shard = unit.finished_rows(&table(name), &rows).expect("writes");
            unit.add(shard.made_from(made_from, std::collections::BTreeMap::new()));
        }
    }
    let kept = unit.kept().iter().map(|output| output.key.clone()).collect();
    (unit, kept)
}

fn sensors(bench: &Bench, config: &str, force: bool, tables: &[(&str, &str)]) -> Vec<String> {
    let attempt = Attempt::start(&bench.store, identity(config), force).expect("starts");
    let (unit, kept) = unit_of(&attempt, tables);
    unit.finish().expect("finishes");
    attempt.commit().expect("commits");
    kept
}

const BEFORE: [(&str, &str); 3] = [("LIDAR", "1"), ("ROOF", "1"), ("RADAR", "1")];
const AFTER: [(&str, &str); 3] = [("LIDAR", "1"), ("ROOF", "16"), ("FLOW", "1")];

fn what_depends_on_what_it_did_is_kept(bench: &Bench) {
    let fresh = bench.another();
    assert_eq!(sensors(&fresh, "d", false, &AFTER), [""; 0]);
    assert_eq!(sensors(bench, "c", false, &BEFORE), [""; 0]);
    assert_eq!(sensors(bench, "d", false, &AFTER), [table("LIDAR")]);
    assert_eq!(bench.tree(), fresh.tree(), "as from nothing");
    // Other code or inputs, or a wish: all of it.
    let other = |change: fn(&mut Identity)| {
        let mut identity = identity("c");
        change(&mut identity);
        let attempt = Attempt::start(&bench.store, identity, false).expect("starts");
        let (_, kept) = unit_of(&attempt, &AFTER);
        kept.len()
    };
    assert_eq!(other(|_| {}), 3);
    assert_eq!(other(|identity| identity.code_version = "2".into()), 0);
    assert_eq!(other(|identity| drop(identity.inputs.insert("simulate-and-log".into(), "new".into()))), 0);
    let forced = Attempt::start(&bench.store, identity("c"), true).expect("starts");
    assert!(unit_of(&forced, &AFTER).1.is_empty());
    // A shard that is cut short is none.
    let whole = bench.bytes(&table("LIDAR"));
    bench.put(&table("LIDAR"), &whole[1..]);
    assert_eq!(other(|_| {}), 2);
}

fn a_stopped_try_keeps_what_is_still_as_it_was(bench: &Bench) {
    let fresh = bench.another();
    sensors(&fresh, "d", false, &AFTER);
    sensors(bench, "c", false, &BEFORE);
    let old = bench.tree();
    // Stopped when the unit was whole: it is taken up.
    let attempt = Attempt::start(&bench.store, identity("d"), false).expect("starts");
    let (unit, _) = unit_of(&attempt, &AFTER);
    unit.finish().expect("finishes");
    drop(attempt);
    let again = Attempt::start(&bench.store, identity("d"), false).expect("starts");
    assert!(again.unit("vehicle_0").expect("asks").is_none());
    drop(again);
    // The old settings are wanted back: of the shards that were replaced none is taken for the old one, were
    // it of its size. Those of the stopped try that fit are as good.
    let cut = old[&table("ROOF")].iter().map(|byte| !byte).collect::<Vec<u8>>();
    bench.put(&table("ROOF"), &cut);
    let back = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let (unit, kept) = unit_of(&back, &BEFORE);
    assert_eq!(kept, [table("LIDAR"), table("RADAR")]);
    drop(unit);
    drop(back);
    assert_eq!(sensors(bench, "e", false, &[("FLOW", "1"), ("LIDAR", "2")]), [table("FLOW")]);
    sensors(bench, "d", false, &AFTER);
    assert_eq!(bench.tree(), fresh.tree());
}

fn what_a_stopped_try_of_other_settings_wrote_is_removed(bench: &Bench) {
    let fresh = bench.another();
    sensors(&fresh, "c", false, &BEFORE);
    for is_first in [true, false] {
        let attempt = Attempt::start(&bench.store, identity("d"), false).expect("starts");
        let (unit, _) = unit_of(&attempt, &AFTER);
        unit.finish().expect("finishes");
        drop(attempt);
        // It is stopped again under the settings of before, when the unit's record is theirs.
        if is_first {
            let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
            let (unit, _) = unit_of(&attempt, &BEFORE);
            unit.finish().expect("finishes");
            drop(attempt);
        }
        let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
        if let Some(unit) = attempt.unit("vehicle_0").expect("asks") {
            drop(unit);
            unit_of(&attempt, &BEFORE).0.finish().expect("finishes");
        }
        attempt.commit().expect("commits");
        assert_eq!(bench.tree(), fresh.tree());
    }
}

fn forcing_changes_the_digest_once_even_when_killed_between(bench: &Bench) {
    let store = &bench.store;
    let first = run(store, "c", false, &TWO).expect("runs");
    let again = run(store, "c", false, &TWO).expect("runs");
    assert_eq!(first.digest(), again.digest());

    let attempt = Attempt::start(store, identity("c"), true).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("forced");
    assert!(store.manifest(SCOPE, STAGE).expect("asks").is_some(), "the old one still stands");
    unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
    unit.finish().expect("finishes");
    assert!(store.manifest(SCOPE, STAGE).expect("asks").is_none(), "its shards are being replaced");
    drop(attempt);
    let forced = run(store, "c", true, &TWO).expect("runs");
    assert_eq!(forced.generation, 1);
    assert_ne!(first.digest(), forced.digest());
    assert_eq!(first.outputs, forced.outputs);
}

fn what_a_new_try_no_longer_writes_is_removed(bench: &Bench) {
    run(&bench.store, "c", false, &TWO).expect("runs");
    run(&bench.store, "d", false, &["vehicle_0"]).expect("runs");
    let files = bench.tree();
    assert!(files.contains_key(&key("vehicle_0")));
    assert!(!files.keys().any(|k| k.contains("vehicle_1")), "{:?}", files.keys());
}

fn broken_shards_are_named(bench: &Bench) {
    let store = &bench.store;
    let manifest = run(store, "c", false, &TWO).expect("runs");
    let (first, second) = (key("vehicle_0"), key("vehicle_1"));
    let whole = bench.bytes(&first);

    bench.put(&first, &whole[..whole.len() / 2]);
    let error = store.read_rows::<GnssRow>(&manifest, &first).expect_err("is truncated");
    let text = error.to_string();
    assert!(text.contains("vehicle_0/GNSS.parquet") && text.contains("truncated"), "{text}");
    assert!(!store.outputs_present(&manifest).expect("asks"));

    let mut changed = whole.clone();
    changed[whole.len() / 3] ^= 0x40;
    bench.put(&first, &changed);
    store.backend().remove(&second).expect("removes");
    let findings = verify(store, &[], |_| {}).expect("verifies").findings;
    let problems: Vec<_> = findings.iter().map(|f| (f.key.as_str(), f.problem.clone())).collect();
    assert_eq!(problems, [(first.as_str(), Problem::Changed), (second.as_str(), Problem::Missing)]);

    // The right size, but no table.
    bench.put(&first, &vec![7; whole.len()]);
    let error = store.read_rows::<GnssRow>(&manifest, &first).expect_err("is no table");
    assert!(matches!(&error, StoreError::Corrupt { path, .. } if path.contains("vehicle_0")), "{error}");
}

fn damaged_records_are_done_again(bench: &Bench) {
    let store = &bench.store;
    run(store, "c", false, &TWO).expect("runs");
    let whole = bench.tree();
    let manifest = SCOPE.manifest(STAGE);
    for kept in [0, 40] {
        let bytes = bench.bytes(&manifest);
        bench.put(&manifest, &bytes[..kept]);
        assert!(matches!(store.manifest(SCOPE, STAGE), Err(StoreError::Corrupt { .. })));
        run(store, "c", false, &TWO).expect("runs again");
        assert_eq!(whole, bench.tree());
    }
    // The same for the records of a try that was killed after its first unit.
    run_half(store, "d", true);
    for record in [SCOPE.part(STAGE, "vehicle_0"), SCOPE.redo(STAGE)] {
        assert!(store.read(&record).expect("asks").is_some(), "{record}");
        bench.put(&record, b"{");
    }
    let manifest = run(store, "d", false, &TWO).expect("runs");
    assert_eq!(manifest.outputs.len(), 2);
    assert!(verify(store, &[(SCOPE, STAGE)], |_| {}).expect("verifies").findings.is_empty());
}

fn two_outputs_of_one_name_are_refused(bench: &Bench) {
    let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is to do");
    unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
    unit.rows(&key("vehicle_0"), &gnss(20)).expect("writes");
    let error = unit.finish().expect_err("is refused");
    assert!(error.to_string().contains("vehicle_0/GNSS.parquet"), "{error}");
}

fn of_two_that_put_one_succeeds(bench: &Bench) {
    let backend = bench.store.backend();
    let won: usize = std::thread::scope(|scope| {
        let tries = (0..8_u8)
            .map(|i| scope.spawn(move || backend.put_if_absent("a/once", STAGE, &[i; 64]).expect("puts")));
        let tries: Vec<_> = tries.collect();
        tries.into_iter().map(|t| usize::from(t.join().expect("ends"))).sum()
    });
    assert_eq!(won, 1);
    let bytes = bench.tree().remove("a/once").expect("is there");
    assert!(bytes.len() == 64 && bytes.iter().all(|b| *b == bytes[0]), "one of them, whole: {bytes:?}");
}

fn two_processes_of_one_mind_agree(bench: &Bench) {
    let slow = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let fast = run(&bench.store, "c", false, &["vehicle_0"]).expect("runs");
    let tree = bench.tree();
    if let Some(mut unit) = slow.unit("vehicle_0").expect("asks") {
        unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
        unit.finish().expect("finishes");
    }
    assert_eq!(slow.commit().expect("agrees"), fast);
    assert_eq!(tree, bench.tree());
}

/// A build with a program of this digest.
fn built(commit: Option<&str>, program: &str) -> Identity {
    let commit = commit.map(str::to_owned);
    // Each by another device.
    let device = Some(format!("device {program}"));
    let made_by =
        MadeBy { release: "1".into(), commit, program: program.to_owned(), device, ..MadeBy::default() };
    Identity { made_by: Some(made_by), ..identity("c") }
}

fn run_unit(attempt: &Attempt) -> bool {
    let unit = attempt.unit("vehicle_0").expect("asks");
    let is_to_do = unit.is_some();
    if let Some(mut unit) = unit {
        unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
        unit.finish().expect("finishes");
    }
    is_to_do
}

fn two_builds_of_one_version_agree(bench: &Bench) {
    let start = |made: Identity| Attempt::start(&bench.store, made, false).expect("starts");
    let (slow, fast) = (start(built(Some("ab"), "p")), start(built(Some("cd"), "q")));
    assert!(run_unit(&fast));
    let first = fast.commit().expect("commits");
    let tree = bench.tree();
    run_unit(&slow);
    let second = slow.commit().expect("agrees");
    assert_eq!((first.digest(), tree), (second.digest(), bench.tree()), "the first one stays");
    assert_ne!(first, second);
}

fn an_edited_program_takes_up_no_unit_of_another(bench: &Bench) {
    for (then, now, is_made_again) in [
        (built(Some("ab"), "p"), built(Some("cd"), "q"), false),
        (built(None, "p"), built(None, "p"), false),
        (built(None, "p"), built(None, "q"), true),
        (built(Some("ab"), "p"), built(None, "q"), true),
        (built(None, "p"), built(Some("ab"), "q"), true),
    ] {
        let bench = bench.another();
        let start = |made: &Identity| Attempt::start(&bench.store, made.clone(), false).expect("starts");
        run_unit(&start(&then));
        assert_eq!(run_unit(&start(&now)), is_made_again, "{:?} after {:?}", now.made_by, then.made_by);
    }
}

fn two_processes_at_odds_leave_no_manifest(bench: &Bench) {
    let slow = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    run(&bench.store, "d", false, &["vehicle_0"]).expect("runs");
    let mut unit = slow.unit("vehicle_0").expect("asks").expect("is to do");
    unit.rows(&key("vehicle_0"), &gnss(20)).expect("writes");
    unit.finish().expect("finishes");
    let error = slow.commit().expect_err("the shards are mixed");
    assert!(matches!(error, StoreError::Contested { .. }) && error.is_transient(), "{error}");
    assert!(bench.store.manifest(SCOPE, STAGE).expect("asks").is_none());
    let manifest = run(&bench.store, "c", false, &["vehicle_0"]).expect("runs");
    assert!(bench.store.outputs_present(&manifest).expect("asks"));
}

fn an_object_is_replaced_whole(bench: &Bench) {
    bench.put("a", b"first");
    let mut sink = bench.store.backend().create("a", STAGE).expect("creates");
    sink.write_all(b"sec").expect("writes");
    sink.flush().expect("flushes");
    assert_eq!(bench.bytes("a"), b"first");
    drop(sink);
    assert_eq!(bench.tree()["a"], b"first", "what is dropped is discarded");
    bench.put("a", b"2");
    assert_eq!(bench.bytes("a"), b"2");
}

fn a_manifest_is_replaced_only_as_it_was_read(bench: &Bench) {
    let store = &bench.store;
    let read = run(store, "c", false, &TWO).expect("runs");
    let accepted = Manifest { accepted_by: vec!["newer".into()], ..read.clone() };
    store.replace_manifest(SCOPE, &read, &accepted).expect("nobody else writes");
    assert_eq!(store.manifest(SCOPE, STAGE).expect("reads").as_ref(), Some(&accepted));
    // Somebody has made the stage again since.
    let again = run(store, "c", true, &TWO).expect("runs");
    let error = store.replace_manifest(SCOPE, &accepted, &read).expect_err("another one stands");
    assert!(matches!(error, StoreError::Contested { .. }) && error.is_transient(), "{error}");
    assert_eq!(store.manifest(SCOPE, STAGE).expect("reads"), Some(again));
}
