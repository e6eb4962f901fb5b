//! What holds for any sequence of frames, periods and values.

use super::*;
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum Event {
    Frame(Sent),
    /// A period of the bus, then RPDO1, RPDO2 and SYNC.
    Cycle(u16, i8, i16),
    Ticks(u32),
    Read(Actual, bool),
    Reset,
    Send,
}

fn controlword() -> impl Strategy<Value = u16> {
    prop_oneof![
        6 => prop::sample::select(std::vec![0x06, 0x07, 0x0f, 0x0f]),
        1 => prop::sample::select(std::vec![0x00, 0x02, 0x80, 0x8f]),
        1 => any::<u16>(),
    ]
}

fn actual() -> impl Strategy<Value = Actual> {
    let fault = prop_oneof![8 => Just(0_u16), 1 => Just(0x4210), 1 => any::<u16>()];
    let [ready, powered] = [prop::bool::weighted(0.9); 2];
    (any::<[i32; 2]>(), prop::num::f32::ANY, fault, any::<bool>(), (ready, powered)).prop_map(
        |([position, velocity], torque, fault, at_rest, (ready, powered))| Actual {
            ready,
            powered,
            position,
            velocity,
            torque,
            fault,
            at_rest,
            follows: !at_rest,
        },
    )
}

fn any_frame() -> impl Strategy<Value = Sent> {
    let data = || prop::collection::vec(any::<u8>(), 0..9);
    let own = prop::sample::select(std::vec![0x000, 0x080, 0x205, 0x305, 0x605, 0x701]);
    prop_oneof![
        (0_u16..0x800, data()).prop_map(|(id, data)| frame(id, &data)),
        (own, data()).prop_map(|(id, data)| frame(id, &data)),
        prop::sample::select(std::vec![1, 1, 2, 0x80, 0x81, 0x82]).prop_map(nmt),
        Just(sync()),
        (controlword(), any::<i8>(), any::<i32>()).prop_map(|(word, mode, p)| rpdo1(word, mode, p)),
        (any::<u8>(), any::<u16>(), 0_u8..4, any::<[u8; 4]>()).prop_map(|(command, index, sub, data)| {
            let [i0, i1] = index.to_le_bytes();
            frame(0x605, &[&[command, i0, i1, sub][..], &data].concat())
        }),
    ]
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        2 => any_frame().prop_map(Event::Frame),
        4 => (controlword(), 7_i8..12, any::<i16>()).prop_map(|(word, mode, t)| Event::Cycle(word, mode, t)),
        1 => (0_u32..60).prop_map(Event::Ticks),
        1 => (actual(), any::<bool>()).prop_map(|(actual, answers)| Event::Read(actual, answers)),
        1 => Just(Event::Reset),
        1 => Just(Event::Send),
    ]
}

/// What the bus has told the node, seen from outside.
#[derive(Default)]
struct Bus {
    operational: bool,
    received: Option<u16>,
    controlword: u16,
}

impl Bus {
    fn see(&mut self, Sent(id, data): &Sent) {
        let Id::Standard(id) = id else { return };
        match (id.as_raw(), &data[..]) {
            (0x000, &[command @ (1 | 2 | 0x80..=0x82), 0 | 5]) => {
                let controlword = if command > 0x80 { 0 } else { self.controlword };
                let received = self.received.filter(|_| command == 1);
                *self = Self { operational: command == 1, received, controlword };
            }
            (0x080, [] | [_]) if self.operational => {
                self.controlword = self.received.take().unwrap_or(self.controlword);
            }
            (0x205, &[c0, c1, _, _, _, _, _]) if self.operational => {
                self.received = Some(u16::from_le_bytes([c0, c1]));
            }
            _ => {}
        }
    }
}

/// Node and bus together.
struct World {
    node: Node,
    bus: Bus,
}

impl World {
    fn started() -> Self {
        let mut world = Self { node: PARAMS.build().unwrap(), bus: Bus::default() };
        world.take(&nmt(1));
        world.node.read(&MOVES, true);
        world
    }

    fn take(&mut self, frame: &Sent) {
        self.bus.see(frame);
        self.node.receive(frame);
    }

    fn cycle(&mut self, word: u16, mode: i8, torque: i16) {
        self.take(&rpdo1(word, mode, 3));
        self.take(&rpdo2(4, torque));
        self.take(&sync());
    }

    fn happen(&mut self, event: &Event) -> Result<(), TestCaseError> {
        match event {
            Event::Frame(frame) => self.take(frame),
            &Event::Cycle(word, mode, torque) => {
                ticks(&mut self.node, PERIOD);
                self.cycle(word, mode, torque);
            }
            &Event::Ticks(periods) => ticks(&mut self.node, periods),
            Event::Read(actual, answers) => self.node.read(actual, *answers),
            Event::Reset => _ = self.node.reset_requested(),
            Event::Send => {
                let sent = sent(&mut self.node);
                prop_assert!(sent.len() <= 9);
                prop_assert!(sent.iter().all(|(id, data)| data.len() <= 8 && (id & 0x7f) == 5));
            }
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn power_is_on_by_command_without_fault_in_operational_only(
        events in prop::collection::vec(event(), 0..60),
    ) {
        let mut world = World::started();
        let mut fault = 0;
        for event in events {
            world.happen(&event)?;
            if let Event::Read(actual, _) = event {
                fault = actual.fault;
            }
            let World { node, bus } = &mut world;
            if node.wanted() == Wanted::On {
                prop_assert!(bus.operational);
                prop_assert_eq!(bus.controlword & 0x0f, 0x0f);
                prop_assert_eq!((fault, node.machine.error()), (0, 0));
            }
            match node.target() {
                Some(Target::Torque(torque)) => prop_assert!(torque.abs() <= 32.767 * 50.001),
                Some(_) => prop_assert_eq!(node.wanted(), Wanted::On),
                None => {}
            }
        }
    }

    #[test]
    fn a_lost_bus_brakes_and_then_takes_the_power_off(events in prop::collection::vec(event(), 0..40)) {
        let mut world = World::started();
        for event in events {
            world.happen(&event)?;
        }
        let node = &mut world.node;
        let mut wanted = node.wanted();
        for _ in 0..PARAMS.timeout + PARAMS.longest_stop {
            node.tick();
            let next = node.wanted();
            let order = |wanted| match wanted {
                Wanted::On => 0,
                Wanted::Brake | Wanted::Standby => 1,
                Wanted::Off => 2,
            };
            prop_assert!(matches!(order(next) - order(wanted), 0 | 1), "{:?} {:?}", wanted, next);
            wanted = next;
        }
        prop_assert_eq!(wanted, Wanted::Off);
    }

    #[test]
    fn a_joint_that_was_told_to_brake_does_so_once(events in prop::collection::vec(event(), 0..60)) {
        // However many reasons to brake come: periods of braking in a row are at most the longest stop.
        let mut world = World::started();
        let mut braked = 0;
        for event in events {
            let mut brake = |world: &mut World, periods| {
                for _ in 0..periods {
                    world.node.tick();
                    braked = if world.node.wanted() == Wanted::Brake { braked + 1 } else { 0 };
                    prop_assert!(braked <= PARAMS.longest_stop);
                }
                Ok(())
            };
            match event {
                Event::Ticks(periods) => brake(&mut world, periods)?,
                Event::Cycle(word, mode, torque) => {
                    brake(&mut world, PERIOD)?;
                    world.cycle(word, mode, torque);
                }
                event => world.happen(&event)?,
            }
            braked = if world.node.wanted() == Wanted::Brake { braked } else { 0 };
        }
    }
}
