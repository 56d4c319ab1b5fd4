//! Reads any bytes as a file of infos: where its parts are, and what they say.

#![no_main]

use import_core::{Rigs, Scene, json, scan};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // A part alone, too: few inputs are whole files.
    if let Ok(value) = json::parse(bytes) {
        let _ = Rigs::of(&value);
        let _ = Scene::of(value, 0);
    }
    let Ok(index) = scan(bytes) else { return };
    let part = |range: &std::ops::Range<u64>| {
        let text = &bytes[range.start as usize..range.end as usize];
        assert!(text.starts_with(b"{") && text.ends_with(b"}"), "a part without its brackets");
        json::parse(text)
    };
    if let Ok(metadata) = part(&index.metadata) {
        let _ = Rigs::of(&metadata);
    }
    for (number, range) in &index.scenes {
        let Ok(value) = part(range) else { continue };
        if let Ok(scene) = Scene::of(value, *number) {
            assert!(scene.frames() > 0 && scene.agents.iter().all(|(_, records)| records.len() as u32 == scene.frames()));
        }
    }
});
