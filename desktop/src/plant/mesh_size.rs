//! The sizes of the reference mesh, n nodes around x m along the axis: one table, from which each is compiled.

use std::fmt;
use std::str::FromStr;

use strainwave::flexspline::shell::{NODES_ALONG, NODES_AROUND};

/// Work on a mesh of any size.
pub trait OnMesh {
    /// Result of the call.
    type Output;

    /// The work on a mesh of N nodes around x M along the axis.
    fn run<const N: usize, const M: usize>(self) -> Self::Output;
}

macro_rules! sizes {
    ($($name:ident: $n:literal x $m:literal,)*) => {
        /// One of the sizes that are compiled in.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum MeshSize {
            $(#[doc = concat!($n, " nodes around x ", $m, " along the axis.")] $name,)*
        }

        impl MeshSize {
            /// Every size.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Nodes around and along the axis.
            pub fn nodes(self) -> (usize, usize) {
                match self {
                    $(Self::$name => ($n, $m),)*
                }
            }

            /// Does the work on a mesh of this size.
            pub fn run<W: OnMesh>(self, work: W) -> W::Output {
                match self {
                    $(Self::$name => work.run::<$n, $m>(),)*
                }
            }
        }
    };
}

sizes! {
    By8x3: 8 x 3,
    By12x3: 12 x 3,
    By16x4: 16 x 4,
    By24x4: 24 x 4,
    By36x4: 36 x 4,
    By36x6: 36 x 6,
    By48x6: 48 x 6,
    By72x8: 72 x 8,
}

impl MeshSize {
    /// The paper's 36 stacks and 4 slices.
    pub const DEFAULT: Self = Self::By36x4;

    /// The names of all sizes in one line.
    pub fn names() -> String {
        Self::ALL.iter().map(Self::to_string).collect::<Vec<_>>().join(", ")
    }
}

impl fmt::Display for MeshSize {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (n, m) = self.nodes();
        write!(formatter, "{n}x{m}")
    }
}

impl FromStr for MeshSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.parse::<i64>().ok();
        let parts = text.split_once('x').and_then(|(n, m)| Some((number(n)?, number(m)?)));
        let (n, m) = parts.ok_or_else(|| format!("not NxM; allowed: {}", Self::names()))?;
        let (fewest_n, fewest_m) = (*NODES_AROUND.start() as i64, *NODES_ALONG.start() as i64);
        if n < fewest_n {
            return Err(format!("n = {n} is out of range; allowed: {fewest_n} nodes around or more"));
        }
        if m < fewest_m {
            return Err(format!("m = {m} is out of range; allowed: {fewest_m} nodes along the axis or more"));
        }
        let found = Self::ALL.iter().find(|size| size.nodes() == (n as usize, m as usize));
        found.copied().ok_or_else(|| format!("not compiled in; allowed: {}", Self::names()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Nodes;

    impl OnMesh for Nodes {
        type Output = (usize, usize);

        fn run<const N: usize, const M: usize>(self) -> (usize, usize) {
            (N, M)
        }
    }

    #[test]
    fn a_size_is_read_back_from_its_name_and_runs_as_such() {
        for size in MeshSize::ALL {
            assert_eq!(size.to_string().parse(), Ok(*size));
            assert_eq!(size.run(Nodes), size.nodes());
        }
        assert_eq!(MeshSize::DEFAULT.nodes(), (36, 4));
    }

    #[test]
    fn what_is_no_size_is_told_the_bound_or_the_list() {
        let refused = |text: &str| text.parse::<MeshSize>().unwrap_err();
        assert_eq!(refused("3x4"), "n = 3 is out of range; allowed: 4 nodes around or more");
        assert_eq!(refused("-8x3"), "n = -8 is out of range; allowed: 4 nodes around or more");
        assert_eq!(refused("8x1"), "m = 1 is out of range; allowed: 2 nodes along the axis or more");
        let list = "8x3, 12x3, 16x4, 24x4, 36x4, 36x6, 48x6, 72x8";
        assert_eq!(refused("9x3"), format!("not compiled in; allowed: {list}"));
        for text in ["", "x", "36", "36x", "36 x 4", "36x4x2", "99999999999999999999x4"] {
            assert_eq!(refused(text), format!("not NxM; allowed: {list}"));
        }
    }
}
