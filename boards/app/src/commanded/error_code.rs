//! Faults of the joint as error codes (CiA 301, table "Emergency error codes"; CiA 402-2, "Error codes").

use strainwave::compensator::Faults;

/// Of each fault that leads to Safe; the first that is there counts.
const CODES: [(Faults, u16); 9] = [
    // Incremental sensor 1.
    (Faults::MOTOR_ENCODER_LOST, 0x7305),
    (Faults::MOTOR_ENCODER_FROZEN, 0x7305),
    // Excess torque.
    (Faults::GEAR_OVERLOAD, 0x8311),
    // Torque control.
    (Faults::DRIVE_NOT_FOLLOWING, 0x8300),
    (Faults::LIMIT_CYCLE, 0x8300),
    // Velocity speed controller.
    (Faults::OVERSPEED, 0x8400),
    (Faults::FOLLOWING_ERROR, 0x8611),
    // Software reset, by the watchdog.
    (Faults::RESTARTED, 0x6010),
    // Internal software.
    (Faults::PERIOD_OUT_OF_RANGE, 0x6100),
];

/// Any other cause of Safe: control overruns.
const INTERNAL_SOFTWARE: u16 = 0x6100;

/// Error code of a joint in Safe with these faults.
pub(super) fn of(faults: Faults) -> u16 {
    CODES.iter().find(|(fault, _)| faults.intersects(*fault)).map_or(INTERNAL_SOFTWARE, |(_, code)| *code)
}
