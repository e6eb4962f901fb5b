//! Time of one step of the mesh, per link: what `host-tests/rivals/flexspline.py` compares with others.
//!
//! The whole step as the desktop's plant takes it, [`Vectorised`], on the default gear, moving: its drive moves at
//! 10 rad/s on the output side and the ellipse a hundred times as fast, so that no node rests.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use strainwave::flexspline::shell::Shell;
use strainwave::flexspline::{Ends, Flexspline, Mesh};
use strainwave::{Angle, Real};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::gear_params;
use strainwave_desktop::plant::vectorised::Vectorised;

/// Rate of the drive (rad/s).
const DRIVE_RATE: f64 = 10.0;
/// Fraction of the largest stable step that is taken.
const STEP: f64 = 0.7;

fn step<R: Real, const N: usize, const M: usize>(criterion: &mut Criterion, precision: &str) {
    let params = gear_params::<R>(&GearFile::default_gear()).flexspline;
    let dt = R::lit(STEP) * Mesh::<R, N, M>::stable_step(&params);
    let mesh = Vectorised::new(Mesh::<R, N, M>::build(&params, dt).expect("the default gear can be built"));
    let mut state = mesh.rest();
    let drive_rate = R::lit(DRIVE_RATE);
    let wave_generator_rate = R::lit(-100.0 * DRIVE_RATE);
    let mut ends = Ends { drive_rate, flange_rate: drive_rate, wave_generator_rate, ..Ends::default() };
    let mut group = criterion.benchmark_group("flexspline");
    group.throughput(Throughput::Elements(Shell::<R, N, M>::links() as u64));
    group.bench_function(BenchmarkId::new(precision, format_args!("{N}x{M}")), |bencher| {
        bencher.iter(|| {
            let advanced = |angle: Angle<R>, rate: R| angle.plus(rate * dt);
            ends.drive = advanced(ends.drive, ends.drive_rate);
            ends.flange = advanced(ends.flange, ends.flange_rate);
            ends.wave_generator = advanced(ends.wave_generator, ends.wave_generator_rate);
            black_box(mesh.step(&mut state, &ends))
        });
    });
    group.finish();
}

fn steps(criterion: &mut Criterion) {
    step::<f64, 36, 4>(criterion, "f64");
    step::<f32, 36, 4>(criterion, "f32");
    step::<f64, 8, 3>(criterion, "f64");
    step::<f32, 8, 3>(criterion, "f32");
}

criterion_group!(benches, steps);
criterion_main!(benches);
