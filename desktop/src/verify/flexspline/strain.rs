//! Strain gauges on the reduced mesh, as they run in real time (f32), against the settled literal mesh (f64).
//!
//! Every link of the mesh is a gauge, at wave-generator angles that lie anywhere between the nodes and at torques
//! up to rated, both signs.

use strainwave::flexspline::cup::DIRECTIONS;
use strainwave::flexspline::{Reduced, StrainGauge};
use strainwave::{Angle, Error};

use crate::design::joint::gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::plant::settled::Settled;
use crate::verify::bounds;
use crate::verify::largest;

/// Steps in which a mesh settles; twice as many change no strain by 1e-10.
const SETTLING: usize = 20_000;
/// Wave-generator angles (rad).
const ANGLES: [f64; 4] = [0.0, 0.3, 0.7, 2.5];
/// Torsion, in torsions at rated torque.
const TORSIONS: [f64; 4] = [-1.0, 0.0, 0.4, 1.0];

/// A link: its near node and its direction.
type Place = ((usize, usize), (i32, i32));

pub(super) fn measure(file: &GearFile) -> Result<Vec<Figure>, Error> {
    let coarse = worst::<8, 3>(file)?;
    let reference = worst::<36, 4>(file)?;
    Ok(vec![
        bounds::figure("flexspline.8x3.reduced.strain", coarse.whole),
        bounds::figure("flexspline.36x4.reduced.strain", reference.whole),
        bounds::figure("flexspline.8x3.reduced.strain_by_torque", coarse.by_torque),
        bounds::figure("flexspline.36x4.reduced.strain_by_torque", reference.by_torque),
    ])
}

/// Largest differences of strain between gauge and mesh.
#[derive(Default)]
struct Worst {
    whole: f64,
    /// Of what a torque adds to the strain without it, at the same angle.
    by_torque: f64,
}

impl Worst {
    fn take(&mut self, whole: f64, by_torque: f64) {
        self.whole = largest([self.whole, whole]);
        self.by_torque = largest([self.by_torque, by_torque]);
    }
}

fn worst<const N: usize, const M: usize>(file: &GearFile) -> Result<Worst, Error> {
    let (double, single) = (gear_params::<f64>(file), gear_params::<f32>(file));
    let params = &double.flexspline;
    let mut mesh = Settled::<N, M>::build(params, SETTLING)?;
    let reduced = Reduced::<f32, N, M>::build(&single.flexspline, single.rated_torque)?;
    let places = places::<N, M>();
    let gauges: Vec<_> = places
        .iter()
        .map(|(node, direction)| StrainGauge::build(&reduced, *node, *direction))
        .collect::<Result<_, _>>()?;
    let largest = params.line.build()?.torsion(file.gear.rated_torque);
    let mut worst = Worst::default();
    for angle in ANGLES {
        mesh.torque(0.0, angle);
        let unloaded = strains(&mesh, &places)?;
        for torsion in TORSIONS {
            let loaded = mesh.torque(torsion * largest, angle);
            for ((gauge, strain), unloaded) in gauges.iter().zip(strains(&mesh, &places)?).zip(&unloaded) {
                let of = |torque: f64| f64::from(gauge.strain(torque as f32, Angle::from_radians_f64(angle)));
                let by_torque = f64::from(gauge.per_torque) * loaded;
                worst.take(of(loaded) - strain, by_torque - (strain - unloaded));
            }
        }
    }
    Ok(worst)
}

/// Every link of an N x M mesh.
fn places<const N: usize, const M: usize>() -> Vec<Place> {
    let nodes = (0..M).flat_map(|j| (0..N).map(move |i| (i, j)));
    let links = nodes.flat_map(|node| DIRECTIONS.map(|(around, along)| (node, (around, along as i32))));
    links.filter(|((_, j), (_, along))| j + (*along as usize) < M).collect()
}

/// Strains of the links at these places.
fn strains<const N: usize, const M: usize>(
    mesh: &Settled<N, M>,
    places: &[Place],
) -> Result<Vec<f64>, Error> {
    places.iter().map(|(node, direction)| mesh.strain(*node, *direction)).collect()
}
