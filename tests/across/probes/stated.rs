//! Files of digests: what a probe's shards were when they were last accepted, and of which versions.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use super::digests::Digests;
use super::folder;
use super::versions::Versions;

/// What `tests/probes/NAME.digests` says.
pub(super) struct Stated {
    /// Digest of the probe itself.
    pub(super) input: String,
    /// Numbers of the stages that made the shards.
    pub(super) versions: BTreeMap<String, u32>,
    pub(super) digests: Digests,
}

/// A shard that is not as stated.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Difference {
    pub(super) stage: String,
    pub(super) key: String,
    pub(super) what: &'static str,
}

impl Stated {
    fn path(name: &str) -> PathBuf {
        folder().join(format!("{name}.digests"))
    }

    /// What is stated of a probe, or `None` if nothing is.
    pub(super) fn read(name: &str) -> Option<Self> {
        let text = fs::read_to_string(Self::path(name)).ok()?;
        Some(Self::parse(&text).unwrap_or_else(|line| {
            panic!("tests/probes/{name}.digests: `{line}` is no line of digests: remove the file and run `make accept-bytes`")
        }))
    }

    /// The reverse of [`Self::text`]; else the line that is wrong.
    pub(super) fn parse(text: &str) -> Result<Self, &str> {
        let mut stated = Self { input: String::new(), versions: BTreeMap::new(), digests: Digests::new() };
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            match line.split(' ').collect::<Vec<_>>()[..] {
                ["probe", digest] => digest.clone_into(&mut stated.input),
                ["version", stage, number] => {
                    stated.versions.insert(stage.into(), number.parse().map_err(|_| line)?);
                }
                // Keys may hold spaces: the digest is what comes last.
                ["shard", stage, ref key @ .., digest] => {
                    stated.digests.insert((stage.into(), key.join(" ")), digest.into());
                }
                _ => return Err(line),
            }
        }
        Ok(stated)
    }

    pub(super) fn text(&self, name: &str) -> String {
        let mut text = format!(
            "# What the stages of these versions make of {name}.toml: stage, shard, BLAKE3. Written by `make accept-bytes`.\n"
        );
        writeln!(text, "probe {}", self.input).expect("writes");
        for (stage, number) in &self.versions {
            writeln!(text, "version {stage} {number}").expect("writes");
        }
        for ((stage, key), digest) in &self.digests {
            writeln!(text, "shard {stage} {key} {digest}").expect("writes");
        }
        text
    }

    /// Writes the file where it would be another one; whether it did.
    pub(super) fn write(&self, name: &str) -> bool {
        let (path, text) = (Self::path(name), self.text(name));
        let differs = fs::read_to_string(&path).ok().as_ref() != Some(&text);
        if differs {
            fs::write(&path, text).expect("the digests are written");
        }
        differs
    }

    /// Shards that were made otherwise than stated, are new or are gone.
    pub(super) fn differences(&self, made: &Digests) -> Vec<Difference> {
        let of = |(stage, key): &(String, String), what| Difference {
            stage: stage.clone(),
            key: key.clone(),
            what,
        };
        let new = made.iter().filter_map(|(key, digest)| match self.digests.get(key) {
            None => Some(of(key, "is new")),
            Some(other) if other != digest => Some(of(key, "differs")),
            Some(_) => None,
        });
        let gone = self.digests.keys().filter(|key| !made.contains_key(*key)).map(|key| of(key, "is gone"));
        new.chain(gone).collect()
    }
}

/// What to say of differences: stage by stage in their order, since what comes later may differ for what came
/// before.
pub(super) fn report(name: &str, differences: &[Difference], versions: &Versions) -> String {
    const SHOWN: usize = 6;
    let mut stages: Vec<&str> = differences.iter().map(|d| d.stage.as_str()).collect();
    stages.sort_by_key(|stage| (versions.place(stage), *stage));
    stages.dedup();
    let mut text = format!("probe {name} is not as tests/probes/{name}.digests states:\n");
    for stage in &stages {
        let of_stage: Vec<&Difference> = differences.iter().filter(|d| d.stage == *stage).collect();
        writeln!(text, "  {stage}: {} shards", of_stage.len()).expect("writes");
        for difference in of_stage.iter().take(SHOWN) {
            writeln!(text, "    {} {}", difference.key, difference.what).expect("writes");
        }
        if of_stage.len() > SHOWN {
            writeln!(text, "    ...").expect("writes");
        }
    }
    let first = stages.first().copied().unwrap_or_default();
    text + &format!(
        "Bytes have changed, of {first} first. If they should, run `make accept-bytes`: it raises the numbers of these stages in \
         versions.toml and renews the digests; commit both with the change. If they should not, the change is wrong.\n"
    )
}
