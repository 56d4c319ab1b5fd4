//! Files with faults: the reader says where, and neither panics nor hangs.

mod common;

use opendrive::*;
use proptest::prelude::*;

const ROAD: &str = r#"<OpenDRIVE><header revMajor="1" revMinor="4"/>
<road id="7" length="10" junction="-1">
<planView><geometry s="0" x="0" y="0" hdg="0" length="10"><line/></geometry></planView>
<lanes><laneSection s="0"><center><lane id="0" type="none"/></center>
<right><lane id="-1" type="driving"><width sOffset="0" a="3"/></lane></right></laneSection></lanes>
</road></OpenDRIVE>"#;

/// What is read after a replacement in the good file.
fn changed(from: &str, to: &str) -> Result<Network, ReadError> {
    assert!(ROAD.contains(from));
    Network::parse(&ROAD.replacen(from, to, 1))
}

#[test]
fn the_good_file_is_good() {
    let network = Network::parse(ROAD).expect("good");
    assert_eq!((network.roads.len(), network.warnings.len()), (1, 0));
}

#[test]
fn errors_name_line_and_road() {
    let cases = [
        ("hdg=\"0\"", "hdg=\"nan\"", "line 3, road 7: <geometry> hdg=\"nan\" is not a finite number"),
        ("hdg=\"0\"", "", "line 3, road 7: <geometry> has no hdg"),
        ("id=\"-1\" type", "id=\"x\" type", "line 5, road 7: <lane> id=\"x\" is not a lane id"),
        ("a=\"3\"", "a=\"inf\"", "line 5, road 7: <width> a=\"inf\" is not a finite number"),
        ("length=\"10\" junction", "junction", "line 2, road 7: <road> has no length"),
    ];
    for (from, to, message) in cases {
        assert_eq!(changed(from, to).expect_err(to).to_string(), message);
    }
    let error = changed("</planView>", "</plan>").expect_err("not XML");
    assert!(matches!(error, ReadError::Xml { line: 3, .. }), "{error}");
    assert!(Network::parse("").is_err());
    assert!(Network::parse("<html/>").is_err());
    assert!(read_bytes(&[0xff, 0xfe, 0x00]).is_err());
    assert!(read_bytes(&[0x1f, 0x8b, 0x08, 0x00]).is_err());
}

#[test]
fn lesser_faults_become_warnings() {
    let cases = [
        ("type=\"driving\"", "type=\"flying\"", "line 5, road 7: <lane> type=\"flying\" is unknown"),
        ("<line/>", "", "line 3, road 7, s 0.000: geometry of unknown kind"),
        ("length=\"10\"><line/>", "length=\"9\"><line/>", "geometry adds up to 9.000 m"),
        ("<lanes>", "<helix/><lanes>", "1 <road/helix> elements are not understood"),
        (
            "<planView>",
            "<link><successor elementType=\"road\" elementId=\"8\" contactPoint=\"end\"/></link><planView>",
            "its successor is road 8",
        ),
    ];
    for (from, to, message) in cases {
        let warnings = changed(from, to).expect(to).warnings;
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(warnings[0].to_string().contains(message), "{}", warnings[0]);
    }
}

#[test]
fn a_namespace_and_gzip_change_nothing() {
    let plain = Network::parse(ROAD).expect("good");
    assert_eq!(
        changed(
            "<OpenDRIVE>",
            "<OpenDRIVE xmlns=\"http://code.asam.net/simulation/standard/opendrive_schema\">"
        ),
        Ok(plain)
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any number anywhere, and any piece of text cut out: an answer comes, and a map can be made of it.
    #[test]
    fn damaged_files_never_panic(at in 0.0..1.0f64, cut in 0..60usize,
                                 number in prop::sample::select(vec!["-1", "1e300", "-1e300", "1e-300", "0", "65536", "x", ""])) {
        let text = write(&common::network());
        let digits: Vec<usize> = text.match_indices('"').map(|(i, _)| i).collect();
        let pick = (at * (digits.len() / 2 - 1) as f64) as usize * 2;
        let mut damaged = text.clone();
        damaged.replace_range(digits[pick] + 1..digits[pick + 1], number);
        let from = (at * text.len() as f64) as usize;
        let shorter: String = text.char_indices().filter(|(i, _)| *i < from || *i >= from + cut).map(|(_, c)| c).collect();
        for file in [damaged, shorter] {
            if let Ok(network) = Network::parse(&file) {
                let map = Map::new(network);
                for lane in map.lanes() {
                    let _ = map.ahead(LanePos { lane: lane.id, along_m: 0.0 }, 100.0);
                    let _ = map.lane_change(lane.id, lane.s_start);
                }
                for stripe in map.stripes().iter().take(20) {
                    let _ = map.stripe_centre(stripe, 0.1);
                }
                let _ = map.nearest_driving_lane(nalgebra::Point3::origin());
            }
        }
    }
}
