//! A store that is checked: what is faulty, what does not belong, what is missing, what is only in the
//! making.

use std::io::Write;
use std::time::Duration;

use store::{
    Attempt, Failure, Finding, Manifest, Output, Problem, Redo, Scope, Strays, Verification, remove_strays,
    verify,
};

use crate::common::{Bench, SCOPE, STAGE, gnss, identity, key, on_every_backend, run, run_half};

on_every_backend!(
    strays_are_named,
    old_strays_are_removed_where_all_is_done,
    a_deleted_manifest_is_missed,
    stages_that_failed_say_why,
    what_is_in_the_making_is_no_stray,
    records_that_cannot_be_read_are_named,
    each_flipped_bit_of_a_manifest_is_found,
    what_lies_elsewhere_is_neither_followed_nor_removed,
);

fn checked(bench: &Bench) -> Verification {
    verify(&bench.store, &[(SCOPE, STAGE)], |_| {}).expect("verifies")
}

fn finding(key: impl Into<String>, problem: Problem) -> Finding {
    Finding { key: key.into(), manifest: None, problem }
}

fn strays_are_named(bench: &Bench) {
    run(&bench.store, "c", false, &["vehicle_0"]).expect("runs");
    assert_eq!(checked(bench).findings, []);
    let strays = [
        "notes.txt",
        "scenes/0007/sensors/vehicle_0/old.parquet",
        "scenes/0007/_manifests/notes.txt",
        "scenes/0007/_manifests/x.parts.json.bak",
        "scenes/0007/table.tmp",
    ];
    for stray in strays {
        bench.put(stray, b"{}");
    }
    let mut named = strays.map(|stray| finding(stray, Problem::Stray));
    named.sort_by(|a, b| a.key.cmp(&b.key));
    assert_eq!(checked(bench).findings, named);
    assert_eq!(named[0].to_string(), "notes.txt: no manifest names this file");
}

fn old_strays_are_removed_where_all_is_done(bench: &Bench) {
    let store = &bench.store;
    run(store, "c", false, &["vehicle_0"]).expect("runs");
    let of_done = "scenes/0007/sensors/vehicle_0/old.parquet";
    let kept = ["notes.txt", "plan/old.parquet", "scenes/0008/table.parquet", "scenes/notes.txt"];
    for stray in kept.iter().chain([&of_done]) {
        bench.put(stray, b"{}");
    }
    let before = store.backend().keys("").expect("lists");
    let ages = Duration::from_secs(10_000 * 24 * 3600);
    assert_eq!(remove_strays(store, ages).expect("looks"), Strays { removed: 0, bytes: 0, left: 5 });
    assert_eq!(store.backend().keys("").expect("lists"), before);
    // Who cannot read a manifest does not know what belongs to it.
    let manifest = SCOPE.manifest(STAGE);
    let sound = store.read(&manifest).expect("reads").expect("is there");
    bench.put(&manifest, b"{}");
    assert!(remove_strays(store, Duration::ZERO).is_err());
    bench.put(&manifest, &sound);
    assert_eq!(store.backend().keys("").expect("lists"), before);
    // A stage that another scene has: this one is not done.
    let other = store.manifest(SCOPE, STAGE).expect("reads").expect("is there");
    let other = Manifest { stage: "other".into(), outputs: Vec::new(), ..other };
    store.write_json("scenes/0008/_manifests/other.json", "other", &other).expect("writes");
    assert_eq!(remove_strays(store, Duration::ZERO).expect("looks").removed, 0);
    store.backend().remove("scenes/0008/_manifests/other.json").expect("removes");
    let strays = remove_strays(store, Duration::ZERO).expect("removes");
    assert_eq!(strays, Strays { removed: 1, bytes: 2, left: 4 });
    let left: Vec<String> = before.into_iter().filter(|key| key != of_done).collect();
    assert_eq!(store.backend().keys("").expect("lists"), left);
}

fn a_deleted_manifest_is_missed(bench: &Bench) {
    run(&bench.store, "c", false, &["vehicle_0"]).expect("runs");
    let manifest = SCOPE.manifest(STAGE);
    bench.store.backend().remove(&manifest).expect("removes");
    let result = checked(bench);
    let expected = [finding(key("vehicle_0"), Problem::Stray), finding(&manifest, Problem::NotDone)];
    assert_eq!(result.findings, expected);
    // A scene that was never begun lacks it as well.
    let all = verify(&bench.store, &[(SCOPE, STAGE), (Scope::Scene(8), STAGE)], |_| {}).expect("verifies");
    assert_eq!(all.findings[2], finding(Scope::Scene(8).manifest(STAGE), Problem::NotDone));
}

fn stages_that_failed_say_why(bench: &Bench) {
    let failure = Failure { code_version: "test".into(), reason: "frame 3: no light".into() };
    bench.store.write_json(&SCOPE.failure(STAGE), STAGE, &failure).expect("writes");
    let result = checked(bench);
    assert_eq!(result.findings, [finding(SCOPE.manifest(STAGE), Problem::Failed(failure.reason))]);
    assert!(result.findings[0].to_string().contains("failed: frame 3: no light"));
}

