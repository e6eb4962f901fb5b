//! The control on an emulated board, with its tuning link served from the idle loop.

use static_cell::StaticCell;
use strainwave_app::served::{Exchange, Served, ServedJoint};
use strainwave_app::{Control, Slot, Telemetry};
use strainwave_service::tuning::TuningLink;

use crate::control::{self, Board};
use crate::flash_file::FlashFile;
use crate::serial::{Port, Tunable};

/// Takes the joint over as [`crate::start`] does, with what its store holds, and serves the link until the host closes the lockstep one.
pub fn start<M: Tunable>(
    place: &'static StaticCell<Control<Served<Board<M>>>>,
    slot: &'static Slot<Served<Board<M>>>,
    telemetry: &'static mut Telemetry,
    exchange: &'static Exchange,
) -> ! {
    let (sender, log) = telemetry.split();
    let (board, compensator) = control::prepare::<M>();
    let flash = FlashFile::open().map(|flash| (flash, FlashFile::REGION));
    // Its flash is a file: writing it takes the control none of its time.
    let mut joint = ServedJoint::new(exchange, flash, true);
    if let Some(place) = place.try_uninit() {
        let control = place.write(Control::new(Served::new(board, exchange), compensator, sender));
        if let Some(learnt) = joint.learnt_before() {
            control.start_from(&learnt);
        }
        slot.put(control);
    }
    let (mut port, mut link) = (Port::<M>::open(), TuningLink::default());
    control::idle::<M>(log, || link.poll(&mut port, &mut joint))
}
