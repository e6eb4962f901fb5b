//! Why a run of a chip with its plant ended.

use strainwave_desktop::plant::divergence::RunError;
use strainwave_service::store;
use strainwave_service::tuning::client;

use crate::chips::chip;

/// Why a run ended.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The chip.
    #[error(transparent)]
    Chip(#[from] chip::Error),
    /// The plant.
    #[error(transparent)]
    Plant(#[from] RunError),
    /// A parameter that no model can be built from.
    #[error(transparent)]
    Parameter(#[from] strainwave::Error),
    /// The host's end of the tuning link.
    #[error(transparent)]
    Client(#[from] client::Error),
    /// What the chip has stored.
    #[error("emulated chip: {}", .0.reason())]
    Store(store::Error),
}
