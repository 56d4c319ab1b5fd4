//! Writing and reading back gives the same network, to the bit.

use std::collections::BTreeMap;

use crate::any::Any;
use opendrive::*;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_network_survives_writing(seed: u64) {
        let network = Any(seed).network();
        let text = write(&network);
        let again = Network::parse(&text).expect("our own file");
        let again = Network { warnings: Vec::new(), unknown_elements: BTreeMap::new(), ..again };
        if again != network || format!("{again:?}") != format!("{network:?}") {
            // Equality takes 0 and -0 for one, print does not. The whole of both would be too much to look
            // at.
            let (got, want) = (format!("{again:#?}"), format!("{network:#?}"));
            let differing: Vec<_> = got.lines().zip(want.lines()).filter(|(a, b)| a != b).take(5).collect();
            prop_assert!(false, "{differing:?}");
        }
        // Written once more, nothing changes.
        prop_assert_eq!(write(&again), text);
    }
}
