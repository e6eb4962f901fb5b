//! Histories that cost the hysteresis most, and whether it is right along them: what is counted works.
//!
//! The torsion runs down towards zero until the memory is full and beyond, each time turning a little earlier. From
//! every depth it then turns, goes on, or wipes out any number of what it remembers, all of it at once included;
//! and so does the inverse in looking for the output there, which must be the target. Random
//! inputs follow. Inputs in half ranges, outputs in those at saturation.

use strainwave::Error;
use strainwave::compensator::{HYSTERESIS_LEVELS, HYSTERESIS_MEMORY};
use strainwave::hysteresis::{Staircase, StaircaseState, TorsionHysteresis, TorsionHysteresisState, Weights};

/// Largest difference of an output to the inverse's target.
pub const AGREEMENT: f32 = 1e-5;

/// Turning points of a run-down: more than are remembered.
const TURNING_POINTS: usize = HYSTERESIS_MEMORY + 4;

/// Random inputs.
const INPUTS: u32 = 2000;

type Model = Staircase<f32, HYSTERESIS_LEVELS, HYSTERESIS_MEMORY>;
type Torsion = TorsionHysteresis<f32, HYSTERESIS_LEVELS, HYSTERESIS_MEMORY>;

/// Both operators on one history.
struct Driven {
    model: Model,
    torsion: Torsion,
    state: StaircaseState<f32, HYSTERESIS_MEMORY>,
    torsion_state: TorsionHysteresisState<f32, HYSTERESIS_MEMORY>,
    /// Largest distance of an output from its target.
    worst: f32,
}

/// Runs through the histories: the largest distance of an output from its target.
///
/// # Errors
/// None with the models as they are.
pub fn drive() -> Result<f32, Error> {
    let weights = Weights::uniform(1.0)?;
    let mut driven = Driven {
        model: Model::build(1.0, &weights)?,
        torsion: Torsion::from_weights(1.0, &weights)?,
        state: StaircaseState::default(),
        torsion_state: TorsionHysteresisState::default(),
        worst: 0.0,
    };
    driven.run_down()?;
    driven.at_random()?;
    Ok(driven.worst)
}

impl Driven {
    fn run_down(&mut self) -> Result<(), Error> {
        for k in 0..TURNING_POINTS {
            for reach in 0..=2 * k + 2 {
                // Between two turning points on either side, beyond the first at last.
                let to = 1.0 - (reach as f32 - 0.5) / (TURNING_POINTS + 1) as f32;
                self.look_ahead(to)?;
                self.look_ahead(-to)?;
            }
            self.step(turning_point(k));
        }
        for input in [f32::NAN, 2.0, -2.0, f32::NAN, 0.0] {
            self.look_ahead(input)?;
            self.step(input);
        }
        Ok(())
    }

    /// Marsaglia's xorshift32, on a grid coarse enough for inputs to be met again.
    fn at_random(&mut self) -> Result<(), Error> {
        let mut bits = 2_463_534_242_u32;
        for _ in 0..INPUTS {
            bits ^= bits << 13;
            bits ^= bits >> 17;
            bits ^= bits << 5;
            let input = (bits >> 22) as f32 / 512.0 - 1.0;
            self.look_ahead(input)?;
            self.step(input);
        }
        Ok(())
    }

    fn step(&mut self, input: f32) {
        self.model.step(&mut self.state, input);
        self.torsion.step(&mut self.torsion_state, input);
    }

    /// A step to `input` and back in time, and the inverse's way to the output there.
    fn look_ahead(&mut self, input: f32) -> Result<(), Error> {
        let mut next = self.torsion_state;
        self.torsion.step(&mut next, input);
        let expected = self.model.peek(&self.state, input).output;
        let found = self.model.inverse()?.input(&self.state, expected);
        let distance = (self.model.peek(&self.state, found).output - expected).abs();
        self.worst = self.worst.max(distance);
        Ok(())
    }
}

/// From the end of the range inwards, on alternating sides.
fn turning_point(k: usize) -> f32 {
    let amplitude = 1.0 - k as f32 / (TURNING_POINTS + 1) as f32;
    if k.is_multiple_of(2) { amplitude } else { -amplitude }
}
