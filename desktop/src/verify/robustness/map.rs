//! What a controller has of the gear's kinematic error, the map.
//!
//! | state | the compensator | a rival |
//! | --- | --- | --- |
//! | told | has it in its gear file | has it in its gear file, and puts it in advance where it can |
//! | learnt | has none, and learns one where it reads the output's encoder | has none: no rival learns |
//! | absent | has none, and may not learn the ripple of the output's angle | has none |

use strainwave::compensator::JointParams;
use strainwave::kinematic_error::KinematicErrorParams;

use crate::io::gear_file::{GearFile, KinematicError};

/// State of the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    /// In the gear file.
    Told,
    /// Learnt while the joint works.
    Learnt,
    /// Neither.
    Absent,
}

impl Map {
    /// Every state.
    pub const ALL: [Self; 3] = [Self::Told, Self::Learnt, Self::Absent];

    /// As in `map_told`.
    pub fn name(self) -> &'static str {
        ["map_told", "map_learnt", "map_absent"][self as usize]
    }

    /// Gear file of a controller in this state.
    pub fn file(self, told: &GearFile) -> GearFile {
        let mut file = told.clone();
        if self != Self::Told {
            file.kinematic_error = KinematicError::default();
        }
        file
    }

    /// The compensator's joint in this state, from that of the gear file with the map.
    pub fn joint(self, told: &JointParams<f32>) -> JointParams<f32> {
        let mut joint = *told;
        if self != Self::Told {
            joint.gear.kinematic_error = KinematicErrorParams::default();
        }
        if self == Self::Absent {
            joint.learning.ripple.position_rate = 0.0;
        }
        joint
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::joint_params;

    /// Nothing else of the compensator depends on the map: a file without it gives the same joint.
    #[test]
    fn the_joint_is_that_of_the_file() {
        let told = GearFile::default_gear();
        let joint = joint_params(&told).unwrap();
        for map in [Map::Told, Map::Learnt] {
            assert_eq!(map.joint(&joint), joint_params(&map.file(&told)).unwrap(), "{map:?}");
        }
        let [learnt, absent] = [Map::Learnt, Map::Absent].map(|map| map.joint(&joint));
        assert!(learnt.gear == absent.gear && learnt.learning != absent.learning);
    }
}
