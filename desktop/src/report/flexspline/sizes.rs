//! Natural frequencies and the stable step of every mesh size.

use maud::{Markup, html};
use nalgebra::{DMatrix, SymmetricEigen};
use strainwave::flexspline::{FlexsplineParams, Mesh, Shell};

use crate::plant::mesh_size::{MeshSize, OnMesh};
use crate::plant::{STEP_SHARE, micro_steps};
use crate::report::table;

const HEADER: [&str; 7] = [
    "mesh",
    "links",
    "torsion, lowest (kHz)",
    "ellipse, lowest (kHz)",
    "all, highest (kHz)",
    "stable step (µs)",
    "steps in 0.1\u{a0}ms",
];

pub(super) fn section(params: &FlexsplineParams<f64>) -> Markup {
    let rows: Vec<_> = MeshSize::ALL.iter().map(|size| size.run(Row { params, size: *size })).collect();
    let tube = kilohertz(params.cup.torsion_frequency());
    html! {
        h3 { "Mesh sizes" }
        p {
            "Natural frequencies of the round mesh with rim and flange held: the lowest mode of torsion (of the tube: "
            (tube) " kHz), the lowest of the ellipse's harmonic, and the highest of all. The stable step is that of the "
            "assembled mesh with its tooth contact and its damping; the reference build takes " (STEP_SHARE) " of it."
        }
        (table(HEADER, &rows))
    }
}

fn kilohertz(angular_frequency: f64) -> String {
    format!("{:.1}", angular_frequency / std::f64::consts::TAU * 1e-3)
}

/// Natural angular frequencies of a mesh (rad/s).
struct Frequencies {
    torsion: f64,
    ellipse: f64,
    highest: f64,
}

impl Frequencies {
    fn of<const N: usize, const M: usize>(params: &FlexsplineParams<f64>) -> Self {
        let harmonic = |order, components: &[usize]| {
            let matrix = Mesh::<f64, N, M>::harmonic(params, order);
            let places: Vec<_> = (1..M - 1).flat_map(|j| components.iter().map(move |c| (j, *c))).collect();
            let entry = |row: usize, column: usize| {
                let ((j, c), (k, d)) = (places[row], places[column]);
                matrix[j][c][k][d]
            };
            SymmetricEigen::new(DMatrix::from_fn(places.len(), places.len(), entry)).eigenvalues
        };
        let highest = (0..=N / 2).map(|order| harmonic(order, &[0, 1, 2]).max()).fold(0.0, f64::max);
        Self {
            torsion: harmonic(0, &[1]).min().sqrt(),
            ellipse: harmonic(2, &[0, 1, 2]).min().sqrt(),
            highest: highest.sqrt(),
        }
    }
}

struct Row<'a> {
    params: &'a FlexsplineParams<f64>,
    size: MeshSize,
}

impl OnMesh for Row<'_> {
    type Output = [String; 7];

    fn run<const N: usize, const M: usize>(self) -> Self::Output {
        let Frequencies { torsion, ellipse, highest } = Frequencies::of::<N, M>(self.params);
        let stable = Mesh::<f64, N, M>::stable_step(self.params);
        [
            self.size.to_string(),
            Shell::<f64, N, M>::links().to_string(),
            kilohertz(torsion),
            kilohertz(ellipse),
            kilohertz(highest),
            format!("{:.3}", stable * 1e6),
            format!("{}", micro_steps(STEP_SHARE * stable)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::gear_params;
    use crate::io::gear_file::GearFile;

    fn params() -> FlexsplineParams<f64> {
        gear_params(&GearFile::default_gear()).flexspline
    }

    /// Basis of the estimate of the reduction's error.
    #[test]
    fn the_lowest_modes_are_those_that_the_reduction_is_documented_with() {
        let within =
            |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 0.01, "{value} {expected}");
        within(Frequencies::of::<8, 3>(&params()).ellipse, 8.6e4);
        within(Frequencies::of::<36, 4>(&params()).ellipse, 7.4e4);
    }

    #[test]
    fn a_finer_mesh_comes_closer_to_the_tubes_torsion() {
        let tube = params().cup.torsion_frequency();
        let difference = |frequencies: Frequencies| (frequencies.torsion / tube - 1.0).abs();
        let [coarse, fine] =
            [difference(Frequencies::of::<8, 3>(&params())), difference(Frequencies::of::<72, 8>(&params()))];
        assert!(fine < 0.15 && 2.0 * fine < coarse, "{coarse} {fine}");
    }

    /// A mode swings stably with dt < 2/omega, and the bound is not far below that of the stiffest.
    #[test]
    fn the_stable_step_lies_just_below_that_of_the_highest_mode() {
        let highest = Frequencies::of::<36, 4>(&params()).highest;
        let fraction = Mesh::<f64, 36, 4>::stable_step(&params()) * highest / 2.0;
        assert!((0.8..1.0).contains(&fraction), "{fraction}");
    }
}
