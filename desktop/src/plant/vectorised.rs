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
struct Step<'a, R: Real, F: Flexspline<R>> {
    model: &'a F,
    state: &'a mut F::State,
    ends: &'a Ends<R>,
}

impl<R: Real, F: Flexspline<R>> NullaryFnOnce for Step<'_, R, F> {
    type Output = Reaction<R>;

    #[inline(always)]
    fn call(self) -> Reaction<R> {
        self.model.step(self.state, self.ends)
    }
}

impl<R: Real, F: Flexspline<R>> Flexspline<R> for Vectorised<F> {
    type State = F::State;

    fn rest(&self) -> Self::State {
        self.model.rest()
    }

    #[inline]
    fn step(&self, state: &mut Self::State, ends: &Ends<R>) -> Reaction<R> {
        self.processor.dispatch(Step { model: &self.model, state, ends })
    }

    fn energy(&self, state: &Self::State, ends: &Ends<R>) -> R {
        self.model.energy(state, ends)
    }

    fn largest_strain(&self, state: &Self::State) -> Option<Strained<R>> {
        self.model.largest_strain(state)
    }
}

/// [`Mesh::relax`], to be compiled for each instruction set.
struct Relaxation<'a, R, const N: usize, const M: usize> {
    mesh: &'a Mesh<R, N, M>,
    state: &'a mut MeshState<R, N, M>,
    ends: &'a Ends<R>,
    steps: usize,
}

impl<R: Real, const N: usize, const M: usize> NullaryFnOnce for Relaxation<'_, R, N, M> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.mesh.relax(self.state, self.ends, self.steps);
    }
}

impl<R: Real, const N: usize, const M: usize> Vectorised<Mesh<R, N, M>> {
    /// As [`Mesh::relax`].
    pub fn relax(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>, steps: usize) {
        self.processor.dispatch(Relaxation { mesh: &self.model, state, ends, steps });
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
