//! What is published of how drivers and people move, beside what the scenes show.
//!
//! * 100-Car: Dingus et al., The 100-Car Naturalistic Driving Study, DOT HS 810 593, 2006: what marked a
//!   stretch of recorded driving as a possible incident.
//! * NCHRP 400: Fambro, Fitzpatrick and Koppa, Determination of Stopping Sight Distances, 1997: nine of ten
//!   drivers brake harder for something unexpected.
//! * UN R79: Regulation No. 79, 03 series: systems that steer; lateral jerk averaged over half a second.
//! * ISO 15622:2018: cruise control above 20 m/s and below 5 m/s; braking averaged over 2 s, jerk over 1 s.
//! * Curves: a test-track study with 28 passengers, doi:10.31234/osf.io/kcw2d: 3 m/s2 was more balanced, 4
//!   m/s2 often too fast.
//! * Weidmann: Transporttechnik der Fussgänger, 1993: free walking speed, mean and standard deviation.

use super::people::Moves;
use super::{Report, mean, quantile};

fn line(what: &str, here: &str, published: &str) {
    println!("| {what} | {here} | {published} |");
}

fn spread(values: &[f64]) -> f64 {
    let middle = mean(values);
    mean(&values.iter().map(|v| (v - middle) * (v - middle)).collect::<Vec<_>>()).sqrt()
}

/// A table of both.
pub(crate) fn print(reports: &[Report]) {
    let all = |of: fn(&Report) -> &Vec<f64>| -> Vec<f64> { reports.iter().flat_map(of).copied().collect() };
    let two = |mut values: Vec<f64>, shares: [f64; 2]| {
        let [a, b] = shares.map(|share| quantile(&mut values, share));
        format!("{a:.2}, {b:.2}")
    };
    println!("\n| how they move | here | published |\n|---|---|---|");
    line(
        "sideways acceleration, m/s2: 99.9 %, most",
        &two(all(|r| &r.motion.sideways), [0.999, 1.0]),
        "systems 3 (UN R79); passengers 3, not 4 (curves); incidents from 6.9 (100-Car)",
    );
    line(
        "braking, m/s2: 1 %, 0.1 %",
        &two(all(|r| &r.motion.acceleration).iter().map(|a| -a).collect(), [0.99, 0.999]),
        "systems 3.5 to 5 (ISO 15622); 3.4 in need (NCHRP 400); incidents from 5.9 (100-Car)",
    );
    line(
        "jerk over half a second, m/s3: 99 %, 99.9 %",
        &two(all(|r| &r.motion.jerk).iter().map(|j| j.abs()).collect(), [0.99, 0.999]),
        "systems 2.5 to 5 over a second (ISO 15622), sideways 5 (UN R79)",
    );
    let feet = |of: fn(&Moves) -> &Vec<f64>| -> Vec<f64> {
        reports.iter().flat_map(|r| of(&r.people.on_foot)).copied().collect()
    };
    let speeds = feet(|m| &m.speed_mps);
    line(
        "walking speed, m/s: mean, deviation",
        &format!("{:.2}, {:.2}", mean(&speeds), spread(&speeds)),
        "1.34, 0.26 (Weidmann); as wished for: log-normal, median 1.17, at least 0.8 (SimBEV2X)",
    );
}
