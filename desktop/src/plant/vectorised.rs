//! A flexspline stepped with the widest vector instructions that this processor has.
//!
//! The model's own code, compiled once more for each instruction set (AVX2, AVX-512 on x86) and chosen when the
//! program runs; without one of them, as the compiler's target has it. Nothing is fused or reordered, so
//! every processor gives the same bits.

use pulp::{Arch, NullaryFnOnce};
use strainwave::Real;
use strainwave::flexspline::mesh::MeshState;
use strainwave::flexspline::shell::ShellState;
use strainwave::flexspline::{Ends, Flexspline, Mesh, Reaction, Shell, Strained};

/// A flexspline model, and what this processor can do.
#[derive(Clone, Debug)]
pub struct Vectorised<F> {
    model: F,
    processor: Arch,
}

impl<F> Vectorised<F> {
    /// The same model.
    pub fn new(model: F) -> Self {
        Self { model, processor: Arch::new() }
    }

    /// The model as it is elsewhere.
    pub fn model(&self) -> &F {
        &self.model
    }
}

/// One step, to be compiled for each instruction set.
struct Step<'a, R, const N: usize, const M: usize> {
    mesh: &'a Mesh<R, N, M>,
    state: &'a mut MeshState<R, N, M>,
    ends: &'a Ends<R>,
}

impl<R: Real, const N: usize, const M: usize> NullaryFnOnce for Step<'_, R, N, M> {
    type Output = Reaction<R>;

    #[inline(always)]
    fn call(self) -> Reaction<R> {
        self.mesh.step_inlined(self.state, self.ends)
    }
}

/// A step with the instructions of this processor.
#[inline]
fn step<R: Real, const N: usize, const M: usize>(
    processor: Arch,
    mesh: &Mesh<R, N, M>,
    state: &mut MeshState<R, N, M>,
    ends: &Ends<R>,
) -> Reaction<R> {
    // Without one of the instruction sets the step is the mesh's own: a step is long to compile.
    if matches!(processor, Arch::Scalar) {
        return mesh.step(state, ends);
    }
    processor.dispatch(Step { mesh, state, ends })
}

impl<R: Real, const N: usize, const M: usize> Flexspline<R> for Vectorised<Mesh<R, N, M>> {
    type State = MeshState<R, N, M>;

    fn rest(&self) -> Self::State {
        self.model.rest()
    }

    #[inline]
    fn step(&self, state: &mut Self::State, ends: &Ends<R>) -> Reaction<R> {
        step(self.processor, &self.model, state, ends)
    }

    fn energy(&self, state: &Self::State, ends: &Ends<R>) -> R {
        self.model.energy(state, ends)
    }

    fn largest_strain(&self, state: &Self::State) -> Option<Strained<R>> {
        self.model.largest_strain(state)
    }
}

impl<R: Real, const N: usize, const M: usize> Vectorised<Mesh<R, N, M>> {
    /// As [`Mesh::relax`].
    pub fn relax(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>, steps: usize) {
        self.model.relax_by(state, steps, |slowed, state| {
            step(self.processor, slowed, state, ends);
        });
    }
}

/// Steps of a free shell, to be compiled for each instruction set.
struct FreeSteps<'a, R, const N: usize, const M: usize> {
    shell: &'a Shell<R, N, M>,
    state: &'a mut ShellState<R, N, M>,
    steps: usize,
}

impl<R: Real, const N: usize, const M: usize> NullaryFnOnce for FreeSteps<'_, R, N, M> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for _ in 0..self.steps {
            self.shell.step(self.state);
        }
    }
}

impl<R: Real, const N: usize, const M: usize> Vectorised<Shell<R, N, M>> {
    /// So many of [`Shell::step`].
    pub fn steps(&self, state: &mut ShellState<R, N, M>, steps: usize) {
        self.processor.dispatch(FreeSteps { shell: &self.model, state, steps });
    }
}
