//! Bounds of the whole gear, its plant, and the firmware against the host.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "angle.torsion.million_turns",
        value: 2e-10,
        unit: "rad",
        why: "f32 torsion up to 1.5 mrad after 10^6 wave-generator revolutions: a 24-bit difference, 1 unit of which \
              is 1.2e-10 rad; the observer needs 1e-6",
    },
    Bound {
        name: "plant.power_balance",
        value: 1e-6,
        unit: "1",
        why: "energy that the reference plant's micro-steps leave unaccounted, of the energy moved; target 1e-4",
    },
    Bound {
        name: "plant.condensed.output",
        value: 5e-6,
        unit: "rad",
        why: "error of 4 micro-steps a period and a mesh without inertia against the reference plant's output in a \
              closed loop: below half of a 19-bit encoder's count",
    },
    Bound {
        name: "plant.condensed.torsion",
        value: 5e-6,
        unit: "rad",
        why: "the same of the torsion: 0.07 % of that at rated torque",
    },
    Bound {
        name: "gear.steps.wind_up",
        value: 3e-2,
        unit: "1",
        why: "steady torsion after steps of 1 mrad under -50 N m against the catalogue's line, relative: held by friction and \
              hysteresis; target 2e-2",
    },
    Bound {
        name: "gear.steps.ringing",
        value: 2e-2,
        unit: "1",
        why: "frequency after the same steps against the eigenvalue at that torque, relative: stiffness and inertia of the ringing \
              joint",
    },
    Bound {
        name: "gear.real_time.output_position.max",
        value: 2e-6,
        unit: "rad",
        why: "a sixth of a 19-bit encoder's count, 1.2e-5 rad",
    },
    Bound {
        name: "gear.real_time.torsion.max",
        value: 2e-6,
        unit: "rad",
        why: "0.14 % of the torsion at rated torque",
    },
    Bound {
        name: "gear.real_time.transmitted_torque.max",
        value: 0.1,
        unit: "N m",
        why: "0.15 % of rated torque",
    },
    Bound {
        name: "gear.real_time.wave_generator_torque.max",
        value: 4e-3,
        unit: "N m",
        why: "a ninth of the Coulomb friction at the wave generator",
    },
    Bound {
        name: "pil.replay.size_17.rms",
        value: 6e-5,
        unit: "rad",
        why: "a measured gear's output predicted with the catalogue's line alone; a rigid gear misses by 2.4e-4",
    },
    Bound {
        name: "pil.faults",
        value: 0.0,
        unit: "1",
        why: "different faults, a limited torque excepted, that a healthy joint raises at work and in a scenario: no false \
              alarms",
    },
    Bound {
        name: "pil.limited",
        value: 0.01,
        unit: "s",
        why: "time at the torque limit in a scenario's judged part: no move or load requires it",
    },
    Bound {
        name: "pil.worse_marks",
        value: 0.0,
        unit: "1",
        why: "metrics of a scenario that are worse than a baseline's on the same plant by more than 5 % and 12 urad: \
              compensation never degrades a run",
    },
    Bound {
        name: "pil.steps_unlike_host",
        value: 0.0,
        unit: "1",
        why: "one generic code, and IEEE arithmetic on both processors: every bit of every output",
    },
    Bound {
        name: "pil.real.misread",
        value: 0.0,
        unit: "1",
        why: "control periods of the executed image of a real board in which its encoder is not read exactly once",
    },
    Bound {
        name: "pil.real.position",
        value: 1e-5,
        unit: "rad",
        why: "output of the joint that it holds from the operator's target, by the motor's encoder alone: 80 of its counts, seen through the gear",
    },
    Bound {
        name: "pil.real.telemetry.damaged",
        value: 0.0,
        unit: "line",
        why: "lines that came over the USART otherwise than they were sent",
    },
    Bound {
        name: "pil.real.encoder_lost.release",
        value: 2.5e-3,
        unit: "s",
        why: "from the failure of the only encoder to a drive without torque and without its enable",
    },
    Bound {
        name: "pil.real.encoder_lost.unsaid",
        value: 0.0,
        unit: "1",
        why: "the failure is not in the telemetry",
    },
    Bound {
        name: "pil.real.stopped.release",
        value: 5e-3,
        unit: "s",
        why: "from the end of the control interrupts to the same: the watchdog's 2 ms and a start",
    },
    Bound {
        name: "pil.real.stopped.enabled",
        value: 0.0,
        unit: "period",
        why: "control periods of the 0.2 s after it in which the drive is enabled: nobody has looked after the cause",
    },
    Bound {
        name: "pil.real.constant_changed.release",
        value: 3e-4,
        unit: "s",
        why: "from a changed bit of the joint's constants in RAM to a drive without its enable, the later of two bits, one in each half: a half is \
              summed in each control period",
    },
    Bound {
        name: "pil.real.constant_changed.enabled",
        value: 0.0,
        unit: "period",
        why: "control periods of the 0.2 s after it in which the drive is enabled, of both",
    },
    Bound {
        name: "pil.real.served.readings_unlike_host",
        value: 0.0,
        unit: "1",
        why: "readings over the tuning link of an executed image with any bit unlike those of the host's control in the same period",
    },
    Bound {
        name: "pil.real.served.answer",
        value: 5e-3,
        unit: "s",
        why: "longest time from the request of a reading to its last byte: 139 bytes at 921 600 Bd take 1.5 ms, what the emulated USART of an STM32F4 \
              sends twice as long",
    },
    Bound {
        name: "pil.real.served.damaged",
        value: 0.0,
        unit: "1",
        why: "frames that came over the link otherwise than they were sent",
    },
    Bound {
        name: "pil.real.served.unexpected",
        value: 0.0,
        unit: "1",
        why: "refusals, gains, silence, faults, resets, and what is kept over a restart, otherwise than they have to be",
    },
    Bound {
        name: "pil.real.can.frames_unlike_host",
        value: 0.0,
        unit: "1",
        why: "CAN frames of an executed image with any bit unlike those of the host's build of the same node",
    },
    Bound {
        name: "pil.real.can.answer",
        value: 1e-3,
        unit: "s",
        why: "longest time from when a master sends what it commands and a SYNC to the end of both answers, of which up to 0.5 ms are on the bus: a \
              cycle; target half of it",
    },
    Bound {
        name: "pil.real.can.following",
        value: 1e-4,
        unit: "rad",
        why: "largest distance of the output from the interpolated targets of a move of 20 mrad in 0.2 s, by the motor's encoder alone: 0.5 % of it",
    },
    Bound {
        name: "pil.real.can.position",
        value: 2e-5,
        unit: "rad",
        why: "the same when it rests: the gear's torsion at rest is not seen; target 1e-5, as after an operator's move, which is half as long",
    },
    Bound {
        name: "pil.real.can.lost.release",
        value: 0.15,
        unit: "s",
        why: "from the last SYNC to a drive that is off, of a joint in motion: 50 ms of silence, what it takes to brake, and 10 ms at rest; target 0.1",
    },
    Bound {
        name: "pil.real.can.stopped.speed",
        value: 0.01,
        unit: "rad/s",
        why: "fastest output when a quick stop or a silent bus has stopped a moving joint, by velocity, positions and a torque, and the drive goes \
              off: at rest, as the bus is told",
    },
    Bound {
        name: "pil.real.can.unexpected",
        value: 0.0,
        unit: "1",
        why: "boot-up, states, modes, refusals, quick stop, errors and resets on the bus otherwise than they have to be",
    },
    Bound {
        name: "pil.real.odrive.frames_unlike_host",
        value: 0.0,
        unit: "1",
        why: "CAN frames of an executed image to its master and to its drive with any bit unlike those of the host's build of the same code",
    },
    Bound {
        name: "pil.real.odrive.answer",
        value: 1e-3,
        unit: "s",
        why: "as without a drive on CAN, from when a master sends what it commands to the end of both answers: a cycle; target half of it",
    },
    Bound {
        name: "pil.real.odrive.following",
        value: 1e-4,
        unit: "rad",
        why: "the same as without a drive on CAN",
    },
    Bound {
        name: "pil.real.odrive.position",
        value: 3e-5,
        unit: "rad",
        why: "the same when it rests, with the gains for a drive that is later; target 1e-5",
    },
    Bound {
        name: "pil.real.odrive.delay",
        value: 4.5e-4,
        unit: "s",
        why: "longest time from a control interrupt until its torque, or a newer one, is at the drive: a frame of 0.1 ms every third control period, \
              behind a heartbeat that is on the bus; target 4e-4",
    },
    Bound {
        name: "pil.real.odrive.cycles",
        value: 470.0,
        unit: "cycle",
        why: "worst-case path of what a drive on CAN adds to the interrupt below the control's, in a period in which a heartbeat has come and a torque \
              is sent, without wait states; target 400",
    },
    Bound {
        name: "pil.real.odrive.silent.release",
        value: 0.02,
        unit: "s",
        why: "from the end of a drive's heartbeats, of 4 ms, to a drive that is off and whose silence the master is told: three of them, and the \
              frames",
    },
    Bound {
        name: "pil.real.odrive.error.named",
        value: 5e-3,
        unit: "s",
        why: "from an error of the drive to the same: the next heartbeat, and the frames",
    },
    Bound {
        name: "pil.real.odrive.lost.release",
        value: 0.18,
        unit: "s",
        why: "from the last SYNC to a drive that is off, of a joint in motion, as without a drive on CAN, whose vibration the later drive damps less; target 0.1",
    },
    Bound {
        name: "pil.real.odrive.encoder_lost.release",
        value: 3e-3,
        unit: "s",
        why: "from the failure of the motor encoder to a drive that is idle: as of one at wires, and a frame of 0.1 ms behind a heartbeat",
    },
];
