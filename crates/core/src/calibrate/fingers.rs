//! The fingers that the sensors of a glove follow, from poses that bend one finger alone.
//!
//! In all other poses the fingers bend together, so that exchanged plugs of two fingers do not show.

use super::observation::{Observations, PoseObservation};
use super::pose::CalibrationPose;
use crate::estimate::{ChannelMap, ChannelRow};
use crate::hand::{Dof, Finger};

/// The smallest range of a working sensor, as a fraction of the full scale: half the range of a sensor with the wrong resistor.
const MIN_RANGE: f64 = 0.03;

/// The smallest change when a finger bends alone, as a fraction of the range of the sensor.
const MIN_CHANGE: f64 = 0.5;

/// The largest change when another finger bends, as a fraction of the change with its own finger: of two neighbors, such as ring and
/// little finger, one hardly bends without the other, but never as far.
pub(super) const MAX_OTHER: f64 = 0.9;

/// The sensor of a finger, which may span several joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FingerSensor {
    /// The index of its channel.
    pub channel: usize,
    /// The finger of the glove file.
    pub stated: Finger,
    /// The finger that it follows; `None` if it follows none, or several.
    pub followed: Option<Finger>,
}

impl FingerSensor {
    /// Returns `true` if it follows another finger than in the glove file.
    pub fn is_moved(&self) -> bool {
        self.followed.is_some_and(|finger| finger != self.stated)
    }
}

/// Returns the sensors of the fingers of a glove, by finger and from the knuckle outwards. `None` if it has none, or if a pose was not
/// taken that bends one of these fingers alone.
pub fn finger_sensors(observations: &Observations, map: &ChannelMap) -> Option<Vec<FingerSensor>> {
    let flat = observations.get(CalibrationPose::Flat)?;
    let poses = CalibrationPose::SINGLE_FINGERS.iter();
    let needed = poses.filter(|pose| pose.is_needed_for(map));
    let bent: Option<Vec<(Finger, &PoseObservation)>> = needed
        .map(|&pose| Some((pose.bent_finger()?, observations.get(pose)?)))
        .collect();
    let bent = bent.filter(|all| !all.is_empty())?;
    let mut rows: Vec<&ChannelRow> = map.rows().iter().collect();
    rows.sort_by_key(|row| row.dof);
    let mut sensors: Vec<FingerSensor> = Vec::new();
    for row in rows {
        let is_known = sensors.iter().any(|sensor| sensor.channel == row.channel);
        if let Some(stated) = row.dof.finger()
            && is_flexion(row.dof)
            && !is_known
        {
            let range = observations.range(row.channel).filter(|(low, high)| {
                let smallest = MIN_RANGE * f64::from(map.full_scale());
                high - low >= smallest
            });
            let followed = range.and_then(|(low, high)| {
                let (finger, change) = clear_change(row.channel, flat, &bent)?;
                (change >= MIN_CHANGE * (high - low)).then_some(finger)
            });
            sensors.push(FingerSensor {
                channel: row.channel,
                stated,
                followed,
            });
        }
    }
    Some(sensors)
}

/// Returns the map with each sensor at the finger that it follows. `None` if all are there already, or if a finger has more
/// sensors than in the map.
///
/// Sensors of one finger keep their order from the knuckle outwards. A sensor that follows no finger gets a finger that lacks one.
pub fn at_their_fingers(sensors: &[FingerSensor], map: &ChannelMap) -> Option<ChannelMap> {
    let places = places(sensors)?;
    let mut exchanged: Vec<(usize, usize)> = Vec::new();
    for &finger in Finger::ALL {
        let placed = || sensors.iter().zip(&places);
        let leaving = placed().filter(|(it, place)| it.stated == finger && **place != finger);
        let arriving = placed().filter(|(it, place)| it.stated != finger && **place == finger);
        exchanged.extend(
            leaving
                .zip(arriving)
                .map(|((old, _), (new, _))| (old.channel, new.channel)),
        );
    }
    let new_channel = |channel: usize| {
        let mut pairs = exchanged.iter();
        let pair = pairs.find(|(old, _)| *old == channel);
        pair.map_or(channel, |(_, new)| *new)
    };
    let is_changed = !exchanged.is_empty();
    is_changed.then(|| map.clone().with_channels(new_channel))
}

