//! Files with faults: the reader says where, and neither panics nor hangs.

use crate::common;

use std::fmt::Write;

use opendrive::*;
use proptest::prelude::*;

const ROAD: &str = r#"<OpenDRIVE><header revMajor="1" revMinor="4"/>
<road id="7" length="10" junction="-1">
<planView><geometry s="0" x="0" y="0" hdg="0" length="10"><line/></geometry></planView>
<lanes><laneSection s="0"><center><lane id="0" type="none"/></center>
<right><lane id="-1" type="driving"><width sOffset="0" a="3"/></lane></right></laneSection></lanes>
</road></OpenDRIVE>"#;

/// Two streets and a junction between them, with a light and its controller; each element that a test spoils
/// on a line of its own.
const STREETS: &str = r#"<OpenDRIVE><header revMajor="1" revMinor="7"/>
<road id="a" length="20" junction="-1">
<link><successor elementType="junction" elementId="j"/></link>
<planView>
<geometry s="0" x="0" y="0" hdg="0" length="8"><line/></geometry>
<geometry s="8" x="8" y="0" hdg="0" length="12"><line/></geometry>
</planView>
<elevationProfile><elevation s="0" a="1"/><elevation s="5" a="1"/></elevationProfile>
<lanes>
<laneSection s="0"><center><lane id="0"/></center><right>
<lane id="-1" type="driving"><link><successor id="-1"/></link><width sOffset="0" a="3"/><width sOffset="4" a="3" b="0"/></lane>
</right></laneSection>
<laneSection s="12"><center><lane id="0"/></center><right>
<lane id="-1" type="driving"><link><predecessor id="-1"/></link><width sOffset="0" a="3"/></lane>
</right></laneSection>
</lanes>
<objects>
<object id="o" s="5" t="4"><repeat s="5" length="10" distance="2"/></object>
<tunnel id="t" s="2" length="6" type="standard"/>
</objects>
<signals>
<signal id="s" s="18" t="-4" dynamic="yes"/>
</signals>
</road>
<road id="b" length="10" junction="j">
<link><predecessor elementType="road" elementId="a" contactPoint="end"/><successor elementType="road" elementId="c" contactPoint="start"/></link>
<planView><geometry s="0" x="20" y="0" hdg="0" length="10"><line/></geometry></planView>
<lanes><laneSection s="0"><center><lane id="0"/></center><right>
<lane id="-1" type="driving"><link><predecessor id="-1"/><successor id="-1"/></link><width sOffset="0" a="3"/></lane>
</right></laneSection></lanes>
<signals><signalReference id="s" s="0" t="0"/></signals>
</road>
<road id="c" length="20" junction="-1">
<link><predecessor elementType="junction" elementId="j"/><successor elementType="road" elementId="d" contactPoint="start"/></link>
<planView><geometry s="0" x="30" y="0" hdg="0" length="20"><line/></geometry></planView>
<lanes><laneSection s="0"><center><lane id="0"/></center><right>
<lane id="-1" type="driving"><link><successor id="-1"/></link><width sOffset="0" a="3"/></lane>
</right></laneSection></lanes>
</road>
<road id="d" length="20" junction="-1">
<link><predecessor elementType="road" elementId="c" contactPoint="end"/></link>
<planView><geometry s="0" x="50" y="0" hdg="0" length="20"><line/></geometry></planView>
<lanes><laneSection s="0"><center><lane id="0"/></center><right>
<lane id="-1" type="driving"><link><predecessor id="-1"/></link><width sOffset="0" a="3"/></lane>
</right></laneSection></lanes>
</road>
<controller id="k"><control signalId="s"/></controller>
<junction id="j">
<connection id="0" incomingRoad="a" connectingRoad="b" contactPoint="start"><laneLink from="-1" to="-1"/></connection>
<controller id="k"/>
</junction>
</OpenDRIVE>"#;

/// What is read after a replacement in a good file.
#[track_caller]
fn changed(file: &str, from: &str, to: &str) -> Result<Network, ReadError> {
    assert!(file.contains(from), "{from}");
    Network::parse(&file.replacen(from, to, 1))
}

