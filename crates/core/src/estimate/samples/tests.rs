//! Comparison of the channel table with the rows of a map one by one.

use super::channel_table::ChannelTable;
use super::channels::ChannelConverter;
use crate::capture::Channels;
use crate::estimate::plausibility::Plausibility;
use crate::estimate::{
    AffineMap, ChannelMap, ChannelRow, Estimate, EstimatorSettings, JointLimits, Rejection,
};
use crate::hand::{Dof, DofSet, JointAngles};
use crate::time::Timestamp;

/// Returns a map of random channels, and the same with a second row of one angle, which has no table.
fn maps(random: &mut fastrand::Rng) -> [ChannelMap; 2] {
    let mut rows = Vec::new();
    for &dof in Dof::ALL {
        if random.u32(..5) > 0 {
            let slope = random.f64() * 0.02 - 0.01;
            rows.push(ChannelRow {
                label: dof.to_string(),
                dof,
                channel: random.usize(..24),
                calibration: AffineMap::from_counts(random.f64() * -200.0, slope, 0.3),
            });
        }
    }
    let curvatures = vec![(3, 20.0), (7, -31.0)];
    let map = |map_rows| ChannelMap::new(map_rows, 255).with_curvatures(curvatures.clone());
    let mut twice = rows.clone();
    twice.push(rows[0].clone());
    [rows, twice].map(map)
}

#[test]
fn a_table_gives_the_angles_of_the_rows_one_by_one() {
    let mut random = fastrand::Rng::with_seed(3);
    let limits = JointLimits::human();
    let mut outcomes = [0; 3];
    for round in 0..4_000 {
        let map = maps(&mut random);
        let limits = Some(&limits).filter(|_| round % 5 > 0);
        assert!(ChannelTable::new(&map[1], limits).is_none());
        assert!(ChannelTable::new(&map[0], limits).is_some());
        let mut offsets = JointAngles::default();
        for &dof in Dof::ALL.iter().filter(|_| random.u32(..9) == 0) {
            offsets.set(dof, if round % 50 == 0 { f64::NAN } else { 0.05 });
        }
        let spread = random.u16(1..256);
        let middle = random.u16(..=255 - spread / 2);
        let counts = (0..24).map(|_| match random.u32(..2_000) {
            0 => Channels::UNKNOWN,
            _ => (middle.saturating_sub(spread / 2) + random.u16(..spread)).min(255),
        });
        let channels = Channels {
            full_scale: 255,
            counts: counts.collect(),
            unsent: Default::default(),
        };
        let settings = EstimatorSettings {
            limits: limits.copied(),
            ..EstimatorSettings::default()
        };
        let convert = |given| {
            let mut converter = ChannelConverter::new(given, &settings);
            let mut estimate = Estimate::new(Timestamp(1), JointAngles::default());
            let outcome = converter.convert(
                &channels,
                settings.rail_timeout,
                &offsets,
                &mut Plausibility::default(),
                &mut estimate,
            );
            (outcome, estimate)
        };
        let [(by_table, estimate), (by_rows, expected)] = map.each_ref().map(convert);
        assert_eq!(by_table, by_rows, "round {round}");
        outcomes[match by_rows {
            Ok(()) => 0,
            Err(Rejection::NotFinite) => 1,
            Err(_) => 2,
        }] += 1;
        if by_rows.is_ok() {
            assert_eq!(estimate, expected, "round {round}");
        }
    }
    assert!(outcomes.iter().all(|count| *count > 10), "{outcomes:?}");
}

#[test]
fn a_learned_range_changes_the_table() {
    let row = ChannelRow {
        label: "pip".to_owned(),
        dof: Dof::IndexPipFlexion,
        channel: 0,
        calibration: AffineMap::from_counts(-50.0, 0.01, 0.0),
    };
    let settings = EstimatorSettings {
        learn_ranges: true,
        ..EstimatorSettings::default()
    };
    let map = |rows| ChannelMap::new(rows, 255).with_ranges(vec![(0, (50.0, 200.0))]);
    let [by_table, by_rows] = [vec![row.clone()], vec![row.clone(), row]].map(|rows| {
        let mut converter = ChannelConverter::new(&map(rows), &settings);
        let channels = |count| Channels {
            full_scale: 255,
            counts: [count].into_iter().collect(),
            unsent: Default::default(),
        };
        let convert = |tested: &mut ChannelConverter| {
            let mut estimate = Estimate::new(Timestamp(1), JointAngles::default());
            let offsets = JointAngles::default();
            let outcome = tested.convert(
                &channels(150),
                None,
                &offsets,
                &mut Plausibility::default(),
                &mut estimate,
            );
            outcome.unwrap();
            estimate.angles.get(Dof::IndexPipFlexion)
        };
        let before = convert(&mut converter);
        for index in 0..80 {
            let count = if index < 60 { 220 } else { 150 };
            converter.observe_ranges(Timestamp(10_000 * index), &channels(count), DofSet::NONE);
        }
        assert!(converter.is_widening_due());
        converter.widen_ranges();
        let widened = convert(&mut converter);
        converter.undo_learning();
        [before, widened, convert(&mut converter)]
    });
    assert_eq!(by_table, by_rows);
    let [before, widened, undone] = by_table;
    assert!(widened < before && undone == before, "{by_table:?}");
}