/// Returns the finger of each sensor. `None` if more sensors follow a finger than it has in the glove file.
fn places(sensors: &[FingerSensor]) -> Option<Vec<Finger>> {
    let mut places: Vec<Option<Finger>> = sensors.iter().map(|it| it.followed).collect();
    let free = |taken: &[Option<Finger>], finger: Finger| {
        let stated = sensors.iter().filter(|it| it.stated == finger).count();
        let own = taken.iter().filter(|place| **place == Some(finger));
        stated.checked_sub(own.count())
    };
    let fingers = || Finger::ALL.iter().copied();
    if fingers().any(|finger| free(&places, finger).is_none()) {
        return None;
    }
    let has_room = |taken: &[Option<Finger>], finger: Finger| {
        free(taken, finger).is_some_and(|count| count > 0)
    };
    for (index, sensor) in sensors.iter().enumerate() {
        if places[index].is_none() && has_room(&places, sensor.stated) {
            places[index] = Some(sensor.stated);
        }
    }
    while let Some(index) = places.iter().position(Option::is_none) {
        let place = fingers().find(|&finger| has_room(&places, finger))?;
        places[index] = Some(place);
    }
    places.into_iter().collect()
}

/// Returns the finger with which a channel changes most, and the change in counts. `None` if it changes with several fingers.
fn clear_change(
    channel: usize,
    flat: &PoseObservation,
    bent: &[(Finger, &PoseObservation)],
) -> Option<(Finger, f64)> {
    let straight = flat.median(channel)?;
    let change = |(finger, pose): &(Finger, &PoseObservation)| {
        let counts = pose.median(channel)? - straight;
        Some((*finger, counts.abs()))
    };
    let mut changes: Vec<(Finger, f64)> = bent.iter().filter_map(change).collect();
    changes.sort_by(|one, other| other.1.total_cmp(&one.1));
    let &(finger, largest) = changes.first()?;
    let second = changes.get(1).map_or(0.0, |(_, counts)| *counts);
    (second <= MAX_OTHER * largest).then_some((finger, largest))
}