fn texts(network: &Network) -> Vec<String> {
    network.warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn the_good_files_are_good() {
    for file in [ROAD, STREETS] {
        assert_eq!(texts(&Network::parse(file).expect("good")), [""; 0]);
    }
}

#[test]
fn errors_name_line_and_road() {
    let cases = [
        ("hdg=\"0\"", "hdg=\"nan\"", "line 3, road 7: <geometry> hdg=\"nan\" is not a finite number"),
        ("hdg=\"0\"", "", "line 3, road 7: <geometry> has no hdg"),
        ("id=\"-1\" type", "id=\"x\" type", "line 5, road 7: <lane> id=\"x\" is not a lane id"),
        ("id=\"-1\" type", "id=\"-40000\" type", "line 5, road 7: <lane> id=\"-40000\" is not a lane id"),
        ("a=\"3\"", "a=\"inf\"", "line 5, road 7: <width> a=\"inf\" is not a finite number"),
        ("a=\"3\"", "a=\"1e999\"", "line 5, road 7: <width> a=\"1e999\" is not a finite number"),
        ("length=\"10\" junction", "junction", "line 2, road 7: <road> has no length"),
    ];
    for (from, to, message) in cases {
        assert_eq!(changed(ROAD, from, to).expect_err(to).to_string(), message);
    }
    let error = changed(ROAD, "</planView>", "</plan>").expect_err("not XML");
    assert!(matches!(error, ReadError::Xml { line: 3, .. }), "{error}");
    assert!(Network::parse("").is_err());
    assert!(Network::parse("<html/>").is_err());
    assert!(read_bytes(&[0xff, 0xfe, 0x00]).is_err());
    assert!(read_bytes(&[0x1f, 0x8b, 0x08, 0x00]).is_err());
}

/// One replacement in [`STREETS`], one warning.
#[test]
fn lesser_faults_become_warnings_with_line_road_and_s() {
    let cases = [
        // Words and elements.
        ("type=\"driving\"", "type=\"flying\"", "line 11, road a: <lane> type=\"flying\" is unknown"),
        ("<line/>", "", "line 5, road a, s 0.000: geometry of unknown kind"),
        ("<lanes>", "<helix/><lanes>", "line 9: 1 <road/helix> elements are not understood"),
        (
            "<width",
            "<foo/><width",
            "line 11: 1 <road/lanes/laneSection/right/lane/foo> elements are not understood",
        ),
        ("revMinor=\"7\"", "revMinor=\"12\"", "revision 1.12 is newer"),
        (" revMajor=\"1\" revMinor=\"7\"", "", "line 0: the header states no revision"),
        // The reference line.
        (
            "x=\"8\" y=\"0\"",
            "x=\"8\" y=\"0.5\"",
            "line 6, road a, s 8.000: the reference line has a gap of 0.500 m",
        ),
        (
            "x=\"8\" y=\"0\" hdg=\"0\"",
            "x=\"8\" y=\"0\" hdg=\"0.1\"",
            "line 6, road a, s 8.000: the reference line has a kink of 0.1000 rad",
        ),
        ("length=\"12\"", "length=\"11\"", "line 2, road a: geometry adds up to 19.000 m"),
        (
            "<geometry s=\"8\"",
            "<geometry s=\"9\"",
            "line 6, road a, s 9.000: geometry begins at 9.000 m where 8.000 m is expected",
        ),
        (
            "length=\"12\"><line/></geometry>",
            "length=\"12\"><line/></geometry><geometry s=\"20\" x=\"0\" y=\"0\" hdg=\"0\" length=\"-1\"/>",
            "line 6, road a, s 20.000: geometry of negative length",
        ),
        // Records.
        (
            "<elevation s=\"0\" a=\"1\"/><elevation s=\"5\" a=\"1\"/>",
            "<elevation s=\"5\" a=\"1\"/><elevation s=\"0\" a=\"1\"/>",
            "line 8, road a: elevation records are not in order of s",
        ),
        (
            "<elevation s=\"5\"",
            "<elevation s=\"0\"",
            "line 8, road a, s 0.000: 1 elevation records begin where the one before does",
        ),
        (
            "<elevation s=\"5\"",
            "<elevation s=\"25\"",
            "line 2, road a, s 25.000: a elevation record begins where there is no road",
        ),
        (
            "<laneSection s=\"12\"",
            "<laneSection s=\"21\"",
            "line 13, road a, s 21.000: a lane section begins after the road's end",
        ),
        (
            "<laneSection s=\"12\"",
            "<laneSection s=\"0\"",
            "line 9, road a, s 0.000: 1 laneSection records begin where the one before does",
        ),
        // Lanes.
        (
            "a=\"3\" b=\"0\"",
            "a=\"3\" b=\"-0.5\"",
            "line 10, road a, s 12.000: lane -1 has the negative width -1.000 m",
        ),
        (
            "<width sOffset=\"0\" a=\"3\"/><width sOffset=\"4\"",
            "<width sOffset=\"1\" a=\"3\"/><width sOffset=\"4\"",
            "line 10, road a, s 1.000: lane -1: the first width record begins late",
        ),
        (
            "<width sOffset=\"0\" a=\"3\"/><width sOffset=\"4\" a=\"3\" b=\"0\"/>",
            "",
            "line 11, road a, s 0.000: lane -1 has neither width nor border",
        ),
        (
            "<successor id=\"-1\"/>",
            "<successor id=\"-2\"/>",
            "line 10, road a, s 12.000: lane -1 leads to lane -2, which does not exist",
        ),
        (
            "<predecessor id=\"-1\"/>",
            "<predecessor id=\"1\"/>",
            "line 13, road a, s 12.000: lane -1 follows lane 1, which does not exist",
        ),
        (
            "</lane>\n",
            "</lane><lane id=\"-3\"><width a=\"1\"/></lane>\n",
            "line 10, road a, s 0.000: lane ids have gaps",
        ),
        (
            "</lane>\n",
            "</lane><lane id=\"-1\"><width a=\"1\"/></lane>\n",
            "line 10, road a, s 0.000: two lanes have one id",
        ),
        // Links.
        (
            "elementId=\"j\"/></link>",
            "elementId=\"x\"/></link>",
            "line 2, road a, s 20.000: its successor is junction x, which does not exist",
        ),
        (
            "elementId=\"d\"",
            "elementId=\"x\"",
            "line 33, road c, s 20.000: its successor is road x, which does not exist",
        ),
        (
            "<link><predecessor elementType=\"road\" elementId=\"c\" contactPoint=\"end\"/></link>",
            "",
            "line 33, road c, s 20.000: its successor is the start of road d, which is linked to nothing",
        ),
        (
            "elementId=\"c\" contactPoint=\"end\"",
            "elementId=\"c\" contactPoint=\"middle\"",
            "line 41, road d: <predecessor> has no contactPoint",
        ),
        (
            "<link><successor id=\"-1\"/></link><width sOffset=\"0\" a=\"3\"/></lane>",
            "<link><successor id=\"-2\"/></link><width sOffset=\"0\" a=\"3\"/></lane>",
            "line 33, road c, s 20.000: its successor is road d, which has no lane -2 there to meet lane -1",
        ),
        (
            "incomingRoad=\"a\"",
            "incomingRoad=\"x\"",
            "line 49: junction j: road x of a connection does not exist",
        ),
        (
            "incomingRoad=\"a\"",
            "incomingRoad=\"d\"",
            "line 49: junction j: the start of road b touches road a, not road d",
        ),
        (
            "from=\"-1\" to=\"-1\"",
            "from=\"-2\" to=\"-1\"",
            "line 49: junction j: road a has no lane -2 to come from",
        ),
        (
            "from=\"-1\" to=\"-1\"",
            "from=\"-1\" to=\"2\"",
            "line 49: junction j: road b has no lane 2 to lead to",
        ),
        ("connectingRoad=\"b\" ", "", "line 49: connection without incoming or connecting road"),
        (
            "junction=\"j\"",
            "junction=\"-1\"",
            "line 49: junction j: the connecting road b does not belong to it",
        ),
        // Ids.
        ("<road id=\"d\"", "<road id=\"c\"", "line 40, road c: another road has the id c, too"),
        ("</OpenDRIVE>", "<junction id=\"j\"/></OpenDRIVE>", "line 52: another junction has the id j, too"),
        (
            "</OpenDRIVE>",
            "<controller id=\"k\"/></OpenDRIVE>",
            "line 52: another controller has the id k, too",
        ),
        (
            "</signals>",
            "<signal id=\"s\" s=\"1\" t=\"0\"/></signals>",
            "line 23, road a, s 1.000: another signal has the id s, too",
        ),
        // Furniture.
        (
            "<signal id=\"s\" s=\"18\"",
            "<signal id=\"s\" s=\"21\"",
            "line 22, road a, s 21.000: signal s lies where there is no road",
        ),
        (
            "<signal id=\"s\" s=\"18\" t=\"-4\"",
            "<signal id=\"s\" s=\"18\" t=\"1e200\"",
            "line 22, road a: 1e200 is beyond all measure: the signal is left out",
        ),
        (
            "<repeat s=\"5\" length=\"10\"",
            "<repeat s=\"5\" length=\"16\"",
            "line 18, road a, s 21.000: row of object o lies where there is no road",
        ),
        ("distance=\"2\"", "distance=\"1e-8\"", "line 18, road a, s 5.000: a row of object o has room for"),
        (
            "length=\"6\" type=\"standard\"",
            "length=\"60\" type=\"standard\"",
            "line 2, road a, s 62.000: tunnel t lies where there is no road",
        ),
        (
            "<signalReference id=\"s\"",
            "<signalReference id=\"x\"",
            "line 25, road b, s 0.000: refers to signal x, which does not exist",
        ),
        ("signalId=\"s\"", "signalId=\"x\"", "line 47: controller k names signal x, which does not exist"),
        (
            "<controller id=\"k\"/>",
            "<controller id=\"x\"/>",
            "line 48: junction j names controller x, which does not exist",
        ),
        (
            "dynamic=\"yes\"/>",
            "><dependency id=\"x\"/></signal>",
            "line 22, road a, s 18.000: signal s depends on signal x",
        ),
    ];
    for (from, to, message) in cases {
        let found = texts(&changed(STREETS, from, to).expect(to));
        // Some faults have consequences, which may be named, too.
        assert!(
            found
                .iter()
                .any(|w| w.starts_with(message) || w.contains(message) && !message.starts_with("line")),
            "{message}: {found:?}"
        );
        assert!(found.len() <= 3, "{message}: {found:?}");
    }
}

#[test]
fn roads_without_length_or_sense_are_left_out() {
    let cases = [
        (
            "<road id=\"d\" length=\"20\"",
            "<road id=\"d\" length=\"0\"",
            "line 40, road d: road without geometry or length",
        ),
        (
            "<road id=\"d\" length=\"20\"",
            "<road id=\"d\" length=\"-3\"",
            "line 40, road d: road without geometry or length",
        ),
        ("x=\"50\"", "x=\"1e300\"", "line 40, road d, s 0.000: the reference line is beyond all measure"),
        (
            "x=\"50\" y=\"0\" hdg=\"0\" length=\"20\"><line/>",
            "x=\"50\" y=\"0\" hdg=\"0\" length=\"20\"><arc curvature=\"1e7\"/>",
            "line 40, road d, s 0.000: the reference line is beyond all measure",
        ),
    ];
    for (from, to, message) in cases {
        let network = changed(STREETS, from, to).expect(to);
        assert!(texts(&network).iter().any(|w| w.starts_with(message)), "{message}: {:?}", texts(&network));
        assert_eq!(network.roads.len(), 3);
    }
}

#[test]
fn a_namespace_and_gzip_change_nothing() {
    let plain = Network::parse(ROAD).expect("good");
    let spaced = "<OpenDRIVE xmlns=\"http://code.asam.net/simulation/standard/opendrive_schema\">";
    assert_eq!(changed(ROAD, "<OpenDRIVE>", spaced), Ok(plain.clone()));
    assert_eq!(read_bytes(&gzip(ROAD.as_bytes())), Ok(plain));
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    std::io::Write::write_all(&mut packed, bytes).expect("into memory");
    packed.finish().expect("into memory")
}

#[test]
fn bombs_are_refused() {
    let error = |bytes: &[u8]| read_bytes(bytes).expect_err("a bomb").to_string();
    // 20 MB of spaces in 20 kB.
    let bomb = gzip(&vec![b' '; 20_000_000]);
    assert!(bomb.len() < 100_000 && error(&bomb).contains("unpack to more than"));
    let deep = format!("<OpenDRIVE>{}", "<a>".repeat(1_000_000));
    assert_eq!(error(deep.as_bytes()), "line 1: elements are nested more than 100 deep");
    let wide = format!(
        "<OpenDRIVE\n {}/>",
        (0..100_000).fold(String::new(), |mut t, i| {
            let _ = write!(t, "a{i}='' ");
            t
        })
    );
    assert_eq!(error(wide.as_bytes()), "line 1: an element with more than 1000 attributes");
    let laughs = "<!DOCTYPE x [<!ENTITY a \"aaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">]><OpenDRIVE>&b;</OpenDRIVE>";
    assert!(matches!(read_bytes(laughs.as_bytes()), Err(ReadError::Xml { .. })));
}

