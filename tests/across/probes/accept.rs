//! `make accept-bytes`: numbers are raised and digests renewed, both in one go.

use std::collections::BTreeMap;

use super::digests::{Digests, IMPORT};
use super::stated::Stated;
use super::versions::Versions;
use super::{PROBES, made};

/// By stage, the number that it has to have at least: one more than that of the digests from which its shards
/// differ. Numbers that were raised since are not raised again, so that nothing happens twice when this is
/// stopped and started anew.
fn needed(stated: &Stated, made: &Digests) -> BTreeMap<String, u32> {
    let mut differences = stated.differences(made);
    // Where another dataset was imported, what is made of it differs with it.
    if differences.iter().any(|difference| difference.stage == IMPORT) {
        differences.retain(|difference| !difference.key.starts_with("imported/"));
    }
    // Imports have the version `import`, and are never stale.
    let stages = differences.into_iter().map(|difference| difference.stage).filter(|stage| stage != IMPORT);
    stages.map(|stage| (stage.clone(), stated.versions.get(&stage).map_or(1, |number| number + 1))).collect()
}

/// Not a test: it writes. All probes in one process, since they raise numbers of one file.
#[test]
#[ignore = "writes versions.toml and tests/probes: run by `make accept-bytes`"]
#[expect(clippy::print_stdout, reason = "what `make accept-bytes` has to say")]
fn accept_bytes() {
    let versions = Versions::read();
    let (mut least, mut all) = (BTreeMap::<String, u32>::new(), Vec::new());
    for probe in PROBES {
        let (input, made) = (made::input(probe), made::digests(probe));
        match Stated::read(probe.name) {
            Some(stated) if stated.input == input => {
                for (stage, number) in needed(&stated, &made) {
                    assert!(versions.place(&stage) < usize::MAX, "{stage} has no number in versions.toml");
                    println!("{}: {stage} differs", probe.name);
                    let least = least.entry(stage).or_default();
                    *least = number.max(*least);
                }
            }
            // Nothing to compare with: what differs may do so because the probe does.
            _ => println!("{}: is new, or another scene than before", probe.name),
        }
        all.push((probe.name, input, made));
    }
    let raised = versions.raised(&least);
    // The numbers first: with them written, a second try after this one was stopped raises none again.
    raised.write();
    let (old, numbers) = (versions.numbers(), raised.numbers());
    for (stage, number) in numbers.iter().filter(|(stage, number)| old.get(*stage) != Some(number)) {
        println!("versions.toml: {stage} = {number}");
    }
    for (name, input, digests) in all {
        if (Stated { input, versions: numbers.clone(), digests }).write(name) {
            println!("tests/probes/{name}.digests: written");
        }
    }
}

/// Digests of a few shards: stage, key, digest.
fn digests(shards: &[[&str; 3]]) -> Digests {
    shards
        .iter()
        .map(|[stage, key, digest]| ((stage.to_string(), key.to_string()), digest.to_string()))
        .collect()
}

#[test]
fn stages_that_differ_are_raised_once() {
    let text = "# Numbers.\n\nplan = 1\nbev-gt = 9 # masks: 9 of them\nstats = 3\n";
    let versions = Versions::of(text.to_owned());
    let before =
        digests(&[["plan", "a b", "1"], ["bev-gt", "b", "1"], ["stats", "c", "1"], ["import", "d", "1"]]);
    let stated = Stated { input: "x".into(), versions: versions.numbers(), digests: before };
    assert!(needed(&stated, &stated.digests).is_empty());
    let written = stated.text("x");
    let again = Stated::parse(&written).expect("reads back");
    assert_eq!((again.text("x"), again.differences(&stated.digests)), (written.clone(), vec![]));

    // One differs, one is gone, one is new; imports have no number.
    let made = digests(&[
        ["plan", "a b", "1"],
        ["bev-gt", "b", "2"],
        ["stats", "e", "1"],
        ["import", "d", "2"],
        // Made of what was imported.
        ["plan", "imported/x", "1"],
    ]);
    let raised = versions.raised(&needed(&stated, &made));
    let expected =
        BTreeMap::from([("plan", 1), ("bev-gt", 10), ("stats", 4)].map(|(s, n)| (s.to_owned(), n)));
    assert_eq!(raised.numbers(), expected);
    assert_eq!(raised.raised(&needed(&stated, &made)).numbers(), expected, "once only");
    // Everything but the numbers is as it was.
    let line = raised.raised(&BTreeMap::new());
    let kept = "# Numbers.\n\nplan = 1\nbev-gt = 10 # masks: 9 of them\nstats = 4\n";
    assert_eq!(line.text(), kept);
    let report = super::stated::report("x", &stated.differences(&made), &versions);
    let order =
        ["bev-gt: 1", "b differs", "stats: 2", "e is new", "c is gone", "import: 1"].map(|s| report.find(s));
    assert!(order.is_sorted() && order[0].is_some(), "{report}");
}
