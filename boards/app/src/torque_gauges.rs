//! Torque by four strain gauges of the default gear, and with it where the nodes of the 8 x 3 mesh are: a control period
//! from bytes to bytes.
//!
//! A frame in: the gauges' strains, the phase of the wave generator less the flexspline, 2^32 to a revolution, and the torque as
//! known elsewhere (N m), NaN where it is not. A frame out: torque and its standard deviation (N m), then the displacements (m) by
//! slice, node and component. Little-endian words, no padding, f32 as its bits.

use strainwave::compensator::MESH;
use strainwave::flexspline::reduced::{Direction, Node};
use strainwave::flexspline::{
    DisplacementField, GaugeTorque, Reduced, StrainGauge, TorqueGauges, TorqueGaugesParams, TorqueGaugesState,
};
use strainwave::{Angle, Error};

use crate::literal_mesh::default_gear::JOINT;

/// Gauges.
pub const GAUGES: usize = 4;
/// Where they are on the 36 x 4 mesh: a quarter of a revolution apart, two along each diagonal.
const PLACES: [(Node, Direction); GAUGES] =
    [((0, 0), (1, 1)), ((9, 0), (1, 1)), ((18, 0), (-1, 1)), ((27, 0), (-1, 1))];

const WORD: usize = 4;
/// Length of a frame in (bytes).
pub const INPUT_BYTES: usize = (GAUGES + 2) * WORD;
/// Length of a frame out (bytes).
pub const OUTPUT_BYTES: usize = (2 + 3 * MESH.0 * MESH.1) * WORD;

/// Displacements (m), by slice, node and component.
type Field = [[[f32; 3]; MESH.0]; MESH.1];

/// What is read in a control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Strains.
    pub strains: [f32; GAUGES],
    /// Phase of the wave generator less the flexspline.
    pub phase: u32,
    /// Torque as known elsewhere (N m).
    pub reference: Option<f32>,
}

/// What follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Torque and its standard deviation.
    pub torque: GaugeTorque<f32>,
    /// Displacements.
    pub field: Field,
}

/// Sensor, its state and the mesh's shapes.
pub struct Program {
    sensor: TorqueGauges<f32, GAUGES>,
    state: TorqueGaugesState<f32, GAUGES>,
    mesh: Reduced<f32, { MESH.0 }, { MESH.1 }>,
    field: DisplacementField<f32, { MESH.0 }, { MESH.1 }>,
}

/// The sensor, with what is declared of its gauges.
///
/// # Errors
/// [`Error::OutOfRange`] with the name of a constant that the joint's file has wrong.
pub fn sensor() -> Result<TorqueGauges<f32, GAUGES>, Error> {
    let (flexspline, rated_torque) = (&JOINT.gear.flexspline, JOINT.gear.rated_torque);
    let cup = Reduced::<f32, 36, 4>::build(flexspline, rated_torque)?;
    let [(node, direction), ..] = PLACES;
    let mut gauges = [StrainGauge::build(&cup, node, direction)?; GAUGES];
    for (gauge, (node, direction)) in gauges.iter_mut().zip(PLACES) {
        *gauge = StrainGauge::build(&cup, node, direction)?;
    }
    let params = TorqueGaugesParams {
        gauges,
        rated_torque,
        gain: 0.058,
        offset: 5.8e-5,
        noise: 1e-6,
        misplacement: 0.01,
        reference: 0.5,
    };
    params.build()
}

impl Program {
    /// Nothing learnt.
    ///
    /// # Errors
    /// As [`sensor`].
    pub fn build() -> Result<Self, Error> {
        let sensor = sensor()?;
        let mesh = Reduced::build(&JOINT.gear.flexspline, JOINT.gear.rated_torque)?;
        Ok(Self { sensor, state: sensor.rest(), mesh, field: DisplacementField::build(&mesh) })
    }

    /// One control period.
    pub fn step(&mut self, reading: &Reading) -> Answer {
        let wave_generator = Angle::from_counts(reading.phase.into());
        let torque = self.sensor.step(&mut self.state, &reading.strains, wave_generator, reading.reference);
        let torsion = self.mesh.torsion(torque.torque);
        Answer { torque, field: self.field.at(torque.torque, torsion, wave_generator) }
    }
}

/// The bytes of a reading.
pub fn encode_reading(reading: &Reading) -> [u8; INPUT_BYTES] {
    let strains = reading.strains.iter().map(|strain| strain.to_bits());
    words(strains.chain([reading.phase, reading.reference.unwrap_or(f32::NAN).to_bits()]))
}

/// The reading in a frame.
pub fn decode(frame: &[u8; INPUT_BYTES]) -> Reading {
    let mut words = frame.chunks_exact(WORD).map(|word| {
        let mut bytes = [0; WORD];
        bytes.copy_from_slice(word);
        u32::from_le_bytes(bytes)
    });
    let mut next = || words.next().unwrap_or_default();
    let strains = core::array::from_fn(|_| f32::from_bits(next()));
    let (phase, reference) = (next(), f32::from_bits(next()));
    Reading { strains, phase, reference: Some(reference).filter(|torque| !torque.is_nan()) }
}

/// The bytes of an answer.
pub fn encode(answer: &Answer) -> [u8; OUTPUT_BYTES] {
    let GaugeTorque { torque, standard_deviation } = answer.torque;
    let field = answer.field.as_flattened().as_flattened().iter();
    words([torque, standard_deviation].into_iter().chain(field.copied()).map(f32::to_bits))
}

/// Torque and standard deviation in the bytes of an answer.
pub fn decode_torque(frame: &[u8; OUTPUT_BYTES]) -> GaugeTorque<f32> {
    let [a, b, c, d, e, f, g, h, ..] = *frame;
    let number = |bytes| f32::from_bits(u32::from_le_bytes(bytes));
    GaugeTorque { torque: number([a, b, c, d]), standard_deviation: number([e, f, g, h]) }
}

/// Words as bytes.
fn words<const K: usize>(words: impl Iterator<Item = u32>) -> [u8; K] {
    let mut frame = [0; K];
    for (bytes, word) in frame.chunks_exact_mut(WORD).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    frame
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_comes_back_from_its_frame() {
        for reference in [Some(-40.5), None] {
            let reading = Reading { strains: [1e-3, -2e-4, 0.0, f32::MAX], phase: 0xdead_beef, reference };
            assert_eq!(decode(&encode_reading(&reading)), reading);
        }
    }

    #[test]
    fn an_answers_torque_comes_back_from_its_frame() {
        let mut program = Program::build().unwrap();
        let reading = Reading { strains: [1e-4; GAUGES], phase: 7, reference: None };
        let answer = program.step(&reading);
        assert_eq!(decode_torque(&encode(&answer)), answer.torque);
        assert!(answer.field[0][0][0] > 2.9e-4);
    }
}