#[test]
fn endless_rows_and_lists_stay_small() {
    let rows = "<object id='x' s='1' t='1'><repeat s='0' length='1e8' distance='0.1'/><repeat s='0' length='1e8' distance='0'/></object>";
    let objects = format!("<objects>{}</objects></road>", rows.repeat(500));
    let map = Map::new(changed(ROAD, "</road>", &objects).expect("readable"));
    assert!(map.objects().len() <= 2_000_000, "{}", map.objects().len());
    // A hundred thousand records of everything that is a list.
    let n = 100_000;
    let many = |one: &dyn Fn(f64, usize) -> String| {
        (0..n).map(|i| one(10.0 * i as f64 / n as f64, i)).collect::<String>()
    };
    let cases = [
        ("<lanes>", many(&|s, i| format!("<laneOffset s='{s}' a='{}'/>", i % 2))),
        ("<width", many(&|s, i| format!("<width sOffset='{s}' a='{}'/>", i % 3))),
        ("<width", many(&|s, _| format!("<roadMark sOffset='{s}' type='solid'/>"))),
        ("<width", format!("<link>{}</link>", many(&|_, i| format!("<successor id='{}'/>", i % 30_000)))),
        ("<lane id=\"-1\"", many(&|_, i| format!("<lane id='-{}'><width a='1'/></lane>", 2 + i % 30_000))),
        (
            "</road>",
            format!("<signals>{}</signals>", many(&|s, _| format!("<signal id='1' s='{s}' t='0'/>"))),
        ),
        ("</road>", many(&|_, i| format!("<u{i}/>"))),
        (
            "</OpenDRIVE>",
            format!("<controller id='k'>{}</controller>", many(&|_, i| format!("<control signalId='{i}'/>"))),
        ),
    ];
    for (before, records) in cases {
        let network = changed(ROAD, before, &format!("{records}{before}")).expect("readable");
        assert!(network.warnings.len() < 4000);
        assert_eq!(Map::new(network).network().roads.len(), 1);
    }
}

