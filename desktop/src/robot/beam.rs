//! Beam: a link that bends, with what is fixed to its end ([`strainwave::link`]).

use strainwave::link::{LinkParams, MOST_MODES};

use super::chain::{Link, Pose};
use crate::io::link_file::LinkFile;

/// A beam that bends, in the place of a rigid link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// The beam and what is fixed to its end; its own gravity is not used.
    pub params: LinkParams<f64, MOST_MODES>,
    /// Modes that are kept, from 1.
    pub modes: usize,
    /// Turn of the next joint's axis about x (rad).
    pub twist: f64,
}

impl Beam {
    /// The beam of a link file, whose gravity, gauges and patch are not used.
    pub fn of(file: &LinkFile, twist: f64) -> Self {
        Self { params: file.params(), modes: file.link.modes, twist }
    }

    /// Mass and inertia times `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let LinkParams { linear_density, payload_mass, payload_inertia, .. } = self.params;
        let params = LinkParams {
            linear_density: factor * linear_density,
            payload_mass: factor * payload_mass,
            payload_inertia: factor * payload_inertia,
            ..self.params
        };
        Self { params, ..self }
    }

    /// The rigid link that it is when it does not bend.
    pub fn straight(&self) -> Link {
        let LinkParams { length, linear_density, payload_mass, payload_inertia, .. } = self.params;
        let beam = linear_density * length;
        let mass = beam + payload_mass;
        let centre = (0.5 * beam + payload_mass) * length / mass;
        let across = beam * length * length / 3.0 + payload_mass * length * length - mass * centre * centre;
        Link {
            end: Pose::denavit_hartenberg([length, 0.0], self.twist),
            mass,
            centre: [centre, 0.0, 0.0],
            // Slender: what it has about its own axis is that of the payload, or a thousandth.
            inertia: [payload_inertia.max(1e-3 * across), across + payload_inertia, across + payload_inertia],
            products: [0.0; 3],
            flange: 0.0,
        }
    }

    /// With this mass (kg) at the end besides: whose modes are taken.
    pub(super) fn bearing(&self, mass: f64) -> LinkParams<f64, MOST_MODES> {
        let params = self.params;
        // Beyond the largest payload that shapes are known for the end of the beam hardly moves in them any more.
        let most = 999.0 * params.linear_density * params.length;
        LinkParams { payload_mass: (params.payload_mass + mass).min(most), ..params }
    }
}
