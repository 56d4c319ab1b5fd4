//! The files of a crate, and which needs which.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::paths::{Named, Source, read};

/// Imports that are followed from one file to the next, at most.
const HOPS: usize = 8;

/// A module's path from the root of its crate.
type Module = Vec<String>;

/// The files of a crate as a graph.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    /// Relative to the crate's `src`.
    pub(crate) files: Vec<PathBuf>,
    /// For each file the files that it needs, with the line that says so.
    pub(crate) edges: Vec<BTreeMap<usize, usize>>,
}

/// A crate that has been read.
struct Crate {
    sources: Vec<Source>,
    /// The module that each file is.
    of_file: Vec<Module>,
    /// The file that holds each module.
    modules: BTreeMap<Module, usize>,
}

impl Graph {
    /// Reads a crate from its root file on, which `load` gives as well as all others by their paths in `src`;
    /// none where there is no such file.
    pub(crate) fn read(root: &str, load: &dyn Fn(&Path) -> Option<String>) -> Option<Self> {
        let mut found = Crate { sources: Vec::new(), of_file: vec![Vec::new()], modules: BTreeMap::new() };
        let mut files = vec![PathBuf::from(root)];
        while let Some(file) = files.get(found.sources.len()).cloned() {
            let k = found.sources.len();
            let source = read(&load(&file)?);
            let module = found.of_file[k].clone();
            found.modules.insert(module.clone(), k);
            found.modules.extend(source.inline.iter().map(|m| ([&module[..], m].concat(), k)));
            // Submodules lie beside `lib.rs`, `main.rs` and `mod.rs`, else in a folder named like the file.
            let is_folder = k == 0 || file.ends_with("mod.rs");
            let folder = if is_folder { file.with_file_name("") } else { file.with_extension("") };
            for m in &source.modules {
                let path: PathBuf = m.iter().fold(folder.clone(), |path, name| path.join(name));
                let places = [path.with_extension("rs"), path.join("mod.rs")];
                if let Some(place) = places.into_iter().find(|place| load(place).is_some()) {
                    files.push(place);
                    found.of_file.push([&module[..], m].concat());
                }
            }
            found.sources.push(source);
        }
        let edges = (0..files.len()).map(|k| found.edges(k)).collect();
        Some(Self { files, edges })
    }
}

impl Crate {
    fn edges(&self, file: usize) -> BTreeMap<usize, usize> {
        let source = &self.sources[file];
        let mut edges = BTreeMap::new();
        for named in &source.named {
            // A module that re-exports an item need not use it.
            let only_passes =
                named.is_reexport && !named.binds.as_ref().is_some_and(|b| source.words.contains(b));
            if !only_passes && let Some(to) = self.find(file, named, HOPS).filter(|&to| to != file) {
                edges.entry(to).or_insert(named.line);
            }
        }
        edges
    }

    /// The file that a path leads to; none outside the crate.
    fn find(&self, file: usize, named: &Named, hops: usize) -> Option<usize> {
        let here = [&self.of_file[file][..], &named.within].concat();
        let mut segments = named.segments.iter().map(String::as_str).peekable();
        // Words that begin no module from here are names of other crates, or of this file.
        let mut at: Module = if segments.peek()? == &"crate" { Vec::new() } else { here };
        let mut is_module = false;
        while let Some(&segment) = segments.peek() {
            let next = match segment {
                "crate" | "self" => at.clone(),
                "super" => at.split_last()?.1.to_vec(),
                name => [&at[..], &[name.to_owned()]].concat(),
            };
            if !self.modules.contains_key(&next) {
                break;
            }
            (at, is_module) = (next, true);
            segments.next();
        }
        if !is_module {
            return None;
        }
        let target = *self.modules.get(&at)?;
        match segments.next() {
            Some(item) if item != "*" => Some(self.origin(target, item, hops).unwrap_or(target)),
            _ => Some(target),
        }
    }

    /// The file from which a file has a name that it imports.
    fn origin(&self, file: usize, item: &str, hops: usize) -> Option<usize> {
        let hops = hops.checked_sub(1)?;
        let imports = || self.sources[file].named.iter().filter(|n| n.binds.is_some());
        if let Some(import) = imports().find(|n| n.binds.as_deref() == Some(item)) {
            return self.find(file, import, hops);
        }
        let globs = imports().filter(|n| n.is_reexport && n.binds.as_deref() == Some("*"));
        globs.filter_map(|n| self.find(file, n, hops)).find_map(|from| {
            let is_there = self.sources[from].words.contains(item);
            is_there.then_some(from).or_else(|| self.origin(from, item, hops))
        })
    }
}

/// The circles: files that all need one another, in order.
pub(crate) fn circles(graph: &Graph) -> Vec<Vec<usize>> {
    let reach: Vec<BTreeSet<usize>> = (0..graph.files.len()).map(|k| reached(graph, k)).collect();
    let mut circles: Vec<Vec<usize>> = Vec::new();
    for k in 0..graph.files.len() {
        let is_known = circles.iter().any(|c| c.contains(&k));
        if reach[k].contains(&k) && !is_known {
            circles.push(reach[k].iter().copied().filter(|&to| reach[to].contains(&k)).collect());
        }
    }
    circles
}