/// Returns `true` for a joint of a finger that bends, which a pose of a single finger moves. The first joint angle of each finger is its
/// abduction.
fn is_flexion(dof: Dof) -> bool {
    dof.finger().is_some() && !dof.index().is_multiple_of(4)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::ChannelObservation;
    use crate::document::Document;
    use crate::layout::Glove;

    fn map(name: &str) -> ChannelMap {
        let document = Document::shipped(name).unwrap();
        Glove::parse(&document).unwrap().map
    }

    /// Observations of a hand whose channels follow these fingers.
    fn observe(map: &ChannelMap, finger_of: impl Fn(usize) -> Option<Finger>) -> Observations {
        let mut observations = Observations::default();
        let poses = [CalibrationPose::Flat, CalibrationPose::Fist];
        for &pose in poses.iter().chain(CalibrationPose::SINGLE_FINGERS) {
            let observe = |channel: usize| {
                let finger = finger_of(channel);
                let is_bent = match pose.bent_finger() {
                    Some(bent) => finger == Some(bent),
                    None => finger.is_some() && pose == CalibrationPose::Fist,
                };
                let median = if is_bent { 3_000.0 } else { 1_000.0 };
                ChannelObservation {
                    channel,
                    median,
                    low: median,
                    high: median,
                    is_still: true,
                    is_sent: true,
                }
            };
            let channels = map.angle_channels().into_iter().map(observe).collect();
            observations.insert(PoseObservation { pose, channels });
        }
        observations
    }

    fn stated(map: &ChannelMap, channel: usize) -> Option<Finger> {
        let mut rows = map.rows().iter();
        let row = rows.find(|row| row.channel == channel && is_flexion(row.dof));
        row.and_then(|row| row.dof.finger())
    }

    fn channels(map: &ChannelMap, finger: Finger) -> Vec<usize> {
        let rows = map.rows().iter();
        let own = rows.filter(|row| row.dof.finger() == Some(finger) && is_flexion(row.dof));
        own.map(|row| row.channel).collect()
    }

    #[test]
    fn sensors_at_their_fingers_change_nothing() {
        for name in ["lucidgloves", "unam-hc11"] {
            let map = map(name);
            let observations = observe(&map, |channel| stated(&map, channel));
            let sensors = finger_sensors(&observations, &map).unwrap();
            assert!(sensors.iter().all(|it| it.followed == Some(it.stated)));
            assert_eq!(at_their_fingers(&sensors, &map), None, "{name}");
        }
    }

    #[test]
    fn three_exchanged_fingers_get_their_sensors_in_the_order_of_their_joints() {
        let map = map("lucidgloves");
        let turned = |channel: usize| match stated(&map, channel)? {
            Finger::Index => Some(Finger::Middle),
            Finger::Middle => Some(Finger::Ring),
            Finger::Ring => Some(Finger::Index),
            other => Some(other),
        };
        let sensors = finger_sensors(&observe(&map, turned), &map).unwrap();
        let matched = at_their_fingers(&sensors, &map).unwrap();
        assert_eq!(channels(&matched, Finger::Index), [23, 24, 25]);
        assert_eq!(channels(&matched, Finger::Middle), [15, 16, 17]);
        assert_eq!(channels(&matched, Finger::Ring), [19, 20, 21]);
        assert_eq!(channels(&matched, Finger::Little), [27, 28, 29]);
    }

    #[test]
    fn one_sensor_over_two_joints_is_exchanged_with_another_one() {
        let map = map("unam-hc11");
        let swapped = |channel: usize| match channel {
            52 => stated(&map, 9),
            9 => stated(&map, 52),
            _ => stated(&map, channel),
        };
        let sensors = finger_sensors(&observe(&map, swapped), &map).unwrap();
        let matched = at_their_fingers(&sensors, &map).unwrap();
        assert_eq!(channels(&matched, Finger::Middle), [9, 9, 57]);
        assert_eq!(channels(&matched, Finger::Ring), [52, 52, 33]);
    }

    #[test]
    fn a_dead_sensor_takes_the_place_that_is_left_and_two_sensors_of_one_finger_change_nothing() {
        let map = map("lucidgloves");
        let dead = |channel: usize| match stated(&map, channel)? {
            Finger::Middle => Some(Finger::Ring),
            Finger::Ring => None,
            other => Some(other),
        };
        let sensors = finger_sensors(&observe(&map, dead), &map).unwrap();
        let matched = at_their_fingers(&sensors, &map).unwrap();
        assert_eq!(channels(&matched, Finger::Ring), [19, 20, 21]);
        assert_eq!(channels(&matched, Finger::Middle), [23, 24, 25]);
        let doubled = |channel: usize| match stated(&map, channel)? {
            Finger::Middle => Some(Finger::Ring),
            other => Some(other),
        };
        let both = finger_sensors(&observe(&map, doubled), &map).unwrap();
        assert_eq!(at_their_fingers(&both, &map), None);
    }

    #[test]
    fn without_each_finger_alone_nothing_is_known() {
        let map = map("lucidgloves");
        let mut observations = observe(&map, |channel| stated(&map, channel));
        observations.remove(CalibrationPose::RingBent);
        assert_eq!(finger_sensors(&observations, &map), None);
        let arm = ChannelMap::new(Vec::new(), 255);
        assert_eq!(finger_sensors(&observations, &arm), None);
    }
}