fn what_is_in_the_making_is_no_stray(bench: &Bench) {
    run(&bench.store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    // A forced try that ends after its first unit: a record of it, one that the manifest is set aside, a file
    // begun.
    run_half(&bench.store, "c", true);
    let mut hand = bench.store.backend().create("scenes/0007/x.parquet", STAGE).expect("creates");
    hand.write_all(b"half").expect("writes");
    std::mem::forget(hand);
    let result = checked(bench);
    assert_eq!(result.findings, [finding(SCOPE.manifest(STAGE), Problem::NotDone)]);
    let mut in_hand =
        vec![SCOPE.part(STAGE, "vehicle_0"), SCOPE.redo(STAGE), key("vehicle_0"), key("vehicle_1")];
    in_hand.sort_unstable();
    assert_eq!(result.in_hand, in_hand);
    if bench.store.backend().lists_unfinished() {
        assert!(result.unfinished.len() == 1 && result.unfinished[0].owner == STAGE, "{result:?}");
    }
    // Once it is done, nothing is left of it.
    run(&bench.store, "c", false, &["vehicle_0", "vehicle_1"]).expect("runs");
    let result = checked(bench);
    assert!(
        result.findings.is_empty() && result.in_hand.is_empty() && result.unfinished.is_empty(),
        "{result:?}"
    );
}

fn records_that_cannot_be_read_are_named(bench: &Bench) {
    let mut manifest = run(&bench.store, "c", false, &["vehicle_0"]).expect("runs");
    let place = SCOPE.manifest(STAGE);
    manifest.format_version = 99;
    bench.store.write_json(&place, STAGE, &manifest).expect("writes");
    let problems = checked(bench).findings;
    assert!(
        matches!(&problems[0], Finding { key, problem: Problem::Manifest(text), .. }
        if *key == place && text.contains("store format 99")),
        "{problems:?}"
    );

    bench.put(&place, b"{");
    let attempt = Attempt::start(&bench.store, identity("c"), false).expect("starts");
    let mut unit = attempt.unit("vehicle_0").expect("asks").expect("is to do");
    unit.rows(&key("vehicle_0"), &gnss(40)).expect("writes");
    unit.finish().expect("finishes");
    drop(attempt);
    let part = SCOPE.part(STAGE, "vehicle_0");
    bench.put(&part, b"[");
    let findings = checked(bench).findings;
    let damaged = |f: &&Finding| matches!(f.problem, Problem::Manifest(_));
    assert_eq!(findings.iter().filter(damaged).map(|f| f.key.as_str()).collect::<Vec<_>>(), [part.as_str()]);
}

fn each_flipped_bit_of_a_manifest_is_found(bench: &Bench) {
    let made_by = store::MadeBy {
        release: "0.1.0".into(),
        commit: None,
        program: "ab".into(),
        ..store::MadeBy::default()
    };
    let identity = store::Identity { made_by: Some(made_by), ..identity("c") };
    let attempt = Attempt::start(&bench.store, identity, false).expect("starts");
    let manifest = attempt.commit().expect("commits");
    let place = SCOPE.manifest(STAGE);
    let sealed = bench.bytes(&place);
    for bit in 0..sealed.len() * 8 {
        let mut flipped = sealed.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        bench.put(&place, &flipped);
        let findings = checked(bench).findings;
        assert!(
            findings.iter().any(|f| f.key == place && matches!(f.problem, Problem::Manifest(_))),
            "bit {bit} of {}: {findings:?}",
            String::from_utf8_lossy(&flipped)
        );
    }
    // Older releases wrote no checksum.
    bench.store.write_json(&place, STAGE, &manifest).expect("writes");
    assert!(bench.bytes(&place).len() < sealed.len());
    assert_eq!(checked(bench).findings, []);
}

/// Records may be written by others: one that names objects of other scopes, or what lies outside of the
/// store, is damaged, and the stage that is done again leaves all that alone.
fn what_lies_elsewhere_is_neither_followed_nor_removed(bench: &Bench) {
    let store = &bench.store;
    let elsewhere = ["scenes/0008/table.parquet", "plan/scenes.parquet", "notes.txt"];
    for key in elsewhere {
        bench.put(key, b"of somebody else");
    }
    for named in
        elsewhere.into_iter().chain(["../beside.txt", "/etc/hostname", "scenes/0007/../0008/table.parquet"])
    {
        run(store, "c", false, &["vehicle_0"]).expect("runs");
        let manifest = store.manifest(SCOPE, STAGE).expect("reads").expect("is there");
        let foreign = Output { key: named.to_owned(), ..manifest.outputs[0].clone() };
        let manifest = Manifest { outputs: vec![manifest.outputs[0].clone(), foreign], ..manifest };
        store.backend().remove(&SCOPE.manifest(STAGE)).expect("removes");
        store.write_json(&SCOPE.manifest(STAGE), STAGE, &manifest).expect("writes");
        let problem = Problem::Manifest(format!("names `{named}`, which is not in its folder"));
        let found = checked(bench).findings;
        assert!(found.contains(&finding(SCOPE.manifest(STAGE), problem.clone())), "{found:?}");
        // The record of a stage that is being done again says the same, and the old manifest with it.
        let redo = Redo { generation: 1, replaces: vec![named.to_owned()], old: Some(manifest.clone()) };
        store.write_json(&SCOPE.redo(STAGE), STAGE, &redo).expect("writes");
        let found = checked(bench).findings;
        assert!(found.contains(&finding(SCOPE.redo(STAGE), problem.clone())), "{found:?}");
        // And one of a finished unit.
        store.backend().remove(&SCOPE.manifest(STAGE)).expect("removes");
        store.write_json(&SCOPE.part(STAGE, "vehicle_1"), STAGE, &manifest).expect("writes");
        let found = checked(bench).findings;
        assert!(found.contains(&finding(SCOPE.part(STAGE, "vehicle_1"), problem)), "{found:?}");
        run(store, "other", false, &["vehicle_0"]).expect("runs");
        for key in elsewhere {
            assert_eq!(
                &store.read(key).expect("reads").expect("is there")[..],
                b"of somebody else",
                "{named}"
            );
        }
    }
    let found = checked(bench).findings;
    assert!(found.iter().all(|finding| finding.problem == Problem::Stray), "{found:?}");
}