#[test]
fn unknown_elements_are_counted_and_kept() {
    let network = changed(
        ROAD,
        "<planView>",
        "<foo a='1' x:a='2' xmlns:x='u'><bar>text</bar></foo><foo/><planView><odd/>",
    )
    .expect("readable");
    let seen: Vec<(&str, usize, u32)> =
        network.unknown_elements.iter().map(|(path, u)| (path.as_str(), u.count, u.line)).collect();
    assert_eq!(seen, [("road/foo", 2, 3), ("road/planView/odd", 1, 3)]);
    // In their places, with what is in them: but one name stands for one attribute.
    let kept = &network.roads[0].kept;
    assert_eq!((kept.len(), kept[0].attributes.len(), kept[0].children[0].text.as_str()), (2, 1, "text"));
    let again = Network::parse(&write(&network)).expect("our own file");
    assert_eq!(again.roads, network.roads);
    // An element may have the name of a namespace declaration, an attribute may not.
    let odd = changed(ROAD, "<planView>", "<xmlns p:xmlns='1' xmlns:p='u'/><planView>").expect("readable");
    assert_eq!((odd.roads[0].kept[0].name.as_str(), odd.roads[0].kept[0].attributes.len()), ("xmlns", 0));
    assert_eq!(Network::parse(&write(&odd)).expect("our own file").roads, odd.roads);
    // User data is passed over without a word.
    let silent = changed(ROAD, "<planView>", "<userData><foo/></userData><planView>").expect("readable");
    assert_eq!(Ok(silent), Network::parse(ROAD));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any number anywhere, and any piece of text cut out: an answer comes, and a map can be made of it.
    #[test]
    fn damaged_files_never_panic(at in 0.0..1.0f64, cut in 0..60usize, everything: bool,
                                 number in prop::sample::select(vec!["-1", "1e300", "-1e300", "1e-300", "0", "65536", "x", ""])) {
        let text = if everything {
            include_str!("../data/everything.xodr").to_owned()
        } else {
            write(&common::network())
        };
        let digits: Vec<usize> = text.match_indices('"').map(|(i, _)| i).collect();
        let pick = (at * (digits.len() / 2 - 1) as f64) as usize * 2;
        let mut damaged = text.clone();
        damaged.replace_range(digits[pick] + 1..digits[pick + 1], number);
        let from = (at * text.len() as f64) as usize;
        let shorter: String = text.char_indices().filter(|(i, _)| *i < from || *i >= from + cut).map(|(_, c)| c).collect();
        for file in [damaged, shorter] {
            if let Ok(network) = Network::parse(&file) {
                let again = Network::parse(&write(&network)).expect("our own file");
                let known = Network {
                    warnings: network.warnings.clone(),
                    unknown_elements: network.unknown_elements.clone(),
                    ..again
                };
                prop_assert_eq!(&known, &network);
                let map = Map::new(network);
                for lane in map.lanes() {
                    let _ = map.ahead(LanePos { lane: lane.id, along_m: 0.0 }, 100.0);
                    let _ = map.lane_change(lane.id, lane.s_start);
                }
                for stripe in map.stripes().iter().take(20) {
                    let _ = map.stripe_line(stripe, 0.1);
                }
                let _ = map.nearest_driving_lane(nalgebra::Point3::origin());
            }
        }
    }
}