/// The files that a file needs, and that those need.
fn reached(graph: &Graph, from: usize) -> BTreeSet<usize> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(at) = open.pop() {
        open.extend(graph.edges[at].keys().filter(|&&to| found.insert(to)));
    }
    found
}

/// The shortest way round a circle, as files with the lines that name the next one.
pub(crate) fn shortest(graph: &Graph, circle: &[usize]) -> Vec<(usize, usize)> {
    let rounds = circle.iter().filter_map(|&from| round(graph, from));
    rounds.min_by_key(Vec::len).unwrap_or_default()
}

/// The shortest way from a file back to it.
fn round(graph: &Graph, from: usize) -> Option<Vec<(usize, usize)>> {
    let mut ways = vec![Vec::new()];
    let mut seen = BTreeSet::new();
    while !ways.is_empty() {
        let mut next = Vec::new();
        for way in ways {
            let at = way.last().map_or(from, |&(_, _, to)| to);
            for (&to, &line) in &graph.edges[at] {
                let way: Vec<(usize, usize, usize)> = [&way[..], &[(at, line, to)]].concat();
                if to == from {
                    return Some(way.into_iter().map(|(file, line, _)| (file, line)).collect());
                }
                if seen.insert(to) {
                    next.push(way);
                }
            }
        }
        ways = next;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A crate of files given by their paths and texts.
    fn graph(files: &[(&str, &str)]) -> Graph {
        let load = |path: &Path| {
            let found = files.iter().find(|(name, _)| Path::new(name) == path);
            found.map(|(_, text)| (*text).to_owned())
        };
        Graph::read("lib.rs", &load).expect("a root")
    }

    /// The shortest circle of each group, as `file:line`.
    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let graph = graph(files);
        let shown = |circle: &Vec<usize>| {
            let steps = shortest(&graph, circle);
            let steps = steps.iter().map(|(file, line)| format!("{}:{line}", graph.files[*file].display()));
            steps.collect::<Vec<_>>().join(" ")
        };
        circles(&graph).iter().map(shown).collect()
    }

    #[test]
    fn a_line_of_files_is_no_circle() {
        let files = [
            ("lib.rs", "mod a; mod b; pub use a::A; pub use b::B;"),
            ("a.rs", "use crate::b::B; pub struct A(B);"),
            ("b.rs", "pub struct B;"),
        ];
        assert_eq!(found(&files), [""; 0]);
        assert_eq!(graph(&files).files.len(), 3);
    }

    #[test]
    fn a_planted_circle_is_named_with_its_lines() {
        let files = [
            ("lib.rs", "mod a; mod b; mod c;"),
            ("a.rs", "\nuse crate::b::{self, B};"),
            ("b.rs", "fn f() {\n\n    crate::c::g();\n}"),
            ("c.rs", "use super::a::A;"),
        ];
        assert_eq!(found(&files), ["a.rs:2 b.rs:3 c.rs:1"]);
    }

    #[test]
    fn tests_make_no_circle() {
        let files = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "use crate::b::B;"),
            ("b.rs", "#[cfg(test)]\nmod tests { use crate::a::A; use super::*; }"),
        ];
        assert_eq!(found(&files), [""; 0]);
    }

    #[test]
    fn a_parent_may_hand_on_what_its_children_have_and_not_use_it() {
        let child = ("p/child.rs", "use super::other::O; use crate::p::C; pub struct Child(O);");
        let rest = [("lib.rs", "mod p;"), ("p/other.rs", "pub struct O;"), child];
        let handed = (
            "p/mod.rs",
            "mod child; mod other; pub use child::Child; pub(crate) use self::other::O; pub const C: u8 = 0;",
        );
        assert_eq!(found(&[rest[0], rest[1], rest[2], handed]), [""; 0]);
        for used in
            ["pub use child::Child;\nfn f(_: Child) {}", "use child::Child;", "fn f() { child::g(); }"]
        {
            let text = format!("mod child; mod other; pub const C: u8 = 0;\n{used}");
            let circles = found(&[rest[0], rest[1], rest[2], ("p/mod.rs", &text)]);
            assert_eq!(circles, ["p/mod.rs:2 p/child.rs:1"], "{used}");
        }
    }

    #[test]
    fn names_are_followed_to_where_they_come_from() {
        // a has B from the root, which has it from b by way of p.
        let files = [
            ("lib.rs", "mod a; mod b; mod p; pub use p::*;"),
            ("p.rs", "pub use crate::b::B;"),
            ("a.rs", "use crate::B;"),
            ("b.rs", "use crate::a::A;"),
        ];
        let graph = graph(&files);
        let file = |name: &str| graph.files.iter().position(|f| f == Path::new(name)).expect("a file");
        assert_eq!(circles(&graph), [vec![file("a.rs"), file("b.rs")]]);
    }
}
